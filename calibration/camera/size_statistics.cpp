#include "calibration/camera/size_statistics.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/fit/fit.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/refine/picture_evidence.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/track/locate_stack.hpp"

namespace twincell::calibration {
namespace {

/// Mode of a small sample by repeated halving: keep the shortest interval that contains half of the values
/// (Robertson & Cryer 1974).
double half_sample_mode(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  while (v.size() > 3) {
    const std::size_t half = (v.size() + 1) / 2;
    std::size_t best = 0;
    for (std::size_t a = 0; a + half <= v.size(); ++a)
      if (v[a + half - 1] - v[a] < v[best + half - 1] - v[best]) best = a;
    v = std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(best),
                            v.begin() + static_cast<std::ptrdiff_t>(best + half));
  }
  return v[v.size() / 2];
}

/// Centre distances of pairs that may touch: up to 1.1 mean diameters.
std::vector<double> near_pairs(const std::vector<SizedBead>& frame, double diameter) {
  std::vector<SizedBead> sorted = frame;
  std::sort(sorted.begin(), sorted.end(), [](const SizedBead& a, const SizedBead& b) { return a.x < b.x; });
  std::vector<double> r;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t k = i + 1; k < sorted.size() && sorted[k].x - sorted[i].x < 1.1 * diameter; ++k) {
      const double d = std::hypot(sorted[k].x - sorted[i].x, sorted[k].y - sorted[i].y);
      if (d < 1.1 * diameter) r.push_back(d);
    }
  return r;
}

/// Number of pairs in a bin of distances. The model is a peak of touching pairs at distance d plus a uniform
/// density of separate pairs above d; the camera noise s blurs both. The residual uses 2 sqrt(n + 3/8), which
/// has unit variance for a count n.
struct PairsInBin {
  double at, width, count;
  template <class T>
  bool operator()(const T* p, T* residual) const {
    using std::erfc, std::exp, std::sqrt;
    const T u = (at - p[0]) * exp(-p[1]);
    const T touching = p[2] * p[2] * exp(-0.5 * u * u - p[1]) / std::sqrt(2 * std::numbers::pi);
    const T apart = p[3] * p[3] * 0.5 * erfc(-u / std::numbers::sqrt2);
    residual[0] = 2.0 * (sqrt(width * (touching + apart) + 0.375) - std::sqrt(count + 0.375));
    return true;
  }
};

/// Centre distance of touching beads, from all near pairs. In a moving bed most near pairs do not quite
/// touch. The mean around the mode, which was tried first, was too large by eight of its standard errors.
std::optional<Estimate> touching(const std::vector<double>& pairs, double diameter, std::size_t frames) {
  constexpr std::size_t kMinPairs = 20;
  constexpr double kBinWidth = 0.5, kReach = 5;  // of the histogram from the mode; peak widths
  constexpr double kMinReachAbove = 0.015;       // bead diameters
  if (pairs.size() < kMinPairs) return std::nullopt;
  const double mode = half_sample_mode(pairs);
  std::vector<double> below;
  for (const double r : pairs)
    if (r < mode) below.push_back(mode - r);
  if (below.size() < kMinPairs / 2) return std::nullopt;
  // Distances below the mode contain no gaps, so only they give the noise.
  const double width = std::max(1e-4 * diameter, robust_spread(below));
  const double low = mode - kReach * width, high = mode + std::max(kReach * width, kMinReachAbove * diameter),
               bin = kBinWidth * width;
  std::vector<double> counts(static_cast<std::size_t>(std::ceil((high - low) / bin)));
  double n = 0;
  for (const double r : pairs)
    if (r > low && r < low + bin * static_cast<double>(counts.size()))
      ++counts[static_cast<std::size_t>((r - low) / bin)], ++n;
  if (n < kMinPairs) return std::nullopt;
  std::vector<double> p = {mode, std::log(width), std::sqrt(0.8 * n), std::sqrt(0.2 * n / (high - mode))};
  ceres::Problem problem;
  for (std::size_t k = 0; k < counts.size(); ++k)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PairsInBin, 1, 4>(
                                 new PairsInBin{low + bin * (static_cast<double>(k) + 0.5), bin, counts[k]}),
                             nullptr, p.data());
  const FitReport fit =
      solve(problem, p.data(), {"distance", "noise", "touching", "apart"}, Residuals::weighted);
  const double moved = std::abs(fit.values[0] - mode);
  // Without a peak of touching pairs the distance is not defined.
  if (!fit.usable || !(moved < 3 * width) || !(fit.values[2] * fit.values[2] > kMinPairs / 2.0))
    return std::nullopt;
  const double error = fit.standard_errors.empty() ? width / std::sqrt(n) : fit.standard_errors[0];
  // The same pairs recur in other frames, so frames do not add independent data.
  return Estimate{fit.values[0], error * std::sqrt(static_cast<double>(frames))};
}

