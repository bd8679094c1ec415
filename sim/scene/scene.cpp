#include "sim/scene/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "core/bounded_list.hpp"
#include "core/key_record.hpp"
#include "sim/laws/axes.hpp"
#include "sim/scene/drive_tables.hpp"
#include "sim/scene/presets.hpp"
#include "trajectory/calibration_file.hpp"
#include "trajectory/recorded_motion.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::sim {

namespace {

using Section = ConfigSection;

/// Tables below [contact], and the walls to which each applies.
const std::vector<std::pair<std::string, std::vector<std::string>>> kWallTables = {
    {"bottom", {"bottom"}}, {"sides", {"left", "right"}}, {"plates", {"front", "back"}}, {"lid", {"lid"}}};

/// Collects keys that the scene does not use. A key that the user wrote is refused. A key from a preset or a
/// calibration file gives way to the user's choice; it is removed and listed in Scene::void_keys.
class Voids {
 public:
  /// \param lower names of the preset and of the calibration file, as they appear in messages
  Voids(Config& config, std::vector<std::string> lower, std::vector<VoidKey>& told)
      : config_(config), lower_(std::move(lower)), told_(told) {}

  /// Refuses keys of something that the scene does not have. \param complaint a sentence
  void refuse(const Section& s, const std::vector<std::string>& keys, const std::string& complaint) {
    std::optional<Where> first;
    for (const auto& key : keys) {
      if (!s.has(key)) continue;
      const Where where = s.where(key);
      if (std::find(lower_.begin(), lower_.end(), where.file) == lower_.end()) {
        if (!first) first = where;
        continue;
      }
      told_.push_back({where.key, where.file, complaint});
      config_.erase(where.key);
    }
    if (first) throw ConfigError(*first, complaint);
  }

 private:
  Config& config_;
  std::vector<std::string> lower_;
  std::vector<VoidKey>& told_;
};

/// "\"linear\"", "\"linear\" or \"hertz\"", "\"a\", \"b\" or \"c\"".
std::string any_of_words(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k)
    text += (k == 0 ? "" : k + 1 == words.size() ? " or " : ", ") + fmt::format("\"{}\"", words[k]);
  return text;
}

template <class Enum>
Enum read_word(const Section& s, const std::string& key, const std::vector<std::string>& words,
               Enum otherwise) {
  const auto v = s.word(key, words);
  return v ? static_cast<Enum>(std::find(words.begin(), words.end(), *v) - words.begin()) : otherwise;
}

bool read_motion(const Section& s, const std::string& key, bool otherwise) {
  const auto v = s.word(key, {"move", "rest"});
  return v ? *v == "move" : otherwise;
}

constexpr double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// Reads gravity and returns the magnitude of g as given, to which Gamma and K_m refer.
double read_gravity(const Section& s, Scene& scene, Voids& voids) {
  const auto tilt = s.number_in("tilt", -45, 45);
  record_key(s.where("gravity").key, {.lengths = {2, 3}});
  if (!s.is_list("gravity")) {
    const double g = s.number_in("gravity", 0).value_or(1), lean = radians(tilt.value_or(0));
    scene.gravity = Vec3(g * std::sin(lean), 0, -g * std::cos(lean));
    if (g == 0 && tilt.value_or(0) != 0) voids.refuse(s, {"tilt"}, "turns gravity, but cell.gravity is 0.");
    return g;
  }
  if (tilt)
    throw ConfigError(s.where("tilt"),
                      "cell.gravity already gives a direction; a tilt is allowed only with a number.");
  if (scene.dimension == 2) {
    const std::vector<double> g = s.numbers("gravity", 2).value();
    scene.gravity = Vec3(g[0], 0, g[1]);
  } else {
    const std::vector<double> g = s.numbers("gravity", 3).value();
    scene.gravity = Vec3(g[0], g[1], g[2]);
  }
  return scene.gravity.norm();
}

void read_side_tilt(const Section& s, Scene& scene) {
  constexpr double kSteepest = 45;
  if (!s.is_list("side_tilt")) {
    scene.left_tilt = scene.right_tilt = s.number_in("side_tilt", -kSteepest, kSteepest).value_or(0);
    return;
  }
  const std::vector<double> both = numbers_in(s, "side_tilt", 2, -kSteepest, kSteepest).value();
  scene.left_tilt = both[0];
  scene.right_tilt = both[1];
}

