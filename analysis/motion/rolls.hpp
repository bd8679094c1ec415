#pragma once
/// \file
/// Number of convection rolls of a displacement field, with a stated false-alarm rate.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace twincell::analysis {

/// Probability of finding any roll in a bed without steady flow.
inline constexpr double kRollFalseAlarm = 0.05;
/// Minimum number n of blocks of cycles that distinguish a roll from chance. Of the 2^n combinations of
/// signs, two give the observed field up to its sign, and 2/2^n must not exceed kRollFalseAlarm.
inline constexpr std::size_t kMinRollBlocks = 6;
inline constexpr double kSmallestRoll =
    0.1;  ///< as a share of the largest |psi|; weaker regions are not rolls

/// Circulations around the loops of a grid (Circulation::plaquettes in convection_field.hpp), one array per
/// block of cycles. The mean over the blocks is the circulation of the whole run. A loop is NaN either in all
/// blocks or in no block.
struct CirculationBlocks {
  std::size_t columns = 0;
  bool periodic = false;                         ///< the last column is adjacent to the first
  std::vector<std::vector<double>> blocks = {};  ///< [blocks][rows x columns] sigma^2 per cycle
};

/// Stream function psi, sigma^2 per cycle, from the circulations C. In every loop
///
///     sum over the four neighbours q of (psi - psi_q) = C,    psi = 0 on walls, floor, surface and in holes
///
/// so that u_x = d psi/dz, u_z = -d psi/dx is the rotational part of the flow. psi at a point is the area
/// that circulates around the point per cycle, counter-clockwise positive. NaN where C is NaN.
std::vector<double> stream_function(const std::vector<double>& circulation, std::size_t columns,
                                    bool periodic);

/// Number of rolls. A roll is a connected region of one sense with |t| > T/2 everywhere and |t| > T
/// somewhere. Here t = mean/(standard error) of psi over the blocks, and T is the value that the largest |t|
/// of the field exceeds in 5 % of 999 draws with a random sign for every block. Without steady flow, a block
/// and its mirror image are equally likely, so that T is valid for any distribution of the blocks and any
/// spatial correlation of their noise. Regions whose |psi| stays below `least` (sigma^2 per cycle) or below a
/// tenth of the largest |psi| are left out. The same blocks give the same number.
/// \pre blocks.blocks.size() >= kMinRollBlocks
std::size_t count_rolls(const CirculationBlocks& blocks, double least);

}  // namespace twincell::analysis
