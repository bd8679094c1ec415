// Third-party LAMMPS dumps: columns and ids in any order, missing beads, coordinates scaled, wrapped or not;
// and files that are not dumps.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/foreign/foreign_trajectory.hpp"

namespace twincell::lammps_dump_test {
namespace {

constexpr double kExact = 1e-15;

std::string frame_text(long step, const std::string& flags, const std::string& columns,
                       const std::vector<std::string>& atoms) {
  return fmt::format(
      "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS {}\n0 8\n-2 10\n-0.5 "
      "0.5\nITEM: ATOMS {}\n{}{}",
      step, atoms.size(), flags, columns, fmt::join(atoms, "\n"), atoms.empty() ? "" : "\n");
}

ForeignOptions reduced() {
  ForeignOptions options;
  options.timestep = 0.01;
  return options;
}

class Dump : public ::testing::Test {
 protected:
  MemoryTrajectory read(const std::string& text, const ForeignOptions& options = reduced()) {
    put_file(file(), text);
    const ForeignTrajectory dump(file(), foreign_format("lammps-dump", ""), options);
    MemoryTrajectory trajectory(dump.info());
    dump.copy_to(trajectory);
    EXPECT_EQ(trajectory.n_frames(), dump.n_frames());
    return trajectory;
  }
  /// The message with which `text` is refused, without the folder's name.
  std::string refusal(const std::string& text, const ForeignOptions& options = reduced()) {
    try {
      read(text, options);
    } catch (const InputError& e) {
      const std::string said = e.what(), folder = folder_.path().string() + "/";
      EXPECT_EQ(said.rfind(folder, 0), 0U) << said;
      return said.substr(folder.size());
    } catch (const ConfigError& e) {
      return std::string("options: ") + e.what();
    }
    return "accepted";
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "d"; }

