// Trajectories with numbers that are impossible for a bead cell: the reader, hence `validate` and every verb,
// refuses them and names file and dataset.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/hdf5_elsewhere.hpp"
#include "tests/support/program.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/recorded_motion.hpp"

namespace twincell::h5md_ranges_test {
namespace {

TrajectoryInfo sound() {
  TrajectoryInfo info;
  info.n_beads = 2;
  info.columns.phase = true;
  info.box.upper = Vec3(10, 1, 20);
  info.drive = Drive{Axis::z, 1.0, 2.0};
  info.phases_per_cycle = 20;
  info.source = Origin::simulation;
  info.radius = {0.5, 0.5};
  info.mass = {1, 1};
  info.provenance_json = "{}";
  return info;
}

void write(const std::filesystem::path& path, const TrajectoryInfo& info, int phase = 0,
           std::int64_t cycle = 0, double x = 1) {
  H5mdWriter writer(path, info);
  Frame frame;
  frame.position = {Vec3(x, 0, 1), Vec3(3, 0, 1)};
  frame.phase = phase;
  frame.cycle = cycle;
  writer.append(frame);
  writer.finish();
}

/// Expects `validate` and every verb that reads all numbers to refuse the file.
void expect_refused(const std::string& file, const std::string& what) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"validate", file},
                                             {"info", file},
                                             {"analyze", file, "-q"},
                                             {"render", file, "-o", file + ".frames", "-q"}}) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 3) << words[0] << " " << what << ": " << ran.out << ran.err;
    EXPECT_NE((ran.err + ran.out).find(what), std::string::npos) << words[0] << ": " << ran.err;
  }
  EXPECT_FALSE(std::filesystem::exists(file + ".frames"));
}

std::shared_ptr<const RecordedMotion> record(std::vector<MotionSample> samples, RecordInfo info = {}) {
  return std::make_shared<RecordedMotion>(std::move(samples), std::move(info));
}

TEST(H5mdRanges, ImpossibleCellsAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  write(file, sound());
  EXPECT_EQ(run_program({"validate", file}).code, 0);

  const std::vector<std::pair<std::string, std::function<void(TrajectoryInfo&)>>> faults = {
      {"cell", [](TrajectoryInfo& t) { t.box.upper.x() = std::nan(""); }},
      {"cell", [](TrajectoryInfo& t) { t.box.upper.z() = 1e9; }},
      {"cell", [](TrajectoryInfo& t) { t.box.lower.x() = 11; }},
      {"phases_per_cycle", [](TrajectoryInfo& t) { t.phases_per_cycle = 2147483647; }},
      {"radius", [](TrajectoryInfo& t) { t.radius[1] = -1; }},
      {"radius", [](TrajectoryInfo& t) { t.radius[0] = 1e6; }},
      {"mass", [](TrajectoryInfo& t) { t.mass[0] = 0; }},
      {"amplitude", [](TrajectoryInfo& t) { t.drive->amplitude = std::nan(""); }},
      {"omega", [](TrajectoryInfo& t) { t.drive->omega = -1; }},
      {"downward_share", [](TrajectoryInfo& t) { t.drive->downward_share = 1.5; }},
      {"harmonics",
       [](TrajectoryInfo& t) {
         t.drive->harmonics = {{std::nan(""), 0}};
       }},
      {"harmonics",
       [](TrajectoryInfo& t) {
         t.drive->harmonics = {{0.1, 0}, {0.1, 1}};
       }},
      {"harmonics", [](TrajectoryInfo& t) { t.drive->harmonics.resize(31); }},
      {"recorded",
       [](TrajectoryInfo& t) {
         t.drive->recorded = record({{0, 0, 0}, {0, std::nan(""), 0}});
       }},
      {"recorded",
       [](TrajectoryInfo& t) {
         t.drive->recorded = record({{0, 0, 0}, {2e6, 0, 0}});
       }},
      {"recorded",
       [](TrajectoryInfo& t) {
         t.drive->recorded = record({{0, 0, 0}, {0, 0, 0}}, {.interval = 0});
       }},
      {"recorded",
       [](TrajectoryInfo& t) {
         t.drive->recorded = record({{0, 0, 0}, {0, 0, 0}}, {.start = HUGE_VAL});
       }},
      {"recorded",
       [](TrajectoryInfo& t) {
         t.drive->recorded = record({{0, 0, 0}, {0, 0, 0}}, {.cycles = -1});
       }},
      {"sigma_m", [](TrajectoryInfo& t) { t.scale.sigma_m = 0; }}};
  for (const auto& [what, spoil] : faults) {
    TrajectoryInfo info = sound();
    spoil(info);
    write(file, info);
    expect_refused(file, what);
  }
  write(file, sound(), 0, std::int64_t{1} << 60);
  expect_refused(file, "cycle");
  write(file, sound(), 20);
  expect_refused(file, "phase");
  for (const double far : {1.1e7, -1e300, HUGE_VAL}) {
    write(file, sound(), 0, 0, far);
    expect_refused(file, "positions must be within 1e+07");
  }
  write(file, sound(), 0, 0, 1e7);
  EXPECT_EQ(run_program({"validate", file}).code, 0);
}

