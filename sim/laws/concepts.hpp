#pragma once
/// \file
/// Concepts that define a contact law. A law is a small value type. It declares the word by which a scene
/// selects it, its parameters and the keys from which it reads them, the shortest time that the integrator
/// must resolve, its constants per kind of pair, and one formula. `None` is a law too. Kernels use laws only
/// through these concepts. A law that LAMMPS has also declares its words there (lammps_contact.hpp).
///
/// Convention (docs/conventions.md): n points from j to i; the overlap is delta = R_i + R_j - r > 0 in
/// contact; v_n = v_ij . n < 0 during approach; in the plane t = (-n_z, n_x) and v_t = v_ij . t - (R_i w_i +
/// R_j w_j). Forces act on i. All quantities are in reduced units. Formulas are templates on the number type
/// (scalar_arithmetic.hpp) and, for friction and rolling, on the tangent plane (tangent.hpp), so one formula
/// serves one contact or eight, in 2D and 3D.

#include <concepts>
#include <string>
#include <string_view>

#include "sim/laws/parameters.hpp"
#include "sim/laws/tangent.hpp"

namespace twincell::sim {

/// Members that every law has.
template <class Law>
concept ContactLaw = requires(const Law law, const ContactTable& table, const PairScale& pair) {
  { Law::kWord } -> std::convertible_to<std::string_view>;
  { Law::kName } -> std::convertible_to<std::string_view>;
  { Law::kHelp } -> std::convertible_to<std::string_view>;  // one clause, for `twincell keys`
  { Law::kConstants } -> std::convertible_to<int>;
  { Law::read(table) } -> std::same_as<Law>;
  { law.constants(pair)[0] } -> std::convertible_to<double>;
  Law::kKeys;
};

/// Normal force along n from overlap and normal velocity. The contact remembers kMemory numbers, which are 0
/// at first touch.
template <class Law>
concept NormalLaw = ContactLaw<Law> &&
    requires(const Law law, const PairScale& pair, const float* c, float x, float* m) {
  { Law::kMemory } -> std::convertible_to<int>;
  { Law::force(c, x, x, m) } -> std::same_as<float>;       // (constants, overlap, v_n, memory)
  { law.shortest_time(pair, x) } -> std::same_as<double>;  // (pair, impact speed), t0
  { law.largest_force(x) } -> std::same_as<double>;  // at an overlap; sets the rounding quantum of force sums
  { law.is_elastic() } -> std::same_as<bool>;        // whether every impact gives back all energy
  // Overlap at which a tangential stiffness that grows with the overlap must be resolved, sigma, at an impact
  // speed: that of an elastic impact; 0 if shortest_time() resolves it.
  { law.impact_overlap(pair, x) } -> std::same_as<double>;
};

/// A normal law that omits the attraction at the end of a contact: kOmitsTension = true. It gives the
/// collision as it is, and as it would be with the attraction. Its force is max(0, force_with_tension()),
/// which takes the same arguments.
template <class Law>
concept OmitsTension = requires(const Law law, const PairScale& pair) {
  requires Law::kOmitsTension;
  { law.collision(pair).restitution } -> std::convertible_to<double>;
  { law.collision_with_tension(pair).restitution } -> std::convertible_to<double>;
};

/// A tangential law whose force also takes the overlap, as its last argument: kReadsOverlap = true. Its
/// stiffness, and with it the shortest time, depends on the overlap.
template <class Law>
concept ReadsOverlap = requires(const Law law, const PairScale& pair, double overlap) {
  requires Law::kReadsOverlap;
  { law.shortest_time(pair, overlap) } -> std::same_as<double>;  // t0
};

/// A tangential law with history names the law without history to choose instead. With a stiffness k_t = 0
/// the two exert the same force.
template <class Law>
concept NamesLawWithoutHistory = !Law::kHistory || requires {
  { Law::kWithoutHistory } -> std::convertible_to<std::string_view>;
};

/// A tangential law that exerts no force with some of its parameters, although friction is not 0.
/// why_no_force() says which; it is empty if the law exerts one.
template <class Law>
concept MayExertNoForce = requires(const Law law) {
  { law.why_no_force() } -> std::convertible_to<std::string_view>;
};

/// Evaluates a tangential law: force from (constants, v_t, F_n, dt, xi), and from the overlap if the law
/// reads it.
template <class Law, class V, class T, class X>
[[gnu::always_inline]] inline T tangential_force(const V* c, const T& v_t, V f_n, V dt, X& xi,
                                                 [[maybe_unused]] V overlap) {
  if constexpr (ReadsOverlap<Law>)
    return Law::force(c, v_t, f_n, dt, xi, overlap);
  else
    return Law::force(c, v_t, f_n, dt, xi);
}

/// Tangential force. kActs: beads rotate. kHistory: the contact remembers xi.
template <class Law>
concept TangentialLaw = ContactLaw<Law> && NamesLawWithoutHistory<Law> &&
    requires(const Law law, const PairScale& pair, const float* c, float x, Tangent<float, 3> t,
             Tangent<float, 3> kept) {
  { Law::kActs } -> std::convertible_to<bool>;
  { Law::kHistory } -> std::convertible_to<bool>;
  { tangential_force<Law>(c, t, x, x, kept, x) } -> std::same_as<Tangent<float, 3>>;
  { law.shortest_time(pair) } -> std::same_as<double>;  // t0
};

/// Torque against rolling on i (the opposite torque acts on j). The contact remembers the rolled angle theta.
template <class Law>
concept RollingLaw = ContactLaw<Law> && requires(const Law law, const PairScale& pair, const float* c,
                                                 float x, Tangent<float, 3> t, Tangent<float, 3> kept) {
  { Law::kActs } -> std::convertible_to<bool>;
  { Law::torque(c, t, x, x, kept) } -> std::same_as<Tangent<float, 3>>;  // (constants, w, F_n, dt, theta)
  { law.shortest_time(pair) } -> std::same_as<double>;                   // t0
};

}  // namespace twincell::sim
