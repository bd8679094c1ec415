#pragma once
/// \file
/// Interface of a stack of camera frames, read one at a time.

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace twincell::imaging {

/// Metadata of a stack. Data that the stack does not state are absent.
struct StackInfo {
  std::string format;                         ///< description for the user: "Phantom cine, 16 bit"
  int width = 0, height = 0;                  ///< px; 0: unknown until the first frame is read
  std::optional<int> bits;                    ///< pixel values are in 0 .. 2^bits - 1, as the file states
  std::optional<double> frame_rate_hz;        ///< as the file states
  bool playback = false;                      ///< that rate is the one of playing a video, not of filming
  std::optional<double> stamped_rate_hz;      ///< from the time stamps of the first and the last frame
  std::optional<std::int64_t> first_number;   ///< the camera's number of the first frame; 0 is the trigger
  std::optional<double> exposure_s;           ///< of the first frame, s
  std::string time_origin;                    ///< origin of FrameSource::time_s; empty: no time stamps
  std::optional<std::int64_t> recorded_unix;  ///< clock of the camera at time 0, whole s since 1970 (UTC)
  std::size_t other_files = 0;                ///< in a folder: number of skipped files that are not pictures
  std::vector<std::string> notes;             ///< sentences that the user should read
};

/// A stack of frames of one size, read in order. Memory use does not grow with their number.
class FrameSource {
 public:
  FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  virtual ~FrameSource() = default;
  /// Reads the next frame as one grey channel of type CV_8U, CV_16U or CV_32F. Colour is converted to grey
  /// (0.299 R + 0.587 G + 0.114 B, ITU-R BT.601). Values are those of the camera, not scaled to the range of
  /// the type: 12-bit values are in 0 .. 4095. Row 0 is the top.
  /// \returns false at the end of the stack
  /// \throws InputError naming the file if it cannot be read or is truncated, or if the size of the frame
  /// differs from that of the first
  virtual bool next(cv::Mat& frame) = 0;
  /// Number of frames that the stack states, for progress reports. For a video it may be wrong by a few.
  [[nodiscard]] virtual std::size_t announced() const = 0;
  /// Name of the frame read last, for messages: its file, and its number if the file contains several.
  [[nodiscard]] virtual std::string current() const = 0;
  /// Metadata of the stack.
  [[nodiscard]] virtual StackInfo info() const { return {}; }
  /// Time stamp by the camera of the frame read last, s after StackInfo::time_origin; absent if the format
  /// has no time stamps.
  [[nodiscard]] virtual std::optional<double> time_s() const { return {}; }
};

/// Natural order of file names: runs of digits compare as numbers, so that frame_2 precedes frame_10. Names
/// that differ only in leading zeros compare as text.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace twincell::imaging