/// Changes a valid file by hand, as damage or malice would.
template <class Change>
void spoil(const std::string& file, const std::string& object, Change change) {
  write(file, sound());
  const h5::Handle id = h5::own(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "opening");
  const h5::Handle part = h5::own(H5Oopen(id.get(), object.c_str(), H5P_DEFAULT), "opening " + object);
  change(part.get());
}

TEST(H5mdRanges, AnUnknownAxisIsNoIndex) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  spoil(file, "parameters/drive", [](hid_t drive) {
    ASSERT_GE(H5Adelete(drive, "axis"), 0);
    h5::write_attribute(drive, "axis", std::string("q"));
  });
  expect_refused(file, "axis");
  spoil(file, "parameters/drive", [](hid_t drive) {
    ASSERT_GE(H5Adelete(drive, "axis"), 0);
    h5::write_attribute(drive, "axis", 7);
  });
  expect_refused(file, "parameters/drive@axis: must be x, y or z");
}

TEST(H5mdRanges, AnUnknownSourceIsRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  spoil(file, "twincell", [](hid_t ours) {
    ASSERT_GE(H5Adelete(ours, "source"), 0);
    h5::write_attribute(ours, "source", std::string("a dream"));
  });
  expect_refused(file, "twincell@source: is 'a dream'; there are: unknown, simulation, experiment");
}

// Opening a pipe without a writer never returns.
TEST(H5mdRanges, APipeIsNotOpened) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe", file = folder / "t.h5";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  write(file, sound());
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"validate", pipe},
                                             {"analyze", pipe},
                                             {"draw", pipe, "-o", folder / "a.png"},
                                             {"analyze", file, "--rest-height", pipe}}) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 3) << words[0];
    EXPECT_NE(ran.err.find("a pipe or a socket; a regular file is needed"), std::string::npos) << ran.err;
  }
}

TEST(H5mdRanges, AFileThatMayNotBeReadIsNoDamagedOne) {
  const TemporaryFolder folder;
  const std::string file = folder / "a.h5", answer = folder / "answer";
  {
    H5mdWriter writer(file, TrajectoryInfo{.n_beads = 0});
    writer.finish();
  }
  std::filesystem::permissions(file, std::filesystem::perms::none);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const pid_t child = ::fork();
  if (child == 0) {  // root may read everything
    constexpr uid_t kOther = 65534;
    const bool other = ::geteuid() != 0 || ::setresuid(kOther, kOther, kOther) == 0;
    std::ofstream(answer) << (other ? complaint_of([&] { const H5mdReader reader(file); }) : "unable")
                          << std::flush;
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  const std::string said = read_text_file(answer);
  EXPECT_NE(said.find("a.h5: the file cannot be read (Permission denied)."), std::string::npos) << said;
}

TEST(H5mdRanges, StatedSizesMatchFileContent) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  spoil(file, "particles/trajectory/position/step", [](hid_t steps) {
    const hsize_t many = 1'000'000'000;
    ASSERT_GE(H5Dset_extent(steps, &many), 0);
  });
  expect_refused(file, "claims");
}