/// Linear fit of the diameters in x and y, from the beads whose diameter is within `width` of `middle`.
void add_gradient(SizeStatistics& c, const BeadFrames& beads, double middle, double width,
                  double independent) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero(), centre = Eigen::Vector3d::Zero();
  double n = 0, squares = 0;
  const auto each = [&](const auto& use) {
    for (const auto& frame : beads.frames)
      for (const SizedBead& b : frame)
        if (std::abs(2 * b.radius - middle) <= width) use(b);
  };
  each([&](const SizedBead& b) { centre += Eigen::Vector3d(0, b.x, b.y), ++n; });
  centre /= std::max(1.0, n);
  each([&](const SizedBead& b) {
    const Eigen::Vector3d at(1, b.x - centre[1], b.y - centre[2]);
    normal += at * at.transpose();
    right += (2 * b.radius - middle) * at;
  });
  const Eigen::Vector3d line = normal.ldlt().solve(right);
  each([&](const SizedBead& b) {
    const Eigen::Vector3d at(1, b.x - centre[1], b.y - centre[2]);
    squares += std::pow(2 * b.radius - middle - line.dot(at), 2);
  });
  // The same beads recur in other frames at other positions, so the number of independent sizes is the number
  // of beads.
  const Eigen::Matrix3d covariance =
      squares / std::max(1.0, n - 3) * (n / std::max(4.0, independent)) * normal.inverse();
  c.gradient_x = {line[1] / middle, std::sqrt(covariance(1, 1)) / middle};
  c.gradient_y = {line[2] / middle, std::sqrt(covariance(2, 2)) / middle};
}

/// Groups of rejected discs of another size that are less than a bead diameter apart.
std::vector<SizedBead> objects_of(const std::vector<imaging::Detection>& dropped, double diameter) {
  constexpr double kMinScore = 0.8;  // Detection::score
  struct Group {
    double x = 0, y = 0, n = 0;
  };
  std::vector<Group> groups;
  for (const imaging::Detection& d : dropped) {
    if (d.verdict != imaging::Verdict::wrong_radius || d.score < kMinScore || d.edge) continue;
    const auto near = std::find_if(groups.begin(), groups.end(), [&](const Group& g) {
      return std::hypot(g.x / g.n - d.x, g.y / g.n - d.y) < diameter;
    });
    Group& g = near == groups.end() ? groups.emplace_back() : *near;
    g.x += d.x, g.y += d.y, ++g.n;
  }
  std::vector<SizedBead> objects;
  for (const Group& g : groups) objects.push_back({g.x / g.n, g.y / g.n});
  return objects;
}

/// Moves the located discs of further sizes that are one or two a frame, such as an intruder, from the beads
/// to the others, with their radii. \param n_sizes  the first is that of the beads \param size_of
/// [frames][beads] index of the nearest size
void separate_few_larger(BeadFrames& beads, std::size_t n_sizes,
                         const std::vector<std::vector<std::size_t>>& size_of) {
  constexpr double kMostInFrame = 2, kMaxShareOfBeads = 0.1;
  double all = 0;
  for (const auto& frame : beads.frames) all += static_cast<double>(frame.size());
  for (std::size_t size = 1; size < n_sizes; ++size) {
    double n = 0, most = 0;
    for (const auto& frame : size_of) {
      const auto here = static_cast<double>(std::count(frame.begin(), frame.end(), size));
      n += here, most = std::max(most, here);
    }
    if (most > kMostInFrame || n > kMaxShareOfBeads * all) continue;
    for (std::size_t f = 0; f < beads.frames.size(); ++f) {
      std::vector<SizedBead> kept;
      for (std::size_t i = 0; i < beads.frames[f].size(); ++i)
        (size_of[f][i] == size ? beads.others[f] : kept).push_back(beads.frames[f][i]);
      beads.counts[f] -= beads.frames[f].size() - kept.size();
      beads.frames[f] = std::move(kept);
    }
  }
}

}  // namespace

