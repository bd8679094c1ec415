// link_cost TABLE DIAMETER PHASES [FALL] [MEMORY] [REPETITIONS] -> identities on TABLE.ids, one line of JSON.
//
// TABLE, little-endian: int64 frames; per frame int64 beads, then x, y as float64 for each. PHASES 0: the
// linker gets no phase of a frame. link_peers.py runs this program and compares it with other linkers.

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "core/cpu_clock.hpp"
#include "imaging/link/initial_velocities.hpp"
#include "imaging/link/link.hpp"

using namespace twincell;

namespace {

template <class T>
T get(std::ifstream& in) {
  T value{};
  in.read(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: link_cost TABLE DIAMETER PHASES [FALL] [MEMORY] [REPETITIONS]\n");
    return 2;
  }
  // Detections.
  const std::string path = argv[1];
  std::ifstream in(path, std::ios::binary);
  std::vector<std::vector<imaging::PixelPoint>> frames(static_cast<std::size_t>(get<std::int64_t>(in)));
  for (auto& frame : frames) {
    frame.resize(static_cast<std::size_t>(get<std::int64_t>(in)));
    for (imaging::PixelPoint& p : frame) {
      p.x_px = get<double>(in);
      p.y_px = get<double>(in);
    }
  }
  if (!in) {
    fmt::print(stderr, "link_cost: {} is missing or too short.\n", path);
    return 3;
  }
  // Options of the linker.
  imaging::LinkOptions options{.diameter_px = std::stod(argv[2])};
  const int phases = std::stoi(argv[3]);
  options.closed = true;
  if (argc > 4) options.fall_px = std::stod(argv[4]);
  if (argc > 5) options.memory = std::stoi(argv[5]);
  const int repetitions = argc > 6 ? std::stoi(argv[6]) : 1;

  auto time_of = [&](std::size_t f) {
    imaging::FrameTime time;
    if (phases > 0) {
      time.phase = static_cast<std::int32_t>(f % static_cast<std::size_t>(phases));
      time.cycle = static_cast<std::int64_t>(f / static_cast<std::size_t>(phases));
    }
    return time;
  };
  // Linking: the fastest repetition counts; the first one also writes the identities.
  double best = 1e300;
  imaging::LinkReport report;
  for (int r = 0; r < repetitions; ++r) {
    std::ofstream out;
    if (r == 0) out.open(path + ".ids", std::ios::binary);
    imaging::Linker linker(options, phases);
    const double begun = process_cpu_seconds();
    linker.begin(imaging::initial_velocities(options, phases, frames.size(), [&](std::size_t f) {
      return imaging::FrameOfBeads{frames[f], {}, time_of(f)};
    }));
    double seconds = process_cpu_seconds() - begun;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const bool more = f + 1 < frames.size();
      const imaging::FrameAhead ahead =
          more ? imaging::FrameAhead{frames[f + 1], time_of(f + 1), {}} : imaging::FrameAhead{};
      const double start = process_cpu_seconds();
      const std::vector<std::int64_t> ids = linker.next(frames[f], time_of(f), {}, more ? &ahead : nullptr);
      seconds += process_cpu_seconds() - start;
      if (r > 0) continue;
      for (std::size_t k = 0; k < ids.size(); ++k) {
        const std::int64_t record[2] = {ids[k], linker.ambiguous()[k]};
        out.write(reinterpret_cast<const char*>(record), sizeof record);
      }
    }
    best = std::min(best, seconds);
    report = linker.total();
  }
  fmt::print(
      R"({{"seconds": {}, "links": {}, "settled": {}, "bridged": {}, "ambiguous": {}, "births": {}, "losses": {}, )"
      R"("networks": {}, "largest_network": {}, "unsolved": {}, "rematched": {}, "unclear_shifts": {}}})"
      "\n",
      best, report.links, report.settled, report.bridged, report.ambiguous, report.births, report.losses,
      report.networks, report.largest_network, report.unsolved, report.rematched, report.unclear_shifts);
}
