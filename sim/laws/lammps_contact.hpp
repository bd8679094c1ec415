#pragma once
/// \file
/// What a contact law is in LAMMPS.

#include <concepts>
#include <string_view>

namespace twincell::sim {

/// Coefficients of a contact for LAMMPS's pair_style gran/hooke. The damping coefficients are rates, which
/// LAMMPS multiplies by m_eff.
struct LammpsContact {
  double k_n = 0, k_t = 0;          ///< m g/sigma
  double gamma_n = 0, gamma_t = 0;  ///< 1/t0
  double mu = 0;
  bool history = false;        ///< style hooke/history
  bool friction = false;       ///< dampflag
  bool clipped = false;        ///< limit_damping
  bool for_all_masses = true;  ///< the rates are the same for contacts of other masses
  bool operator==(const LammpsContact&) const = default;
};

/// A law that LAMMPS has: write_lammps() sets its coefficients for a contact of reduced mass m_eff. kInLammps
/// repeats the word of the law, so that a law does not inherit this from the law from which it is derived.
template <class Law>
concept InLammps = (std::string_view(Law::kInLammps) == std::string_view(Law::kWord)) &&
                   requires(const Law law, LammpsContact& contact, double m_eff) {
  { law.write_lammps(contact, m_eff) } -> std::same_as<void>;
};

}  // namespace twincell::sim
