#pragma once
/// \file
/// Indices of the constants of a contact, which the kernels, the solvers and the plan share. They do not
/// depend on the laws.

namespace twincell::sim {

/// Number of components of the spin and of the tangent plane.
template <int D>
inline constexpr int kTurns = D == 2 ? 1 : 3;

/// Indices of the constants of a contact. There is one set per kind of pair: the geometry first, then the
/// constants of its laws in the order of the axes.
namespace constant {
inline constexpr int kReach = 0;     ///< R_i + R_j; R at a wall
inline constexpr int kEdge = 1;      ///< kReach^2, slightly enlarged; pairs with a smaller r^2 are evaluated
inline constexpr int kInvReach = 2;  ///< 1/kReach
inline constexpr int kInvReachSquared = 3;  ///< 1/kReach^2
inline constexpr int kInvRadiusI = 4;       ///< 1/R_i, for rolling
inline constexpr int kInvRadiusJ = 5;       ///< 1/R_j; 0 at a wall
inline constexpr int kInvMass = 6;          ///< 1/m_eff
inline constexpr int kLaws = 7;             ///< first constant of the laws
}  // namespace constant

}  // namespace twincell::sim
