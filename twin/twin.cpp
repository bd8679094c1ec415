#include "twin/twin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/atomic_file.hpp"
#include "core/config.hpp"
#include "core/escape.hpp"
#include "core/median.hpp"
#include "core/output_rules.hpp"
#include "core/plural.hpp"
#include "core/sha256.hpp"
#include "core/toml_leaves.hpp"
#include "imaging/track/bed_in_cell.hpp"
#include "imaging/track/write_trajectory.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene_layers.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/calibration_file.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::twin {
namespace {

namespace fs = std::filesystem;

/// Largest shift that a scene accepts (start.perturbation), sigma.
constexpr double kLargestShift = 0.01;
/// First line of a generated scene, which allows a later run to replace the file.
const char* const kSceneHead = "# The scene of a filmed cell, by twincell match.\n";

constexpr std::string_view kChecksum = "# SHA-256 of the lines below begins with ";
/// Second line of a generated scene: the checksum of the lines below, which shows whether somebody changed
/// them.
std::string checksum_line(const std::string& below) {
  constexpr std::size_t kDigits = 16;
  return std::string(kChecksum) + sha256_of_text(below).substr(0, kDigits) + "\n";
}

/// \throws ConfigError if the folder holds what a match into it would lose or mix with its own results
void require_room(const fs::path& folder, int twins) {
  std::error_code ec;
  const std::string head = kSceneHead;
  if (const fs::path scene = folder / "scene.toml"; fs::is_regular_file(scene, ec)) {
    const std::string text = read_text_file(scene);
    const std::size_t line = text.starts_with(head) ? text.find('\n', head.size()) : std::string::npos;
    // Earlier scenes have no checksum.
    if (line != std::string::npos && text.compare(head.size(), kChecksum.size(), kChecksum) == 0 &&
        text.substr(head.size(), line + 1 - head.size()) != checksum_line(text.substr(line + 1)))
      throw ConfigError({.file = scene.string()},
                        "it has changed since twincell wrote it; move it, or name a new folder.");
  }
  if (const fs::path more = folder / fmt::format("simulation-{}.h5", twins + 1); fs::exists(more, ec))
    throw ConfigError(
        {.file = more.string()},
        "it is a twin of an earlier match with more twins, and would count as one of these; remove "
        "it, or name a new folder.");
}

void require_known(const imaging::CellDescription& cell, const fs::path& file, const fs::path& stack) {
  const auto need = [&](bool known, const char* key, const char* why) {
    if (!known)
      throw ConfigError({.file = file.string(), .key = key},
                        fmt::format("is missing; a twin needs it {}, and twincell new {} -o CELL.toml "
                                    "measures it.",
                                    why, shell_word(stack.string())));
  };
  need(cell.origin.has_value(), "camera.origin_px", "to place the beads over the plate");
  need(cell.width.has_value(), "cell.width", "to place the side walls");
}

std::string word_of_sides(const imaging::CellDescription& cell, const fs::path& file) {
  if (cell.sides != Boundary::open) return sides_word(cell.sides);
  throw ConfigError({.file = file.string(), .key = "cell.sides"},
                    "\"open\" sides cannot be simulated: beads would leave; use \"walls\" or \"periodic\".");
}

/// The first frame at phase 0, from which the twin starts, and its beads.
struct FirstPacking {
  std::size_t frame = 0, beads = 0;
  double position_error = 0;
  std::int64_t cycles = 0;  ///< number of cycles from this frame to the last one
};
FirstPacking find_first_packing(const TrajectorySource& trajectory) {
  FirstPacking b;
  Frame frame;
  for (b.frame = 0; b.frame < trajectory.n_frames(); ++b.frame) {
    trajectory.read(b.frame, frame);
    if (frame.phase == 0) break;
  }
  if (b.frame == trajectory.n_frames())
    throw InputError({.file = trajectory.name()}, "no frame is at phase 0, where a simulation begins.");
  b.beads = frame.n_present();
  if (b.beads == 0)
    throw InputError(
        {.file = trajectory.name()},
        fmt::format(
            "frame {}, the first at phase 0, shows no bead, and the twin would begin with none; "
            "twincell locate STACK --view page.html shows what is located (--refine, --dark, --bright).",
            b.frame));
  std::vector<double> errors;
  for (std::size_t i = 0; i < frame.position_sigma.size(); ++i)
    if (frame.present(i))
      for (const double e : {frame.position_sigma[i].x(), frame.position_sigma[i].z()})
        if (std::isfinite(e)) errors.push_back(e);
  if (!errors.empty()) b.position_error = upper_median(std::move(errors));
  Frame last;
  trajectory.read(trajectory.n_frames() - 1, last);
  b.cycles = std::max<std::int64_t>(1, last.cycle - frame.cycle + 1);
  return b;
}

double mean_height(const std::vector<sim::Bead>& beads) {
  double sum = 0;
  for (const sim::Bead& b : beads) sum += b.z;
  return beads.empty() ? 0 : sum / static_cast<double>(beads.size());
}

/// Simulates a twin. \returns the mean fall of its beads while they settle, sigma
double simulate(const sim::Scene& scene, const fs::path& output, const TwinProvenance& provenance,
                int threads, Progress& progress) {
  sim::RunState start = sim::placed(scene, progress);
  const std::string said = provenance.of_simulation(scene, start.beads);
  // Limit the threads: a small bed on many threads waits for them at every step, and stalls if other programs
  // use the processor.
  const int worth = std::min(threads, sim::threads_for(start.beads.size(), 0));
  sim::Simulation run(scene, std::move(start), sim::SolverKind::best, worth);
  const double height = mean_height(run.system().beads);
  run.settle(progress);
  const double fall = height - mean_height(run.system().beads);
  TrajectoryInfo info = run.trajectory_info();
  info.provenance_json = said;
  H5mdWriter writer(output, std::move(info));
  run.run(writer, progress);
  writer.finish();
  return fall;
}

/// Reads the cell and measures its drive on the plate if the cell states none.
calibration::FilmedCell read_filmed_cell(const TwinOptions& options, const ProgressOf& progress) {
  const imaging::FrameRange range = imaging::frames_of(options.film.locating);
  calibration::FilmedCell filmed = calibration::stated_cell(options.film, range);
  require_known(filmed.cell, options.cell_file(), options.stack);
  (void)word_of_sides(filmed.cell, options.cell_file());
  filmed = calibration::check_beads(std::move(filmed), options.open, options.stack, options.film, progress);
  // Phases from the bed or a list need no lock to the drive.
  const bool locked = filmed.source.method == imaging::PhaseMethod::fixed;
  if (!calibration::lacks_drive(filmed.cell, locked)) return filmed;
  const auto bar = progress("the plate's edge");
  calibration::CompletedDrive completed = calibration::complete_drive(
      std::move(filmed.cell), locked, options.cell_file(), options.stack, range, options.film.threads, *bar);
  return {std::move(completed.cell), std::move(filmed.source), std::move(completed.measured),
          std::move(filmed.found_refiner)};
}

/// The cell with a number of phases. Where the stack determines the phases, their number is not known before
/// it is tracked; any number serves to check a scene.
imaging::CellDescription with_phases(imaging::CellDescription cell) {
  constexpr int kSomePhases = 20;
  if (!cell.phase_lock.locked()) cell.phase_lock.frames_per_cycle = kSomePhases;
  return cell;
}

/// \throws ConfigError if the frames show another drive than the cell states
void require_agreement(const calibration::DriveCheck& check, const TwinOptions& options) {
  if (check.disagreement.empty()) return;
  throw ConfigError(
      {.file = options.cell_file(), .key = "drive"},
      options.stacks_of_cell > 1 && check.by == "plate"
          ? fmt::format(
                "{}; the cell serves {} stacks: leave the strength of the drive out of it, so that "
                "it is measured in each, or give each stack a cell of its own, as twincell new writes.",
                check.disagreement, options.stacks_of_cell)
          : check.disagreement + "; correct one of them, or use --trust-stated-drive.");
}

/// How the bed lies in the cell that is stated. \returns doubts, in sentences
/// \throws ConfigError if it cannot lie there
std::vector<std::string> check_bed_in_cell(const calibration::TrackedFilm& film, const TwinOptions& options) {
  struct Nowhere : TrajectorySink {
    void append(const Frame& /*frame*/) override {}
  } nowhere;
  imaging::BedInCell watched(nowhere, film.plan.info, film.cell, film.stack.width_px, film.stack.height_px);
  imaging::write_trajectory(film.stack, film.plan, watched);
  // A part of the picture need not show the beads at the walls.
  const imaging::LocatingRequest& part = options.film.locating;
  const std::string contradiction = watched.contradiction();
  if (!contradiction.empty() && !options.trust_stated_cell && part.roi.empty() && part.mask.empty())
    throw ConfigError({.file = options.cell_file(), .key = "cell"},
                      contradiction + "; correct it, or use --trust-stated-cell.");
  return watched.doubts();
}

/// Writes the tracked film into `output`.
void write_experiment(calibration::TrackedFilm& film, const fs::path& output,
                      const TwinProvenance& provenance) {
  film.plan.info.provenance_json = provenance.of_experiment(film.cell);
  H5mdWriter writer(output, film.plan.info);
  imaging::write_trajectory(film.stack, film.plan, writer);
  writer.finish();
}

/// Simulates the scene once from the measured positions, and `options.twins` - 1 times from shifted ones.
void simulate_twins(const std::string& scene, Twin& twin, const TwinOptions& options, const fs::path& folder,
                    const TwinProvenance& provenance, const ProgressOf& progress) {
  for (int k = 1; k <= options.twins; ++k) {
    std::vector<std::string> assignments;  // those of the options are in the scene
    if (k > 1) {
      assignments.push_back(fmt::format("start.seed={}", k));
      assignments.push_back(
          fmt::format("start.perturbation={:.9g}", std::min(kLargestShift, twin.position_error)));
    }
    twin.simulations.push_back(folder / fmt::format("simulation-{}.h5", k));
    const sim::Scene read = sim::read_scene_text(scene, twin.scene.string(), assignments, folder);
    const auto bar = progress(fmt::format("simulating twin {}", k));
    const double fall = simulate(read, twin.simulations.back(), provenance, options.film.threads, *bar);
    if (k == 1) twin.fall = fall, twin.discarded = read.discard, twin.cycles = read.cycles;
  }
}

}  // namespace