 private:
  TemporaryFolder folder_;
};

TEST_F(Dump, ColumnsAndIdsInAnyOrder) {
  const auto t = read(frame_text(0, "ff fm pp", "vy element y id vx omegaz x",
                                 {"0.5 Cu 2 7 0.25 3 1", "0.75 Cu 4 3 0.125 -1 5"}) +
                      frame_text(50, "ff fm pp", "vy element y id vx omegaz x",
                                 {"0.5 Cu 2 3 0.25 3 1", "0.75 Cu 4 7 0.125 -1 5"}));
  ASSERT_EQ(t.info().n_beads, 2U);
  EXPECT_TRUE(t.info().columns.velocity && t.info().columns.spin);
  EXPECT_FALSE(t.info().columns.identity || t.info().columns.phase || t.info().columns.plate_height);
  EXPECT_TRUE(t.info().radius.empty() && t.info().tracer.empty() && !t.info().drive);
  EXPECT_EQ(t.info().box.boundary[0], Boundary::wall);
  EXPECT_EQ(t.info().box.upper, Vec3(8, 1, 10));
  const auto& f = t.frames();
  EXPECT_EQ(f[0].position[0], Vec3(5, 0, 4));  // id 3
  EXPECT_EQ(f[0].velocity[0], Vec3(0.125, 0, 0.75));
  EXPECT_EQ(f[0].spin[0], Vec3(0, 1, 0));  // counter-clockwise in (x, y) is about -y in Twincell's axes
  EXPECT_EQ(f[0].position[1], Vec3(1, 0, 2));
  EXPECT_EQ(f[1].position[0], Vec3(1, 0, 2));
  EXPECT_DOUBLE_EQ(f[1].time, 0.5);
}

TEST_F(Dump, BeadsMayBeMissing) {
  const auto t =
      read(frame_text(0, "ff ff pp", "id x y", {"9 1 1"}) + frame_text(1, "ff ff pp", "id x y", {}) +
           frame_text(2, "ff ff pp", "id x y", {"9 3 1", "2 2 1"}));
  ASSERT_EQ(t.info().n_beads, 2U);
  EXPECT_TRUE(t.info().columns.identity);
  const std::vector<std::int64_t> none{-1, -1}, second{-1, 1}, both{0, 1};
  EXPECT_EQ(t.frames()[0].id, second);
  EXPECT_EQ(t.frames()[1].id, none);
  EXPECT_EQ(t.frames()[2].id, both);
  EXPECT_TRUE(std::isnan(t.frames()[0].position[0].x()));
}

// A bead that moves right by 3 a frame in a period of 8, in every notation of its position.
TEST_F(Dump, AllCoordinateColumnsAreRead) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> ways = {
      {"id xu y", {"1 6 1", "1 9 1", "1 12 1"}},
      {"id xsu ys", {"1 0.75 0.25", "1 1.125 0.25", "1 1.5 0.25"}},
      {"id x y", {"1 6 1", "1 1 1", "1 4 1"}},
      {"id xs y", {"1 0.75 1", "1 0.125 1", "1 0.5 1"}},
      {"id x y ix", {"1 6 1 0", "1 1 1 1", "1 4 1 1"}},
      {"id xs y ix", {"1 0.75 1 0", "1 0.125 1 1", "1 0.5 1 1"}},
      {"id x xu y", {"1 6 6 1", "1 1 9 1", "1 4 12 1"}},
  };
  for (const auto& [columns, atoms] : ways) {
    std::string text;
    for (std::size_t k = 0; k < 3; ++k)
      text += frame_text(static_cast<long>(k), "pp fm pp", columns, {atoms[k]});
    const auto t = read(text);
    EXPECT_EQ(t.info().box.boundary[0], Boundary::periodic);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(t.frames()[k].position[0], Vec3(6 + 3.0 * static_cast<double>(k), 0, 1)) << columns;
  }
}

TEST_F(Dump, ThreeDimensionsKeepTheirAxes) {
  ForeignOptions options = reduced();
  options.dimension = 3;
  options.origin = Vec3(1, -2, -0.5);
  options.bead_mass = 2;
  const auto t = read(frame_text(0, "ff pp ff", "id type x y z vx vy vz omegax omegay omegaz diameter mass",
                                 {"1 1 2 3 0.25 4 5 6 7 8 9 1 6"}),
                      options);
  EXPECT_EQ(t.frames()[0].position[0], Vec3(1, 5, 0.75));
  EXPECT_EQ(t.frames()[0].velocity[0], Vec3(4, 5, 6));
  EXPECT_EQ(t.frames()[0].spin[0], Vec3(7, 8, 9));
  EXPECT_EQ(t.info().radius.at(0), 0.5);
  EXPECT_EQ(t.info().mass.at(0), 3);
  EXPECT_EQ(t.info().box.boundary[1], Boundary::periodic);
  EXPECT_EQ(t.info().box.upper, Vec3(7, 12, 1));
}

// 2 mm beads in metres and seconds, 50 Hz, 4 frames a cycle, a wall that oscillates from step 0 on.
TEST_F(Dump, LaboratoryUnitsAndPhases) {
  ForeignOptions options;
  options.timestep = 1e-5;
  options.sigma = 2e-3;
  options.gravity = 9.81;
  options.drive = {.amplitude = 1e-3, .frequency = 50.0};
  options.phases_per_cycle = 4;
  options.phase_of_step_zero = 0.75;
  options.tracer_type = 2;
  std::string text;
  for (long k = 0; k < 6; ++k)
    text += frame_text(500 * k, "ff ff pp", "id type radius x y vx vy",
                       {fmt::format("1 2 0.001 0.004 {} 0.14 0", 0.001 + 1e-4 * static_cast<double>(k)),
                        "2 1 0.001 0.006 0.001 0 0"});
  const auto t = read(text, options);
  const double t0 = std::sqrt(2e-3 / 9.81);
  const auto& f = t.frames();
  EXPECT_NEAR(f[1].time, 0.005 / t0, kExact);
  EXPECT_NEAR(f[0].velocity[0].x(), 0.14 / std::sqrt(2e-3 * 9.81), kExact);
  EXPECT_NEAR(f[0].position[0].x(), 2, kExact);
  EXPECT_NEAR(t.info().radius[0], 0.5, kExact);
  EXPECT_NEAR(t.info().drive->gamma(), 1e-3 * std::pow(2 * std::numbers::pi * 50, 2) / 9.81, 1e-12);
  const std::vector<std::uint8_t> tracer{1, 0};
  EXPECT_EQ(t.info().tracer, tracer);
  const std::vector<int> phase{3, 0, 1, 2, 3, 0};
  const std::vector<long> cycle{0, 1, 1, 1, 1, 2};
  const std::vector<double> height{-0.5, 0, 0.5, 0, -0.5, 0};
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(f[k].phase, phase[k]);
    EXPECT_EQ(f[k].cycle, cycle[k]);
    EXPECT_NEAR(f[k].plate_height, height[k], 1e-12);
  }
}

TEST_F(Dump, TimeMayStandInTheDump) {
  const std::string text =
      "ITEM: UNITS\nlj\nITEM: TIME\n0.75\n" + frame_text(3, "ff ff pp", "id x y", {"1 1 1"});
  ForeignOptions options;
  EXPECT_EQ(read(text, options).frames()[0].time, 0.75);
  EXPECT_EQ(refusal(frame_text(3, "ff ff pp", "id x y", {"1 1 1"}), options).rfind("options: --timestep", 0),
            0U);
}

