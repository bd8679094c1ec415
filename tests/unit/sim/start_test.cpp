// Initial positions of beads: lattices against their geometry, random deposits, valid and invalid files.

#include "sim/start/start.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "core/error.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/system/cell_grid.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::sim::start_test {
namespace {

const std::string kFlat = "preset = \"fortini-huang-2015\"\n[drive]\ngamma = 1.0\n";
const std::string kSpace =
    "preset = \"bhateja-2016-rough-3d\"\n[start]\nkind = \"crystal_a\"\n[drive]\nk_m = 5.0\n";

Scene scene(const std::string& text, const std::vector<std::string>& set = {}) {
  return read_scene_text(text, "scene.toml", set);
}

/// Smallest gap between two beads; a negative value is an overlap.
double smallest_gap(const std::vector<Bead>& beads, const Scene& s) {
  double smallest = HUGE_VAL;
  for_each_near_pair(
      beads, s.dimension, s.period(), 0.5,
      [&](std::int32_t, std::int32_t, double gap, const Vec3&) { smallest = std::min(smallest, gap); });
  return smallest;
}

/// Largest overlap of a bead with a wall.
double deepest_in_wall(const std::vector<Bead>& beads, const Scene& s) {
  double deepest = -HUGE_VAL;
  for (const Wall& wall : s.walls())
    for (const Bead& b : beads)
      deepest = std::max(deepest, b.radius - (wall.n.dot(centre_of(b)) - wall.offset));
  return deepest;
}

template <class Action>
std::string complaint(Action action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}

void expect_says(const std::string& said, const std::string& wanted) {
  EXPECT_NE(said.find(wanted), std::string::npos) << "wanted: " << wanted << "\nsaid:   " << said;
}

TEST(Crystal, RowsOfPaperOne) {  // 20 and 19 beads alternately; 800 ends in a full row
  const auto beads = crystal_a(scene(kFlat, {"beads.count=800"})).beads;
  ASSERT_EQ(beads.size(), 800U);
  const auto in_row = [&](int row) {
    const double z = 0.5 + row * std::numbers::sqrt3 / 2;
    return std::count_if(beads.begin(), beads.end(), [&](const Bead& b) { return std::abs(b.z - z) < 1e-9; });
  };
  for (int row = 0; row < 41; ++row) EXPECT_EQ(in_row(row), row % 2 == 0 ? 20 : 19) << row;
}

TEST(Crystal, BeadsTouchAndStayInTheCell) {
  const std::vector<std::vector<std::string>> cells = {
      {"cell.width=20"},
      {"cell.width=10", "cell.sides=periodic"},
      {"cell.width=11.3"},
      {"cell.width=2.9", "cell.sides=periodic"},
      {"cell.width=1"},
      {"cell.width=7", "cell.sides=absent"},
      {"cell.dimension=3", "cell.depth=6", "cell.width=7"},
      {"cell.dimension=3", "cell.depth=5", "cell.width=5", "cell.sides=periodic", "cell.plates=periodic"},
      {"cell.dimension=3", "cell.depth=6.928203230275509", "cell.width=6", "cell.sides=periodic",
       "cell.plates=periodic"},
      {"cell.dimension=3", "cell.depth=4.1", "cell.width=7.7", "cell.plates=periodic"},
      {"cell.dimension=3", "cell.depth=1.15", "cell.width=20"},
      {"cell.dimension=3", "cell.depth=1.5", "cell.width=8"},
      {"cell.dimension=3", "cell.depth=3", "cell.width=8", "cell.plates=absent"},
      {"cell.width=9", "cell.side_tilt=-6"},
      {"cell.width=9", "cell.side_tilt=6"}};
  for (const char* kind : {"crystal_a", "crystal_b"})
    for (auto set : cells) {
      set.insert(set.end(), {"beads.count=150", std::string("start.kind=") + kind});
      const Scene s = scene(kFlat, set);
      const auto beads = make_start(s).beads;
      ASSERT_EQ(beads.size(), 150U);
      const std::string which = std::string(kind) + " " + set[0] + " " + set[1] + " " + set[2];
      const double gap = smallest_gap(beads, s);
      EXPECT_GE(gap, -1e-12) << which;
      EXPECT_LE(gap, s.width == 1 ? HUGE_VAL : 1e-12) << which;  // an upright row of crystal A has gaps
      EXPECT_LE(deepest_in_wall(beads, s), 1e-8) << which;
      EXPECT_NO_THROW(require_sound(beads, s, 1e-8)) << which;
    }
}

// 12 neighbours, 6 of them in the layer; in hexagonal stacking the layer is a mirror plane.
TEST(Crystal, IsClosePackedInSpace) {
  for (const char* kind : {"crystal_a", "crystal_b"}) {
    const Scene s = scene(kSpace, {"cell.sides=walls", "cell.plates=walls", "cell.width=8", "cell.depth=8",
                                   "beads.count=600", std::string("start.kind=") + kind});
    const auto beads = make_start(s).beads;
    const bool along_x = s.start == StartKind::crystal_b;  // layers are stacked along x, or along z
    int interior = 0;
    for (const Bead& b : beads) {
      if (b.x < 2 || b.x > 6 || b.y < 2 || b.y > 6 || b.z < 2 || b.z > 5) continue;
      std::vector<Vec3> bonds;
      for (const Bead& other : beads) {
        const Vec3 bond = centre_of(other) - centre_of(b);
        if (bond.norm() > 1e-9 && bond.norm() < 1 + 1e-9) bonds.push_back(bond);
      }
      ASSERT_EQ(bonds.size(), 12U) << kind;
      const auto stacked = [&](const Vec3& r) { return along_x ? r.x() : r.z(); };
      EXPECT_EQ(std::count_if(bonds.begin(), bonds.end(),
                              [&](const Vec3& r) { return std::abs(stacked(r)) < 1e-9; }),
                6);
      for (Vec3 mirrored : bonds) {
        (along_x ? mirrored.x() : mirrored.z()) *= -1;
        EXPECT_TRUE(std::any_of(bonds.begin(), bonds.end(),
                                [&](const Vec3& r) { return (r - mirrored).norm() < 1e-9; }));
      }
      // Rows touch along x in crystal A, along the vertical in crystal B.
      const Vec3 row = along_x ? Vec3::UnitZ() : Vec3::UnitX();
      EXPECT_TRUE(
          std::any_of(bonds.begin(), bonds.end(), [&](const Vec3& r) { return (r - row).norm() < 1e-9; }));
      ++interior;
    }
    EXPECT_GT(interior, 20) << kind;
  }
}

TEST(Crystal, CanonicalCellOfPaperTwoHasLayersOfTwentyFive) {
  const auto beads = crystal_a(scene(kSpace)).beads;
  ASSERT_EQ(beads.size(), 100U);
  for (int layer = 0; layer < 4; ++layer) {
    const double z = 0.5 + layer * std::sqrt(2.0 / 3);
    EXPECT_EQ(
        std::count_if(beads.begin(), beads.end(), [&](const Bead& b) { return std::abs(b.z - z) < 1e-9; }),
        25);
  }
}

TEST(Crystal, SlotHasTheCrystalOfThePlane) {
  for (const char* kind : {"crystal_a", "crystal_b", "random"}) {
    const std::string start = std::string("start.kind=") + kind;
    const auto plane = make_start(scene(kFlat, {"beads.count=90", start})).beads;
    const auto slot =
        make_start(scene(kFlat, {"beads.count=90", start, "cell.dimension=3", "cell.depth=1.15"})).beads;
    ASSERT_EQ(slot.size(), plane.size());
    for (std::size_t i = 0; i < plane.size() && std::string(kind) != "random"; ++i) {
      EXPECT_EQ(slot[i].x, plane[i].x);
      EXPECT_EQ(slot[i].y, 1.15 / 2);
      EXPECT_EQ(slot[i].z, plane[i].z);
    }
  }
}

TEST(Crystal, SaysWhenItDoesNotFit) {
  const std::vector<std::string> low = {"beads.count=400", "cell.lid=wall", "cell.height=12"};
  for (const char* kind : {"crystal_a", "crystal_b", "random"}) {
    auto set = low;
    set.push_back(std::string("start.kind=") + kind);
    const std::string said = complaint([&] { make_start(scene(kFlat, set)); });
    expect_says(said, "scene.toml: beads.count: ");
    expect_says(said, "in a cell 20 wide, 12 high");
  }
  auto closing = low;
  closing[1] = "cell.side_tilt=-30";
  closing[2] = "cell.width=9";
  expect_says(complaint([&] { make_start(scene(kFlat, closing)); }), "of 400 beads fit on the lattice");
}

TEST(Sizes, FollowTheirSpread) {
  for (const char* spread : {"uniform", "normal"})
    for (const char* width : {"0.05", "0.49"}) {
      const Scene s = scene(kFlat, {"beads.count=20000", std::string("beads.spread=") + spread,
                                    std::string("beads.spread_width=") + width, "cell.width=400"});
      const auto radii = draw_radii(s, 20000);
      double mean = 0, square = 0, largest = 0;
      for (const double r : radii) {
        const double deviation = r / s.radius - 1;
        mean += deviation / 20000;
        square += deviation * deviation / 20000;
        largest = std::max(largest, std::abs(deviation));
      }
      const double w = s.spread_width, cut = largest_deviation(s.spread, w) / w;
      // Variance of a uniform distribution, and of a normal distribution truncated at +-cut standard
      // deviations.
      const double tail = std::exp(-cut * cut / 2) / std::sqrt(2 * std::numbers::pi),
                   inside = std::erf(cut / std::numbers::sqrt2);
      const double expected = s.spread == SizeSpread::uniform ? w / std::numbers::sqrt3
                                                              : w * std::sqrt(1 - 2 * cut * tail / inside);
      std::printf("%s %s: deviation %.5f, expected %.5f\n", spread, width, std::sqrt(square), expected);
      EXPECT_NEAR(mean, 0, 4 * w / std::sqrt(20000.0));
      EXPECT_NEAR(std::sqrt(square), expected, 0.02 * expected);
      EXPECT_LE(largest, largest_deviation(s.spread, w));
      EXPECT_GT(largest, 0.95 * largest_deviation(s.spread, w));
    }
}

TEST(Sizes, MassesAreThoseOfOneMaterial) {
  for (const auto& [text, powers] : {std::pair(kFlat, 2), {kSpace, 3}}) {
    const Scene s = scene(text, {"beads.count=60", "beads.radius=0.4", "beads.mass=3", "beads.spread=uniform",
                                 "beads.spread_width=0.4", "cell.width=8"});
    for (const Bead& b : make_start(s).beads) {
      EXPECT_NEAR(b.mass, 3 * std::pow(b.radius / 0.4, powers), 1e-12);
      EXPECT_NEAR(b.inertia, (powers == 2 ? 0.5 : 0.4) * b.mass * b.radius * b.radius, 1e-12);
    }
  }
}

TEST(Start, ShippedScenesBeginAsTheirSourceSays) {
  const auto sample = [](const std::string& name) {
    const Scene s = read_scene(std::string(TWINCELL_SOURCE_DIR) + "/data_samples/" + name + "/scene.toml");
    auto beads = make_start(s).beads;
    EXPECT_NO_THROW(require_sound(beads, s, 1e-8)) << name;
    return std::pair(s, beads);
  };
  EXPECT_EQ(sample("fortini-huang-crystal").second.size(), 400U);
  const auto [rough, spheres] = sample("bhateja-rough-3d");
  EXPECT_DOUBLE_EQ(rough.drive.omega, std::sqrt(5));
  EXPECT_EQ(spheres.size(), 100U);
  const auto [slot, between] = sample("slot-3d");
  ASSERT_EQ(between.size(), 400U);
  for (const Bead& b : between) {
    EXPECT_NEAR(b.radius, 0.5, 0.015);
    EXPECT_NEAR(b.y, 1.15 / 2, 0.09);
  }
  const auto [with_intruder, bed] = sample("intruder");
  ASSERT_EQ(bed.size(), 401U);
  EXPECT_DOUBLE_EQ(bed.back().mass, 25);
  EXPECT_DOUBLE_EQ(bed.back().z - bed.back().radius, 0.5);
}

TEST(Start, AnySizesAndAnIntruderOverlapNowhere) {
  for (const std::string& text : {kFlat, kSpace})
    for (const char* kind : {"crystal_a", "crystal_b", "random"})
      for (const char* sides : {"walls", "periodic"}) {
        const Scene s =
            scene(text + "[cell]\nwidth = 12.0\n" + (text == kSpace ? "depth = 9.0\n" : ""),
                  {"beads.count=300", std::string("start.kind=") + kind, std::string("cell.sides=") + sides,
                   "beads.spread=normal", "beads.spread_width=0.2", "beads.intruder.radius=2",
                   "beads.intruder.z=2.5", "beads.intruder.x=3"});
        const auto beads = make_start(s).beads;
        ASSERT_EQ(beads.size(), 301U);
        EXPECT_EQ(beads.back().radius, 2);
        EXPECT_EQ(beads.back().x, 3);
        EXPECT_NEAR(beads.back().mass, s.dimension == 2 ? 16 : 64, 1e-12);
        EXPECT_GE(smallest_gap(beads, s), -1e-12) << kind << " " << sides;
        EXPECT_LE(deepest_in_wall(beads, s), 1e-8) << kind << " " << sides;
      }
}

TEST(Random, DrawsFromTheSeedAlone) {
  const Scene s = scene(kFlat, {"beads.count=50", "start.kind=random", "start.seed=5"});
  const auto beads = random_deposit(s).beads, again = random_deposit(s).beads;
  for (std::size_t i = 0; i < beads.size(); ++i) EXPECT_EQ(centre_of(beads[i]), centre_of(again[i]));
  // The first bead touches no other, so that its position follows directly from the standard's generator.
  std::mt19937_64 engine(5);
  EXPECT_EQ(beads[0].x, 0.5 + 19 * (static_cast<double>(engine() >> 11) * 0x1p-53));
  EXPECT_NE(random_deposit(scene(kFlat, {"beads.count=50", "start.kind=random", "start.seed=6"})).beads[0].x,
            beads[0].x);
}

// The beads take the stated share of the column up to the highest one.
TEST(Random, TheFractionSetsTheColumn) {
  for (const double fraction : {0.4, 0.1, 0.03}) {
    const Scene s =
        scene(kFlat, {"beads.count=400", "start.kind=random", "start.fraction=" + std::to_string(fraction)});
    const auto beads = random_deposit(s).beads;
    EXPECT_GE(smallest_gap(beads, s), -1e-12);
    double top = 0;
    for (const Bead& b : beads) top = std::max(top, b.z + 0.5);
    EXPECT_NEAR(400 * std::numbers::pi / 4 / (s.width * top), fraction, 0.03 * fraction);
  }
  const auto plain = random_deposit(scene(kFlat, {"beads.count=50", "start.kind=random"})).beads,
             stated =
                 random_deposit(scene(kFlat, {"beads.count=50", "start.kind=random", "start.fraction=0.4"}))
                     .beads;
  for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(plain[i].z, stated[i].z);  // 0.4 is the default
  expect_refusal<ConfigError>(
      [] {
        random_deposit(scene(kFlat, {"beads.count=400", "start.kind=random", "start.fraction=0.1",
                                     "cell.height=30", "cell.lid=wall"}));
      },
      "start.fraction", "needs a column of 157.1 sigma, but the cell ends at 30");
}

// The column of which the beads take a tenth, by its height.
TEST(Random, TheHeightSetsTheColumn) {
  const double tall = 400 * std::numbers::pi / 4 / (0.1 * 20);
  const auto column = [](const std::string& key) {
    return scene(kFlat, {"beads.count=400", "start.kind=random", key});
  };
  const auto by_height = random_deposit(column(fmt::format("start.height={:.17g}", tall))).beads,
             by_share = random_deposit(column("start.fraction=0.1")).beads;
  for (std::size_t i = 0; i < by_height.size(); ++i) EXPECT_NEAR(by_height[i].z, by_share[i].z, 1e-9);
  // At most half of the area: 400 pi/4 / (0.5 * 20).
  expect_refusal<ConfigError>([&] { random_deposit(column("start.height=31")); }, "start.height",
                              "is 31 sigma, but the beads need a column of 31.42 sigma");
  expect_refusal<ConfigError>(
      [&] {
        random_deposit(scene(kFlat, {"beads.count=400", "start.kind=random", "start.height=60",
                                     "cell.height=50", "cell.lid=wall"}));
      },
      "start.height", "is 60 sigma, but the cell ends at 50");
}

// Every bead is faster by the speed of fall, so that it lands on the bottom with sqrt(v^2 + 2 g h).
TEST(Random, BeadsFallWithTheStatedSpeed) {
  const auto dropped = [](const char* speed) {
    return random_deposit(scene(kFlat, {"beads.count=50", "start.kind=random", "start.height=200",
                                        std::string("start.fall_speed=") + speed}))
        .beads;
  };
  const auto slow = dropped("0"), fast = dropped("3");
  for (std::size_t i = 0; i < slow.size(); ++i) {
    EXPECT_EQ(centre_of(fast[i]), centre_of(slow[i]));
    EXPECT_EQ(fast[i].vx, slow[i].vx);
    EXPECT_NEAR(fast[i].vz, slow[i].vz - 3, 1e-15);
  }
}

// With these seeds the first beads lie so that the last find no room.
TEST(Random, ASmallCellBeginsAnewUntilAllBeadsHaveRoom) {
  for (const char* seed : {"8097129745161049", "2862574063938275"}) {
    const Scene s = scene(
        kFlat, {"cell.width=6", "beads.count=12", "start.kind=random", std::string("start.seed=") + seed});
    const auto beads = random_deposit(s).beads;
    EXPECT_GE(smallest_gap(beads, s), -1e-12) << seed;
    EXPECT_LE(deepest_in_wall(beads, s), 1e-8) << seed;
  }
  expect_refusal<ConfigError>(
      [] {
        random_deposit(scene(kFlat, {"cell.width=6", "beads.count=12", "start.kind=random", "cell.height=2.5",
                                     "cell.lid=wall"}));
      },
      "beads.count", "they would take 63 % of it below 2.5 sigma");
}

TEST(Random, ManyBeadsInSpaceTakeNoTime) {
  const Scene s = scene(kSpace, {"cell.width=30", "cell.depth=30", "beads.count=30000", "start.kind=random",
                                 "start.velocity_scale=3"});
  const auto beads = random_deposit(s).beads;
  EXPECT_GE(smallest_gap(beads, s), -1e-12);
  double fastest = 0, top = 0;
  for (const Bead& b : beads) {
    fastest = std::max({fastest, std::abs(b.vx), std::abs(b.vy), std::abs(b.vz)});
    top = std::max(top, b.z);
  }
  EXPECT_LE(fastest, 3);
  EXPECT_GT(fastest, 2.99);
  EXPECT_NEAR(30000 * std::numbers::pi / 6 / (30 * 30 * top), 0.25, 0.01);
}

TEST(Random, WithoutGravityBeadsFillTheCell) {
  const Scene s = scene("preset = \"bhateja-2016-zero-g\"\n");
  double mean = 0, top = 0;
  const auto beads = make_start(s).beads;
  for (const Bead& b : beads) {
    mean += b.z / static_cast<double>(beads.size());
    top = std::max(top, b.z + b.radius);
  }
  EXPECT_NEAR(mean, 5, 1);
  EXPECT_GT(top, 9);
  EXPECT_LE(top, 10);
}

TEST(Perturbation, IsSmallSeededAndOff) {
  const Scene off = scene(kFlat, {"beads.count=50"}),
              on = scene(kFlat, {"beads.count=50", "start.perturbation=1e-3"}),
              other = scene(kFlat, {"beads.count=50", "start.perturbation=1e-3", "start.seed=2"});
  const auto still = make_start(off).beads, a = make_start(on).beads, b = make_start(on).beads,
             c = make_start(other).beads;
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(centre_of(a[i]), centre_of(b[i]));
    EXPECT_NE(centre_of(a[i]), centre_of(c[i]));
    EXPECT_EQ(a[i].y, 0);
    largest = std::max({largest, std::abs(a[i].x - still[i].x), std::abs(a[i].z - still[i].z)});
  }
  EXPECT_LE(largest, 1e-3);
  EXPECT_GT(largest, 0.9e-3);
}

