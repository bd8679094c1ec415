// For every verdict, a picture or a candidate that produces it.

#include "imaging/refine/judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "imaging/benchmark/picture.hpp"
#include "imaging/refine/picture_fit.hpp"

namespace twincell::imaging::judge_test {
namespace {

Detection good(double x, double y) {
  Detection b;
  b.x = x;
  b.y = y;
  b.radius = 7.5;
  b.darkness = b.interior = b.score = 0.9;
  return b;
}

Verdict judged(const Detection& b) {
  const Judged j = judge({b}, 7.5, 200, 100, {});
  EXPECT_EQ(j.beads.size() + j.dropped.size(), 1U);
  return (j.beads.empty() ? j.dropped : j.beads).at(0).verdict;
}

// Beads of a broad distribution of sizes have a larger tolerance.
TEST(Judge, TheToleranceOfTheRadiusDecides) {
  Detection small = good(50, 50);
  small.radius = 0.75 * 7.5;
  EXPECT_EQ(judged(small), Verdict::wrong_radius);
  JudgeOptions wide;
  wide.radius_tolerance = 0.3;
  EXPECT_EQ(judge({small}, 7.5, 200, 100, wide).beads.size(), 1U);
}

/// Number of tracers among beads with these interiors.
std::size_t tracers(const std::vector<double>& interiors) {
  std::vector<Detection> beads;
  for (std::size_t k = 0; k < interiors.size(); ++k) {
    beads.push_back(good(20 + 20 * static_cast<double>(k), 50));
    beads.back().interior = interiors[k];
  }
  const int width = 40 + 20 * static_cast<int>(interiors.size());
  const Judged j = judge(beads, 7.5, width, 100, {});
  EXPECT_EQ(j.beads.size(), interiors.size());
  return static_cast<std::size_t>(
      std::count_if(j.beads.begin(), j.beads.end(), [](const Detection& b) { return b.tracer; }));
}

// Beads that let light through, with opaque tracers; opaque beads with pale tracers; and neither.
TEST(Judge, TracersAreDarkerAmongPaleBeads) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 0.02);
  for (const auto& [beads, few, expected] :
       {std::tuple(0.45, 0.95, 24U), {0.95, 0.6, 24U}, {0.45, 0.5, 0U}, {0.95, 1.0, 0U}}) {
    std::vector<double> interiors;
    for (int k = 0; k < 200; ++k) interiors.push_back((k % 8 == 3 && k < 192 ? few : beads) + noise(random));
    EXPECT_EQ(tracers(interiors), expected) << beads << ' ' << few;
  }
}

// One population: at most one frame in a thousand has tracers, as documented. The frames have the scatter of
// translucent discs, so that many beads lie below 0.8 of the median; the exponential tail is the worst case.
TEST(Judge, OnePopulationHasNoTracers) {
  constexpr int kFrames = 4000, kBeads = 200;
  for (const bool exponential : {false, true}) {
    std::mt19937_64 random(exponential ? 2 : 1);
    int alarms = 0, beyond = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      std::vector<double> interiors;
      for (int k = 0; k < kBeads; ++k) {
        const double off = exponential ? std::exponential_distribution<double>(20)(random)
                                       : std::abs(std::normal_distribution<double>(0, 0.1)(random));
        interiors.push_back(std::max(0.36, 0.95 + (k % 2 == 0 ? off : -off)));
        beyond += interiors.back() < 0.76 ? 1 : 0;
      }
      alarms += tracers(interiors) > 0 ? 1 : 0;
    }
    EXPECT_GT(beyond, kFrames);            // the old rule, 0.8 of the median, flagged these
    EXPECT_LE(alarms, 10) << exponential;  // 4 expected at most, and 3 standard deviations
  }
}

TEST(Judge, TwoPopulationsAreSeparated) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const std::size_t few : {1U, 5U, 40U}) {
    std::vector<double> interiors;
    for (std::size_t k = 0; k < 100; ++k)
      interiors.push_back((k < few ? 0.55 : 0.95) + 0.02 * normal(random));
    EXPECT_EQ(tracers(interiors), few);
  }
}

