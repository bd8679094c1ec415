#include "trajectory/formats/h5md_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "core/hdf5_open.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"
#include "trajectory/recorded_motion.hpp"

namespace twincell::h5md_file_test {
namespace {

namespace fs = std::filesystem;

TrajectoryInfo experiment_info() {
  TrajectoryInfo info;
  info.n_beads = 3;
  info.columns = {.velocity = true,
                  .spin = false,
                  .identity = true,
                  .phase = true,
                  .plate_height = true,
                  .time_mean = true};
  info.box.upper = Vec3(20, 1.15, 110);
  info.box.side_tilt = {0.6, -0.25};
  info.drive = Drive{Axis::z, 1.8, 1.0};
  info.phases_per_cycle = 20;
  info.samples_per_cycle = 400;
  info.scale = {0.002, 9.81, std::nullopt};
  info.source = Origin::experiment;
  info.radius = {0.5, 0.5, 0.49};
  info.tracer = {0, 1, 0};
  info.provenance_json = R"({"program":"twincell"})";
  return info;
}

/// Bead 2 is absent in odd frames.
Frame frame_number(int f) {
  Frame frame;
  frame.step = 10 * f;
  frame.time = 0.1 * f;
  frame.phase = f % 20;
  frame.cycle = f / 20;
  frame.plate_height = std::sin(0.1 * f);
  if (f > 0) frame.time_mean = {Vec3(0.1, 0, f / 3.0), Vec3(0.2, 0, f / 7.0)};
  const double nan = std::nan("");
  const bool there = f % 2 == 0;
  frame.position = {Vec3(0.5, 0, 0.5 + f), Vec3(1.5, 0, 0.5),
                    there ? Vec3(2.5, 0, 1.0 / 3.0) : Vec3(nan, nan, nan)};
  frame.velocity = {Vec3(0, 0, 1), Vec3(0, 0, 0), there ? Vec3(1, 0, 0) : Vec3(nan, nan, nan)};
  frame.id = {0, 1, there ? 2 : -1};
  return frame;
}

void write(const fs::path& path, int frames) {
  H5mdWriter writer(path, experiment_info());
  for (int f = 0; f < frames; ++f) writer.append(frame_number(f));
  writer.finish();
}

/// The conditions that a reader finds in a file of this metadata.
RunConditions conditions_through_file(const TrajectoryInfo& info) {
  const TemporaryFolder folder;
  H5mdWriter writer(folder / "run.h5", info);
  writer.append(frame_number(0));
  writer.finish();
  return H5mdReader(folder / "run.h5").info().conditions;
}

TEST(H5mdFile, TimeMeansOfForcesAreStored) {
  const TemporaryFolder folder;
  for (const std::size_t walls : {0, 2}) {
    TrajectoryInfo info = experiment_info();
    info.columns.contact_forces = info.columns.force_mean = true;
    info.walls.assign(walls, "bottom");
    std::vector<BedForces> means;
    {
      H5mdWriter writer(folder / "run.h5", info);
      for (int f = 0; f < 3; ++f) {
        Frame frame = frame_number(f);
        if (f > 0) {
          BedForces& m = frame.force_mean;
          m = BedForces::zero(walls);
          for (std::size_t w = 0; w < walls; ++w) {
            m.wall_normal_force[w] = 3.0 * f + static_cast<double>(w);
            m.wall_force[w] = Vec3(-0.5, f, static_cast<double>(w) / 3);
          }
          m.stress << 1, 2, 3, 4, 5, 6, 7, 8, 9.0 * f;
          m.kinetic << 9, 2, 3, 4, 8, 6, 7, 8, 1.0 / f;
          m.in_contact = 0.25 * f, m.normal_force = -1.0 / 3, m.tangential_force = 0.125;
        }
        means.push_back(frame.force_mean);
        writer.append(frame);
      }
      writer.finish();
    }
    EXPECT_TRUE(validate_h5md(folder / "run.h5").empty());
    const H5mdReader reader(folder / "run.h5");
    EXPECT_TRUE(reader.info().columns.force_mean);
    Frame frame;
    for (const std::size_t f : {2, 0, 1}) {
      reader.read(f, frame);
      EXPECT_EQ(frame.force_mean.known(), f > 0);
      EXPECT_EQ(frame.force_mean.wall_force, means[f].wall_force);
      EXPECT_EQ(frame.force_mean.wall_normal_force, means[f].wall_normal_force);
      if (f == 0) continue;
      EXPECT_EQ(frame.force_mean.stress, means[f].stress);
      EXPECT_EQ(frame.force_mean.kinetic, means[f].kinetic);
      EXPECT_EQ(frame.force_mean.in_contact, means[f].in_contact);
      EXPECT_EQ(frame.force_mean.normal_force, means[f].normal_force);
      EXPECT_EQ(frame.force_mean.tangential_force, means[f].tangential_force);
    }
  }
  // Files of earlier versions have contact forces without means.
  TrajectoryInfo earlier = experiment_info();
  earlier.columns.contact_forces = true;
  H5mdWriter writer(folder / "earlier.h5", earlier);
  writer.append(frame_number(1));
  writer.finish();
  const H5mdReader reader(folder / "earlier.h5");
  EXPECT_FALSE(reader.info().columns.force_mean);
  Frame frame;
  reader.read(0, frame);
  EXPECT_FALSE(frame.force_mean.known());
}

TEST(H5mdFile, TheHarmonicsOfTheDriveAreStored) {
  const TemporaryFolder folder;
  TrajectoryInfo info = experiment_info();
  const auto read_back = [&] {
    H5mdWriter writer(folder / "run.h5", info);
    writer.append(frame_number(0));
    writer.finish();
    return H5mdReader(folder / "run.h5").info().drive.value();
  };
  EXPECT_TRUE(read_back().harmonics.empty());
  info.drive->harmonics = {{0.1, 0.25}, {0.02, 1.0 / 3}};
  const Drive drive = read_back();
  ASSERT_EQ(drive.harmonics.size(), 2);
  EXPECT_EQ(drive.displacement(0.3), info.drive->displacement(0.3));
  EXPECT_EQ(drive.harmonics[1].phase, 1.0 / 3);
}

// A program that knows no ramp must refuse the file, and not read it as a steady drive.
TEST(H5mdFile, TheVersionOfTheSchemaIsTheLowestThatUnderstandsTheDrive) {
  const TemporaryFolder folder;
  const auto version = [&](const Drive& drive) {
    TrajectoryInfo info = experiment_info();
    info.drive = drive;
    H5mdWriter writer(folder / "run.h5", info);
    writer.append(frame_number(0));
    writer.finish();
    const h5::Handle file(H5Fopen((folder / "run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    const h5::Handle ours(H5Gopen2(file.get(), "twincell", H5P_DEFAULT));
    return h5::read_int_attribute(ours.get(), "schema_version").at(0);
  };
  const Drive steady{Axis::z, 1.8, 1.0};
  Drive ramped = steady, tilted = steady;
  ramped.ramp = {.from = {1.8, 1.0}, .to = {2.4, 1.0}, .power = 0, .first = 3, .cycles = 8};
  tilted.horizontal = HorizontalMotion{.amplitude = 0.3};
  EXPECT_EQ(version(steady), 1);
  EXPECT_EQ(version(ramped), 2);
  EXPECT_EQ(version(tilted), 2);
  EXPECT_EQ(kSchemaVersion, 2);
}

TEST(H5mdFile, TheRecordOfTheDriveIsStored) {
  const TemporaryFolder folder;
  TrajectoryInfo info = experiment_info();
  const std::vector<MotionSample> samples = {{0.1, 1, -2}, {0.3, 0.5, 1.0 / 3}, {-0.2, 0, 0}};
  for (const int cycles : {0, 2}) {
    const RecordInfo record{
        .interval = 0.7, .start = 0.25, .cycles = cycles, .file = "trace.csv", .sha256 = "12ab34cd56"};
    info.drive->recorded = std::make_shared<RecordedMotion>(samples, record);
    H5mdWriter writer(folder / "run.h5", info);
    writer.append(frame_number(0));
    writer.finish();
    const Drive drive = H5mdReader(folder / "run.h5").info().drive.value();
    ASSERT_NE(drive.recorded, nullptr);
    for (const double fraction : {0.0, 0.03, 0.1})
      for (const int cycle : {0, 1}) {
        EXPECT_EQ(drive.displacement(fraction, cycle), info.drive->displacement(fraction, cycle));
        EXPECT_EQ(drive.velocity(fraction, cycle), info.drive->velocity(fraction, cycle));
        EXPECT_EQ(drive.acceleration(fraction, cycle), info.drive->acceleration(fraction, cycle));
      }
    EXPECT_EQ(drive.formula(), info.drive->formula());
    EXPECT_EQ(drive.formula(), std::string("recorded in trace.csv (SHA-256 12ab34cd...)") +
                                   (cycles > 0 ? ", 2 cycles repeated" : ""));
  }
}

TEST(H5mdFile, TheConditionsOfARunAreStored) {
  TrajectoryInfo info = experiment_info();
  info.conditions = {.n_l = 20.05, .gamma = 1.8, .start = "crystal_a"};
  const RunConditions read = conditions_through_file(info);
  EXPECT_EQ(read.n_l, 20.05);
  EXPECT_EQ(read.gamma, 1.8);
  EXPECT_EQ(read.start, "crystal_a");
  // Each of them can be absent.
  const RunConditions none = conditions_through_file(experiment_info());
  EXPECT_FALSE(none.n_l || none.gamma);
  EXPECT_EQ(none.start, "");
}

TEST(H5mdFile, TheStartOfAnEarlierSimulationComesFromItsScene) {
  TrajectoryInfo info = experiment_info();
  info.source = Origin::simulation;
  info.provenance_json = R"({"config": "[start]\nkind = \"random\"\n"})";
  EXPECT_EQ(conditions_through_file(info).start, "random");
  info.provenance_json = R"({"config": "[start\n"})";
  EXPECT_EQ(conditions_through_file(info).start, "") << "a damaged record states no start";
  // Stored conditions are not overruled by a text.
  info.provenance_json = R"({"config": "[start]\nkind = \"random\"\n"})";
  info.conditions.start = "table";
  EXPECT_EQ(conditions_through_file(info).start, "table");
}

TEST(H5mdFile, ImpossibleConditionsAreRefused) {
  TrajectoryInfo info = experiment_info();
  info.conditions = {.n_l = -1, .gamma = 1.8, .start = {}};
  expect_refusal<InputError>([&] { (void)conditions_through_file(info); }, "twincell/conditions/n_l", "-1");
  info.conditions = {.n_l = 1, .gamma = std::nan(""), .start = {}};
  expect_refusal<InputError>([&] { (void)conditions_through_file(info); }, "twincell/conditions/gamma",
                             "not negative");
  info.conditions = {.n_l = 1, .gamma = 3.6, .start = {}};
  expect_refusal<InputError>([&] { (void)conditions_through_file(info); }, "twincell/conditions/gamma",
                             "parameters/drive states Gamma = 1.8");
}

TEST(H5mdFile, WhatIsWrittenIsReadBitForBit) {
  const TemporaryFolder folder;
  write(folder / "run.h5", 45);
  const H5mdReader reader(folder / "run.h5");
  const TrajectoryInfo& info = reader.info();
  EXPECT_EQ(reader.n_frames(), 45U);
  EXPECT_EQ(info.n_beads, 3U);
  EXPECT_TRUE(info.columns.velocity && info.columns.identity && info.columns.phase &&
              info.columns.plate_height);
  EXPECT_FALSE(info.columns.spin);
  EXPECT_EQ(info.box.upper, Vec3(20, 1.15, 110));
  EXPECT_EQ(info.box.boundary[0], Boundary::wall);
  EXPECT_EQ(info.box.boundary[1], Boundary::open);
  EXPECT_EQ(info.box.side_tilt, (std::array<double, 2>{0.6, -0.25}));
  ASSERT_TRUE(info.drive);
  EXPECT_EQ(info.drive->amplitude, 1.8);
  EXPECT_EQ(info.phases_per_cycle, 20);
  EXPECT_EQ(info.samples_per_cycle, 400);
  EXPECT_TRUE(info.columns.time_mean);
  EXPECT_EQ(info.scale.sigma_m, 0.002);
  EXPECT_FALSE(info.scale.pixels_per_sigma);
  EXPECT_EQ(info.radius, (std::vector<double>{0.5, 0.5, 0.49}));
  EXPECT_EQ(info.tracer, (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_TRUE(info.mass.empty());
  EXPECT_EQ(info.source, Origin::experiment);
  Frame frame;
  for (int f : {44, 0, 17}) {
    reader.read(static_cast<std::size_t>(f), frame);
    const Frame truth = frame_number(f);
    EXPECT_EQ(frame.step, truth.step);
    EXPECT_EQ(frame.time, truth.time);
    EXPECT_EQ(frame.phase, truth.phase);
    EXPECT_EQ(frame.cycle, truth.cycle);
    EXPECT_EQ(frame.plate_height, truth.plate_height);
    EXPECT_EQ(frame.time_mean.temperature.hasNaN(), truth.time_mean.temperature.hasNaN());
    if (!truth.time_mean.temperature.hasNaN()) {
      EXPECT_EQ(frame.time_mean.temperature, truth.time_mean.temperature);
      EXPECT_EQ(frame.time_mean.temperature_coarse, truth.time_mean.temperature_coarse);
    }
    EXPECT_EQ(frame.id, truth.id);
    EXPECT_TRUE(frame.spin.empty());
    for (std::size_t i = 0; i < 3; ++i)
      if (truth.present(i))
        EXPECT_EQ(frame.position[i], truth.position[i]);
      else
        EXPECT_FALSE(frame.position[i].allFinite());
    EXPECT_EQ(frame.n_present(), f % 2 == 0 ? 3U : 2U);
  }
  EXPECT_TRUE(validate_h5md(folder / "run.h5").empty());
}

// Deflating motion in space, where no coordinate is zero, would save a few percent of the file only.
TEST(H5mdFile, OnlyMotionInAPlaneIsDeflated) {
  const TemporaryFolder folder;
  constexpr std::size_t kBeads = 400, kFrames = 10;
  for (const int dimension : {2, 3}) {
    TrajectoryInfo info;
    info.n_beads = kBeads;
    info.box.dimension = dimension;
    info.box.upper = Vec3(1, 1, 1);
    {
      H5mdWriter writer(folder / "run.h5", info);
      Frame frame;
      frame.position.assign(kBeads, Vec3(0.5, 0, 0.5));
      for (std::size_t f = 0; f < kFrames; ++f) {
        frame.step = static_cast<std::int64_t>(f), frame.time = static_cast<double>(f);
        writer.append(frame);
      }
      writer.finish();
    }
    const h5::Handle file = h5::open_file(folder / "run.h5");
    const h5::Handle position = h5::own(
        H5Dopen2(file.get(), "particles/trajectory/position/value", H5P_DEFAULT), "opening positions");
    const std::uint64_t size = kFrames * kBeads * 3 * sizeof(double),
                        stored = h5::stored_bytes(position.get());
    if (dimension == 2)
      EXPECT_LT(stored, size / 10);
    else
      EXPECT_EQ(stored, size);
  }
}

TEST(H5mdFile, ContactForcesAreStoredWithTheirConnectivity) {
  const TemporaryFolder folder;
  TrajectoryInfo info = experiment_info();
  info.columns.contact_forces = true;
  info.walls = {"bottom", "left"};
  const ContactForce touch{0, 1, 0.125, -Vec3::UnitX(), 2.5, Vec3(0, 0, 0.75)},
      floor{0, -1, 0.5, Vec3::UnitZ(), 3, Vec3(-1, 0, 0)},
      second{1, 2, 0.25, Vec3::UnitX(), -1, Vec3::Zero()};
  const std::vector<std::vector<ContactForce>> of = {{}, {floor, touch}, {floor, touch, second}, {}};
  {
    H5mdWriter writer(folder / "run.h5", info);
    for (int f = 0; f < 4; ++f) {
      Frame frame = frame_number(2 * f);
      frame.contact_forces = of[static_cast<std::size_t>(f)];
      writer.append(frame);
    }
    writer.finish();
  }
  const H5mdReader reader(folder / "run.h5");
  EXPECT_TRUE(reader.info().columns.contact_forces);
  EXPECT_EQ(reader.info().walls, info.walls);
  Frame frame;
  for (std::size_t f = 0; f < 4; ++f) {
    reader.read(f, frame);
    ASSERT_EQ(frame.contact_forces.size(), of[f].size());
    for (std::size_t k = 0; k < of[f].size(); ++k) {
      const ContactForce &a = frame.contact_forces[k], &b = of[f][k];
      EXPECT_EQ(std::pair(a.i, a.j), std::pair(b.i, b.j));
      EXPECT_EQ(a.overlap, b.overlap);
      EXPECT_EQ(a.normal, b.normal);
      EXPECT_EQ(a.normal_force, b.normal_force);
      EXPECT_EQ(a.tangential_force, b.tangential_force);
    }
  }
  EXPECT_TRUE(validate_h5md(folder / "run.h5").empty());
  // The standard element holds the pairs of beads, -1 where a frame has fewer.
  const h5::Handle file(H5Fopen((folder / "run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  EXPECT_EQ(h5::read_dataset<std::int32_t>(file.get(), "connectivity/contacts/value"),
            (std::vector<std::int32_t>{-1, -1, -1, -1, 0, 1, -1, -1, 0, 1, 1, 2, -1, -1, -1, -1}));
  EXPECT_TRUE(h5::exists(file.get(), "connectivity/contacts/step"));
  // A damaged list is refused.
  fs::copy_file(folder / "run.h5", folder / "damaged.h5");
  {
    const h5::Handle damaged(H5Fopen((folder / "damaged.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
    const std::int64_t counts[] = {0, 2, 9, 0};
    const h5::Handle set(H5Dopen2(damaged.get(), "twincell/contact_forces/count", H5P_DEFAULT));
    ASSERT_GE(H5Dwrite(set.get(), h5::native<std::int64_t>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, counts), 0);
  }
  expect_refusal<InputError>([&] { H5mdReader broken(folder / "damaged.h5"); },
                             "twincell/contact_forces/count", "9 contacts exceeds the 5 contacts");
  // Without an announcement, contact forces are refused.
  H5mdWriter writer(folder / "other.h5", experiment_info());
  frame = frame_number(0);
  frame.contact_forces = {touch};
  EXPECT_THROW(writer.append(frame), RunError);
}

TEST(H5mdFile, WithoutAContactTheListsOfContactForcesAreEmpty) {
  const TemporaryFolder folder;
  TrajectoryInfo info = experiment_info();
  info.columns.contact_forces = true;
  H5mdWriter writer(folder / "run.h5", info);
  writer.append(frame_number(0));
  writer.append(frame_number(2));
  writer.finish();
  const h5::Handle file(H5Fopen((folder / "run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const h5::Series pairs(file.get(), "twincell/contact_forces/pairs"),
      values(file.get(), "twincell/contact_forces/values");
  ASSERT_TRUE(pairs && values);
  EXPECT_EQ(pairs.size(), 0U);
  EXPECT_EQ(pairs.record(), std::vector<hsize_t>{2});
  EXPECT_EQ(values.size(), 0U);
  EXPECT_EQ(values.record(), std::vector<hsize_t>{8});
  EXPECT_TRUE(validate_h5md(folder / "run.h5").empty());
  Frame frame;
  H5mdReader(folder / "run.h5").read(1, frame);
  EXPECT_TRUE(frame.contact_forces.empty());
}

TEST(H5mdFile, NothingAppearsUnderTheFinalNameBeforeTheEnd) {
  const TemporaryFolder folder;
  {
    H5mdWriter writer(folder / "run.h5", experiment_info());
    writer.append(frame_number(0));
    EXPECT_FALSE(fs::exists(folder / "run.h5"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(H5mdFile, EmptyTrajectoriesAreLegal) {
  const TemporaryFolder folder;
  TrajectoryInfo none;
  H5mdWriter writer(folder / "none.h5", none);
  Frame frame;
  writer.append(frame);
  writer.finish();
  const H5mdReader reader(folder / "none.h5");
  EXPECT_EQ(reader.info().n_beads, 0U);
  EXPECT_EQ(reader.n_frames(), 1U);
  reader.read(0, frame);
  EXPECT_TRUE(std::isnan(frame.plate_height));
  EXPECT_TRUE(validate_h5md(folder / "none.h5").empty());
}

TEST(H5mdFile, AppendRefusesInconsistentFrames) {
  const TemporaryFolder folder;
  H5mdWriter writer(folder / "run.h5", experiment_info());
  writer.append(frame_number(1));
  EXPECT_THROW(writer.append(frame_number(1)), RunError);  // step does not increase
  Frame short_frame = frame_number(2);
  short_frame.velocity.pop_back();
  EXPECT_THROW(writer.append(short_frame), RunError);
}

std::string complaint_of(const fs::path& path) {
  try {
    const H5mdReader reader(path);
    Frame frame;
    for (std::size_t f = 0; f < reader.n_frames(); ++f) reader.read(f, frame);
  } catch (const Error& e) {
    EXPECT_EQ(e.exit_code(), ExitCode::input) << e.what();
    return e.what();
  }
  return "accepted";
}

TEST(H5mdFile, DamagedFilesAreOneSentence) {
  const TemporaryFolder folder;
  EXPECT_NE(complaint_of(folder / "absent.h5").find("absent.h5: the file does not exist."),
            std::string::npos);
  std::ofstream(folder / "text.h5") << "not hdf5";
  EXPECT_NE(complaint_of(folder / "text.h5").find("not an HDF5 file"), std::string::npos);
  std::ofstream(folder / "empty.h5").close();
  EXPECT_NE(complaint_of(folder / "empty.h5").find("not an HDF5 file"), std::string::npos);
  write(folder / "run.h5", 45);
  const auto size = fs::file_size(folder / "run.h5");
  for (const double part : {0.1, 0.5, 0.9, 0.999}) {
    fs::copy_file(folder / "run.h5", folder / "cut.h5", fs::copy_options::overwrite_existing);
    fs::resize_file(folder / "cut.h5", static_cast<std::uintmax_t>(part * static_cast<double>(size)));
    EXPECT_NE(complaint_of(folder / "cut.h5").find("truncated"), std::string::npos) << part;
  }
}

TEST(H5mdFile, ADamagedChunkNamesTheFrame) {
  const TemporaryFolder folder;
  write(folder / "run.h5", 150);
  // Finds the second chunk of positions through HDF5 itself and overwrites it with invalid data.
  haddr_t where = 0;
  hsize_t chunk[3] = {};
  {
    const h5::Handle file(H5Fopen((folder / "run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    const h5::Handle set(H5Dopen2(file.get(), "particles/trajectory/position/value", H5P_DEFAULT));
    const h5::Handle layout(H5Dget_create_plist(set.get()));
    ASSERT_EQ(H5Pget_chunk(layout.get(), 3, chunk), 3);
    chunk[1] = chunk[2] = 0;
    hsize_t bytes = 0;
    unsigned mask = 0;
    ASSERT_GE(H5Dget_chunk_info_by_coord(set.get(), chunk, &mask, &where, &bytes), 0);
  }
  std::fstream raw(folder / "run.h5", std::ios::in | std::ios::out | std::ios::binary);
  raw.seekp(static_cast<std::streamoff>(where));
  raw << "scribble";
  raw.close();
  const std::string complaint = complaint_of(folder / "run.h5");
  EXPECT_NE(complaint.find("frame " + std::to_string(chunk[0]) + ":"), std::string::npos) << complaint;
  EXPECT_FALSE(validate_h5md(folder / "run.h5").empty());
}

// Files of other programs: omitted fields are inferred from the frames.
TEST(H5mdFile, ThePlaneAndThePhasesShowInTheFrames) {
  const TemporaryFolder folder;
  for (const bool planar : {true, false}) {
    const std::string file = folder / (planar ? "plane.h5" : "space.h5");
    {
      H5mdWriter writer(file, experiment_info());
      for (int f = 0; f < 45; ++f) {
        Frame frame = frame_number(f);
        if (!planar) frame.position[1].y() = 0.5;
        writer.append(frame);
      }
      writer.finish();
      const h5::Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
      H5Ldelete(opened.get(), "twincell/cell", H5P_DEFAULT);
      H5Ldelete(opened.get(), "parameters/phases_per_cycle", H5P_DEFAULT);
    }
    const H5mdReader reader(file);
    EXPECT_EQ(reader.info().box.dimension, planar ? 2 : 3);
    EXPECT_EQ(reader.info().phases_per_cycle, 20);
  }
}

TEST(H5mdFile, ValidateFindsBrokenLinksAndWrongAttributes) {
  const TemporaryFolder folder;
  write(folder / "run.h5", 5);
  {
    const h5::Handle file(H5Fopen((folder / "run.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
    H5Ldelete(file.get(), "particles/trajectory/velocity/step", H5P_DEFAULT);
    const h5::Handle box(H5Oopen(file.get(), "particles/trajectory/box", H5P_DEFAULT));
    H5Adelete(box.get(), "dimension");
    h5::write_attribute(box.get(), "dimension", 2);
  }
  const auto faults = validate_h5md(folder / "run.h5");
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0], "particles/trajectory/velocity/step: the dataset is missing.");
  EXPECT_EQ(faults[1], "particles/trajectory/box@dimension: must be 3.");
}

TEST(H5mdFile, UnwritablePlaces) {
  const TemporaryFolder folder;
  EXPECT_THROW(H5mdWriter(folder / "no/such/folder.h5", experiment_info()), ConfigError);
  fs::create_directory(folder / "taken.h5");
  EXPECT_THROW(H5mdWriter(folder / "taken.h5", experiment_info()), ConfigError);
}

}  // namespace
}  // namespace twincell::h5md_file_test
