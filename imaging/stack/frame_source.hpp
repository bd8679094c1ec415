#pragma once
/// \file
/// Camera frames, one at a time.

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace twincell {

/// What a stack says of itself. What it does not say is absent.
struct StackInfo {
  std::string format;                         ///< for people: "Phantom cine, 16 bit"
  int width = 0, height = 0;                  ///< px; 0: not known before the first frame is read
  std::optional<int> bits;                    ///< pixel values lie in 0 .. 2^bits - 1, by the file's own word
  std::optional<double> frame_rate_hz;        ///< as stated
  std::optional<double> stamped_rate_hz;      ///< by the time stamps of the first and the last frame
  std::optional<std::int64_t> first_number;   ///< the camera's number of the first frame; 0 is the trigger
  std::optional<double> exposure_s;           ///< of the first frame, s
  std::string time_origin;                    ///< what FrameSource::time_s counts from; empty: no times
  std::optional<std::int64_t> recorded_unix;  ///< clock of the camera at time 0, whole s since 1970 (UTC)
  std::size_t other_files = 0;                ///< in a folder: files that are no pictures and are passed over
  std::vector<std::string> notes;             ///< sentences the user should read
};

/// A stack of frames of one size, read in order; memory does not grow with their number.
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;
  /// Reads the next frame as one grey channel of type CV_8U, CV_16U or CV_32F. Colour is turned into grey
  /// (0.299 R + 0.587 G + 0.114 B, ITU-R BT.601). Values are those of the camera, not spread over the range
  /// of the type: 12 bits lie in 0 .. 4095. Row 0 is the top. \returns false at the end of the stack
  /// \throws InputError naming the file if it cannot be read or is truncated, or if its size differs from
  /// the first
  virtual bool next(cv::Mat& frame) = 0;
  /// Number of frames as the stack announces it (a video may be wrong by a few); for progress.
  [[nodiscard]] virtual std::size_t announced() const = 0;
  /// The file behind the frame read last.
  [[nodiscard]] virtual std::string current() const = 0;
  /// What the stack says of itself.
  [[nodiscard]] virtual StackInfo info() const { return {}; }
  /// When the frame read last was taken, s after StackInfo::time_origin, by the camera's own stamp; absent
  /// where the format has none.
  [[nodiscard]] virtual std::optional<double> time_s() const { return {}; }
};

/// Order in which a person would put file names: runs of digits compare as numbers, so frame_2 precedes
/// frame_10. Names that differ only in leading zeros compare as text.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace twincell
