// Overlapping starts, unequal sizes, tall boxes, invalid numbers.

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "core/error.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/collision.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/shaken_bed.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sim::geometry_test {
namespace {

/// A scene whose beads come from a table.
struct Table {
  TemporaryFolder folder;
  Scene scene(const std::string& csv, std::vector<std::string> set = {}) {
    std::ofstream(folder / "beads.csv") << csv;
    set.push_back("start.from=" + (folder / "beads.csv").string());
    return read_scene_text(
        "preset = \"fortini-huang-2015\"\n[drive]\namplitude = 1.5\n[start]\nkind = \"table\"\n"
        "[time]\ndiscard = 0\ncycles = 1\n",
        "scene.toml", set);
  }
};

TEST(Overlaps, AreRefusedAtTheStartByName) {
  Table t;
  const auto start = [&](const std::string& csv, const std::vector<std::string>& set = {}) {
    return [&t, csv, set] { Simulation(t.scene(csv, set)); };
  };
  expect_refusal<ConfigError>(start("x,z\n5,3\n5,3\n"), "beads 0 and 1 have the same centre");
  expect_refusal<ConfigError>(start("x,z\n5,3\n5,3\n", {"start.relax=true"}), "have the same centre");
  expect_refusal<ConfigError>(
      start("x,z\n5,3\n5.94,3\n9,3\n9.93,3\n"),
      "beads 2 and 3 overlap by 0.07 sigma, the bound is 0.05; 2 pairs exceed their bounds");
  expect_refusal<ConfigError>(start("x,z\n5,0.44\n"),
                              "bead 0 at (5, 0, 0.44) reaches 0.06 sigma into the wall");
  expect_refusal<ConfigError>(start("x,z\n25,3\n", {"start.relax=true"}), "into the wall \"right\"");
  expect_refusal<ConfigError>(start("x,z\n0.5,0.5\n1.3,0.5\n",
                                    {"start.relax=true", "cell.width=1.8", "cell.lid=wall", "cell.height=1"}),
                              "start.relax: the beads cannot be pushed apart");
}

TEST(Overlaps, RelaxedBeadsAreNotLaunched) {
  // Ninety beads in a space for forty, some almost at the same position.
  std::string csv = "x,z\n";
  std::mt19937_64 engine(3);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  for (int i = 0; i < 90; ++i)
    csv += std::to_string(0.3 + 7.4 * uniform()) + "," + std::to_string(0.3 + 4.5 * uniform()) + "\n";
  Table t;
  const Scene scene = t.scene(csv, {"start.relax=true", "cell.width=8", "cell.gravity=0", "cell.lid=wall",
                                    "cell.height=40", "drive.amplitude=0"});
  std::vector<Bead> before = from_table(scene).beads, after = make_start(scene).beads;
  const Plan plan = make_plan(scene, after);
  System s = make_system(scene, plan);
  s.beads = after;
  const auto kernel = make_solver(plan, guard_limits(plan));
  double fastest = 0;
  for (int k = 0; k < 20; ++k) {
    kernel->advance(s, 50);
    for (const Bead& b : s.beads) fastest = std::max(fastest, 0.5 * b.mass * (b.vx * b.vx + b.vz * b.vz));
  }
  std::printf("largest energy of a relaxed bead %.1e\n", fastest);
  EXPECT_LT(fastest, 1e-6);
  double moved = 0;  // relaxation did have to move them
  for (std::size_t i = 0; i < after.size(); ++i)
    moved = std::max(moved, std::hypot(after[i].x - before[i].x, after[i].z - before[i].z));
  EXPECT_GT(moved, 0.3);
  EXPECT_LT(moved, 10);
}

TEST(Sizes, KeysThatATableMakesVoidAreRefused) {
  Table t;
  const auto start = [&](const std::string& csv, const std::vector<std::string>& set) {
    const Scene scene = t.scene(csv, set);
    return [scene] { (void)make_start(scene); };
  };
  const std::string masses = "x,z,mass\n5,1,2\n7,1,3\n",
                    both = "x,z,radius,mass\n5,1,0.4,2\n7,1,0.5,2\n8.1,1,0.4,2\n";
  expect_refusal<ConfigError>(start(masses, {"beads.mass=4"}), "4 has no effect: ");
  expect_refusal<ConfigError>(start(masses, {"beads.mass=4"}),
                              "contains the masses of its beads, and 2 of 2 differ; remove the key");
  expect_refusal<ConfigError>(start(both, {"beads.radius=0.6"}),
                              "contains the radii of its beads, and 3 of 3 differ");
  EXPECT_NO_THROW(start(both, {})());
  EXPECT_NO_THROW(start("x,z,mass\n5,1,4\n7,1,4\n", {"beads.mass=4"})());
  // Without a column of masses, radius and mass of a bead state the material.
  const Scene material = t.scene("x,z,radius\n5,1,0.4\n7,1,0.5\n", {"beads.radius=0.8", "beads.mass=4"});
  EXPECT_DOUBLE_EQ(make_start(material).beads[0].mass, 1);
}

/// A hundred small discs, and one that is a hundred times larger and 1e6 times heavier and falls on them.
System unlike(SolverKind kind, std::string* said = nullptr) {
  std::string csv = "x,z,vz,radius,mass\n6,5.27,-1,5,1e4\n";
  for (int i = 0; i < 100; ++i)
    csv += std::to_string(1 + 0.101 * i) + "," + std::to_string(i % 2 == 0 ? 0.05 : 0.2) + ",0,0.05,0.01\n";
  Table t;
  const Scene scene = t.scene(csv, {"cell.width=12", "contact.k_n=1e7", "time.steps_per_contact=10"});
  const std::vector<Bead> beads = from_table(scene).beads;
  const Plan plan = make_plan(scene, beads);
  if (said != nullptr)
    for (const TimeLimit& l : plan.limits) *said += l.name + "\n";
  EXPECT_NEAR(plan.limits[0].time, std::numbers::pi / std::sqrt(1e7 / 0.005), 1e-2 * plan.limits[0].time);
  EXPECT_DOUBLE_EQ(plan.overlap_bound, 0.1 * 0.1);
  System s = make_system(scene, plan);
  s.beads = beads;
  GuardLimits limits = guard_limits(plan);
  limits.overlap = 0.05;  // the large disc causes large overlaps
  make_solver(plan, limits, kind)->advance(s, 8000);
  return s;
}

TEST(Sizes, UnequalBeadsAgreeWithTheOracle) {
  const System list = unlike(SolverKind::best);
  EXPECT_TRUE(same_bits(list, unlike(SolverKind::all_pairs)));
  double fastest = 0;  // the small discs were hit
  for (std::size_t i = 1; i < list.beads.size(); ++i) fastest = std::max(fastest, std::abs(list.beads[i].vx));
  EXPECT_GT(fastest, 0.1);
}

TEST(Sizes, LightestBeadSetsTheStepAndMedianBeadTheOverlapBound) {
  const auto plan_of = [](const std::vector<std::string>& set) {
    return make_plan(read_scene_text(
        "preset = \"fortini-huang-2015\"\n[beads]\ncount = 9\n[drive]\ngamma = 1\n", "s", set));
  };
  const Plan equal = plan_of({});
  const Plan light =
      plan_of({"beads.intruder.radius=0.005", "beads.intruder.mass=1e-6", "beads.intruder.z=40"});
  EXPECT_NEAR(light.dt, 1e-3 * equal.dt, 0.02e-3 * equal.dt);  // t_c is proportional to sqrt(mass)
  EXPECT_DOUBLE_EQ(light.overlap_bound, 0.1);
  EXPECT_DOUBLE_EQ(light.travel_bound, 0.05 * 0.01);
  EXPECT_EQ(plan_of({"beads.intruder.radius=5", "beads.intruder.mass=1e6", "beads.intruder.z=40"}).dt,
            equal.dt);
  // The masses of a file replace those of the scene.
  Table t;
  const Scene scene = t.scene("x,z,mass\n5,3,1\n9,3,0.01\n", {"start.settle_limit=0"});
  EXPECT_NEAR(Simulation(scene).plan().dt, 0.1 * equal.dt, 1e-3 * equal.dt);
}

std::size_t bytes_in_use() {
  const auto info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST(Sizes, LargeBeadDoesNotLengthenTheListsOfSmallBeads) {
  ShakenBed small({"beads.count=4000", "cell.width=400", "cell.lid=wall", "cell.height=300"}),
      mixed({"beads.count=4000", "cell.width=400", "cell.lid=wall", "cell.height=300",
             "beads.intruder.radius=50", "beads.intruder.z=150"});
  const auto grows = [](ShakenBed& bed) {
    const std::size_t before = bytes_in_use();
    bed.advance(50);
    return static_cast<double>(bytes_in_use() - before) / static_cast<double>(bed.system.beads.size());
  };
  const double alone = grows(small), beside = grows(mixed);
  std::printf("lists: %.0f bytes a bead, %.0f beside a bead a hundred times larger\n", alone, beside);
  EXPECT_LT(beside, 2 * alone + 500);
}

TEST(Input, InvalidBeadsAreRefusedByName) {
  Table t;
  for (const char* column : {"x", "z", "vx", "vz", "spin", "radius", "mass"})
    for (const char* value : {"nan", "inf", "-inf", "", "one", "1e999", "0x10"}) {
      const std::string name = column;
      const bool place = name == "x" || name == "z";
      const std::string header = place ? "x,z" : "x,z," + name;
      const std::string row = name == "x"   ? std::string(value) + ",3"
                              : name == "z" ? std::string("5,") + value
                                            : std::string("5,3,") + value;
      expect_refusal<InputError>([&] { Simulation(t.scene(header + "\n" + row + "\n")); },
                                 "beads.csv:2:", name + ": a finite number is needed");
    }
  for (const char* column : {"radius", "mass"})
    for (const char* value : {"0", "-1", "-0.0"})
      expect_refusal<InputError>(
          [&] { Simulation(t.scene(std::string("x,z,") + column + "\n5,3," + value + "\n")); },
          std::string(column) + ": ", "must be greater than 0");
  expect_refusal<InputError>([&] { Simulation(t.scene("x,z,id\n5,3,1\n7,3,1\n")); },
                             "id: there is no such column");
  expect_refusal<InputError>([&] { Simulation(t.scene("")); }, "the table is empty");
  expect_refusal<ConfigError>([&] { Simulation(t.scene("x,z\n5,1e300\n")); }, "bead 0", "is too far away");
  expect_refusal<ConfigError>([&] { Simulation(t.scene("x,z,vx\n5,3,1e5\n")); },
                              "scene.toml: start: ", "bead 0 moves", "sigma in one step");
  expect_refusal<ConfigError>([&] { Simulation(t.scene("x,z\n5,3\n", {"cell.height=2"})); },
                              "bead 0 reached the height of the cell, 2 sigma above the plate");
  expect_refusal<InputError>([&] { Simulation(t.scene("x,z\n", {"drive.amplitude=0.5"})); }, "has no bead");
}

TEST(Lists, BedThatMovesWithItsPlateKeepsItsList) {
  const auto lists_per_cycle = [](const char* gamma) {
    Simulation run(
        read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 400\n[time]\n"
                        "steps_per_contact = 20\ndiscard = 0\ncycles = 4\n",
                        "s", {std::string("drive.gamma=") + gamma}));
    const std::int64_t before = run.list_builds();
    MemoryTrajectory out(run.trajectory_info());
    run.run(out);
    const double lists = static_cast<double>(run.list_builds() - before) / 4;
    std::printf("Gamma = %s: %.1f lists a cycle\n", gamma, lists);
    return lists;
  };
  // In the laboratory frame, two beads of a bed that moves with its plate use up the skin of 1/4 after 1/8 of
  // the distance 4 A.
  EXPECT_LT(lists_per_cycle("0.9"), 0.1 * 4 * 0.9 / 0.125);
  // At Gamma = 2, reference positions in the laboratory frame caused 20,000 rebuilds in 6.4e6 steps, 45
  // cycles. There the two fastest beads at the surface determine the rate.
  EXPECT_LT(lists_per_cycle("2"), 0.5 * 20000 / 45);
}

TEST(TallBoxes, EmptySpaceCostsNothing) {
  for (const char* height : {"1e5", "1e9"}) {
    ShakenBed bed({"beads.count=200", std::string("cell.height=") + height, "cell.lid=wall"});
    bed.system.beads[3].z = 1e4, bed.system.beads[7].z = 100, bed.system.beads[9].z = 9.9e4;
    const std::size_t before = bytes_in_use();
    bed.advance(2000);
    const double grown = static_cast<double>(bytes_in_use() - before);
    std::printf("%.0f bytes\n", grown);
    EXPECT_LT(grown, 2e6);
    EXPECT_GT(bed.system.beads[3].z, 9e3);
  }
}

TEST(Drive, PlateAtRestOrBelowGammaOneRuns) {
  for (const char* gamma : {"0", "0.5", "0.99"}) {
    Simulation run(
        read_scene_text("preset = \"fortini-huang-2015\"\n[beads]\ncount = 40\n[time]\n"
                        "steps_per_contact = 20\ndiscard = 0\ncycles = 2\n",
                        "s", {std::string("drive.gamma=") + gamma}));
    MemoryTrajectory out(run.trajectory_info());
    run.run(out);
    const double lift = out.frames().back().position[0].z() - out.frames().back().plate_height;
    EXPECT_NEAR(lift, 0.5, 1e-4) << gamma;  // it never leaves the plate
  }
}

}  // namespace
}  // namespace twincell::sim::geometry_test
