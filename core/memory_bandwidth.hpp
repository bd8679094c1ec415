#pragma once
/// \file
/// Bandwidth of main memory: the bound of work that moves data.

#include <optional>

namespace twincell {

/// Bytes per second that `threads` threads together read from main memory at present: the best of three
/// passes over 128 MB, which is more than the caches of the usual processors hold. Takes about 0.1 s.
/// Empty if less than four times as much memory is available.
/// \pre threads >= 1
std::optional<double> memory_bandwidth(int threads);

}  // namespace twincell
