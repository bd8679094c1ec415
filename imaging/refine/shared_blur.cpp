#include "imaging/refine/shared_blur.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace twincell::imaging {

namespace {

/// Equations of the blur, with one unknown (s^2) or three, and their coupling to those of the discs.
struct BlurEquations {
  std::vector<std::vector<Step>> shared;  // coupling of each unknown to each disc
  Eigen::MatrixXd normal;
  Eigen::VectorXd right;
};

BlurEquations blur_equations(BlurFit fit, const std::vector<RingSums>& sums) {
  const int n = fit == BlurFit::round ? 1 : RingSums::kBlurs;
  BlurEquations e{std::vector(static_cast<std::size_t>(n), std::vector<Step>(sums.size())),
                  Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const RingSums& s = sums[k];
    std::size_t at = 0;
    for (int q = 0; q < n; ++q) {
      for (int p = 0; p <= q; ++p, ++at) e.normal(q, p) = e.normal(p, q) += s.bb[at];
      e.right[q] += s.br[static_cast<std::size_t>(q)];
      for (int m = 0; m < kFitted; ++m)
        e.shared[static_cast<std::size_t>(q)][k][m] =
            s.jb[std::size_t{RingSums::kBlurs} * static_cast<std::size_t>(m) + static_cast<std::size_t>(q)];
    }
  }
  return e;
}

/// The equations of a round blur, Q_xx = Q_yy.
BlurEquations rounded(const BlurEquations& e) {
  BlurEquations r{{e.shared[0]}, Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd::Zero(1)};
  for (std::size_t k = 0; k < r.shared[0].size(); ++k) r.shared[0][k] += e.shared[2][k];
  r.normal(0, 0) = e.normal(0, 0) + 2 * e.normal(0, 2) + e.normal(2, 2);
  r.right[0] = e.right[0] + e.right[2];
  return r;
}

/// Bounded step of the blur; also corrects the steps of the discs for it.
Eigen::VectorXd blur_step(const BlurEquations& e, double variance, const std::vector<Normal>& blocks,
                          const std::vector<Coupling>& couplings, std::vector<Step>& steps) {
  const auto n = static_cast<Eigen::Index>(e.shared.size());
  std::vector<std::vector<Step>> follow;
  Eigen::MatrixXd normal = e.normal;
  Eigen::VectorXd right = e.right;
  for (Eigen::Index q = 0; q < n; ++q) {
    const std::vector<Step>& shared = e.shared[static_cast<std::size_t>(q)];
    follow.push_back(gauss_newton_step(blocks, couplings, shared));
    for (std::size_t k = 0; k < steps.size(); ++k) {
      right[q] -= shared[k].dot(steps[k]);
      for (Eigen::Index p = 0; p < n; ++p)
        normal(p, q) -= e.shared[static_cast<std::size_t>(p)][k].dot(follow.back()[k]);
    }
  }
  Eigen::VectorXd step = normal.ldlt().solve(right);
  if (!step.allFinite()) return Eigen::VectorXd::Zero(n);
  for (Eigen::Index q = 0; q < n; ++q) {
    step[q] = std::clamp(step[q], -0.5 * variance, variance);
    for (std::size_t k = 0; k < steps.size(); ++k)
      steps[k] -= step[q] * follow[static_cast<std::size_t>(q)][k];
  }
  return step;
}

/// A blur that is not round: mean variance, and the excess of variance along one direction over that across
/// it.
struct Uneven {
  double mean, more, angle;
  explicit Uneven(const Eigen::VectorXd& q)
      : mean(0.5 * (q[0] + q[2])),
        more(std::hypot(q[0] - q[2], 2 * q[1])),
        angle(0.5 * std::atan2(2 * q[1], q[0] - q[2])) {}
};

/// Decides whether the blur has a direction, from its step without the couplings of the discs.
/// \returns whether it has one in this sweep
bool has_direction(FrameModel& frame, const BlurEquations& equations, const DiscSteps& discs) {
  constexpr double kMinExcess = 0.04, kMaxMeanStep = 0.1;  // fractions of s^2
  std::vector<Step> alone = discs.steps;
  const Uneven seen(blur_step(equations, frame.blur.variance, discs.blocks, {}, alone));
  // A mean blur that is still wrong also appears to depend on direction.
  const bool directed = seen.more > std::max(kMinExcess * frame.blur.variance, std::abs(seen.mean));
  if (directed || std::abs(seen.mean) < kMaxMeanStep * frame.blur.variance)
    frame.blur_has_direction = directed;
  return directed;
}

void put_path(FrameModel& frame, const Eigen::Vector2d& path) {
  // With a longer path no point of a disc would stay dark throughout the exposure.
  const double most = frame.priors.smallest(), length = path.norm();
  const Eigen::Vector2d bounded = length > most ? Eigen::Vector2d(most / length * path) : path;
  frame.blur.path = {bounded.x(), bounded.y()};
}

/// Applies a step to variance and path.
/// \returns the change of the variance of the edges, px^2
double apply(FrameModel& frame, BlurFit fit, const Eigen::VectorXd& step) {
  const double old = frame.blur.variance;
  if (fit == BlurFit::path) {
    const Eigen::Vector2d path(frame.blur.path[0], frame.blur.path[1]), longer = path + step.tail<2>();
    put_path(frame, longer);
    frame.blur.variance = old + step[0];
    return std::abs(step[0]) + std::abs(longer.squaredNorm() - path.squaredNorm()) / 12;
  }
  if (step.size() == 1) {
    frame.blur.variance = old + step[0];
    return std::abs(step[0]);
  }
  const Uneven seen(step);
  // A uniform density over a length L has the variance L^2/12.
  put_path(frame, std::sqrt(12 * seen.more) * Eigen::Vector2d(std::cos(seen.angle), std::sin(seen.angle)));
  frame.blur.variance = old + seen.mean - seen.more / 2;
  return std::abs(seen.mean) + seen.more / 2;
}

}  // namespace

double fit_blur(FrameModel& frame, BlurFit fit, const DiscSteps& discs) {
  constexpr double kMinVariance = 0.09, kMaxVariance = 36, kWideVariance = 0.7;  // px^2
  if (fit == BlurFit::none) return 0;
  BlurEquations equations = blur_equations(fit, discs.sums);
  if (fit == BlurFit::uneven && !has_direction(frame, equations, discs)) equations = rounded(equations);
  const double old = frame.blur.variance;
  const Eigen::VectorXd step = blur_step(equations, old, discs.blocks, discs.couplings, discs.steps);
  const double widened = apply(frame, fit, step);
  frame.blur.variance = std::clamp(frame.blur.variance, kMinVariance, kMaxVariance);
  // For a wide blur the same relative change moves the discs farther.
  return widened / std::min(old, kWideVariance);
}

}  // namespace twincell::imaging
