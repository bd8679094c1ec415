#pragma once
/// \file
/// One Gauss-Newton step for all discs of a frame together.
///
/// Discs whose blurred edges share pixels influence each other: a disc fitted too large makes its neighbours
/// too small. Fitting one disc at a time would take tens of sweeps in a dense packing. The normal equations
/// of the whole frame have one block per disc and one per pair of neighbours. Both are sums over pixels, so
/// the whole matrix is positive definite, as for any sum of squares. (Pair blocks from a table of gaps were
/// tried. They were wrong by a few per cent, and dense packings with little noise diverged.) A step need not
/// be exact, because the next one corrects it. The equations are therefore solved by conjugate gradients to
/// one part in a hundred.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "imaging/disc/ring_normal_equations.hpp"

namespace twincell::imaging {

inline constexpr int kFitted = RingSums::kFitted;
using Normal = Eigen::Matrix<double, kFitted, kFitted>;  ///< order x, y, R, a
using Step = Eigen::Matrix<double, kFitted, 1>;
enum FittedRow : std::uint8_t { kX, kY, kR, kA };  ///< rows of a Normal and a Step

/// The normal matrix of one disc.
/// \param s sums over its ring
Normal normal_of(const RingSums& s);
/// The right side of the normal equations of one disc.
/// \param s sums over its ring
Step right_side(const RingSums& s);

/// Pairs of discs whose edges are less than `reach` apart, each once. Discs are sorted into cells, so the
/// time is linear in their number.
/// \param reach px, >= 0
std::vector<std::array<std::int32_t, 2>> near_pairs(const std::vector<Disc>& discs, double reach);

/// Two discs that share pixels, with the off-diagonal block that couples them.
struct Coupling {
  std::int32_t i, j;
  Normal sums;  ///< rows: x, y, R, a of i; columns: of j
};
/// All pairs, ordered by their first disc. Their sums are not computed yet; see `renew`.
std::vector<Coupling> couplings_of(const RingArgs& args, const std::vector<Disc>& discs);
/// Computes the sums of one pair for the present state of its discs.
void renew(Coupling& coupling, const RingArgs& args, const std::vector<Disc>& discs);

/// Solves (blocks + couplings) step = right for all discs.
/// \param blocks positive definite
std::vector<Step> gauss_newton_step(const std::vector<Normal>& blocks, const std::vector<Coupling>& couplings,
                                    const std::vector<Step>& right);

}  // namespace twincell::imaging
