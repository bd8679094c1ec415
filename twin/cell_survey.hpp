#pragma once
/// \file
/// Survey of a stack of which nothing is known: bead size and polarity, walls, plate, rotation and
/// distortion, and the motion of the plate, each with its standard error, or the reason why it was not
/// measured.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera/cell_geometry.hpp"
#include "calibration/camera/size_statistics.hpp"
#include "calibration/drive/drive_fit.hpp"
#include "core/progress.hpp"
#include "imaging/disc/detection.hpp"
#include "imaging/refine/refiner.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell::twin {

/// NotMeasured::what where the period of the plate is not a whole number of frames.
inline constexpr const char* kFramesPerCycle = "the number of frames per cycle";

/// A quantity that the stack does not give.
struct NotMeasured {
  std::string what;    ///< "the plate's motion"
  std::string why;     ///< clause: "the stack has one frame"
  std::string remedy;  ///< clause that names the verb, option or key that gives it
};

/// Options of survey_cell.
struct SurveyOptions {
  double diameter_px = 0;       ///< bead diameter; 0: found
  std::optional<double> gamma;  ///< of the drive, if known: where no plate is seen, it places the phases
  int threads = 1;
};

/// What a stack shows of its cell. Lengths in px.
struct CellSurvey {
  std::filesystem::path stack;
  imaging::StackInfo info;
  cv::Size size;
  std::size_t n_frames = 0;      ///< readable frames
  std::string unreadable;        ///< message of the frame at which reading ended; empty: all were read
  bool bright = false;           ///< beads are brighter than the background
  double diameter_px = 0;        ///< bead diameter of the locator; 0: no beads were found
  bool diameter_stated = false;  ///< by SurveyOptions
  std::string refine = imaging::RefineOptions{}.method;  ///< the refiner that suits the discs
  std::vector<double> other_diameters_px;                ///< of discs of further sizes
  std::optional<calibration::SizeStatistics> beads;
  std::optional<imaging::Aspect> aspect;  ///< height over width of the beads in the picture
  std::optional<calibration::CellGeometry> geometry;
  std::optional<calibration::DriveFit> drive;       ///< motion of the plate; times in frames
  std::optional<calibration::Estimate> plate_row;   ///< mean height of the plate, row of the ideal picture
  bool walls_of_bed = false, plate_of_bed = false;  ///< from the beads that touch them, not from their edges
  std::optional<double> frame_rate_hz;    ///< of the stamps or of the stack; not the playback rate of a video
  std::optional<double> playback_hz;      ///< frame rate that a video states
  std::size_t frame = 0;                  ///< number of the frame below
  cv::Mat picture;                        ///< a frame that shows beads, else the first one
  std::vector<imaging::Detection> discs;  ///< the beads in it
  std::vector<NotMeasured> missing;
  std::vector<std::string> notes;  ///< sentences of the stack and of the fits

  [[nodiscard]] bool has_walls() const { return geometry && geometry->has_left && geometry->has_right; }
};

/// Measures what the stack shows. Frames after an unreadable one, or after one of another size, are left out.
/// The plate counts as seen only if at least 90 % of the frames show it and no bead is below it by a third of
/// a diameter. Where no plate or no side wall is seen, they are taken from the beads that touch them.
/// \throws InputError if the stack cannot be opened or its first frame cannot be read
CellSurvey survey_cell(const std::filesystem::path& stack, const SurveyOptions& options,
                       const ProgressOf& progress);

}  // namespace twincell::twin