TEST(Relax, PushesLittleAndTheLighterBeadMore) {
  const Scene s = scene(kFlat, {"beads.count=2"});
  std::vector<Bead> pair(2);
  pair[0].x = 5, pair[1].x = 5.8, pair[0].z = pair[1].z = 5;
  pair[1].mass = 3;
  relax_overlaps(pair, s, 1e-4, 1);
  EXPECT_NEAR(pair[0].x, 5 - 0.0075, 1e-15);  // 0.01 in total
  EXPECT_NEAR(pair[1].x, 5.8 + 0.0025, 1e-15);
  EXPECT_LE(relax_overlaps(pair, s, 1e-4, 1000), 1e-4);
  EXPECT_NEAR(pair[1].x - pair[0].x, 1, 1e-4);
  std::vector<Bead> low(1);
  low[0].x = 5, low[0].z = 0.4;
  relax_overlaps(low, s, 1e-4, 1);
  EXPECT_NEAR(low[0].z, 0.41, 1e-15);
}

TEST(Relax, UndoesNoiseInAnyCell) {
  for (const std::string& text : {kFlat, kSpace})
    for (const char* spread : {"none", "uniform"}) {
      std::vector<std::string> set = {"beads.count=250", std::string("beads.spread=") + spread,
                                      "cell.width=9"};
      if (std::string(spread) != "none") set.emplace_back("beads.spread_width=0.3");
      const Scene s = scene(text, set);
      auto beads = make_start(s).beads;
      std::mt19937_64 engine(3);
      // Equal beads touch on their lattice; unequal beads are placed with the spacing of the largest.
      std::normal_distribution<double> noise(0, std::string(spread) == "none" ? 0.02 : 0.15);
      for (Bead& b : beads) {
        b.x += noise(engine), b.z += noise(engine);
        if (s.dimension == 3) b.y += noise(engine);
      }
      const auto noisy = beads;
      const double left = relax_overlaps(beads, s, 1e-4, 20000);
      double moved = 0;
      for (std::size_t i = 0; i < beads.size(); ++i)
        moved = std::max(moved, (centre_of(beads[i]) - centre_of(noisy[i])).norm());
      std::printf("%dD, %s: overlap left %.1e, largest displacement %.3f\n", s.dimension, spread, left,
                  moved);
      EXPECT_LE(left, 1e-4);
      EXPECT_GE(smallest_gap(beads, s), -2e-4);  // the last correction may push a bead into a neighbour
      EXPECT_LE(deepest_in_wall(beads, s), 2e-4);
      EXPECT_LT(moved, 0.5);
    }
}