double read_cell(const Section& s, Scene& scene, Voids& voids) {
  scene.dimension = static_cast<int>(s.integer_in("dimension", 2, 3).value_or(scene.dimension));
  scene.width = s.number_in("width", 0, 1e6, true).value_or(scene.width);
  scene.height = s.number_in("height", 0, 1e9, true);
  scene.sides = read_word(s, "sides", {"walls", "periodic", "absent"}, scene.sides);
  scene.bottom = read_word(s, "bottom", {"wall", "periodic", "absent"}, scene.bottom);
  scene.lid = read_word(s, "lid", {"absent", "wall"}, scene.lid ? 1 : 0) == 1;
  if (scene.dimension == 2) {
    voids.refuse(s, {"depth", "plates", "plates_motion"}, "a 2D cell has no depth; set cell.dimension = 3.");
    scene.plate_drag = s.number_in("plate_drag", 0).value_or(scene.plate_drag);
  } else {
    voids.refuse(s, {"plate_drag"},
                 "stands in for the front and back plates of a 2D cell; in 3D use cell.plates.");
    const auto depth = s.number_in("depth", 0, 1e6, true);
    if (!depth) throw ConfigError(s.where("depth"), "a 3D cell needs its depth.");
    scene.depth = *depth;
    scene.plates = read_word(s, "plates", {"walls", "periodic", "absent"}, Edge::wall);
  }
  scene.bottom_moves = read_motion(s, "bottom_motion", scene.bottom_moves);
  scene.side_walls_move = read_motion(s, "side_walls", scene.side_walls_move);
  scene.plates_move = read_motion(s, "plates_motion", scene.plates_move);
  scene.lid_moves = read_motion(s, "lid_motion", scene.lid_moves);
  read_side_tilt(s, scene);
  if (scene.bottom != Edge::wall) voids.refuse(s, {"bottom_motion"}, "the cell has no bottom wall.");
  if (scene.sides != Edge::wall) voids.refuse(s, {"side_walls", "side_tilt"}, "the cell has no side walls.");
  if (scene.plates != Edge::wall) voids.refuse(s, {"plates_motion"}, "the cell has no front and back walls.");
  if (!scene.lid) voids.refuse(s, {"lid_motion"}, "the cell has no lid; set cell.lid = \"wall\".");
  return read_gravity(s, scene, voids);
}

void read_intruder(const Section& s, Scene& scene, Voids& voids) {
  if (!s.has("radius") && !s.has("mass") && !s.has("x") && !s.has("y") && !s.has("z")) return;
  Intruder intruder;
  const auto radius = s.number_in("radius", 0, 1e6, true), z = s.number("z");
  if (!radius) throw ConfigError(s.where("radius"), "an intruder needs its radius.");
  if (!z) throw ConfigError(s.where("z"), "an intruder needs the height at which it starts.");
  intruder.radius = *radius;
  intruder.mass = s.number_in("mass", 0, 1e12, true).value_or(scene.mass_of(intruder.radius));
  intruder.x = s.number("x").value_or(scene.width / 2);
  if (scene.dimension == 2) voids.refuse(s, {"y"}, "a 2D cell has no y.");
  intruder.y = scene.dimension == 3 ? s.number("y").value_or(scene.depth / 2) : 0;
  intruder.z = *z;
  scene.intruder = intruder;
}

void read_beads(const Section& s, Scene& scene, Voids& voids) {
  constexpr std::int64_t kMost = 10'000'000;
  scene.radius = s.number_in("radius", 0, 1e6, true).value_or(scene.radius);
  scene.mass = s.number_in("mass", 0, 1e12, true).value_or(scene.mass);
  const auto inertia = s.word("inertia", {"disc", "sphere"});
  if (scene.dimension == 3 && inertia && *inertia == "disc")
    throw ConfigError(s.where("inertia"), "beads of a 3D cell are spheres.");
  scene.inertia_factor = inertia ? (*inertia == "disc" ? 0.5 : 0.4) : scene.dimension == 3 ? 0.4 : 0.5;
  const auto count = s.integer_in("count", 0, kMost);
  const auto layers = s.number_in("layers", 0, 1e6);
  if (count) scene.n_beads = static_cast<std::size_t>(*count);
  if (layers) {
    if (count) throw ConfigError(s.where("layers"), "contradicts 'count': only one of the two can be given.");
    const double d = 2 * scene.radius;
    const double beads =
        std::round(*layers * scene.width / d * (scene.dimension == 3 ? scene.depth / d : 1.0));
    if (!(beads <= static_cast<double>(kMost)))
      throw ConfigError(s.where("layers"),
                        fmt::format("{:g} layers are {:g} beads, the bound is {}.", *layers, beads, kMost));
    if (*layers > 0 && beads < 1)
      throw ConfigError(s.where("layers"), fmt::format("{:g} layers are less than one bead.", *layers));
    scene.n_beads = static_cast<std::size_t>(beads);
  }
  scene.spread = read_word(s, "spread", {"none", "uniform", "normal"}, scene.spread);
  const auto width = s.number_in("spread_width", 0, std::nullopt);
  if (width && *width >= 0.5)
    throw ConfigError(s.where("spread_width"),
                      fmt::format("{} is out of range; the value must be less than 0.5.", *width));
  if (scene.spread == SizeSpread::none)
    voids.refuse(s, {"spread_width"}, "is the width of a size distribution, but beads.spread is \"none\".");
  else if (!width)
    throw ConfigError(s.where("spread"), "needs beads.spread_width.");
  scene.spread_width = width.value_or(0);
  read_intruder(s.section("intruder"), scene, voids);
}

