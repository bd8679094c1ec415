#include "sim/scene/read_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "core/bounded_list.hpp"
#include "core/key_record.hpp"
#include "sim/laws/law_words.hpp"
#include "sim/laws/rolling/none.hpp"
#include "sim/laws/tangential/none.hpp"
#include "sim/scene/drive_tables.hpp"
#include "trajectory/recorded_motion.hpp"

namespace twincell::sim {

const std::vector<std::pair<std::string, std::vector<std::string>>>& wall_tables() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> tables = {
      {"bottom", {"bottom"}}, {"sides", {"left", "right"}}, {"plates", {"front", "back"}}, {"lid", {"lid"}}};
  return tables;
}

namespace {

using Section = ConfigSection;

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

/// Reads gravity and returns the magnitude of g as given, to which Gamma and K_m refer.
double read_gravity(const Section& s, Scene& scene, VoidKeys& void_keys) {
  const auto tilt = s.number_in("tilt", -45, 45);
  record_key(s.where("gravity").key, {.lengths = {2, 3}});
  if (!s.is_list("gravity")) {
    const double g = s.number_in("gravity", 0).value_or(1), lean = tilt.value_or(0) * std::numbers::pi / 180;
    scene.gravity = Vec3(g * std::sin(lean), 0, -g * std::cos(lean));
    if (g == 0 && tilt.value_or(0) != 0)
      void_keys.refuse(s, {"tilt"}, "turns gravity, but cell.gravity is 0.");
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
  constexpr double kMaxTilt_deg = 45;
  if (!s.is_list("side_tilt")) {
    scene.left_tilt = scene.right_tilt = s.number_in("side_tilt", -kMaxTilt_deg, kMaxTilt_deg).value_or(0);
    return;
  }
  const std::vector<double> both = numbers_in(s, "side_tilt", 2, -kMaxTilt_deg, kMaxTilt_deg).value();
  scene.left_tilt = both[0];
  scene.right_tilt = both[1];
}

}  // namespace

double read_cell(const Section& s, Scene& scene, VoidKeys& void_keys) {
  scene.dimension = static_cast<int>(s.integer_in("dimension", 2, 3).value_or(scene.dimension));
  scene.width = s.number_in("width", 0, 1e6, true).value_or(scene.width);
  scene.height = s.number_in("height", 0, 1e9, true);
  scene.sides = read_word(s, "sides", {"walls", "periodic", "absent"}, scene.sides);
  scene.bottom = read_word(s, "bottom", {"wall", "periodic", "absent"}, scene.bottom);
  scene.lid = read_word(s, "lid", {"absent", "wall"}, scene.lid ? 1 : 0) == 1;
  if (scene.dimension == 2) {
    void_keys.refuse(s, {"depth", "plates", "plates_motion"},
                     "a 2D cell has no depth; set cell.dimension = 3.");
    scene.plate_drag = s.number_in("plate_drag", 0).value_or(scene.plate_drag);
  } else {
    void_keys.refuse(s, {"plate_drag"},
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
  if (scene.bottom != Edge::wall) void_keys.refuse(s, {"bottom_motion"}, "the cell has no bottom wall.");
  if (scene.sides != Edge::wall)
    void_keys.refuse(s, {"side_walls", "side_tilt"}, "the cell has no side walls.");
  if (scene.plates != Edge::wall)
    void_keys.refuse(s, {"plates_motion"}, "the cell has no front and back walls.");
  if (!scene.lid) void_keys.refuse(s, {"lid_motion"}, "the cell has no lid; set cell.lid = \"wall\".");
  return read_gravity(s, scene, void_keys);
}

namespace {

void read_intruder(const Section& s, Scene& scene, VoidKeys& void_keys) {
  if (!s.has("radius") && !s.has("mass") && !s.has("x") && !s.has("y") && !s.has("z")) return;
  Intruder intruder;
  const auto radius = s.number_in("radius", 0, 1e6, true), z = s.number("z");
  if (!radius) throw ConfigError(s.where("radius"), "an intruder needs its radius.");
  if (!z) throw ConfigError(s.where("z"), "an intruder needs the height at which it starts.");
  intruder.radius = *radius;
  intruder.mass = s.number_in("mass", 0, 1e12, true).value_or(scene.mass_of(intruder.radius));
  intruder.x = s.number("x").value_or(scene.width / 2);
  if (scene.dimension == 2) void_keys.refuse(s, {"y"}, "a 2D cell has no y.");
  intruder.y = scene.dimension == 3 ? s.number("y").value_or(scene.depth / 2) : 0;
  intruder.z = *z;
  scene.intruder = intruder;
}

}  // namespace

void read_beads(const Section& s, Scene& scene, VoidKeys& void_keys) {
  constexpr std::int64_t kMaxBeads = 10'000'000;
  scene.radius = s.number_in("radius", 0, 1e6, true).value_or(scene.radius);
  scene.mass = s.number_in("mass", 0, 1e12, true).value_or(scene.mass);
  const auto inertia = s.word("inertia", {"disc", "sphere"});
  if (scene.dimension == 3 && inertia && *inertia == "disc")
    throw ConfigError(s.where("inertia"), "beads of a 3D cell are spheres.");
  scene.inertia_factor = inertia ? (*inertia == "disc" ? 0.5 : 0.4) : scene.dimension == 3 ? 0.4 : 0.5;
  const auto count = s.integer_in("count", 0, kMaxBeads);
  const auto layers = s.number_in("layers", 0, 1e6);
  if (count) scene.n_beads = static_cast<std::size_t>(*count);
  if (layers) {
    if (count) throw ConfigError(s.where("layers"), "contradicts 'count': only one of the two can be given.");
    const double d = 2 * scene.radius;
    const double beads =
        std::round(*layers * scene.width / d * (scene.dimension == 3 ? scene.depth / d : 1.0));
    if (!(beads <= static_cast<double>(kMaxBeads)))
      throw ConfigError(s.where("layers"), fmt::format("{:g} layers are {:g} beads, the bound is {}.",
                                                       *layers, beads, kMaxBeads));
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
    void_keys.refuse(s, {"spread_width"},
                     "is the width of a size distribution, but beads.spread is \"none\".");
  else if (!width)
    throw ConfigError(s.where("spread"), "needs beads.spread_width.");
  scene.spread_width = width.value_or(0);
  read_intruder(s.section("intruder"), scene, void_keys);
}

namespace {

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
void refuse_unread(const Section& table, const ContactChoice& laws, VoidKeys& void_keys) {
  const std::vector<std::string> read = keys_of(laws.normal, laws.tangential, laws.rolling);
  for (const std::string& key : all_law_keys()) {
    if (!table.has(key) || std::find(read.begin(), read.end(), key) != read.end()) continue;
    const KeyReaders readers = readers_of(key);
    const std::string& law = readers.axis == "normal"       ? laws.normal
                             : readers.axis == "tangential" ? laws.tangential
                                                            : laws.rolling;
    // Smooth beads may be given as tangential = "none", as mu = 0, or as both.
    if (key == "mu" && law == NoTangential::kWord && table.number(key) == 0.0) continue;
    void_keys.refuse(table, {key},
                     fmt::format("the law contact.{} = \"{}\" does not read it; {} would.", readers.axis, law,
                                 any_of_words(readers.laws)));
  }
}

/// Refuses keys of [contact.wall] that the own tables of all walls of the cell state.
void refuse_replaced(const Section& contact, const Section& walls, const Scene& scene, VoidKeys& void_keys) {
  std::vector<std::string> own;
  for (const auto& [table, names] : wall_tables())
    if (std::ranges::any_of(scene.walls(), [&](const Wall& w) { return w.name == names.front(); }))
      own.push_back(table);
  if (own.empty()) return;
  for (const std::string& key : all_law_keys())
    if (walls.has(key) &&
        std::ranges::all_of(own, [&](const std::string& table) { return contact.section(table).has(key); }))
      void_keys.refuse(walls, {key},
                       fmt::format("all walls of the cell have their own: [contact.{}].",
                                   fmt::join(own, "] and [contact.")));
}

}  // namespace

void read_contact(const Section& s, Scene& scene, VoidKeys& void_keys) {
  ContactChoice& c = scene.contact;
  refuse_former_word(s, "normal", "linear-clipped", "linear-no-tension");
  refuse_former_word(s, "normal", "falling-restitution", "velocity-dependent-restitution");
  refuse_former_word(s, "tangential", "spring-only", "spring-limited");
  refuse_former_key(s, "tension", "contact.normal = \"linear\" or \"linear-no-tension\"");
  refuse_former_key(s, "slip", "contact.tangential = \"spring\", \"spring-limited\" or \"force-clipped\"");
  c.normal = s.word("normal", normal_words()).value_or(c.normal);
  c.tangential = s.word("tangential", tangential_words()).value_or(c.tangential);
  c.rolling = s.word("rolling", rolling_words()).value_or(c.rolling);
  scene.overlap_bound = s.number_in("overlap_bound", 1e-6, 0.5).value_or(scene.overlap_bound);

  const Section walls = s.section("wall");
  const auto only_numbers = [&](const Section& table) {
    void_keys.refuse(
        table, {"normal", "tangential", "rolling"},
        "all contacts follow the same kinds of law, named in [contact]; their parameters may differ here "
        "(mu = 0 makes a smooth wall).");
  };
  only_numbers(walls);
  if (c.tangential == NoTangential::kWord && c.rolling != NoRolling::kWord) {
    void_keys.refuse(
        s, {"rolling"},
        fmt::format("is \"{}\", but contact.tangential is \"{}\": without friction beads do not turn, "
                    "and nothing resists their rolling; choose a tangential law, or rolling = \"{}\".",
                    c.rolling, c.tangential, NoRolling::kWord));
    c.rolling = NoRolling::kWord;
  }
  c.bead = ContactTable({s});
  refuse_unread(s, c, void_keys);
  refuse_unread(walls, c, void_keys);
  for (const auto& [table, names] : wall_tables()) {
    const Section own = s.section(table);
    only_numbers(own);
    refuse_unread(own, c, void_keys);
    for (const auto& name : names) c.wall[name] = ContactTable({own, walls, s});
  }
  refuse_replaced(s, walls, scene, void_keys);
}

namespace {

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

}  // namespace

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

void read_start(const Section& s, const std::filesystem::path& folder, Scene& scene, VoidKeys& void_keys) {
  if (const auto kind = s.word("kind", words_of(kStarts)))
    scene.start = row_named(kStarts, *kind, "start.kind", "start").value;
  const StartRow& row = start_row(scene.start);
  scene.seed = static_cast<std::uint64_t>(s.integer_in("seed", 0, kLargestSeed).value_or(1));
  if (const auto v = s.text("from"); v && !v->empty()) scene.from = folder / *v;
  scene.frame = static_cast<std::size_t>(s.integer_in("frame", 0, std::int64_t{1} << 40).value_or(0));
  scene.perturbation = s.number_in("perturbation", 0, 0.01).value_or(scene.perturbation);
  scene.velocity_scale = s.number_in("velocity_scale", 0, 1e6).value_or(scene.velocity_scale);
  scene.fraction = s.number_in("fraction", 1e-3, largest_fraction(scene.dimension));
  scene.column_height = s.number_in("height", 0, 1e6, true);
  scene.fall_speed = s.number_in("fall_speed", 0, 1e6).value_or(scene.fall_speed);
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
    void_keys.refuse(
        s, {"from"},
        fmt::format("a file is named, but start.kind is not {}.", only_for(&StartRow::from_file)));
    void_keys.refuse(s, {"in_motion"},
                     fmt::format("keeps the motion of a file's beads, but start.kind is not {}.",
                                 only_for(&StartRow::from_file)));
  }
  if (scene.in_motion) {
    void_keys.refuse(s, {"rest_energy", "settle_limit"},
                     "applies to a bed that settles, but start.in_motion keeps it moving.");
    void_keys.refuse(s, {"relax"}, "moves beads, but start.in_motion continues from their positions.");
  }
  if (!row.has_frames)
    void_keys.refuse(
        s, {"frame"},
        fmt::format("a frame is named, but start.kind is not {}.", only_for(&StartRow::has_frames)));
  if (!row.draws) {
    void_keys.refuse(s, {"velocity_scale"},
                     fmt::format("sets the speeds of a random start, but start.kind is not {}.",
                                 only_for(&StartRow::draws)));
    void_keys.refuse(s, {"fall_speed"},
                     fmt::format("sets the speed of a random start, but start.kind is not {}.",
                                 only_for(&StartRow::draws)));
    void_keys.refuse(s, {"fraction", "height"},
                     fmt::format("sets the column of a random start, but start.kind is not {}.",
                                 only_for(&StartRow::draws)));
  }
  if (scene.fraction && scene.column_height)
    void_keys.refuse(s, {"height"}, "sets the column of a random start, and so does start.fraction.");
}

void refuse_void_spread(const Section& beads, const Scene& scene, VoidKeys& void_keys) {
  if (start_row(scene.start).sets_radii && scene.spread != SizeSpread::none)
    void_keys.refuse(beads, {"spread", "spread_width"},
                     "radii are not drawn for the beads of a table; its column \"radius\" contains them.");
}

namespace {

/// Versions before 0.2 had a choice of precision. Files that state "double" remain valid.
void refuse_single_precision(const Section& s) {
  if (const auto word = s.text("precision"); word && *word != "double")
    throw ConfigError(s.where("precision"),
                      fmt::format("\"{}\" is not supported; this version computes only in \"double\" "
                                  "(single precision saved no time); remove the key.",
                                  *word));
}

}  // namespace

void read_time(const Section& s, Scene& scene) {
  refuse_former_key(s, "force", "allow_unstable_step = true");
  scene.allow_unstable_step = s.boolean("allow_unstable_step").value_or(scene.allow_unstable_step);
  const auto integrator = s.word("integrator", integrator_words());
  scene.integrator_stated = integrator.has_value();
  scene.integrator = integrator.value_or(std::string(kDefaultIntegrator.word));
  scene.steps_per_contact = s.number_in("steps_per_contact", scene.allow_unstable_step ? 1 : kMinSteps, 1e6)
                                .value_or(integrator_named(scene.integrator).steps_per_contact);
  refuse_former_word(s, "stepping", "flights", "event-driven");
  if (const auto stepping = s.word("stepping", words_of(kSteppings)))
    scene.stepping = row_named(kSteppings, *stepping, "time.stepping", "stepping").value;
  refuse_single_precision(s);
  scene.discard = s.integer_in("discard", 0, 1'000'000).value_or(scene.discard);
  scene.cycles = s.integer_in("cycles", 1, 100'000'000).value_or(scene.cycles);
  scene.phases = static_cast<int>(s.integer_in("phases", 1, 10'000).value_or(scene.phases));
  if (const auto springs = s.boolean("springs")) scene.springs = springs;
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

}  // namespace twincell::sim
