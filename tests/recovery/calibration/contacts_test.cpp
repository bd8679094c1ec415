// Restitution and friction from bounces and collisions whose truth is known: by formula, and by the
// simulator.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "calibration/contact/bounce.hpp"
#include "calibration/contact/collisions.hpp"
#include "calibration/contact/contact_numbers.hpp"
#include "calibration/contact/inference.hpp"
#include "calibration/contact/walton.hpp"
#include "calibration/fit/curve_components.hpp"
#include "core/error.hpp"
#include "sim/laws/linear_collision.hpp"
#include "sim/run/simulation.hpp"
#include "tests/support/validation.hpp"

using namespace twincell;

namespace {

struct Film {
  double e = 0.85, drop = 4, noise = 0.005, dt = 0.02, drag = 0, outliers = 0;
  double amplitude = 0, omega = 1;
  double duration = 16;
};

/// A bead of radius 1/2 that bounces on a plate; flights with drag to first order in short steps, impacts by
/// bisection.
std::vector<BounceSample> bounce(const Film& film, std::mt19937_64& generator) {
  std::normal_distribution<double> noise(0, film.noise);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto plate = [&](double t) { return film.amplitude * std::sin(film.omega * t); };
  const auto plate_velocity = [&](double t) {
    return film.amplitude * film.omega * std::cos(film.omega * t);
  };
  double t = 0, z = film.drop, v = 0;
  std::vector<BounceSample> samples;
  const double step = film.dt / 20;
  const auto fly = [&](double h) {
    z += v * h - 0.5 * h * h - film.drag * (v * 0.5 * h * h);
    v -= h + film.drag * (v * h - 0.5 * h * h);
    t += h;
  };
  for (int i = 0; t < film.duration; ++i) {
    if (i % 20 == 0) {
      const double wild = uniform(generator) < film.outliers ? 2 * (uniform(generator) - 0.5) : 0;
      samples.push_back({t, z + noise(generator) + wild});
    }
    const double t0 = t, z0 = z, v0 = v;
    fly(step);
    if (z - 0.5 >= plate(t)) continue;
    double low = 0, high = step;
    for (int k = 0; k < 60; ++k) {
      t = t0, z = z0, v = v0;
      const double middle = 0.5 * (low + high);
      fly(middle);
      (z - 0.5 >= plate(t) ? low : high) = middle;
    }
    v = plate_velocity(t) - film.e * (v - plate_velocity(t));
    if (v - plate_velocity(t) < 0.05) break;
    fly(step - low);
  }
  return samples;
}

struct Recovered {
  double bias = 0, rms = 0, coverage = 0;
};

Recovered recover(const char* what, const Film& film, int trials, const BounceOptions& options) {
  std::mt19937_64 generator(31);
  Recovered r;
  for (int i = 0; i < trials; ++i) {
    const BounceFit fit = fit_bounces(bounce(film, generator), options);
    const double error = fit.restitution - film.e;
    r.bias += error / trials;
    r.rms += error * error / trials;
    r.coverage += std::abs(error) <= 1.96 * fit.restitution_error ? 1.0 / trials : 0;
  }
  r.rms = std::sqrt(r.rms);
  std::cout << what << ": bias " << r.bias << ", rms " << r.rms << ", coverage " << 100 * r.coverage
            << " %\n";
  EXPECT_LE(std::abs(r.bias), 4 * r.rms / std::sqrt(trials));
  return r;
}

}  // namespace

TEST(ContactNumbers, AreInverseToTheCollision) {
  // Table of physics: bead-bead of paper 1, t_c = 2.222831e-3 t0, e_n = 0.894812 from k_n = 1e6, gamma_n =
  // 100.
  const SpringDashpot s = spring_of(0.894812, 2.222831e-3, 0.5);
  test::validate({"I6.1", "k_n from e_n and t_c, paper 1 bead-bead", 1e6, 5, "closed form, eq. A5"}, s.k_n);
  test::validate({"I6.1", "gamma_n from e_n and t_c, paper 1 bead-bead", 100, 1e-3, "closed form, eq. A5"},
                 s.gamma_n);
  for (const double e : {0.05, 0.5, 0.9, 1.0})
    for (const double t_c : {1e-3, 0.1}) {
      const SpringDashpot there = spring_of(e, t_c, 0.5);
      const sim::LinearCollision back(there.k_n, there.c_n, 0.5);
      EXPECT_NEAR(back.restitution(), e, 1e-12);
      EXPECT_NEAR(back.contact_time(), t_c, 1e-12 * t_c);
      EXPECT_NEAR(there.c_n, 0.5 * there.gamma_n, 1e-12 * there.gamma_n);
    }
  EXPECT_THROW(spring_of(0, 1e-3, 1), ConfigError);
  EXPECT_THROW(spring_of(1.01, 1e-3, 1), ConfigError);
  EXPECT_THROW(spring_of(0.9, 0, 1), ConfigError);
}