TEST(Sound, NamesTheBead) {
  const Scene s = scene(kFlat, {"beads.count=3"});
  const auto said = [&](auto change) {
    std::vector<Bead> beads = crystal_a(s).beads;
    change(beads);
    return complaint([&] { require_sound(beads, s, 0.05); });
  };
  EXPECT_EQ(said([](auto&) {}), "accepted");
  expect_says(said([](auto& b) { b[1] = b[0]; }), "scene.toml: start: beads 0 and 1 have the same centre.");
  expect_says(said([](auto& b) { b[2].x -= 0.06; }), "beads 1 and 2 overlap by 0.06 sigma");
  expect_says(said([](auto& b) { b[2].x -= 0.14, b[1].x -= 0.08; }),
              "beads 0 and 1 overlap by 0.08 sigma, the bound is 0.05; 2 pairs exceed their bounds");
  EXPECT_EQ(said([](auto& b) { b[2].x -= 0.04; }), "accepted");
  expect_says(said([](auto& b) { b[1].vz = std::nan(""); }), "bead 1 has no finite position or velocity");
  expect_says(said([](auto& b) { b[1].spin_x = HUGE_VAL; }), "bead 1 has no finite position or velocity");
  expect_says(said([](auto& b) { b[2].z = 0.4; }),
              "bead 2 at (2.5, 0, 0.4) reaches 0.1 sigma into the wall \"bottom\"");
  const Scene narrow = scene(kFlat, {"beads.count=1", "cell.sides=periodic", "cell.width=3"});
  std::vector<Bead> large(2);
  large[0].radius = 0.8, large[0].z = 2, large[1].z = 9;
  expect_says(complaint([&] { require_sound(large, narrow, 0.05); }),
              "a bead of radius 0.8 would meet two images of another");
}

