// For every combination of laws, dimension, integrator, sizes and boundaries, all solvers give the same bits.
// The result also does not depend on when neighbour lists are rebuilt, how threads share the work, how beads
// are numbered, or how a run is divided into calls.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "sim/run/make_solver.hpp"
#include "sim/start/start.hpp"

namespace twincell::sim {
namespace {

struct Laws {
  std::string normal, tangential, rolling;
};
std::vector<Laws> all_laws() {
  std::vector<Laws> all;
  for (const auto& normal : normal_words())
    for (const auto& tangential : tangential_words())
      for (const auto& rolling : rolling_words())
        if (tangential != "none" || rolling == "none") all.push_back({normal, tangential, rolling});
  return all;
}

struct Case {
  int dimension;
  std::string integrator;
  bool unequal;  ///< distributed radii, and an intruder
  bool periodic;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.dimension << "D " << c.integrator << (c.unequal ? " unequal" : " equal")
       << (c.periodic ? " periodic" : " walls");
}

/// A small bed, dense and fast enough that contacts begin, slide, stick, roll and end from the first steps
/// on.
Scene scene_of(const Case& c, const Laws& laws) {
  std::string text = "[cell]\ndimension = " + std::to_string(c.dimension);
  text += c.dimension == 2 ? "\nwidth = 5.0\n" : "\nwidth = 3.8\ndepth = 3.8\n";
  if (c.periodic) text += "sides = \"periodic\"\n";
  if (c.periodic && c.dimension == 3) text += "plates = \"periodic\"\n";
  text += "[beads]\ncount = 20\n";
  if (c.unequal)
    text += "spread = \"uniform\"\nspread_width = 0.2\n[beads.intruder]\nradius = 0.83\nz = 2.5\n";
  text += "[drive]\nomega = 7.0\ngamma = 4.0\n[time]\nsteps_per_contact = 12\nintegrator = \"" +
          c.integrator + "\"\n";
  text += "[contact]\nnormal = \"" + laws.normal + "\"\ntangential = \"" + laws.tangential +
          "\"\nrolling = \"" + laws.rolling + "\"\n";
  // One value for every key that a law may read. Where several keys set the same quantity, only the one
  // listed here is used.
  const std::map<std::string, double> values = {{"k_n", 1e4},
                                                {"restitution", 0.8},
                                                {"restitution_fast", 0.6},
                                                {"youngs_modulus", 3e4},
                                                {"viscous_time", 1e-3},
                                                {"pull_off_force", 3},
                                                {"mu", 0.4},
                                                {"k_t", 3e3},
                                                {"k_r", 50},
                                                {"c_r", 0.05},
                                                {"mu_r", 0.2}};
  const std::vector<std::string> keys = keys_of(laws.normal, laws.tangential, laws.rolling);
  const auto reads = [&](const char* key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
  const std::set<std::string> once(keys.begin(), keys.end());
  for (const std::string& key : once)
    if (const auto value = values.find(key); value != values.end())
      text += key + " = " + std::to_string(value->second) + "\n";
  if (reads("c_t")) text += reads("restitution") ? "c_t_over_c_n = 0.5\n" : "c_t = 5.0\n";
  const bool rough = laws.tangential != "none";
  if (rough) text += "[contact.wall]\nmu = 0.7\n";
  return read_scene_text(text, "bed");
}

System bed_of(const Scene& scene, const Plan& plan) {
  System s = make_system(scene, plan);
  s.beads = make_start(scene).beads;
  std::mt19937_64 engine(11);
  const auto random = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  for (Bead& b : s.beads) {
    b.vx = 2 * random(), b.vz = 2 * random(), b.spin = 4 * random();
    if (s.dimension == 3) b.vy = 2 * random(), b.spin_x = 4 * random(), b.spin_z = 4 * random();
  }
  return s;
}

/// Final state of a run.
struct Outcome {
  System system;
  std::vector<ContactMemory> contacts;
};
struct Habits {
  SolverKind kind = SolverKind::scalar;
  int threads = 1;
  std::int64_t rebuild_every = 0;
  std::int64_t piece = 1 << 30;  ///< steps per call
};
Outcome run(const Plan& plan, System s, std::int64_t steps, const Habits& habits) {
  const auto kernel = make_solver(plan, {.overlap = 0.3, .travel_per_step = 1}, habits.kind, habits.threads);
  kernel->rebuild_every(habits.rebuild_every);
  for (std::int64_t done = 0; done < steps; done += habits.piece)
    kernel->advance(s, std::min(habits.piece, steps - done));
  return {std::move(s), kernel->contacts()};
}

bool same_bits(const Outcome& a, const Outcome& b) {
  const auto same = [](const auto& u, const auto& v) {
    return u.size() == v.size() && std::memcmp(u.data(), v.data(), u.size() * sizeof(u[0])) == 0;
  };
  if (!same(a.system.beads, b.system.beads) || a.contacts.size() != b.contacts.size()) return false;
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    const ContactMemory &p = a.contacts[k], &q = b.contacts[k];
    const std::size_t kept = std::min(p.values.size(), q.values.size());  // the oracle stores trailing zeros
    if (p.i != q.i || p.j != q.j || std::memcmp(p.values.data(), q.values.data(), kept * sizeof(double)) != 0)
      return false;
  }
  return true;
}

class Kernels : public testing::TestWithParam<Case> {
 protected:
  /// Calls check(plan, start, reference, name) for each combination of laws. The reference is the result of
  /// the scalar solver.
  template <class Check>
  void for_each_law(std::int64_t steps, Check check) {
    for (const Laws& laws : all_laws()) {
      const Scene scene = scene_of(GetParam(), laws);
      const Plan plan = make_plan(scene);
      const System start = bed_of(scene, plan);
      const Outcome reference = run(plan, start, steps, {});
      const std::string name = laws.normal + ", " + laws.tangential + ", " + laws.rolling;
      check(plan, start, reference, name);
    }
  }
};

TEST_P(Kernels, GiveTheSameBits) {
  constexpr std::int64_t kSteps = 700;
  for_each_law(kSteps,
               [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
                 for (const SolverKind kind : {SolverKind::avx2, SolverKind::avx512, SolverKind::all_pairs})
                   if (available(kind)) {
                     EXPECT_TRUE(same_bits(reference, run(plan, start, kSteps, {.kind = kind})))
                         << make_solver(plan, {}, kind)->description() << ": " << name;
                   }
               });
  for (const auto& [kind, word] : {std::pair{SolverKind::avx2, "AVX2"}, {SolverKind::avx512, "AVX-512"}})
    if (!available(kind)) std::printf("not compared: this processor has no %s\n", word);
}

TEST_P(Kernels, HabitsDoNotShow) {
  constexpr std::int64_t kSteps = 300;
  for_each_law(
      kSteps, [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
        const auto same = [&](const Habits& habits) {
          return same_bits(reference, run(plan, start, kSteps, habits));
        };
        EXPECT_TRUE(same({.kind = SolverKind::scalar, .rebuild_every = 1}))
            << name << ": lists built at every step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .rebuild_every = 1}))
            << name << ": lists built at every step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .rebuild_every = 7}))
            << name << ": lists built at every 7th step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .piece = 1})) << name << ": a call for every step";
        EXPECT_TRUE(same({.kind = SolverKind::best, .piece = 37})) << name << ": in pieces of 37 steps";
      });
}

// H24, H25: a stored vector changes sign when i and j are exchanged
TEST_P(Kernels, NumbersOfBeadsDoNotShow) {
  constexpr std::int64_t kSteps = 300;
  for_each_law(kSteps,
               [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
                 std::vector<std::size_t> order(start.beads.size());
                 std::iota(order.begin(), order.end(), std::size_t{0});
                 std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
                 System shuffled = start;
                 for (std::size_t k = 0; k < order.size(); ++k) shuffled.beads[k] = start.beads[order[k]];
                 const Outcome outcome = run(plan, shuffled, kSteps, {.kind = SolverKind::best});
                 System back = outcome.system;
                 for (std::size_t k = 0; k < order.size(); ++k)
                   back.beads[order[k]] = outcome.system.beads[k];
                 EXPECT_TRUE(same_bits({back, reference.contacts}, reference)) << name;
               });
}

TEST_P(Kernels, ThreadsDoNotShow) {  // H26
  constexpr std::int64_t kSteps = 40;
  for_each_law(
      kSteps, [&](const Plan& plan, const System& start, const Outcome& reference, const std::string& name) {
        for (const int threads : {2, 3})
          EXPECT_TRUE(
              same_bits(reference, run(plan, start, kSteps, {.kind = SolverKind::best, .threads = threads})))
              << name << ": " << threads << " threads";
      });
}

INSTANTIATE_TEST_SUITE_P(All, Kernels, testing::ValuesIn([] {
                           std::vector<Case> all;
                           for (const int dimension : {2, 3})
                             for (const char* integrator : {"verlet", "predicted", "split"})
                               for (const bool unequal : {false, true})
                                 for (const bool periodic : {false, true})
                                   all.push_back({dimension, integrator, unequal, periodic});
                           return all;
                         }()),
                         [](const auto& of) {
                           const Case& c = of.param;
                           return std::string(c.dimension == 2 ? "Plane" : "Space") + "_" + c.integrator +
                                  "_" + (c.unequal ? "unequal" : "equal") + "_" +
                                  (c.periodic ? "periodic" : "walls");
                         });

}  // namespace
}  // namespace twincell::sim