TEST(Bounce, RestingPlateIntervalsCover) {
  const Recovered r = recover("resting plate", {}, 200, {});
  EXPECT_GE(r.coverage, 0.93);
  EXPECT_LE(r.coverage, 0.97);
  EXPECT_LT(r.rms, 0.005);
}

TEST(Bounce, OutliersAreTold) {
  const Recovered r = recover("20 % outliers", {.outliers = 0.2}, 200, {});
  EXPECT_GE(r.coverage, 0.93);
  EXPECT_LE(r.coverage, 0.97);
}

TEST(Bounce, DragAndGravityAreNuisancesThatComeBack) {
  std::mt19937_64 generator(32);
  const BounceFit fit = fit_bounces(bounce({.drop = 12, .noise = 0.003, .drag = 0.02}, generator));
  std::cout << "g " << fit.gravity << " +- " << fit.gravity_error << ", drag " << fit.drag << " +- "
            << fit.drag_error << ", e " << fit.restitution << " +- " << fit.restitution_error << "\n";
  EXPECT_NEAR(fit.gravity, 1, 4 * fit.gravity_error);
  EXPECT_NEAR(fit.drag, 0.02, 4 * fit.drag_error);
  EXPECT_GT(fit.drag, 3 * fit.drag_error);
  EXPECT_NEAR(fit.restitution, 0.85, 4 * fit.restitution_error);
}

TEST(Bounce, VibratingPlate) {
  const Film film{.e = 0.8, .amplitude = 0.3, .omega = 2.5, .duration = 30};
  const BounceOptions options{.gravity = std::nullopt, .drag = false, .plate = [](double t) {
                                return PlateAt{0.3 * std::sin(2.5 * t), 0.75 * std::cos(2.5 * t)};
                              }};
  const Recovered r = recover("vibrating plate", film, 200, options);
  EXPECT_GE(r.coverage, 0.93);
  EXPECT_LE(r.coverage, 0.97);
}

TEST(Bounce, NoNoiseAndAPlateThatOvertakesFlights) {
  // Heights without noise: where the plate falls and rises under a flying bead, the height above it has
  // minima that are no impacts.
  const Film film{.e = 0.85, .noise = 0, .amplitude = 4, .duration = 60};
  const BounceOptions options{.gravity = std::nullopt, .drag = false, .plate = [](double t) {
                                return PlateAt{4 * std::sin(t), 4 * std::cos(t)};
                              }};
  std::mt19937_64 generator(1);
  const BounceFit fit = fit_bounces(bounce(film, generator), options);
  EXPECT_GE(fit.impacts.size(), 2U);
  for (const BounceImpact& impact : fit.impacts) EXPECT_NEAR(impact.restitution, 0.85, 1e-3) << impact.time;
  EXPECT_NEAR(fit.gravity, 1, 1e-4);
}

TEST(Bounce, WhatCannotBeFitted) {
  EXPECT_THROW(fit_bounces({}), InputError);
  std::vector<BounceSample> fall;
  for (int i = 0; i < 40; ++i) fall.push_back({0.02 * i, 5 - 0.5 * 0.0004 * i * i});
  EXPECT_THROW(fit_bounces(fall), InputError) << "a fall without an impact";
}

namespace {

/// Impacts by Walton's law.
std::vector<Impact> impacts(double e, double mu, double beta, double steepest, int n, double noise,
                            std::mt19937_64& generator) {
  std::normal_distribution<double> normal(0, noise);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Impact> all;
  for (int i = 0; i < n; ++i) {
    const double psi = steepest * uniform(generator);
    all.push_back({.speed = 0.3 + uniform(generator),
                   .restitution = e + normal(generator),
                   .psi_1 = psi,
                   .psi_2 = std::max(-beta * psi, psi - mu * (1 + e) * 3) + normal(generator)});
  }
  return all;
}

}  // namespace

