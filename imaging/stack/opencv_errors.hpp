#pragma once
/// \file
/// Errors of OpenCV and of the FFmpeg in it: silences their stderr output and finds the reason of exceptions.

#include <exception>
#include <optional>
#include <string>

namespace twincell::imaging {

/// Silences OpenCV and its FFmpeg on stderr. Call before the first picture or film is opened, since the log
/// level of FFmpeg is read only once.
void quiet_opencv();

/// Reason of an OpenCV error, without source file and line.
struct OpencvError {
  std::string what;
  bool out_of_memory = false;
};

/// The OpenCV error that `e` reports; absent if `e` is not an exception of OpenCV.
std::optional<OpencvError> opencv_error(const std::exception& e);

}  // namespace twincell::imaging
