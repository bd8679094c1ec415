#include "imaging/find/lattice_constant.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "imaging/benchmark/packing.hpp"
#include "imaging/benchmark/picture.hpp"
#include "tests/support/hexagonal_sites.hpp"

namespace twincell::lattice_constant_test {

using namespace imaging;

namespace {

cv::Mat1b exposed(const rendered::Picture& p) {
  return rendered::expose(rendered::expected(p), p, 51, 1);
}

rendered::Picture empty() {
  rendered::Picture p;
  p.width = 300, p.height = 260;
  return p;
}

// Discs of that diameter on a hexagonal lattice that fills the picture.
cv::Mat1b crystal(double constant, double diameter, double turned) {
  rendered::Picture p = empty();
  for (const cv::Point2d& site :
       hexagonal_sites(constant, turned, static_cast<int>(2 * p.width / constant))) {
    rendered::Disc d;
    d.x = 150 + site.x, d.y = 130 + site.y;
    d.radius = 0.5 * diameter;
    if (d.x > -constant && d.y > -constant && d.x < p.width + constant && d.y < p.height + constant)
      p.discs.push_back(d);
  }
  return exposed(p);
}

}  // namespace

TEST(LatticeConstant, CrystalsToOnePixel) {
  for (const double constant : {8.0, 10.0, 12.5, 15.0, 20.0, 25.0})
    for (const double turned : {0.0, 0.1, 0.3})
      EXPECT_NEAR(lattice_constant(crystal(constant, constant, turned)), constant, 0.75)
          << constant << " px, turned by " << turned;
}

// The bright gaps are closer together than the discs by a factor of the square root of 3.
TEST(LatticeConstant, LightGapsDoNotPassForDiscs) {
  EXPECT_NEAR(lattice_constant(crystal(16, 15, 0.2)), 16, 0.75);
}

TEST(LatticeConstant, NoneWhereThereIsNoCrystal) {
  std::mt19937_64 random(3);
  const cv::Rect2d room(6, 6, 288, 248);
  rendered::Picture apart = empty(), touching = empty();
  apart.discs = rendered::sparse(std::vector<double>(80, 7.5), room, random);
  touching.discs = rendered::deposited(std::vector<double>(280, 7.5), room, random);
  EXPECT_EQ(lattice_constant(exposed(apart)), 0);
  EXPECT_EQ(lattice_constant(exposed(touching)), 0);
  EXPECT_EQ(lattice_constant(exposed(empty())), 0);
  for (const int side : {1, 2, 7, 12})
    EXPECT_EQ(lattice_constant(cv::Mat1b(side, 3 * side, uchar{9})), 0) << side;
}

}  // namespace twincell::lattice_constant_test