TEST(Walton, IntervalsCover) {
  std::mt19937_64 generator(41);
  const int trials = 300;
  int e = 0, mu = 0, beta = 0;
  double bias[3] = {};
  for (int i = 0; i < trials; ++i) {
    const WaltonFit f = fit_walton(impacts(0.9, 0.25, 0.4, 5, 80, 0.02, generator), 0.5);
    e += std::abs(f.restitution - 0.9) <= 1.99 * f.restitution_error ? 1 : 0;
    mu += std::abs(f.tangential.value("mu") - 0.25) <= 1.99 * f.tangential.standard_error("mu") ? 1 : 0;
    beta +=
        std::abs(f.tangential.value("beta_0") - 0.4) <= 1.99 * f.tangential.standard_error("beta_0") ? 1 : 0;
    bias[0] += (f.restitution - 0.9) / trials;
    bias[1] += (f.tangential.value("mu") - 0.25) / trials;
    bias[2] += (f.tangential.value("beta_0") - 0.4) / trials;
  }
  std::cout << "coverage of e_n, mu, beta_0: " << 100.0 * e / trials << ", " << 100.0 * mu / trials << ", "
            << 100.0 * beta / trials << " %; bias " << bias[0] << ", " << bias[1] << ", " << bias[2] << "\n";
  EXPECT_GE(e + mu + beta, 0.93 * 3 * trials);
  EXPECT_LE(e + mu + beta, 0.97 * 3 * trials);
}

TEST(Walton, SaysWhatIsUndetermined) {
  std::mt19937_64 generator(42);
  // All stick: friction is at least what held them, and no more is known.
  const WaltonFit sticking = fit_walton(impacts(0.9, 5, 0.4, 1, 60, 0.01, generator), 0.5);
  EXPECT_NE(std::find(sticking.tangential.undetermined.begin(), sticking.tangential.undetermined.end(), "mu"),
            sticking.tangential.undetermined.end());
  EXPECT_NEAR(sticking.tangential.value("beta_0"), 0.4, 0.02);
  // Spins unknown.
  std::vector<Impact> blind = impacts(0.9, 0.2, 0.4, 4, 60, 0.01, generator);
  for (Impact& i : blind) i.psi_1 = i.psi_2 = std::nan("");
  const WaltonFit f = fit_walton(blind, 0.5);
  EXPECT_FALSE(f.has_tangential);
  EXPECT_NEAR(f.restitution, 0.9, 0.01);
  EXPECT_THROW(fit_walton({}, 0.5), InputError);
}

namespace {

/// A gas of discs without gravity; linear dashpot e_n = 0.9, mu = 0.2. 1/m_t = 6, MODEL's sticking ratio is
/// -beta_0.
MemoryTrajectory gas(int cycles, int phases) {
  const sim::Scene scene = sim::read_scene_text(
      "[cell]\nwidth = 20.0\nheight = 20.0\nlid = \"wall\"\ngravity = 0.0\n[beads]\ncount = "
      "60\n[contact]\nk_n = 1e5\n"
      "restitution = 0.9\nk_t = 28571.0\ngamma_t = 0.0\nmu = 0.2\n[drive]\namplitude = 0.0\nomega = "
      "12.566\n[start]\nkind "
      "= \"random\"\nseed = 3\nvelocity_scale = 2.0\n[time]\ndiscard = 0\ncycles = " +
          std::to_string(cycles) + "\nphases = " + std::to_string(phases) + "\n",
      "gas");
  sim::Simulation run(scene);
  MemoryTrajectory trajectory(run.trajectory_info());
  run.run(trajectory);
  return trajectory;
}

}  // namespace

TEST(Collisions, OfTheSimulatorGiveItsRestitutionAndFriction) {
  const MemoryTrajectory trajectory = gas(60, 20);
  const FoundCollisions found = find_collisions(trajectory, {.gravity = 0, .least_speed = 0.2});
  const WaltonFit f = fit_walton(found.impacts, 0.5);
  std::cout << found.impacts.size() << " impacts, " << found.crowded << " crowded; e_n " << f.restitution
            << " +- " << f.restitution_error << ", mu " << f.tangential.value("mu") << " +- "
            << f.tangential.standard_error("mu") << ", beta_0 " << f.tangential.value("beta_0") << "\n";
  EXPECT_GT(found.impacts.size(), 50U);
  test::validate({"I6.2", "e_n from collisions found in a trajectory", 0.9, 0.003, "closed form of the law"},
                 f.restitution);
  test::validate(
      {"I6.2", "mu from collisions found in a trajectory", 0.2, 0.01, "Coulomb's law of the scene"},
      f.tangential.value("mu"));
}

