#pragma once
/// \file
/// How many convection rolls a field of displacements has, with a stated rate of false alarms.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace twincell {

/// In a bed without steady flow, the probability that any roll is found.
inline constexpr double kRollFalseAlarm = 0.05;
/// Blocks of cycles that can tell a roll from chance: of 2^n signs two show what was seen, up to the sign,
/// and 2/2^n must not exceed kRollFalseAlarm.
inline constexpr std::size_t kFewestRollBlocks = 6;
inline constexpr double kSmallestRoll = 0.1;  ///< of the largest |psi|; weaker regions are no rolls

/// Circulations round the loops of a grid (Circulation::plaquettes in convection.hpp), one array for each
/// block of cycles, of which the mean is the circulation of the whole run. NaN in all of them or in none.
struct CirculationBlocks {
  std::size_t columns = 0;
  bool periodic = false;                         ///< the last column is the first one's neighbour
  std::vector<std::vector<double>> blocks = {};  ///< [blocks][rows x columns] sigma^2 per cycle
};

/// Stream function psi, sigma^2 per cycle, of circulations C: in every loop
///     sum over the four neighbours q of (psi - psi_q) = C,    psi = 0 on walls, floor, surface and in holes
/// so that u_x = d psi/dz, u_z = -d psi/dx is the part of the flow that goes round; psi is the area that goes
/// round a point in a cycle, counter-clockwise positive. NaN where C is.
std::vector<double> stream_function(const std::vector<double>& circulation, std::size_t columns,
                                    bool periodic);

/// Number of rolls: regions of one sense in which |t| > T/2 and somewhere |t| > T, with t = mean/(standard
/// error) of psi over the blocks and T the value that the largest |t| anywhere exceeds in 5 % of 999 draws in
/// which every block has its sign at random. Without steady flow a block is as likely as its mirror image, so
/// that T holds whatever the blocks' distribution and however their noise hangs together in space. Regions
/// whose |psi| stays below `least` or below a tenth of the largest are left out. Same blocks, same number.
/// \pre blocks.blocks.size() >= kFewestRollBlocks
std::size_t count_rolls(const CirculationBlocks& blocks, double least);

}  // namespace twincell