std::string twin_scene(const std::string& base, const std::string& base_name,
                       const imaging::CellDescription& cell, const fs::path& experiment, std::size_t frame,
                       std::int64_t cycles, const std::vector<std::string>& assignments) {
  const std::string tilt =
      cell.side_tilt && cell.sides == Boundary::wall
          ? fmt::format("side_tilt = [{:.17g}, {:.17g}]\n", (*cell.side_tilt)[0], (*cell.side_tilt)[1])
          : "";
  const std::string stated = fmt::format(
      "[cell]\nwidth = {:.17g}\nsides = \"{}\"\n{}[drive]\namplitude = {:.17g}\nomega = {:.17g}\n{}"
      "[start]\nkind = \"trajectory\"\nfrom = '''{}'''\nframe = {}\n[time]\ndiscard = 0\ncycles = {}\nphases "
      "= {}\n",
      *cell.width, word_of_sides(cell, "the cell"), tilt, cell.drive()->amplitude, cell.drive()->omega,
      cell.harmonics.empty() ? "" : "harmonics = " + harmonics_text(cell.harmonics) + "\n",
      experiment.string(), frame, cycles, cell.phase_lock.frames_per_cycle);
  std::string scale;
  if (cell.scale.sigma_m) scale += fmt::format("sigma_m = {:.17g}\n", *cell.scale.sigma_m);
  if (cell.scale.gravity_m_s2) scale += fmt::format("gravity_m_s2 = {:.17g}\n", *cell.scale.gravity_m_s2);
  Config scene = base_name.empty()
                     ? Config::from_text("preset = \"fortini-huang-2015\"\n", "preset of the twin")
                     : Config::from_text(base, base_name);
  reduce_units(scene);
  // Values of the scene in laboratory units were converted with its own scale, so both scales must agree.
  for (const auto& [key, of_cell] :
       {std::pair{"sigma_m", cell.scale.sigma_m}, std::pair{"gravity_m_s2", cell.scale.gravity_m_s2}}) {
    constexpr double kAgree = 1e-9;
    if (!of_cell || !scene.root().has("scale")) continue;
    const ConfigSection own = scene.root().section("scale");
    if (const auto here = own.number(key); here && std::abs(*here / *of_cell - 1) > kAgree)
      throw ConfigError(
          own.where(key),
          fmt::format("is {:g} and the cell's {} is {:g}; one of them is wrong.", *here, key, *of_cell));
  }
  // The calibration that the cell includes also applies to the contacts of the scene.
  if (!cell.included.file.empty() && !scene.root().has("calibration"))
    scene.assign("calibration.from=" + toml_quoted(fs::absolute(cell.included.file).string()));
  include_calibration(scene, base_name, Includer::scene);
  Config measured =
      Config::from_text(stated + (scale.empty() ? "" : "[scale]\n" + scale), "the cell description");
  scene.yield_to(measured, "drive", {"amplitude", "omega", "frequency", "gamma", "k_m", "peak_velocity"});
  scene.yield_to(measured, "start",
                 {"kind", "from", "frame", "velocity_scale", "fraction", "height", "fall_speed"});
  scene.overlay(std::move(measured));
  sim::assign(scene, assignments);
  return resolved_text(scene);
}

