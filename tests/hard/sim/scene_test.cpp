// Invalid scenes: each is refused with one sentence that states the place and the reason.

#include "sim/scene/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "sim/laws/law_words.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/presets.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/recorded_motion.hpp"

namespace twincell::sim::scene_test {
namespace {

const std::string kGood = "preset = \"fortini-huang-2015\"\n[beads]\ncount = 50\n[drive]\ngamma = 1.5\n";
const std::string kGood3d = "preset = \"bhateja-2016-rough-3d\"\n[drive]\nk_m = 5.0\n";

std::string complaint(const std::string& text, const std::vector<std::string>& set = {}) {
  try {
    read_scene_text(text, "scene.toml", set);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

void expect_complaint(const std::string& text, const std::string& wanted) {
  const std::string said = complaint(text);
  EXPECT_NE(said.find(wanted), std::string::npos) << "wanted: " << wanted << "\nsaid:   " << said;
}

Scene good(const std::vector<std::string>& set) {
  return read_scene_text(kGood, "scene.toml", set);
}

TEST(Scene, ValidScenesAreAccepted) {
  EXPECT_EQ(complaint(kGood), "accepted");
  EXPECT_EQ(complaint("preset = \"bhateja-2016-rough-2d\"\n[drive]\nk_m = 5.0\n"), "accepted");
  const Scene s = good({"drive.gamma=1.8", "start.kind=random"});
  EXPECT_DOUBLE_EQ(s.drive.gamma(), 1.8);
  EXPECT_EQ(s.start, StartKind::random);
}

TEST(Scene, ComplaintsNameLineKeyValueAndBound) {
  expect_complaint(kGood + "[contact]\nmuu = 0.1\n",
                   "scene.toml:7:7: contact.muu: there is no such key; did you mean 'contact.mu'?");
  expect_complaint(kGood + "[time]\nframes_per_cycle = 12\n",
                   "time.frames_per_cycle: there is no such key; [time] has allow_unstable_step, contacts, "
                   "cycles, discard, ");
  expect_complaint(kGood + "[contact.lid]\nmuu = 0.1\n", "contact.lid.muu: there is no such key");
  expect_complaint(kGood + "[cell]\nwidth = 0.9\n", "does not fit into a cell 0.9 wide");
  expect_complaint(kGood + "[time]\nsteps_per_contact = 2\n",
                   "time.steps_per_contact: 2 is out of range; the value must be at least 6");
  expect_complaint(kGood + "[time]\ncycles = 1.5\n", "time.cycles: a whole number is needed");
  expect_complaint(kGood + "[time]\nintegrator = \"euler\"\n",
                   "'euler' is not one of split, verlet, predicted");
  expect_complaint(kGood + "[start]\nkind = \"pile\"\n",
                   fmt::format("'pile' is not one of {}", fmt::join(words_of(kStarts), ", ")));
  expect_complaint(kGood + "[start]\nkind = \"trajectory\"\n",
                   "start.from: a start from a trajectory needs the name of its file");
  expect_complaint(kGood + "[start]\nkind = \"table\"\n",
                   "start.from: a start from a table needs the name of its file");
  expect_complaint(kGood + "[start]\nfrom = \"a.h5\"\n",
                   "start.from: a file is named, but start.kind is not");
  expect_complaint(kGood + "[start]\nframe = 3\n", "start.frame: a frame is named, but start.kind is not");
  expect_complaint("preset = \"fortini\"\n", "'fortini' is not one of fortini-huang-2015");
  expect_complaint("[drive]\nomega = 1.0\ngamma = 1.0\n", "beads.count: the number of beads is missing");
  expect_complaint(
      kGood + "amplitude = 9.0\n",
      "scene.toml:4:1: drive: gamma = 1.5 contradicts the other numbers, from which it would be 9");
  expect_complaint("[beads]\ncount = 1\n[drive]\ngama = 1.0\n",
                   "scene.toml:4:8: drive.gama: there is no such key; did you mean 'drive.gamma'?");
  expect_complaint("[beads]\ncount = 1\n[drive]\ngamma = 1.0\n",
                   "scene.toml:3:1: drive: two of amplitude, omega,");
}

// Gamma refers to the gravity of the cell, and so does an acceleration: 19.62 m/s^2 at g/2 = 4.905 m/s^2
// is 4.
TEST(Scene, AccelerationsReferToTheGravityOfTheCell) {
  const auto drive = [](const std::string& gravity, const std::string& strength) {
    return read_scene_text("preset = \"fortini-huang-2015\"\ncell.gravity = " + gravity +
                               "\n[beads]\ncount = 9\n[drive]\nfrequency_hz = 11.0\n" + strength +
                               "\n[scale]\nsigma_mm = 2.0\ngravity_m_s2 = 9.81\n",
                           "s")
        .drive;
  };
  EXPECT_NEAR(drive("1", "peak_acceleration_m_s2 = 19.62").gamma(), 2, 1e-12);
  EXPECT_NEAR(drive("0.5", "peak_acceleration_m_s2 = 19.62").gamma(), 4, 1e-12);
  EXPECT_NEAR(drive("[0.3, -0.4]", "peak_acceleration_m_s2 = 19.62").gamma(), 4, 1e-12);
  EXPECT_EQ(drive("0.5", "peak_acceleration_m_s2 = 19.62").amplitude,
            drive("1", "peak_acceleration_m_s2 = 19.62").amplitude);
  EXPECT_NEAR(drive("0.5", "ramp.peak_acceleration_m_s2 = 9.81\ngamma = 1").ramp->to.amplitude,
              drive("0.5", "gamma = 2").amplitude, 1e-12);
  // Contradictions are told in the numbers that were written.
  expect_refusal<ConfigError>([&] { (void)drive("0.5", "amplitude_mm = 2.0\ngamma = 3.0"); },
                              "gamma = 3 contradicts the other numbers, from which it would be 1.9");
}

// A gas without drive and gravity is as fast as its start.
TEST(Scene, TheStepFollowsTheSpeedsOfTheStart) {
  const auto step = [](const std::string& speed) {
    const Scene s = read_scene_text(
        "beads.count = 20\n[cell]\nwidth = 12.0\nheight = 12.0\nsides = \"periodic\"\nbottom = "
        "\"periodic\"\ngravity = "
        "0.0\n[contact]\nnormal = \"hertz\"\nyoungs_modulus = 1e6\npoisson_ratio = 0.3\nviscous_time = "
        "0.0\ntangential = "
        "\"none\"\n[drive]\namplitude = 0.0\nomega = 1.0\n[start]\nkind = \"random\"\nvelocity_scale = " +
            speed + "\n",
        "s");
    return make_plan(s).shortest().time;
  };
  // The duration of a Hertzian contact falls as v^-1/5.
  EXPECT_NEAR(step("1.0") / step("32.0"), 2, 1e-6);
  EXPECT_LT(step("5.0"), step("1.0"));
}

TEST(Scene, NumbersOutOfRangeAreRefused) {
  for (const char* key :
       {"cell.width",           "cell.height",          "cell.gravity",       "cell.tilt",
        "cell.side_tilt",       "cell.plate_drag",      "beads.radius",       "beads.mass",
        "beads.layers",         "drive.amplitude",      "drive.omega",        "drive.ramp_cycles",
        "start.perturbation",   "start.velocity_scale", "start.fraction",     "start.height",
        "start.fall_speed",     "start.rest_energy",    "start.settle_limit", "time.steps_per_contact",
        "contact.overlap_bound"})
    for (const char* value : {"nan", "inf", "-inf", "\"one\"", "-1e9", "true"}) {
      const std::string said = complaint(kGood, {std::string(key) + "=" + value});
      EXPECT_NE(said.find(key), std::string::npos) << key << " = " << value << ": " << said;
    }
  for (const char* key : {"cell.width", "beads.radius", "beads.mass", "drive.omega", "start.rest_energy"}) {
    const std::string said = complaint(kGood, {std::string(key) + "=0"});
    EXPECT_NE(said.find(std::string(key) + ": 0 is out of range; the value must be greater than 0"),
              std::string::npos)
        << said;
  }
  // Smaller bounds leave collisions without a velocity at which the step can be found.
  EXPECT_EQ(complaint(kGood, {"contact.overlap_bound=1e-6"}), "accepted");
  EXPECT_NE(
      complaint(kGood, {"contact.overlap_bound=9e-7"}).find("contact.overlap_bound: 9e-07 is out of range"),
      std::string::npos);
  EXPECT_NE(complaint(kGood, {"beads.count=-1"}).find("beads.count: -1 is out of range"), std::string::npos);
  EXPECT_NE(complaint(kGood, {"cell.gravity=[0, nan]"}).find("cell.gravity: a list of 2 numbers"),
            std::string::npos);
}

TEST(Cell, DimensionsHaveTheirOwnKeys) {
  EXPECT_EQ(complaint(kGood3d), "accepted");
  expect_complaint(kGood + "[cell]\ndimension = 4\n", "cell.dimension: 4 is out of range");
  expect_complaint(kGood + "[cell]\ndimension = 3\n", "cell.depth: a 3D cell needs its depth");
  for (const char* line : {"depth = 2.0", "plates = \"walls\"", "plates_motion = \"rest\""})
    expect_complaint(kGood + "[cell]\n" + line + "\n", "a 2D cell has no depth");
  expect_complaint(kGood3d + "[cell]\nplate_drag = 0.1\n",
                   "cell.plate_drag: stands in for the front and back plates");
  expect_complaint(kGood3d + "[cell]\ngravity = [0.0, -1.0]\n",
                   "cell.gravity: a list of 3 numbers is needed");
  expect_complaint(kGood + "axis = \"y\"\n", "drive.axis: a 2D cell cannot be driven along y");
  expect_complaint("preset = \"bhateja-2016-rough-3d\"\n[beads]\ninertia = \"disc\"\n[drive]\nk_m = 5.0\n",
                   "beads.inertia: beads of a 3D cell are spheres");
  expect_complaint(kGood3d + "[cell]\nplates = \"walls\"\ndepth = 0.9\n",
                   "does not fit into a cell 0.9 deep");
}

TEST(Cell, WallsThatAreNotThereHaveNoProperties) {
  expect_complaint(kGood + "[cell]\nsides = \"periodic\"\nside_walls = \"rest\"\n",
                   "cell.side_walls: the cell has no side walls");
  expect_complaint(kGood + "[cell]\nsides = \"absent\"\nside_tilt = 1.0\n",
                   "cell.side_tilt: the cell has no side walls");
  expect_complaint(kGood + "[cell]\nlid_motion = \"rest\"\n", "cell.lid_motion: the cell has no lid");
  expect_complaint(kGood3d + "[cell]\nplates_motion = \"rest\"\n", "the cell has no front and back walls");
  expect_complaint(kGood + "[contact.lid]\nmu = 0.1\n",
                   "scene.toml:6:1: contact.lid: the cell has no such wall");
  expect_complaint(kGood + "[contact.plates]\nmu = 0.1\n", "contact.plates: the cell has no such wall");
}

TEST(Cell, LidAndPeriodAlongZNeedAHeight) {
  expect_complaint(kGood + "[cell]\nlid = \"wall\"\n", "cell.height: a lid needs its height");
  expect_complaint(kGood + "[cell]\nlid = \"wall\"\nheight = 0.8\n", "does not fit into a cell 0.8 high");
  expect_complaint(kGood + "[cell]\nbottom = \"periodic\"\n",
                   "cell.height: a cell periodic along z needs its period");
  expect_complaint(kGood + "[cell]\nbottom = \"periodic\"\nlid = \"wall\"\nheight = 9.0\n",
                   "cell.lid: contradicts cell.bottom");
}

TEST(Cell, PeriodsLeaveNoSecondImageInReach) {
  const std::string periodic = kGood + "[cell]\nsides = \"periodic\"\nwidth = ";
  expect_complaint(periodic + "2.4\n",
                   "scene.toml:8:9: cell.width: a bead would meet two images of another: a period of 2.4 is "
                   "less than 2.5");
  EXPECT_EQ(complaint(periodic + "2.6\n"), "accepted");
  expect_complaint(kGood3d + "[cell]\ndepth = 2.4\n", "cell.depth: a bead would meet two images");
  // The bound is 2 (R + R' + the reach of the larger bead), for the two largest beads that can meet.
  expect_complaint(periodic + "6.9\n[beads.intruder]\nradius = 2.0\nz = 9.0\n",
                   "a period of 6.9 is less than 7,");
  EXPECT_EQ(complaint(periodic + "7.1\n[beads.intruder]\nradius = 2.0\nz = 9.0\n"), "accepted");
  expect_complaint(kGood + "spread = 1\n", "drive.spread");
  EXPECT_NE(
      complaint(periodic + "2.6\n", {"beads.spread=uniform", "beads.spread_width=0.2"}).find("less than 3,"),
      std::string::npos);
}

TEST(Cell, GravityNeedsAWallThatCarries) {
  expect_complaint(kGood + "[cell]\nbottom = \"absent\"\n",
                   "cell.gravity: no wall supports the beads, which gravity (0, 0, -1) accelerates");
  expect_complaint(kGood + "[cell]\ngravity = [0.0, 1.0]\n",
                   "no wall supports the beads, which gravity (0, 0, 1) accelerates");
  expect_complaint(kGood + "[cell]\nsides = \"periodic\"\ngravity = [1.0, 0.0]\n",
                   "no wall supports the beads");
  expect_complaint(kGood + "[cell]\nsides = \"periodic\"\nbottom = \"periodic\"\nheight = 20.0\n",
                   "no wall supports the beads");
  EXPECT_EQ(complaint(kGood + "[cell]\nlid = \"wall\"\nheight = 60.0\ngravity = [0.0, 1.0]\n"), "accepted");
  EXPECT_EQ(complaint(kGood + "[cell]\nsides = \"periodic\"\ntilt = 20.0\n"), "accepted");  // an incline
  expect_complaint(kGood + "[cell]\ntilt = 2.0\ngravity = [0.0, -1.0]\n",
                   "cell.tilt: cell.gravity already gives a direction");
}

TEST(Cell, WithoutGravityOpenCellsAreRefused) {
  const std::string still =
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 5\n[drive]\namplitude = 0.5\n[cell]\ngravity = "
      "0.0\n";
  expect_complaint(
      still, "scene.toml:7:11: cell.gravity: without gravity beads leave the cell for ever: its top is open");
  const std::string closed = still + "lid = \"wall\"\nheight = 30.0\n";
  EXPECT_EQ(complaint(closed), "accepted");
  expect_complaint(closed + "sides = \"absent\"\n", "its sides are open");
  expect_complaint(closed + "bottom = \"absent\"\n", "its bottom is open");
  expect_complaint(closed + "dimension = 3\ndepth = 5.0\nplates = \"absent\"\n",
                   "its front and back are open");
  expect_complaint("preset = \"bhateja-2016-zero-g\"\n[drive]\ngamma = 1.0\n",
                   "gamma: has no meaning without gravity");
}

TEST(Cell, DriveMustMoveAWall) {
  const std::string rests = kGood + "[cell]\nbottom_motion = \"rest\"\nside_walls = \"rest\"\n";
  expect_complaint(rests, "scene.toml:4:1: drive: moves nothing: no wall rides with the plate");
  EXPECT_NE(complaint(rests, {"drive.gamma=0"}), complaint(rests));
  EXPECT_EQ(complaint(rests, {"drive.gamma=0"}), "accepted");
}

TEST(Cell, WallsStandWhereTheSceneSays) {
  const Scene s = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 5\n[drive]\ngamma = 1.0\n"
      "[cell]\ndimension = 3\ndepth = 3.0\nwidth = 8.0\nlid = \"wall\"\nheight = 30.0\nside_tilt = [10.0, "
      "-5.0]\n"
      "plates_motion = \"rest\"\n",
      "s");
  const auto walls = s.walls();
  ASSERT_EQ(walls.size(), 6U);
  const char* names[] = {"bottom", "left", "right", "front", "back", "lid"};
  // A point on each wall, and a second point one sigma further inside the cell.
  const double left = 10 * std::numbers::pi / 180, right = -5 * std::numbers::pi / 180;
  const Vec3 on[] = {
      {4, 1, 0}, {-4 * std::tan(left), 1, 4}, {8 + 4 * std::tan(right), 1, 4}, {4, 0, 4}, {4, 3, 4},
      {4, 1, 30}};
  const Vec3 inward[] = {{0, 0, 1},
                         {std::cos(left), 0, std::sin(left)},
                         {-std::cos(right), 0, std::sin(right)},
                         {0, 1, 0},
                         {0, -1, 0},
                         {0, 0, -1}};
  for (std::size_t w = 0; w < 6; ++w) {
    EXPECT_EQ(walls[w].name, names[w]);
    EXPECT_NEAR(walls[w].n.dot(on[w]), walls[w].offset, 1e-12) << names[w];
    EXPECT_NEAR(walls[w].n.dot(on[w] + inward[w]) - walls[w].offset, 1, 1e-12) << names[w];
    EXPECT_EQ(walls[w].moves, w != 3 && w != 4) << names[w];
  }
}

TEST(Cell, TiltTurnsGravity) {
  const Scene s = good({"cell.tilt=30", "cell.gravity=2"});
  EXPECT_NEAR(s.gravity.x(), 1, 1e-12);
  EXPECT_NEAR(s.gravity.z(), -std::sqrt(3), 1e-12);
  EXPECT_DOUBLE_EQ(s.drive.amplitude, 1.5 * 2);  // A = Gamma g/omega^2
}

TEST(Beads, CountOrLayers) {
  EXPECT_EQ(read_scene_text("preset = \"bhateja-2016-rough-2d\"\n[drive]\nk_m = 5.0\n", "s").n_beads, 40U);
  EXPECT_EQ(read_scene_text(kGood3d, "s").n_beads, 100U);
  EXPECT_EQ(read_scene_text(kGood3d, "s", {"beads.count=7"}).n_beads,
            7U);  // the scene's choice replaces that of the preset
  EXPECT_EQ(read_scene_text(kGood3d, "s", {"beads.radius=0.25"}).n_beads, 400U);
  expect_complaint("[beads]\ncount = 5\nlayers = 2.0\n[drive]\ngamma = 1.0\nomega = 1.0\n",
                   "beads.layers: contradicts 'count'");
  expect_complaint("[beads]\nlayers = 9e5\n[cell]\nwidth = 1e5\n",
                   "beads.layers: 900000 layers are 9e+10 beads, the bound is 10000000");
  expect_complaint("[beads]\nlayers = 0.04\n[cell]\nwidth = 10\n",
                   "beads.layers: 0.04 layers are less than one bead");
}

TEST(Beads, SpreadNeedsAWidth) {
  const std::string beads = "preset = \"fortini-huang-2015\"\n[drive]\ngamma = 1.5\n[beads]\ncount = 5\n";
  EXPECT_EQ(complaint(beads + "spread = \"normal\"\nspread_width = 0.01\n"), "accepted");
  expect_complaint(beads + "spread = \"normal\"\n", "beads.spread: needs beads.spread_width");
  expect_complaint(beads + "spread_width = 0.1\n", "beads.spread_width: is the width of a size distribution");
  expect_complaint(beads + "spread = \"uniform\"\nspread_width = 0.5\n",
                   "beads.spread_width: 0.5 is out of range; the value must be less than 0.5");
}

TEST(Beads, IntruderHasItsPlace) {
  const std::string intruder = kGood + "[beads.intruder]\n";
  const Scene s = read_scene_text(intruder + "radius = 2.0\nz = 6.0\n", "s");
  ASSERT_TRUE(s.intruder);
  EXPECT_DOUBLE_EQ(s.intruder->x, 10);
  EXPECT_DOUBLE_EQ(s.intruder->mass, 16);  // the same material: discs of four radii
  expect_complaint(intruder + "z = 6.0\n", "beads.intruder.radius: an intruder needs its radius");
  expect_complaint(intruder + "radius = 2.0\n", "beads.intruder.z: an intruder needs the height");
  expect_complaint(intruder + "radius = 0.0\nz = 6.0\n", "beads.intruder.radius: 0 is out of range");
  expect_complaint(intruder + "radius = 11.0\nz = 12.0\n",
                   "an intruder of diameter 22 does not fit into a cell 20 wide");
  expect_complaint(
      intruder + "radius = 2.0\nz = 1.0\n",
      "scene.toml:6:1: beads.intruder: the intruder at (10, 0, 1) reaches 1 into the wall \"bottom\"");
  expect_complaint(intruder + "radius = 2.0\nz = 6.0\nx = 19.0\n", "into the wall \"right\"");
  expect_complaint(intruder + "radius = 2.0\nz = 6.0\ny = 0.0\n", "beads.intruder.y: a 2D cell has no y");
  expect_complaint(intruder + "radius = 2.0\nz = 6.0\n[start]\nkind = \"table\"\nfrom = \"a.csv\"\n",
                   "a file contains all beads");
}

TEST(Contact, KindsOfLawAreTheSameForAll) {
  for (const char* table : {"wall", "bottom", "sides"})
    for (const char* line : {"normal = \"hertz\"", "tangential = \"none\"", "rolling = \"none\"",
                             "normal = \"linear-no-tension\""})
      expect_complaint(kGood + "[contact." + table + "]\n" + line + "\n",
                       "all contacts follow the same kinds of law, named in [contact]");
  expect_complaint(kGood + "[contact]\nnormal = \"rubber\"\n",
                   "contact.normal: 'rubber' is not one of linear,");
}

// Without tangential friction beads do not rotate, so the rolling resistance would be dropped silently.
TEST(Contact, RollingWithoutFrictionIsRefused) {
  const std::string rolling = kGood + "[contact]\nrolling = \"spring\"\nk_r = 1.0\nmu_r = 0.1\n";
  expect_complaint(rolling + "tangential = \"none\"\n", "scene.toml:7:11: contact.rolling: is \"spring\"");
  expect_complaint(rolling + "tangential = \"none\"\n", "contact.tangential is \"none\"");
  EXPECT_NO_THROW((void)read_scene_text(rolling, "scene.toml"));
}

TEST(Contact, LawsRefuseTheirParameters) {
  expect_complaint(kGood + "[contact]\nmu = -0.1\n",
                   "scene.toml:7:6: contact.mu: -0.1 is out of range; the value must be at least 0");
  expect_complaint(kGood + "[contact]\nk_n = \"stiff\"\n",
                   "scene.toml:7:7: contact.k_n: a number is needed, not a string.");
  expect_complaint(kGood + "[contact]\nk_n = nan\n", "contact.k_n: a finite number is needed");
  expect_complaint(
      kGood + "[contact]\nrestitution = 1.1\n",
      "contact.restitution: 1.1 is out of range; the value must be greater than 0 and at most 1.");
  expect_complaint(kGood + "[contact]\nrestitution = 0.0\n", "contact.restitution: 0 is out of range");
  expect_complaint(kGood + "[contact]\nc_n = 5.0\nrestitution = 0.9\n", "contradicts 'c_n'");
  expect_complaint(kGood + "[contact.wall]\nmu = -0.1\n",
                   "scene.toml:7:6: contact.wall.mu: -0.1 is out of range; the value must be at least 0");
}

/// Formats words as `"a" or "b"`, each in quotes.
std::string any_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k)
    text += (k == 0 ? "" : k + 1 == words.size() ? " or " : ", ") + ("\"" + words[k] + "\"");
  return text;
}

// Two examples of the laws that read a key. The tests below take the list from the laws themselves.
TEST(Contact, LawsAreNamedByTheKeysThatTheyRead) {
  EXPECT_EQ(any_of(readers_of("k_t").laws), "\"spring\", \"spring-limited\" or \"force-clipped\"");
  EXPECT_EQ(any_of(readers_of("viscous_time").laws), "\"hertz\"");
  EXPECT_EQ(readers_of("youngs_modulus").axis, "normal");
}

// Each law with each key of another law: the number would be dropped silently.
TEST(Contact, KeysThatTheLawDoesNotReadAreRefused) {
  const std::string bare = "[beads]\ncount = 9\n[drive]\ngamma = 1.5\nomega = 1.0\n";
  for (const std::string table : {"contact", "contact.wall", "contact.bottom", "contact.sides"})
    for (const auto& [law, key] : std::vector<std::array<std::string, 2>>{
             {"normal = \"hertz\"", "restitution"},
             {"normal = \"hertz\"", "c_n"},
             {"normal = \"hertz\"", "gamma_n"},
             {"normal = \"hertz\"", "k_n"},
             {"normal = \"hertz\"", "restitution_fast"},
             {"normal = \"velocity-dependent-restitution\"", "restitution"},
             {"normal = \"velocity-dependent-restitution\"", "viscous_time"},
             {"normal = \"linear\"", "youngs_modulus"},
             {"normal = \"linear\"", "restitution_speed"},
             {"normal = \"linear-no-tension\"", "poisson_ratio"},
             {"tangential = \"none\"", "mu"},
             {"tangential = \"none\"", "k_t"},
             {"tangential = \"none\"", "gamma_t"},
             {"tangential = \"dashpot\"", "k_t"},
             {"rolling = \"none\"", "mu_r"},
             {"rolling = \"none\"", "k_r"},
             {"rolling = \"none\"", "c_r"}}) {
      const std::string readers = any_of(readers_of(key).laws);
      const std::string young = law.find("hertz") != std::string::npos ? "youngs_modulus = 1e7\n" : "";
      const std::string head = bare + "[contact]\n" + law + "\n" + young;
      ASSERT_EQ(complaint(head), "accepted");
      expect_complaint(
          head + (table == "contact" ? "" : "[" + table + "]\n") + key + " = 0.3\n",
          table + "." + key + ": the law contact." + law + " does not read it; " + readers + " would.");
    }
  // The message states file, line and column.
  expect_complaint("[beads]\ncount = 9\n[contact]\nnormal = \"hertz\"\nrestitution = 0.5\n",
                   "scene.toml:5:15: contact.restitution: the law contact.normal = \"hertz\" does not read");
}

// A value that the plan drops by itself is not an error of the user.
TEST(Contact, SmoothBeadsHaveTwoSpellings) {
  EXPECT_EQ(complaint(kGood, {"contact.mu=0"}), "accepted");  // the preset's k_t and gamma_t are read
  EXPECT_EQ(complaint(kGood, {"contact.mu=0", "contact.k_t=2e4"}), "accepted");
  EXPECT_EQ(complaint(kGood, {"contact.tangential=none", "contact.mu=0"}), "accepted");
  EXPECT_NE(complaint(kGood, {"contact.tangential=none", "contact.mu=0.5"}), "accepted");
}

TEST(Contact, APresetsKeysGiveWayAndAreNamed) {
  const auto keys = [](const Scene& s) {
    std::vector<std::string> all;
    for (const VoidKey& key : s.void_keys) all.push_back(key.key);
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_TRUE(good({}).void_keys.empty());
  const Scene hertz = good({"contact.normal=hertz", "contact.youngs_modulus=1e7"});
  EXPECT_EQ(keys(hertz), (std::vector<std::string>{"contact.gamma_n", "contact.k_n"}));
  ASSERT_FALSE(hertz.void_keys.empty());
  EXPECT_EQ(hertz.void_keys[0].source, "preset fortini-huang-2015");
  EXPECT_NE(hertz.void_keys[0].text().find("has no effect: the law contact.normal = \"hertz\""),
            std::string::npos)
      << hertz.void_keys[0].text();
  EXPECT_EQ(hertz.resolved.find("gamma_n"), std::string::npos);
  EXPECT_EQ(keys(read_scene_text(hertz.resolved, "again")), keys(hertz));  // as sweeps read it
  EXPECT_EQ(read_scene_text(hertz.resolved, "again").resolved, hertz.resolved);
  EXPECT_EQ(keys(good({"contact.tangential=none"})),
            (std::vector<std::string>{"contact.gamma_t", "contact.k_t", "contact.mu"}));
  EXPECT_EQ(keys(read_scene_text("preset = \"bhateja-2016-horizontal\"\n[cell]\nlid = \"absent\"\n"
                                 "[drive]\nk_m = 9\n",
                                 "s")),
            std::vector<std::string>{"cell.lid_motion"});
  // A multiple of a dashpot that no longer exists would mean no friction: this is an error, not only a note.
  EXPECT_NE(complaint("preset = \"bhateja-2016-rough-2d\"\n[drive]\nk_m = 9\n[contact]\nnormal = "
                      "\"hertz\"\nyoungs_modulus = 1e7\n")
                .find("contact.c_t_over_c_n: there is no normal dashpot"),
            std::string::npos);
}

TEST(Scene, KeysOfAnotherStartOrCellAreRefused) {
  expect_complaint(kGood + "[start]\nfraction = 0.1\n",
                   "start.fraction: sets the column of a random start, but start.kind is not");
  expect_complaint(kGood + "[start]\nheight = 60.0\n",
                   "start.height: sets the column of a random start, but start.kind is not");
  expect_complaint(kGood + "[start]\nfall_speed = 2.0\n",
                   "start.fall_speed: sets the speed of a random start, but start.kind is not");
  expect_complaint(kGood + "[start]\nkind = \"random\"\nfraction = 0.1\nheight = 60.0\n",
                   "start.height: sets the column of a random start, and so does start.fraction");
  expect_complaint(kGood + "[start]\nvelocity_scale = 2.0\n",
                   "start.velocity_scale: sets the speeds of a random start, but start.kind is not");
  expect_complaint(kGood + "[cell]\ngravity = 0.0\ntilt = 3.0\n", "cell.tilt: turns gravity");
  const std::string table = kGood + "[start]\nkind = \"table\"\nfrom = \"a.csv\"\n";
  EXPECT_EQ(complaint(table), "accepted");
  EXPECT_NE(complaint(table, {"beads.spread=uniform", "beads.spread_width=0.1"})
                .find("beads.spread: radii are not drawn for the beads of a table"),
            std::string::npos);
  expect_complaint("\"beads.count\" = 5\n" + kGood, "beads.count: is a name in quotes");
  expect_complaint(kGood + "gamma = 2.0\n", "scene.toml:6");  // the key occurs twice
}

TEST(Scene, SeedsAreNeverRounded) {
  EXPECT_EQ(good({"start.seed=9007199254740992"}).seed, std::uint64_t{1} << 53);
  for (const char* seed : {"9007199254740993", "9223372036854775807", "-1"})
    EXPECT_NE(
        complaint(kGood, {std::string("start.seed=") + seed})
            .find(std::string("start.seed: ") + seed + " is out of range; the value must be at least 0"),
        std::string::npos)
        << seed;
  for (const char* seed : {"9223372036854775808", "18446744073709551616", "1e3", "2.5"})
    EXPECT_NE(complaint(kGood + "[start]\nseed = " + std::string(seed) + "\n").find("scene.toml:7"),
              std::string::npos)
        << complaint(kGood + "[start]\nseed = " + std::string(seed) + "\n");
}

TEST(Scene, StartFileIsRelativeToScene) {
  const std::string text = kGood + "[start]\nkind = \"table\"\nfrom = \"b/a.csv\"\n";
  EXPECT_EQ(read_scene_text(text, "s", {}, "/x/y").from, "/x/y/b/a.csv");
  EXPECT_EQ(read_scene_text(text, "s").from, "b/a.csv");
  EXPECT_EQ(read_scene_text(text, "s", {"start.from=/z.csv"}, "/x/y").from, "/z.csv");
  EXPECT_NE(read_scene_text(text, "s", {}, "/x/y").resolved.find("b/a.csv"), std::string::npos);
}

// A file for an earlier version is refused with the present word.
TEST(Contact, FormerWordsAreRefusedWithThoseOfToday) {
  const std::vector<std::pair<std::string, std::string>> now = {
      {"contact.normal=linear-clipped",
       "contact.normal: \"linear-clipped\" is now called \"linear-no-tension\""},
      {"contact.normal=falling-restitution",
       "\"falling-restitution\" is now called \"velocity-dependent-restitution\""},
      {"contact.tangential=spring-only", "\"spring-only\" is now called \"spring-limited\""},
      {"contact.tension=clipped", "contact.tension: is a former key; write contact.normal = "},
      {"contact.slip=rescale", "contact.slip: is a former key; write contact.tangential = "},
      {"time.stepping=flights", "time.stepping: \"flights\" is now called \"event-driven\""},
      {"time.force=true", "time.force: is a former key; write allow_unstable_step = true"}};
  for (const auto& [former, sentence] : now)
    EXPECT_NE(complaint(kGood, {former}).find(sentence), std::string::npos) << complaint(kGood, {former});
}

TEST(Contact, KeysThatAllWallsReplaceAreRefused) {
  const std::string mu = "contact.wall.mu=0.1", bottom = "contact.bottom.mu=0.3",
                    sides = "contact.sides.mu=0.3";
  const std::string said = complaint(kGood, {mu, bottom, sides});
  EXPECT_NE(said.find("contact.wall.mu: all walls of the cell have their own: [contact.bottom] and "
                      "[contact.sides]."),
            std::string::npos)
      << said;
  EXPECT_EQ(complaint(kGood, {mu, bottom}), "accepted");
  EXPECT_EQ(complaint(kGood, {mu, bottom, sides, "cell.lid=wall", "cell.height=40"}), "accepted");
  EXPECT_NE(complaint(kGood, {mu, bottom, "cell.sides=periodic"}), "accepted");
  EXPECT_EQ(complaint(kGood, {mu, "contact.bottom.k_n=1e7", "contact.sides.mu=0.3"}), "accepted");
}

TEST(Contact, InnermostTableWins) {
  const Scene s =
      read_scene_text(kGood +
                          "[cell]\nlid = \"wall\"\nheight = 40.0\n[contact]\nmu = 0.1\n[contact.wall]\nmu = "
                          "0.2\nrestitution = 0.9\n[contact.lid]\nmu = 0.3\n",
                      "s");
  EXPECT_EQ(s.contact.bead.number("mu"), 0.1);
  EXPECT_EQ(s.contact.wall.at("bottom").number("mu"), 0.2);
  EXPECT_EQ(s.contact.wall.at("left").number("mu"), 0.2);
  EXPECT_EQ(s.contact.wall.at("lid").number("mu"), 0.3);
  EXPECT_EQ(s.contact.wall.at("lid").number("k_n"), 1e6);
  // The wall's restitution replaces the preset's gamma_n there; the beads keep gamma_n.
  EXPECT_EQ(s.contact.wall.at("lid").which_of(normal_damping_keys()), "restitution");
  EXPECT_EQ(s.contact.bead.which_of(normal_damping_keys()), "gamma_n");
  EXPECT_EQ(good({"contact.restitution=0.8"}).contact.bead.which_of(normal_damping_keys()), "restitution");
}

TEST(DriveOfAScene, RampAndSchedule) {
  EXPECT_TRUE(good({}).envelope.points.empty());
  EXPECT_FALSE(good({"drive.start=abrupt"}).comoving);
  const Scene ramp = good({"drive.start=ramp", "drive.ramp_cycles=4"});
  EXPECT_DOUBLE_EQ(ramp.envelope.at(1), 0.25);
  EXPECT_DOUBLE_EQ(ramp.envelope.duration(), 4);
  const Scene calmed = good({"drive.schedule=[[0, 3], [5, 3], [10, 1]]"});
  EXPECT_DOUBLE_EQ(calmed.envelope.at(7.5), 2);
  EXPECT_DOUBLE_EQ(calmed.envelope.at(11), 1);
  const auto refused = [](const std::string& schedule) {
    return complaint(kGood, {"drive.schedule=" + schedule});
  };
  EXPECT_NE(refused("[[0, 1], [5, 2]]").find("drive.schedule: the last factor is 2; it must be 1"),
            std::string::npos);
  EXPECT_NE(refused("[[5, 2], [5, 1]]").find("cycles must increase, but 5 follows 5"), std::string::npos);
  EXPECT_NE(refused("[[0, -1], [5, 1]]").find("drive.schedule: -1 is out of range"), std::string::npos);
  EXPECT_NE(refused("[[-1, 2], [5, 1]]").find("drive.schedule: -1 is out of range"), std::string::npos);
  EXPECT_NE(refused("[]").find("a list of pairs of numbers is needed"), std::string::npos);
  EXPECT_NE(complaint(kGood, {"drive.start=ramp", "drive.schedule=[[0, 1]]"})
                .find("drive.schedule: contradicts 'start'"),
            std::string::npos);
  EXPECT_NE(
      complaint(kGood, {"drive.ramp_cycles=5"}).find("drive.ramp_cycles: is given, but drive.start is not"),
      std::string::npos);
}

TEST(DriveOfAScene, Harmonics) {
  EXPECT_TRUE(good({}).drive.harmonics.empty());
  const Scene shaken = good({"drive.harmonics=[[0.1, 0.25], [0.02, 0]]", "drive.axis=x"});
  ASSERT_EQ(shaken.drive.harmonics.size(), 2);
  EXPECT_EQ(shaken.drive.harmonics[0].amplitude, 0.1);
  EXPECT_EQ(shaken.drive.harmonics[0].phase, 0.25);
  EXPECT_EQ(shaken.drive.axis, Axis::x);
  EXPECT_EQ(shaken.drive.amplitude, good({}).drive.amplitude);
  EXPECT_NE(shaken.resolved.find("harmonics"), std::string::npos) << "a checkpoint keeps the harmonics";
  EXPECT_FALSE(make_plan(shaken).event_driven);
  const auto refused = [](const std::string& harmonics) {
    return complaint(kGood, {"drive.harmonics=" + harmonics});
  };
  EXPECT_NE(refused("[[0.1, 0], [-0.2, 0]]")
                .find("drive.harmonics: the amplitude -0.2 of harmonic 3, relative to the first, must be "
                      "between 0 and 100."),
            std::string::npos);
  EXPECT_NE(refused("[[101, 0]]").find("the amplitude 101 of harmonic 2"), std::string::npos);
  EXPECT_NE(refused("[[0.1, 1]]").find("the phase 1 of harmonic 2 must be at least 0 and less than 1 cycle"),
            std::string::npos);
  EXPECT_NE(refused("[0.1]").find("a list of pairs of numbers is needed"), std::string::npos);
  std::string many = "[[0.1, 0]";
  for (int k = 0; k < 30; ++k) many += ", [0.1, 0]";
  EXPECT_NE(refused(many + "]").find("has 31 harmonics, the bound is 30."), std::string::npos);
  const Scene event = good({"drive.harmonics=[[0.1, 0]]", "time.stepping=event-driven",
                            "contact.tangential=none", "contact.mu=0"});
  try {
    (void)make_plan(event);
    FAIL() << "event-driven motion accepted harmonics";
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("the drive has harmonics"), std::string::npos) << e.what();
  }
}

/// The lines of a record of `cycles` cycles of 40 samples of 2 sin t, to which `value` may add.
template <class Value>
std::string record_of(int cycles, Value value) {
  std::string text = "time_t0,position_sigma\n";
  for (int i = 0; i < 40 * cycles; ++i) {
    const double t = 2 * std::numbers::pi * i / 40;
    text += fmt::format("{:.12g},{:.12g}\n", t, 2 * std::sin(t) + value(t));
  }
  return text;
}

TEST(DriveOfAScene, Recorded) {
  const TemporaryFolder folder;
  const auto put = [&](const std::string& text) { put_file(folder / "trace.csv", text); };
  const std::string scene =
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = 5\n[time]\ndiscard = 0\ncycles = 3\n";
  const auto read = [&](std::vector<std::string> with) {
    with.insert(with.begin(), "drive.file=trace.csv");
    return read_scene_text(scene, "scene.toml", with, folder.path());
  };
  const auto refusal = [&](const std::vector<std::string>& with) {
    return complaint_of([&] { (void)make_plan(read(with)); });
  };
  const auto expect = [&](const std::vector<std::string>& with, const std::string& words) {
    const std::string said = refusal(with);
    EXPECT_NE(said.find(words), std::string::npos) << words << " is not in: " << said;
  };
  put(record_of(5, [](double t) { return 0.2 * std::cos(2 * t); }));
  // omega = 1 is that of the preset. A and Gamma are those of the sine.
  const Scene plain = read({});
  EXPECT_NEAR(plain.drive.amplitude, 2, 5e-3);
  EXPECT_EQ(plain.drive.gamma(), plain.drive.amplitude);
  EXPECT_EQ(plain.drive.omega, 1);
  EXPECT_NE(plain.resolved.find("file_sha256"), std::string::npos);
  EXPECT_FALSE(make_plan(plain).event_driven);
  // z'' = -2 sin t - 0.8 cos 2t = -2s - 0.8 + 1.6 s^2 is lowest at s = 5/8: -1.425; at s = -1 it is 2.8.
  EXPECT_NEAR(plain.drive.peak_fall(), 1.425, 0.01);
  // A stated strength scales the record, and a record replaces the amplitude of lower layers.
  const Scene scaled = read({"drive.gamma=3.0"});
  EXPECT_EQ(scaled.drive.gamma(), 3);
  EXPECT_NEAR(scaled.drive.displacement(0.3, 1), 3 / plain.drive.gamma() * plain.drive.displacement(0.3, 1),
              1e-12);
  EXPECT_NEAR(scaled.drive.peak_fall() / plain.drive.peak_fall(), 3 / plain.drive.gamma(), 1e-9);
  const Scene replaced = read_scene_text(scene + "[drive]\ngamma = 9.0\n", "scene.toml",
                                         {"drive.file=trace.csv"}, folder.path());
  EXPECT_EQ(replaced.drive.amplitude, plain.drive.amplitude);
  // Repeated: the frequency follows from the record.
  const Scene repeated = read({"drive.repeat=true", "drive.frequency=0.16", "time.cycles=1000"});
  EXPECT_NEAR(repeated.drive.omega, 1, 1e-12);
  EXPECT_EQ(repeated.drive.recorded->info().cycles, 5);
  EXPECT_EQ(refusal({"drive.repeat=true", "time.cycles=1000"}), "");
  // What does not fit together.
  expect({"time.cycles=5"},
         "drive.file: trace.csv lasts 4.975 cycles from its first phase 0, but the run needs 5 (");
  expect({"time.discard=2"}, "but the run needs 5 (");
  expect({"drive.start=ramp", "drive.ramp_cycles=2"}, "but the run needs 5 (");
  expect({"drive.repeat=true", "drive.frequency=0.2"}, "drive.repeat: ");
  expect({"drive.repeat=true", "drive.frequency=0.2"}, "trace.csv has 6.283 cycles of the stated frequency");
  expect({"drive.harmonics=[[0.1, 0]]"}, "drive.harmonics: contradicts drive.file");
  expect({"drive.file_sha256=12ab"}, "but drive.file_sha256 is 12ab: the record has changed.");
  expect({"drive.file=none.csv"}, "none.csv");
  expect({"time.stepping=event-driven", "contact.tangential=none", "contact.mu=0"}, "the drive is recorded");
  EXPECT_NE(complaint(kGood, {"drive.repeat=true"})
                .find("drive.repeat: repeats a record, but drive.file names none."),
            std::string::npos);
  EXPECT_NE(complaint("beads.count = 5\n", {"drive.file=trace.csv"})
                .find("drive.file: needs drive.frequency or drive.omega too"),
            std::string::npos);
  EXPECT_NE(complaint(kGood, {"drive.cutoff=1.0"})
                .find("drive.cutoff: smooths a record, but drive.file names none."),
            std::string::npos);
  expect({"drive.cutoff=0.3"}, "drive.cutoff: 0.3/t0 would weaken the drive, whose frequency is 0.1592/t0;");
  expect({"drive.cutoff=4.0"},
         "drive.cutoff: 4/t0 removes nothing: it must be below half the sampling rate of ");
  EXPECT_EQ(refusal({"drive.cutoff=1.6"}), "");
  // A stored scene refuses a record that has changed.
  put(record_of(5, [](double t) { return 0.3 * std::cos(2 * t); }));
  EXPECT_NE(complaint_of([&] {
              (void)read_scene_text(plain.resolved, "stored", {}, folder.path());
            }).find("the record has changed"),
            std::string::npos);
  // Doubts: hardly a sine; noise.
  const auto warned = [&](const std::string& words) {
    const Plan plan = make_plan(read({}));
    return std::ranges::any_of(plan.warnings,
                               [&](const std::string& w) { return w.find(words) != std::string::npos; });
  };
  EXPECT_FALSE(warned("trace.csv"));
  put(record_of(5, [](double t) { return 18 * std::sin(t); }));
  EXPECT_TRUE(
      warned("position_sigma of trace.csv: Gamma = 20 follows from the values, and beds are usually "
             "shaken at 0.3 to 9; is their unit right?"));
  put(record_of(5, [](double t) { return std::clamp(2 * std::sin(t), -1.5, 1.5) - 2 * std::sin(t); }));
  EXPECT_TRUE(
      warned("position_sigma of trace.csv: 45 % of the values are exactly the largest or the smallest"));
  // Accelerations of 1.6 g in m/s^2, at an instrument that senses gravity, named g.
  std::string text = record_of(5, [](double t) { return 9.81 + 13.7 * std::sin(t); });
  text.replace(text.find("position_sigma"), std::string("position_sigma").size(), "acceleration_g");
  put(text);
  EXPECT_TRUE(warned("acceleration_g of trace.csv: their mean is 9.8"));
  EXPECT_TRUE(warned("acceleration_g of trace.csv: Gamma = 15.7 follows from the values"));
  put(record_of(5, [](double t) { return 6 * std::cos(3 * t); }));
  EXPECT_TRUE(warned("has only 10 % of the mean square of trace.csv"));
  put(record_of(5, [](double t) { return 0.2 * std::cos(18 * t); }));
  EXPECT_TRUE(warned("the largest acceleration of trace.csv is "));
  EXPECT_TRUE(warned("set drive.cutoff"));
  // The noise has 18 times the frequency of the drive; of its amplitude 0.2 remains less than 0.1 %.
  const double fall = read({"drive.cutoff=0.4"}).drive.peak_fall();
  EXPECT_GT(read({}).drive.peak_fall(), 30);
  EXPECT_GT(fall, 1.9);
  EXPECT_LT(fall, 2.3);
}

// Keys that the law reads and a value makes void are named, unless a preset states them.
TEST(Scene, KeysWithoutEffectAreWarnedOf) {
  const auto warned = [](const std::vector<std::string>& assignments, const std::string& sentence) {
    return std::ranges::count(make_plan(good(assignments)).warnings, sentence);
  };
  const std::string spring = "contact.tangential=\"spring\"", k_t = "contact.k_t=2e4";
  const std::string sentence = "contact.k_t has no effect: mu is 0 for all contacts.";
  EXPECT_EQ(warned({spring, k_t, "contact.mu=0"}, sentence), 1);
  EXPECT_EQ(warned({spring, k_t, "contact.mu=0.1"}, sentence), 0);
  EXPECT_EQ(warned({spring, k_t, "contact.mu=0", "contact.bottom.mu=0.3"}, sentence), 0);
  const std::string dashpot = "contact.tangential=\"dashpot\"", ratio = "contact.c_t_over_c_n=0.5";
  const std::string undamped =
      "contact.c_t_over_c_n has no effect: with restitution = 1 there is no normal dashpot to take a "
      "multiple "
      "of.";
  EXPECT_EQ(warned({dashpot, ratio, "contact.mu=0.3", "contact.restitution=1.0"}, undamped), 1);
  EXPECT_EQ(warned({dashpot, ratio, "contact.mu=0.3", "contact.restitution=0.99"}, undamped), 0);
  const std::string harmonics = "drive.harmonics=[[0.1,0.2]]", rest = "drive.gamma=0.0";
  const std::string none =
      "drive.harmonics has no effect: they are relative to the amplitude of the drive, "
      "which is 0.";
  EXPECT_EQ(warned({harmonics, rest}, none), 1);
  EXPECT_EQ(warned({harmonics}, none), 0);
  const std::string still =
      "drive.start has no effect: the plate rests, because the amplitude of the drive is 0.";
  EXPECT_EQ(warned({"drive.start=abrupt", rest}, still), 1);
  EXPECT_EQ(warned({"drive.start=comoving", rest}, still), 0);
  EXPECT_EQ(warned({"drive.start=abrupt"}, still), 0);
  const std::string inertia = "beads.inertia=sphere", no_turn = "beads.inertia has no effect: no bead turns.";
  EXPECT_EQ(warned({inertia, "contact.tangential=none"}, no_turn), 1);
  EXPECT_EQ(warned({inertia, "contact.mu=0"}, no_turn), 1);
  EXPECT_EQ(warned({inertia}, no_turn), 0);
  EXPECT_EQ(warned({inertia, "contact.mu=0", "beads.spread=uniform", "beads.spread_width=0.1"}, no_turn), 0);
  const Scene smooth = read_scene_text("preset = \"bhateja-2016-smooth-2d\"\n[drive]\nk_m = 9\n", "s");
  EXPECT_TRUE(make_plan(smooth).warnings.empty()) << make_plan(smooth).warnings.front();
  const Scene paper = read_scene_text(
      "preset = \"fortini-huang-2015\"\nbeads.count = 100\n"
      "drive.gamma = 1.2\ncontact.mu = 0\n",
      "preset");
  EXPECT_TRUE(make_plan(paper).warnings.empty()) << make_plan(paper).warnings.front();
}

// Harmonics are relative to the first: 10 % is 0.1.
TEST(DriveOfAScene, HarmonicsInPercentAreWarnedOf) {
  const auto warnings = [](const char* harmonics) {
    return make_plan(good({std::string("drive.harmonics=") + harmonics})).warnings;
  };
  EXPECT_TRUE(warnings("[[0.1, 0.25], [1.0, 0.0]]").empty());
  const std::vector<std::string> doubts = warnings("[[0.1, 0.25], [10.0, 0.0]]");
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_NE(doubts[0].find("harmonic 3 of the drive is 10 times the first"), std::string::npos) << doubts[0];
}

// The scene of a twin states A and omega. A sweep over Gamma keeps omega, so that A = Gamma g/omega^2.
TEST(DriveOfAScene, AnAssignedStrengthReplacesTheAmplitude) {
  const auto drive = [](const std::string& stated, const std::vector<std::string>& assigned) {
    return read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 9\n" + stated, "s", assigned)
        .drive;
  };
  const std::string twin = "[drive]\namplitude = 1.6\nomega = 0.5\n";
  EXPECT_EQ(drive(twin, {"drive.gamma=2.0"}).omega, 0.5);
  EXPECT_DOUBLE_EQ(drive(twin, {"drive.gamma=2.0"}).amplitude, 8);
  EXPECT_DOUBLE_EQ(drive(twin, {"drive.k_m=4.0"}).amplitude, 4);
  EXPECT_EQ(drive(twin, {"drive.amplitude=3.0"}).omega, 0.5);
  EXPECT_EQ(drive(twin, {"drive.omega=2.0"}).amplitude, 1.6);
  EXPECT_DOUBLE_EQ(drive(twin, {"drive.gamma=2.0", "drive.omega=2.0"}).amplitude, 0.5);
  EXPECT_DOUBLE_EQ(drive(twin, {"drive.gamma=2.0", "drive.amplitude=2.0"}).omega, 1);
  EXPECT_DOUBLE_EQ(drive("[drive]\nfrequency = 0.5\ngamma = 2.0\n", {"drive.amplitude=3.0"}).omega,
                   std::numbers::pi);
  const std::string in_mm =
      "[drive]\namplitude_mm = 2.0\nfrequency_hz = 10.0\n[scale]\nsigma_mm = 1.0\ngravity_m_s2 = 10.0\n";
  EXPECT_NEAR(drive(in_mm, {"drive.peak_acceleration_g=2.0"}).omega, 0.2 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(drive(in_mm, {"drive.gamma=2.0"}).gamma(), 2, 1e-12);
  EXPECT_THROW((void)drive(twin, {"drive.gamma=2.0", "drive.amplitude=3.0", "drive.omega=2.0"}), ConfigError);
  // Gamma and K_m determine a drive, A = K_m/Gamma and omega = Gamma/sqrt(K_m): each replaces itself.
  for (const char* second : {"k_m = 4.0", "peak_velocity = 2.0"}) {
    const auto by_strengths = [&](const std::vector<std::string>& assigned) {
      return read_scene_text(std::string("[cell]\nwidth = 6.0\n[beads]\ncount = 9\n[contact]\nk_n = 1e5\n") +
                                 "restitution = 0.6\n[drive]\ngamma = 2.0\n" + second + "\n",
                             "s", assigned)
          .drive;
    };
    EXPECT_DOUBLE_EQ(by_strengths({"drive.gamma=8.0"}).amplitude, 0.5);
    EXPECT_DOUBLE_EQ(by_strengths({"drive.gamma=8.0"}).omega, 4);
    EXPECT_DOUBLE_EQ(by_strengths({"drive.k_m=16.0"}).amplitude, 8);
    EXPECT_DOUBLE_EQ(by_strengths({"drive.peak_velocity=4.0"}).amplitude, 8);
    EXPECT_DOUBLE_EQ(by_strengths({"drive.gamma=8.0", "drive.k_m=16.0"}).amplitude, 2);
    EXPECT_DOUBLE_EQ(by_strengths({"drive.gamma=8.0", "drive.omega=2.0"}).amplitude, 2);
    EXPECT_DOUBLE_EQ(by_strengths({"drive.k_m=16.0", "drive.amplitude=2.0"}).omega, 2);
  }
  // Of A and Gamma, an assigned omega does not tell which stays.
  EXPECT_THROW((void)drive("[drive]\namplitude = 2.0\ngamma = 2.0\n", {"drive.omega=3.0"}), ConfigError);
}

TEST(Presets, AreThePapersCells) {
  const Scene horizontal =
      read_scene_text("preset = \"bhateja-2016-horizontal\"\n[drive]\nk_m = 100.0\n", "s");
  EXPECT_EQ(horizontal.n_beads, 3000U);
  EXPECT_EQ(horizontal.drive.axis, Axis::x);
  for (const Wall& wall : horizontal.walls())
    EXPECT_EQ(wall.moves, wall.name == "left" || wall.name == "right") << wall.name;
  EXPECT_NEAR(static_cast<double>(*horizontal.n_beads) / (43 * 2), horizontal.depth, 0.2);  // two layers
  const Scene still = read_scene_text("preset = \"bhateja-2016-zero-g\"\n", "s");
  EXPECT_EQ(still.g(), 0);
  EXPECT_EQ(still.n_beads, 100U);
  for (const Wall& wall : still.walls()) EXPECT_TRUE(wall.moves) << wall.name;
  // The mirror planes of a crystal would confine its beads for ever.
  for (const std::string& name : preset_names()) {
    const bool still_cell = name == "bhateja-2016-zero-g";
    const Scene s = read_scene_text("preset = \"" + name + "\"\n[beads]\ncount = 9\n", "s",
                                    {still_cell ? "drive.omega=1" : "drive.peak_velocity=1"});
    EXPECT_EQ(s.start, name == "fortini-huang-2015" ? StartKind::crystal_a : StartKind::random) << name;
  }
  EXPECT_DOUBLE_EQ(
      read_scene_text("preset = \"bhateja-2016-smooth-3d\"\n[drive]\nk_m = 4.0\n", "s").drive.omega, 2);
}

}  // namespace
}  // namespace twincell::sim::scene_test
