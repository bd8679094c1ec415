// One solver that is called for a few steps at a time: its lists go on from call to call, and end where the
// caller changes something.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "sim/start/start.hpp"

namespace twincell::sim::short_calls_test {
namespace {

const std::string kPaperOne =
    "[cell]\nwidth = 8.0\n[contact]\nk_n = 1e5\ngamma_n = 10.0\ngamma_t = 10.0\nk_t = 2e3\n";
const std::string kPeriodic =
    "[cell]\nwidth = 8.0\nsides = \"periodic\"\n[contact]\nk_n = 1e5\nrestitution = 0.9\ntangential = "
    "\"dashpot\"\nc_t_over_c_n = 1.0\nmu = 0.4\n";
const std::string kSpace =
    "[cell]\ndimension = 3\nwidth = 3.0\ndepth = 3.0\n[contact]\nk_n = 1e5\ngamma_n = 10.0\ngamma_t = 10.0\n"
    "k_t = 2e3\n";
const std::string kSplit = "[time]\nsteps_per_contact = 10\nintegrator = \"split\"\n";
/// Few contacts: most beads are inactive, and the active set is found anew in some calls only.
const std::string kDilute = "[cell]\nwidth = 60.0\n[contact]\nk_n = 1e5\n";

constexpr std::int64_t kSteps = 2400;

struct Outcome {
  System system;
  std::vector<ContactMemory> contacts;
  std::int64_t inner_lists = 0;
};

using Change = std::function<void(System&)>;
enum class Lists { go_on, begin_in_each_call };

/// A shaken random bed after kSteps in calls of the lengths, in turn. \param change acts after every 50th
/// call
Outcome shaken(const std::string& laws, SolverKind kind, int threads,
               const std::vector<std::int64_t>& lengths, const Change& change = nullptr,
               Lists lists = Lists::go_on) {
  const Scene scene = read_scene_text(
      "[beads]\ncount = 60\n[drive]\nomega = 1.0\ngamma = 3.0\n[start]\nkind = \"random\"\nseed = 5\n" + laws,
      "shaken");
  const Plan plan = make_plan(scene);
  Outcome out{.system = make_system(scene, plan)};
  System& s = out.system;
  s.beads = make_start(scene).beads;
  for (Bead& b : s.beads) b.vz -= 2, b.vx *= 2, b.spin = b.vx;
  const auto solver = make_solver(plan, {}, kind, threads);
  if (lists == Lists::begin_in_each_call) solver->rebuild_every(std::int64_t{1} << 40);
  std::int64_t done = 0;
  for (std::size_t call = 0; done < kSteps; ++call) {
    const std::int64_t steps = std::min(lengths[call % lengths.size()], kSteps - done);
    solver->advance(s, steps);
    done += steps;
    if (change && call % 50 == 49) change(s);
  }
  out.contacts = solver->contacts();
  out.inner_lists = solver->counters().near_refreshes;
  return out;
}

void expect_same_bits(const Outcome& a, const Outcome& b, const std::string& what) {
  ASSERT_EQ(a.system.beads.size(), b.system.beads.size());
  EXPECT_EQ(0,
            std::memcmp(a.system.beads.data(), b.system.beads.data(), a.system.beads.size() * sizeof(Bead)))
      << what;
  ASSERT_EQ(a.contacts.size(), b.contacts.size()) << what;
  for (std::size_t k = 0; k < a.contacts.size(); ++k)
    EXPECT_EQ(a.contacts[k].values, b.contacts[k].values) << what;
}

TEST(ShortCalls, HaveTheBitsAndTheListsOfOneCall) {
  const std::vector<std::int64_t> whole = {kSteps}, one = {1}, mixed = {1, 7, 2, 3, 64, 1, 1, 5};
  for (const auto& laws : {kPaperOne, kPeriodic, kPaperOne + kSplit, kSpace + kSplit, kDilute + kSplit}) {
    const Outcome oracle = shaken(laws, SolverKind::all_pairs, 1, whole);
    for (const int threads : {1, 2}) {
      const Outcome uncut = shaken(laws, SolverKind::best, threads, whole);
      for (const auto& lengths : {one, mixed}) {
        const Outcome cut = shaken(laws, SolverKind::best, threads, lengths);
        expect_same_bits(cut, oracle, laws);
        EXPECT_LE(cut.inner_lists, 1.2 * static_cast<double>(uncut.inner_lists) + 5) << laws << threads;
      }
    }
  }
}

TEST(ShortCalls, EndTheListsWhereTheCallerChangesSomething) {
  const std::vector<std::int64_t> lengths = {3, 1, 4, 2};
  // Each change brings beads into contact that free flight would have kept apart.
  const std::pair<const char*, Change> changes[] = {
      {"a bead is thrown", [](System& s) { s.beads[7].vx += 5, s.beads[7].vz -= 5; }},
      {"beads are raised",
       [](System& s) {
         for (std::size_t k = 0; k < 20; ++k) s.beads[k].z += 0.01;
       }},
      {"a wall moves", [](System& s) { s.walls.back().offset += 0.05; }},
      {"gravity turns", [](System& s) { s.gravity.x() = s.gravity.x() > 0 ? -20 : 20; }},
      {"the drive jumps", [](System& s) { s.step += 40; }},
      {"friction of the plates", [](System& s) { s.plate_drag = 1 - s.plate_drag; }},
  };
  for (const auto& [what, change] : changes)
    for (const int threads : {1, 2})
      expect_same_bits(shaken(kPaperOne, SolverKind::best, threads, lengths, change),
                       shaken(kPaperOne, SolverKind::best, 1, lengths, change, Lists::begin_in_each_call),
                       what);
}

}  // namespace
}  // namespace twincell::sim::short_calls_test