// t_c is 7e-3 t0, the frames are 1.25e-3 t0 apart: no collision fits between two of them.
TEST(Collisions, LongerThanTheFramesAreApartAreFoundOverSeveral) {
  const MemoryTrajectory trajectory = gas(20, 400);
  EXPECT_LT(find_collisions(trajectory, {.gravity = 0, .least_speed = 0.2, .stride = 1}).impacts.size(), 3U);
  const FoundCollisions found = find_collisions(trajectory, {.gravity = 0, .least_speed = 0.2});
  std::cout << found.impacts.size() << " impacts in every " << found.stride << "th frame\n";
  EXPECT_GE(found.stride, 4U);
  EXPECT_GT(found.impacts.size(), 15U);
  EXPECT_NEAR(fit_walton(found.impacts, 0.5).restitution, 0.9, 0.003);
}

TEST(Inference, IntervalsCoverAndWhatDoesNotMatterIsUndetermined) {
  // A simulator by formula: one observable falls with e, the other too; neither knows mu.
  std::mt19937_64 generator(51);
  std::normal_distribution<double> normal(0, 1);
  const std::vector<Sought> sought = {{"e", 0.6, 0.95}, {"mu", 0, 1}};
  const auto simulate = [&](const std::vector<double>& t) {
    return std::vector<double>{2 - t[0] + 0.02 * normal(generator), t[0] * t[0] + 0.03 * normal(generator)};
  };
  const int trials = 200;
  int covered = 0, open = 0;
  double bias = 0;
  for (int i = 0; i < trials; ++i) {
    std::vector<SimulatedPoint> runs;
    for (const auto& theta : spread_points(sought, 40)) runs.push_back({theta, simulate(theta)});
    const auto y = simulate({0.8, 0.4});
    const Inference f = infer_parameters(sought, runs, {{"a", y[0], 0}, {"b", y[1], 0}});
    covered += f.profiles[0].low <= 0.8 && 0.8 <= f.profiles[0].high ? 1 : 0;
    open += f.profiles[1].undetermined() ? 1 : 0;
    bias += (f.profiles[0].best - 0.8) / trials;
  }
  std::cout << "coverage of e " << 100.0 * covered / trials << " %, bias " << bias << "; mu undetermined in "
            << 100.0 * open / trials << " %\n";
  EXPECT_GE(covered, 0.93 * trials);
  EXPECT_LE(covered, 0.985 * trials);
  EXPECT_GE(open, 0.9 * trials);
  EXPECT_NEAR(bias, 0, 0.005);
  EXPECT_THROW(infer_parameters(sought, {{{0.7, 0.5}, {1, 1}}}, {{"a", 1, 0}, {"b", 1, 0}}), InputError);
}

TEST(Inference, ObservablesThatScatterTogetherCountAsWhatTheyAre) {
  // The second observable is the first with as much noise again of its own: taken for independent, the two
  // would narrow the interval by a third too much.
  std::mt19937_64 generator(52);
  std::normal_distribution<double> normal(0, 1);
  const std::vector<Sought> sought = {{"e", 0.6, 0.95}};
  const auto simulate = [&](const std::vector<double>& t) {
    const double shared = 0.02 * normal(generator);
    return std::vector<double>{2 - t[0] + shared, 3 - t[0] + shared + 0.004 * normal(generator),
                               1 + t[0] + 0.02 * normal(generator)};
  };
  const int trials = 200;
  int covered = 0;
  for (int i = 0; i < trials; ++i) {
    std::vector<SimulatedPoint> runs;
    for (const auto& theta : spread_points(sought, 24)) runs.push_back({theta, simulate(theta)});
    const auto y = simulate({0.8});
    const Inference f = infer_parameters(sought, runs, {{"a", y[0], 0}, {"b", y[1], 0}, {"c", y[2], 0}});
    covered += f.profiles[0].low <= 0.8 && 0.8 <= f.profiles[0].high ? 1 : 0;
  }
  std::cout << "coverage of e " << 100.0 * covered / trials << " %\n";
  EXPECT_GE(covered, 0.93 * trials);
  EXPECT_LE(covered, 0.985 * trials);
}

