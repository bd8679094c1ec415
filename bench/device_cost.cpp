// Many equal beds on a device, and one of them on a core of the same machine.
//
// usage: device_cost gpu|host LAYERS BEDS PERIODS SAMPLES
//
// The bed is that of Fortini & Huang 2015 at Gamma = 2, after two periods, with split steps. Each bed has
// a thread, which advances it by PERIODS periods of the drive, in 20 calls a period with SAMPLES samples
// a period in between, as a run does. SAMPLES is a multiple of 20. Prints one line: particle-steps per second
// of all beds together and of one bed on one core, their ratio, and whether each bed has the bits of the one
// on the core.

#include <fmt/format.h>

#include <barrier>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "core/error.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "sim/scene/starts.hpp"
#include "sim/start/start.hpp"
#include "sim/system/system.hpp"

namespace {

using namespace twincell;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

constexpr std::int64_t kFrames = 20;   ///< a period
constexpr std::int64_t kBefore = 100;  ///< steps that are not timed: beds are transferred, kernels compiled
constexpr sim::GuardLimits kLimits{.overlap = 0.3, .travel_per_step = 1};

struct Work {
  std::int64_t steps_per_period, periods, samples;

  void of(sim::Solver& solver, sim::System& s) const {
    std::vector<std::int64_t> pieces;
    for (std::int64_t k = 1; k <= periods * samples; ++k) {
      pieces.push_back(k * steps_per_period / samples - (k - 1) * steps_per_period / samples);
      if (k % (samples / kFrames) != 0) continue;
      solver.advance_in_pieces(s, pieces, [] {});
      pieces.clear();
    }
  }
  [[nodiscard]] double steps() const { return static_cast<double>(steps_per_period * periods); }
};

bool same_bits(const sim::System& a, const sim::System& b) {
  if (a.beads.size() != b.beads.size()) return false;
  for (std::size_t k = 0; k < a.beads.size(); ++k)
    if (a.beads[k].x != b.beads[k].x || a.beads[k].z != b.beads[k].z || a.beads[k].vx != b.beads[k].vx ||
        a.beads[k].vz != b.beads[k].vz)
      return false;
  return true;
}

void run(const std::string& device, int layers, std::size_t beds, const Work& asked) {
  const sim::Scene scene = sim::read_scene_text(
      fmt::format(
          "preset = \"fortini-huang-2015\"\n[beads]\nlayers = {}\n[drive]\ngamma = 2.0\n[start]\nkind = "
          "\"random\"\n[time]\nintegrator = \"split\"\nsteps_per_contact = 6.37\n",
          layers),
      "bed");
  const sim::Plan plan = sim::make_plan(scene);
  Work work = asked;
  work.steps_per_period = plan.steps_per_period;
  sim::System start = sim::make_system(scene, plan);
  start.beads = sim::make_start(scene).beads;
  const auto solver = sim::make_solver(plan, kLimits);
  solver->advance(start, 2 * plan.steps_per_period);
  const auto memory = solver->contacts();

  sim::System of_core = start;
  solver->advance(of_core, kBefore);
  const Clock::time_point core_begin = Clock::now();
  work.of(*solver, of_core);
  const double core_seconds = seconds_since(core_begin);

  const sim::SolverKind kind = device == "gpu" ? sim::SolverKind::gpu : sim::SolverKind::device_on_host;
  std::vector<sim::System> of_beds(beds, start);
  std::vector<std::int64_t> builds(beds);
  std::vector<std::exception_ptr> errors(beds);
  std::barrier together(static_cast<std::ptrdiff_t>(beds) + 1);
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < beds; ++k)
    threads.emplace_back([&, k] {
      std::unique_ptr<sim::Solver> own;
      try {
        own = sim::make_solver(plan, kLimits, kind);
        own->restore(memory);
        own->advance(of_beds[k], kBefore);
      } catch (...) {
        errors[k] = std::current_exception();
      }
      together.arrive_and_wait();
      try {
        if (!errors[k]) work.of(*own, of_beds[k]);
        if (!errors[k]) builds[k] = own->list_builds();
      } catch (...) {
        errors[k] = std::current_exception();
      }
      together.arrive_and_wait();
    });
  together.arrive_and_wait();
  const Clock::time_point begin = Clock::now();
  together.arrive_and_wait();
  const double seconds = seconds_since(begin);
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);

  const double beads = static_cast<double>(start.beads.size());
  const double core_rate = beads * work.steps() / core_seconds,
               rate = beads * work.steps() * static_cast<double>(beds) / seconds;
  std::size_t same = 0;
  for (const sim::System& s : of_beds) same += same_bits(s, of_core) ? 1 : 0;
  std::string name = device == "gpu" ? sim::graphics_card() : "device kernel on the processor";
  std::puts(
      fmt::format("{{\"device\": \"{}\", \"layers\": {}, \"beads\": {:.0f}, \"beds\": {}, \"samples\": {}, "
                  "\"rate\": {:.4g}, \"core_rate\": {:.4g}, \"ratio\": {:.3f}, \"us_per_step\": {:.2f}, "
                  "\"list_builds\": {}, \"same_bits\": {}}}",
                  name, layers, beads, beds, work.samples, rate, core_rate, rate / core_rate,
                  1e6 * seconds / work.steps(), builds[0], same)
          .c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fputs("usage: device_cost gpu|host LAYERS BEDS PERIODS SAMPLES\n", stderr);
    return 2;
  }
  try {
    run(argv[1], std::stoi(argv[2]), std::stoul(argv[3]),
        {.steps_per_period = 0, .periods = std::stol(argv[4]), .samples = std::stol(argv[5])});
    return 0;
  } catch (const Error& e) {
    std::fprintf(stderr, "device_cost: %s\n", e.what());
    return static_cast<int>(e.exit_code());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "device_cost: %s\n", e.what());
    return 1;
  }
}