/// Refuses a word of versions before 0.2; the message names the present word.
void refuse_former_word(const Section& s, const std::string& key, const std::string& former,
                        const std::string& now) {
  if (const auto word = s.text(key); word && *word == former)
    throw ConfigError(s.where(key), fmt::format("\"{}\" is now called \"{}\".", former, now));
}
/// Refuses a key of versions before 0.2. \param now what to write instead
void refuse_former_key(const Section& s, const std::string& key, const std::string& now) {
  if (s.has(key)) throw ConfigError(s.where(key), fmt::format("is a former key; write {}.", now));
}

/// Refuses law keys that the chosen laws do not read, because their values would be ignored.
void refuse_unread(const Section& table, const ContactChoice& laws, Voids& voids) {
  const std::vector<std::string> read = keys_of(laws.normal, laws.tangential, laws.rolling);
  for (const std::string& key : all_law_keys()) {
    if (!table.has(key) || std::find(read.begin(), read.end(), key) != read.end()) continue;
    const KeyReaders readers = readers_of(key);
    const std::string& law = readers.axis == "normal"       ? laws.normal
                             : readers.axis == "tangential" ? laws.tangential
                                                            : laws.rolling;
    // Smooth beads may be given as tangential = "none", as mu = 0, or as both.
    if (key == "mu" && law == NoTangential::kWord && table.number(key) == 0.0) continue;
    voids.refuse(table, {key},
                 fmt::format("the law contact.{} = \"{}\" does not read it; {} would.", readers.axis, law,
                             any_of_words(readers.laws)));
  }
}

void read_contact(const Section& s, Scene& scene, Voids& voids) {
  ContactChoice& c = scene.contact;
  refuse_former_word(s, "normal", "linear-clipped", "linear-no-tension");
  refuse_former_word(s, "normal", "falling-restitution", "velocity-dependent-restitution");
  refuse_former_word(s, "tangential", "spring-only", "spring-limited");
  refuse_former_key(s, "tension", "contact.normal = \"linear\" or \"linear-no-tension\"");
  refuse_former_key(s, "slip", "contact.tangential = \"spring\", \"spring-limited\" or \"force-clipped\"");
  c.normal = s.word("normal", normal_words()).value_or(c.normal);
  c.tangential = s.word("tangential", tangential_words()).value_or(c.tangential);
  c.rolling = s.word("rolling", rolling_words()).value_or(c.rolling);
  scene.overlap_bound = s.number_in("overlap_bound", 0, 0.5, true).value_or(scene.overlap_bound);

  const Section walls = s.section("wall");
  const auto only_numbers = [&](const Section& table) {
    voids.refuse(
        table, {"normal", "tangential", "rolling"},
        "all contacts follow the same kinds of law, named in [contact]; their parameters may differ here "
        "(mu = 0 makes a smooth wall).");
  };
  only_numbers(walls);
  if (c.tangential == NoTangential::kWord && c.rolling != NoRolling::kWord) {
    voids.refuse(
        s, {"rolling"},
        fmt::format("is \"{}\", but contact.tangential is \"{}\": without friction beads do not turn, "
                    "and nothing resists their rolling; choose a tangential law, or rolling = \"{}\".",
                    c.rolling, c.tangential, NoRolling::kWord));
    c.rolling = NoRolling::kWord;
  }
  c.bead = ContactTable({s});
  refuse_unread(s, c, voids);
  refuse_unread(walls, c, voids);
  for (const auto& [table, names] : kWallTables) {
    const Section own = s.section(table);
    only_numbers(own);
    refuse_unread(own, c, voids);
    for (const auto& name : names) c.wall[name] = ContactTable({own, walls, s});
  }
}

void read_schedule(const Section& s, Envelope& envelope) {
  const auto points = s.pairs("schedule");
  if (!points) return;
  const Where where = s.where("schedule");
  for (std::size_t k = 0; k < points->size(); ++k) {
    const auto& [cycle, factor] = (*points)[k];
    require_range(where, cycle, 0, 1e6);
    require_range(where, factor, 0, 1e6);
    if (k > 0 && !(cycle > (*points)[k - 1].first))
      throw ConfigError(
          where, fmt::format("cycles must increase, but {:g} follows {:g}.", cycle, (*points)[k - 1].first));
  }
  if (points->back().second != 1)
    throw ConfigError(where, fmt::format("the last factor is {:g}; it must be 1, the drive that is recorded.",
                                         points->back().second));
  envelope.points = *points;
}

void read_record(const Section& s, const std::filesystem::path& folder, Scene& scene) {
  if (const auto file = s.text("file")) {
    if (file->empty())
      throw ConfigError(s.where("file"), "is empty; it names a file of times and displacements.");
    scene.record.file = folder / *file;
  }
  scene.record.repeats = s.boolean("repeat").value_or(false);
  scene.record.sha256 = s.text("file_sha256").value_or("");
  scene.record.cutoff = s.number_in("cutoff", 0, std::nullopt, true).value_or(0);
  if (scene.record.file.empty()) {
    if (scene.record.repeats)
      throw ConfigError(s.where("repeat"), "repeats a record, but drive.file names none.");
    if (!scene.record.sha256.empty())
      throw ConfigError(s.where("file_sha256"), "is the digest of a record, but drive.file names none.");
    if (scene.record.cutoff > 0)
      throw ConfigError(s.where("cutoff"), "smooths a record, but drive.file names none.");
  } else if (!scene.drive.harmonics.empty()) {
    throw ConfigError(s.where("harmonics"), "contradicts drive.file: the record contains all harmonics.");
  }
}