TEST(H5mdRanges, DataInOtherFilesIsNotRead) {
  const TemporaryFolder folder;
  for (const std::string kind : {"link", "virtual", "external"}) {
    const std::string file = folder / (kind + ".h5");
    write(file, sound());
    {
      const h5::Handle f = h5::own(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), file);
      test::add_elsewhere(f.get(), kind, folder / "other");
    }
    expect_refused(file, "only data in the file itself is read");
  }
}

// Frames that contradict themselves or each other.
TEST(H5mdRanges, FramesThatCannotBeAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  TrajectoryInfo info = sound();
  info.columns.identity = info.columns.position_sigma = info.columns.time_mean = true;
  info.columns.contact_forces = info.columns.force_mean = true;
  info.walls = {"bottom"};
  const auto put = [&](const std::function<void(Frame&)>& spoil, std::int64_t second_cycle = 1) {
    H5mdWriter writer(file, info);
    int written = 0;
    for (const std::int64_t cycle : {std::int64_t{0}, second_cycle}) {
      Frame frame;
      frame.step = static_cast<std::int64_t>(written) * 10;
      frame.time = static_cast<double>(frame.step);
      frame.position = {Vec3(1, 0, 1), Vec3(3, 0, 1)};
      frame.position_sigma = {Vec3(0.1, std::nan(""), 0.1), Vec3(0.1, std::nan(""), 0.1)};
      frame.id = {0, 1};
      frame.time_mean = {Vec3(0.1, 0, 0.2), Vec3(0.1, 0, 0.1)};
      frame.force_mean = BedForces::zero(1);
      frame.cycle = cycle;
      frame.phase = 4;
      if (written++ == 1) spoil(frame);
      writer.append(frame);
    }
    writer.finish();
  };
  put([](Frame&) {});
  EXPECT_EQ(run_program({"validate", file}).code, 0) << run_program({"validate", file}).err;
  const std::vector<std::pair<std::string, std::function<void(Frame&)>>> faults = {
      {"slot 1 is a bead without a finite position", [](Frame& f) { f.position[1].x() = std::nan(""); }},
      {"slot 0 is empty but has a position", [](Frame& f) { f.id[0] = -1; }},
      {"slot 0 is empty but has a position", [](Frame& f) { f.id[0] = -7; }},
      {"the id 1 occurs twice", [](Frame& f) { f.id[0] = 1; }},
      {"the uncertainty of bead 1 is -1", [](Frame& f) { f.position_sigma[1].x() = -1; }},
      {"a temperature is -5", [](Frame& f) { f.time_mean.temperature.z() = -5; }},
      {"a temperature is inf", [](Frame& f) { f.time_mean.temperature_coarse.x() = HUGE_VAL; }},
      {"beads touch for a fraction 1.5 of the time", [](Frame& f) { f.force_mean.in_contact = 1.5; }},
      {"the fraction of the time in which beads touch is infinite",
       [](Frame& f) { f.force_mean.in_contact = HUGE_VAL; }},
      {"its time means of forces and stress must be finite",
       [](Frame& f) { f.force_mean.stress(0, 2) = HUGE_VAL; }},
      {"its time means of forces and stress must be finite",
       [](Frame& f) { f.force_mean.wall_force[0].z() = std::nan(""); }},
      {"its mean kinetic stress and tangential force must not be negative",
       [](Frame& f) { f.force_mean.kinetic(2, 2) = -1; }}};
  for (const auto& [what, spoil] : faults) {
    put(spoil);
    const Ran valid = run_program({"validate", file}), used = run_program({"analyze", file, "-q"});
    for (const Ran& ran : {valid, used}) {
      EXPECT_EQ(ran.code, 3) << what;
      EXPECT_NE((ran.err + ran.out).find("frame 1: " + what), std::string::npos) << ran.err << ran.out;
    }
  }
  for (const std::int64_t cycle : {0, -1}) {
    put([](Frame&) {}, cycle);
    expect_refused(file, "which does not come after phase 4 of cycle 0 of frame 0");
  }
}

