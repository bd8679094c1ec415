#include "imaging/link/collective_matching.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <vector>

namespace twincell::collective_matching_test {

using namespace imaging;

namespace {

constexpr double kDiameter = 15;

// n x n beads of a crystal whose lattice constant is 1.1 diameters.
std::vector<PixelPoint> crystal(int n) {
  std::vector<PixelPoint> beads;
  for (int row = 0; row < n; ++row)
    for (int i = 0; i < n; ++i)
      beads.push_back({1.1 * kDiameter * (i + 0.5 * (row % 2)), 1.1 * kDiameter * std::sqrt(0.75) * row});
  return beads;
}

// Each bead may be assigned to every detection within reach, all at the same cost.
std::vector<Edge> all_within(const std::vector<PixelPoint>& places, const std::vector<PixelPoint>& detections,
                             double reach, double price) {
  std::vector<Edge> choices;
  for (std::size_t t = 0; t < places.size(); ++t)
    for (std::size_t k = 0; k < detections.size(); ++k)
      if (std::hypot(detections[k].x_px - places[t].x_px, detections[k].y_px - places[t].y_px) <
          reach * kDiameter)
        choices.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(k), price});
  return choices;
}

std::size_t wrong(const std::vector<std::int64_t>& goals) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < goals.size(); ++t) count += goals[t] != static_cast<std::int64_t>(t) ? 1 : 0;
  return count;
}

}  // namespace

TEST(CollectiveMatching, ACrystalThatTurnsIsFollowedThoughTheNearestBeadIsAnother) {
  // Rotation by 8 degrees about the middle: displacements up to 1.3 diameters at the rim. Only beads near the
  // middle can be matched by distance; outwards the match must follow from the neighbours.
  const auto places = crystal(14);
  const PixelPoint middle{115, 100};
  std::vector<PixelPoint> detections;
  const double angle = 8 * std::acos(-1.0) / 180;
  std::size_t another = 0;
  for (const PixelPoint p : places) {
    const double x = p.x_px - middle.x_px, y = p.y_px - middle.y_px;
    detections.push_back({middle.x_px + x * std::cos(angle) - y * std::sin(angle),
                          middle.y_px + x * std::sin(angle) + y * std::cos(angle)});
  }
  for (std::size_t t = 0; t < places.size(); ++t) {
    std::size_t nearest = 0;
    double least = 1e300;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double r = std::hypot(detections[k].x_px - places[t].x_px, detections[k].y_px - places[t].y_px);
      if (r < least) {
        least = r;
        nearest = k;
      }
    }
    another += nearest != t ? 1 : 0;
  }
  const auto match =
      match_collectively(places, detections, all_within(places, detections, 1.9, -10), kDiameter);
  std::cout << "nearest is another: " << another << " of " << places.size() << '\n';
  EXPECT_GT(another, 40U) << "else this tests nothing";
  EXPECT_EQ(wrong(match.column_of_row), 0U);
}

TEST(CollectiveMatching, ABlockGoesWhereItsRimFits) {
  // The right half is sheared upwards, its last column by nearly a lattice constant: there the detection of
  // the bead below is nearer than that of the bead itself.
  const auto places = crystal(12);
  auto detections = places;
  const double up = 2 * 1.1 * kDiameter * std::sqrt(0.75);
  for (std::size_t t = 0; t < places.size(); ++t)
    if (t % 12 >= 6) detections[t].y_px -= up * 0.5 * (static_cast<double>(t % 12) - 5) / 6;
  const auto match =
      match_collectively(places, detections, all_within(places, detections, 1.9, -10), kDiameter);
  EXPECT_EQ(wrong(match.column_of_row), 0U);
}