TEST(Sound, ChecksManyBeadsQuickly) {  // must not search all pairs: there are 5e9
  const Scene s = scene(kFlat, {"beads.count=100000", "cell.width=300"});
  auto beads = crystal_a(s).beads;
  EXPECT_NO_THROW(require_sound(beads, s, 0.05));
  beads[77777].x += 0.2;
  expect_says(complaint([&] { require_sound(beads, s, 0.05); }), "77777");
  EXPECT_LE(relax_overlaps(beads, s, 1e-3, 2000), 1e-3);
}

/// A trajectory with a single frame.
struct Film {
  TemporaryFolder folder;
  TrajectoryInfo info;
  Frame frame;
  Film() { info.box.upper = Vec3(8, 1, 20); }
  Scene scene_of(const std::vector<std::string>& more = {}) {
    info.n_beads = frame.position.size();
    std::filesystem::remove(folder / "start.h5");  // a film is not replaced by a simulation
    H5mdWriter writer(folder / "start.h5", info);
    writer.append(frame);
    writer.finish();
    std::vector<std::string> set = {"cell.width=8", "start.kind=trajectory",
                                    "start.from=" + (folder / "start.h5").string()};
    set.insert(set.end(), more.begin(), more.end());
    return scene(kFlat, set);
  }
};

