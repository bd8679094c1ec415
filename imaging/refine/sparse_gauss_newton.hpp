#pragma once
/// \file
/// One Gauss-Newton step of all discs of a frame together.
///
/// Discs whose blurred edges share pixels pull at each other: a disc drawn too large makes its neighbours too
/// small. One disc at a time would take tens of sweeps in a dense packing. The normal equations of the whole
/// frame have a block per disc and one per pair of neighbours, both sums over pixels, so that the whole is
/// positive as a sum of squares must be. (Pairs' blocks from a table of gaps were tried: a few per cent
/// wrong, they made dense packings with little noise diverge.) A step need not be exact, the next one mends
/// it; so the equations are solved by conjugate gradients to a part in a hundred.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "imaging/disc/ring_normal_equations.hpp"

namespace twincell {

inline constexpr int kFitted = RingSums::kFitted;
using Normal = Eigen::Matrix<double, kFitted, kFitted>;  ///< order x, y, R, a
using Step = Eigen::Matrix<double, kFitted, 1>;

/// Pairs of discs whose edges are less than `reach` apart, each once; discs in cells, so time is linear.
std::vector<std::array<std::int32_t, 2>> near_pairs(const std::vector<Disc>& discs, double reach);

/// Two discs that share pixels, and by how much they pull at each other.
struct Coupling {
  std::int32_t i, j;
  Normal sums;  ///< rows: x, y, R, a of i; columns: of j
};
/// All pairs, by their first disc; their sums are yet to be found.
std::vector<Coupling> couplings_of(const RingArgs& args, const std::vector<Disc>& discs);
/// Finds the sums of one pair, as its discs are now.
void renew(Coupling& coupling, const RingArgs& args, const std::vector<Disc>& discs);

/// Solves (blocks + couplings) step = right for all discs. \param blocks positive definite
std::vector<Step> gauss_newton_step(const std::vector<Normal>& blocks, const std::vector<Coupling>& couplings,
                                    const std::vector<Step>& right);

}  // namespace twincell