TEST(CollectiveMatching, DiscsFarApartDoNotPassThroughEachOther) {
  // Two beads 2.2 d apart, one above the other, collide and rebound; an exchange of the two has the lower
  // edge cost. They are too far apart to be neighbours.
  const std::vector<PixelPoint> places = {{0, 0}, {1, 33}};
  const std::vector<PixelPoint> detections = {{0, 5}, {1, 28}};
  auto match = [&](double cheaper) {
    const std::vector<Edge> choices = {
        {0, 0, -10}, {0, 1, -10 - cheaper}, {1, 0, -10 - cheaper}, {1, 1, -10}};
    return match_collectively(places, detections, choices, kDiameter).column_of_row;
  };
  EXPECT_EQ(match(3), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(match(8), (std::vector<std::int64_t>{1, 0})) << "16 is more than the price of passing, 15";
}

TEST(CollectiveMatching, ThreeBeadsChangePlacesWhereTwoWouldNotGain) {
  // Of the six assignments of three beads the cheapest is a cyclic exchange; every exchange of two beads
  // costs more than no exchange.
  const std::vector<PixelPoint> places = {{0, 0}, {60, 0}, {30, 52}};
  const std::vector<Edge> choices = {{0, 0, -10}, {0, 1, -12}, {0, 2, -1}, {1, 0, -1}, {1, 1, -10},
                                     {1, 2, -12}, {2, 0, -12}, {2, 1, -1}, {2, 2, -10}};
  EXPECT_EQ(match_collectively(places, places, choices, kDiameter).column_of_row,
            (std::vector<std::int64_t>{1, 2, 0}));
}

TEST(CollectiveMatching, WhereNobodyIsLostARowSlidesByALatticeVector) {
  // The top row of a crystal slides by a lattice vector. Except for the first bead, the detections are the
  // same as at rest, and separation from the row below has a high cost. Only the condition that the first
  // bead must be present decides. The cost of 16.2 (two pairs, each 2 ln(1 + 1.1^2 / 0.15^2) = 8.0) for each
  // of 12 beads is less than the cost of a lost bead.
  const auto places = crystal(12);
  auto detections = places;
  for (std::size_t t = 0; t < 12; ++t) detections[t].x_px += 1.1 * kDiameter;
  const auto choices = all_within(places, detections, 1.9, -10);
  const auto at_rest = match_collectively(places, detections, choices, kDiameter).column_of_row;
  EXPECT_EQ(at_rest[0], Assignment::kAlone);
  EXPECT_EQ(at_rest[1], 0) << "where the first bead is now";
  const auto match =
      match_collectively(places, detections, choices, kDiameter, {.initial = {}, .all_present = true});
  EXPECT_EQ(wrong(match.column_of_row), 0U);
  EXPECT_EQ(match.margin[5], 0) << "nothing but the count says so";
}

TEST(CollectiveMatching, LongChainsDoNotMoveForOneBead) {
  // A chain of 30 beads would have to move on by one place. It is cheaper to leave one bead without a
  // detection and one detection without a bead.
  const auto places = crystal(30);
  auto detections = places;
  detections[29 * 30 + 15] = {places[15].x_px, -1.1 * kDiameter};
  const auto match = match_collectively(places, detections, all_within(places, detections, 1.9, -10),
                                        kDiameter, {.initial = {}, .all_present = true});
  EXPECT_EQ(match.column_of_row[29 * 30 + 15], Assignment::kAlone);
  EXPECT_EQ(wrong(match.column_of_row), 1U);
}

TEST(CollectiveMatching, InitialGuessDoesNotChangeTheResult) {
  // A ring of six beads: the cost decreases if all six move on to the next place, and increases if only two,
  // three or four of them do. The initial guess is either the ring or invalid, which must not change the
  // result.
  std::vector<PixelPoint> places;
  for (int i = 0; i < 6; ++i) places.push_back({60 * std::cos(i * 1.0472), 60 * std::sin(i * 1.0472)});
  std::vector<Edge> choices;
  for (std::uint32_t t = 0; t < 6; ++t)
    for (std::uint32_t k = 0; k < 6; ++k)
      choices.push_back({t, k, k == t ? -10.0 : k == (t + 1) % 6 ? -12.0 : -1.0});
  const std::vector<std::int64_t> ring = {1, 2, 3, 4, 5, 0};
  const std::vector<std::int32_t> told = {1, 2, 3, 4, 5, 0}, nonsense = {3, 3, -1, 90, 0, 0};
  EXPECT_EQ(match_collectively(places, places, choices, kDiameter, {.initial = told}).column_of_row, ring);
  EXPECT_EQ(match_collectively(places, places, choices, kDiameter, {.initial = nonsense}).column_of_row,
            ring);
}

TEST(CollectiveMatching, IndistinguishableLinksHaveNoMargin) {
  // Two beads and two detections that are equally near to both; a third pair far away is unambiguous.
  const std::vector<PixelPoint> places = {{0, 0}, {18, 0}, {200, 0}};
  const std::vector<PixelPoint> detections = {{9, 12}, {9, -12}, {200, 1}};
  const auto match =
      match_collectively(places, detections, all_within(places, detections, 1.5, -10), kDiameter);
  EXPECT_NEAR(match.margin[0], 0, 1e-6);
  EXPECT_NEAR(match.margin[1], 0, 1e-6);
  EXPECT_EQ(match.column_of_row[2], 2);
  EXPECT_GT(match.margin[2], 3);
}

TEST(CollectiveMatching, BeadsWithoutChoiceAndDetectionsWithoutBead) {
  EXPECT_TRUE(match_collectively({}, {}, {}, kDiameter).column_of_row.empty());
  const std::vector<PixelPoint> places = {{0, 0}, {20, 0}, {40, 0}};
  const std::vector<PixelPoint> detections = {{1, 0}, {100, 0}};
  const auto match =
      match_collectively(places, detections, all_within(places, detections, 0.5, -10), kDiameter);
  EXPECT_EQ(match.column_of_row, (std::vector<std::int64_t>{0, Assignment::kAlone, Assignment::kAlone}));
  EXPECT_TRUE(match_collectively(places, {}, {}, kDiameter).margin.size() == 3);
}

}  // namespace twincell::collective_matching_test
