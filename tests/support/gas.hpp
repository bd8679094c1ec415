#pragma once
/// \file
/// A homogeneous gas of equal beads in a periodic box without gravity: d = m = 1, speeds of order one.

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

struct GasOptions {
  int dimension = 2;
  int cells = 16;          ///< beads along each axis: cells^dimension in total
  double phi = 0.1;        ///< fraction of the area or volume
  double stiffness = 1e6;  ///< k_n
  double restitution = 1;
  double n = 20.37;  ///< steps per contact time
  unsigned seed = 1;
  std::string integrator = "verlet";
};

/// A gas that starts as a lattice, hexagonal rows or simple cubic, with Maxwellian velocities of temperature
/// 1 and total momentum 0.
class Gas {
 public:
  explicit Gas(const GasOptions& o) : options(o) {
    const bool flat = o.dimension == 2;
    const double spacing = flat ? std::sqrt(std::numbers::pi / (2 * std::sqrt(3.0) * o.phi))
                                : std::cbrt(std::numbers::pi / 6 / o.phi);
    const double width = o.cells * spacing, height = flat ? width * std::sqrt(0.75) : width;
    std::string text = "[cell]\ndimension = " + std::to_string(o.dimension) +
                       "\ngravity = 0.0\nwidth = " + exact(width) + "\nheight = " + exact(height) +
                       "\nsides = \"periodic\"\nbottom = \"periodic\"\n";
    if (!flat) text += "depth = " + exact(width) + "\nplates = \"periodic\"\n";
    text +=
        "[beads]\ncount = 1\n[drive]\namplitude = 0.0\nomega = 1.0\n[contact]\ntangential = \"none\"\nk_n "
        "= " +
        exact(o.stiffness) + "\nrestitution = " + exact(o.restitution) + "\n[time]\nintegrator = \"" +
        o.integrator + "\"\nstepping = \"steps\"\n";
    const Scene scene = read_scene_text(text, "gas");
    const Plan plan = make_plan(scene);
    system = make_system(scene, plan);
    contact_time = std::numbers::pi / std::sqrt(2 * o.stiffness);  // without the damping correction
    system.dt = contact_time / o.n;
    std::mt19937_64 engine(o.seed);
    std::normal_distribution<double> maxwell(0, 1);
    for (int a = 0; a < o.cells; ++a)
      for (int b = 0; b < o.cells; ++b)
        for (int c = 0; c < (flat ? 1 : o.cells); ++c) {
          Bead bead;
          bead.x = (a + 0.25 + (flat ? 0.5 * (b % 2) : 0)) * spacing;
          bead.z = (b + 0.5) * height / o.cells;
          bead.vx = maxwell(engine), bead.vz = maxwell(engine);
          if (!flat) bead.y = (c + 0.5) * spacing, bead.vy = maxwell(engine);
          bead.inertia = scene.inertia_factor * bead.mass * bead.radius * bead.radius;
          system.beads.push_back(bead);
        }
    stand_still();
    kernel = make_solver(plan, {.overlap = 0.3, .travel_per_step = 1});
  }

  /// Subtracts the mean velocity.
  void stand_still() {
    Vec3 momentum = Vec3::Zero();
    double mass = 0;
    for (const Bead& b : system.beads) momentum += b.mass * Vec3(b.vx, b.vy, b.vz), mass += b.mass;
    const Vec3 v = momentum / mass;
    for (Bead& b : system.beads) b.vx -= v.x(), b.vy -= v.y(), b.vz -= v.z();
  }
  void advance_time(double time) {
    kernel->advance(system, std::max<std::int64_t>(1, std::llround(time / system.dt)));
  }
  [[nodiscard]] double count() const { return static_cast<double>(system.beads.size()); }
  [[nodiscard]] double dimension() const { return options.dimension; }
  [[nodiscard]] double kinetic_energy() const {
    double sum = 0;
    for (const Bead& b : system.beads) sum += 0.5 * b.mass * (b.vx * b.vx + b.vy * b.vy + b.vz * b.vz);
    return sum;
  }
  /// m <v^2>/d
  [[nodiscard]] double temperature() const { return 2 * kinetic_energy() / (count() * dimension()); }
  [[nodiscard]] double number_density() const {
    const auto& p = system.period;
    return count() / (p[0] * p[2] * (options.dimension == 3 ? p[1] : 1));
  }
  /// Calls visit(i, j, overlap) for every pair in contact. It tests only the pairs of a list, which is
  /// rebuilt when a bead has moved by half of the list's margin.
  template <class Visit>
  void for_each_contact(Visit visit) {
    constexpr double kMargin = 0.3;
    bool stale = listed_at_.empty();
    for (std::size_t i = 0; i < listed_at_.size() && !stale; ++i)
      stale = (centre_of(system.beads[i]) - listed_at_[i]).squaredNorm() > kMargin * kMargin / 4;
    if (stale) {
      listed_at_.clear();
      near_.clear();
      for (const Bead& b : system.beads) listed_at_.push_back(centre_of(b));
      for_each_near_pair(system.beads, options.dimension, system.period, kMargin,
                         [&](std::int32_t i, std::int32_t j, double, const Vec3& shift) {
                           near_.push_back({i, j, shift});
                         });
    }
    for (const Near& pair : near_) {
      const Bead &p = system.beads[static_cast<std::size_t>(pair.i)],
                 &q = system.beads[static_cast<std::size_t>(pair.j)];
      const double r2 = (centre_of(p) - centre_of(q) + pair.shift).squaredNorm();
      const double reach = p.radius + q.radius;
      if (r2 < reach * reach) visit(pair.i, pair.j, reach - std::sqrt(r2));
    }
  }
  [[nodiscard]] double potential_energy() {
    double sum = 0;
    for_each_contact([&](auto, auto, double overlap) { sum += 0.5 * options.stiffness * overlap * overlap; });
    return sum;
  }

