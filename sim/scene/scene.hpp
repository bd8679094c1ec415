#pragma once
/// \file
/// The scene: contents of the cell, drive, start and time, read from TOML and checked. docs/scene.md
/// describes every key.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "sim/laws/parameters.hpp"
#include "sim/scene/integrators.hpp"
#include "sim/scene/recorded_drive.hpp"
#include "sim/scene/starts.hpp"
#include "sim/system/system.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/trajectory.hpp"
#include "trajectory/units.hpp"

namespace twincell::sim {

/// Boundary of the cell on one side.
enum class Edge { wall, periodic, absent };

/// The contact laws, by their words in the scene, and the tables that contain the parameters of each kind of
/// contact.
struct ContactChoice {
  std::string normal = "linear", tangential = "spring", rolling = "none";
  ContactTable bead;                         ///< bead-bead
  std::map<std::string, ContactTable> wall;  ///< by wall name: bottom, left, right, front, back, lid
};

/// One large bead among the others.
struct Intruder {
  double radius = 2, mass = 1;
  double x = 0, y = 0, z = 0;  ///< initial position, sigma
};

/// Distribution of radii about `radius`; masses scale as R^3 (spheres) or R^2 (discs).
enum class SizeSpread { none, uniform, normal };
/// Largest deviation from `radius`, relative to it, in a distribution of this width. A uniform distribution
/// has its half width; a normal one is truncated on both sides at three standard deviations, or at 0.9 if
/// that is smaller.
double largest_deviation(SizeSpread spread, double width);

/// Gap, in diameters of the largest bead, up to which pairs are listed. A periodic cell must be so wide that
/// no bead comes this close to two images of another.
inline constexpr double kListReach = 0.25;

/// Steps per contact below which a run is refused unless time.allow_unstable_step is true, and below which
/// there is a warning.
inline constexpr double kMinSteps = 6, kFewSteps = 20;

/// Largest seed. Up to this bound every language that reads a provenance represents integers exactly.
inline constexpr std::int64_t kLargestSeed = std::int64_t{1} << 53;

/// Stop criterion of a driven bed: the 95 % interval of a mean is narrow enough. Scene::cycles is then the
/// upper limit of the run.
struct Precision {
  std::string quantity;    ///< "T_z", for example: one of sweep/precision_rule.hpp
  double relative = 0.01;  ///< half of the interval divided by the mean
  double absolute = 0;     ///< half of the interval, in the unit of the quantity; the larger bound applies
};

/// A key of a preset or of a calibration file that has no effect, because the scene selects something else.
struct VoidKey {
  std::string key;     ///< "contact.gamma_n"
  std::string source;  ///< "preset fortini-huang-2015", or the calibration file
  std::string reason;  ///< a sentence

  /// The key, its source and the reason as one sentence, for `explain` and for notes.
  [[nodiscard]] std::string text() const;
};

/// A scene with preset, overrides and defaults applied.
struct Scene {           // NOLINT(clang-analyzer-optin.performance.Padding): in the order of a scene's tables
  std::string file;      ///< for messages
  std::string resolved;  ///< TOML with preset and overrides, without void_keys, for provenance; includes
                         ///< integrator and n even if they are defaults

  // Cell
  int dimension = 2;
  double width = 20;             ///< L_x, sigma
  double depth = 1;              ///< L_y, sigma: period or gap of front and back plates; 3D only
  std::optional<double> height;  ///< of the lid above the plate, sigma; absent: no limit
  Edge sides = Edge::wall;       ///< boundaries along x
  Edge plates = Edge::absent;    ///< boundaries along y, 3D
  Edge bottom = Edge::wall;      ///< periodic: z has period `height` (no gravity along it)
  bool lid = false;  ///< true: a hard lid at `height`; false: a bead that reaches `height` stops the run
  bool bottom_moves = true, side_walls_move = true, plates_move = true, lid_moves = true;
  double left_tilt = 0, right_tilt = 0;  ///< outward tilt of a side wall about its foot, degrees
  Vec3 gravity = -Vec3::UnitZ();
  double plate_drag = 0;  ///< 2D substitute for front and back plates, 1/t0

  // Beads
  std::optional<std::size_t> n_beads;  ///< absent only with a trajectory or table start
  double radius = 0.5, mass = 1;
  double inertia_factor = 0.5;  ///< I = factor m R^2: disc 1/2, sphere 2/5
  SizeSpread spread = SizeSpread::none;
  double spread_width = 0;  ///< standard deviation (normal) or half width (uniform) relative to radius
  std::optional<Intruder> intruder;

