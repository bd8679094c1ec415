#include "sim/scene/read_scene.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sim/laws/law_words.hpp"
#include "sim/scene/check_scene.hpp"
#include "sim/scene/drive_tables.hpp"
#include "sim/scene/presets.hpp"
#include "sim/scene/read_tables.hpp"
#include "sim/scene/scene_layers.hpp"
#include "trajectory/calibration_file.hpp"
#include "trajectory/recorded_motion.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::sim {

namespace {

/// Reads and checks the tables of a resolved scene.
/// \param lower names of the preset and of the calibration file, whose keys give way
Scene interpret(Config& config, const std::string& name, const std::filesystem::path& folder,
                std::vector<std::string> lower) {
  Scene scene;
  scene.file = name;
  std::erase(lower, name);  // a scene with such a name is the user's own file
  VoidKeys void_keys(config, std::move(lower), scene.void_keys);
  // Reading: in this order, since later tables depend on the dimension, the cell and the start.
  const ConfigSection root = config.root(), cell = root.section("cell"), beads = root.section("beads"),
                      contact = root.section("contact"), drive = root.section("drive");
  scene.source = root;
  static_cast<void>(root.text("preset"));
  const double g = read_cell(cell, scene, void_keys);
  read_beads(beads, scene, void_keys);
  read_contact(contact, scene, void_keys);
  const DriveSpec spec = read_drive(drive, folder, scene);
  const std::optional<RampSpec> ramp = read_ramp(drive);
  read_start(root.section("start"), folder, scene, void_keys);
  read_time(root.section("time"), scene);
  read_until(root.section("until"), scene);
  read_scale(root.section("scale"), scene);
  read_effects(root.section("effects"), scene);
  refuse_void_spread(beads, scene, void_keys);
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
  if (scene.g() > 0) {
    scene.drive.gravity = scene.g();
    scene.drive.downward_share = -scene.gravity.z() / scene.g();
  }
  if (ramp)
    scene.drive.ramp = make_ramp(*ramp, scene.drive, spec, g, cycles_before(scene.envelope, scene.discard),
                                 scene.cycles, drive);
  const bool from_file = start_row(scene.start).from_file;
  if (!scene.n_beads && !from_file)
    throw ConfigError(beads.where("count"), "the number of beads is missing.");
  check_scene(scene, root);
  // Stored scenes, checkpoints and points of a sweep keep their integrator and n, even if later versions
  // change the defaults.
  const ConfigSection time = root.section("time");
  if (!time.has("integrator")) config.assign(fmt::format("time.integrator={}", scene.integrator));
  if (!time.has("steps_per_contact"))
    config.assign(fmt::format("time.steps_per_contact={}", scene.steps_per_contact));
  // The same scene with another record is another run.
  if (scene.drive.recorded && !drive.has("file_sha256"))
    config.assign("drive.file_sha256=" + scene.drive.recorded->info().sha256);
  scene.resolved = resolved_text(config);
  return scene;
}

Scene resolve(Config config, const std::string& name, const std::vector<std::string>& assignments,
              const std::filesystem::path& folder) {
  assign(config, assignments);
  refer_to_gravity(config);
  reduce_units(config);
  const Included included = include_calibration(config, name, Includer::scene);
  const ConfigSection root = config.root();
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

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& assignments) {
  return resolve(Config::from_file(path), path.string(), assignments, path.parent_path());
}

Scene read_scene_text(const std::string& text, const std::string& name,
                      const std::vector<std::string>& assignments, const std::filesystem::path& folder) {
  return resolve(Config::from_text(text, name), name, assignments, folder);
}

}  // namespace twincell::sim
