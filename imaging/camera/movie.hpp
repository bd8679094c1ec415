#pragma once
/// \file
/// Writing frames to a film.

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "core/atomic_file.hpp"

namespace twincell::imaging {

class FilmWriter;

/// \throws ConfigError for a rate of a film outside 0.01 .. 1000, 1/s
void require_frame_rate(double frames_per_second);

/// Writes .mp4 (H.264, or MPEG-4 if this build of OpenCV has no H.264) or .avi (Motion JPEG), 8-bit grey or
/// BGR. An odd width or height is made even by repeating the last column or row. The file appears at
/// commit().
class Movie {
 public:
  /// \param size of the frames, px
  /// \param frames_per_second 0.01 .. 1000, 1/s
  /// \throws ConfigError for another extension or another rate
  /// \throws RunError if the film cannot be opened
  Movie(const std::filesystem::path& file, cv::Size size, double frames_per_second);
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;
  /// \param bits depth of the frame; the upper eight bits are shown
  void add(const cv::Mat& frame, int bits);
  /// Reads the film back, then moves it to its final name.
  /// \throws RunError if a frame is missing
  void commit();

 private:
  AtomicPath place_;
  std::unique_ptr<FilmWriter> writer_;
  cv::Size size_;
  std::size_t frames_ = 0;
};

}  // namespace twincell::imaging