TEST(Trajectory, ImpossibleOnesAreRefused) {
  const auto refusal = [](const std::vector<Vec3>& positions, const std::vector<std::string>& more = {}) {
    Film film;
    film.frame.position = positions;
    return complaint([&] { make_start(film.scene_of(more)); });
  };
  expect_says(refusal({Vec3(2, 0, 0.5), Vec3(2, 0, 0.5)}), "beads 0 and 1 have the same centre");
  expect_says(refusal({Vec3(2, 0, 0.5), Vec3(2.5, 0, 0.5)}), "beads 0 and 1 overlap by 0.5 sigma");
  expect_says(refusal({Vec3(9, 0, 0.5)}), "into the wall \"right\"");
  expect_says(refusal({Vec3(2, 0, 0.5)}, {"start.frame=1"}), "start.frame: frame 1 was requested");
  expect_says(refusal({Vec3(2, 0, 0.5)}, {"beads.count=2"}), "beads.count: 2 beads were specified");
  // Too many beads for the width: the relaxation ends in a jam.
  std::vector<Vec3> row;
  for (int i = 0; i < 9; ++i) row.emplace_back(0.5 + i * 0.875, 0, 0.5);
  expect_says(refusal(row, {"cell.lid=wall", "cell.height=1"}), "the beads cannot be pushed apart");
}

