#pragma once
/// \file
/// What OpenCV, and FFmpeg in it, say of themselves becomes our sentences: on stderr, and in exceptions.

#include <exception>
#include <optional>
#include <string>

namespace twincell {

/// Silences both. Call before the first picture or film is opened: FFmpeg's level is read once.
void quiet_opencv();

/// What went wrong in OpenCV, without its file and line.
struct OpencvError {
  std::string what;
  bool out_of_memory = false;
};

/// Absent if the exception is none of OpenCV's.
std::optional<OpencvError> opencv_error(const std::exception& e);

}  // namespace twincell
