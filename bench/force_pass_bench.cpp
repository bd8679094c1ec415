// The list kernel with the widest vectors and with AVX2, compared with the all-pairs reference on the same
// driven bed, in one run. Items are particle-steps.

#include <benchmark/benchmark.h>

#include <string>

#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/start/start.hpp"

namespace twincell::sim {
namespace {

/// Force pass on a crystal of the first paper's beads that rides on the plate at Gamma = 1.5.
void force_pass(benchmark::State& state, SolverKind kind) {
  if (!available(kind)) return state.SkipWithError("this processor cannot");
  const auto n = state.range(0);
  const Scene scene = read_scene_text(
      "preset = \"fortini-huang-2015\"\n[beads]\ncount = " + std::to_string(n) + "\n[drive]\ngamma = 1.5\n",
      "bench", {"time.integrator=verlet"});
  const Plan plan = make_plan(scene);
  System s = make_system(scene, plan);
  s.beads = make_start(scene).beads;
  for (Bead& b : s.beads) b.vz = scene.drive.peak_velocity();
  const auto kernel = make_solver(plan, {}, kind);
  constexpr std::int64_t kSteps = 500;
  for (auto _ : state) kernel->advance(s, kSteps);
  state.SetItemsProcessed(state.iterations() * kSteps * n);
  state.counters["list_builds"] = static_cast<double>(kernel->list_builds());
}

BENCHMARK_CAPTURE(force_pass, list, SolverKind::best)->Arg(40)->Arg(200)->Arg(800);
BENCHMARK_CAPTURE(force_pass, avx2, SolverKind::avx2)->Arg(800);
BENCHMARK_CAPTURE(force_pass, all_pairs, SolverKind::all_pairs)->Arg(40)->Arg(200)->Arg(800);

}  // namespace
}  // namespace twincell::sim

BENCHMARK_MAIN();