TEST(Trajectory, NoiseIsPushedApart) {
  Film film;
  film.frame.position = {Vec3(2, 0, 0.49), Vec3(2.96, 0, 0.5), Vec3(3.9, 0, 0.52)};
  const Start start = make_start(film.scene_of());
  EXPECT_GE(start.beads[1].x - start.beads[0].x, 1 - 1e-3);
  EXPECT_GE(start.beads[0].z, 0.5 - 1e-3);
}

TEST(Trajectory, PositionsCountFromThePlateAndEmptySlotsAreLeftOut) {
  Film film;
  film.info.columns.identity = film.info.columns.plate_height = true;
  film.info.tracer = {0, 1, 1};
  film.frame.position = {Vec3(2, 0, 1.5), Vec3(5, 0, 4), Vec3(std::nan(""), 0, 0)};
  film.frame.id = {0, 1, -1};
  film.frame.plate_height = 0.75;
  const Start vertical = make_start(film.scene_of());
  ASSERT_EQ(vertical.beads.size(), 2U);
  EXPECT_DOUBLE_EQ(vertical.beads[0].z, 0.75);
  EXPECT_DOUBLE_EQ(vertical.beads[0].x, 2);
  EXPECT_EQ(vertical.tracer, (std::vector<std::uint8_t>{0, 1}));
  film.info.drive = Drive{Axis::x, 1, 1};
  const Start horizontal = make_start(film.scene_of());
  EXPECT_DOUBLE_EQ(horizontal.beads[0].z, 1.5);
  EXPECT_DOUBLE_EQ(horizontal.beads[0].x, 1.25);
  // A vertical drive with a motion along x: both are subtracted, at the phase of the frame.
  film.info.drive = Drive{};
  film.info.drive->horizontal = HorizontalMotion{.amplitude = 0.5, .ratio = 1, .phase = 0.25};
  film.info.phases_per_cycle = 4;
  film.info.columns.phase = true;
  film.frame.phase = 0;
  film.frame.cycle = 0;
  EXPECT_DOUBLE_EQ(make_start(film.scene_of()).beads[0].x, 1.5);
  film.frame.phase = 2;
  EXPECT_DOUBLE_EQ(make_start(film.scene_of()).beads[0].x, 2.5);
}

