#pragma once
/// \file
/// The motion of a plate as an instrument recorded it: uniform samples and their interpolation.

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace twincell {

/// Displacement, velocity and acceleration of a plate along one axis, in sigma and t0.
struct MotionSample {
  double z = 0, v = 0, a = 0;
};

/// Largest number of samples of a record, and largest displacement, sigma.
inline constexpr std::size_t kMaxSamples = 1'000'000;
inline constexpr double kLargestStroke = 1e6;

/// What a record says besides its samples.
struct RecordInfo {
  double interval = 1;  ///< between samples, t0
  double start = 0;     ///< time from the first sample to the beginning of cycle 0, t0
  int cycles = 0;    ///< whole cycles of a record that is repeated (after its last sample the first follows);
                     ///< 0: it is not repeated
  std::string file;  ///< name of the file, without its folder
  std::string sha256;                    ///< of the file, 64 hex digits
  std::vector<std::string> doubts = {};  ///< sentences about the record; not stored in files
};

/// A recorded motion. Between two samples it is the polynomial of degree 5 that has their displacement,
/// velocity and acceleration, so that all three are continuous. A cycle begins at phase 0 of the sine that is
/// fitted to the record, as the cycle of a sinusoidal drive does.
class RecordedMotion {
 public:
  /// \pre at least 2 samples, finite; interval > 0
  RecordedMotion(std::vector<MotionSample> samples, RecordInfo info);

  /// The motion in a cycle (0 is the first) at a fraction of it, 0 <= fraction < 1.
  /// \param period of a cycle, t0. A repeated record gives the same bits in every repetition. Less than one
  /// interval beyond the ends of another record its first or last polynomial continues; farther away the
  /// plate stays there.
  [[nodiscard]] MotionSample at(std::int64_t cycle, double fraction, double period) const;
  /// Adds a doubt to info().doubts.
  void doubt(std::string sentence) { info_.doubts.push_back(std::move(sentence)); }
  /// Number of cycles from the beginning of cycle 0 to the last sample; infinite if the record is repeated.
  [[nodiscard]] double length(double period) const;
  /// The same motion with a larger or smaller stroke.
  [[nodiscard]] RecordedMotion scaled(double factor) const;

  /// Extremes over the samples and seven points in each interval.
  struct Range {
    double lowest = 0, highest = 0;  ///< displacement, sigma
    double speed = 0;                ///< largest |velocity|, sigma/t0
    double fall = 0, rise = 0;       ///< largest downward and upward acceleration, not negative, sigma/t0^2
  };
  [[nodiscard]] const Range& range() const { return range_; }
  [[nodiscard]] const std::vector<MotionSample>& samples() const { return samples_; }
  [[nodiscard]] const RecordInfo& info() const { return info_; }

 private:
  std::vector<MotionSample> samples_;
  RecordInfo info_;
  Range range_;
};

}  // namespace twincell
