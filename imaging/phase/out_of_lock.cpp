#include "imaging/phase/out_of_lock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace twincell::imaging {

std::vector<FrameStretch> stretches_out_of_lock(std::span<const double> misses, double period) {
  constexpr double kMinFrames = 3;
  constexpr double kMinShareOff = 0.5;  // of the frames in which the plate is seen
  constexpr double kMinLengthInside = 0.5, kMinLengthAtEnd = 0.25;  // of a stretch, periods
  const double near = std::max(kMinFrames, 0.5 * period);           // frames
  std::vector<FrameStretch> groups;
  for (std::size_t f = 0; f < misses.size(); ++f) {
    if (!(misses[f] > 1)) continue;
    if (groups.empty() || static_cast<double>(f - groups.back().last) >= near) groups.push_back({f, f});
    groups.back().last = f;
  }
  std::vector<FrameStretch> out;
  for (FrameStretch g : groups) {
    double off = 0, seen = 0;
    for (std::size_t f = g.first; f <= g.last; ++f) {
      off += misses[f] > 1 ? 1 : 0;
      seen += std::isfinite(misses[f]) ? 1 : 0;
    }
    const bool begins = static_cast<double>(g.first) < near,
               ends = static_cast<double>(misses.size() - 1 - g.last) < near;
    const double least = std::max(kMinFrames, (begins || ends ? kMinLengthAtEnd : kMinLengthInside) * period);
    if (off < kMinFrames || static_cast<double>(g.size()) < least || off < kMinShareOff * seen) continue;
    // The few frames between it and the end of the film are less than a cycle, and cross the sine by chance.
    if (begins) g.first = 0;
    if (ends) g.last = misses.size() - 1;
    out.push_back(g);
  }
  return out;
}

std::size_t frames_in(std::span<const FrameStretch> stretches) {
  std::size_t n = 0;
  for (const FrameStretch& s : stretches) n += s.size();
  return n;
}

std::string in_words(std::span<const FrameStretch> stretches) {
  constexpr std::size_t kMaxNamed = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(stretches.size(), kMaxNamed); ++i) {
    const FrameStretch& s = stretches[i];
    text += i == 0 ? "" : i + 1 == stretches.size() ? " and " : ", ";
    text += s.first == s.last ? fmt::format("{}", s.first) : fmt::format("{} to {}", s.first, s.last);
  }
  return stretches.size() > kMaxNamed ? text + ", ..." : text;
}

}  // namespace twincell::imaging