// LAMMPS states its units on request (dump_modify units yes). Lengths in metres are no bead diameters.
TEST_F(Dump, UnitsMayStandInTheDump) {
  const std::string frame = frame_text(3, "ff ff pp", "id x y", {"1 1 1"});
  for (const auto& [units, length] : {std::pair{"lj", ""}, {"si", "m"}, {"cgs", "cm"}, {"nano", "nm"}}) {
    put_file(file(), fmt::format("ITEM: UNITS\n{}\n", units) + frame);
    EXPECT_EQ(ForeignTrajectory(file(), foreign_format("lammps-dump", ""), reduced()).length_unit(), length)
        << units;
  }
  const Ran ran = run_program(
      {"import", file(), "-o", file().string() + ".h5", "--format", "lammps-dump", "--timestep", "0.01"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("the lengths of the file are in nm, so the bead diameter in nm is needed"),
            std::string::npos)
      << ran.err;
}

TEST_F(Dump, MalformedOnesAreRefusedByLine) {
  const std::string good = frame_text(0, "ff ff pp", "id x y", {"1 1 1", "2 2 1"});
  ASSERT_EQ(refusal(good), "accepted");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(refusal(""), "d: the file holds no frame.");
  EXPECT_EQ(
      refusal("\x89HDF\n"),
      "d:1: 'ITEM: TIMESTEP' is missing; this is not a text dump of LAMMPS. Formats that are read: xyz, "
      "lammps-dump, gsd, csv, trackmate.");
  EXPECT_EQ(refusal(with("2 2 1\n", "")), "d:10: the file ends where an atom should be.");
  EXPECT_EQ(refusal(good.substr(0, good.find("ITEM: BOX"))), "d:4: the file ends within a frame.");
  EXPECT_EQ(refusal(with("ATOMS id x y", "ATOMS ")),
            "d:9: there is no column 'id', without which beads cannot be identified.");
  EXPECT_EQ(refusal(with("2 2 1", "2 2")), "d:11: 3 columns are needed, 2 were found.");
  EXPECT_EQ(refusal(with("2 2 1", "2 two 1")), "d:11: 'two' is not a finite number.");
  EXPECT_EQ(refusal(with("2 2 1", "2 nan 1")), "d:11: 'nan' is not a finite number.");
  EXPECT_EQ(refusal(with("2 2 1", "1 2 1")), "d:11: the bead with id 1 occurs twice in a frame.");
  EXPECT_EQ(refusal(with("2 2 1", "2.5 2 1")), "d:11: '2.5' is not a whole number.");
  EXPECT_EQ(refusal(with("ATOMS id", "ATOMS mol")),
            "d:9: there is no column 'id', without which beads cannot be identified.");
  EXPECT_EQ(refusal(with("id x y", "id x vy")),
            "d:9: there is no column for the positions along y (y, yu, ys or ysu).");
  EXPECT_EQ(refusal(with("id x y", "id x x")), "d:9: the column 'x' occurs twice.");
  EXPECT_EQ(refusal(with("id x y", "id x y radius diameter")),
            "d:9: the columns 'radius' and 'diameter' both state the size of a bead; dump one of them.");
  EXPECT_EQ(refusal(with("ff ff pp", "xy xz yz ff ff pp")), "d:6: 3 numbers are needed, '0 8' was found.");
  EXPECT_EQ(refusal(with("0 8", "8 0")), "d:6: the box is empty: 8 is not below 0.");
  EXPECT_EQ(refusal(with("ATOMS\n2", "ATOMS\n-2")), "d:4: -2 atoms are announced.");
  EXPECT_EQ(refusal(with("ATOMS\n2", "ATOMS\n99999999999999999999")),
            "d:4: '99999999999999999999' is not a whole number.");
  EXPECT_EQ(refusal(with("ATOMS\n2", "ATOMS\n1")), "d:11: 'ITEM:' is missing, '2 2 1' was found.");
  EXPECT_EQ(refusal(with("ITEM: TIMESTEP\n0\n", "")), "d:7: atoms come before 'ITEM: TIMESTEP'.");
  EXPECT_EQ(refusal(with("ITEM: TIMESTEP", "ITEM: TIMES")), "d:1: the section 'ITEM: TIMES' is unknown.");
  EXPECT_EQ(refusal(good + good), "d:13: step 0 comes after step 0.");
  EXPECT_EQ(refusal(good + frame_text(1, "ff ff pp", "id y x", {})),
            "d:20: the columns are not those of the first frame.");
  EXPECT_EQ(refusal(good + frame_text(1, "pp ff pp", "id x y", {})),
            "d:13: the box is not periodic as it was in the first frame.");
  EXPECT_EQ(refusal(frame_text(0, "ff ff ff", "id x y z", {"1 1 1 0.3"})), "accepted");
  EXPECT_EQ(refusal(frame_text(0, "ff ff ff", "id x y z", {"1 1 1 0.3", "2 3 1 0.5"})),
            "d:11: bead 2 is at z = 0.5, not in the plane z = 0.3 of the first bead; is this a "
            "three-dimensional system (--dimension 3)?");
}

TEST_F(Dump, TypesThatAreNotReadAsTracersAreSaid) {
  const auto said = [&](const std::vector<std::string>& beads, std::optional<long> tracers) {
    put_file(file(), frame_text(0, "ff ff pp", "id type x y", beads));
    ForeignOptions options = reduced();
    options.tracer_type = tracers;
    return ForeignTrajectory(file(), foreign_format("lammps-dump", ""), options).assumption();
  };
  const std::vector<std::string> two = {"1 1 1 1", "2 7 3 1", "3 1 5 1"};
  EXPECT_EQ(said(two, {}),
            "the file has beads of 2 types (2 of type 1, 1 of type 7), and none is taken for a tracer "
            "(--tracer-type).");
  EXPECT_EQ(said(two, 7), "");
  EXPECT_EQ(said({"1 3 1 1", "2 3 3 1"}, {}), "");
}

TEST_F(Dump, OptionsThatDoNotFitAreRefused) {
  const std::string text =
      frame_text(0, "ff ff pp", "id x y", {"1 1 1"}) + frame_text(77, "ff ff pp", "id x y", {});
  ForeignOptions options = reduced();
  options.phases_per_cycle = 4;
  EXPECT_EQ(refusal(text, options),
            "options: --frames-per-cycle: has no meaning without the drive, whose period is then unknown.");
  options.drive = {.amplitude = 1.0, .omega = 2 * std::numbers::pi};
  EXPECT_EQ(refusal(text, options),
            "d:12: step 77 is at 0.7700 cycles, not at one of 4 phases of a cycle; check the time step, the "
            "drive and the frames per cycle.");
  options.phases_per_cycle = 100;
  EXPECT_EQ(refusal(text, options), "accepted");
  options.tracer_type = 1;
  EXPECT_EQ(refusal(text, options), "options: --tracer-type: the file has no types of beads.");
  options = reduced();
  options.drive_axis = Axis::y;
  EXPECT_EQ(refusal(text, options), "options: --drive-axis: a 2D system has no y axis.");
  options = reduced();
  options.sigma = 0;
  EXPECT_EQ(refusal(text, options), "options: --sigma: 0 is out of range; the value must be greater than 0.");
  options = reduced();
  options.origin = Vec3(0, 11, 0);
  EXPECT_EQ(refusal(text, options),
            "options: --cell-origin: the origin of the cell, its lower left corner, is above or to the right "
            "of all beads.");
}

// Bytes changed, removed and duplicated anywhere: the dump is refused with a line number or read as finite
// numbers.
TEST_F(Dump, DamagedOnesNeitherCrashNorPass) {
  std::string good;
  for (long k = 0; k < 4; ++k)
    good += frame_text(50 * k, "pp fm pp", "id type radius x y z vx vy vz omegax omegay omegaz ix iy",
                       {"1 1 0.5 1.25 3 0 0.1 0.2 0 0 0 1 0 0", "2 1 0.5 2.5 3 0 0.1 -0.2e-3 0 0 0 1 -1 0",
                        "5 2 0.5 5.5 1 0 0.1 0.2 0 0 0 1 1 0"});
  std::mt19937_64 chance(20240707);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(chance() % n); };
  const std::string letters = "0123456789+-.e \n\t\rnaifx\xff:IM";
  int refused = 0, accepted = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string text = good;
    for (std::size_t wounds = 1 + below(3); wounds > 0; --wounds) {
      const std::size_t at = below(text.size()), length = std::min(1 + below(40), text.size() - at);
      const std::size_t kind = below(8);
      if (kind < 5)
        text[at] = letters[below(letters.size())];
      else if (kind == 5)
        text.erase(at, length);
      else if (kind == 6)
        text.insert(at, text.substr(at, length));
      else
        text.resize(at + 1);
    }
    const std::string said = refusal(text);
    if (said == "accepted") {
      ++accepted;
      const MemoryTrajectory t = read(text);
      for (const Frame& f : t.frames())
        for (std::size_t i = 0; i < f.position.size(); ++i)
          EXPECT_EQ(f.present(i), f.position[i].allFinite() && f.velocity[i].allFinite()) << text;
    } else {
      ++refused;
      EXPECT_TRUE(said.rfind("d:", 0) == 0 || said.rfind("options:", 0) == 0) << said;
    }
  }
  fmt::print("{} refused, {} still dumps\n", refused, accepted);
  EXPECT_GT(refused, 1000);
  EXPECT_GT(accepted, 100);
}

}  // namespace
}  // namespace twincell::lammps_dump_test