TEST(Inference, AnOnsetIsTheDriveAtWhichALevelIsCrossed) {
  // y = 4 (G - G_on(e)), G_on = 1 + e: a measured onset of 1.8 +- 0.03 says e = 0.8 +- 0.03, with what runs
  // scatter on top.
  std::mt19937_64 generator(53);
  std::normal_distribution<double> normal(0, 1);
  const std::vector<Sought> sought = {{"e", 0.4, 1.2}};
  const Sought drive{"drive.gamma", 1.5, 2.1};
  const int trials = 200;
  int covered = 0;
  double error = 0, slope = 0;
  for (int i = 0; i < trials; ++i) {
    std::vector<SimulatedPoint> runs;
    for (const auto& p : spread_points({sought[0], drive}, 30))
      runs.push_back({{p[0]}, {4 * (p[1] - 1 - p[0]) + 0.05 * normal(generator)}, {p[1]}});
    const double onset = 1.8 + 0.03 * normal(generator) + 0.05 / 4 * normal(generator);
    const Inference f = infer_parameters(sought, runs, {{"onset", 0, 0, Condition{drive, onset, 0.03}}});
    covered += f.profiles[0].low <= 0.8 && 0.8 <= f.profiles[0].high ? 1 : 0;
    error += f.profiles[0].standard_error / trials;
    slope += f.slope[0] / trials;
  }
  std::cout << "coverage of e " << 100.0 * covered / trials << " %, standard error " << error << "\n";
  // Most of the error is the onset's own, of which no run has any: on the safe side.
  EXPECT_GE(covered, 0.93 * trials);
  EXPECT_LE(error, 1.5 * std::hypot(0.03, 0.05 / 4));
  EXPECT_GE(error, 0.9 * std::hypot(0.03, 0.05 / 4));
  EXPECT_NEAR(slope, 4, 0.05);
}

TEST(Inference, AsFewRunsAsASurfaceNeedsAreEnough) {
  std::vector<SimulatedPoint> runs;
  const std::vector<Sought> sought = {{"e", 0.6, 0.95}};
  for (const auto& theta : spread_points(sought, 5))
    runs.push_back({theta, {2 - theta[0] + 0.001 * std::sin(40 * theta[0])}});
  const Inference f = infer_parameters(sought, runs, {{"a", 1.2, 0}});
  EXPECT_NEAR(f.profiles[0].best, 0.8, 0.01);
  EXPECT_GE(f.profiles[0].drop, 4.30265 * 4.30265 * (1 - 1e-5)) << "Student's t of 2 degrees";
  runs.pop_back();
  EXPECT_THROW(infer_parameters(sought, runs, {{"a", 1.2, 0}}), InputError);
}

TEST(CurveComponents, OfTwoFormsAreTwoNumbers) {
  std::mt19937_64 generator(54);
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::vector<double>> curves;
  const auto curve = [](double a, double b) {
    std::vector<double> c;
    for (int k = 0; k < 20; ++k) c.push_back(3 + a * std::sin(0.314 * k) + b * k / 20.0);
    return c;
  };
  for (int i = 0; i < 12; ++i) curves.push_back(curve(normal(generator), normal(generator)));
  curves.push_back(std::vector<double>(20, std::nan("")));  // a run without a curve
  curves.emplace_back();
  const CurveComponents c = components_of(curves);
  EXPECT_EQ(c.forms.size(), 2U);
  const std::vector<double> other = curve(0.3, -1.2);
  EXPECT_LT(c.misfit(other), 1e-12);
  const std::vector<double> back = c.curve(c.numbers(other));
  for (std::size_t k = 0; k < 20; ++k) EXPECT_NEAR(back[k], other[k], 1e-12);
  std::vector<double> strange = other;
  strange[7] += 1;
  EXPECT_GT(c.misfit(strange), 0.15);
  EXPECT_TRUE(std::isnan(c.numbers(curves[12])[0]));
  EXPECT_THROW(components_of({curves[0], curves[1]}), InputError);
}