TEST(Trajectory, SizesAreTheSimulationsNotTheCameras) {
  Film film;
  film.frame.position = {Vec3(2, 0, 1.5), Vec3(5, 0, 4)};
  film.info.radius = {0.6, 0.4};
  film.info.mass = {7, 2};
  film.info.source = Origin::experiment;
  EXPECT_EQ(make_start(film.scene_of()).beads[0].radius, 0.5);
  film.info.source = Origin::simulation;
  const auto beads = make_start(film.scene_of()).beads;
  EXPECT_EQ(beads[0].radius, 0.6);
  EXPECT_EQ(beads[0].mass, 7);
  EXPECT_DOUBLE_EQ(beads[0].inertia, 0.5 * 7 * 0.36);
  film.info.radius[1] = 0;
  expect_says(complaint([&] { make_start(film.scene_of()); }),
              "start.h5: radius: 0 of bead 1 is out of range");
}

TEST(Trajectory, PlaneIntoSlotAndNotBack) {
  Film film;
  film.frame.position = {Vec3(2, 0, 0.5), Vec3(2.97, 0, 0.5)};
  const auto slot = make_start(film.scene_of({"cell.dimension=3", "cell.depth=1.2"})).beads;
  EXPECT_DOUBLE_EQ(slot[0].y, 0.6);
  EXPECT_GE(slot[1].x - slot[0].x, 1 - 1e-3);
  film.info.box.dimension = 3;
  film.info.box.upper = Vec3(8, 6, 20);
  film.frame.position = {Vec3(2, 1, 0.5), Vec3(2.97, 5, 0.5)};
  EXPECT_DOUBLE_EQ(make_start(film.scene_of({"cell.dimension=3", "cell.depth=6"})).beads[1].y, 5);
  expect_says(complaint([&] { make_start(film.scene_of()); }), "start.from: ");
  expect_says(complaint([&] { make_start(film.scene_of()); }), "is three-dimensional, the cell is not");
}

struct Table {
  TemporaryFolder folder;
  std::string file = (folder / "beads.csv").string();
  Scene scene_of(const std::string& text, const std::string& base = kFlat,
                 const std::vector<std::string>& more = {}) {
    std::ofstream(file) << text;
    std::vector<std::string> set = {"start.kind=table", "start.from=" + file};
    set.insert(set.end(), more.begin(), more.end());
    return scene(base, set);
  }
};

TEST(BeadTable, HoldsWhatItNames) {
  Table table;
  const auto flat =
      make_start(table.scene_of("z, x,spin,radius\r\n0.5,2,-5,0.5\r\n\r\n3.25,4,0,1\r\n")).beads;
  ASSERT_EQ(flat.size(), 2U);
  EXPECT_EQ(flat[0].x, 2);
  EXPECT_EQ(flat[0].z, 0.5);
  EXPECT_EQ(flat[0].spin, -5);
  EXPECT_EQ(flat[1].radius, 1);
  EXPECT_DOUBLE_EQ(flat[1].mass, 4);
  EXPECT_DOUBLE_EQ(flat[1].inertia, 2);
  const auto space = make_start(table.scene_of("x,y,z,vx,vy,vz,spin_x,spin_z,mass\n1,2,3,4,5,6,7,8,9", kSpace,
                                               {"beads.count=1"}))
                         .beads;
  ASSERT_EQ(space.size(), 1U);
  const Bead& b = space[0];
  EXPECT_EQ(centre_of(b), Vec3(1, 2, 3));
  EXPECT_EQ(Vec3(b.vx, b.vy, b.vz), Vec3(4, 5, 6));
  EXPECT_EQ(Vec3(b.spin_x, b.spin_z, b.mass), Vec3(7, 8, 9));
  EXPECT_EQ(make_start(table.scene_of("x,z\n1,2", kSpace, {"beads.count=1"})).beads[0].y,
            2.5);  // the middle of the gap
}

// 2 mm and 9.81 m/s^2: v0 = 140.07 mm/s, t0 = 14.278 ms.
TEST(BeadTable, UnitsStandInTheNames) {
  Table table;
  const std::vector<std::string> in_cell = {"scale.sigma_mm=2.0", "scale.gravity_m_s2=9.81"};
  const auto beads =
      make_start(
          table.scene_of("x_mm,z_sigma,vx_mm_s,vz_v0,spin_rad_s,diameter_mm\n6,1.5,140.071,0.25,70.036,4\n",
                         kFlat, in_cell))
          .beads;
  ASSERT_EQ(beads.size(), 1U);
  const Bead& b = beads[0];
  EXPECT_DOUBLE_EQ(b.x, 3);
  EXPECT_EQ(b.z, 1.5);
  EXPECT_NEAR(b.vx, 1, 1e-5);
  EXPECT_EQ(b.vz, 0.25);
  EXPECT_NEAR(b.spin, 1, 1e-4);
  EXPECT_DOUBLE_EQ(b.radius, 1);
  EXPECT_DOUBLE_EQ(b.mass, 4);
  expect_says(complaint([&] { make_start(table.scene_of("z,x_mm\n1,2\n", kFlat, in_cell)); }),
              table.file +
                  ":1:1: z: has no unit although the scene has a laboratory scale; write z_sigma for "
                  "reduced units or z_mm for laboratory units.");
  expect_says(complaint([&] { make_start(table.scene_of("x,z_mm\n1,2\n")); }),
              table.file + ":1:3: z_mm: is 1 in laboratory units, which need scale.sigma_mm");
  expect_says(complaint([&] { make_start(table.scene_of("x,z,radius,diameter\n1,2,1,2\n")); }),
              ":1:12: diameter: the column occurs twice");
}

