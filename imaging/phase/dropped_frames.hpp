#pragma once
/// \file
/// A plate that moves as a sine, filmed with a whole number of frames per cycle: the frames that are missing
/// or were taken twice.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace twincell::imaging {

/// z(t) = mean + amplitude sin(2 pi (t/N + phase)), with t the tick of the frame. Lengths are in the unit of
/// the heights.
struct SineSlips {
  double mean = 0, amplitude = 0;
  double phase = 0;    ///< at frame 0, cycles, in [0, 1)
  double scatter = 0;  ///< of the heights about the sine, robust (1.48 times the median deviation)
  std::vector<std::int64_t> ticks;  ///< [frames] frame intervals since frame 0; whole numbers
  std::int64_t dropped = 0;         ///< frames that are missing
  std::int64_t doubled = 0;         ///< frames that were taken twice
  std::size_t seen = 0;             ///< number of finite heights

  /// Height of the sine in a frame.
  /// \param frames_per_cycle N of the fit
  [[nodiscard]] double at(std::size_t frame, int frames_per_cycle) const;
};

/// Fits the sine and the ticks. The sine is first fitted to the stretch of 0.6 cycles with the smallest
/// residual, then to all frames. The ticks are the most likely path (Viterbi): a frame advances by one tick
/// or, at a cost, by none or by up to N - 1. If all heights are closer to the sine than a quarter of its
/// largest step between frames, no frame is missing, and no path is searched. Memory of the search: 2 bytes
/// times frames times N.
/// \param heights one per frame, NaN where unknown
/// \param frames_per_cycle N, 3 or more
/// \returns nothing for fewer than eight heights or less than one cycle
std::optional<SineSlips> fit_sine_with_slips(std::span<const double> heights, int frames_per_cycle);

/// The sine without slips whose period fits the heights best.
struct FreeSine {
  double period = 0;  ///< frames
  double amplitude = 0, scatter = 0;
  double mean = 0;
  double phase = 0;  ///< at frame 0, cycles, in [0, 1)

  /// Height of the sine in a frame.
  [[nodiscard]] double at(std::size_t frame) const;
};
/// Fits a FreeSine: first to 2000 frames, by a search over all periods from 2 frames to the length of the
/// stack, then to twice as many frames in each round, near the period of the round before.
/// \param near period to which it is within a tenth, frames, if one is known: the search is then much shorter
/// \returns nothing for fewer than eight heights
std::optional<FreeSine> fit_free_sine(std::span<const double> heights, std::optional<double> near = {});

/// Frames per cycle to try for a plate with missing or doubled frames: the stated number, or if it is 0 the
/// whole numbers from 0.85 to 1.3 times the apparent period, which missing frames shorten; at most 23.
std::vector<int> frames_per_cycle_to_try(int stated, double apparent_period);

}  // namespace twincell::imaging
