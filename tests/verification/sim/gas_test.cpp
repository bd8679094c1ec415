// Many beads without gravity, elastic and cooling (docs/validation.md: V3.1-V3.8, V4.1). Run lengths are
// chosen so that the standard error, from the means of time blocks or of several starts, is at most half of
// the tolerance. The tests check this condition too.

#include "tests/support/gas.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/validation.hpp"

namespace twincell::sim::gas_test {
namespace {

using test::validate;

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

TEST(ElasticGas, EnergyWalksAtRandomAndDoesNotDrift) {
  // Where a contact begins a fraction theta into a step, Verlet makes an error of (w0 dt)^2 theta (1 - theta)
  // in the energy E_n of the approach; where the contact ends, it makes the opposite error. The variance over
  // theta is 1/180, and <E_n^2> = 2 T^2 over collisions: after N_c collisions the energy has random-walked by
  // T (pi/n)^2 sqrt(N_c/45).
  constexpr int kStarts = 24;
  constexpr std::int64_t kSteps = 40'000;
  for (const double n : {50.37, 100.37}) {
    double mean = 0, squares = 0;
    for (unsigned seed = 1; seed <= kStarts; ++seed) {
      Gas gas({.cells = 16, .phi = 0.3, .stiffness = 1e4, .n = n, .seed = seed});
      const double start = gas.kinetic_energy() + gas.potential_energy();
      gas.kernel->advance(gas.system, kSteps);
      const double collisions = 0.5 * gas.count() * gas.system.time() *
                                collision_rate(2, gas.number_density(), contact_value(2, 0.3), 1);
      const double walk = std::pow(std::numbers::pi / n, 2) * std::sqrt(collisions / 45) * gas.temperature();
      const double change = (gas.kinetic_energy() + gas.potential_energy() - start) / walk;
      mean += change / kStarts, squares += change * change / kStarts;
      double px = 0, pz = 0;
      for (const Bead& b : gas.system.beads) px += b.vx, pz += b.vz;
      if (seed == 1)
        validate({"V3.2", "momentum, 256 discs, 4e4 steps, n = " + number(n), 0, 1e-12 * std::sqrt(kSteps),
                  "conservation"},
                 std::hypot(px, pz));
    }
    const std::string what = " energy change over that of a random walk, verlet, n = " + number(n);
    // Three standard errors of 24 starts.
    validate({"V3.1", "mean" + what, 0, 3 / std::sqrt(kStarts), "closed form"}, mean);
    validate({"V3.1", "rms" + what, 1, 3 / std::sqrt(2.0 * kStarts), "closed form"}, std::sqrt(squares));
  }
}

TEST(ElasticGas, KeepsEnergyWhereStepsAreSplit) {
  // The plan requires 1e-4 over 1e7 steps, with a fitted drift of 1e-5. n = 100 meets this; n = 50 meets it
  // over a twentieth of the steps.
  struct Case {
    double n;
    std::int64_t steps;
  };
  constexpr int kLooks = 100;
  for (const Case& c : {Case{50.37, 500'000}, {100.37, 10'000'000}}) {
    Gas gas({.cells = 16, .phi = 0.3, .n = c.n, .integrator = "split"});
    const double start = gas.kinetic_energy() + gas.potential_energy();
    double up = 0, down = 0, largest = 0;
    for (int k = 0; k < kLooks; ++k) {
      gas.kernel->advance(gas.system, c.steps / kLooks);
      const double change = (gas.kinetic_energy() + gas.potential_energy()) / start - 1;
      largest = std::max(largest, std::abs(change));
      const double t = (k - 0.5 * (kLooks - 1)) / kLooks;
      up += t * change, down += t * t;
    }
    const std::string what = " of the energy, 256 discs, phi = 0.3, split, " +
                             number(static_cast<double>(c.steps)) + " steps, n = " + number(c.n);
    validate({"V3.1", "largest change" + what, 0, 1e-4, "conservation"}, largest);
    if (c.n > 100) validate({"V3.1", "drift over the run" + what, 0, 1e-5, "conservation"}, up / down);
  }
}

TEST(ElasticGas, KeepsAngularMomentum) {
  // A contracting and rotating cloud in open space.
  for (const int dimension : {2, 3}) {
    Gas gas({.dimension = dimension, .cells = dimension == 2 ? 12 : 5, .phi = 0.2});
    gas.system.period = {0, 0, 0};
    Vec3 middle = Vec3::Zero();
    for (const Bead& b : gas.system.beads) middle += centre_of(b) / gas.count();
    for (Bead& b : gas.system.beads) {
      const Vec3 r = centre_of(b) - middle;
      b.x = r.x(), b.y = r.y(), b.z = r.z();
      b.vx -= 0.5 * r.x() + 0.3 * r.z(), b.vy -= 0.5 * r.y(), b.vz -= 0.5 * r.z() - 0.3 * r.x();
    }
    if (dimension == 2)
      for (Bead& b : gas.system.beads) b.y = b.vy = 0;
    const auto angular_momentum = [&] {
      Vec3 sum = Vec3::Zero();
      for (const Bead& b : gas.system.beads) sum += centre_of(b).cross(Vec3(b.vx, b.vy, b.vz));
      return sum;
    };
    const Vec3 before = angular_momentum();
    CollisionCounter counter;
    int collisions = 0;
    for (int k = 0; k < 4000; ++k) {
      gas.advance_time(gas.contact_time / 2);
      collisions += counter.look(gas);
    }
    EXPECT_GT(collisions, 100);
    validate({"V3.3", "angular momentum of a smooth cloud, relative, " + number(dimension) + "D", 0, 1e-11,
              "conservation"},
             (angular_momentum() - before).norm() / before.norm());
  }
}

TEST(ElasticGas, SharesEnergyEqually) {
  // Half of the beads are ten times as heavy and all start at the same speed: far from equilibrium.
  Gas gas({.cells = 20, .phi = 0.5, .stiffness = 2.5e3, .n = 15.37});
  for (std::size_t i = 0; i < gas.system.beads.size(); i += 2) gas.system.beads[i].mass = 10;
  gas.stand_still();
  double mass = 0;
  for (const Bead& b : gas.system.beads) mass += b.mass;
  gas.advance_time(30);
  constexpr int kBlocks = 20, kLooks = 100;
  std::vector<double> ratio, axes, kurtosis;
  for (int block = 0; block < kBlocks; ++block) {
    std::array<double, 2> energy{};
    double x2 = 0, z2 = 0, fourth = 0, squares = 0;
    for (int look = 0; look < kLooks; ++look) {
      gas.advance_time(0.25);
      double heat = 0;
      for (const Bead& b : gas.system.beads) heat += b.mass * (b.vx * b.vx + b.vz * b.vz);
      heat /= 2 * (gas.count() - 1);
      for (std::size_t i = 0; i < gas.system.beads.size(); ++i) {
        const Bead& b = gas.system.beads[i];
        // The centre of mass is at rest: m <v^2> = d T (1 - m/M).
        const double share = b.mass / (1 - b.mass / mass) / heat;
        const double x = share * b.vx * b.vx, z = share * b.vz * b.vz;
        energy[i % 2] += x + z;
        x2 += x, z2 += z, fourth += x * x + z * z, squares += x + z;
      }
    }
    const double samples = 2 * gas.count() * kLooks;
    ratio.push_back(energy[0] / energy[1]);
    axes.push_back(x2 / z2);
    kurtosis.push_back(fourth / samples / std::pow(squares / samples, 2));
  }
  const auto row = [](const std::string& what, double outside, const std::vector<double>& blocks) {
    const Averaged a = over_blocks(blocks);
    EXPECT_LT(2 * a.error, 0.01 * outside);
    validate({"V3.4", what, outside, 0.01 * outside, "equipartition"}, a.mean);
  };
  row("temperature of heavy over light beads, masses 10 : 1, mixed from afar", 1, ratio);
  row("<v_x^2>/<v_z^2>", 1, axes);
  // The sum of N squares is fixed: <v^4>/<v^2>^2 is approximately 3 (1 - 2/(2 N)).
  row("kurtosis of a velocity component", 3, kurtosis);
}

struct State {
  double z;       ///< P/(n T) for beads of the effective diameter, converted to diameter 1
  double z_soft;  ///< as measured
  double rate;    ///< collisions per bead and time, over sqrt(T)
  double temperature;
  Averaged virial;  ///< its error is relative to z_soft
};

/// Pressure and collision rate. \param equation Z(phi) of the hard gas, for the conversion to diameter 1
template <class Equation>
State measure(const GasOptions& options, double collisions, Equation equation) {
  Gas gas(options);
  const double g = contact_value(options.dimension, options.phi);
  const double rate = collision_rate(options.dimension, gas.number_density(), g, 1);
  gas.advance_time(30 / rate + 2);
  constexpr int kBlocks = 16;
  const int looks = static_cast<int>(collisions / (gas.count() * rate / 2 * gas.contact_time / 2) / kBlocks);
  CollisionCounter counter;
  counter.look(gas);
  double temperature = 0;
  std::vector<double> blocks;
  long counted = 0;
  const std::int64_t first_step = gas.system.step;
  for (int block = 0; block < kBlocks; ++block) {
    double sum = 0, heat = 0;
    for (int look = 0; look < looks; ++look) {
      gas.advance_time(gas.contact_time / 2);
      counted += counter.look(gas);
      gas.for_each_contact(
          [&](auto, auto, double overlap) { sum += options.stiffness * overlap * (1 - overlap) / looks; });
      heat += gas.temperature() / looks;
    }
    temperature += heat / kBlocks;
    blocks.push_back(sum / (gas.dimension() * gas.count() * heat));
  }
  State s{};
  s.virial = over_blocks(blocks);
  s.z_soft = 1 + s.virial.mean;
  s.temperature = temperature;
  const double d = effective_diameter(options.stiffness, temperature);
  const double soft = equation(options.phi * std::pow(d, options.dimension)) - 1;
  s.z = 1 + s.virial.mean * (equation(options.phi) - 1) / soft;
  s.virial.error /= s.z_soft;
  const double time = static_cast<double>(gas.system.step - first_step) * gas.system.dt;
  s.rate = 2 * static_cast<double>(counted) / (gas.count() * time) / std::sqrt(temperature);
  return s;
}

TEST(ElasticGas, PressureOfDiscs) {
  for (const auto& [phi, collisions] :
       {std::pair{0.1, 1e4}, {0.2, 2e4}, {0.3, 3e4}, {0.4, 6e4}, {0.5, 8e4}, {0.6, 1.2e5}}) {
    const State s = measure({.cells = 24, .phi = phi, .stiffness = 1e5}, collisions, hard_disc_z);
    EXPECT_LT(2 * s.virial.error, 0.01);
    const std::string what = "P/(n T), 576 discs, phi = " + number(phi);
    if (phi < 0.55)
      validate({"V3.5", what, henderson_z(phi), 0.01 * henderson_z(phi), "Henderson 1975"}, s.z);
    validate({"V3.5", what, hard_disc_z(phi), 0.01 * hard_disc_z(phi),
              "virial series to B10, Clisby & McCoy 2006"},
             s.z);
  }
}

TEST(ElasticGas, PressureTendsToThatOfHardDiscs) {
  // Three stiffnesses; the remaining deviation is proportional to sqrt(T/k_n).
  const double phi = 0.3, outside = hard_disc_z(phi);
  double s_0 = 0, s_x = 0, s_xx = 0, s_y = 0, s_xy = 0;
  for (const double stiffness : {2.5e3, 1e4, 4e4}) {
    const State s = measure({.cells = 24, .phi = phi, .stiffness = stiffness}, 3e4, hard_disc_z);
    const double x = std::sqrt(s.temperature / stiffness);
    s_0 += 1, s_x += x, s_xx += x * x, s_y += s.z_soft, s_xy += x * s.z_soft;
    const double d = effective_diameter(stiffness, s.temperature);
    validate({"V3.5", "P/(n T), phi = 0.3, k_n = " + number(stiffness) + ": discs of the effective diameter",
              hard_disc_z(phi * d * d), 0.01 * outside, "virial series; Barker & Henderson 1967"},
             s.z_soft);
  }
  const double limit = (s_xx * s_y - s_x * s_xy) / (s_0 * s_xx - s_x * s_x);
  validate({"V3.5", "P/(n T), phi = 0.3, k_n -> infinity from three", henderson_z(phi),
            0.015 * henderson_z(phi), "Henderson 1975"},
           limit);
}

TEST(ElasticGas, PressureOfSpheres) {
  for (const auto& [phi, collisions] : {std::pair{0.1, 2e4}, {0.2, 4e4}, {0.3, 8e4}, {0.4, 1.6e5}}) {
    const State s =
        measure({.dimension = 3, .cells = 9, .phi = phi, .stiffness = 1e5}, collisions, carnahan_starling_z);
    EXPECT_LT(2 * s.virial.error, 0.01);
    const double z = carnahan_starling_z(phi);
    validate({"V3.7", "P/(n T), 729 spheres, phi = " + number(phi), z, 0.01 * z, "Carnahan & Starling 1969"},
             s.z);
  }
}

TEST(ElasticGas, CollisionRate) {
  for (const int dimension : {2, 3})
    for (const double phi : {0.1, 0.3}) {
      const GasOptions options{.dimension = dimension,
                               .cells = dimension == 2 ? 24 : 9,
                               .phi = phi,
                               .stiffness = phi < 0.2 ? 2e5 : 1e6};
      const double n = dimension == 2 ? phi * 4 / std::numbers::pi : phi * 6 / std::numbers::pi;
      const double outside = collision_rate(dimension, n, contact_value(dimension, phi), 1);
      const State s = measure(options, 1.5e4, [](double) { return 2.0; });
      validate(
          {"V3.6",
           "collisions of a bead per time, over sqrt(T), " + number(dimension) + "D, phi = " + number(phi),
           outside, 0.02 * outside, "Enskog"},
          s.rate);
    }
}

TEST(ElasticGas, PairCorrelationAtContact) {
  for (const int dimension : {2, 3}) {
    const double phi = 0.3;
    Gas gas({.dimension = dimension, .cells = dimension == 2 ? 24 : 9, .phi = phi, .stiffness = 1e4});
    gas.advance_time(10);
    // g(r) in shells up to 1.2 d. A parabola through ln g, weighted by counts, is extrapolated to the
    // effective diameter, where g of soft beads equals the contact value of hard beads of that diameter.
    constexpr int kShells = 10, kLooks = 800;
    const double reach = 0.2;
    std::array<double, kShells> counts{};
    double temperature = 0;
    for (int look = 0; look < kLooks; ++look) {
      gas.advance_time(0.1);
      temperature += gas.temperature() / kLooks;
      for_each_near_pair(gas.system.beads, dimension, gas.system.period, reach,
                         [&](auto, auto, double gap, const Vec3&) {
                           if (gap >= 0) ++counts[static_cast<std::size_t>(gap / reach * kShells)];
                         });
    }
    const double d = effective_diameter(gas.options.stiffness, temperature);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Vec3 right = Vec3::Zero();
    for (int k = 0; k < kShells; ++k) {
      const double inner = 1 + reach * k / kShells, outer = 1 + reach * (k + 1) / kShells;
      const double shell = dimension == 2
                               ? std::numbers::pi * (outer * outer - inner * inner)
                               : 4 * std::numbers::pi / 3 * (std::pow(outer, 3) - std::pow(inner, 3));
      const double c = counts[static_cast<std::size_t>(k)];
      const double g = c / (kLooks * (gas.count() - 1) / 2 * gas.number_density() * shell);
      const double r = (inner + outer) / 2 - d;
      const Vec3 row(1, r, r * r);
      normal += c * row * row.transpose();
      right += c * std::log(g) * row;
    }
    const double measured = std::exp(normal.fullPivLu().solve(right)[0]);
    const double outside = contact_value(dimension, phi * std::pow(d, dimension));
    validate({"V3.8", "g at contact, " + number(dimension) + "D, phi = 0.3", outside, 0.03 * outside,
              dimension == 2 ? "Henderson 1975" : "Carnahan & Starling 1969"},
             measured);
  }
}

/// Equilibrates the elastic gas, then lets it cool with e = 0.9. Returns the slope of sqrt(T_0/T) over t up
/// to 5 tau, times tau.
double haff_slope(const GasOptions& options) {
  Gas elastic(options);
  const double g = contact_value(options.dimension, options.phi);
  const double rate = collision_rate(options.dimension, elastic.number_density(), g, 1);
  elastic.advance_time(20 / rate);
  GasOptions lossy = options;
  lossy.restitution = 0.9;
  Gas gas(lossy);
  gas.system.beads = elastic.system.beads;
  const double t_0 = gas.temperature();
  const double tau =
      2 * options.dimension / ((1 - 0.9 * 0.9) * rate * std::sqrt(t_0));  // 1/tau = (1 - e^2) w_c/(2 d)
  constexpr int kLooks = 100;
  double up = 0, down = 0;
  for (int k = 1; k <= kLooks; ++k) {
    gas.advance_time(5 * tau / kLooks);
    const double t = gas.system.time() / tau;
    up += t * (std::sqrt(t_0 / gas.temperature()) - 1), down += t * t;
  }
  return up / down;
}

/// Uses so few beads that shear modes, which cool more slowly than the rest, carry little of the energy.
void expect_haff(const GasOptions& options, int starts) {
  std::vector<double> slopes;
  for (int seed = 1; seed <= starts; ++seed) {
    GasOptions start = options;
    start.seed = static_cast<unsigned>(seed);
    slopes.push_back(haff_slope(start));
  }
  const Averaged a = over_blocks(slopes);
  EXPECT_LT(2 * a.error, 0.03);
  validate({"V4.1",
            "slope of sqrt(T_0/T) times tau, e = 0.9, phi = 0.1, t <= 5 tau, " + number(options.dimension) +
                "D, mean of " + number(starts) + " starts",
            1, 0.03, "Haff 1983"},
           a.mean);
}

TEST(CoolingGas, DiscsFollowHaff) {
  expect_haff({.dimension = 2, .cells = 20, .phi = 0.1, .stiffness = 2.5e4}, 8);
}

TEST(CoolingGas, SpheresFollowHaff) {
  expect_haff({.dimension = 3, .cells = 8, .phi = 0.1, .stiffness = 2.5e4}, 8);
}

}  // namespace
}  // namespace twincell::sim::gas_test
