#pragma once
/// \file
/// From a stack and a cell description to the twin: the experiment's trajectory and simulations that begin
/// from its first packing, in its cell, with its drive.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/output_kind.hpp"
#include "core/progress.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/link/link.hpp"
#include "imaging/locate/locator.hpp"
#include "sim/scene/scene.hpp"
#include "twin/comparison.hpp"

namespace twincell {

struct TwinOptions {
  std::filesystem::path stack, cell_file;
  std::filesystem::path scene;  ///< what the cell does not say (contacts, step); empty: preset of paper 1
  std::vector<std::string> assignments;  ///< "section.key=value", over all else
  /// Simulations. The first begins exactly where the camera saw the beads; each other is shifted, bead by
  /// bead and with its own seed, by the uncertainty of the located positions.
  int twins = 3;
  LocatorOptions locator;
  LinkOptions link;
  int threads = 1;
  bool trust_stated_drive = false;  ///< do not hold the stated drive against the plate in the frames
};

/// Provenance of the files, which only the program can write.
struct TwinProvenance {
  std::function<std::string(const CellDescription&)> of_experiment;
  std::function<std::string(const sim::Scene&, const std::vector<sim::Bead>&)> of_simulation;
};

/// The kind of output that the folder of a match is: several files, and a report in a folder of its own.
inline Product twin_folder() {
  return Product::shared_folder("a match");
}

/// Files of a twin, each written whole or not at all.
struct Twin {
  std::filesystem::path experiment, scene;
  std::vector<std::filesystem::path> simulations;
  double pixels_per_sigma = 0;  ///< the scale, as given or as located
  double position_error = 0;    ///< median uncertainty of a coordinate in the first frame at phase 0, sigma
  std::size_t beads = 0;        ///< in that frame
  std::int64_t cycles = 0;
  std::string drive;  ///< how what the cell does not say of the drive was measured; empty: it says all
};

/// The scene of the twin as TOML: `base` (text of a scene, or empty) with width, sides, drive and scale of
/// the cell, started from frame `frame` of `experiment`, over `cycles` cycles of the cell's phases. \throws
/// ConfigError naming the cell's key that is missing
std::string twin_scene(const std::string& base, const std::string& base_name, const CellDescription& cell,
                       const std::filesystem::path& experiment, std::size_t frame, std::int64_t cycles);

/// Writes experiment.h5, scene.toml and simulation-1.h5 … into `folder`, which is made if it is not there.
/// What the cell does not say of drive and phases is measured on the plate (plate_drive.hpp).
/// \throws ConfigError if the cell description lacks origin or width, the drive is neither stated nor seen,
/// the scene cannot be, or the folder cannot be written to: all before the work; InputError, RunError as
/// track_stack and Simulation
Twin make_twin(const TwinOptions& options, const std::filesystem::path& folder,
               const TwinProvenance& provenance, const ProgressOf& progress);

}  // namespace twincell
