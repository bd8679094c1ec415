#pragma once
/// \file
/// What a contact law declares. A law is a small value type: a name, its parameters, what it needs, the
/// shortest time it makes the integrator resolve, and one call operator. `None` is a law too. The kernels
/// know laws only by this.
///
/// Convention (docs/conventions.md): n points from j to i, overlap delta = R_i + R_j - r > 0 in contact,
/// v_n = v_ij . n < 0 while approaching; in the plane t = (-n_z, n_x) and v_t = v_ij . t - (R_i w_i + R_j
/// w_j). Forces are those on i. Reduced units throughout.

#include <concepts>
#include <string_view>

namespace twincell::sim {

/// Normal force along n from overlap and normal velocity.
template <class Law>
concept NormalLaw = requires(const Law law, double x) {
  { Law::kName } -> std::convertible_to<std::string_view>;
  { law(x, x, x) } -> std::same_as<double>;          // (overlap, v_n, m_eff)
  { law.shortest_time(x) } -> std::same_as<double>;  // (m_eff), t0
};

/// Tangential force along t. kNeedsSpin: the bead's rotation matters; kNeedsHistory: xi lives as long as the
/// contact.
template <class Law>
concept TangentialLaw = requires(const Law law, double x, double& xi) {
  { Law::kName } -> std::convertible_to<std::string_view>;
  { Law::kNeedsSpin } -> std::convertible_to<bool>;
  { Law::kNeedsHistory } -> std::convertible_to<bool>;
  { law(x, x, x, x, xi) } -> std::same_as<double>;      // (v_t, F_n, m_eff, dt, xi)
  { law.shortest_time(x, x) } -> std::same_as<double>;  // (m_eff, m_t), t0
};

/// How two positions are compared across the side boundary.
template <class Law>
concept SideLaw = requires(const Law law, double x) {
  { Law::kName } -> std::convertible_to<std::string_view>;
  { Law::kWalls } -> std::convertible_to<bool>;
  { law.separation(x) } -> std::same_as<double>;  // x_i - x_j -> shortest image
};

}  // namespace twincell::sim