BeadFrames locate_beads(imaging::FrameSource& frames, const imaging::LocatorOptions& options,
                        const std::optional<imaging::Lens>& lens, int most, int threads, Progress& progress) {
  /// Every stride-th frame of another source.
  class Thinned : public imaging::FrameSource {
   public:
    Thinned(imaging::FrameSource& whole, std::size_t stride) : whole_(whole), stride_(stride) {}
    bool next(cv::Mat& frame) override {
      for (std::size_t skip = first_ ? 0 : stride_ - 1; skip > 0; --skip) {
        cv::Mat passed;
        if (!whole_.next(passed)) return false;
      }
      first_ = false;
      return whole_.next(frame);
    }
    [[nodiscard]] std::size_t announced() const override {
      return (whole_.announced() + stride_ - 1) / stride_;
    }
    [[nodiscard]] std::string current() const override { return whole_.current(); }

   private:
    imaging::FrameSource& whole_;
    std::size_t stride_;
    bool first_ = true;
  };
  Thinned some(frames,
               std::max<std::size_t>(1, frames.announced() / static_cast<std::size_t>(std::max(1, most))));
  BeadFrames out;
  out.mean_model_error = kDiameterModelError_px;
  out.model_scatter = kDiameterModelScatter_px;
  imaging::FramesAhead ahead(some);
  const imaging::LocatorOptions locator = imaging::configure_locator(ahead, options, threads).locator;
  constexpr std::int64_t kAspectFrames = 12;
  imaging::RimAspect aspect;
  const std::vector<double> radii_px = locator.radii_px();
  std::vector<std::vector<std::size_t>> size_of;
  imaging::locate_stack(
      ahead, locator, threads,
      [&](std::int64_t frame, const cv::Mat& grey, const imaging::Located& found) {
        if (frame < kAspectFrames) aspect.add(grey, found.beads, found.path_px);
        out.frames.emplace_back();
        out.counts.push_back(found.beads.size());
        out.others.push_back(objects_of(found.dropped, locator.diameter_px));
        size_of.emplace_back();
        for (const imaging::Detection& b : found.beads) {
          if (b.edge) continue;
          size_of.back().push_back(imaging::nearest_size(b.radius, radii_px));
          SizedBead bead{b.x, b.y, b.radius, b.sigma_radius};
          if (lens) {
            const imaging::PixelPoint at = lens->ideal_from_picture({b.x, b.y});
            bead = {at.x_px, at.y_px, b.radius / lens->magnification(at), b.sigma_radius};
          }
          out.frames.back().push_back(bead);
        }
      },
      progress);
  // Discs of a size that the user named are beads.
  if (options.other_diameters_px.empty()) separate_few_larger(out, radii_px.size(), size_of);
  out.aspect = aspect.value();
  return out;
}

BeadFrames beads_of(const TrajectorySource& trajectory, int most) {
  const TrajectoryInfo& info = trajectory.info();
  if (info.radius.empty())
    throw InputError({.file = trajectory.name(), .key = {}},
                     "has no radii; calibrate beads on the stack itself.");
  BeadFrames out;
  const std::size_t stride =
      std::max<std::size_t>(1, trajectory.n_frames() / static_cast<std::size_t>(std::max(1, most)));
  Frame frame;
  for (std::size_t f = 0; f < trajectory.n_frames(); f += stride) {
    trajectory.read(f, frame);
    out.frames.emplace_back();
    for (std::size_t i = 0; i < info.n_beads; ++i)
      if (frame.present(i) && std::isfinite(frame.position[i].x()))
        out.frames.back().push_back({frame.position[i].x(), frame.position[i].z(), info.radius[i], 0});
    out.counts.push_back(out.frames.back().size());
  }
  return out;
}

