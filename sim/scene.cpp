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
  c.k_n = s.number_in("k_n", 0, 1e12, true).value_or(c.k_n);
  at_most_one(s, kNormalDamping);
  if (s.has("gamma_n") || s.has("c_n") || s.has("restitution"))
    c.gamma_n = c.c_n = c.restitution = std::nullopt;
  if (const auto v = s.number_in("gamma_n", 0, std::nullopt)) c.gamma_n = v;
  if (const auto v = s.number_in("c_n", 0, std::nullopt)) c.c_n = v;
  if (const auto v = s.number_in("restitution", 0, 1.0, true)) c.restitution = v;
  if (const auto v = s.word("tension", {"allowed", "clipped"})) c.tension = *v == "allowed";
  if (const auto v = s.word("tangential", {"none", "dashpot", "spring"}))
    c.tangential = *v == "none"      ? ContactSpec::Tangential::none
                   : *v == "dashpot" ? ContactSpec::Tangential::dashpot
                                     : ContactSpec::Tangential::spring;
  c.k_t = s.number_in("k_t", 0, 1e12).value_or(c.k_t);
  at_most_one(s, kTangentialDamping);
  if (s.has("gamma_t") || s.has("c_t") || s.has("c_t_over_c_n"))
    c.gamma_t = c.c_t = c.c_t_over_c_n = std::nullopt;
  if (const auto v = s.number_in("gamma_t", 0, std::nullopt)) c.gamma_t = v;
  if (const auto v = s.number_in("c_t", 0, std::nullopt)) c.c_t = v;
  if (const auto v = s.number_in("c_t_over_c_n", 0, std::nullopt)) c.c_t_over_c_n = v;
  c.mu = s.number_in("mu", 0, 1e12).value_or(c.mu);
  if (const auto v = s.word("slip", {"rescale", "spring_only"})) c.slip_rescales = *v == "rescale";
}

void read_cell(const Section& s, Scene& scene) {
  if (const auto d = s.integer("dimension"); d && *d != 2)
    throw ConfigError(s.where("dimension"),
                      fmt::format("{} is not simulated by this version, which knows 2.", *d));
  scene.width = s.number_in("width", 0, 1e6, true).value_or(scene.width);
  scene.height = s.number_in("height", 0, std::nullopt, true);
  if (const auto v = s.word("sides", {"walls", "periodic"})) scene.periodic_sides = *v == "periodic";
  if (const auto v = s.word("side_walls", {"move", "rest"})) scene.side_walls_move = *v == "move";
  scene.gravity = s.number_in("gravity", 0, std::nullopt).value_or(scene.gravity);
  scene.tilt = s.number_in("tilt", -45, 45).value_or(scene.tilt);
}

void read_beads(const Section& s, Scene& scene) {
  if (s.has("count"))
    scene.n_beads = static_cast<std::size_t>(s.integer_in("count", 0, 10'000'000).value_or(0));
  scene.radius = s.number_in("radius", 0, 1e6, true).value_or(scene.radius);
  scene.mass = s.number_in("mass", 0, 1e12, true).value_or(scene.mass);
  if (const auto v = s.word("inertia", {"disc", "sphere"})) scene.inertia_factor = *v == "disc" ? 0.5 : 0.4;
  if (2 * scene.radius > scene.width)
    throw ConfigError(s.where("radius"),
                      fmt::format("a bead of diameter {} does not fit into a cell {} wide.", 2 * scene.radius,
                                  scene.width));
}

DriveSpec read_drive(const Section& s, Scene& scene) {
  const DriveSpec spec = read_drive_spec(s);
  if (const auto v = s.word("start", {"comoving", "abrupt"})) scene.comoving = *v == "comoving";
  return spec;
}

void read_start(const Section& s, Scene& scene) {
  const std::vector<std::string> words = {"crystal_a", "crystal_b", "random", "trajectory"};
  if (const auto v = s.word("kind", words))
    scene.start = static_cast<StartKind>(std::find(words.begin(), words.end(), *v) - words.begin());
  scene.seed = static_cast<std::uint64_t>(s.integer_in("seed", 0, std::int64_t{1} << 53).value_or(1));
  if (const auto v = s.text("from")) scene.from = *v;
  scene.frame = static_cast<std::size_t>(s.integer_in("frame", 0, std::int64_t{1} << 40).value_or(0));
  scene.rest_energy = s.number_in("rest_energy", 0, std::nullopt, true).value_or(scene.rest_energy);
  scene.settle_limit = s.number_in("settle_limit", 0, 1e6).value_or(scene.settle_limit);
  if (scene.start == StartKind::trajectory && scene.from.empty())
    throw ConfigError(s.where("from"), "a start from a trajectory needs the name of its file.");
  if (scene.start != StartKind::trajectory && !scene.from.empty())
    throw ConfigError(s.where("from"), "a file is named, but start.kind is not \"trajectory\".");
}

void read_time(const Section& s, Scene& scene) {
  scene.steps_per_contact = s.number_in("steps_per_contact", 8, 1e6).value_or(scene.steps_per_contact);
  scene.discard = s.integer_in("discard", 0, 1'000'000).value_or(scene.discard);
  scene.cycles = s.integer_in("cycles", 1, 100'000'000).value_or(scene.cycles);
  scene.phases = static_cast<int>(s.integer_in("phases", 1, 10'000).value_or(scene.phases));
}

void read_scale(const Section& s, Scene& scene) {
  scene.scale.sigma_m = s.number_in("sigma_m", 0, std::nullopt, true);
  scene.scale.gravity_m_s2 = s.number_in("gravity_m_s2", 0, std::nullopt, true);
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
