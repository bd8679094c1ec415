#pragma once
/// \file
/// Camera frames, one at a time: a folder of pictures, a single picture, a multi-page TIFF, a video.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace twincell {

/// A stack of frames of one size, read in order; memory does not grow with their number.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Reads the next frame as one grey channel of type CV_8U, CV_16U or CV_32F (colour is turned into grey,
  /// the bit depth is kept). \returns false at the end of the stack \throws InputError naming the file if it
  /// cannot be read or is truncated, or if its size differs from the first
  virtual bool next(cv::Mat& frame) = 0;
  /// Number of frames as the stack announces it (a video may be wrong by a few); for progress.
  [[nodiscard]] virtual std::size_t announced() const = 0;
  /// The file behind the frame read last.
  [[nodiscard]] virtual std::string current() const = 0;
};

/// Opens a stack: a folder (its PNG, TIFF, JPEG, BMP and PGM files in natural order), one such file (a TIFF
/// gives all its pages), or a video (AVI, MP4, MKV, MOV, M4V, CINE; 8 bit only, whatever the file holds).
/// \throws InputError if there is nothing to read
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& stack);

/// Order in which a person would put file names: runs of digits compare as numbers, so frame_2 precedes
/// frame_10. Names that differ only in leading zeros compare as text.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace twincell
