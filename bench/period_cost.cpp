// Runs a scene in pieces and prints the cost of each. It starts each piece on request, so another program can
// be timed on the same piece in between.
//
// usage: period_cost SCENE.toml PERIODS FOLDER [THREADS]
//
// A piece is PERIODS whole periods of the drive, because the cost varies over one period; there are
// time.cycles/PERIODS pieces. Before each piece the program writes its first state to FOLDER/piece_K.h5,
// prints {"state": …, "beads": …, "steps": …} and waits for a line on standard input. After the piece it
// prints {"cpu_s": …, "elapsed_s": …}: the processor time of the whole program, and the time by the clock.

#include <fmt/format.h>

#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>

#include "core/error.hpp"
#include "core/stage_times.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace {

using namespace twincell;

void say(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

class Pieces : public TrajectorySink {
 public:
  Pieces(const sim::Simulation& run, std::int64_t periods, std::string folder)
      : run_(run), periods_(periods), folder_(std::move(folder)) {}

  void append(const Frame& frame) override {
    if (frame.phase != 0 || frame.cycle % periods_ != 0) return;
    end_piece();
    const std::string name = fmt::format("{}/piece_{}.h5", folder_, frame.cycle / periods_);
    H5mdWriter writer(name, run_.trajectory_info());
    writer.append(frame);
    writer.finish();
    say(fmt::format(R"({{"state": "{}", "beads": {}, "steps": {}}})", name, frame.position.size(),
                    run_.plan().steps_per_period * periods_));
    std::string line;
    if (!std::getline(std::cin, line)) throw Interrupted(ExitCode::interrupted);
    begun_ = std::clock();
    begun_at_ = StageTimes::elapsed_seconds();
  }

  void end_piece() {
    if (begun_ >= 0)
      say(fmt::format(R"({{"cpu_s": {:.6f}, "elapsed_s": {:.6f}}})",
                      static_cast<double>(std::clock() - begun_) / CLOCKS_PER_SEC,
                      StageTimes::elapsed_seconds() - begun_at_));
  }

 private:
  const sim::Simulation& run_;
  std::int64_t periods_;
  std::string folder_;
  std::clock_t begun_ = -1;
  double begun_at_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) {
    std::fputs("usage: period_cost SCENE.toml PERIODS FOLDER [THREADS]\n", stderr);
    return 2;
  }
  try {
    sim::Simulation run(sim::read_scene(argv[1]), Progress::none(), sim::SolverKind::best,
                        argc == 5 ? std::stoi(argv[4]) : 1);
    Pieces pieces(run, std::stol(argv[2]), argv[3]);
    run.run(pieces);
    pieces.end_piece();
    return 0;
  } catch (const Error& e) {
    std::fprintf(stderr, "period_cost: %s\n", e.what());
    return static_cast<int>(e.exit_code());
  }
}
