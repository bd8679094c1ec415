#include "sim/scene/presets.hpp"

namespace twincell::sim {

const std::vector<std::pair<std::string, std::string>>& presets() {
  // Canonical cells of Bhateja et al., sec. II: four layers, A = d, periodic, open top; W = K_m sets omega.
  // The paper names neither k_n nor c_t; the presets use 1e6 and c_t = c_n. A crystal would keep its mirror
  // planes for ever, and beads would never leave them, so the start is random.
  static const std::string plane_cell = R"(
[cell]
width = 10.0
sides = "periodic"
[beads]
layers = 4
inertia = "sphere"
[start]
kind = "random"
[drive]
amplitude = 1.0
)";
  static const std::string space_cell = R"(
[cell]
dimension = 3
width = 5.0
depth = 5.0
sides = "periodic"
plates = "periodic"
[beads]
layers = 4
[start]
kind = "random"
[drive]
amplitude = 1.0
)";
  static const std::string rough = R"([contact]
k_n = 1e6
restitution = 0.9
tangential = "dashpot"
c_t_over_c_n = 1.0
mu = 0.4
)";
  static const std::string smooth = R"([contact]
k_n = 1e6
restitution = 0.9
tangential = "none"
)";
  static const std::vector<std::pair<std::string, std::string>> all = {
      // Table I and section II; omega = 1/t0, so that A = Gamma and K_m = Gamma^2. By default side walls move
      // with the plate, and beads are discs, or spheres in a 3D slot.
      {"fortini-huang-2015", R"(
[cell]
width = 20.0
sides = "walls"
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
      {"bhateja-2016-smooth-2d", plane_cell + smooth},
      {"bhateja-2016-rough-2d", plane_cell + rough},
      {"bhateja-2016-smooth-3d", space_cell + smooth},
      {"bhateja-2016-rough-3d", space_cell + rough},
      // Fig. 5: a channel, periodic along y, whose end walls are driven along x; 3000 grains make two layers
      // in a period of 35 d. Floor and lid are at rest.
      {"bhateja-2016-horizontal", R"(
[cell]
dimension = 3
width = 43.0
depth = 35.0
height = 10.0
sides = "walls"
plates = "periodic"
lid = "wall"
bottom_motion = "rest"
lid_motion = "rest"
[beads]
count = 3000
[start]
kind = "random"
[contact]
k_n = 1e6
restitution = 0.3
tangential = "none"
[drive]
axis = "x"
amplitude = 10.0
)"},
      // Fig. 6: no gravity; the lid is ten diameters above the floor and moves with it. Without g the only
      // time scale is d/V_p, so the drive is given by A and omega.
      {"bhateja-2016-zero-g", R"(
[cell]
dimension = 3
width = 5.0
depth = 5.0
height = 10.0
sides = "periodic"
plates = "periodic"
lid = "wall"
gravity = 0.0
[beads]
layers = 4
[start]
kind = "random"
[drive]
amplitude = 1.0
omega = 1.0
)" + smooth},
  };
  return all;
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& preset : presets()) names.push_back(preset.first);
  return names;
}

}  // namespace twincell::sim