/// Numbers of tracers among 200 beads on a lattice. `is_pale` tells which of them absorb `pale`.
template <class IsPale>
std::size_t tracers_on_lattice(double pale, double scatter, IsPale is_pale) {
  constexpr int kRows = 10, kColumns = 20, kSpacing = 20;
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, scatter);
  std::vector<Detection> beads;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      beads.push_back(good(kSpacing * (column + 1), kSpacing * (row + 1)));
      beads.back().interior = (is_pale(row, column) ? pale : 0.97) + noise(random);
    }
  const Judged j = judge(beads, 7.5, kSpacing * (kColumns + 1), kSpacing * (kRows + 1), {});
  return static_cast<std::size_t>(
      std::count_if(j.beads.begin(), j.beads.end(), [](const Detection& b) { return b.tracer; }));
}

// Tracers that let a tenth of the light through are a population of their own if they are many and alike.
// Beads along a wall, or in the shadow at a corner, are not tracers.
TEST(Judge, CloseTracersAreScattered) {
  const auto every = [](int n) { return [n](int row, int column) { return (20 * row + column) % n == 3; }; };
  EXPECT_EQ(tracers_on_lattice(0.83, 0.005, every(11)), 18U);
  EXPECT_EQ(tracers_on_lattice(0.88, 0.005, every(11)), 18U);
  EXPECT_EQ(tracers_on_lattice(0.93, 0.005, every(11)), 0U);
  EXPECT_EQ(tracers_on_lattice(0.88, 0.03, every(11)), 0U);
  EXPECT_EQ(tracers_on_lattice(0.88, 0.005, every(51)), 0U);
  EXPECT_EQ(tracers_on_lattice(0.88, 0.005, [](int, int column) { return column == 0; }), 0U);
  EXPECT_EQ(tracers_on_lattice(0.88, 0.005, [](int row, int column) { return row < 5 && column < 5; }), 0U);
}

TEST(Judge, EachBeadHasOneVerdict) {
  EXPECT_EQ(judged(good(50, 50)), Verdict::bead);
  Detection b = good(50, 50);
  b.radius = 7.5 * 1.19;
  EXPECT_EQ(judged(b), Verdict::bead);
  b.radius = 7.5 * 1.21;
  EXPECT_EQ(judged(b), Verdict::wrong_radius);
  b = good(50, 50);
  b.interior = 0.34;
  EXPECT_EQ(judged(b), Verdict::bright_inside);
  b = good(50, 50);
  b.score = 0.49;
  EXPECT_EQ(judged(b), Verdict::unexplained);
  b = good(NAN, 50);
  EXPECT_EQ(judged(b), Verdict::unexplained);
  for (const auto& [x, y] : {std::pair{-0.6, 50.0}, {199.6, 50.0}, {50.0, -0.6}, {50.0, 99.6}})
    EXPECT_EQ(judged(good(x, y)), Verdict::outside) << x << ' ' << y;
  for (const auto& [x, y] : {std::pair{-0.4, 50.0}, {199.4, 50.0}, {50.0, -0.4}, {50.0, 99.4}})
    EXPECT_EQ(judged(good(x, y)), Verdict::bead) << x << ' ' << y;
}

TEST(Judge, BetterOfTwoOverlappingDiscsStays) {
  Detection a = good(50, 50), b = good(63, 50), c = good(77.9, 50);  // b overlaps a by 2 px; c touches b
  b.score = 0.7;
  const Judged j = judge({a, b, c}, 7.5, 200, 100, {});
  ASSERT_EQ(j.beads.size(), 2U);
  EXPECT_EQ(j.beads[0].x, 50);
  EXPECT_EQ(j.beads[1].x, 77.9);
  ASSERT_EQ(j.dropped.size(), 1U);
  EXPECT_EQ(j.dropped[0].verdict, Verdict::overlaps);
  b.x = 63.2;  // an overlap of less than a quarter of a radius
  EXPECT_EQ(judge({a, b, c}, 7.5, 200, 100, {}).beads.size(), 3U);
}

