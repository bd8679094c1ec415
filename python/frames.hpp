#pragma once
/// \file
/// Frames of pixels between NumPy and the readers of stacks.

#include <memory>
#include <opencv2/core.hpp>

#include "imaging/stack/frame_source.hpp"
#include "python/module.hpp"

namespace twincell::python {

/// A grey picture as an array over the same memory, and the reverse.
/// \throws ConfigError for an array that is not two-dimensional or of another type of numbers
py::array array_of_picture(const cv::Mat& picture);
/// A copy of an array of Python as a picture.
cv::Mat picture_of_array(const py::handle& array);

/// The stack of an argument: the name of a stack, one picture (2-D array), or anything that can be iterated
/// over pictures. Call with the interpreter's lock; the source takes the lock itself where it needs it.
/// \param name receives the name of the stack; empty for pictures in memory
std::unique_ptr<imaging::FrameSource> source_of(const py::object& stack, std::string& name);

/// The stack that is read in C++ where an argument is twincell.Frames, a stack or a slice of it; another
/// argument as it is. A reversed slice is iterated over.
/// \param frames A:B:STEP of the argument, as the option says; becomes that of the stack
py::object stack_of_frames(const py::object& stack, std::string& frames);

}  // namespace twincell::python
