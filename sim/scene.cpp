#include "sim/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/presets.hpp"

namespace twincell::sim {

namespace {

using Section = ConfigSection;

// Of each group one key says it all.
const std::vector<std::string> kNormalDamping = {"gamma_n", "c_n", "restitution"};
const std::vector<std::string> kTangentialDamping = {"gamma_t", "c_t", "c_t_over_c_n"};

double bounded(const Section& s, const std::string& key, double fallback, std::optional<double> lower,
               std::optional<double> upper, bool open_lower = false) {
  const double value = s.number(key).value_or(fallback);
  require_range(s.where(key), value, lower, upper, open_lower);
  return value;
}

std::optional<double> optional_bounded(const Section& s, const std::string& key, double lower,
                                       std::optional<double> upper, bool open_lower = false) {
  const auto value = s.number(key);
  if (value) require_range(s.where(key), *value, lower, upper, open_lower);
  return value;
}

std::int64_t whole(const Section& s, const std::string& key, std::int64_t fallback, std::int64_t lower,
                   std::int64_t upper) {
  const std::int64_t value = s.integer(key).value_or(fallback);
  require_range(s.where(key), static_cast<double>(value), static_cast<double>(lower),
                static_cast<double>(upper));
  return value;
}

void at_most_one(const Section& s, const std::vector<std::string>& keys) {
  std::vector<std::string> given;
  for (const auto& key : keys)
    if (s.has(key)) given.push_back(key);
  if (given.size() > 1)
    throw ConfigError(s.where(given[1]), fmt::format("contradicts '{}': only one of {} can be given.",
                                                     given[0], fmt::join(keys, ", ")));
}

/// A key of `contact.wall` that is absent is taken from `contact`: the papers use the same numbers for both.
void read_contact(const Section& s, ContactSpec& c) {
  c.k_n = bounded(s, "k_n", c.k_n, 0, 1e12, true);
  at_most_one(s, kNormalDamping);
  if (s.has("gamma_n") || s.has("c_n") || s.has("restitution"))
    c.gamma_n = c.c_n = c.restitution = std::nullopt;
  if (const auto v = optional_bounded(s, "gamma_n", 0, std::nullopt)) c.gamma_n = v;
  if (const auto v = optional_bounded(s, "c_n", 0, std::nullopt)) c.c_n = v;
  if (const auto v = optional_bounded(s, "restitution", 0, 1.0, true)) c.restitution = v;
  if (const auto v = s.word("tension", {"allowed", "clipped"})) c.tension = *v == "allowed";
  if (const auto v = s.word("tangential", {"none", "dashpot", "spring"}))
    c.tangential = *v == "none"      ? ContactSpec::Tangential::none
                   : *v == "dashpot" ? ContactSpec::Tangential::dashpot
                                     : ContactSpec::Tangential::spring;
  c.k_t = bounded(s, "k_t", c.k_t, 0, 1e12);
  at_most_one(s, kTangentialDamping);
  if (s.has("gamma_t") || s.has("c_t") || s.has("c_t_over_c_n"))
    c.gamma_t = c.c_t = c.c_t_over_c_n = std::nullopt;
  if (const auto v = optional_bounded(s, "gamma_t", 0, std::nullopt)) c.gamma_t = v;
  if (const auto v = optional_bounded(s, "c_t", 0, std::nullopt)) c.c_t = v;
  if (const auto v = optional_bounded(s, "c_t_over_c_n", 0, std::nullopt)) c.c_t_over_c_n = v;
  c.mu = bounded(s, "mu", c.mu, 0, 1e12);
  if (const auto v = s.word("slip", {"rescale", "spring_only"})) c.slip_rescales = *v == "rescale";
}

void read_cell(const Section& s, Scene& scene) {
  if (const auto d = s.integer("dimension"); d && *d != 2)
    throw ConfigError(s.where("dimension"),
                      fmt::format("{} is not simulated by this version, which knows 2.", *d));
  scene.width = bounded(s, "width", scene.width, 0, 1e6, true);
  scene.height = optional_bounded(s, "height", 0, std::nullopt, true);
  if (const auto v = s.word("sides", {"walls", "periodic"})) scene.periodic_sides = *v == "periodic";
  if (const auto v = s.word("side_walls", {"move", "rest"})) scene.side_walls_move = *v == "move";
  scene.gravity = bounded(s, "gravity", scene.gravity, 0, std::nullopt);
  scene.tilt = bounded(s, "tilt", scene.tilt, -45, 45);
}

void read_beads(const Section& s, Scene& scene) {
  if (s.has("count")) scene.n_beads = static_cast<std::size_t>(whole(s, "count", 0, 0, 10'000'000));
  scene.radius = bounded(s, "radius", scene.radius, 0, 1e6, true);
  scene.mass = bounded(s, "mass", scene.mass, 0, 1e12, true);
  if (const auto v = s.word("inertia", {"disc", "sphere"})) scene.inertia_factor = *v == "disc" ? 0.5 : 0.4;
  if (2 * scene.radius > scene.width)
    throw ConfigError(s.where("radius"),
                      fmt::format("a bead of diameter {} does not fit into a cell {} wide.", 2 * scene.radius,
                                  scene.width));
}

DriveSpec read_drive(const Section& s, Scene& scene) {
  DriveSpec spec;
  spec.amplitude = s.number("amplitude");
  spec.omega = s.number("omega");
  spec.frequency = s.number("frequency");
  spec.gamma = s.number("gamma");
  spec.k_m = s.number("k_m");
  spec.peak_velocity = s.number("peak_velocity");
  if (const auto v = s.word("start", {"comoving", "abrupt"})) scene.comoving = *v == "comoving";
  return spec;
}

void read_start(const Section& s, Scene& scene) {
  const std::vector<std::string> words = {"crystal_a", "crystal_b", "random", "trajectory"};
  if (const auto v = s.word("kind", words))
    scene.start = static_cast<StartKind>(std::find(words.begin(), words.end(), *v) - words.begin());
  scene.seed = static_cast<std::uint64_t>(whole(s, "seed", 1, 0, std::int64_t{1} << 53));
  if (const auto v = s.text("from")) scene.from = *v;
  scene.frame = static_cast<std::size_t>(whole(s, "frame", 0, 0, std::int64_t{1} << 40));
  scene.rest_energy = bounded(s, "rest_energy", scene.rest_energy, 0, std::nullopt, true);
  scene.settle_limit = bounded(s, "settle_limit", scene.settle_limit, 0, 1e6);
  if (scene.start == StartKind::trajectory && scene.from.empty())
    throw ConfigError(s.where("from"), "a start from a trajectory needs the name of its file.");
  if (scene.start != StartKind::trajectory && !scene.from.empty())
    throw ConfigError(s.where("from"), "a file is named, but start.kind is not \"trajectory\".");
}

void read_time(const Section& s, Scene& scene) {
  scene.steps_per_contact = bounded(s, "steps_per_contact", scene.steps_per_contact, 8, 1e6);
  scene.discard = whole(s, "discard", scene.discard, 0, 1'000'000);
  scene.cycles = whole(s, "cycles", scene.cycles, 1, 100'000'000);
  scene.phases = static_cast<int>(whole(s, "phases", scene.phases, 1, 10'000));
}

void read_scale(const Section& s, Scene& scene) {
  scene.scale.sigma_m = optional_bounded(s, "sigma_m", 0, std::nullopt, true);
  scene.scale.gravity_m_s2 = optional_bounded(s, "gravity_m_s2", 0, std::nullopt, true);
}

Scene interpret(const Config& config, const std::string& name) {
  Scene scene;
  scene.file = name;
  scene.resolved = config.text();
  const Section root = config.root();
  static_cast<void>(root.text("preset"));
  read_cell(root.section("cell"), scene);
  read_beads(root.section("beads"), scene);
  const Section contact = root.section("contact"), wall = contact.section("wall");
  read_contact(contact, scene.bead);
  scene.wall = scene.bead;
  read_contact(wall, scene.wall);
  if (scene.wall.tangential != scene.bead.tangential || scene.wall.tension != scene.bead.tension ||
      scene.wall.slip_rescales != scene.bead.slip_rescales)
    throw ConfigError(wall.where(""),
                      "beads and walls must follow the same kind of law; their parameters may differ (mu = 0 "
                      "makes a smooth wall).");
  const DriveSpec drive = read_drive(root.section("drive"), scene);
  read_start(root.section("start"), scene);
  read_time(root.section("time"), scene);
  read_scale(root.section("scale"), scene);
  // A misspelt key explains more than what is missing because of it.
  config.refuse_unknown_keys();
  scene.drive = solve_drive(drive, scene.gravity, root.section("drive").where(""), Axis::z);
  if (!scene.n_beads && scene.start != StartKind::trajectory)
    throw ConfigError(root.section("beads").where("count"), "the number of beads is missing.");
  if (scene.periodic_sides && scene.width < 4 * scene.radius)
    throw ConfigError(
        root.section("cell").where("width"),
        fmt::format("a bead would touch two images of another: {:g} is less than two diameters, {:g}.",
                    scene.width, 4 * scene.radius));
  if (scene.gravity == 0 && scene.periodic_sides)
    throw ConfigError(root.section("cell").where("gravity"),
                      "without gravity and without a lid the beads leave for ever.");
  return scene;
}

Scene resolve(Config config, const std::string& name, const std::vector<std::string>& assignments) {
  for (const auto& assignment : assignments) config.assign(assignment);
  const Section root = config.root();
  const auto preset = root.word("preset", preset_names());
  if (!preset) return interpret(config, name);
  const auto& all = presets();
  const auto chosen = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.first == *preset; });
  Config base = Config::from_text(chosen->second, "preset " + *preset);
  for (const char* section : {"contact", "contact.wall"})
    for (const auto& group : {kNormalDamping, kTangentialDamping}) base.yield_to(config, section, group);
  base.overlay(std::move(config));
  return interpret(base, name);
}

}  // namespace

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& preset : presets()) names.push_back(preset.first);
  return names;
}

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& assignments) {
  return resolve(Config::from_file(path), path.string(), assignments);
}

Scene read_scene_text(const std::string& text, const std::string& name,
                      const std::vector<std::string>& assignments) {
  return resolve(Config::from_text(text, name), name, assignments);
}

}  // namespace twincell::sim
