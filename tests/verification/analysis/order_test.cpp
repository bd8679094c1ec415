// V5.1, V5.2: q6, psi6, psi4 of exact neighbourhoods (closed forms of the planar Steinhardt parameter), and
// their invariances.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "analysis/order/bond_order.hpp"
#include "tests/support/validation.hpp"

namespace twincell::order_test {

using namespace analysis;

namespace {

constexpr double kPi = std::numbers::pi;

/// Bead 0 at the origin with neighbours at unit distance in the directions `angles`.
Frame star(const std::vector<double>& angles) {
  Frame frame;
  frame.position.emplace_back(0, 0, 0);
  for (const double phi : angles) frame.position.emplace_back(std::cos(phi), 0, std::sin(phi));
  return frame;
}

Box open_box() {
  Box box;
  box.boundary = {Boundary::open, Boundary::open, Boundary::open};
  return box;
}

BondOrder order_of(const Frame& frame, double cutoff = 1.1) {
  return bond_order(find_neighbours(frame, open_box(), cutoff));
}

std::vector<double> every(double step_degrees, int n) {
  std::vector<double> angles;
  for (int i = 0; i < n; ++i) angles.push_back(step_degrees * i * kPi / 180);
  return angles;
}

/// Weights as exact fractions: a_m = 4 pi/13 |Y_6m(pi/2)|^2 = 105/1024, 126/1024, 231/1024; (5/16)^2 for m =
/// 0.
double q6_from(double psi2, double psi4, double psi6) {
  return std::sqrt(25.0 / 256 + 2 * (105 * psi2 * psi2 + 126 * psi4 * psi4 + 231 * psi6 * psi6) / 1024);
}

struct Case {
  const char* name;
  std::vector<double> angles;
  double q6, psi6, psi4;
};

}  // namespace

TEST(BondOrder, TableOfNeighbourhoods) {
  const std::vector<Case> cases = {
      {"hexagonal", every(60, 6), q6_from(0, 0, 1), 1, 0},
      {"hexagonal, 5 of 6", every(60, 5), q6_from(0.2, 0.2, 1), 1, 0.2},
      {"hexagonal, 4 of 6", every(60, 4), q6_from(0.25, 0.25, 1), 1, 0.25},
      {"square", every(90, 4), q6_from(0, 1, 0), 0, 1},
      {"8 directions", every(45, 8), 0.3125, 0, 0},
      {"12 directions", every(30, 12), 0.3125, 0, 0},
      {"5-fold", every(72, 5), 0.3125, 0, 0},
      {"2 opposite", every(180, 2), 1, 1, 1},
  };
  // Values printed in the literature to five digits, as a check that is independent of the weights above.
  const std::vector<double> five_digits = {0.74083, 0.75291, 0.75962, 0.58630,
                                           0.31250, 0.31250, 0.31250, 1.00000};
  for (std::size_t c = 0; c < cases.size(); ++c) {
    // The cut-off is smaller than the gap between the neighbours of 12 directions, so only the centre's bonds
    // count.
    const BondOrder order = order_of(star(cases[c].angles), 1.0 + 1e-9);
    EXPECT_EQ(order.n_bonds[0], cases[c].angles.size()) << cases[c].name;
    test::validate(
        {"V5.1", std::string("q6, ") + cases[c].name, cases[c].q6, 1e-12, "Steinhardt et al. 1983"},
        order.q6[0]);
    EXPECT_NEAR(order.psi6[0], cases[c].psi6, 1e-12) << cases[c].name;
    EXPECT_NEAR(order.psi4[0], cases[c].psi4, 1e-12) << cases[c].name;
    EXPECT_NEAR(order.q6[0], five_digits[c], 5.1e-6) << cases[c].name;
  }
}

TEST(BondOrder, FewerThanTwoNeighboursHaveNoValue) {
  const BondOrder lone = order_of(star({}));
  EXPECT_TRUE(std::isnan(lone.q6[0]));
  const BondOrder pair = order_of(star({0.3}));
  EXPECT_EQ(pair.n_bonds[0], 1U);
  EXPECT_TRUE(std::isnan(pair.q6[0]) && std::isnan(pair.psi6[0]) && std::isnan(pair.psi4[0]));
  EXPECT_EQ(structure_of(pair, 0), Structure::undefined);
}

TEST(BondOrder, RandomDirectionsHaveTheRmsOfIndependentBonds) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> angle(0, 2 * kPi);
  for (const int n : {4, 6}) {
    const int samples = 40000;
    double sum = 0;
    for (int s = 0; s < samples; ++s) {
      std::vector<double> angles;
      for (int b = 0; b < n; ++b) angles.push_back(angle(generator));
      Neighbours one;
      one.first = {0, static_cast<std::size_t>(n)};
      for (const double phi : angles) {
        one.index.push_back(0);
        one.bond.emplace_back(std::cos(phi), 0, std::sin(phi));
      }
      const double q6 = bond_order(one).q6[0];
      sum += q6 * q6;
    }
    const double expected = std::sqrt(25.0 / 256 + 231.0 / 256 / n);
    test::validate(
        {"V5.1", "rms q6 of " + std::to_string(n) + " random bonds", expected, 0.004, "closed form"},
        std::sqrt(sum / samples));
  }
}