std::string others_in_words(const BeadFrames& beads) {
  constexpr double kMinShareOfFrames = 0.5;  // that show such objects
  constexpr double kMaxShareOfBeads = 0.1;   // objects per bead; more are a second size of beads
  std::size_t with = 0, first = 0;
  double all = 0, others = 0;
  std::vector<double> numbers;
  for (std::size_t f = 0; f < beads.others.size(); ++f) {
    all += static_cast<double>(beads.counts[f]);
    others += static_cast<double>(beads.others[f].size());
    if (beads.others[f].empty()) continue;
    if (with++ == 0) first = f;
    numbers.push_back(static_cast<double>(beads.others[f].size()));
  }
  if (with == 0 || static_cast<double>(with) < kMinShareOfFrames * static_cast<double>(beads.others.size()) ||
      others > kMaxShareOfBeads * all)
    return {};
  const SizedBead& at = beads.others[first].front();
  return fmt::format(
      "{:g} object{} of another size than the beads, as an intruder, {} in {} of {} frames, the first at "
      "x, y = {:.0f}, {:.0f} px{}; the numbers here leave such objects out (twincell locate --diameter D1 D2 "
      "locates discs of two sizes)",
      upper_median(numbers), upper_median(numbers) == 1 ? "" : "s",
      upper_median(numbers) == 1 ? "is seen" : "are seen", with, beads.others.size(), at.x, at.y,
      at.radius > 0 ? fmt::format(", {:.4g} px in diameter", 2 * at.radius) : "");
}

SizeStatistics count_beads(const BeadFrames& beads) {
  SizeStatistics c;
  c.frames = beads.frames.size();
  std::vector<double> diameters, counts;
  double noise = 0, most = 0;
  for (std::size_t f = 0; f < beads.frames.size(); ++f) {
    counts.push_back(static_cast<double>(beads.counts[f]));
    most = std::max(most, static_cast<double>(beads.frames[f].size()));
    for (const SizedBead& b : beads.frames[f]) {
      diameters.push_back(2 * b.radius);
      noise += 4 * b.sigma_radius * b.sigma_radius;
    }
  }
  c.sizes = diameters.size();
  if (diameters.size() < 3)
    throw InputError({.file = {}, .key = "beads"},
                     fmt::format("{} beads are too few to measure.", diameters.size()));
  noise /= static_cast<double>(diameters.size());
  c.count.value = upper_median(counts);
  c.count.error = counts.size() > 1 ? 1.2533 * robust_spread(counts, c.count.value) /
                                          std::sqrt(static_cast<double>(counts.size()))
                                    : kNaN;

  // Mean and variance, without false detections and half-hidden discs, whose diameters are outliers.
  const double middle = upper_median(diameters),
               width = std::max(robust_spread(diameters, middle), 1e-6 * middle);
  double sum = 0, squares = 0, cubes = 0, n = 0;
  for (const double d : diameters) {
    if (std::abs(d - middle) > 5 * width) continue;
    sum += d, ++n;
    c.diameters.push_back(d);
  }
  std::sort(c.diameters.begin(), c.diameters.end());
  const double mean = sum / n;
  double fourth = 0;
  for (const double d : c.diameters) {
    squares += (d - mean) * (d - mean);
    fourth += std::pow(d - mean, 4);
    cubes += std::pow(d / mean, 3);
  }
  const double variance = squares / std::max(1.0, n - 1), kurtosis = fourth / n;
  // The number of independent sizes is the largest number of beads in one frame, at most the number accepted.
  const double independent = std::max(2.0, std::min(n, most));
  c.diameter = {mean, std::hypot(std::sqrt(variance / independent), beads.mean_model_error)};
  const double true_variance = std::max(0.0, variance - noise);
  // Variance of the sample variance of n beads, mu_4/n - (n - 3)/(n (n - 1)) s^4, corrected for the bias of
  // mu_4.
  const double of_few = std::max(1.0, independent - 3);
  const double error_of_variance = std::sqrt(
      std::max(kurtosis * independent / of_few - variance * variance * of_few / (independent - 1), 0.0) /
      independent);
  const double error_of_true = std::hypot(error_of_variance, beads.model_scatter * beads.model_scatter);
  // The error of the spread follows from that of its square; near zero the linear propagation would diverge.
  c.spread.value = std::sqrt(true_variance) / mean;
  c.spread.error = true_variance > error_of_true ? error_of_true / (2 * std::sqrt(true_variance)) / mean
                                                 : std::sqrt(error_of_true) / mean;
  c.mass.value = cubes / n - 3 * noise / (mean * mean);
  c.mass.error = 3 * c.spread.value * c.spread.error * 2;

  add_gradient(c, beads, middle, 5 * width, independent);

  std::vector<double> pairs;
  for (const auto& frame : beads.frames)
    for (const double r : near_pairs(frame, mean))
      if (r > 0.9 * mean) pairs.push_back(r);
  c.spacing = touching(pairs, mean, std::max<std::size_t>(1, beads.frames.size()));
  return c;
}

}  // namespace twincell::calibration
