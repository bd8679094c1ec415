// `sweep run --device`: the same results as without it, and one sentence where there is no device. The
// graphics card is a stand-in that is the processor (tests/support/fake_cuda_driver.cpp).

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/support/file_bytes.hpp"
#include "tests/support/program.hpp"

namespace twincell::device_test {
namespace {

constexpr int kDone = 0, kFailed = 1, kUsage = 2;

class SweepOnDevice : public ::testing::Test {
 protected:
  SweepOnDevice() { write_plan("spring", "beads.layers = [2, 3]\nseeds = 2\n"); }
  ~SweepOnDevice() override {
    ::unsetenv("LD_LIBRARY_PATH");
    ::unsetenv("FAKE_CUDA");
  }
  void write_plan(const std::string& tangential, const std::string& axes) const {
    std::ofstream(plan_)
        << "seed = 3\nresults = [\"s_b\", \"s_c\"]\n[scene]\npreset = \"fortini-huang-2015\"\n"
           "cell.width = 6.0\nstart.kind = \"random\"\ndrive.gamma = 1.6\ntime = { discard = 1, "
           "cycles = 3, phases = 10, steps_per_contact = 6.37 }\ncontact.tangential = \""
        << tangential << "\"\n[axes]\n"
        << axes;
  }
  /// With the stand-in for the driver.
  static void use_fake_card(const char* fault = "") {
    ::setenv("LD_LIBRARY_PATH", TWINCELL_FAKE_CUDA, 1);
    ::setenv("FAKE_CUDA", fault, 1);
  }
  [[nodiscard]] Ran run(const std::string& into, const std::vector<std::string>& more) const {
    std::vector<std::string> words{"sweep", "run", plan_, "--folder", folder_ / into};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  /// What `collect` writes.
  [[nodiscard]] std::string collected(const std::string& from) const {
    const std::string out = folder_ / (from + ".json");
    const Ran ran = run_program({"sweep", "collect", plan_, "--folder", folder_ / from, "-o", out, "-q"});
    EXPECT_EQ(ran.code, kDone) << ran.err;
    return bytes_of(out);
  }
  static bool has_device_code(const Ran& refused) {
    return refused.err.find("when it was built") == std::string::npos;
  }

  TemporaryFolder folder_;
  std::string plan_ = folder_ / "plan.toml";
};

TEST_F(SweepOnDevice, GivesTheSameBytes) {
  ASSERT_EQ(run("ordinary", {"-q"}).code, kDone);
  const std::string ordinary = collected("ordinary");
  EXPECT_NE(ordinary.find("\"s_b\""), std::string::npos);
  const Ran host = run("host", {"--device", "host", "-q"});
  ASSERT_EQ(host.code, kDone) << host.err;
  EXPECT_EQ(collected("host"), ordinary);
  use_fake_card();
  const Ran gpu = run("gpu", {"--device", "gpu"});
  if (!has_device_code(gpu)) GTEST_SKIP() << gpu.err;
  ASSERT_EQ(gpu.code, kDone) << gpu.err;
  EXPECT_NE(gpu.err.find("a card that is the processor."), std::string::npos) << gpu.err;
  EXPECT_EQ(collected("gpu"), ordinary);
}

TEST_F(SweepOnDevice, WithoutACardIsRefused) {
  if (::dlopen("libcuda.so.1", RTLD_NOW) != nullptr) GTEST_SKIP() << "this machine has a driver";
  const Ran ran = run("none", {"--device", "gpu"});
  EXPECT_EQ(ran.code, kUsage);
  EXPECT_NE(ran.err.find("--device: gpu "), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("run without --device."), std::string::npos) << ran.err;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
}

TEST_F(SweepOnDevice, FiguresSayWhichOfThemCanUseIt) {
  const std::string out = folder_ / "figure";
  Ran ran = run_program({"reproduce", "p2-fig2", "--device", "host", "-o", out});
  EXPECT_EQ(ran.code, kUsage);
  EXPECT_NE(ran.err.find("--device: has no effect on p2-fig2; the beds of p1-fig3, p1-fig4"),
            std::string::npos)
      << ran.err;
  use_fake_card("none");
  ran = run_program({"reproduce", "p1-fig5", "--device", "gpu", "-o", out});
  EXPECT_EQ(ran.code, kUsage);
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(SweepOnDevice, FaultsOfACardAreNoResults) {
  use_fake_card("none");
  Ran ran = run("faulty", {"--device", "gpu"});
  if (!has_device_code(ran)) GTEST_SKIP() << ran.err;
  EXPECT_EQ(ran.code, kUsage);
  EXPECT_NE(ran.err.find("the driver finds none"), std::string::npos) << ran.err;
  use_fake_card("memory");
  ran = run("faulty", {"--device", "gpu"});
  EXPECT_EQ(ran.code, kFailed);
  EXPECT_NE(ran.err.find("(error 2, out of memory)"), std::string::npos) << ran.err;
  use_fake_card("launch");
  ran = run("faulty", {"--device", "gpu"});
  EXPECT_EQ(ran.code, kFailed);
  EXPECT_NE(ran.err.find("failed in linear_spring_2d_full (error 719"), std::string::npos) << ran.err;
  // No point has a failure as its result: without the fault the sweep is complete.
  use_fake_card();
  ran = run("faulty", {"--device", "gpu", "--json"});
  EXPECT_EQ(ran.code, kDone) << ran.err;
  EXPECT_NE(ran.out.find("\"failed\": 0"), std::string::npos) << ran.out;
}

TEST_F(SweepOnDevice, WhatItCannotRunIsRefusedByName) {
  write_plan("force-clipped", "beads.layers = [2]\n");
  Ran ran = run("laws", {"--device", "host"});
  EXPECT_EQ(ran.code, kUsage);
  EXPECT_NE(ran.err.find("--device has no kernel for 2D"), std::string::npos) << ran.err;
  write_plan("spring", "beads.layers = [2]\ntime.stepping = [\"event-driven\"]\n");
  ran = run("events", {"--device", "host"});
  EXPECT_EQ(ran.code, kUsage);
  EXPECT_NE(ran.err.find("time.stepping"), std::string::npos) << ran.err;
  EXPECT_EQ(run("mpi", {"--device", "host", "--mpi"}).code, kUsage);
}

}  // namespace
}  // namespace twincell::device_test
