#include "calibration/drive/plate_motion.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace twincell::calibration {
namespace {

/// z0 + A sin(omega t + phi) - z with omega a parameter.
struct FreeHarmonic {
  double time, height;
  template <class T>
  bool operator()(const T* p, T* residual) const {
    residual[0] = p[0] + p[1] * sin(p[3] * time + p[2]) - height;
    return true;
  }
};

/// The same with omega known.
struct Harmonic {
  double time, height, omega;
  template <class T>
  bool operator()(const T* p, T* residual) const {
    residual[0] = p[0] + p[1] * sin(omega * time + p[2]) - height;
    return true;
  }
};

/// z0, A, phi by linear least squares at a known omega: a start from which phi cannot end in a wrong minimum.
std::array<double, 4> linear_start(const std::vector<HeightSample>& samples, double omega) {
  const auto n = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd basis(n, 3);
  Eigen::VectorXd z(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const HeightSample& s = samples[static_cast<std::size_t>(i)];
    basis.row(i) << 1, std::sin(omega * s.time), std::cos(omega * s.time);
    z[i] = s.height;
  }
  const Eigen::Vector3d c = basis.colPivHouseholderQr().solve(z);
  return {c[0], std::hypot(c[1], c[2]), std::atan2(c[2], c[1]), omega};
}

}  // namespace

PlateMotion fit_plate_motion(const std::vector<HeightSample>& samples, double omega, bool fit_omega) {
  require_range({.file = {}, .key = "omega"}, omega, 0, {}, true);
  std::vector<HeightSample> finite;
  for (const HeightSample& s : samples)
    if (std::isfinite(s.time) && std::isfinite(s.height)) finite.push_back(s);
  const std::size_t n_parameters = fit_omega ? 4 : 3;
  if (finite.size() < n_parameters)
    throw InputError({.file = {}, .key = "heights"},
                     fmt::format("{} finite samples cannot determine the {} numbers of a harmonic motion",
                                 finite.size(), n_parameters));

  auto p = linear_start(finite, omega);
  ceres::Problem problem;
  for (const HeightSample& s : finite) {
    if (fit_omega)
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<FreeHarmonic, 1, 4>(new FreeHarmonic{s.time, s.height}), nullptr,
          p.data());
    else
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Harmonic, 1, 3>(new Harmonic{s.time, s.height, omega}), nullptr,
          p.data());
  }
  std::vector<std::string> names = {"z0", "A", "phi"};
  if (fit_omega) names.emplace_back("omega");

  PlateMotion motion;
  motion.fit = solve(problem, p.data(), names);
  if (p[1] < 0) {
    p[1] = -p[1];
    p[2] += std::numbers::pi;
  }
  p[2] = std::remainder(p[2], 2 * std::numbers::pi);
  motion.z0 = p[0];
  motion.amplitude = p[1];
  motion.phase = p[2];
  motion.omega = fit_omega ? p[3] : omega;
  motion.fit.values = {p.begin(), p.begin() + static_cast<std::ptrdiff_t>(n_parameters)};
  motion.n_left_out = samples.size() - finite.size();
  return motion;
}

}  // namespace twincell::calibration