TEST(BeadTable, BadRowsAreNamed) {
  Table table;
  const auto expect_refused = [&](const std::string& text, const std::string& wanted) {
    expect_says(complaint([&] { make_start(table.scene_of(text)); }), table.file + wanted);
  };
  expect_refused("", ": the table is empty");
  expect_refused("x,z\n", ": the table has no bead");
  expect_refused("x,vx\n1,2\n", ":1: z: the column is missing");
  expect_refused("x,z,colour\n1,2,3\n", ":1:5: colour: there is no such column");
  expect_refused("x,z,x\n1,2,3\n", ":1:5: x: the column occurs twice");
  expect_refused("x,y,z\n1,2,3\n", ":1:3: y: beads of a 2D cell have no such column");
  expect_refused("x,z\n1,2\n1\n", ":3: 2 columns are needed, 1 were found");
  expect_refused("x,z\n1,2,3\n", ":2: 2 columns are needed, 3 were found");
  for (const char* bad : {"two", "", "nan", "inf", "1e999", "2 3", "0x10", "2;"})
    expect_refused("x,z\n1,2\n1, " + std::string(bad) + "\n",
                   std::string(":3:") + "4: z: a finite number is needed, not '" + bad + "'");
  expect_refused("x,z,radius\n1,2,0\n", ":2:5: radius: 0 is out of range; the value must be greater than 0");
  expect_refused("x,z,mass\n1,2,-1\n", ":2:5: mass: -1 is out of range");
  expect_says(complaint([&] { make_start(table.scene_of("x,z\n1,2\n", kFlat, {"beads.count=3"})); }),
              "beads.count: 3 beads were specified");
  std::filesystem::remove(table.file);
  expect_says(complaint([&] {
                make_start(scene(kFlat, {"start.kind=table", "start.from=" + table.file}));
              }),
              table.file);
}

TEST(Tracers, AreTheMiddleRowOfACrystal) {
  const Scene flat = scene(kFlat, {"beads.count=390"});  // ten double rows
  const auto beads = crystal_a(flat).beads;
  const auto tracer = choose_tracers(beads, flat);
  int chosen = 0;
  for (std::size_t i = 0; i < beads.size(); ++i)
    if (tracer[i] == 1) {
      ++chosen;
      EXPECT_NEAR(beads[i].z, 0.5 + 10 * std::numbers::sqrt3 / 2, 0.9);
    }
  EXPECT_TRUE(chosen == 19 || chosen == 20) << chosen;
  const Scene space = scene(kSpace, {"beads.count=125"});
  const auto layers = crystal_a(space).beads;
  const auto of_layer = choose_tracers(layers, space);
  EXPECT_EQ(std::count(of_layer.begin(), of_layer.end(), 1), 25);
  for (std::size_t i = 0; i < layers.size(); ++i) EXPECT_EQ(of_layer[i] == 1, i >= 50 && i < 75) << i;
}

TEST(Tracers, AreOneAColumnOtherwise) {
  const auto count = [](const Scene& s, const std::vector<Bead>& beads) {
    const auto tracer = choose_tracers(beads, s);
    return std::count(tracer.begin(), tracer.end(), 1);
  };
  const Scene flat = scene(kFlat, {"beads.count=400", "start.kind=random"});
  EXPECT_EQ(count(flat, random_deposit(flat).beads), 20);
  const Scene space = scene(kSpace, {"beads.count=1000", "start.kind=random"});
  auto beads = random_deposit(space).beads;
  EXPECT_EQ(count(space, beads), 25);
  // A bead that has drifted across a period remains in its column.
  const auto before = choose_tracers(beads, space);
  for (Bead& b : beads) b.x += 10, b.y -= 15;
  EXPECT_EQ(choose_tracers(beads, space), before);
  const Scene big =
      scene(kFlat, {"beads.count=100", "start.kind=random", "beads.intruder.radius=3", "beads.intruder.z=4"});
  const auto with_intruder = choose_tracers(random_deposit(big).beads, big);
  EXPECT_EQ(with_intruder.back(), 0);
  EXPECT_EQ(choose_tracers({}, flat).size(), 0U);
}

}  // namespace
}  // namespace twincell::sim::start_test