TEST(BondOrder, InvariantUnderRotationMirrorAndScale) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> place(0, 8);
  Frame frame;
  for (int i = 0; i < 120; ++i) frame.position.emplace_back(place(generator), 0, place(generator));
  const BondOrder before = order_of(frame, 1.2);
  double worst = 0;
  const auto compare = [&](const Frame& moved, double cutoff, const char* what) {
    const BondOrder after = order_of(moved, cutoff);
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      ASSERT_EQ(after.n_bonds[i], before.n_bonds[i]) << what;
      if (std::isnan(before.q6[i])) {
        EXPECT_TRUE(std::isnan(after.q6[i])) << what;
        continue;
      }
      EXPECT_NEAR(after.q6[i], before.q6[i], 1e-12) << what;
      EXPECT_NEAR(after.psi6[i], before.psi6[i], 1e-12) << what;
      worst = std::max(worst, std::abs(after.q6[i] - before.q6[i]));
    }
  };
  Frame rotated = frame, mirrored = frame, scaled = frame;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    const Vec3 r = frame.position[i];
    rotated.position[i] =
        Vec3(r.x() * std::cos(0.7) - r.z() * std::sin(0.7), 0, r.x() * std::sin(0.7) + r.z() * std::cos(0.7));
    mirrored.position[i] = Vec3(-r.x(), 0, r.z());
    scaled.position[i] = 3.7 * r;
  }
  compare(rotated, 1.2, "rotation");
  compare(mirrored, 1.2, "mirror");
  compare(scaled, 3.7 * 1.2, "scale");
  test::validate({"V5.2", "largest change of q6 under rotation, mirror, scale", 0, 1e-12, "symmetry"}, worst);
}

TEST(BondOrder, StructuresOfPerfectLattices) {
  Frame hexagonal, square;
  for (int row = 0; row < 7; ++row)
    for (int c = 0; c < 7; ++c) {
      hexagonal.position.emplace_back(c + 0.5 * (row % 2), 0, row * std::sqrt(3.0) / 2);
      square.position.emplace_back(c, 0, row);
    }
  const std::size_t centre = 3 * 7 + 3;
  EXPECT_EQ(structure_of(order_of(hexagonal, 1.2), centre), Structure::hexagonal);
  EXPECT_EQ(structure_of(order_of(square, 1.2), centre), Structure::square);
  EXPECT_EQ(structure_of(order_of(square, 1.5), centre), Structure::other);  // diagonals within the cut-off
}

}  // namespace twincell::order_test
