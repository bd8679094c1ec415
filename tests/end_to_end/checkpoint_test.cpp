// Runs that are stopped, killed or damaged, as a user meets them: a resumed run ends with the same datasets.

#include "sim/run/checkpoint.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include "core/hdf5.hpp"
#include "core/provenance.hpp"
#include "tests/support/datasets.hpp"
#include "tests/support/program.hpp"

namespace twincell::checkpoint_test {
namespace {

namespace fs = std::filesystem;

constexpr int kDone = 0, kUsage = 2, kInput = 3, kPartial = 5;

class Checkpoints : public ::testing::Test {
 protected:
  Checkpoints() {
    std::ofstream(scene_) << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 60\n[cell]\nwidth = 8.0\n"
                             "[drive]\ngamma = 2.0\n[start]\nkind = \"random\"\n[time]\nsteps_per_contact = "
                             "10\ncycles = 30\ndiscard = 1\n";
  }

  [[nodiscard]] std::vector<std::string> words(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"simulate", scene_, "-o", output_, "-q"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Datasets of an uninterrupted run.
  [[nodiscard]] std::map<std::string, std::string> uninterrupted() const {
    const std::string path = folder_ / "whole.h5";
    const Ran ran = run_program({"simulate", scene_, "-o", path, "-q"});
    EXPECT_EQ(ran.code, kDone) << ran.err;
    auto all = datasets_of(path);
    fs::remove(path);
    EXPECT_GT(all.size(), 10U);
    return all;
  }
  void expect_refusal(const std::vector<std::string>& more, int code,
                      const std::vector<std::string>& mentioned) const {
    const Ran ran = run_program(words(more));
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    for (const auto& word : mentioned) EXPECT_NE(ran.err.find(word), std::string::npos) << ran.err;
  }
  /// Starts a run and stops it once it has saved a checkpoint that contains frames.
  [[nodiscard]] Ran stopped_in_the_middle(int signal) const {
    RunningProgram program(words({"--checkpoint-every", "0.02"}));
    EXPECT_TRUE(program.wait_until(folder_.path(), [&] { return fs::exists(place_ / "segment-0002.h5"); }));
    program.signal(signal);
    return program.wait();
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "scene.toml", output_ = folder_ / "o.h5";
  fs::path place_ = folder_ / "o.h5.checkpoint";
};

TEST_F(Checkpoints, KilledAgainAndAgainTheRunEndsAsIfNothingHadHappened) {
  const auto whole = uninterrupted();
  std::mt19937 random(20150101);
  int killed = 0, ended = 0;
  for (int k = 0; k < 60 && ended == 0; ++k) {
    // Every update saves a checkpoint: a kill right after a change of a file hits a save.
    FolderEvents changes(folder_.path());
    RunningProgram program(words({"--resume", "--checkpoint-every", "1e-9"}));
    const std::size_t last = 20 + random() % 400;
    for (std::size_t seen = 0, more = 1; seen < last && more > 0; seen += more)
      more = changes.wait(program.id());
    program.signal(SIGKILL);
    const Ran ran = program.wait();
    if (ran.code == 128 + SIGKILL) {
      ++killed;
      continue;
    }
    ++ended;
    EXPECT_EQ(ran.code, kDone) << ran.err;
  }
  EXPECT_GE(killed, 3);
  const Ran last = run_program(words({"--resume"}));
  EXPECT_EQ(last.code, kDone) << last.err;
  EXPECT_EQ(datasets_of(output_), whole);
  EXPECT_EQ(names_in(folder_.path()), (std::vector<std::string>{"o.h5", "scene.toml"}));
}

TEST_F(Checkpoints, SignalsSaveAndSayHowToGoOn) {
  const auto whole = uninterrupted();
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGTERM, 143}}) {
    const Ran ran = stopped_in_the_middle(signal);
    ASSERT_EQ(ran.code, code) << ran.err;
    EXPECT_NE(ran.err.find("--resume"), std::string::npos) << ran.err;
    EXPECT_FALSE(fs::exists(output_));
    expect_refusal({}, kUsage, {"o.h5.checkpoint", "unfinished run", "--resume"});
    const Ran rest = run_program(words({"--resume"}));
    EXPECT_EQ(rest.code, kDone) << rest.err;
    EXPECT_EQ(datasets_of(output_), whole);
    EXPECT_EQ(names_in(folder_.path()), (std::vector<std::string>{"o.h5", "scene.toml"}));
    // A script that resumes once more gets no error.
    EXPECT_EQ(run_program(words({"--resume"})).code, kDone);
    fs::remove(output_);
  }
}

TEST_F(Checkpoints, AnotherSceneIsRefusedByTheKeyThatDiffers) {
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  expect_refusal({"--resume", "--set", "drive.gamma=2.1"}, kUsage, {"drive.gamma", "2.1", "2.0"});
  expect_refusal({"--resume", "--set", "time.cycles=31"}, kUsage, {"time.cycles", "31", "30"});
  expect_refusal({"--resume", "--seed", "4"}, kUsage, {"start.seed", "4", "absent"});
  EXPECT_TRUE(fs::exists(place_ / "state.h5"));
}

TEST_F(Checkpoints, ARecordedDriveGoesOnAndAChangedRecordIsRefused) {
  const auto put_record = [&](double a) {
    std::ofstream record(folder_ / "trace.csv");
    record << "time_t0,position_sigma\n";
    for (int i = 0; i < 3500; ++i)
      record << fmt::format("{:.4f},{:.9f}\n", 0.1 * i, a * std::sin(0.6 * i * 0.1));
  };
  put_record(4);
  {
    std::ofstream scene(scene_);
    scene
        << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 60\n[cell]\nwidth = 8.0\n[drive]\nfile = "
           "\"trace.csv\"\nomega = 0.6\n[start]\nkind = \"random\"\n[time]\nsteps_per_contact = 10\ncycles = "
           "30\ndiscard = 1\n";
  }
  const auto whole = uninterrupted();
  EXPECT_TRUE(whole.contains("parameters/drive/recorded/samples"));
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  put_record(4.1);
  expect_refusal({"--resume"}, kUsage, {"drive.file_sha256", "in the run that is to be resumed"});
  put_record(4);
  EXPECT_EQ(run_program(words({"--resume"})).code, kDone);
  EXPECT_EQ(datasets_of(output_), whole);
}

TEST_F(Checkpoints, AChangedFileOfTheStartIsRefused) {
  const auto put_beads = [&](int count) {
    std::ofstream beads(folder_ / "beads.csv");
    beads << "x,z\n";
    for (int i = 0; i < count; ++i) beads << fmt::format("{},{}\n", 0.6 + i % 7, 0.6 + 1.1 * (i / 7));
  };
  put_beads(40);
  std::ofstream(scene_)
      << "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 8.0\n[drive]\ngamma = 2.0\n[start]\n"
         "kind = \"table\"\nfrom = \"beads.csv\"\n[time]\nsteps_per_contact = 10\ncycles = 30\n"
         "discard = 1\n";
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  put_beads(35);
  expect_refusal({"--resume"}, kUsage, {"start.from", "beads.csv has changed since the run began"});
  put_beads(40);
  EXPECT_EQ(run_program(words({"--resume"})).code, kDone);
}

// A finished run is not finished any more once the file of its start has changed.
TEST_F(Checkpoints, AFinishedRunOfAChangedStartIsRefused) {
  const auto put_beads = [&](double x) {
    std::ofstream(folder_ / "beads.csv") << "x,z\n0.6,0.6\n" << x << ",0.6\n";
  };
  put_beads(3);
  std::ofstream(scene_)
      << "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 8.0\n[drive]\ngamma = 2.0\n[start]\n"
         "kind = \"table\"\nfrom = \"beads.csv\"\n[time]\nsteps_per_contact = 10\ncycles = 1\n"
         "discard = 0\n";
  ASSERT_EQ(run_program(words({})).code, kDone);
  EXPECT_EQ(run_program(words({"--resume"})).code, kDone);
  put_beads(5);
  expect_refusal({"--resume"}, kUsage, {"start.from", "beads.csv has changed since", "o.h5 was written"});
  put_beads(3);
  EXPECT_EQ(run_program(words({"--resume"})).code, kDone);
}

TEST_F(Checkpoints, WhatAnotherVersionWroteIsRefused) {
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  {
    const h5::Handle file(H5Fopen((place_ / "state.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
    const h5::Handle version(H5Aopen(file.get(), "checkpoint_version", H5P_DEFAULT));
    const int other = 99;
    ASSERT_GE(H5Awrite(version.get(), H5T_NATIVE_INT, &other), 0);
  }
  expect_refusal({"--resume"}, kInput, {"state.h5", "checkpoint_version", "99"});
}

// Flipped bits, truncated files, a missing segment: the run is refused with the name of the file, and never
// continues from damaged data.
TEST_F(Checkpoints, DamageIsFound) {
  const auto whole = uninterrupted();
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  const fs::path kept = folder_ / "kept";
  fs::copy(place_, kept, fs::copy_options::recursive);
  const auto restore = [&] {
    fs::remove_all(place_);
    fs::copy(kept, place_, fs::copy_options::recursive);
    fs::remove(output_);
  };
  std::mt19937 random(1);
  int refused = 0;
  for (int k = 0; k < 24; ++k) {
    const fs::path file = place_ / (k % 3 == 0 ? "segment-0001.h5" : "state.h5");
    const auto size = fs::file_size(file);
    if (k % 4 == 3) {
      fs::resize_file(file, random() % size);
    } else {
      std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
      const auto at = static_cast<std::streamoff>(random() % size);
      stream.seekg(at);
      const char flipped = static_cast<char>(stream.get() ^ (1 << random() % 8));
      stream.seekp(at);
      stream.put(flipped);
    }
    const Ran ran = run_program(words({"--resume"}));
    if (ran.code == kDone) {  // the flipped byte is unused
      EXPECT_EQ(datasets_of(output_), whole);
    } else {
      ++refused;
      EXPECT_EQ(ran.code, kInput) << ran.err;
      EXPECT_NE(ran.err.find(file.filename()), std::string::npos) << ran.err;
    }
    restore();
  }
  EXPECT_GE(refused, 14);  // at least all segments and all truncated files
  fs::remove(place_ / "segment-0001.h5");
  expect_refusal({"--resume"}, kInput, {"segment-0001.h5", "missing"});
}

TEST_F(Checkpoints, AUsersFileNamedLikeASegmentStays) {
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  fs::copy_file(place_ / "segment-0001.h5", place_ / "segment-0099.h5");
  const Ran rest = run_program(words({"--resume"}));
  EXPECT_EQ(rest.code, kDone) << rest.err;
  EXPECT_EQ(names_in(place_), std::vector<std::string>{"segment-0099.h5"});
}

// A run removes its checkpoints, so it must not take a folder of others for its own.
TEST_F(Checkpoints, FilesOfOthersAreNeitherReplacedNorRemoved) {
  const fs::path data = folder_ / "data";
  const auto expect_kept = [&](const fs::path& file, const std::vector<std::string>& mentioned) {
    const auto before = names_in(file.parent_path());
    for (const auto& more : {std::vector<std::string>{"--checkpoint-every", "0"}, {"--resume"}}) {
      expect_refusal(more, kUsage, mentioned);
      EXPECT_EQ(names_in(file.parent_path()), before);
      EXPECT_FALSE(fs::exists(output_));
    }
  };
  fs::create_directory(data);
  std::ofstream(data / "segment-0001.h5") << "mine";
  fs::create_directory_symlink(data, place_);
  expect_kept(data / "segment-0001.h5", {"o.h5.checkpoint", "is a link"});
  EXPECT_TRUE(fs::is_symlink(place_));
  fs::remove(place_);
  fs::rename(data, place_);
  expect_kept(place_ / "segment-0001.h5", {"'segment-0001.h5'", "does not contain frames of this run"});
  fs::rename(place_ / "segment-0001.h5", place_ / "notes.txt");
  expect_kept(place_ / "notes.txt", {"'notes.txt'", "was not written by this program"});
  // A trajectory of another run.
  fs::remove(place_ / "notes.txt");
  const std::string other = place_ / "segment-0001.h5";
  ASSERT_EQ(run_program({"simulate", scene_, "-o", other, "-q", "--set", "drive.gamma=1.5"}).code, kDone);
  expect_kept(other, {"'segment-0001.h5'", "does not contain frames of this run"});
}

TEST_F(Checkpoints, AFileOfOthersIsNotTakenForTheNextSegment) {
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  const std::size_t segments = sim::read_checkpoint(place_ / "state.h5").segments.size();
  const fs::path mine = place_ / fmt::format("segment-{:04}.h5", segments + 1);
  std::ofstream(mine) << "mine";
  expect_refusal({"--resume"}, kUsage, {mine.filename(), "does not contain frames of this run"});
  EXPECT_TRUE(fs::exists(mine) && fs::exists(place_ / "state.h5"));
}

// A run that was killed between its first segment and its first state leaves nothing but the segment.
TEST_F(Checkpoints, SegmentsWithoutAStateAreThoseOfAKilledRun) {
  const auto whole = uninterrupted();
  for (const auto& more : {std::vector<std::string>{"--checkpoint-every", "0"}, {"--resume"}}) {
    ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
    fs::remove(place_ / "state.h5");
    const Ran ran = run_program(words(more));
    EXPECT_EQ(ran.code, kDone) << ran.err;
    EXPECT_EQ(datasets_of(output_), whole);
    EXPECT_FALSE(fs::exists(place_));
    fs::remove(output_);
  }
}

TEST_F(Checkpoints, AnotherProgramsRunIsNotResumed) {
  ASSERT_EQ(stopped_in_the_middle(SIGINT).code, 130);
  const fs::path state = place_ / "state.h5";
  sim::Checkpoint checkpoint = sim::read_checkpoint(state);
  const std::string own = checkpoint.program;
  EXPECT_EQ(own, version_line());
  checkpoint.program = "twincell 0.0.1";
  sim::write_checkpoint(state, checkpoint);
  expect_refusal({"--resume"}, kUsage,
                 {"o.h5.checkpoint", "written by twincell 0.0.1", "this is " + own, "remove"});
  EXPECT_FALSE(fs::exists(output_));
  // The refusal leaves the checkpoint unchanged.
  checkpoint.program = own;
  sim::write_checkpoint(state, checkpoint);
  const Ran rest = run_program(words({"--resume"}));
  EXPECT_EQ(rest.code, kDone) << rest.err;
  EXPECT_EQ(datasets_of(output_), uninterrupted());
}

TEST_F(Checkpoints, AFullDiskStopsTheRunWhichGoesOnWhenThereIsRoom) {
  const auto whole = uninterrupted();
  // A limit on the size of files represents the full disk; the program inherits it.
  struct rlimit usual {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &usual), 0);
  const auto under_limit = [&](rlim_t bytes, const std::vector<std::string>& more) {
    const rlimit limit{bytes, usual.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const Ran ran = run_program(words(more));
    ::setrlimit(RLIMIT_FSIZE, &usual);
    return ran;
  };
  const Ran none = under_limit(4096, {"--checkpoint-every", "1e-9"});
  EXPECT_EQ(none.code, 1) << none.err;
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
  EXPECT_EQ(names_in(folder_.path()), std::vector<std::string>{"scene.toml"});
  // Room for each checkpoint, but not for all frames in one file.
  const Ran late = under_limit(150'000, {"--checkpoint-every", "0.02"});
  EXPECT_EQ(late.code, kPartial) << late.err;
  EXPECT_NE(late.err.find("--resume"), std::string::npos) << late.err;
  EXPECT_FALSE(fs::exists(output_));
  EXPECT_EQ(run_program(words({"--resume"})).code, kDone);
  EXPECT_EQ(datasets_of(output_), whole);
}

TEST_F(Checkpoints, AFolderThatCannotBeIsRefusedAtOnce) {
  std::ofstream(place_) << "a file";
  expect_refusal({"--checkpoint-every", "1"}, kUsage, {"o.h5.checkpoint", "cannot be created"});
  fs::remove(place_);
  RunningProgram first(words({"--checkpoint-every", "0.02"}));
  EXPECT_TRUE(first.wait_until(folder_.path(), [&] { return fs::exists(place_ / "state.h5"); }));
  expect_refusal({"--resume"}, kUsage, {"another process"});
  first.signal(SIGKILL);
  static_cast<void>(first.wait());
}

}  // namespace
}  // namespace twincell::checkpoint_test
