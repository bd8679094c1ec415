#include "imaging/stack/repeated_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <unordered_map>
#include <unordered_set>

#include "core/median.hpp"

namespace twincell::imaging {

namespace {

/// 64-bit hash of the pixels (multiply and rotate, eight bytes at a time).
std::uint64_t hash_of(const cv::Mat& frame) {
  constexpr std::uint64_t kMultiplier = 0x9E3779B97F4A7C15ULL;
  std::uint64_t hash =
      static_cast<std::uint64_t>(frame.cols) * kMultiplier ^ static_cast<std::uint64_t>(frame.rows);
  const std::size_t bytes = static_cast<std::size_t>(frame.cols) * frame.elemSize();
  for (int y = 0; y < frame.rows; ++y) {
    const unsigned char* row = frame.ptr(y);
    for (std::size_t at = 0; at < bytes; at += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + at, std::min(sizeof word, bytes - at));
      hash = (hash ^ word) * kMultiplier;
      hash ^= hash >> 29U;
    }
  }
  return hash;
}

}  // namespace

void RepeatedFrames::add(const cv::Mat& frame) {
  hashes_.push_back(hash_of(frame));
  const bool comparable = before_.size() == frame.size() && before_.type() == frame.type();
  changes_.push_back(comparable ? cv::norm(frame, before_, cv::NORM_L1) / static_cast<double>(frame.total())
                                : 0);
  frame.copyTo(before_);
}

std::vector<std::uint8_t> RepeatedFrames::repeats() const {
  constexpr std::size_t kMaxRun = 6;  // equal frames
  constexpr double kMinChange = 0.5;  // beside a run, fraction of the median change
  const std::size_t n = hashes_.size();
  std::vector<double> moved;
  for (std::size_t f = 1; f < n; ++f)
    if (hashes_[f] != hashes_[f - 1]) moved.push_back(changes_[f]);
  if (moved.empty() || moved.size() + 1 == n) return {};
  const double least = kMinChange * upper_median(std::move(moved));
  std::vector<std::uint8_t> repeats(n, 0);
  bool certain = false;
  for (std::size_t first = 0, last = 0; first < n; first = ++last) {
    while (last + 1 < n && hashes_[last + 1] == hashes_[first]) ++last;
    if (last == first || last - first + 1 > kMaxRun) continue;
    std::fill(repeats.begin() + static_cast<std::ptrdiff_t>(first) + 1,
              repeats.begin() + static_cast<std::ptrdiff_t>(last) + 1, std::uint8_t{1});
    certain = certain || (first > 0 && last + 1 < n && hashes_[first - 1] != hashes_[last + 1] &&
                          changes_[first] >= least && changes_[last + 1] >= least);
  }
  return certain ? repeats : std::vector<std::uint8_t>{};
}

std::string RepeatedFrames::copied() const {
  constexpr std::size_t kFewest = 8, kFewestPictures = 3, kPeriods = 3;
  const std::size_t n = hashes_.size();
  std::unordered_map<std::uint64_t, std::size_t> seen;  // the last frame with these pixels
  std::size_t first = 0, distance = 0, longest = 0, longest_first = 0, longest_distance = 0;
  std::unordered_set<std::uint64_t> pictures;
  for (std::size_t f = 0; f < n; ++f) {
    const auto before = seen.find(hashes_[f]);
    const std::size_t back = before == seen.end() ? 0 : f - before->second;
    if (back != distance) first = f, distance = back, pictures.clear();
    pictures.insert(hashes_[f]);
    seen[hashes_[f]] = f;
    const std::size_t length = f + 1 - first;
    if (distance > 1 && length > longest && pictures.size() >= kFewestPictures)
      longest = length, longest_first = first, longest_distance = distance;
  }
  const bool periodic = longest_first == longest_distance && longest + longest_distance == n &&
                        longest >= (kPeriods - 1) * longest_distance;
  if (longest < kFewest || periodic) return {};
  return fmt::format(
      "frames {} to {} equal frames {} to {} to the bit: this part of the film is in the stack twice, and "
      "its cycles count twice, as noise makes no two frames of a camera equal",
      longest_first, longest_first + longest - 1, longest_first - longest_distance,
      longest_first + longest - 1 - longest_distance);
}

std::string repeats_in_words(std::span<const std::uint8_t> repeats, const FrameRange& range) {
  const auto first = std::find(repeats.begin(), repeats.end(), 1);
  if (first == repeats.end()) return {};
  return fmt::format(
      "{} of {} frames equal the frame before them to the bit, the first of them frame {}: a conversion of "
      "the frame rate, or a copy, has repeated them, as noise makes no two frames of a camera equal; export "
      "the film without a conversion",
      std::count(repeats.begin(), repeats.end(), 1), repeats.size(), range.number(first - repeats.begin()));
}

}  // namespace twincell::imaging
