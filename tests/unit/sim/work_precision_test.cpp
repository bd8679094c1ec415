// The measurement of errors and run times of integration steps: against errors found by an independent
// program, theoretical orders, closed forms, and choices made by hand.

#include "sim/accuracy/work_precision.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "sim/laws/linear_collision.hpp"

namespace twincell::sim::work_precision_test {
namespace {

/// Exponent p of error ~ n^-p, from two values of n.
template <class Error>
double order(const std::string& integrator, double few, double many, const Error& error) {
  const auto at = [&](double n) { return error(collision_errors({.integrator = integrator, .n = n})); };
  return std::log(at(few) / at(many)) / std::log(many / few);
}

double head_on(const CollisionErrors& e) {
  return e.restitution();
}
double oblique(const CollisionErrors& e) {
  return e.sticking();
}

TEST(CollisionErrors, VerletErrorsAgreeWithAnIndependentProgram) {
  // Two beads of Table I, Fortini & Huang 2015, by velocity Verlet with half-step velocities in Python.
  struct Row {
    double n, rms, largest;
  };
  for (const Row& row :
       {Row{10.37, 9.8e-3, 2.2e-2}, Row{20.37, 4.6e-3, 9.2e-3}, Row{50.37, 1.8e-3, 3.2e-3},
        Row{100.37, 9.2e-4, 1.5e-3}, Row{200.37, 4.6e-4, 7.3e-4}, Row{400.37, 2.3e-4, 3.6e-4}}) {
    const EntryPhaseSpread e = collision_errors({.n = row.n}).restitution_pair;
    std::printf("verlet, n = %g: rms error of e %.2e (%.1e), largest %.2e (%.1e)\n", row.n, e.rms, row.rms,
                e.largest, row.largest);
    EXPECT_NEAR(e.rms, row.rms, 0.05 * row.rms);
    EXPECT_NEAR(e.largest, row.largest, 0.05 * row.largest);
    EXPECT_LE(std::abs(e.mean), 3e-4);
  }
}

TEST(CollisionErrors, OrdersAreThoseOfTheIntegrators) {
  // The force jumps where a damped contact begins and ends: first order, unless the step is split there.
  const double verlet = order("verlet", 20.37, 400.37, head_on),
               predicted = order("predicted", 20.37, 400.37, head_on),
               split = order("split", 8.37, 30.37, head_on),
               verlet_oblique = order("verlet", 20.37, 400.37, oblique),
               split_oblique = order("split", 8.37, 100.37, oblique);
  std::printf("orders, head-on: verlet %.2f, predicted %.2f, split %.2f; oblique: verlet %.2f, split %.2f\n",
              verlet, predicted, split, verlet_oblique, split_oblique);
  EXPECT_NEAR(verlet, 1, 0.15);
  EXPECT_NEAR(predicted, 1, 0.15);
  EXPECT_NEAR(verlet_oblique, 1, 0.15);
  EXPECT_NEAR(split_oblique, 2, 0.1);
  // Head-on, contributions of second order cancel partly for these laws: the order is between two and three.
  EXPECT_GE(split, 1.9);
  EXPECT_LE(split, 3.1);
}

TEST(CollisionErrors, AreTheSameForEveryStiffness) {
  for (const std::string integrator : {"verlet", "split"}) {
    const CollisionErrors soft = collision_errors({.integrator = integrator, .n = 10.37, .k_n = 1e5}),
                          hard = collision_errors({.integrator = integrator, .n = 10.37, .k_n = 1e7});
    EXPECT_NEAR(soft.restitution() / hard.restitution(), 1, 0.05) << integrator;
    EXPECT_NEAR(soft.sticking() / hard.sticking(), 1, 0.05) << integrator;
  }
}

TEST(StickingRatio, ClosedForms) {
  // Bead on plate and two beads of Table I: a = 150, Omega = 86.6025 and 193.649.
  EXPECT_NEAR(sticking_ratio(1e4, 100, 3, 3.145527e-3), 0.310127, 1e-6);
  EXPECT_NEAR(sticking_ratio(1e4, 50, 6, 2.222831e-3), 0.419530, 1e-6);
  // Undamped, k_t/k_n = m_t/m_eff reverses the surface velocity: a disc on a plate, t_c = pi/sqrt(k_n).
  EXPECT_NEAR(sticking_ratio(1e6 / 3, 0, 3, std::acos(-1.0) * 1e-3), -1, 1e-12);
  // With a dashpot alone: exp(-c t_c/m_t).
  EXPECT_NEAR(sticking_ratio(0, 100, 3, 2e-3), std::exp(-0.6), 1e-12);
}

TEST(BedErrors, BedsRestAtTheFewestSteps) {
  for (const std::string integrator : {"verlet", "predicted", "split"})
    for (const double n : {6.0, 6.37, 14.37}) {
      const BedErrors e = bed_errors({.integrator = integrator, .n = n});
      std::printf("%s, n = %g: %.1e m g sigma a bead, floor %.1e, overlaps %.1e\n", integrator.c_str(), n,
                  e.kinetic_energy, e.floor_force, e.overlap);
      EXPECT_LE(e.kinetic_energy, 1e-20);
      EXPECT_LE(e.floor_force, 1e-8);
      EXPECT_LE(e.overlap, 1e-8);
      EXPECT_GT(e.overlap, 1e-13);  // the column has really been evaluated: it never rests to the last bit
    }
}

TEST(GasTemperature, IsThatOfTheGasWhateverTheStep) {
  const GasTemperature fine = gas_temperature({.n = 50.37}, {}, 200),
                       coarse = gas_temperature({.integrator = "split", .n = 6.37}, {}, 200);
  const double both = std::hypot(fine.standard_error, coarse.standard_error);
  std::printf("T_z = %.4f +- %.4f and %.4f +- %.4f\n", fine.value, fine.standard_error, coarse.value,
              coarse.standard_error);
  EXPECT_EQ(fine.periods, 200);
  EXPECT_NEAR(fine.value, coarse.value, 4 * both);
  // Smallest plausible error for ten blocks of twenty periods of forty beads.
  EXPECT_GT(both, 0.005 * fine.value);
  EXPECT_LT(both, 0.10 * fine.value);
  EXPECT_NEAR(fine.seconds_to(0.5 * fine.standard_error / fine.value), 4 * fine.seconds, 1e-9 * fine.seconds);
}

TEST(StepCosts, KnowTheirSteps) {
  const auto costs =
      step_costs({{.n = 10.37}, {.integrator = "split", .n = 40.37}, {.n = 10.37, .k_n = 1e5}}, 1);
  ASSERT_EQ(costs.size(), 3U);
  EXPECT_NEAR(costs[0].contact_time, 2.222831e-3, 1e-9);
  EXPECT_NEAR(costs[2].contact_time, 7.029209e-3, 1e-8);
  EXPECT_NEAR(costs[0].contact_time / costs[0].dt, 10.37, 0.02);
  EXPECT_NEAR(costs[1].contact_time / costs[1].dt, 40.37, 0.02);
  EXPECT_NEAR(costs[2].contact_time / costs[2].dt, 10.37, 0.02);
  for (const StepCost& cost : costs) EXPECT_GT(cost.seconds_per_time, 0);
}

WorkPrecision made_up(const std::string& integrator, double n, double error, double seconds,
                      double k_n = 1e6) {
  WorkPrecision w;
  w.setting = {.integrator = integrator, .n = n, .k_n = k_n};
  w.collision.restitution_pair = {.mean = error / 10, .rms = error / 2, .largest = error};
  w.collision.sticking_wall = {.mean = error / 10, .rms = error / 2, .largest = error};
  w.cost.seconds_per_time = seconds;
  return w;
}

TEST(WorkPrecision, CheapestPassesWithAllLargerNumbersOfSteps) {
  const std::vector<WorkPrecision> all = {
      made_up("verlet", 10, 2e-4, 1),  // accurate by chance: the error with 20 steps is larger
      made_up("verlet", 20, 5e-3, 2), made_up("verlet", 50, 1e-3, 5),     made_up("split", 10, 9e-4, 3),
      made_up("split", 20, 1e-5, 4),  made_up("split", 5, 1e-6, 0.1, 1e5)};  // different stiffness
  EXPECT_EQ(cheapest(all, 1e6, 1e-3)->setting, all[3].setting);
  EXPECT_EQ(cheapest(all, 1e6, 1e-4)->setting, all[4].setting);
  EXPECT_EQ(cheapest(all, 1e6, 1e-2)->setting, all[0].setting);
  EXPECT_FALSE(cheapest(all, 1e6, 1e-7));
  EXPECT_EQ(equal_accuracy(all, all[2]).setting, all[3].setting);
  const auto best = front(all, 1e6);
  ASSERT_EQ(best.size(), 2U);
  EXPECT_EQ(best[0].setting, all[0].setting);
  EXPECT_EQ(best[1].setting, all[4].setting);
}

TEST(WorkPrecision, EqualAccuracyIsOfEverythingMeasured) {
  const WorkPrecision reference = made_up("verlet", 50, 1e-3, 5);
  const WorkPrecision good = made_up("split", 10, 9e-4, 1);
  EXPECT_EQ(equal_accuracy({reference, good}, reference).setting, good.setting);
  const auto expect_refused = [&](const WorkPrecision& w, const char* what) {
    EXPECT_EQ(equal_accuracy({reference, w}, reference).setting, reference.setting) << what;
  };
  WorkPrecision w = good;
  w.collision.restitution_wall.largest = 2e-3;
  expect_refused(w, "bead on the plate");
  w = good;
  w.collision.sticking_pair.rms = 2e-3;
  expect_refused(w, "oblique");
  w = good;
  w.bed.floor_force = 1e-3;
  expect_refused(w, "bed");
  w = good;
  w.cost.seconds_per_time = 6;
  expect_refused(w, "more expensive");
  w = good;
  w.collision.restitution_pair.mean = -2e-4;
  EXPECT_EQ(equal_accuracy({reference, w}, reference).setting, w.setting);
  EXPECT_EQ(equal_accuracy({reference, w}, reference, true).setting, reference.setting);
}

}  // namespace
}  // namespace twincell::sim::work_precision_test
