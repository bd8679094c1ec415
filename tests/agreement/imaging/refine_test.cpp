// The fit of picture_fit.hpp against Ceres, with the same patch, model and weights. Ceres fits all discs and
// the quadratic surface of the illumination together. Sizes and darknesses scatter widely, so that the prior
// of the fit (beads are alike) carries no weight.

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "imaging/benchmark/packing.hpp"
#include "imaging/benchmark/picture.hpp"
#include "imaging/disc/ring_normal_equations.hpp"
#include "imaging/refine/picture_fit.hpp"

namespace twincell::imaging::refine_test {
namespace {

constexpr double kRing = 3;

/// Residual: darkness of a pixel minus (T + (1 - T) q), in standard deviations of the noise. T is the
/// darkness of all discs near the pixel, averaged over their path during the exposure; q is the quadratic
/// surface of the illumination error. The first parameter block contains the coefficients of q.
struct Pixel {
  double x, y, darkness, weight, variance;  // s^2
  std::array<double, 2> path;
  Surface basis;
  std::size_t near = 0;

  template <class T>
  bool operator()(T const* const* blocks, T* residual) const {
    using std::erfc, std::sqrt;
    T dark(0), light(0);
    const int steps = path == std::array<double, 2>{} ? 1 : 24;
    for (std::size_t k = 1; k <= near; ++k)
      for (int i = 0; i < steps; ++i) {
        const T* disc = blocks[k];
        const double t = (i + 0.5) / steps - 0.5;
        const T dx = x - t * path[0] - disc[0], dy = y - t * path[1] - disc[1];
        const T u = sqrt(dx * dx + dy * dy) - disc[2] + variance / (2.0 * disc[2]);
        dark += disc[3] * (0.5 / steps) * erfc(u / sqrt(2 * variance));
      }
    for (int q = 0; q < 6; ++q) light += blocks[0][q] * basis[q];
    residual[0] = weight * (darkness - dark - (1.0 - dark) * light);
    return true;
  }
};

double largest_difference(const rendered::Picture& picture, double snr) {
  const cv::Mat1b frame = rendered::expose(rendered::expected(picture), picture, snr, 3);
  const Prepared image = prepare(frame, {}, 7.5);
  std::vector<Proposal> proposals;
  for (const rendered::Disc& d : picture.discs) proposals.push_back({d.x + 0.3, d.y - 0.2, 1});
  RefineOptions options;
  options.sweeps = 100;
  options.ring_px = kRing;
  const Refined refined = refine(image, proposals, 7.5, options);
  EXPECT_EQ(refined.beads.size(), picture.discs.size());

  // The weights are those of the fitted model, as in the last sweep of the fit.
  const Noise noise = noise_of(image.darkness);
  const double variance = refined.blur_px * refined.blur_px;
  std::vector<std::array<double, 4>> discs;
  for (const Detection& b : refined.beads)
    discs.push_back({b.x + 0.2, b.y - 0.1, b.radius + 0.1, b.darkness});
  cv::Mat1f model = cv::Mat1f::zeros(frame.rows, frame.cols + kSpareColumns);
  for (const Detection& b : refined.beads)
    add_disc(model, {b.x, b.y, b.radius, b.darkness}, {variance, refined.path_px});

  ceres::Problem problem;
  Surface surface = Surface::Zero();
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      bool in_ring = false, in_disc = false;
      std::vector<double*> blocks = {surface.data()};
      for (std::size_t k = 0; k < discs.size(); ++k) {
        const Detection& b = refined.beads[k];
        const double r = std::hypot(x - b.x, y - b.y);
        if (r < b.radius + 7) blocks.push_back(discs[k].data());
        in_ring = in_ring || std::abs(r - b.radius) < kRing;
        in_disc = in_disc || r < b.radius;
      }
      if (in_disc && !in_ring) continue;
      const double v = noise.dark + noise.light * (1 - double(model(y, x)));
      auto* cost = new ceres::DynamicAutoDiffCostFunction<Pixel, 4>(
          new Pixel{double(x), double(y), double(image.darkness(y, x)), 1 / std::sqrt(v), variance,
                    refined.path_px, surface_basis(x, y, frame.size()), blocks.size() - 1});
      cost->AddParameterBlock(6);
      for (std::size_t k = 1; k < blocks.size(); ++k) cost->AddParameterBlock(4);
      cost->SetNumResiduals(1);
      problem.AddResidualBlock(cost, nullptr, blocks);
    }
  ceres::Solver::Options solver;
  solver.max_num_iterations = 200;
  solver.function_tolerance = solver.parameter_tolerance = solver.gradient_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.BriefReport();

  double largest = 0, radius = 0, sigma = 0;
  for (std::size_t k = 0; k < discs.size(); ++k) {
    const Detection& b = refined.beads[k];
    largest = std::max({largest, std::abs(discs[k][0] - b.x), std::abs(discs[k][1] - b.y)});
    radius = std::max(radius, std::abs(discs[k][2] - b.radius));
    sigma = std::max(sigma, b.sigma_x);
  }
  std::printf(
      "%zu discs, SNR %g, path %.2f %.2f px: centres agree with Ceres to %.1e px (sigma_x %.4f), radii to "
      "%.1e px\n",
      discs.size(), snr, refined.path_px[0], refined.path_px[1], largest, sigma, radius);
  return largest;
}

std::vector<double> radii(std::size_t n) {
  std::vector<double> all;
  for (std::size_t k = 0; k < n; ++k) all.push_back(7.5 * (0.9 + 0.2 * double(k * 7 % n) / double(n)));
  return all;
}
void spread_contrast(rendered::Picture& p) {
  for (std::size_t k = 0; k < p.discs.size(); ++k) p.discs[k].contrast = 0.75 + 0.25 * double(k * 5 % 7) / 6;
}

TEST(Refine, OneDiscAloneIsThatOfCeres) {
  rendered::Picture p;
  p.width = p.height = 120;
  std::mt19937_64 random(8);
  p.discs = rendered::sparse(radii(25), {2, 2, 116, 116}, random);
  spread_contrast(p);
  EXPECT_LE(largest_difference(p, 164), 1e-3);
  EXPECT_LE(largest_difference(p, 51), 1e-3);
}

rendered::Picture touching(std::uint64_t seed) {
  rendered::Picture p;
  p.width = p.height = 120;
  std::mt19937_64 random(seed);
  p.discs = rendered::deposited(radii(25), {10.3, 5, 85, 104.6}, random);
  spread_contrast(p);
  return p;
}

TEST(Refine, TouchingIsCeres) {
  const rendered::Picture p = touching(9);
  EXPECT_LE(largest_difference(p, 164), 1e-3);
  EXPECT_LE(largest_difference(p, 51), 1e-3);
}

TEST(Refine, MovedIsCeres) {
  rendered::Picture p = touching(10);
  for (rendered::Disc& d : p.discs) d.path_x = 1.5, d.path_y = -2.6;
  EXPECT_LE(largest_difference(p, 164), 1e-3);
  EXPECT_LE(largest_difference(p, 51), 1e-3);
}

}  // namespace
}  // namespace twincell::imaging::refine_test
