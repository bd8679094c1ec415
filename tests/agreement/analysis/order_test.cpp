// The planar q6 against a direct evaluation of Steinhardt's definition in three dimensions, over all pairs
// and with a different polar axis.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "analysis/order/bond_order.hpp"

namespace twincell::order_test {

using namespace analysis;

namespace {

struct Slow {
  std::vector<std::size_t> n;
  std::vector<double> q6, psi6;
};

/// q_6 = sqrt(4 pi/13 sum_m |mean Y_6m|^2), with the polar axis along z, which is in the plane of the beads.
Slow slow_order(const Frame& frame, const Box& box, double cutoff) {
  Slow slow;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    std::vector<std::complex<double>> y(7, 0);
    std::complex<double> e6 = 0;
    std::size_t n = 0;
    for (std::size_t j = 0; j < frame.position.size(); ++j) {
      if (j == i || !frame.present(i) || !frame.present(j)) continue;
      Vec3 d = frame.position[j] - frame.position[i];
      for (int a = 0; a < 3; ++a) {  // explicit minimum image
        if (box.boundary[static_cast<std::size_t>(a)] != Boundary::periodic) continue;
        const double period = box.upper[a] - box.lower[a];
        while (d[a] > period / 2) d[a] -= period;
        while (d[a] < -period / 2) d[a] += period;
      }
      if (d.norm() > cutoff) continue;
      ++n;
      const double theta = std::acos(std::clamp(d.z() / d.norm(), -1.0, 1.0));
      const double azimuth = std::atan2(d.y(), d.x());
      for (unsigned m = 0; m <= 6; ++m) y[m] += std::sph_legendre(6, m, theta) * std::polar(1.0, m * azimuth);
      e6 += std::polar(1.0, 6 * std::atan2(d.z(), d.x()));
    }
    slow.n.push_back(n);
    double sum = std::norm(y[0]);
    for (unsigned m = 1; m <= 6; ++m) sum += 2 * std::norm(y[m]);
    slow.q6.push_back(std::sqrt(4 * std::numbers::pi / 13 * sum) / static_cast<double>(n));
    slow.psi6.push_back(std::abs(e6) / static_cast<double>(n));
  }
  return slow;
}

Frame random_beads(std::size_t n, double width, double height, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> x(0, width), z(0, height);
  Frame frame;
  for (std::size_t i = 0; i < n; ++i) frame.position.emplace_back(x(generator), 0, z(generator));
  return frame;
}

void expect_same(const Frame& frame, const Box& box, double cutoff) {
  const Slow slow = slow_order(frame, box, cutoff);
  const BondOrder fast = bond_order(find_neighbours(frame, box, cutoff));
  double worst = 0;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    ASSERT_EQ(fast.n_bonds[i], slow.n[i]) << "bead " << i;
    if (slow.n[i] < 2) continue;
    EXPECT_NEAR(fast.q6[i], slow.q6[i], 1e-12);
    EXPECT_NEAR(fast.psi6[i], slow.psi6[i], 1e-12);
    worst = std::max(worst, std::abs(fast.q6[i] - slow.q6[i]));
  }
  std::cout << "largest difference of q6: " << worst << '\n';
}

}  // namespace

TEST(OrderAgreement, OpenBox) {
  Box box;
  box.upper = Vec3(20, 1, 20);
  expect_same(random_beads(500, 20, 20, 1), box, 1.2);
}

TEST(OrderAgreement, PeriodicBoxWithBeadsManyPeriodsAway) {
  Box box;
  box.upper = Vec3(10, 1, 20);
  box.boundary[0] = Boundary::periodic;
  Frame frame = random_beads(300, 10, 20, 2);
  for (std::size_t i = 0; i < frame.position.size(); i += 3)
    frame.position[i].x() += 10.0 * (static_cast<double>(i % 7) - 3);
  expect_same(frame, box, 1.2);
}

TEST(OrderAgreement, PeriodTooNarrowForThreeCells) {
  Box box;
  box.upper = Vec3(3, 1, 20);
  box.boundary[0] = Boundary::periodic;
  expect_same(random_beads(80, 3, 20, 3), box, 1.3);
}

TEST(OrderAgreement, EmptySlotsAndAHighFlyer) {
  Box box;
  box.upper = Vec3(10, 1, 20);
  Frame frame = random_beads(200, 10, 20, 4);
  for (std::size_t i = 0; i < frame.position.size(); ++i) frame.id.push_back(static_cast<std::int64_t>(i));
  for (std::size_t i = 0; i < frame.position.size(); i += 5) {
    frame.id[i] = -1;
    frame.position[i] = Vec3::Constant(std::nan(""));
  }
  frame.position[1] = Vec3(3, 0, 1e9);  // beyond the last cell
  frame.position[2] = Vec3(3, 0, 1e9 + 0.5);
  frame.position[3] = Vec3(3, 0, 1e9 - 0.5);
  expect_same(frame, box, 1.2);
}

TEST(OrderAgreement, RelabellingShiftAndWrapChangeNothing) {
  Box box;
  box.upper = Vec3(10, 1, 20);
  box.boundary[0] = Boundary::periodic;
  const Frame frame = random_beads(300, 10, 20, 5);
  const BondOrder before = bond_order(find_neighbours(frame, box, 1.2));
  Frame reversed;
  reversed.position.assign(frame.position.rbegin(), frame.position.rend());
  Frame shifted = frame;
  for (Vec3& r : shifted.position) r += Vec3(1234.25, 0, 0);
  Frame wrapped = shifted;
  for (Vec3& r : wrapped.position) r = box.wrap(r);
  const BondOrder relabelled = bond_order(find_neighbours(reversed, box, 1.2));
  const BondOrder moved = bond_order(find_neighbours(shifted, box, 1.2));
  const BondOrder folded = bond_order(find_neighbours(wrapped, box, 1.2));
  const std::size_t n = frame.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(relabelled.n_bonds[n - 1 - i], before.n_bonds[i]);
    ASSERT_EQ(moved.n_bonds[i], before.n_bonds[i]);
    ASSERT_EQ(folded.n_bonds[i], before.n_bonds[i]);
    if (before.n_bonds[i] < 2) continue;
    EXPECT_NEAR(relabelled.q6[n - 1 - i], before.q6[i], 1e-12);
    EXPECT_NEAR(moved.q6[i], before.q6[i], 1e-9);  // positions near 1234 resolve 1e-13 of a bond
    EXPECT_NEAR(folded.q6[i], before.q6[i], 1e-9);
  }
}

TEST(Neighbours, ATieAtTheCutoffCounts) {
  Box box;
  Frame frame;
  frame.position = {Vec3(0, 0, 0), Vec3(1.25, 0, 0)};
  EXPECT_EQ(find_neighbours(frame, box, 1.25).count(0), 1U);
  EXPECT_EQ(find_neighbours(frame, box, 1.25).count(1), 1U);
  EXPECT_EQ(find_neighbours(frame, box, std::nextafter(1.25, 1.0)).count(0), 0U);
}

}  // namespace twincell::order_test