  ContactChoice contact;
  double overlap_bound = 0.1;  ///< diameters of the median bead; a deeper overlap stops the run

  // Drive
  Drive drive;
  DriveRecord record;           ///< the file of a recorded drive
  Envelope envelope;            ///< preparation cycles, run before `discard` begins
  std::optional<double> phase;  ///< initial phase of the plate, cycles, 0 <= phase < 1; absent: 0, or that of
                                ///< the frame from which a start in motion continues
  bool comoving = true;         ///< false: beads at rest when the plate starts at full speed

  // Start
  StartKind start = StartKind::crystal_a;
  std::uint64_t seed = 1;
  std::filesystem::path from;  ///< file of a trajectory or table start; relative to the scene's folder
  std::size_t frame = 0;
  bool in_motion = false;  ///< trajectory or table start: velocities, spins and springs are kept, no settling
  double perturbation = 0;    ///< largest seeded random displacement of each coordinate, sigma
  double velocity_scale = 1;  ///< random start: largest speed component, sigma/t0
  /// Random start: the share of the column's area (3D: volume) that the beads take. It decides the height
  /// from which they fall. Absent: 0.4 (3D: 0.25).
  std::optional<double> fraction;
  std::optional<double> column_height;  ///< random start: height of the column instead of the share, sigma
  double fall_speed = 0;                ///< random start: downward speed of every bead at the start, sigma/t0
  double rest_energy = 1e-12;           ///< kinetic energy per bead below which the bed is at rest, m g sigma
  double settle_limit = 100;            ///< longest settling time, t0
  bool relax = false;                   ///< overlaps of any depth are removed first

  // Time
  double steps_per_contact = kDefaultIntegrator.steps_per_contact;
  bool allow_unstable_step = false;                 ///< fewer than kMinSteps steps per contact are allowed
  std::string integrator{kDefaultIntegrator.word};  ///< word of one of kAllIntegrators
  bool integrator_stated = false;                   ///< set by file, preset or command line
  Stepping stepping = Stepping::automatic;
  std::int64_t discard = 10, cycles = 200;
  int phases = 20;
  /// Contact memory is stored with every frame; absent: where contacts are, if a law has memory
  std::optional<bool> springs;
  bool contacts = false;  ///< contact forces are stored with every frame
  std::optional<int>
      samples;  ///< samples per cycle of time averages; 0: none; absent: 400, or two per phase with
                ///< event-driven motion, because the beads of a dilute gas do not land all at once
  std::optional<Precision> until;  ///< checked by the analysis during the run (sweep/measure.hpp)
  Scale scale;

  // Effects that the user allows to omit. The plan refuses to omit an effect that would change the result.
  bool rotation = true, history = true;

  std::filesystem::path calibration;  ///< file that calibration.from names; empty: none
  std::vector<VoidKey> void_keys;     ///< keys of a preset or calibration file without effect

  std::optional<ConfigSection> source;  ///< the text that was read; absent in a scene without text

  /// Position of "section.key" in the scene's file, or where it could be set, for errors that are found only
  /// after reading. If a preset or the command line sets the key, file and key only.
  [[nodiscard]] Where where(const std::string& key) const;
  [[nodiscard]] double g() const { return gravity.norm(); }
  /// Mass of a bead of the same material: proportional to R^2 for discs, R^3 for spheres.
  [[nodiscard]] double mass_of(double bead_radius) const;
  [[nodiscard]] std::array<double, 3> period() const {
    return {sides == Edge::periodic ? width : 0, dimension == 3 && plates == Edge::periodic ? depth : 0,
            bottom == Edge::periodic ? height.value_or(0) : 0};
  }
  /// The files that the scene names; empty where it names none.
  [[nodiscard]] std::vector<std::filesystem::path> named_files() const {
    return {from, record.file, calibration};
  }
  /// The walls of the cell, in the order bottom, left, right, front, back, lid.
  [[nodiscard]] std::vector<Wall> walls() const;
};

/// Where a run of the scene with this number of beads stands in the phase diagram: N_l sigma = N sigma/L_x,
/// Gamma = A omega^2/g (absent without gravity), and the word of the start.
/// \param beads absent: N_l is absent
RunConditions conditions_of(const Scene& scene, std::optional<std::size_t> beads);

}  // namespace twincell::sim
