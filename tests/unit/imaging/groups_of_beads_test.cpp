// Groups of beads that were not located have round outlines, as larger discs have.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "imaging/settings/larger_discs.hpp"
#include "tests/zoo/imaging/painter.hpp"

namespace twincell::imaging::groups_of_beads_test {
namespace {

using Shade = std::function<double(double u, double v, double below)>;

/// Light of a sphere under a lamp at the upper left.
double lit(double u, double v) {
  return std::max(0.0, -0.35 * u - 0.35 * v + 0.87 * std::sqrt(std::max(0.0, 1 - u * u - v * v)));
}

struct Look {
  double ground;
  Shade shade;
};
const std::map<std::string, Look> kLooks = {
    {"steel",
     {40,
      [](double u, double v, double) {
        return 75 + 65 * lit(u, v) + 150 * std::exp(-((u + 0.3) * (u + 0.3) + (v + 0.3) * (v + 0.3)) / 0.03);
      }}},
    {"matt", {40, [](double u, double v, double) { return 60 + 120 * lit(u, v); }}},
    {"clear",
     {170, [](double u, double v, double below) { return below * (std::hypot(u, v) < 0.45 ? 1.2 : 0.3); }}}};

/// The beads of a triangular crystal that are located, and the picture: around an empty ring, the middle is
/// either a group of beads that are not located or a disc of the same look.
struct Scene {
  cv::Mat1b picture;
  std::vector<Detection> located;
};
Scene scene(const Look& look, double diameter, double radius, bool group) {
  const int side = static_cast<int>(22 * diameter);
  const double middle = 0.5 * side;
  zoo::Painter canvas(side, look.ground);
  Scene made;
  if (!group) canvas.disc(middle, middle, radius * diameter, look.shade);
  for (int row = -12; row < 12; ++row)
    for (int k = -14; k < 14; ++k) {
      const double u = k + 0.5 * (row & 1), v = 0.8660254 * row, r = std::hypot(u, v);
      Detection b;
      b.x = middle + u * diameter, b.y = middle + v * diameter, b.radius = 0.5 * diameter;
      if (std::min(b.x, b.y) < diameter || std::max(b.x, b.y) > side - diameter) continue;
      const bool in_group = group && r<radius, around = r> radius + 0.9 && (row % 2 == 0 || k % 2 == 0);
      if (!in_group && !around) continue;
      canvas.disc(b.x, b.y, b.radius, look.shade);
      if (around) made.located.push_back(b);
    }
  made.picture = canvas.exposed(0.7, 3, 3);
  return made;
}

// Before, larger discs were found in most of these groups.
TEST(LargerDiscs, GroupsOfBeadsAreNone) {
  for (const auto& [name, look] : kLooks)
    for (const double diameter : {10.0, 14.0})
      for (const double radius : {1.1, 1.8, 2.8}) {
        const Scene made = scene(look, diameter, radius, true);
        EXPECT_TRUE(larger_discs(made.picture, made.located, diameter).empty())
            << name << ' ' << diameter << " px, " << radius;
      }
}

TEST(LargerDiscs, DiscsThatLookLikeTheBeadsAreFound) {
  for (const auto& [name, look] : kLooks)
    for (const double diameter : {10.0, 14.0})
      for (const double radius : {1.3, 2.5}) {
        const Scene made = scene(look, diameter, radius, false);
        const std::vector<LargerDisc> found = larger_discs(made.picture, made.located, diameter);
        EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                                [&, radius = radius](const LargerDisc& d) {
                                  return std::hypot(d.x - 0.5 * made.picture.cols,
                                                    d.y - 0.5 * made.picture.rows) < 0.2 * diameter &&
                                         std::abs(d.diameter_px - 2 * radius * diameter) < 0.3 * diameter;
                                }))
            << name << ' ' << diameter << " px, " << radius;
      }
}

}  // namespace
}  // namespace twincell::imaging::groups_of_beads_test
