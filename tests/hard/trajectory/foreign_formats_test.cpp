// Every format of another program: what is written is read back, and what is damaged is refused with one
// sentence.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <csignal>
#include <memory>
#include <random>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/foreign/export_trajectory.hpp"
#include "trajectory/foreign/foreign_trajectory.hpp"

namespace twincell::foreign_formats_test {
namespace {

const Vec3 kNowhere = Vec3::Constant(std::nan(""));

/// Three beads in three frames; bead 1 is missing from the second frame, bead 2 crosses the period of x.
MemoryTrajectory three_beads(int dimension) {
  TrajectoryInfo info;
  info.n_beads = 3;
  info.columns = {.velocity = true, .spin = true, .identity = true, .phase = true, .plate_height = true};
  info.box.dimension = dimension;
  info.box.lower = Vec3(0, dimension == 2 ? -0.5 : 0, 0);
  info.box.upper = Vec3(8, dimension == 2 ? 0.5 : 6, 10);
  info.box.boundary = {Boundary::periodic, dimension == 2 ? Boundary::open : Boundary::wall, Boundary::wall};
  info.drive = Drive{.axis = Axis::z, .amplitude = 0.5, .omega = 2};
  info.phases_per_cycle = 4;
  info.radius = {0.5, 0.25, 0.5};
  info.mass = {1, 0.125, 1};
  info.tracer = {0, 1, 0};
  MemoryTrajectory t(info);
  const double depth = dimension == 2 ? 0 : 1;
  for (int f = 0; f < 3; ++f) {
    Frame frame;
    frame.step = 100 * f;
    frame.time = f * info.drive->period() / 4;
    frame.phase = f;
    frame.cycle = 0;
    frame.plate_height = info.drive->displacement(f / 4.0);
    frame.position = {Vec3(1.1, 2 * depth, 0.1 * f + 0.5), Vec3(4.25, 3 * depth, 3.3),
                      Vec3(7.5 + f * 0.4, depth, 1.75)};
    frame.velocity = {Vec3(0.1, 0.5 * depth, 0.2), Vec3(-1, depth, 0.25), Vec3(0.3, -depth, 0)};
    frame.spin = {Vec3(depth, -1, 2 * depth), Vec3(0, 0.5, 0), Vec3(0, 0.125, 0)};
    frame.id = {0, 1, 2};
    if (f == 1) {
      frame.position[1] = frame.velocity[1] = frame.spin[1] = kNowhere;
      frame.id[1] = -1;
    }
    t.append(frame);
  }
  return t;
}

class ForeignFormats : public ::testing::Test {
 protected:
  MemoryTrajectory read(const std::string& word, const ForeignOptions& options) {
    const ForeignTrajectory source(file(), foreign_format(word, ""), options);
    MemoryTrajectory t(source.info());
    source.copy_to(t);
    return t;
  }
  /// The message with which `text` is refused, without the folder's name.
  std::string refusal(const std::string& word, const std::string& text,
                      ForeignOptions options = {.timestep = 1}) {
    put_file(file(), text);
    try {
      read(word, options);
    } catch (const Error& e) {
      const std::string said = e.what(), folder = folder_.path().string() + "/";
      return said.starts_with(folder) ? said.substr(folder.size()) : said;
    }
    return "accepted";
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "f"; }

