// The frames of a LAMMPS deck are those of `simulate`: the same phases of the same cycles.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "sim/lammps/export_lammps.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::sim::lammps_deck_test {
namespace {

const std::string kScene =
    "[cell]\nwidth = 6.0\n[beads]\ncount = 3\n[contact]\nk_n = 1e4\ngamma_n = 60\nk_t = 3e3\ngamma_t = "
    "30\nmu = "
    "0.4\n[drive]\nk_m = 2.0\nomega = 2.0\n[start]\nsettle_limit = 0\n[time]\nintegrator = \"verlet\"\n"
    "steps_per_contact = 20\ndiscard = 0\ncycles = 1\nphases = 40\n";

/// Number after the words with which a line of the deck begins.
std::int64_t number_after(const std::string& input, const std::string& words, std::size_t match = 0) {
  std::size_t at = input.find(words);
  for (std::size_t k = 0; k < match; ++k) at = input.find(words, at + 1);
  return at == std::string::npos ? -1 : std::stoll(input.substr(at + words.size()));
}

/// Steps at which LAMMPS writes frames: multiples of the interval from the delay on, within the run.
std::vector<std::int64_t> steps_of(const LammpsDeck& deck) {
  const std::int64_t every = number_after(deck.input, "dump            frames all custom "),
                     delay = number_after(deck.input, "dump_modify     frames delay "),
                     first = number_after(deck.input, "\nreset_timestep ", 1),
                     run = number_after(deck.input, "\nrun             ");
  std::vector<std::int64_t> steps;
  for (std::int64_t k = first; k <= first + run; ++k)
    if (k % every == 0 && k >= delay) steps.push_back(k);
  return steps;
}

MemoryTrajectory simulated(const Scene& scene) {
  Simulation run(scene);
  MemoryTrajectory frames(run.trajectory_info());
  run.run(frames);
  return frames;
}

std::vector<std::int64_t> steps_of(const MemoryTrajectory& t) {
  std::vector<std::int64_t> steps;
  for (const Frame& frame : t.frames()) steps.push_back(frame.step);
  return steps;
}

TEST(LammpsDeck, HasTheFramesOfSimulateAtEveryPhaseOfTheStart) {
  const std::map<std::string, std::size_t> frames = {{"0", 40}, {"0.4", 24}, {"0.975", 1}};
  for (const auto& [phase, n] : frames)
    for (const std::string discard : {"0", "1"}) {
      const Scene scene = read_scene_text(kScene, "s", {"drive.phase=" + phase, "time.discard=" + discard});
      const std::vector<std::int64_t> ours = steps_of(simulated(scene));
      EXPECT_EQ(ours.size(), discard == "0" ? n : 40);
      EXPECT_EQ(steps_of(lammps_deck(scene)), ours) << "phase " << phase << ", discard " << discard;
    }
}

TEST(LammpsDeck, FromAFrameEndsWithTheCyclesOfTheScene) {
  const MemoryTrajectory t = simulated(read_scene_text(kScene, "s"));
  for (const int frame : {0, 16, 39}) {
    const LammpsDeck deck =
        lammps_deck(read_scene_text(kScene, "s", {"time.cycles=2"}), t, static_cast<std::size_t>(frame));
    const std::vector<std::int64_t> steps = steps_of(deck);
    ASSERT_EQ(steps.size(), static_cast<std::size_t>(80 - frame));
    EXPECT_EQ(steps.front(), t.frames().at(static_cast<std::size_t>(frame)).step);
  }
}

}  // namespace
}  // namespace twincell::sim::lammps_deck_test
