#pragma once
/// \file
/// What the numbers in the names of a folder's pictures show: frames that are missing or doubled, and
/// pictures of several series.

#include <string>
#include <vector>

namespace twincell::imaging::frames {

/// Sorts names in the order of the frames: in natural order, f_2 before f_10. If all numbers have signs and
/// both signs occur, the order is that of the signed numbers: img-40 ... img-01, img+00 ... of a camera that
/// was triggered in the middle of its recording.
void sort_as_frames(std::vector<std::string>& names);

/// Names that do not belong to the frames, such as background.png or overlay.png beside frame_0001.png …: one
/// series has at least eight pictures and nine tenths of all, and the name is alone in its own series, or
/// without a number. A name that the series continues (stack.tif before stack_1.tif) belongs to it.
std::vector<std::string> outside_the_series(const std::vector<std::string>& names);

/// Sentences for the user. The number of a picture is the last run of digits in its name without the
/// extension; what precedes it names the series.
///
/// - Several series of at least two pictures each: two cameras, or two recordings, in one folder.
/// - Numbers that several pictures of a series have: copies, or one frame in two formats.
/// - Numbers that are skipped, if at least three quarters of the steps between neighbours are equal, and all
///   are multiples of that step. Numbers that are times do not step evenly and give no sentence.
/// \param names as sort_as_frames orders them
std::vector<std::string> notes_on_names(const std::vector<std::string>& names);

}  // namespace twincell::imaging::frames