// A number that is text, or a group that is a number, is not the same as an absent one.
TEST(H5mdRanges, DataOfAnotherTypeAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  const auto as_text = [](const char* name) {
    return [name](hid_t group) {
      ASSERT_GE(H5Ldelete(group, name, H5P_DEFAULT), 0);
      h5::write_text(group, name, "0.5");
    };
  };
  spoil(file, "parameters/drive", as_text("omega"));
  expect_refused(file, "parameters/drive/omega: must be a single number");
  spoil(file, "parameters/drive", as_text("gravity"));
  expect_refused(file, "parameters/drive/gravity: must be a single number");
  spoil(file, "parameters", as_text("drive"));
  expect_refused(file, "parameters/drive: must be a group");
  spoil(file, "parameters", as_text("phases_per_cycle"));
  expect_refused(file, "parameters/phases_per_cycle: must be a single number");
  for (const std::string column : {"radius", "mass"}) {
    spoil(file, "particles/trajectory", as_text(column.c_str()));
    EXPECT_EQ(run_program({"validate", file}).code, 3);
    const Ran ran = run_program({"analyze", file});
    EXPECT_EQ(ran.code, 3);
    EXPECT_NE(ran.err.find("particles/trajectory/" + column + ": must be one number for each bead"),
              std::string::npos)
        << ran.err;
  }
  spoil(file, "particles/trajectory", [](hid_t group) {
    const std::uint8_t nine[] = {0, 9};
    if (h5::exists(group, "tracer")) {
      ASSERT_GE(H5Ldelete(group, "tracer", H5P_DEFAULT), 0);
    }
    h5::write_dataset(group, "tracer", nine, {2});
  });
  expect_refused(file, "tracer: is 9 for bead 1; it must be 0 or 1");
}

TEST(H5mdRanges, PositionsThatWereLostAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  TrajectoryInfo info = sound();
  info.n_beads = 3;
  info.radius = info.mass = {0.5, 0.5, 0.5};
  for (const double x : {1.0, 0.0}) {
    H5mdWriter writer(file, info);
    Frame frame;
    frame.position = {Vec3(0, 0, 0), Vec3(x, 0, 0), Vec3(2 * x, 0, 0)};
    frame.phase = 0;
    frame.cycle = 0;
    writer.append(frame);
    writer.finish();
    if (x > 0)
      EXPECT_EQ(run_program({"validate", file}).code, 0);
    else
      expect_refused(file, "frame 0: all beads are at one place");
  }
}

TEST(H5mdRanges, StepsRiseAndTimesDoNotFall) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  const auto put = [&](std::int64_t step, double time) {
    H5mdWriter writer(file, sound());
    Frame frame;
    frame.position = {Vec3(1, 0, 1), Vec3(3, 0, 1)};
    frame.step = 5;
    frame.time = 1;
    frame.phase = 0;
    frame.cycle = 0;
    writer.append(frame);
    frame.step = step;
    frame.time = time;
    frame.cycle = 1;
    writer.append(frame);
    writer.finish();
  };
  put(6, 1);
  EXPECT_EQ(run_program({"validate", file}).code, 0);
  put(6, 0.9);
  expect_refused(file, "0.9 of frame 1 is not finite, or before the time of the frame before");
  put(6, std::nan(""));
  expect_refused(file, "of frame 1 is not finite");
  put(6, 2);
  {
    const h5::Handle id = h5::own(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "opening");
    const h5::Handle steps =
        h5::own(H5Dopen2(id.get(), "particles/trajectory/position/step", H5P_DEFAULT), "opening the steps");
    const std::int64_t same[] = {5, 5};
    ASSERT_GE(H5Dwrite(steps.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, same), 0);
  }
  for (const char* verb : {"info", "analyze"}) {
    const Ran ran = run_program({verb, file});
    EXPECT_EQ(ran.code, 3);
    EXPECT_NE(ran.err.find("5 of frame 1 does not come after 5 of the frame before"), std::string::npos)
        << ran.err;
  }
}

