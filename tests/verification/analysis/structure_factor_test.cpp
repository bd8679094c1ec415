// S(q) of points without interaction and of lattices, in closed form.
#include "analysis/order/structure_factor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/known_beds.hpp"
#include "tests/support/validation.hpp"

namespace twincell::test::structure_factor_test {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<analysis::Result> structure_factor_of(const MemoryTrajectory& t) {
  analysis::AnalysisOptions options;
  options.only = {"S_q", "S_q_low", "S_q_high", "S_q_peak", "S_q_peak_wavenumber"};
  return analysis::analyze(t, options);
}

TEST(StructureFactor, RandomPointsGiveOneWithinTheInterval) {
  for (const int dimension : {2, 3})
    for (const bool periodic : {false, true}) {
      const auto results = structure_factor_of(ideal_gas(dimension, periodic));
      const auto &s = analysis::find_result(results, "S_q").values,
                 &low = analysis::find_result(results, "S_q_low").values,
                 &high = analysis::find_result(results, "S_q_high").values;
      int held = 0, bins = 0;
      double sum = 0;
      for (std::size_t b = 0; b < s.size(); ++b) {
        if (!std::isfinite(low[b])) continue;
        ++bins;
        held += low[b] <= 1 && 1 <= high[b] ? 1 : 0;
        sum += s[b];
      }
      const std::string what = std::to_string(dimension) + (periodic ? "D, periodic" : "D, walls");
      EXPECT_GT(bins, 60) << what;
      validate({"V5.20", "S(q) of an ideal gas, " + what, 1, 0.01, "closed form"}, sum / bins);
      // 95 % of about 78 bins: the standard error is 2.5 %
      validate({"V5.20", "share of the bins whose interval contains 1, %, " + what, 95, 5, "binomial"},
               100.0 * held / bins);
    }
}

TEST(StructureFactor, TriangularLatticePeakEqualsN) {
  constexpr int kColumns = 16, kRows = 18;
  constexpr double kSpacing = 1.03;
  MemoryTrajectory t = empty(2, period_of_lattice(kColumns, kRows, kSpacing), true);
  add(t, triangular_lattice(kColumns, kRows, kSpacing));
  const auto results = structure_factor_of(t);
  const double bragg = 4 * kPi / (std::sqrt(3.0) * kSpacing);
  validate({"V5.20", "wavenumber of the Bragg peak", bragg, 1e-9, "4 pi/(sqrt(3) a)"},
           analysis::find_result(results, "S_q_peak_wavenumber").value());
  // The peak is the mean of six Bragg vectors with S = N and all others of the bin, whose S is 0.
  const Vec3 size = t.info().box.size();
  const auto bin = std::floor(bragg / analysis::kStructureFactorWidth);
  int vectors = 0;
  for (int nx = -80; nx <= 80; ++nx)
    for (int nz = -80; nz <= 80; ++nz)
      vectors += std::floor(std::hypot(2 * kPi * nx / size.x(), 2 * kPi * nz / size.z()) /
                            analysis::kStructureFactorWidth) == bin
                     ? 1
                     : 0;
  validate({"V5.20", "S at the Bragg peak times its wave vectors over 6 N", 1, 1e-9, "closed form"},
           analysis::find_result(results, "S_q_peak").value() * vectors / (6.0 * kColumns * kRows));
}

TEST(StructureFactor, LatticeBetweenWallsHasTheSamePeak) {
  constexpr double kSpacing = 1.02;
  for (const double width : {20.0, 60.0}) {  // the second is wider than the longest window
    MemoryTrajectory t = empty(2, Vec3(width * kSpacing, 1, 40), false);
    std::vector<Vec3> beads = triangular_lattice(static_cast<int>(width), 22, kSpacing);
    for (Vec3& r : beads) r += Vec3(0.25, 0, 0.5);
    beads.emplace_back(10, 0, 35);  // one bead flies
    add(t, beads);
    // the spacing of the wave vectors is 0.3
    validate({"V5.20", "wavenumber of the Bragg peak between walls", 4 * kPi / (std::sqrt(3.0) * kSpacing),
              0.1, "4 pi/(sqrt(3) a)"},
             analysis::find_result(structure_factor_of(t), "S_q_peak_wavenumber").value());
  }
}

TEST(StructureFactor, HalfFilledBoxMatchesDensityTransform) {
  // Two points at a distance of half the period L: S = 1 + cos(q_x L/2), 2 for even n and 0 for odd n; in a
  // row along x.
  MemoryTrajectory t = empty(2, Vec3(8, 1, 1), true);
  t.info().box.boundary[2] = Boundary::wall;
  add(t, {Vec3(1, 0, 0.5), Vec3(5, 0, 0.5)});
  const auto s = analysis::find_result(structure_factor_of(t), "S_q").values;
  for (int n = 1; n < 20; ++n) {
    const double q = 2 * kPi * n / 8;
    EXPECT_NEAR(s[static_cast<std::size_t>(q / analysis::kStructureFactorWidth)], n % 2 == 0 ? 2 : 0, 1e-9)
        << n;
  }
}

}  // namespace
}  // namespace twincell::test::structure_factor_test
