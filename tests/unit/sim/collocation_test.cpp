// The collocation method against known integrals and a known oscillator; its steps are the same in every
// instruction set.

#include "sim/contact/collocation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "sim/contact/stage_polynomial.hpp"
#include "sim/kernels/kernels.hpp"

namespace twincell::sim::collocation_test {
namespace {

constexpr std::size_t kNormal = 0, kSmooth = 0, kRough = 1;  // positions in laws/axes.hpp

double at_moment(const StageMap& map, const double* values, std::size_t moment) {
  double sum = 0;
  for (std::size_t j = 0; j < kStages; ++j) sum += map.column[j][moment] * values[j];
  return sum;
}

TEST(Collocation, PowersAreIntegratedToTheMoments) {
  const Collocation& c = Collocation::numbers();
  for (int power = 0; power < 8; ++power) {
    double values[kStages];
    for (std::size_t k = 0; k < kStages; ++k) values[k] = std::pow(c.moment[k], power);
    for (std::size_t k = 0; k < kStages; ++k) {
      const double n = power, x = c.moment[k];
      EXPECT_NEAR(at_moment(c.once, values, k), std::pow(x, n + 1) / (n + 1), 1e-15);
      // The degree of the result is power + 2. Only at power = 7 does it exceed what eight values can
      // represent.
      if (power < 7) {
        EXPECT_NEAR(at_moment(c.twice, values, k), std::pow(x, n + 2) / ((n + 1) * (n + 2)), 1e-15);
      }
    }
  }
}

TEST(Collocation, TheEndOfAStepIsOfOrderFifteen) {
  const Collocation& c = Collocation::numbers();
  EXPECT_EQ(c.moment[kStages - 1], 1);
  const auto integral = [&](int power) {
    double values[kStages];
    for (std::size_t k = 0; k < kStages; ++k) values[k] = std::pow(c.moment[k], power);
    return at_moment(c.once, values, kStages - 1);
  };
  for (int power = 8; power <= 14; ++power) EXPECT_NEAR(integral(power), 1.0 / (power + 1), 1e-15) << power;
  // For x^15 the quadrature rule is too large by (7! 8!)^2/(15! 16!): the P_7 component of x^7 on [0, 1],
  // over the leading coefficient of P_8.
  EXPECT_NEAR(integral(15) - 1.0 / 16, 25401600 / 1307674368e3 / 12870, 1e-14);
}

TEST(Collocation, TheLastCoefficientsAreThoseOfLegendre) {
  const Collocation& c = Collocation::numbers();
  // x^7 and x^6 on [0, 1] have the leading Legendre coefficients 7!^2/14! and 6!^2/12!.
  double sevenths[kStages], sixths[kStages];
  for (std::size_t k = 0; k < kStages; ++k)
    sevenths[k] = std::pow(c.moment[k], 7), sixths[k] = std::pow(c.moment[k], 6);
  const auto sum = [&](const double* last, const double* values) {
    double all = 0;
    for (std::size_t k = 0; k < kStages; ++k) all += last[k] * values[k];
    return all;
  };
  EXPECT_NEAR(sum(c.last[1], sevenths), 1.0 / 3432, 1e-15);
  EXPECT_NEAR(sum(c.last[0], sixths), 1.0 / 924, 1e-15);
  EXPECT_NEAR(sum(c.last[1], sixths), 0, 1e-15);
}

TEST(Collocation, PolynomialsOfDegreeEightAreKnownEverywhere) {
  const Collocation& c = Collocation::numbers();
  const auto p = [](double x) { return 2 - x + 3 * std::pow(x, 5) - std::pow(x, 8); };
  const auto slope = [](double x) { return -1 + 15 * std::pow(x, 4) - 8 * std::pow(x, 7); };
  double values[kStages];
  for (std::size_t k = 0; k < kStages; ++k) values[k] = p(c.moment[k]);
  for (const double x : {0.001, 0.3, 0.77, 0.999}) {
    const StagePolynomials at(c, x);
    EXPECT_NEAR(at.value(p(0), values), p(x), 1e-14) << x;
    EXPECT_NEAR(at.slope(p(0), values, at.value(p(0), values)), slope(x), 1e-11) << x;
  }
  for (const double x : {0.0, c.moment[3], 1.0})
    EXPECT_NEAR(StagePolynomials(c, x).value(p(0), values), p(x), 1e-15) << x;
}

/// A bead that hits a wall head-on: a damped oscillator that starts at its rest length.
class HeadOn {
 public:
  static constexpr double kStiffness = 3, kDamping = 0.4, kMass = 0.7, kReach = 0.5, kSpeed = 1.3;

