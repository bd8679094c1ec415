#pragma once
/// \file
/// Frames to a film.

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "core/atomic_file.hpp"

namespace twincell {

/// Writes .mp4 (H.264, or MPEG-4 where this OpenCV has no H.264) or .avi (Motion JPEG). 8 bit grey; an odd
/// width or height is made even by repeating the last column or row. Appears at commit().
class Movie {
 public:
  /// \throws ConfigError for another extension or a rate outside 0 .. 1000, RunError if the film cannot be
  /// begun
  Movie(const std::filesystem::path& file, cv::Size size, double frames_per_second);
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;
  /// \param bits depth of the frame: the upper eight are shown
  void add(const cv::Mat& frame, int bits);
  void commit();

 private:
  struct Writer;
  AtomicPath place_;
  std::unique_ptr<Writer> writer_;
  cv::Size size_;
  std::size_t frames_ = 0;
};

}  // namespace twincell
