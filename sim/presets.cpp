#include "sim/presets.hpp"

namespace twincell::sim {

const std::vector<std::pair<std::string, std::string>>& presets() {
  static const std::vector<std::pair<std::string, std::string>> all = {
      // Table I and section II; omega = 1/t0, so that A = Gamma and K_m = Gamma^2. Side walls ride with the
      // plate.
      {"fortini-huang-2015", R"(
[cell]
width = 20.0
sides = "walls"
side_walls = "move"
[beads]
inertia = "disc"
[contact]
k_n = 1e6
gamma_n = 100.0
tangential = "spring"
k_t = 1e4
gamma_t = 100.0
mu = 0.6
[drive]
omega = 1.0
)"},
      // Canonical two-dimensional cell: 10 d periodic, four layers of ten, A = d; W = K_m sets omega.
      {"bhateja-2016-rough-2d", R"(
[cell]
width = 10.0
sides = "periodic"
[beads]
count = 40
inertia = "sphere"
[contact]
k_n = 1e6
restitution = 0.9
tangential = "dashpot"
c_t_over_c_n = 1.0
mu = 0.4
[drive]
amplitude = 1.0
)"},
      {"bhateja-2016-smooth-2d", R"(
[cell]
width = 10.0
sides = "periodic"
[beads]
count = 40
inertia = "sphere"
[contact]
k_n = 1e6
restitution = 0.9
tangential = "none"
mu = 0.0
[drive]
amplitude = 1.0
)"},
  };
  return all;
}

}  // namespace twincell::sim