  CollocationMotion stepped(const Target& target, double h, bool put_in) {
    start_.h = h;
    const Collocation& c = Collocation::numbers();
    const double width = std::sqrt(kStiffness / kMass) * h * Collocation::kWidths / Collocation::kWidest;
    start_.response = put_in ? &c.response[std::lround(width)] : nullptr;
    CollocationMotion m{};
    target.find_step(kNormal, kSmooth, 2)(start_, m);
    return m;
  }
  /// Overlap and its rate of change at time `t`.
  static std::pair<double, double> exact(double t) {
    const double decay = kDamping / (2 * kMass), w = std::sqrt(kStiffness / kMass - decay * decay);
    const double shrunk = std::exp(-decay * t);
    return {kSpeed / w * shrunk * std::sin(w * t),
            kSpeed * shrunk * (std::cos(w * t) - decay / w * std::sin(w * t))};
  }

 private:
  double law_[2] = {kStiffness, kDamping}, none_[1] = {}, wall_[2] = {0, 1},
         numbers_[4] = {0.2, kReach, 0.1, -kSpeed}, slopes_[2] = {0, kDamping*kSpeed / kMass},
         normal_[2] = {0, 1};
  CollocationStart start_{.normal_law = law_,
                          .tangential_law = none_,
                          .reach = kReach,
                          .inv_mass = 1 / kMass,
                          .turn = 0,
                          .h = 0,
                          .damping = kDamping / kMass,
                          .wall = wall_,
                          .push = nullptr,
                          .pressed = true,
                          .slides = false,
                          .numbers = numbers_,
                          .slopes = slopes_,
                          .normal = normal_,
                          .enough = 1e-15,
                          .method = &Collocation::numbers(),
                          .response = nullptr};
};

TEST(Collocation, ADampedOscillatorIsFollowed) {
  for (const double h : {0.1, 0.8})
    for (const bool put_in : {false, true}) {
      const CollocationMotion m = HeadOn().stepped(kScalar, h, put_in);
      EXPECT_LE(m.change, 1e-15);
      for (std::size_t k = 0; k < kStages; ++k) {
        const auto [overlap, speed] = HeadOn::exact(h * Collocation::numbers().moment[k]);
        // Eight stages represent the motion inside a step up to the eighth power of (omega h)/2; the end of
        // the step is more accurate.
        const double off = k + 1 == kStages ? 1e-13 : 1e-8;
        EXPECT_NEAR(m.overlap[k], overlap, off);
        EXPECT_NEAR(-m.numbers[3][k], speed, off);
        EXPECT_NEAR(m.numbers[0][k], 0.2 + 0.1 * h * Collocation::numbers().moment[k], 1e-15);
      }
    }
}

TEST(Collocation, StepsHaveTheSameBitsOnEveryVectorUnit) {
  constexpr std::size_t kBytes = offsetof(CollocationMotion, change) + sizeof(double);
  const double normal_law[2] = {1e6, 400}, tangential_law[2] = {-300, 0.3};
  const double normal[3] = {0.6, 0, 0.8}, slopes[6] = {10, 3, -20, 0.5, -7, 2},
               push[3 * kStages] = {1, 2, -3, 0.5};
  const double numbers[9] = {0.59, 0.001, 0.79, -1, 0.3, -2, 0.1, -0.2, 0.4};
  for (const bool wall : {false, true})
    for (const bool slides : {false, true})
      for (const bool pressed : {false, true}) {
        CollocationStart a{};
        a.normal_law = normal_law, a.tangential_law = tangential_law;
        a.reach = 1, a.inv_mass = 2, a.turn = 10, a.h = 8e-4, a.damping = 800;
        a.wall = wall ? normal : nullptr, a.push = wall ? push : nullptr;
        a.pressed = pressed, a.slides = slides;
        a.numbers = numbers, a.slopes = slopes, a.normal = normal, a.enough = 1e-12;
        a.method = &Collocation::numbers(), a.response = &a.method->response[10];
        CollocationMotion scalar{};
        kScalar.find_step(kNormal, kRough, 3)(a, scalar);
        EXPECT_TRUE(std::isfinite(scalar.numbers[8][kStages - 1]));
        for (const Target* target : {&kAvx2, &kAvx512}) {
          if (!target->available()) continue;
          CollocationMotion m{};
          target->find_step(kNormal, kRough, 3)(a, m);
          EXPECT_EQ(std::memcmp(&m, &scalar, kBytes), 0) << target->name << " " << wall << slides << pressed;
        }
      }
}

}  // namespace
}  // namespace twincell::sim::collocation_test