 private:
  TemporaryFolder folder_;
};

ForeignOptions options_of(const MemoryTrajectory& t) {
  ForeignOptions options;
  options.dimension = t.info().box.dimension;
  options.drive.amplitude = 0.5;
  options.drive.omega = 2;
  options.phases_per_cycle = 4;
  options.bead_mass = 1;
  options.tracer_type = 2;
  options.timestep = t.frames()[1].time / 100;
  return options;
}

void expect_vector(const Vec3& a, const Vec3& b, double tolerance, int dimension, const std::string& what) {
  for (int k = 0; k < 3; ++k) {
    if (dimension == 2 && k == 1) continue;
    EXPECT_NEAR(a[k], b[k], tolerance) << what << " along "
                                       << "xyz"[k];
  }
}

TEST_F(ForeignFormats, WhatIsWrittenIsReadBack) {
  for (const ForeignFormat* format : foreign_formats()) {
    if (format->create == nullptr || format->open == nullptr) continue;
    if (format->word == "trackmate") continue;  // positions, times and radii only: TrackMateTracks
    const bool is_table = format->word == "csv";
    const double tolerance = format->word == "gsd" ? 1e-6 : 1e-14;  // single precision
    for (const int dimension : {2, 3}) {
      SCOPED_TRACE(fmt::format("{} in {}D", format->word, dimension));
      const MemoryTrajectory out = three_beads(dimension);
      EXPECT_EQ(export_trajectory(out, *format, ExportUnits::reduced(out.info()), file(), "f"), 3U);
      ForeignOptions options = options_of(out);
      if (is_table) options.timestep.reset();  // has times
      const MemoryTrajectory in = read(std::string(format->word), options);
      ASSERT_EQ(in.n_frames(), 3U);
      ASSERT_EQ(in.info().n_beads, 3U);
      EXPECT_EQ(in.info().source, is_table ? Origin::unknown : Origin::simulation);
      EXPECT_EQ(in.info().tracer, out.info().tracer);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(in.info().radius[i], out.info().radius[i], tolerance);
        EXPECT_NEAR(in.info().mass[i], out.info().mass[i], tolerance);
      }
      if (!is_table) {  // a table has no box
        EXPECT_EQ(in.info().box.boundary[0], Boundary::periodic);
        EXPECT_EQ(in.info().box.boundary[2], Boundary::wall);
        EXPECT_NEAR(in.info().box.upper.x(), 8, 8 * tolerance);
        EXPECT_NEAR(in.info().box.upper.z(), 10, 20 * tolerance);
        if (dimension == 2) {
          EXPECT_NEAR(in.info().box.size().y(), 1, tolerance);
        }
      }
      for (std::size_t f = 0; f < 3; ++f) {
        const Frame &a = in.frames()[f], &b = out.frames()[f];
        EXPECT_NEAR(a.time, b.time, 1e-13);
        EXPECT_EQ(a.phase, b.phase);
        EXPECT_NEAR(a.plate_height, b.plate_height, 1e-13);
        for (std::size_t i = 0; i < 3; ++i) {
          ASSERT_EQ(a.present(i), b.present(i)) << "bead " << i << " of frame " << f;
          if (!b.present(i)) continue;
          const std::string what = fmt::format("bead {} of frame {}", i, f);
          expect_vector(a.position[i], b.position[i], 10 * tolerance, dimension, "position of " + what);
          expect_vector(a.velocity[i], b.velocity[i], tolerance, dimension, "velocity of " + what);
          if (in.info().columns.spin) {
            EXPECT_LT((a.spin[i] - b.spin[i]).norm(), tolerance) << "spin of " + what;
          }
        }
      }
      // LAMMPS and XYZ carry the spin, the others do not (docs/formats.md).
      EXPECT_EQ(in.info().columns.spin, format->word == "xyz" || format->word == "lammps-dump");
    }
  }
}

TEST_F(ForeignFormats, LaboratoryUnits) {
  MemoryTrajectory t = three_beads(2);
  EXPECT_THROW((void)ExportUnits::laboratory(t.info(), "--units"), ConfigError);
  t.info().scale = {.sigma_m = 0.002, .gravity_m_s2 = 9.81};
  const ExportUnits units = ExportUnits::laboratory(t.info(), "--units");
  const ForeignFrame s = foreign_frame_of(t.frames()[1], t.info(), units);
  EXPECT_NEAR(s.beads[0].position.x(), 2.2, 1e-12);                                 // 1.1 sigma of 2 mm
  EXPECT_NEAR(s.beads[0].velocity.x(), 0.1 * std::sqrt(9.81 * 0.002) * 1e3, 1e-9);  // v0 = sqrt(g sigma)
  EXPECT_NEAR(*s.time, t.frames()[1].time * std::sqrt(0.002 / 9.81), 1e-15);
}

TEST_F(ForeignFormats, ExtendedXyzOfOtherPrograms) {
  // ASE: no identity, keys in any order, a key without a value, quotes of either kind.
  put_file(file(),
           "2\nProperties=pos:R:3:species:S:1:velo:R:3 energy=-1.5 converged Lattice='8 0 0 0 9 0 0 0 1' "
           "pbc=\"T F F\" Time=0.5\n1 2 0 Si 0.5 0.25 0\n7.9 3 0 Si 0 0 0\n\n");
  const MemoryTrajectory t = read("xyz", {});
  ASSERT_EQ(t.n_frames(), 1U);
  EXPECT_EQ(t.frames()[0].time, 0.5);
  EXPECT_EQ(t.frames()[0].position[1], Vec3(7.9, 0, 3));
  EXPECT_EQ(t.frames()[0].velocity[0], Vec3(0.5, 0, 0.25));
  EXPECT_EQ(t.info().box.upper, Vec3(8, 1, 9));
  EXPECT_EQ(t.info().box.boundary[0], Boundary::periodic);
  EXPECT_TRUE(t.info().radius.empty());
}

// Ten beads in a row of spacing 1 drift by 0.7 a frame through a period of 10 that begins at -5.
std::string drifting_row(const std::string& head, bool wrapped) {
  std::string text;
  for (int f = 0; f < 20; ++f) {
    text +=
        "10\nLattice=\"10 0 0 0 10 0 0 0 1\" Origin=\"-5 -5 -0.5\" " + head + fmt::format(" Time={}\n", f);
    for (int i = 0; i < 10; ++i) {
      const double x = -4.5 + i + 0.7 * f;
      text += fmt::format("{} 0 0\n", wrapped ? x - 10 * std::floor((x + 5) / 10) : x);
    }
  }
  return text;
}

TEST_F(ForeignFormats, WrappedXyzIsUnwrappedAndOtherIsNot) {
  for (const bool wrapped : {true, false}) {
    put_file(file(), drifting_row("pbc=\"T F F\" Properties=pos:R:3", wrapped));
    const MemoryTrajectory t = read("xyz", {});
    EXPECT_EQ(t.info().box.lower.x(), 0);
    EXPECT_EQ(t.info().box.upper.x(), 10);
    for (int f = 0; f < 20; ++f)
      for (std::size_t i = 0; i < 10; ++i)
        EXPECT_NEAR(t.frames()[static_cast<std::size_t>(f)].position[i].x(),
                    0.5 + static_cast<double>(i) + 0.7 * f, 1e-12)
            << "the cell begins where the period does";
  }
  // What export wrote is not wrapped, even if no bead happens to leave the period.
  put_file(file(), drifting_row("creator=twincell pbc=\"T F F\" Properties=pos:R:3", true));
  EXPECT_NEAR(read("xyz", {}).frames()[1].position[9].x(), 0.2, 1e-12);
}

TEST_F(ForeignFormats, XyzWithoutPbcIsPeriodic) {
  put_file(file(), drifting_row("Properties=pos:R:3", true));
  const ForeignTrajectory source(file(), foreign_format("xyz", ""), {});
  EXPECT_EQ(source.info().box.boundary[0], Boundary::periodic);
  EXPECT_NE(source.assumption().find("by the rule of extended XYZ the box is periodic"), std::string::npos);
  put_file(file(), drifting_row("pbc=\"F F F\" Properties=pos:R:3", true));
  EXPECT_EQ(ForeignTrajectory(file(), foreign_format("xyz", ""), {}).assumption(), "");
}

TEST_F(ForeignFormats, ThePeriodIsThatOfTheFileWhereverTheCellBegins) {
  put_file(file(), drifting_row("pbc=\"T T F\" Properties=pos:R:3", false));
  const ForeignTrajectory source(file(), foreign_format("xyz", ""), {.origin = Vec3(1, 2, 0)});
  EXPECT_EQ(source.info().box.size().x(), 10);
  EXPECT_EQ(source.info().box.size().z(), 10);
  EXPECT_EQ(refusal("xyz", drifting_row("pbc=\"T F F\" Properties=pos:R:3", false), {.width = 9}),
            "--cell-width: is 9, but the file is periodic along x with a period of 10.");
}

TEST_F(ForeignFormats, AnXyzBeadThatVanishesNeedsAnIdentity) {
  EXPECT_EQ(
      refusal("xyz", "2\nTime=0 Properties=pos:R:3\n1 1 0\n2 1 0\n1\nTime=1 Properties=pos:R:3\n2 1 0\n"),
      "f:5: the frame has 1 beads, the first one has 2; without the property id:I:1 the missing ones are "
      "unknown.");
  put_file(file(),
           "2\nTime=0 Properties=pos:R:3:id:I:1\n1 1 0 4\n2 1 0 9\n1\nTime=1 "
           "Properties=pos:R:3:id:I:1\n2 1 0 9\n");
  const ForeignTrajectory source(file(), foreign_format("xyz", ""), {});
  EXPECT_EQ(source.ids(), (std::vector<std::int64_t>{4, 9}));
}

TEST_F(ForeignFormats, RadiiThatChangeAreNamed) {
  const auto said = [&](double later) {
    put_file(file(), fmt::format("1\nTime=0 Properties=pos:R:3:radius:R:1\n1 1 0 0.5\n1\nTime=1 "
                                 "Properties=pos:R:3:radius:R:1\n1 1 0 {}\n",
                                 later));
    const ForeignTrajectory source(file(), foreign_format("xyz", ""), {});
    EXPECT_NEAR(source.info().radius.at(0), (0.5 + later) / 2, 1e-15);
    return source.assumption();
  };
  EXPECT_EQ(said(0.5), "");
  EXPECT_EQ(said(0.54), "") << "measured sizes scatter";
  EXPECT_EQ(said(0.6),
            "the radii of beads change by more than a tenth from frame to frame: each has its mean.");
}

TEST_F(ForeignFormats, UnequalMassesThatAreNotReadAreNamed) {
  const auto said = [&](double other, std::optional<double> unit) {
    put_file(file(), fmt::format("2\nTime=0 Properties=pos:R:3:mass:R:1\n1 1 0 2\n3 1 0 {}\n", other));
    ForeignOptions options;
    options.bead_mass = unit;
    const ForeignTrajectory source(file(), foreign_format("xyz", ""), options);
    EXPECT_EQ(source.info().mass.size(), unit ? 2U : 0U);
    return source.assumption();
  };
  EXPECT_EQ(said(2, std::nullopt), "") << "equal beads have the mass m";
  EXPECT_EQ(said(0.5, 1), "");
  EXPECT_EQ(said(0.5, std::nullopt),
            "the masses of the file, 0.5 to 2, are not read, because their unit is not known (--bead-mass; 1 "
            "for a file that twincell exported).");
}

TEST_F(ForeignFormats, DamagedXyz) {
  const std::string head = "Lattice=\"8 0 0 0 9 0 0 0 1\" Properties=pos:R:3";
  EXPECT_EQ(refusal("xyz", "many\n"), "f:1: 'many' is not a whole number.");
  EXPECT_EQ(refusal("xyz", "-1\n"), "f:1: the number of beads is needed, '-1' was found.");
  EXPECT_EQ(refusal("xyz", ""), "f: the file holds no frame.");
  EXPECT_EQ(refusal("xyz", "2\n" + head + "\n1 2 0\n"), "f:3: the file ends within a frame, before bead 2.");
  EXPECT_EQ(refusal("xyz", "9000000000000000000\n" + head + "\n1 2 0\n"),
            "f:3: the file ends within a frame, before bead 2.");
  EXPECT_EQ(refusal("xyz", "1\n" + head + "\n1 2\n"), "f:3: 3 columns are needed, 2 were found.");
  EXPECT_EQ(refusal("xyz", "1\n" + head + "\n1 nan 0\n"), "f:3: 'nan' is not a finite number.");
  EXPECT_EQ(refusal("xyz", "1\nLattice=\"8 1 0 0 9 0 0 0 1\" Properties=pos:R:3\n1 1 0\n"),
            "f:2: the box is not a cuboid along the axes.");
  EXPECT_EQ(refusal("xyz", "1\nLattice=\"8 0 0 0 0 0 0 0 1\" Properties=pos:R:3\n1 1 0\n"),
            "f:2: the box is empty: an edge of Lattice is not positive.");
  EXPECT_EQ(refusal("xyz", "1\nProperties=pos:R:99999999999999999999\n1 1 0\n"),
            "f:2: '99999999999999999999' is not a whole number.");
  EXPECT_EQ(refusal("xyz", "1\nProperties=pos:R\n1 1 0\n"),
            "f:2: Properties needs name:type:count for each property.");
  EXPECT_EQ(refusal("xyz", "1\nProperties=\"\"\n\n"),
            "f:2: Properties needs name:type:count for each property.");
  EXPECT_EQ(refusal("xyz", "1\nProperties=id:I:1\n1\n"), "f:2: there is no property pos:R:3.");
  EXPECT_EQ(refusal("xyz", "2\n" + head + ":id:I:1\n1 2 0 7\n1 3 0 7\n"),
            "f:4: the bead with id 7 occurs twice in a frame.");
}

TEST_F(ForeignFormats, ATableOfTrackpy) {
  // pandas writes an index without a name, and particles as real numbers; y increases downwards.
  put_file(
      file(),
      ",y,x,mass,size,ecc,signal,raw_mass,ep,frame,particle\n"
      "0,90.5,10.25,1,2,3,4,5,0.1,0,0.0\n1,80.0,30.0,1,2,3,4,5,,0,1.0\n2,90.0,12.0,1,2,3,4,5,0.1,2,0.0\n");
  ForeignOptions options;
  options.timestep = 0.01;
  options.sigma = 20;
  options.gravity = 2000;  // t0 = 0.1
  options.origin = Vec3(0, 100, 0);
  const MemoryTrajectory t = read("csv", options);
  ASSERT_EQ(t.n_frames(), 2U);
  EXPECT_EQ(t.frames()[1].step, 2);
  EXPECT_NEAR(t.frames()[1].time, 0.2, 1e-15);
  EXPECT_NEAR(t.frames()[0].position[0].x(), 10.25 / 20, 1e-15);
  EXPECT_NEAR(t.frames()[0].position[0].z(), 9.5 / 20, 1e-15);  // 9.5 px above the origin
  EXPECT_FALSE(t.frames()[1].present(1));
}

TEST_F(ForeignFormats, ColumnsOfATableAreNamed) {
  put_file(file(), "t,bead,X,Y\n5,3,1.5,2.5\n");
  ForeignOptions options;
  options.timestep = 1;
  options.y_up = true;
  options.table_columns = {{"frame", "t"}, {"particle", "bead"}, {"x", "X"}, {"y", "Y"}};
  const MemoryTrajectory t = read("csv", options);
  EXPECT_EQ(t.frames().at(0).position[0], Vec3(1.5, 0, 2.5));
  options.table_columns["x"] = "Z";
  EXPECT_EQ(refusal("csv", "t,bead,X,Y\n5,3,1.5,2.5\n", options),
            "f:1: Z: this column is missing; there are: t, bead, X, Y.");
  options.table_columns = {{"speed", "X"}};
  EXPECT_NE(refusal("csv", "t,bead,X,Y\n5,3,1.5,2.5\n", options).find("there is no quantity 'speed'"),
            std::string::npos);
}

TEST_F(ForeignFormats, ATableMarksItsTracers) {
  ForeignOptions options;
  options.timestep = 1;
  for (const auto& [no, yes] : {std::pair("0", "1"), std::pair("False", "True")}) {
    put_file(file(),
             fmt::format("frame,particle,x,y,tracer\n0,0,1,-1,{0}\n0,1,2,-1,{1}\n0,2,3,-1,{0}\n", no, yes));
    EXPECT_EQ(read("csv", options).info().tracer, (std::vector<std::uint8_t>{0, 1, 0}));
  }
  options.tracer_type = 1;  // the option is stronger
  EXPECT_EQ(read("csv", options).info().tracer, (std::vector<std::uint8_t>{1, 0, 1}));
  options.tracer_type.reset();
  put_file(file(), "frame,particle,x,y\n0,0,1,-1\n");
  EXPECT_TRUE(read("csv", options).info().tracer.empty());
}

TEST_F(ForeignFormats, DamagedTables) {
  const std::string head = "frame,particle,x,y\n";
  EXPECT_EQ(refusal("csv", "frame,x,y\n0,1,2\n"),
            "f:1: there is no column 'particle'; --columns particle=NAME states another name. The columns "
            "are: frame, x, y. Beads that are not linked, such as those of locate, have no particle; track "
            "links them.");
  EXPECT_EQ(refusal("csv", head), "f: the table has no row.");
  EXPECT_EQ(refusal("csv", head + "0,1,2\n"), "f:2: 4 fields are needed, 3 were found.");
  EXPECT_EQ(refusal("csv", head + "0,1,2,\n"), "f:2: y: '' is not a finite number.");
  EXPECT_EQ(refusal("csv", head + "0,1.5,2,3\n"), "f:2: particle: 1.5 is not a whole number.");
  EXPECT_EQ(refusal("csv", head + "0,1,2,inf\n"), "f:2: y: 'inf' is not a finite number.");
  EXPECT_EQ(refusal("csv", head + "0,1,2,3\n0,1,2,3\n"), "f:3: the bead with id 1 occurs twice in a frame.");
  EXPECT_EQ(refusal("csv", "frame,particle,x,y,time\n0,1,2,3,0\n0,2,2,3,1\n"),
            "f:3: the time differs from that of line 2, which has the same frame.");
  EXPECT_EQ(refusal("csv", "frame;particle;x;y\n0;1;2;3\n"),
            "f:1: the fields are separated by semicolons; use commas, and decimal points in numbers.");
  // What a trajectory file cannot hold is refused before one is written.
  EXPECT_EQ(
      refusal("csv", head + "0,1,1e300,-3\n"),
      "f:2: bead 1 is at (1e+300, 3, 0), farther than 1e+07 bead diameters from the origin of the cell.");
  for (const char* time : {"5", "4"})
    EXPECT_EQ(refusal("csv", fmt::format("frame,particle,x,y,time\n0,1,2,-3,5\n1,1,2,-3,{}\n", time), {}),
              fmt::format("f:3: time {} of a frame comes after time 5; times must increase.", time));
}

TEST_F(ForeignFormats, ATracerIsOneInMostFrames) {
  const std::string rows =
      "frame,particle,x,y,tracer\n0,4,1,-1,0\n0,5,2,-1,0\n1,4,1,-1,1\n1,5,2,-1,0\n2,4,1,-1,1\n";
  put_file(file(), rows);
  const ForeignTrajectory changing(file(), foreign_format("csv", ""), {.timestep = 1});
  EXPECT_EQ(changing.info().tracer, (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(changing.assumption(),
            "1 bead is a tracer in some frames only (wrong links?): each bead is what it is in most frames.");
  put_file(file(), "frame,particle,x,y,tracer\n0,4,1,-1,1\n1,4,1,-1,1\n");
  EXPECT_EQ(ForeignTrajectory(file(), foreign_format("csv", ""), {.timestep = 1}).assumption(), "");
}

TEST_F(ForeignFormats, ATableThatContradictsItself) {
  const std::string sizes = "frame,particle,x,y,radius,diameter\n0,4,1,-1,0.5,";
  EXPECT_EQ(refusal("csv", sizes + "1\n"), "accepted");
  EXPECT_EQ(refusal("csv", sizes + "0.5\n"),
            "f:2: the radius is 0.5 and the diameter 0.5, which is not twice the radius.");
}

TEST_F(ForeignFormats, AVelocityMayBeUnknown) {
  const std::string table = "frame,particle,x,y,vx,vy\n0,4,1,-1,";
  for (const char* unknown : {"nan,1\n", "-nan,1\n", ",1\n"}) {
    put_file(file(), table + unknown);
    const MemoryTrajectory t = read("csv", {.timestep = 1});
    EXPECT_TRUE(std::isnan(t.frames().at(0).velocity[0].x())) << unknown;
    EXPECT_EQ(t.frames()[0].velocity[0].z(), -1) << unknown;
  }
  EXPECT_EQ(refusal("csv", table + "inf,1\n"), "f:2: vx: 'inf' is not a finite number.");
  EXPECT_EQ(refusal("xyz", "1\nProperties=species:S:1:pos:R:3:velo:R:3\nX 1 1 0 nan 0 0\n"), "accepted");
  EXPECT_EQ(refusal("xyz", "1\nProperties=species:S:1:pos:R:3:velo:R:3\nX 1 1 0 inf 0 0\n"),
            "f:3: 'inf' is not a finite number.");
  EXPECT_EQ(refusal("xyz", "1\nProperties=species:S:1:pos:R:3\nX nan 1 0\n"),
            "f:3: 'nan' is not a finite number.");
}

// A GSD file of three dimensions is read as a plane only if its beads are in one.
TEST_F(ForeignFormats, AThreeDimensionalGsdFileIsNoPlane) {
  export_trajectory(three_beads(3), foreign_format("gsd", ""), {}, file(), "f");
  const std::string whole = read_text_file(file());
  const std::string said = refusal("gsd", whole);
  EXPECT_NE(said.find("not in the plane z = "), std::string::npos) << said;
  EXPECT_NE(said.find("is this a three-dimensional system (--dimension 3)?"), std::string::npos) << said;
  EXPECT_EQ(refusal("gsd", whole, {.dimension = 3, .timestep = 1}), "accepted");
}

TEST_F(ForeignFormats, AFullDiskIsReported) {
  TrajectoryInfo info;
  info.n_beads = 100;
  MemoryTrajectory run(info);
  std::mt19937_64 random(1);  // numbers that no compression makes shorter
  std::uniform_real_distribution<double> anywhere(0, 10);
  for (int f = 0; f < 20; ++f) {
    Frame frame;
    frame.step = f;
    frame.time = f;
    for (int i = 0; i < 100; ++i) frame.position.emplace_back(anywhere(random), 0, anywhere(random));
    run.append(frame);
  }
  rlimit usual{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &usual), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  for (const ForeignFormat* format : foreign_formats()) {
    if (format->create == nullptr) continue;
    const std::filesystem::path place = file().string() + "-" + std::string(format->word);
    const rlimit limit{.rlim_cur = 4096, .rlim_max = usual.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    EXPECT_THROW(export_trajectory(run, *format, ExportUnits::reduced(info), place, "f"), RunError)
        << format->word;
    ::setrlimit(RLIMIT_FSIZE, &usual);
  }
  std::signal(SIGXFSZ, handler);
}

TEST_F(ForeignFormats, UnitsAndSizesThatNoFileIsLikelyToHave) {
  put_file(file(), "frame,particle,x,y,time\n0,1,2,-3,0\n0,2,14,-3,0\n1,1,2,-3,1\n");
  const auto open = [&](const ForeignOptions& options) {
    return std::make_unique<ForeignTrajectory>(file(), foreign_format("csv", ""), options);
  };
  EXPECT_DOUBLE_EQ(open({})->spacing(), 12) << "pixels that are taken for bead diameters";
  EXPECT_DOUBLE_EQ(open({.sigma = 12})->spacing(), 1);
  EXPECT_EQ(open({})->n_beyond(), 0U);
  EXPECT_EQ(open({.width = 10})->n_beyond(), 1U) << "the bead at x = 14";
  EXPECT_EQ(open({.origin = Vec3(3, 0, 0)})->n_beyond(), 1U) << "the bead at x = 2";
  EXPECT_FALSE(open({.timestep = 1})->replaces_times());
  EXPECT_TRUE(open({.timestep = 2})->replaces_times());
}

TEST_F(ForeignFormats, FramesThatTheirNumbersLeaveOut) {
  const auto missing = [&](const std::string& frames) {
    std::string text = "frame,particle,x,y\n";
    for (const char frame : frames) text += std::string(1, frame) + ",1,2,-3\n";
    put_file(file(), text);
    return ForeignTrajectory(file(), foreign_format("csv", ""), {.timestep = 1}).missing_frames();
  };
  EXPECT_EQ(missing("0"), 0);
  EXPECT_EQ(missing("0123"), 0);
  EXPECT_EQ(missing("2468"), 0) << "every second frame was tracked";
  EXPECT_EQ(missing("0137"), 4);
}

TEST_F(ForeignFormats, TrackMateTracks) {
  for (const int dimension : {2, 3}) {
    const MemoryTrajectory out = three_beads(dimension);
    EXPECT_EQ(export_trajectory(out, foreign_format("trackmate", ""), ExportUnits::reduced(out.info()),
                                file(), "f"),
              3U);
    ForeignOptions options = options_of(out);
    options.timestep.reset();  // has times
    options.tracer_type.reset();
    const MemoryTrajectory in = read("trackmate", options);
    ASSERT_EQ(in.n_frames(), 3U);
    ASSERT_EQ(in.info().n_beads, 3U);
    EXPECT_EQ(in.info().source, Origin::experiment);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(in.info().radius[i], out.info().radius[i]);
    for (std::size_t f = 0; f < 3; ++f) {
      const Frame &a = in.frames()[f], &b = out.frames()[f];
      EXPECT_NEAR(a.time, b.time, 1e-13);
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_EQ(a.present(i), b.present(i)) << "bead " << i << " of frame " << f;
        if (b.present(i)) expect_vector(a.position[i], b.position[i], 1e-13, dimension, "position");
      }
    }
  }
  // A single frame has no tracks: every spot is a bead.
  MemoryTrajectory one(three_beads(2).info());
  one.append(three_beads(2).frames()[0]);
  export_trajectory(one, foreign_format("trackmate", ""), ExportUnits::reduced(one.info()), file(), "f");
  EXPECT_EQ(read("trackmate", {.timestep = 1}).info().n_beads, 3U);
}

// "Export tracks to XML" of TrackMate states the interval of its frames.
TEST_F(ForeignFormats, TracksOfTrackMateHaveTheirTimes) {
  const auto list = [](const std::string& attributes) {
    return "<?xml version=\"1.0\"?>\n<Tracks nTracks=\"1\" " + attributes +
           "><particle nSpots=\"2\"><detection t=\"3\" x=\"1\" y=\"2\" z=\"0\"/>"
           "<detection t=\"5\" x=\"1.5\" y=\"2\" z=\"0\"/></particle></Tracks>";
  };
  put_file(file(), list("spaceUnits=\"mm\" frameInterval=\"0.01\" timeUnits=\"sec\""));
  ForeignOptions options;
  options.sigma = 0.25;
  options.gravity = 4;  // t0 = 0.25
  options.origin = Vec3(0, 4, 0);
  const ForeignTrajectory source(file(), foreign_format("trackmate", ""), options);
  EXPECT_EQ(source.length_unit(), "mm");
  MemoryTrajectory t(source.info());
  source.copy_to(t);
  EXPECT_DOUBLE_EQ(t.frames()[0].time, 0.03 / 0.25);
  EXPECT_DOUBLE_EQ(t.frames()[1].time, 0.05 / 0.25);
  EXPECT_DOUBLE_EQ(t.info().box.upper.y(), 1) << "a file without a box states no gap";
  EXPECT_EQ(refusal("trackmate", list("frameInterval=\"0\""), {}),
            "f:2: frameInterval is 0; it must be above 0.");
  EXPECT_NE(refusal("trackmate", list(""), {}).find("does not state the length of a step"),
            std::string::npos);
}

TEST_F(ForeignFormats, ColumnsOfATableThatAreNotReadAreNamed) {
  const auto said = [&](const std::string& columns) {
    put_file(file(), "frame,particle,x,y" + columns + "\n0,0,1,-1,2,5,0\n1,0,1,-1,2,5,100\n");
    return ForeignTrajectory(file(), foreign_format("csv", ""), {.timestep = 1}).assumption();
  };
  EXPECT_EQ(said(",mass,overlap,step"), "") << "of trackpy and of export";
  EXPECT_EQ(said(",mass,spin,step"), "a column of the table is not read: 'spin'.");
  EXPECT_EQ(said(",radius_mm,time_ms,spin"),
            "3 columns of the table are not read: 'radius_mm', 'time_ms', 'spin'. --columns radius=radius_mm "
            "time=time_ms reads them without a conversion of units; lengths and times of a table have one "
            "unit each.");
  EXPECT_EQ(refusal("csv", "frame,particle,x,y,radius\n0,0,1,-1,-0.3\n"),
            "f:2: the radius is -0.3; it must be above 0.");
  EXPECT_EQ(refusal("csv", "frame,particle,x,y,diameter\n0,0,1,-1,-0.6\n"),
            "f:2: the diameter is -0.6; it must be above 0.");
}

// pandas writes the index of a table as its first column, which trackpy's filters leave in the table too.
TEST_F(ForeignFormats, AColumnThatIsAlsoTheIndexIsReadOnce) {
  const std::string head = "frame,frame,particle,x,y\n";
  put_file(file(), head + "0,0,7,1,-3\n1,1,7,2,-3\n");
  EXPECT_EQ(read("csv", {.timestep = 1}).n_frames(), 2U);
  EXPECT_EQ(refusal("csv", head + "0,0,7,1,-3\n0,1,7,2,-3\n"),
            "f:3: frame: the column occurs twice, with the values '0' and '1'.");
  EXPECT_EQ(refusal("csv", "particle,frame,frame,x,y\n7,0,0,1,-3\n"), "f:1: frame: the column occurs twice.");
}

// Boxes of LAMMPS and OVITO that are cuboids along the axes, written in the forms of other boxes.
TEST_F(ForeignFormats, CuboidsInGeneralFormsAreRead) {
  const auto dump = [](const std::string& box) {
    return "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS " + box +
           "\nITEM: ATOMS id x y z\n1 2 3 0\n";
  };
  for (const char* box : {"pp ff pp\n-1 7\n0 9\n-0.5 0.5", "xy xz yz pp ff pp\n-1 7 0\n0 9 0\n-0.5 0.5 0",
                          "abc origin pp ff pp\n8 0 0 -1\n0 9 0 0\n0 0 1 -0.5"}) {
    put_file(file(), dump(box));
    const MemoryTrajectory t = read("lammps-dump", {.timestep = 1});
    EXPECT_DOUBLE_EQ(t.info().box.size().x(), 8) << box;
    EXPECT_DOUBLE_EQ(t.info().box.size().z(), 9) << box;
    EXPECT_DOUBLE_EQ(t.frames()[0].position[0].x(), 3) << box;  // along a period from its beginning
    EXPECT_EQ(t.info().box.boundary[0], Boundary::periodic) << box;
  }
  for (const char* box : {"xy xz yz pp ff pp\n-1 7 0.1\n0 9 0\n-0.5 0.5 0",
                          "abc origin pp ff pp\n8 0.1 0 -1\n0 9 0 0\n0 0 1 -0.5"})
    EXPECT_EQ(refusal("lammps-dump", dump(box)),
              "f:6: the box is not a cuboid along the axes (tilted boxes are not read).");
  EXPECT_EQ(refusal("lammps-dump", dump("xy xz yz pp ff pp\n-1 7\n0 9 0\n-0.5 0.5 0")),
            "f:6: 3 numbers are needed, '-1 7' was found.");

  put_file(file(), "1\nLattice=\"8 0 0 0 9 0 0 0 0\" pbc=\"T F T\" Properties=pos:R:3\n1 2 0\n");
  const MemoryTrajectory planar = read("xyz", {.timestep = 1});
  EXPECT_DOUBLE_EQ(planar.info().box.size().x(), 8);
  EXPECT_DOUBLE_EQ(planar.info().box.size().z(), 9);
}

TEST_F(ForeignFormats, TracksOfTheIsbiChallenge) {
  for (const int dimension : {2, 3}) {
    const MemoryTrajectory out = three_beads(dimension);
    export_trajectory(out, foreign_format("isbi", ""), ExportUnits::reduced(out.info()), file(), "f");
    ForeignOptions options = options_of(out);
    options.timestep = 1;
    options.phases_per_cycle = 0;
    options.tracer_type.reset();
    const MemoryTrajectory in = read("trackmate", options);
    ASSERT_EQ(in.n_frames(), 3U);
    ASSERT_EQ(in.info().n_beads, 3U);
    for (std::size_t f = 0; f < 3; ++f)
      for (std::size_t i = 0; i < 3; ++i) {
        const Frame &a = in.frames()[f], &b = out.frames()[f];
        ASSERT_EQ(a.present(i), b.present(i)) << "bead " << i << " of frame " << f;
        if (b.present(i)) expect_vector(a.position[i], b.position[i], 1e-13, dimension, "position");
      }
  }
}

/// Positions in px, of which five are a bead diameter.
ForeignOptions in_pixels() {
  ForeignOptions options;
  options.sigma = 5;
  options.origin = Vec3(0, 100, 0);
  return options;
}

/// A file of TrackMate 7, shortened: spot 4 is in no track, track 1 did not pass the filters.
constexpr const char* kTrackMate = R"(<?xml version="1.0" encoding="UTF-8"?>
<TrackMate version="7.11.1">
  <!-- <Spot ID="9"/> -->
  <Log>a text &lt;Spot&gt;</Log>
  <Model spatialunits="pixel" timeunits="sec">
    <AllSpots nspots="6">
      <SpotsInFrame frame="0">
        <Spot ID="1" name="ID1" POSITION_T="0.0" RADIUS="2.5" FRAME="0" POSITION_X="10.5" POSITION_Y="7" POSITION_Z="0" />
        <Spot ID="3" name="a > b" POSITION_T="0.0" RADIUS="2.5" FRAME="0" POSITION_X="20" POSITION_Y="7" POSITION_Z="0" />
      </SpotsInFrame>
      <SpotsInFrame frame="1">
        <Spot ID="2" name="ID2" POSITION_T="0.5" RADIUS="2.5" FRAME="1" POSITION_X="11" POSITION_Y="6" POSITION_Z="0" />
        <Spot ID="4" name="ID4" POSITION_T="0.5" RADIUS="2.5" FRAME="1" POSITION_X="30" POSITION_Y="7" POSITION_Z="0" />
        <Spot ID="5" name="ID5" POSITION_T="0.5" RADIUS="2.5" FRAME="1" POSITION_X="20" POSITION_Y="8" POSITION_Z="0" />
      </SpotsInFrame>
    </AllSpots>
    <AllTracks>
      <Track name="Track_0" TRACK_ID="0"><Edge SPOT_SOURCE_ID="1" SPOT_TARGET_ID="2" LINK_COST="0.3" /></Track>
      <Track name="Track_1" TRACK_ID="1"><Edge SPOT_SOURCE_ID="3" SPOT_TARGET_ID="5" LINK_COST="0.3" /></Track>
    </AllTracks>
    <FilteredTracks><TrackID TRACK_ID="0" /></FilteredTracks>
  </Model>
</TrackMate>)";

TEST_F(ForeignFormats, FilesOfTrackMate) {
  put_file(file(), kTrackMate);
  MemoryTrajectory t = read("trackmate", in_pixels());
  ASSERT_EQ(t.info().n_beads, 1U);
  ASSERT_EQ(t.n_frames(), 2U);
  EXPECT_NEAR(t.frames()[1].position[0].x() - t.frames()[0].position[0].x(), 0.1, 1e-12);
  EXPECT_NEAR(t.frames()[1].position[0].z() - t.frames()[0].position[0].z(), 0.2, 1e-12);  // y downwards
  EXPECT_NEAR(t.info().radius[0], 0.5, 1e-12);
  // The list of tracks that "Export tracks to XML file" writes has frames and positions only.
  put_file(file(),
           "<?xml version=\"1.0\"?>\n<Tracks nTracks=\"2\" spaceUnits=\"pixel\" frameInterval=\"0.5\" "
           "timeUnits=\"sec\">\n<particle nSpots=\"2\"><detection t=\"0\" x=\"1\" y=\"2\" z=\"0\" />"
           "<detection t=\"1\" x=\"1.5\" y=\"2\" z=\"0\" /></particle>\n<particle nSpots=\"1\">"
           "<detection t=\"1\" x=\"4\" y=\"2\" z=\"0\" /></particle></Tracks>");
  ForeignOptions list_of_tracks = in_pixels();
  list_of_tracks.timestep = 0.5;
  t = read("trackmate", list_of_tracks);
  ASSERT_EQ(t.info().n_beads, 2U);
  EXPECT_FALSE(t.frames()[0].present(1));
  EXPECT_NEAR(t.frames()[1].time, 0.5 / std::sqrt(5.0), 1e-12);  // t0 = sqrt(sigma/g)
}

// Times and velocities are converted to seconds where the file states a unit of time.
TEST_F(ForeignFormats, TimesInMillisecondsAreConvertedToSeconds) {
  ForeignOptions options;
  options.sigma = 0.25;
  options.gravity = 4;  // t0 = 0.25
  const auto read_xyz = [&](const std::string& unit) {
    std::string text;
    for (const int f : {0, 1})
      text += fmt::format(
          "1\nTime={} Timestep={} length_unit=mm{} pbc=\"F F F\" Lattice=\"9 0 0 0 9 0 0 0 1\" "
          "Properties=species:S:1:pos:R:3:velo:R:3\nX 1 1 0 2 0 0\n",
          50 * f, f, unit.empty() ? "" : " time_unit=" + unit);
    put_file(file(), text);
    const ForeignTrajectory source(file(), foreign_format("xyz", ""), options);
    MemoryTrajectory t(source.info());
    source.copy_to(t);
    return std::pair(t, source.assumption());
  };
  for (const char* seconds : {"", "s", "sec"}) {
    const auto [t, note] = read_xyz(seconds);
    EXPECT_DOUBLE_EQ(t.frames()[1].time, 50 / 0.25) << seconds;
    EXPECT_DOUBLE_EQ(t.frames()[1].velocity[0].x(), 2 * 0.25 / 0.25) << seconds;
    EXPECT_EQ(note, "") << seconds;
  }
  const auto [t, note] = read_xyz("ms");
  EXPECT_NEAR(t.frames()[1].time, 0.05 / 0.25, 1e-12);
  EXPECT_NEAR(t.frames()[1].velocity[0].x(), 2000 * 0.25 / 0.25, 1e-9);
  EXPECT_NE(note.find("are in ms and are converted to seconds"), std::string::npos) << note;
  const auto [taken, unknown] = read_xyz("frame");
  EXPECT_DOUBLE_EQ(taken.frames()[1].time, 50 / 0.25);
  EXPECT_NE(unknown.find("'frame', which is not a known unit of time"), std::string::npos) << unknown;

  put_file(file(),
           "<Tracks nTracks=\"1\" spaceUnits=\"mm\" frameInterval=\"50\" timeUnits=\"msec\"><particle "
           "nSpots=\"2\"><detection t=\"0\" x=\"1\" y=\"2\" z=\"0\"/><detection t=\"1\" x=\"1.5\" y=\"2\" "
           "z=\"0\"/></particle></Tracks>");
  options.origin = Vec3(0, 4, 0);
  EXPECT_NEAR(read("trackmate", options).frames()[1].time, 0.05 / 0.25, 1e-12);
  std::string model = kTrackMate;
  model.replace(model.find("timeunits=\"sec\""), 15, "timeunits=\"ms\"");
  put_file(file(), model);
  EXPECT_NEAR(read("trackmate", in_pixels()).frames()[1].time, 0.5e-3 / std::sqrt(5.0), 1e-15);
}

TEST_F(ForeignFormats, DamagedTrackMateFiles) {
  const std::string good = kTrackMate;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refusal("trackmate", text, in_pixels());
  };
  EXPECT_EQ(refusal("trackmate", "", {}), "f:1: this is no well-formed XML (No document element found).");
  EXPECT_EQ(refusal("trackmate", "<svg/>", {}),
            "f:1: the element 'svg' is neither TrackMate nor Tracks nor that of an ISBI file.");
  EXPECT_EQ(with("FRAME=\"0\"", "FRAME=\"x\""), "f:8: 'x' is not a whole number.");
  EXPECT_EQ(with("POSITION_X=\"10.5\"", ""), "f:8: 'Spot' has no attribute 'POSITION_X'.");
  EXPECT_EQ(with("POSITION_X=\"10.5\"", "POSITION_X=\"nan\""), "f:8: 'nan' is not a finite number.");
  EXPECT_EQ(with("SPOT_TARGET_ID=\"2\"", "SPOT_TARGET_ID=\"7\""), "f:18: there is no spot 7.");
  EXPECT_EQ(with("SPOT_TARGET_ID=\"5\"", "SPOT_TARGET_ID=\"2\""),
            "f:19: the spot 2 belongs to the tracks 0 and 1.");
  EXPECT_EQ(with("SPOT_TARGET_ID=\"2\"", "SPOT_TARGET_ID=\"4\"").substr(0, 30), "accepted");
  EXPECT_EQ(with("ID=\"2\"", "ID=\"1\""), "f:12: the spot 1 occurs twice.");
  EXPECT_EQ(with("TrackID TRACK_ID=\"0\"", "TrackID TRACK_ID=\"3\""), "f: the file has no tracks.");
  // Two spots of one track in a frame: a split.
  EXPECT_NE(with("<Edge SPOT_SOURCE_ID=\"1\" SPOT_TARGET_ID=\"2\" LINK_COST=\"0.3\" />",
                 "<Edge SPOT_SOURCE_ID=\"1\" SPOT_TARGET_ID=\"2\"/><Edge SPOT_SOURCE_ID=\"1\" "
                 "SPOT_TARGET_ID=\"4\"/>")
                .find("occurs twice in a frame"),
            std::string::npos);
  // Cut anywhere, it is refused.
  for (std::size_t n = 0; n < good.size(); n += 7)
    EXPECT_TRUE(refusal("trackmate", good.substr(0, n), in_pixels()).starts_with("f:")) << n;
}

TEST_F(ForeignFormats, AGsdFileCutAnywhereIsRefused) {
  export_trajectory(three_beads(2), foreign_format("gsd", ""), {}, file(), "f");
  const std::string whole = read_text_file(file());
  EXPECT_EQ(refusal("gsd", whole), "accepted");
  for (std::size_t n = 0; n < whole.size(); n += 37)
    EXPECT_NE(refusal("gsd", whole.substr(0, n)), "accepted") << n << " of " << whole.size() << " bytes";
}

// GSD stores the ids as doubles.
TEST_F(ForeignFormats, AGsdFileWithAnIdThatIsNoWholeNumberIsRefused) {
  export_trajectory(three_beads(3), foreign_format("gsd", ""), {}, file(), "f");
  const std::string whole = read_text_file(file());
  const auto bytes = [](const std::array<double, 3>& ids) {
    return std::string(reinterpret_cast<const char*>(ids.data()), sizeof ids);
  };
  const std::size_t at = whole.find(bytes({0, 1, 2}));
  ASSERT_NE(at, std::string::npos);
  const auto with = [&](double id) {
    std::string damaged = whole;
    return refusal("gsd", damaged.replace(at, 3 * sizeof(double), bytes({0, id, 2})),
                   {.dimension = 3, .timestep = 1});
  };
  EXPECT_EQ(with(5), "accepted");
  EXPECT_EQ(with(0.5), "f: log/particles/id of frame 0 has 0.5, not a whole number within 9e+15.");
  EXPECT_EQ(with(2e200), "f: log/particles/id of frame 0 has 2e+200, not a whole number within 9e+15.");
  EXPECT_EQ(with(-1e19), "f: log/particles/id of frame 0 has -1e+19, not a whole number within 9e+15.");
}

// A flipped byte may change a number; it must never end the reader otherwise than by a sentence.
TEST_F(ForeignFormats, AGsdFileWithAFlippedByteIsReadOrRefused) {
  export_trajectory(three_beads(2), foreign_format("gsd", ""), {}, file(), "f");
  const std::string whole = read_text_file(file());
  std::size_t refused = 0;
  for (std::size_t n = 0; n < whole.size(); n += 5) {
    std::string damaged = whole;
    damaged[n] = static_cast<char>(damaged[n] ^ 0xFF);
    refused += refusal("gsd", damaged) != "accepted" ? 1 : 0;
  }
  EXPECT_GT(refused, 20U);
}

}  // namespace
}  // namespace twincell::foreign_formats_test
