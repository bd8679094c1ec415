#pragma once
/// \file
/// The scene as data: what is in the cell, read from TOML and checked. Every key: docs/scene.md.

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
#include "sim/system/system.hpp"
#include "trajectory/drive.hpp"
#include "trajectory/units.hpp"

namespace twincell::sim {

/// What limits the cell on one side.
enum class Edge { wall, periodic, absent };

/// The laws that contacts follow, by the words of the scene, and where each kind of contact finds its
/// parameters.
struct ContactChoice {
  std::string normal = "linear", tangential = "spring", rolling = "none";
  ContactTable bead;                         ///< bead-bead
  std::map<std::string, ContactTable> wall;  ///< by name of the wall: bottom, left, right, front, back, lid
};

/// One large bead among the others.
struct Intruder {
  double radius = 2, mass = 1;
  double x = 0, y = 0, z = 0;  ///< where it starts, sigma
};

/// How radii are spread about `radius`; masses follow as R^3 (spheres) or R^2 (discs).
enum class SizeSpread { none, uniform, normal };
/// Largest deviation from `radius`, relative to it, that a spread of this width admits: the half width of a
/// uniform one; a normal one is cut on both sides at three standard deviations, or at 0.9 if that is nearer.
double largest_deviation(SizeSpread spread, double width);

/// Gap, in diameters of the largest bead, up to which pairs are listed: a periodic cell must be wide enough
/// that no bead comes so near to two images of another.
inline constexpr double kListReach = 0.25;

/// Steps per contact below which a run is refused, unless forced, and below which it is warned.
inline constexpr double kFewestSteps = 6, kFewSteps = 20;

/// Largest seed: up to here a whole number is the same in every language that reads a provenance.
inline constexpr std::int64_t kLargestSeed = std::int64_t{1} << 53;

enum class StartKind { crystal_a, crystal_b, random, trajectory, table };

/// When a driven bed has been watched for long enough: the 95 % interval of a mean is narrow. Scene::cycles
/// is then the most that are run.
struct Precision {
  std::string quantity;    ///< "T_z": one of those that sweep/precision_rule.hpp knows
  double relative = 0.01;  ///< half of the interval over the mean
  double absolute = 0;     ///< or half of the interval, in the quantity's unit; the larger bound counts
};

/// A key of a preset or of a calibration file that nothing reads, since the scene chose otherwise.
struct VoidKey {
  std::string key;     ///< "contact.gamma_n"
  std::string source;  ///< "preset fortini-huang-2015", or the calibration file
  std::string reason;  ///< a sentence

  /// The whole as one sentence, for `explain` and for notes.
  [[nodiscard]] std::string text() const;
};

struct Scene {           // NOLINT(clang-analyzer-optin.performance.Padding): in the order of a scene's tables
  std::string file;      ///< for messages
  std::string resolved;  ///< TOML with preset and overrides, without void_keys, for provenance; integrator
                         ///< and n stand in it even where nobody stated them

  // Cell
  int dimension = 2;
  double width = 20;             ///< L_x, sigma
  double depth = 1;              ///< L_y, sigma: period or gap of front and back plates; 3D only
  std::optional<double> height;  ///< of the lid above the plate, sigma; absent: never reached
  Edge sides = Edge::wall;       ///< across x
  Edge plates = Edge::absent;    ///< across y, 3D
  Edge bottom = Edge::wall;      ///< periodic: z has period `height` (no gravity along it)
  bool lid = false;  ///< true: a hard lid at `height`; false: a bead that reaches `height` stops the run
  bool bottom_moves = true, side_walls_move = true, plates_move = true, lid_moves = true;
  double left_tilt = 0, right_tilt = 0;  ///< degrees by which a side wall leans outward, about its foot
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
  double overlap_bound = 0.1;  ///< diameters of the usual bead; a deeper overlap stops the run

  // Drive
  Drive drive;
  Envelope envelope;            ///< preparation: cycles run before `discard` begins
  std::optional<double> phase;  ///< cycles, 0 <= phase < 1: where in its cycle the plate begins; absent: 0,
                                ///< or that of the frame that a start in motion goes on from
  bool comoving = true;         ///< false: beads at rest when the plate starts at full speed

  // Start
  StartKind start = StartKind::crystal_a;
  std::uint64_t seed = 1;
  std::filesystem::path from;  ///< trajectory or table start; a relative one is below the scene's folder
  std::size_t frame = 0;
  bool in_motion =
      false;  ///< trajectory or table start: velocities, spins and springs are kept, nothing settles
  double perturbation = 0;     ///< seeded random displacement of every bead, sigma
  double velocity_scale = 1;   ///< random start: largest speed component, sigma/t0
  double rest_energy = 1e-12;  ///< kinetic energy per bead that counts as rest, m g sigma
  double settle_limit = 100;   ///< t0
  bool relax = false;          ///< overlaps of any depth are pushed apart first

  // Time
  double steps_per_contact = kDefaultIntegrator.steps_per_contact;
  bool allow_unstable_step = false;  ///< fewer than kFewestSteps steps per contact are run all the same
  std::string integrator{kDefaultIntegrator.word};  ///< of kAllIntegrators
  bool integrator_stated = false;                   ///< by file, preset or command line
  Stepping stepping = Stepping::automatic;
  std::int64_t discard = 10, cycles = 200;
  int phases = 20;
  bool springs = false;  ///< what contacts remember is stored with every frame
  std::optional<int>
      samples;  ///< a cycle, of what is averaged over time in the run; 0: none; absent: 400, and two a
                ///< phase where beads fly, for a dilute gas does not land all at once
  std::optional<Precision>
      until;  ///< observed by the analysis that runs while the run goes on (sweep/measure.hpp)
  Scale scale;

  // What need not be computed, says the user; the plan refuses what would change the answer.
  bool rotation = true, history = true;

  std::vector<VoidKey> void_keys;  ///< what of a preset or a calibration file does not act

  std::optional<ConfigSection> source;  ///< what was read; absent in a scene that no text stands for

  /// Where "section.key" stands in the scene's file, or where it could, for complaints about what is only
  /// known after reading; file and key alone if a preset or the command line says it.
  [[nodiscard]] Where where(const std::string& key) const;
  [[nodiscard]] double g() const { return gravity.norm(); }
  /// Mass of a bead of the same material: as R^2 for discs, R^3 for spheres.
  [[nodiscard]] double mass_of(double bead_radius) const;
  [[nodiscard]] std::array<double, 3> period() const {
    return {sides == Edge::periodic ? width : 0, dimension == 3 && plates == Edge::periodic ? depth : 0,
            bottom == Edge::periodic ? height.value_or(0) : 0};
  }
  /// The walls that the edges ask for, in the order bottom, left, right, front, back, lid.
  [[nodiscard]] std::vector<Wall> walls() const;
};

/// Reads a scene. A key `preset` names one of preset_names(); the file's own keys win over it.
/// \param assignments "section.key=value", over all else
/// Every key must be read: one that the chosen laws, start or cell do not read is refused, or, if a preset or
/// a calibration file brought it, is left out and named in Scene::void_keys. \throws InputError if the file
/// is missing; ConfigError naming file, line, key, value and bound
Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& assignments = {});
/// The same from text. \param folder where a relative start.from begins; empty: the working directory
Scene read_scene_text(const std::string& text, const std::string& name,
                      const std::vector<std::string>& assignments = {},
                      const std::filesystem::path& folder = {});

std::vector<std::string> preset_names();

}  // namespace twincell::sim
