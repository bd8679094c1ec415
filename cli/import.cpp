// twincell import FILE: converts the output of another program to a trajectory.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>

#include "cli/named_columns.hpp"
#include "cli/output.hpp"
#include "cli/stack_info.hpp"
#include "cli/verb.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "core/plural.hpp"
#include "trajectory/foreign/foreign_trajectory.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/trajectory_doubts.hpp"
#include "trajectory/unit_checks.hpp"

namespace twincell::cli {

namespace {

struct ImportOptions {
  std::string file, output, format;
  std::vector<double> origin;
  std::vector<std::string> columns;
  const CLI::Option *sigma = nullptr, *gravity = nullptr;  ///< of `foreign`
  ForeignOptions foreign;
  std::string source;  ///< word of kOrigins; empty: by the format
};

/// Hands frames on to a writer and watches them.
class WatchedWriter : public TrajectorySink {
 public:
  /// \param writer, info outlive this object
  WatchedWriter(TrajectorySink& writer, const TrajectoryInfo& info) : writer_(writer), doubts_(info) {}
  void append(const Frame& frame) override {
    doubts_.watch(frame);
    writer_.append(frame);
  }
  [[nodiscard]] const TrajectoryDoubts& doubts() const { return doubts_; }

 private:
  TrajectorySink& writer_;
  TrajectoryDoubts doubts_;
};

/// Refuses a file in millimetres, for example, without the diameter of a bead and gravity in its units. Notes
/// that gravity is 1 if a diameter is given.
void require_scale(const ImportOptions& o, const ForeignTrajectory& source, const Common& common) {
  const std::string unit = source.length_unit();
  std::string word = unit;
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 7> kOfNoScale = {"", "sigma", "d", "lj", "pixel", "pixels", "px"};
  const bool has_unit = std::find(kOfNoScale.begin(), kOfNoScale.end(), word) == kOfNoScale.end();
  if (has_unit && o.sigma->count() == 0)
    throw ConfigError(
        {o.file, 0, 0, "--sigma"},
        fmt::format("is missing: the lengths of the file are in {0}, so the bead diameter in {0} is needed.",
                    unit.substr(0, 40)));
  if (o.gravity->count() > 0) return;
  if (has_unit)
    throw ConfigError(
        {o.file, 0, 0, "--gravity"},
        fmt::format(
            "is missing: the lengths of the file are in {0}, so gravity in {0} and {1} is needed, such as "
            "9810 for mm and s.",
            unit.substr(0, 40), source.time_in_seconds() ? "seconds" : "the file's unit of time"));
  if (o.foreign.sigma != 1)
    note(common,
         "gravity is taken as 1 in the units of length and time of the file; --gravity gives another, "
         "such as 9810 for mm and s.");
}

/// Says which numbers the beads have now; empty if they keep those of the file.
std::string new_numbers(const std::vector<std::int64_t>& ids) {
  if (ids.empty() || ids.back() == static_cast<std::int64_t>(ids.size()) - 1)
    return {};  // ascending, distinct
  return fmt::format("the beads {} to {} of the file are numbered 0 to {} here, in this order", ids.front(),
                     ids.back(), ids.size() - 1);
}

/// Notes on units and sizes that no file of beads is likely to have.
void note_doubts(const Common& common, const ForeignTrajectory& source, double sigma) {
  constexpr double kClosest = 0.5, kFarthest = 3;  // sigma
  if (const double d = source.spacing(); std::isfinite(d) && (d < kClosest || d > kFarthest))
    note(common, fmt::format("the nearest neighbours in the first frame are {:.3g} bead diameters apart; the "
                             "bead diameter is {:g} in the unit of the file (--sigma).",
                             d, sigma));
  constexpr double kOverlap = 0.7, kOtherSize = 1.5;
  if (const std::vector<double>& radii = source.info().radius; !radii.empty()) {
    const double wide = 2 * upper_median(radii);
    if (wide > kOtherSize || wide < 1 / kOtherSize)
      note(common,
           fmt::format("by their radii the beads are {:.3g} wide in the unit of the file, but sigma is {:g} "
                       "(--sigma).",
                       wide * sigma, sigma));
    if (source.spacing() < kOverlap * wide)
      note(common,
           fmt::format("the nearest neighbours in the first frame are {:.3g} bead diameters apart and "
                       "overlap, because their radii make them {:.3g} wide: the radii may be diameters.",
                       source.spacing(), wide));
  }
  if (source.n_beyond() > 0)
    note(common, fmt::format("{} of the first frame {} beyond the side walls of the cell, which is {:.4g} "
                             "bead diameters wide (--cell-origin, --cell-width).",
                             plural(source.n_beyond(), "bead"), source.n_beyond() == 1 ? "lies" : "lie",
                             source.info().box.upper.x()));
  if (const double missing = source.missing_frames(); missing > 0)
    note(common,
         fmt::format("the numbers of the steps or frames leave out {:g} {} between the {} of the file.",
                     missing, missing > 1 ? "frames" : "frame", source.n_frames()));
  if (const std::string said = source.assumption(); !said.empty()) note(common, said);
  if (source.replaces_times()) note(common, "the times of the file are replaced by those of --timestep.");
}

/// Enters the options that are not of CLI11's types. \throws ConfigError for those without effect
void set_foreign_options(ImportOptions& o, const ForeignFormat& format) {
  if (!o.origin.empty()) {
    Vec3& corner = o.foreign.origin.emplace(Vec3::Zero());
    for (std::size_t k = 0; k < o.origin.size(); ++k) corner[static_cast<int>(k)] = o.origin[k];
  }
  if (!o.source.empty()) o.foreign.source = row_named(kOrigins, o.source, "--source", "source").value;
  o.foreign.table_columns = named_columns(o.columns);
  const bool is_table = format.word == std::string_view("csv");
  if (!is_table && (!o.columns.empty() || o.foreign.y_up))
    throw ConfigError({"", 0, 0, o.foreign.y_up ? "--y-up" : "--columns"},
                      "applies to tables (--format csv).");
}

void run(ImportOptions& o, const Common& common) {
  if (is_trajectory(o.file))
    throw ConfigError({o.file, 0, 0, ""},
                      "this is a trajectory (H5MD) already; analyze, draw and export read it as it is.");
  const ForeignFormat& format =
      o.format.empty() ? format_of_file(o.file) : foreign_format(o.format, "--format");
  set_foreign_options(o, format);
  ProgressBar reading(common, "reading");
  const ForeignTrajectory source(o.file, format, o.foreign, reading);
  require_scale(o, source, common);
  TrajectoryInfo info = source.info();
  Provenance provenance = common.provenance();
  provenance.inputs.emplace_back(o.file);
  provenance.threads = 1;
  info.provenance_json = provenance.to_json();
  H5mdWriter writer(o.output, info);
  ProgressBar writing(common, "writing");
  WatchedWriter watched(writer, info);
  source.copy_to(watched, writing);
  writer.finish();
  if (info.box.dimension == 3 && source.is_flat())
    note(common, "all beads are in one plane in every frame; for a two-dimensional system: --dimension 2.");
  note_doubts(common, source, o.foreign.sigma);
  for (const std::string& doubt : implausible_numbers(shaken_cell(info.scale, info.drive)))
    note(common, doubt);
  for (const std::string& doubt : watched.doubts().sentences()) note(common, doubt + ".");
  // Some programs count from 1, which the summary says; gaps in the numbers have other causes.
  const std::string numbers = new_numbers(source.ids());
  const bool gaps = !numbers.empty() && source.ids().back() - source.ids().front() + 1 !=
                                            static_cast<std::int64_t>(source.ids().size());
  if (gaps) note(common, numbers + "; --tracers and exports use the new numbers.");
  if (!info.drive) note(common, "no drive was given: the phases and the height of the plate are absent.");
  print_result(
      common,
      {{"output", o.output},
       {"frames", source.n_frames()},
       {"beads", info.n_beads},
       {"source", word_of(info.source)},
       {"missing_beads", info.columns.identity}},
      fmt::format("{} of {}{}\n{}{}\n", plural(source.n_frames(), "frame"), plural(info.n_beads, "bead"),
                  info.columns.identity ? ", not all of them in every frame" : "",
                  numbers.empty() ? "" : numbers + "\n", o.output));
}

/// The file, its format, the output and what the file does not state of its beads.
void add_file_options(CLI::App& verb, Common& common, ImportOptions& o) {
  ForeignOptions& l = o.foreign;
  verb.add_option("file", o.file, "File of the other program")->required();
  std::string formats;
  std::vector<std::string> words;
  for (const ForeignFormat* format : foreign_formats())
    if (format->open != nullptr) {
      formats += fmt::format("{}{}: {}", formats.empty() ? "" : "; ", format->word, format->help);
      words.emplace_back(format->word);
    }
  verb.add_option(
          "--format", o.format,
          fmt::format(
              "Format (docs/formats.md). {}. Default: by the ending of the name, or lammps-dump if the "
              "file begins with 'ITEM:'",
              formats))
      ->check(CLI::IsMember(words))
      ->option_text("WORD");
  verb.add_option(
          "--columns", o.columns,
          "Names of the columns of a table where they differ, as QUANTITY=NAME: frame, particle, x, y, z, "
          "time, radius, diameter, tracer, bead_mass, vx, vy, vz, sigma_x, sigma_y, sigma_z")
      ->option_text("QUANTITY=NAME ...");
  verb.add_flag("--y-up", l.y_up, "y of a table increases upwards; default: downwards, as in a picture");
  writes(common, verb,
         verb.add_option("-o,--output", o.output, "Trajectory file to write (H5MD)")->required(),
         Product::imported_trajectory());
  verb.add_option(
          "--source", o.source,
          "Where the beads come from: simulation, experiment or unknown. The beads of an experiment are "
          "neighbours up to 1.3 diameters, others up to 1.2. Default: by the format")
      ->check(CLI::IsMember(words_of(kOrigins)))
      ->option_text("WORD");
  verb.add_option("--dimension", l.dimension,
                  "Dimension of the system; 2: the plane (x, y) with y upwards; 3: z upwards")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
}

void add_unit_options(CLI::App& verb, ImportOptions& o) {
  ForeignOptions& l = o.foreign;
  verb.add_option("--timestep", l.timestep,
                  "Length of a step, in the time unit of the file; required unless the file contains times. "
                  "All lengths and times below are in the units of the file; times are in seconds if the "
                  "file states a unit such as ms.");
  o.sigma =
      verb.add_option(
              "--sigma", l.sigma,
              "Bead diameter in the unit of the file, the unit of length of the trajectory; required if "
              "the file states a unit such as mm")
          ->capture_default_str();
  o.gravity = verb.add_option("--gravity", l.gravity,
                              "Acceleration of gravity g in the units of the file; required if the file "
                              "states a unit such as mm")
                  ->capture_default_str();
}

void add_cell_options(CLI::App& verb, ImportOptions& o) {
  ForeignOptions& l = o.foreign;
  verb.add_option("--cell-origin", o.origin,
                  "Lower left inside corner of the cell, with the plate at its mean height: x y [z]; "
                  "default: 0, along a periodic axis the lower end of the box")
      ->expected(2, 3)
      ->delimiter(',');
  verb.add_option("--cell-width", l.width,
                  "Distance of the side walls; default: up to the end of the box of the file");
  former_option(verb, "--origin", "--cell-origin");
}

void add_drive_options(CLI::App& verb, ForeignOptions& l) {
  verb.add_option("--drive-amplitude", l.drive.amplitude,
                  "Amplitude A of the plate; without any drive option the drive is unknown");
  verb.add_option("--drive-omega", l.drive.omega, "Angular frequency omega = 2 pi f of the plate");
  former_option(verb, "--drive-frequency", "--drive-omega, with omega = 2 pi f");
  verb.add_option("--drive-gamma", l.drive.gamma, "Drive strength Gamma = A omega^2/g");
  verb.add_option(
          "--drive-axis", l.drive_axis,
          "Direction of the plate motion, in the axes of the trajectory (z upwards): x, y or z; default: z")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Axis>{{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}}))
      ->option_text("AXIS");
  verb.add_option("--frames-per-cycle", l.phases_per_cycle,
                  "Frames per drive cycle; 0 (default): not phase-locked")
      ->check(CLI::Range(0, 1'000'000));
  verb.add_option("--phase-of-step-zero", l.phase_of_step_zero,
                  "Drive phase at step 0, as a fraction of a cycle; 0.75 for a wall with LAMMPS's 'wiggle' "
                  "from step 0 on")
      ->capture_default_str();
}

void add_bead_options(CLI::App& verb, ForeignOptions& l) {
  verb.add_option("--bead-mass", l.bead_mass,
                  "Bead mass m, the unit of the column mass; default: masses are not read");
  verb.add_option("--tracer-type", l.tracer_type,
                  "Type that marks tracers; default: those of the column tracer of a table, otherwise none");
}

}  // namespace

void add_import(CLI::App& program, Common& common) {
  auto o = std::make_shared<ImportOptions>();
  CLI::App& verb =
      add_verb(program, common, "import",
               "Convert the beads of another program, such as a LAMMPS dump or a table of trackpy, to a "
               "trajectory. Writes the trajectory file, in units of the bead diameter and g.",
               "twincell import dump.lammpstrj -o lammps.h5 --timestep 4.44556610e-5 "
               "--drive-amplitude 1.5 --drive-omega 1 --frames-per-cycle 4");
  add_file_options(verb, common, *o);
  add_unit_options(verb, *o);
  add_cell_options(verb, *o);
  add_drive_options(verb, o->foreign);
  add_bead_options(verb, o->foreign);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