  GasOptions options;
  System system;
  std::unique_ptr<Solver> kernel;
  double contact_time = 0;

 private:
  struct Near {
    std::int32_t i, j;
    Vec3 shift;
  };
  std::vector<Near> near_;
  std::vector<Vec3> listed_at_;

  static std::string exact(double v) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", v);
    std::string s = text;
    return s.find_first_of(".e") == std::string::npos ? s + ".0" : s;
  }
};

/// Counts collisions by sampling the contacts twice per contact time: a contact of the linear law lasts t_c
/// at any speed.
class CollisionCounter {
 public:
  /// \return the number of contacts that were absent at the previous sample
  int look(Gas& gas) {
    std::set<std::pair<std::int32_t, std::int32_t>> now;
    int fresh = 0;
    gas.for_each_contact([&](std::int32_t i, std::int32_t j, double) {
      now.emplace(i, j);
      fresh += before_.count({i, j}) == 0;
    });
    before_ = std::move(now);
    return fresh;
  }

 private:
  std::set<std::pair<std::int32_t, std::int32_t>> before_;
};

/// (1 + phi^2/8)/(1 - phi)^2 (Henderson, Mol. Phys. 30, 971 (1975)).
inline double henderson_z(double phi) {
  return (1 + phi * phi / 8) / ((1 - phi) * (1 - phi));
}
/// (1 + phi + phi^2 - phi^3)/(1 - phi)^3 (Carnahan & Starling 1969).
inline double carnahan_starling_z(double phi) {
  return (1 + phi + phi * phi - phi * phi * phi) / std::pow(1 - phi, 3);
}
/// g at contact: Z = 1 + 2^(d-1) phi g.
inline double contact_value(int dimension, double phi) {
  return dimension == 2 ? (1 - 7 * phi / 16) / ((1 - phi) * (1 - phi)) : (1 - phi / 2) / std::pow(1 - phi, 3);
}
/// Collisions per bead and unit time in a hard gas of d = m = 1: 2 sqrt(pi) n g sqrt(T) for discs, 4 sqrt(pi)
/// n g sqrt(T) for spheres.
inline double collision_rate(int dimension, double number_density, double g, double temperature) {
  return (dimension == 2 ? 2 : 4) * std::sqrt(std::numbers::pi) * number_density * g * std::sqrt(temperature);
}
/// Diameter of the hard bead equivalent to the linear spring at temperature T, to first order in its
/// softness: the integral of 1 - exp(-k x^2/2T) (Barker & Henderson 1967).
inline double effective_diameter(double stiffness, double temperature) {
  return 1 - std::sqrt(std::numbers::pi * temperature / (2 * stiffness));
}

/// Equation of state of hard discs from the virial coefficients B_2...B_10 of Clisby & McCoy, J. Stat. Phys.
/// 122, 15 (2006), Table 1 (B_3 and B_4 are closed forms), as the Pade approximant [4/5]; [5/4] agrees to
/// 0.03 % up to phi = 0.6, where Henderson's formula is 1.2 % higher.
inline double hard_disc_z(double phi) {
  // Numerator and denominator of the approximant, in x = 2 phi.
  static const auto pade = [] {
    constexpr int kTop = 4, kBottom = 5;
    constexpr double kPi = std::numbers::pi, kRoot = std::numbers::sqrt3;
    const double b[10] = {1,
                          1,
                          4.0 / 3 - kRoot / kPi,
                          2 - 9 * kRoot / (2 * kPi) + 10 / (kPi * kPi),
                          0.33355604,
                          0.1988425,
                          0.1148728,
                          0.0649930,
                          0.0362193,
                          0.0199537};
    Eigen::Matrix<double, kBottom, kBottom> a;
    Eigen::Matrix<double, kBottom, 1> right;
    for (int i = 0; i < kBottom; ++i) {
      right[i] = -b[kTop + 1 + i];
      for (int j = 0; j < kBottom; ++j) a(i, j) = kTop + i - j >= 0 ? b[kTop + i - j] : 0;
    }
    const Eigen::Matrix<double, kBottom, 1> q = a.fullPivLu().solve(right);
    std::pair<std::vector<double>, std::vector<double>> c{{}, {1}};
    for (int j = 0; j < kBottom; ++j) c.second.push_back(q[j]);
    for (int i = 0; i <= kTop; ++i) {
      c.first.push_back(0);
      for (int j = 0; j <= i; ++j) c.first.back() += c.second[static_cast<std::size_t>(j)] * b[i - j];
    }
    return c;
  }();
  const auto value = [&](const std::vector<double>& c) {
    double sum = 0;
    for (auto k = c.rbegin(); k != c.rend(); ++k) sum = sum * 2 * phi + *k;
    return sum;
  };
  return value(pade.first) / value(pade.second);
}

/// Mean and standard error from block means.
struct Averaged {
  double mean = 0, error = 0;
};
inline Averaged over_blocks(const std::vector<double>& block) {
  Averaged a;
  const double n = static_cast<double>(block.size());
  for (const double b : block) a.mean += b / n;
  for (const double b : block) a.error += (b - a.mean) * (b - a.mean);
  a.error = std::sqrt(a.error / (n * (n - 1)));
  return a;
}

}  // namespace twincell::sim