Twin make_twin(const TwinOptions& options, const fs::path& folder, const TwinProvenance& provenance,
               const ProgressOf& progress) {
  // Read and check everything before the stack is tracked.
  calibration::FilmedCell filmed = read_filmed_cell(options, progress);
  Twin twin{.experiment = folder / "experiment.h5", .scene = folder / "scene.toml"};
  twin.drive = filmed.measured_drive;
  const std::string base = options.scene.empty() ? std::string() : read_text_file(options.scene);
  const auto scene_text = [&](const imaging::CellDescription& cell, std::size_t frame, std::int64_t cycles,
                              const std::vector<std::string>& assignments) {
    return twin_scene(base, options.scene.string(), cell, twin.experiment.filename(), frame, cycles,
                      assignments);
  };
  try {
    (void)sim::read_scene_text(scene_text(with_phases(filmed.cell), 0, 1, {}), twin.scene.string(),
                               options.assignments, folder);
  } catch (const ConfigError& e) {
    // The user knows the file that was named, not the scene that is made of it and of the cell.
    if (options.scene.empty() || !std::string(e.what()).starts_with(twin.scene.string())) throw;
    throw ConfigError(
        {.file = options.scene.string()},
        "with the cell's values: " + std::string(e.what()).substr(twin.scene.string().size() + 1));
  }
  require_room(folder, options.twins);
  calibration::DriveCheck check = calibration::check_plate(filmed, options.stack, options.film, progress);
  require_agreement(check, options);

  // Experiment, scene, simulations.
  calibration::FilmOptions of_film = options.film;
  of_film.folder = folder;
  const auto open = [&](const imaging::LocatorOptions& locator) {
    auto frames = options.open(locator);
    unlist_files(claim_shared_folder(folder, twin_folder()));  // for a stack that can be opened
    return frames;
  };
  calibration::TrackedFilm film =
      calibration::track_filmed_cell(open, std::move(filmed), std::move(check), of_film, progress);
  require_agreement(film.check, options);
  const std::vector<std::string> of_bed = check_bed_in_cell(film, options);
  film.cell.phase_lock.frames_per_cycle = film.stack.phases.frames_per_cycle;
  write_experiment(film, twin.experiment, provenance);
  twin.doubts = film.stack.doubts(film.cell);
  if (std::string left_out = film.plan.in_plate_note(); !left_out.empty())
    twin.doubts.push_back(std::move(left_out));
  twin.doubts.insert(twin.doubts.end(), of_bed.begin(), of_bed.end());
  twin.phases = film.stack.phases;
  twin.pixels_per_sigma = film.plan.pixel_frame.pixels_per_sigma;
  const FirstPacking first = find_first_packing(H5mdReader(twin.experiment));
  twin.beads = first.beads;
  twin.cycles = first.cycles;
  twin.position_error = first.position_error;
  if (options.discard >= twin.cycles)
    throw ConfigError({.file = {}, .key = "--discard"},
                      fmt::format("is {}, but {} shows only {}.", options.discard, options.stack.string(),
                                  plural(twin.cycles, "cycle")));
  const std::string below = scene_text(film.cell, first.frame, first.cycles, options.assignments);
  const std::string scene = kSceneHead + checksum_line(below) + below;
  write_text_file(twin.scene, scene, Product::text("a scene", kSceneHead));
  simulate_twins(scene, twin, options, folder, provenance, progress);
  std::vector<std::string> written = {twin.experiment.filename().string()};
  for (const fs::path& simulation : twin.simulations) written.push_back(simulation.filename().string());
  list_files(folder, written);
  return twin;
}

}  // namespace twincell::twin