// A dropped candidate does not cause others to be dropped: of three in a row only the middle one is dropped.
TEST(Judge, DroppedDiscDropsNoOther) {
  Detection a = good(50, 50), b = good(60, 50), c = good(70, 50);
  b.score = 0.8;
  c.score = 0.7;
  const Judged j = judge({c, b, a}, 7.5, 200, 100, {});
  ASSERT_EQ(j.beads.size(), 2U);
  ASSERT_EQ(j.dropped.size(), 1U);
  EXPECT_EQ(j.dropped[0].x, 60);
}

rendered::Picture row_of_beads() {
  rendered::Picture p;
  p.width = 200;
  p.height = 120;
  for (int k = 0; k < 8; ++k) p.discs.push_back({.x = 20.3 + 21.7 * k, .y = 30.4});
  return p;
}

/// The verdict of refine() on one additional proposal.
Verdict refined(const cv::Mat1b& frame, const rendered::Picture& picture, const Proposal& doubtful) {
  std::vector<Proposal> proposals;
  for (int k = 0; k < 8; ++k) {
    const rendered::Disc& d = picture.discs[static_cast<std::size_t>(k)];
    proposals.push_back({d.x, d.y, 1});
  }
  proposals.push_back(doubtful);
  const Refined r = refine(prepare(frame, {}, 7.5), proposals, 7.5, {});
  EXPECT_EQ(r.beads.size() + r.dropped.size(), 9U);
  for (const Detection& b : r.dropped)
    if (std::hypot(b.x - doubtful.x, b.y - doubtful.y) < 3) return b.verdict;
  EXPECT_EQ(r.beads.size(), 9U);
  return Verdict::bead;
}
cv::Mat1b exposed(const rendered::Picture& p) {
  return rendered::expose(rendered::expected(p), p, 51, 1);
}

TEST(Refine, WhatIsNoBeadIsDroppedWithItsReason) {
  rendered::Picture p = row_of_beads();
  EXPECT_EQ(refined(exposed(p), p, {100, 80, 1}), Verdict::bright_inside) << "nothing there";

  rendered::Picture pale = row_of_beads();
  pale.discs.push_back({.x = 100.2, .y = 80.1, .contrast = 0.38});
  EXPECT_EQ(refined(exposed(pale), pale, {100, 80, 1}), Verdict::pale);
  pale.discs.back().contrast = 0.6;
  EXPECT_EQ(refined(exposed(pale), pale, {100, 80, 1}), Verdict::bead);

  rendered::Picture corner = row_of_beads();
  corner.discs.push_back({.x = -6.2, .y = 125.2});
  EXPECT_EQ(refined(exposed(corner), corner, {-6.2, 125.2, 1}), Verdict::unseen);

  EXPECT_EQ(refined(exposed(p), p, {-8, 60, 1}), Verdict::outside) << "further out than a rim is seen";

  cv::Mat1b wall = exposed(p);
  wall.rowRange(90, 120).setTo(20);
  EXPECT_EQ(refined(wall, p, {100, 105, 1}), Verdict::in_wall);
}

// A bead without a proposal is searched for after the first and the second sweep, provided that another sweep
// follows in which it can be fitted.
TEST(Refine, ABeadFoundLateNeedsASweepOfItsOwn) {
  const rendered::Picture p = row_of_beads();
  std::vector<Proposal> all_but_one;
  for (std::size_t k = 1; k < p.discs.size(); ++k) all_but_one.push_back({p.discs[k].x, p.discs[k].y, 1});
  const Prepared image = prepare(exposed(p), {}, 7.5);
  for (const int sweeps : {1, 2, 3, 30}) {
    RefineOptions options;
    options.sweeps = sweeps;
    const Refined r = refine(image, all_but_one, 7.5, options);
    EXPECT_EQ(r.beads.size(), sweeps > 1 ? 8U : 7U) << sweeps;
  }
}

TEST(Verdict, EachHasAWord) {
  std::set<std::string> words;
  for (int k = 0; k <= static_cast<int>(Verdict::outside); ++k)
    words.emplace(word_of(static_cast<Verdict>(k)));
  EXPECT_EQ(words.size(), 9U);
}

}  // namespace
}  // namespace twincell::imaging::judge_test
