// The table of the keys of a scene against the reader.
#include "sim/scene/scene_keys.hpp"

#include "sim/laws/cell_laws.hpp"
#include "sim/laws/law_words.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "tests/support/key_table_checks.hpp"

namespace twincell::sim::scene_keys_test {
namespace {

/// The tables of walls have the keys of [contact].
std::string name_of(const std::string& key) {
  return std::regex_replace(key, std::regex("^contact\\.(wall|bottom|sides|plates|lid)\\."), "contact.");
}

/// Everything that a scene says, as text.
std::string told(const Assignments& assignments) {
  const Scene s = read_scene_text("beads.count = 10\ndrive.omega_per_t0 = 1.0\ndrive.gamma = 1.5\n",
                                  "an example", assignments);
  std::string text;
  const auto tell = [&](const auto&... values) { ((text += fmt::format("{} ", values)), ...); };
  const auto number = [&](const auto& value) { value ? tell(*value) : tell("none"); };
  tell(s.dimension, s.width, s.depth, static_cast<int>(s.sides), static_cast<int>(s.plates),
       static_cast<int>(s.bottom), s.lid, s.bottom_moves, s.side_walls_move, s.plates_move, s.lid_moves,
       s.left_tilt, s.right_tilt, s.gravity.x(), s.gravity.y(), s.gravity.z(), s.plate_drag);
  number(s.height);
  number(s.n_beads);
  tell(s.radius, s.mass, s.inertia_factor, static_cast<int>(s.spread), s.spread_width);
  if (s.intruder) tell(s.intruder->radius, s.intruder->mass, s.intruder->x, s.intruder->y, s.intruder->z);
  tell(s.contact.normal, s.contact.tangential, s.contact.rolling, s.overlap_bound, s.drive.amplitude,
       s.drive.omega, static_cast<int>(s.drive.axis), s.comoving, s.phase.value_or(0), s.drive.formula());
  for (const auto& [cycle, factor] : s.envelope.points) tell(cycle, factor);
  for (const Harmonic& harmonic : s.drive.harmonics) tell(harmonic.amplitude, harmonic.phase);
  tell(static_cast<int>(s.start), s.seed, s.from.string(), s.frame, s.in_motion, s.perturbation,
       s.velocity_scale, s.fall_speed, s.rest_energy, s.settle_limit, s.relax, s.steps_per_contact,
       s.allow_unstable_step, s.integrator, static_cast<int>(s.stepping), s.discard, s.cycles, s.phases,
       s.springs.value_or(s.contacts), s.contacts, s.rotation, s.history);
  number(s.fraction);
  number(s.column_height);
  number(s.samples);
  if (s.until) tell(s.until->quantity, s.until->relative, s.until->absolute);
  number(s.scale.sigma_m);
  number(s.scale.gravity_m_s2);
  for (const double constant : contact_constants(make_plan(s).laws->bead, {0.5, 0.25, 6.0}, 1, 2, 2))
    tell(constant);
  return text;
}

TEST(SceneKeys, ExamplesAreReadAndWhatIsOutOfRangeIsRefused) {
  expect_examples_and_ranges(scene_keys());
}

TEST(SceneKeys, EveryKeyThatIsReadHasARow) {
  expect_a_row_for_every_query(scene_keys(), name_of);
  expect_a_row_for_every_query_in({"sim/scene/read_scene.cpp", "sim/scene/read_tables.cpp",
                                   "sim/scene/drive_tables.cpp", "sim/laws", "trajectory/drive.cpp"},
                                  scene_keys());
  std::set<std::string> rows;
  for (const KeyRow& row : scene_keys().rows) rows.insert(row.key);
  for (const std::string& key : all_law_keys()) EXPECT_TRUE(rows.contains("contact." + key)) << key;
}

// What a scene states reaches the run, and the printed default changes nothing.
TEST(SceneKeys, StatedDefaultsChangeNothingAndExamplesDo) {
  int checked = 0;
  for (const KeyRow& row : scene_keys().rows) {
    const auto with = context_of_default(scene_keys(), row);
    if (!with) continue;
    Assignments stated = *with;
    stated.push_back(row.key + "=" + row.absent);
    EXPECT_EQ(told(stated), told(*with)) << row.key;
    ++checked;
    if (row.key == "time.precision") continue;  // its only value
    EXPECT_NE(told(with_key(row, row.example)), told(*with)) << row.key << ": the example is the default";
  }
  EXPECT_GE(checked, 40);
}

}  // namespace
}  // namespace twincell::sim::scene_keys_test