DriveSpec read_drive(const Section& s, const std::filesystem::path& folder, Scene& scene) {
  const DriveSpec spec = read_drive_spec(s);
  scene.drive.axis = read_word(s, "axis", {"x", "y", "z"}, Axis::z);
  if (scene.dimension == 2 && scene.drive.axis == Axis::y)
    throw ConfigError(s.where("axis"), "a 2D cell cannot be driven along y.");
  const std::string start = s.word("start", {"comoving", "abrupt", "ramp"}).value_or("comoving");
  scene.comoving = start != "abrupt";
  scene.phase = s.number_in("phase", 0, 1);
  if (scene.phase == 1)
    throw ConfigError(s.where("phase"), "1 is out of range; the value must be less than 1.");
  scene.drive.harmonics = read_harmonics(s);
  scene.drive.horizontal = read_horizontal(s);
  read_record(s, folder, scene);
  read_schedule(s, scene.envelope);
  const auto ramp = s.number_in("ramp_cycles", 0, 1e6, true);
  if (start == "ramp") {
    if (!scene.envelope.points.empty())
      throw ConfigError(s.where("schedule"), "contradicts 'start': a ramp is a schedule of its own.");
    scene.envelope.points = {{0, 0}, {ramp.value_or(10), 1}};
  } else if (ramp) {
    throw ConfigError(s.where("ramp_cycles"), "is given, but drive.start is not \"ramp\".");
  }
  return spec;
}

void read_start(const Section& s, const std::filesystem::path& folder, Scene& scene, Voids& voids) {
  if (const auto kind = s.word("kind", words_of(kStarts)))
    scene.start = row_named(kStarts, *kind, "start.kind", "start").value;
  const StartRow& row = start_row(scene.start);
  scene.seed = static_cast<std::uint64_t>(s.integer_in("seed", 0, kLargestSeed).value_or(1));
  if (const auto v = s.text("from"); v && !v->empty()) scene.from = folder / *v;
  scene.frame = static_cast<std::size_t>(s.integer_in("frame", 0, std::int64_t{1} << 40).value_or(0));
  scene.perturbation = s.number_in("perturbation", 0, 0.01).value_or(scene.perturbation);
  scene.velocity_scale = s.number_in("velocity_scale", 0, 1e6).value_or(scene.velocity_scale);
  // Random placement becomes slow near its limit, 0.547 of the area in 2D and 0.38 of the volume in 3D.
  scene.fraction = s.number_in("fraction", 1e-3, scene.dimension == 2 ? 0.5 : 0.35);
  scene.rest_energy = s.number_in("rest_energy", 0, std::nullopt, true).value_or(scene.rest_energy);
  scene.settle_limit = s.number_in("settle_limit", 0, 1e6).value_or(scene.settle_limit);
  scene.relax = s.boolean("relax").value_or(scene.relax);
  scene.in_motion = s.boolean("in_motion").value_or(scene.in_motion);
  if (row.from_file && scene.from.empty())
    throw ConfigError(s.where("from"),
                      fmt::format("a start from a {} needs the name of its file.", row.word));
  const auto only_for = [&](bool StartRow::*property) {
    std::vector<std::string> words;
    for (const StartRow& start : kStarts)
      if (start.*property) words.emplace_back(start.word);
    return any_of_words(words);
  };
  if (!row.from_file) {
    voids.refuse(s, {"from"},
                 fmt::format("a file is named, but start.kind is not {}.", only_for(&StartRow::from_file)));
    voids.refuse(s, {"in_motion"},
                 fmt::format("keeps the motion of a file's beads, but start.kind is not {}.",
                             only_for(&StartRow::from_file)));
  }
  if (scene.in_motion) {
    voids.refuse(s, {"rest_energy", "settle_limit"},
                 "applies to a bed that settles, but start.in_motion keeps it moving.");
    voids.refuse(s, {"relax"}, "moves beads, but start.in_motion continues from their positions.");
  }
  if (!row.has_frames)
    voids.refuse(s, {"frame"},
                 fmt::format("a frame is named, but start.kind is not {}.", only_for(&StartRow::has_frames)));
  if (!row.draws) {
    voids.refuse(s, {"velocity_scale"},
                 fmt::format("sets the speeds of a random start, but start.kind is not {}.",
                             only_for(&StartRow::draws)));
    voids.refuse(s, {"fraction"},
                 fmt::format("sets the column of a random start, but start.kind is not {}.",
                             only_for(&StartRow::draws)));
  }
}

/// Beads of a table have the sizes of its column, or all the same size.
void refuse_void_spread(const Section& beads, const Scene& scene, Voids& voids) {
  if (start_row(scene.start).sets_radii && scene.spread != SizeSpread::none)
    voids.refuse(beads, {"spread", "spread_width"},
                 "radii are not drawn for the beads of a table; its column \"radius\" contains them.");
}

