#include "sim/start/start_speeds.hpp"

#include <algorithm>
#include <cmath>

#include "sim/scene/starts.hpp"

namespace twincell::sim {

std::optional<StartSpeeds> speeds_of_start(const Scene& scene, const std::vector<Bead>& beads) {
  if (beads.empty() || (!start_row(scene.start).from_file && scene.g() > 0)) return std::nullopt;
  const auto n = static_cast<double>(beads.size());
  Vec3 mean = Vec3::Zero();
  for (const Bead& b : beads) mean += Vec3(b.vx, b.vy, b.vz) / n;
  double squares = 0, squares_about_mean = 0, fastest = 0, first = 0, second = 0;
  for (const Bead& b : beads) {
    const Vec3 v(b.vx, b.vy, b.vz);
    const double about_mean = (v - mean).norm();
    squares += v.squaredNorm();
    squares_about_mean += about_mean * about_mean;
    fastest = std::max(fastest, v.norm());
    second = std::max(second, std::min(first, about_mean));
    first = std::max(first, about_mean);
  }
  const double of_pairs = n > 1 ? std::sqrt(2 * squares_about_mean / (n - 1)) : 0;
  const StartSpeeds speeds{.typical = std::max(of_pairs, std::sqrt(squares / n)),
                           .largest = std::max(first + second, fastest)};
  if (!(speeds.largest > 0)) return std::nullopt;
  return speeds;
}

}  // namespace twincell::sim
