// order_cost TABLE RULE [REPETITIONS] -> q6 of every bead on TABLE.RULE.q6, one line of JSON.
//
// TABLE, little-endian: int64 frames, int64 beads; then x, z as float64 for each bead of each frame. RULE:
// cutoff (1.2 sigma), delaunay, voronoi. order_peers.py runs this program and compares it with NumPy and
// SciPy.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "core/cpu_clock.hpp"

using namespace twincell;

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: order_cost TABLE RULE [REPETITIONS]\n");
    return 2;
  }
  const std::string path = argv[1], rule = argv[2];
  const int repetitions = argc > 3 ? std::stoi(argv[3]) : 1;
  std::ifstream in(path, std::ios::binary);
  std::int64_t size[2] = {0, 0};
  in.read(reinterpret_cast<char*>(size), sizeof size);
  std::vector<Frame> frames(static_cast<std::size_t>(size[0]));
  for (Frame& frame : frames)
    for (std::int64_t i = 0; i < size[1]; ++i) {
      double r[2];
      in.read(reinterpret_cast<char*>(r), sizeof r);
      frame.position.emplace_back(r[0], 0, r[1]);
    }
  if (!in || frames.empty()) {
    fmt::print(stderr, "order_cost: {} is missing or too short.\n", path);
    return 3;
  }
  Box box;
  box.boundary = {Boundary::wall, Boundary::open, Boundary::wall};

  double best = 1e300;
  std::vector<double> q6;
  for (int r = 0; r < repetitions; ++r) {
    q6.clear();
    const double start = thread_cpu_seconds();
    for (const Frame& frame : frames) {
      analysis::BondOrder order;
      if (rule == "cutoff") {
        order = analysis::bond_order(analysis::find_neighbours(frame, box, 1.2));
      } else {
        const analysis::VoronoiCells cells = analysis::voronoi_cells(frame, box);
        order = rule == "voronoi" ? analysis::bond_order(cells.neighbours, cells.edge)
                                  : analysis::bond_order(cells.neighbours);
      }
      q6.insert(q6.end(), order.q6.begin(), order.q6.end());
    }
    best = std::min(best, thread_cpu_seconds() - start);
  }
  std::ofstream out(path + "." + rule + ".q6", std::ios::binary);
  out.write(reinterpret_cast<const char*>(q6.data()),
            static_cast<std::streamsize>(q6.size() * sizeof(double)));
  fmt::print("{{\"seconds\": {}, \"bead_frames\": {}}}\n", best, q6.size());
}