/// Versions before 0.2 had a choice of precision. Files that state "double" remain valid.
void refuse_single_precision(const Section& s) {
  if (const auto word = s.text("precision"); word && *word != "double")
    throw ConfigError(s.where("precision"),
                      fmt::format("\"{}\" is not supported; this version computes only in \"double\" "
                                  "(single precision saved no time); remove the key.",
                                  *word));
}

void read_time(const Section& s, Scene& scene) {
  refuse_former_key(s, "force", "allow_unstable_step = true");
  scene.allow_unstable_step = s.boolean("allow_unstable_step").value_or(scene.allow_unstable_step);
  const auto integrator = s.word("integrator", integrator_words());
  scene.integrator_stated = integrator.has_value();
  scene.integrator = integrator.value_or(std::string(kDefaultIntegrator.word));
  scene.steps_per_contact =
      s.number_in("steps_per_contact", scene.allow_unstable_step ? 1 : kFewestSteps, 1e6)
          .value_or(integrator_named(scene.integrator).steps_per_contact);
  refuse_former_word(s, "stepping", "flights", "event-driven");
  if (const auto stepping = s.word("stepping", words_of(kSteppings)))
    scene.stepping = row_named(kSteppings, *stepping, "time.stepping", "stepping").value;
  refuse_single_precision(s);
  scene.discard = s.integer_in("discard", 0, 1'000'000).value_or(scene.discard);
  scene.cycles = s.integer_in("cycles", 1, 100'000'000).value_or(scene.cycles);
  scene.phases = static_cast<int>(s.integer_in("phases", 1, 10'000).value_or(scene.phases));
  scene.springs = s.boolean("springs").value_or(scene.springs);
  scene.contacts = s.boolean("contacts").value_or(scene.contacts);
  if (const auto samples = s.integer_in("samples", 0, 1'000'000)) scene.samples = static_cast<int>(*samples);
}

void read_until(const Section& s, Scene& scene) {
  if (!s.has("quantity") && !s.has("relative_error") && !s.has("absolute_error")) return;
  const auto quantity = s.text("quantity");
  if (!quantity)
    throw ConfigError(s.where("quantity"), "is missing; it names the mean to which the error bound applies.");
  Precision until{.quantity = *quantity};
  until.relative = s.number_in("relative_error", 0, 1, true).value_or(until.relative);
  until.absolute = s.number_in("absolute_error", 0, 1e12).value_or(until.absolute);
  scene.until = until;
}

void read_effects(const Section& s, Scene& scene) {
  scene.rotation = s.boolean("rotation").value_or(true);
  scene.history = s.boolean("history").value_or(true);
}

void read_scale(const Section& s, Scene& scene) {
  scene.scale.sigma_m = s.number_in("sigma_m", 0, std::nullopt, true);
  scene.scale.gravity_m_s2 = s.number_in("gravity_m_s2", 0, std::nullopt, true);
}

/// Extents of the cell along x, y, z where a boundary limits it; 0: open.
std::array<double, 3> limited_extent(const Scene& s) {
  const bool capped = s.lid || s.bottom == Edge::periodic;
  return {s.sides == Edge::absent ? 0 : s.width, s.dimension == 2 || s.plates == Edge::absent ? 0 : s.depth,
          capped ? s.height.value_or(0) : 0};
}

constexpr const char* kExtentKeys[] = {"width", "depth", "height"};

void check_height(const Scene& s, const Section& cell) {
  if (s.lid && s.bottom == Edge::periodic)
    throw ConfigError(cell.where("lid"), "contradicts cell.bottom: a cell periodic along z has no lid.");
  if (s.lid && !s.height) throw ConfigError(cell.where("height"), "a lid needs its height.");
  if (s.bottom == Edge::periodic && !s.height)
    throw ConfigError(cell.where("height"), "a cell periodic along z needs its period, the height.");
}

void check_sizes(const Scene& s, const Section& cell, const Section& beads) {
  const double largest = s.radius * (1 + largest_deviation(s.spread, s.spread_width));
  const double intruder = s.intruder ? s.intruder->radius : 0;
  const auto extent = limited_extent(s), period = s.period();
  for (std::size_t a = 0; a < 3; ++a) {
    if (extent[a] == 0) continue;
    // The tolerance admits a bed that just fits, whatever the rounding.
    const double slack = 1e-9 * extent[a];
    if (2 * largest > extent[a] + slack)
      throw ConfigError(
          beads.where("radius"),
          fmt::format("a bead of diameter {:g} does not fit into a cell {:g} {}.", 2 * largest, extent[a],
                      a == 0   ? "wide"
                      : a == 1 ? "deep"
                               : "high"));
    if (2 * intruder > extent[a] + slack)
      throw ConfigError(beads.where("intruder.radius"),
                        fmt::format("an intruder of diameter {:g} does not fit into a cell {:g} {}.",
                                    2 * intruder, extent[a],
                                    a == 0   ? "wide"
                                    : a == 1 ? "deep"
                                             : "high"));
    if (period[a] == 0) continue;
    const double reach = largest + std::max(largest, intruder) + kListReach * 2 * std::max(largest, intruder);
    if (period[a] < 2 * reach)
      throw ConfigError(
          cell.where(kExtentKeys[a]),
          fmt::format("a bead would meet two images of another: a period of {:g} is less than {:g}, twice "
                      "the reach of the pair list.",
                      period[a], 2 * reach));
  }
}

void check_intruder(const Scene& s, const Section& beads) {
  if (!s.intruder) return;
  const Section table = beads.section("intruder");
  if (start_row(s.start).from_file)
    throw ConfigError(table.where(""),
                      "a file contains all beads, including the intruder; remove this table.");
  const Vec3 r(s.intruder->x, s.intruder->y, s.intruder->z);
  for (const Wall& wall : s.walls()) {
    const double outside = s.intruder->radius - (wall.n.dot(r) - wall.offset);
    if (outside > 1e-9 * s.intruder->radius)
      throw ConfigError(table.where(""),
                        fmt::format("the intruder at ({:g}, {:g}, {:g}) reaches {:.3g} into the wall \"{}\".",
                                    r.x(), r.y(), r.z(), outside, wall.name));
  }
}

void check_gravity(const Scene& s, const Section& cell) {
  const Where where = cell.where("gravity");
  if (s.g() == 0) {
    const char* open = s.sides == Edge::absent                        ? "sides are open"
                       : s.dimension == 3 && s.plates == Edge::absent ? "front and back are open"
                       : s.bottom == Edge::absent                     ? "bottom is open"
                       : s.bottom == Edge::wall && !s.lid             ? "top is open"
                                                                      : nullptr;
    if (open != nullptr)
      throw ConfigError(where, fmt::format("without gravity beads leave the cell for ever: its {}.", open));
    return;
  }
  // A periodic axis has no wall. Beads that gravity presses against another wall may then slide along that
  // axis.
  const auto walls = s.walls();
  if (std::none_of(walls.begin(), walls.end(), [&](const Wall& w) { return w.n.dot(s.gravity) < 0; }))
    throw ConfigError(
        where,
        fmt::format("no wall supports the beads, which gravity ({:g}, {:g}, {:g}) accelerates for ever.",
                    s.gravity.x(), s.gravity.y(), s.gravity.z()));
}

void check_horizontal(const Scene& s, const Section& drive) {
  const Where where = drive.where("horizontal");
  if (s.drive.axis != Axis::z)
    throw ConfigError(where, "is a motion along x beside that along z, but drive.axis is not \"z\".");
  if (s.drive.recorded) throw ConfigError(where, "contradicts drive.file: a record has one direction.");
}

void check_ramp(const Scene& s, const Section& drive) {
  if (s.until)
    throw ConfigError(
        drive.where("ramp"),
        "contradicts [until]: no mean converges while the drive changes; remove one of the two.");
  const bool goes_on = s.in_motion || s.phase.value_or(0) > 0;
  if (s.drive.ramp->changes_frequency() && s.drive.ramp->first == 0 && goes_on)
    throw ConfigError(drive.where("ramp"),
                      "changes the frequency, and the drive begins within a cycle; set time.discard to at "
                      "least 1, so that the ramp begins with a whole cycle.");
}

void check_drive(const Scene& s, const Section& drive) {
  const auto walls = s.walls();
  if (s.drive.moves() && std::none_of(walls.begin(), walls.end(), [](const Wall& w) { return w.moves; }))
    throw ConfigError(drive.where(""), "moves nothing: no wall rides with the plate.");
  if (s.drive.horizontal) check_horizontal(s, drive);
  if (s.drive.ramp) check_ramp(s, drive);
}

void check_contact_tables(const Scene& s, const Section& contact) {
  const auto walls = s.walls();
  for (const auto& [table, names] : kWallTables) {
    const auto& name = names.front();
    if (contact.has(table) &&
        std::none_of(walls.begin(), walls.end(), [&](const Wall& w) { return w.name == name; }))
      throw ConfigError(contact.where(table), "the cell has no such wall.");
  }
  if (walls.empty() && contact.has("wall"))
    throw ConfigError(contact.where("wall"), "the cell has no walls.");
}

/// Reads and checks the tables of a resolved scene.
/// \param lower names of the preset and of the calibration file, whose keys give way
Scene interpret(Config& config, const std::string& name, const std::filesystem::path& folder,
                std::vector<std::string> lower) {
  Scene scene;
  scene.file = name;
  std::erase(lower, name);  // a scene with such a name is the user's own file
  Voids voids(config, std::move(lower), scene.void_keys);
  // Reading: in this order, since later tables depend on the dimension, the cell and the start.
  const Section root = config.root(), cell = root.section("cell"), beads = root.section("beads"),
                contact = root.section("contact"), drive = root.section("drive");
  scene.source = root;
  static_cast<void>(root.text("preset"));
  const double g = read_cell(cell, scene, voids);
  read_beads(beads, scene, voids);
  read_contact(contact, scene, voids);
  const DriveSpec spec = read_drive(drive, folder, scene);
  const std::optional<RampSpec> ramp = read_ramp(drive);
  read_start(root.section("start"), folder, scene, voids);
  read_time(root.section("time"), scene);
  read_until(root.section("until"), scene);
  read_scale(root.section("scale"), scene);
  read_effects(root.section("effects"), scene);
  refuse_void_spread(beads, scene, voids);
  // Unknown keys come first: a misspelt key is often the reason why another one is missing.
  config.refuse_unknown_keys();
  const ContactChoice& laws = scene.contact;
  check_laws(laws.normal, laws.tangential, laws.rolling, laws.bead);
  for (const auto& [wall, table] : laws.wall) check_laws(laws.normal, laws.tangential, laws.rolling, table);
  const Drive solved = scene.record.file.empty()
                           ? solve_drive(spec, g, drive.where(""), scene.drive.axis)
                           : recorded_drive(scene.record, spec, g, scene.scale, drive, scene.drive.axis);
  scene.drive.amplitude = solved.amplitude;
  scene.drive.omega = solved.omega;
  scene.drive.recorded = solved.recorded;
  if (scene.g() > 0) scene.drive.gravity = scene.g();
  if (ramp)
    scene.drive.ramp = make_ramp(*ramp, scene.drive, spec, g, cycles_before(scene.envelope, scene.discard),
                                 scene.cycles, drive);
  const bool from_file = start_row(scene.start).from_file;
  if (!scene.n_beads && !from_file)
    throw ConfigError(beads.where("count"), "the number of beads is missing.");
  // Checks that involve several tables.
  check_height(scene, cell);
  check_sizes(scene, cell, beads);
  check_intruder(scene, beads);
  check_gravity(scene, cell);
  check_drive(scene, drive);
  check_contact_tables(scene, contact);
  // Stored scenes, checkpoints and points of a sweep keep their integrator and n, even if later versions
  // change the defaults.
  const Section time = root.section("time");
  if (!time.has("integrator")) config.assign(fmt::format("time.integrator={}", scene.integrator));
  if (!time.has("steps_per_contact"))
    config.assign(fmt::format("time.steps_per_contact={}", scene.steps_per_contact));
  // The same scene with another record is another run.
  if (scene.drive.recorded && !drive.has("file_sha256"))
    config.assign("drive.file_sha256=" + scene.drive.recorded->info().sha256);
  scene.resolved = resolved_text(config);
  return scene;
}

const std::vector<std::string>& drive_words() {
  static const std::vector<std::string> words = {"amplitude", "omega", "frequency",
                                                 "gamma",     "k_m",   "peak_velocity"};
  return words;
}

std::size_t count_drive_words(const Config& config) {
  const Section drive = config.root().section("drive");
  return static_cast<std::size_t>(std::count_if(drive_words().begin(), drive_words().end(),
                                                [&](const std::string& word) { return drive.has(word); }));
}

/// Removes from `lower` the amplitude of the drive, however it is stated, if `upper` names a record: its
/// motion has an amplitude of its own, which a stated one would scale.
void yield_to_record(Config& lower, const Config& upper) {
  if (!upper.root().section("drive").has("file")) return;
  for (const char* key :
       {"file_sha256", "repeat", "cutoff", "cutoff_per_t0", "cutoff_hz", "harmonics", "amplitude",
        "amplitude_sigma", "amplitude_mm", "gamma", "peak_acceleration_g", "peak_acceleration_m_s2", "k_m",
        "peak_velocity", "peak_velocity_v0", "peak_velocity_mm_s"})
    lower.erase(std::string("drive.") + key);
}

/// Removes keys from `lower` that `upper` replaces by an equivalent key: restitution replaces gamma_n, layers
/// the count, frequency omega.
void displace(Config& lower, const Config& upper) {
  for (const char* section : {"contact", "contact.wall"})
    for (const auto& group : {normal_damping_keys(), tangential_damping_keys()})
      lower.yield_to(upper, section, group);
  lower.yield_to(upper, "beads", {"count", "layers"});
  lower.yield_to(upper, "drive", {"omega", "frequency"});
}

/// Applies assignments to a scene. An assigned K_m replaces a Gamma of the scene, and the amplitude of a
/// scene that states amplitude and frequency; assignments that contradict each other are refused later.
void assign(Config& config, const std::vector<std::string>& assignments) {
  Config upper = Config::from_text("", "--set");
  for (const auto& assignment : assignments) {
    upper.assign(assignment);
    displace_spellings(config, assignment);
  }
  displace(config, upper);
  yield_to_record(config, upper);
  config.yield_to(upper, "drive", {"gamma", "k_m", "peak_velocity"});
  config.yield_to(upper, "drive.ramp", {"amplitude", "gamma", "k_m", "peak_velocity"});
  config.yield_to(upper, "drive.ramp", {"omega", "frequency"});
  displace_third_quantity(config, assignments);
  for (const auto& assignment : assignments) config.assign(assignment);
}

/// Magnitude of `cell.gravity`, in units of scale.gravity_m_s2; 1 if it is not stated.
double stated_gravity(const Config& config) {
  const Section root = config.root();
  if (!root.has("cell") || !root.section("cell").has("gravity")) return 1;
  const Section cell = root.section("cell");
  if (!cell.is_list("gravity")) return cell.number("gravity").value_or(1);
  const bool planar = cell.integer("dimension").value_or(2) == 2;
  double squares = 0;
  const std::vector<double> components = cell.numbers("gravity", planar ? 2 : 3).value();
  for (const double g : components) squares += g * g;
  return std::sqrt(squares);
}

/// Gamma refers to the gravity of the cell, and so do accelerations in m/s^2.
void refer_to_gravity(Config& config) {
  for (const std::string table : {"drive", "drive.ramp"}) {
    const std::string key = table + ".peak_acceleration_m_s2";
    Section at = config.root();
    bool stated = at.has("drive");
    if (stated) at = at.section("drive");
    if (stated && table != "drive") {
      stated = at.has("ramp");
      if (stated) at = at.section("ramp");
    }
    if (!stated || !at.has("peak_acceleration_m_s2")) continue;
    const double gravity = stated_gravity(config);
    if (gravity > 0 && gravity != 1)
      config.restate(key, key, at.number_in("peak_acceleration_m_s2", 0).value() / gravity);
  }
}

Scene resolve(Config config, const std::string& name, const std::vector<std::string>& assignments,
              const std::filesystem::path& folder) {
  assign(config, assignments);
  refer_to_gravity(config);
  reduce_units(config);
  const Included included = include_calibration(config, name, Includer::scene);
  const Section root = config.root();
  const auto preset = root.word("preset", preset_names());
  std::vector<std::string> lower;
  if (!included.file.empty()) lower.push_back(included.file.string());
  const auto scene_of = [&](Config& whole) {
    Scene scene = interpret(whole, name, folder, lower);
    scene.calibration = included.file;
    return scene;
  };
  if (!preset) return scene_of(config);
  const auto& all = presets();
  const auto chosen = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.first == *preset; });
  lower.push_back("preset " + *preset);
  Config base = Config::from_text(chosen->second, lower.back());
  displace(base, config);
  yield_to_record(base, config);
  // Two measured quantities, or a stated and a measured one, define the whole drive.
  if (std::any_of(included.taken.begin(), included.taken.end(),
                  [](const std::string& taken) { return taken.starts_with("drive."); }) &&
      count_drive_words(config) >= 2)
    base.yield_to(config, "drive", drive_words());
  base.overlay(std::move(config));
  return scene_of(base);
}

}  // namespace

