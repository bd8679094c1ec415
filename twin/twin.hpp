#pragma once
/// \file
/// Makes the twin of an experiment from a frame stack and a cell description: the tracked trajectory, and
/// simulations that start from its first packing, in its cell, with its drive.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/film/track_film.hpp"
#include "core/output_kind.hpp"
#include "core/progress.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/phase/phase_lock.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::twin {

/// Options of make_twin.
struct TwinOptions {
  std::filesystem::path stack;
  calibration::FilmOptions film;         ///< with the cell file, which must be named
  calibration::OpenFrames open;          ///< opens the stack to be tracked, with its chosen frames
  std::filesystem::path scene;           ///< contacts, step and the like; empty: preset of paper 1
  std::vector<std::string> assignments;  ///< "section.key=value", override all other settings
  /// Number of simulations. The first starts exactly from the measured positions. In each of the others every
  /// bead is shifted at random, with the simulation's own seed, by the uncertainty of the measured positions.
  int twins = 3;
  bool trust_stated_cell = false;  ///< do not refuse a cell that the bed does not fill
  std::size_t stacks_of_cell = 1;  ///< number of stacks that the cell file serves
  std::int64_t discard = 0;        ///< cycles that the comparison will leave out of both sides

  /// CELL.toml of the stack.
  [[nodiscard]] const std::string& cell_file() const { return film.request.cell_file; }
};

/// Provenance texts of the files, which the command-line program supplies.
struct TwinProvenance {
  std::function<std::string(const imaging::CellDescription&)> of_experiment;
  std::function<std::string(const sim::Scene&, const std::vector<sim::Bead>&)> of_simulation;
};

/// Output kind of a match's folder: several files, and a report in its own subfolder.
inline Product twin_folder() {
  return Product::shared_folder("a match");
}

/// Files and numbers of a twin. Each file is written atomically.
struct Twin {
  std::filesystem::path experiment, scene;
  std::vector<std::filesystem::path> simulations;
  double pixels_per_sigma = 0;  ///< scale, as stated or from the located beads
  double position_error = 0;    ///< median uncertainty of a coordinate in the first frame at phase 0, sigma
  std::size_t beads = 0;        ///< beads in that frame
  std::int64_t cycles = 0;      ///< cycles of the simulations
  std::int64_t discarded = 0;   ///< driven cycles before them that are not recorded
  double fall = 0;              ///< mean fall of the beads of the first packing while they settle, sigma
  std::string drive;            ///< measured drive in a sentence; empty if the cell states the drive
  imaging::PhaseTable phases;   ///< of the stack
  std::vector<std::string> doubts;  ///< TrackedStack::doubts and BedInCell::doubts of the stack

  /// Whether the film begins in mid-motion and the simulations record their way from rest to that motion:
  /// nothing is discarded and the first packing falls by more than 0.1 sigma.
  [[nodiscard]] bool records_transient() const { return discarded == 0 && fall > 0.1; }
};

/// Scene of the twin as TOML: `base` (text of a scene, or empty) with width, sides, drive and scale of the
/// cell. It starts from frame `frame` of `experiment` and lasts `cycles` cycles with the cell's number of
/// phases.
///
/// \param assignments "section.key=value", which override all of these
/// \throws ConfigError for open sides, or a scale that differs from that of the cell
/// \pre the cell states width and drive
std::string twin_scene(const std::string& base, const std::string& base_name,
                       const imaging::CellDescription& cell, const std::filesystem::path& experiment,
                       std::size_t frame, std::int64_t cycles,
                       const std::vector<std::string>& assignments = {});

/// Writes experiment.h5, scene.toml and simulation-1.h5 … into `folder`, which is created if needed. Drive
/// and phases that the cell does not state are measured on the plate (plate_drive.hpp).
/// \throws ConfigError if the cell description lacks origin or width, the drive is neither stated nor
/// measurable, the scene is invalid, or the folder is not writable, all before the tracking, and if the
/// stated drive disagrees with the frames; InputError, RunError as track_stack and Simulation
Twin make_twin(const TwinOptions& options, const std::filesystem::path& folder,
               const TwinProvenance& provenance, const ProgressOf& progress);

}  // namespace twincell::twin