// The plate of a simulation is where its drive puts it.
TEST(H5mdRanges, AChangedDriveIsFoundByThePlate) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  for (const double stated : {1.0, 2.0}) {
    TrajectoryInfo info = sound();
    info.columns.plate_height = true;
    info.drive->amplitude = stated;
    H5mdWriter writer(file, info);
    Frame frame;
    frame.position = {Vec3(1, 0, 1), Vec3(3, 0, 1)};
    frame.phase = 5;
    frame.cycle = 0;
    frame.plate_height = 1;  // A sin(pi/2)
    writer.append(frame);
    writer.finish();
    if (stated == 2) {
      expect_refused(file, "frame 0: the plate is at 1, but the drive of the file puts it at 2");
      continue;
    }
    for (const char* verb : {"validate", "analyze"}) EXPECT_EQ(run_program({verb, file}).code, 0) << verb;
  }
}

// The phases belong to a number of phases in each cycle.
TEST(H5mdRanges, AnotherNumberOfPhasesIsFoundByThePlate) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  TrajectoryInfo info = sound();
  info.columns.plate_height = true;
  info.phases_per_cycle = 40;
  H5mdWriter writer(file, info);
  Frame frame;
  frame.position = {Vec3(1, 0, 1), Vec3(3, 0, 1)};
  frame.phase = 5;
  frame.cycle = 0;
  frame.plate_height = 1;  // of 20 phases per cycle
  writer.append(frame);
  writer.finish();
  expect_refused(file, "the plate is at 1, but the drive of the file puts it at 0.70");
}

TEST(H5mdRanges, TheBoxIsThatOfTheCell) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5", box = "particles/trajectory/box";
  spoil(file, "particles/trajectory",
        [](hid_t group) { ASSERT_GE(H5Ldelete(group, "box", H5P_DEFAULT), 0); });
  expect_refused(file, box + ": the group is missing");
  for (const double edge : {std::nan(""), 1e9, -1.0, 5.0}) {
    spoil(file, box + "/edges", [&](hid_t edges) {
      const h5::Handle value = h5::own(H5Dopen2(edges, "value", H5P_DEFAULT), "opening the edges");
      const double all[] = {10, 0, 0, 0, 1, 0, 0, 0, edge};
      ASSERT_GE(H5Dwrite(value.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all), 0);
    });
    expect_refused(file, box + "/edges: edge [2][2] of frame 0 is ");
  }
}

TEST(H5mdRanges, NumbersOfARunAreThoseOfItsBeads) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  TrajectoryInfo info = sound();
  info.box.boundary[0] = Boundary::wall;
  info.conditions.n_l = 0.2;
  write(file, info);
  EXPECT_EQ(run_program({"validate", file}).code, 0);
  info.conditions.n_l = 99;
  write(file, info);
  expect_refused(file, "twincell/conditions/n_l: is 99, but 2 beads in a cell 10 wide are 0.2 layers");
  info.conditions.n_l.reset();
  info.radius[0] = 10.1;
  write(file, info);
  expect_refused(file, "radius: 10.1 of bead 0 is out of range; it must be above 0 and at most 10");
  spoil(file, "parameters", [](hid_t parameters) { h5::write_scalar(parameters, "samples_per_cycle", -5); });
  expect_refused(file, "parameters/samples_per_cycle: is -5; it must be a whole number between 0 and");
}

TEST(H5mdRanges, SpeedsBeyondAnyBedAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "t.h5";
  for (const bool spins : {false, true}) {
    TrajectoryInfo info = sound();
    (spins ? info.columns.spin : info.columns.velocity) = true;
    for (const double speed : {1e8, 1e9, HUGE_VAL}) {
      H5mdWriter writer(file, info);
      Frame frame;
      frame.position = {Vec3(1, 0, 1), Vec3(3, 0, 1)};
      std::vector<Vec3>& column = spins ? frame.spin : frame.velocity;
      column.assign(2, Vec3::Constant(std::nan("")));
      column[1].y() = speed;
      frame.phase = 0;
      frame.cycle = 0;
      writer.append(frame);
      writer.finish();
      const Ran ran = run_program({"validate", file});
      EXPECT_EQ(ran.code, speed > 1e8 ? 3 : 0) << ran.out << ran.err;
      EXPECT_EQ(
          (ran.out + ran.err).find(spins ? "of the spin of bead 1 is" : "of the velocity of bead 1 is") !=
              std::string::npos,
          speed > 1e8);
    }
  }
}

}  // namespace
}  // namespace twincell::h5md_ranges_test