double largest_deviation(SizeSpread spread, double width) {
  switch (spread) {
    case SizeSpread::none:
      return 0;
    case SizeSpread::uniform:
      return width;
    case SizeSpread::normal:
      break;
  }
  return std::min(3 * width, 0.9);
}

std::string VoidKey::text() const {
  return fmt::format("{} of {} has no effect: {}", key, source, reason);
}

Where Scene::where(const std::string& key) const {
  const Where at = source ? source->where(key) : Where{};
  return at.file == file ? at : Where{file, 0, 0, key};
}

double Scene::mass_of(double bead_radius) const {
  return mass * std::pow(bead_radius / radius, inertia_factor == 0.5 ? 2 : 3);
}

std::vector<Wall> Scene::walls() const {
  std::vector<Wall> all;
  if (bottom == Edge::wall) all.push_back({Vec3::UnitZ(), 0, bottom_moves, "bottom"});
  if (sides == Edge::wall) {
    const double left = radians(left_tilt), right = radians(right_tilt);
    all.push_back({Vec3(std::cos(left), 0, std::sin(left)), 0, side_walls_move, "left"});
    all.push_back(
        {Vec3(-std::cos(right), 0, std::sin(right)), -width * std::cos(right), side_walls_move, "right"});
  }
  if (dimension == 3 && plates == Edge::wall) {
    all.push_back({Vec3::UnitY(), 0, plates_move, "front"});
    all.push_back({-Vec3::UnitY(), -depth, plates_move, "back"});
  }
  if (lid) all.push_back({-Vec3::UnitZ(), -height.value_or(0), lid_moves, "lid"});
  return all;
}

RunConditions conditions_of(const Scene& scene, std::optional<std::size_t> beads) {
  RunConditions conditions{.n_l = {}, .gamma = {}, .start = std::string(start_row(scene.start).word)};
  if (beads) conditions.n_l = static_cast<double>(*beads) / scene.width;
  if (scene.g() > 0 && !scene.drive.ramp) conditions.gamma = scene.drive.gamma();
  return conditions;
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& preset : presets()) names.push_back(preset.first);
  return names;
}

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& assignments) {
  return resolve(Config::from_file(path), path.string(), assignments, path.parent_path());
}

Scene read_scene_text(const std::string& text, const std::string& name,
                      const std::vector<std::string>& assignments, const std::filesystem::path& folder) {
  return resolve(Config::from_text(text, name), name, assignments, folder);
}

}  // namespace twincell::sim
