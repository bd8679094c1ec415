#include "imaging/refine/population_priors.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.hpp"

namespace twincell::imaging {

namespace {

/// Values of a quantity for many beads, and the variances due to the fit alone for some of them.
struct Scatter {
  std::vector<double> values, variances;
  /// Sets the prior to the median and the true spread of the beads; unchanged if there are too few.
  /// \param least lower bound of the spread
  /// \param rows row step of the fit that gave the values
  void learn(Prior& prior, double least, int rows) {
    constexpr std::size_t kMinBeads = 20;
    if (values.size() < kMinBeads) return;
    const double middle = upper_median(values);
    const double scatter = robust_spread(std::move(values), middle);
    const double own = scatter * scatter - rows * upper_median(variances);
    prior = {middle, std::max(least, std::sqrt(std::max(0.0, own)))};
  }
};

}  // namespace

PopulationPriors::PopulationPriors(double radius_px, const RefineOptions& options) {
  radii_.push_back({radius_px, kRadiusSpread * radius_px});
  for (const double other : options.other_radii_px) radii_.push_back({other, kRadiusSpread * other});
  for (const Prior& s : radii_) nominal_radii_.push_back(s.mean);
}

std::size_t PopulationPriors::size_of(double radius_px) const {
  const auto off = [&](double size) { return std::abs(std::log(radius_px / size)); };
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < nominal_radii_.size(); ++k)
    if (off(nominal_radii_[k]) < off(nominal_radii_[nearest])) nearest = k;
  return nearest;
}

double PopulationPriors::smallest() const {
  return *std::min_element(nominal_radii_.begin(), nominal_radii_.end());
}

double PopulationPriors::largest() const {
  return *std::max_element(nominal_radii_.begin(), nominal_radii_.end());
}

void PopulationPriors::expect_alike(const std::vector<Detection>& beads) {
  if (beads.empty()) return;
  std::vector<std::vector<double>> radii(radii_.size());
  std::vector<double> darkness;
  for (const Detection& b : beads)
    radii[size_of(b.radius)].push_back(b.radius), darkness.push_back(b.darkness);
  for (std::size_t k = 0; k < radii_.size(); ++k)
    if (!radii[k].empty())
      radii_[k] = {upper_median(std::move(radii[k])), kRadiusSpread / 3 * nominal_radii_[k]};
  darkness_ = {upper_median(std::move(darkness)), 0.02};
}

void PopulationPriors::learn(const std::vector<Detection>& beads, const std::vector<RingSums>& sums,
                             double ring_px, int rows) {
  constexpr double kMinRadius = 0.002, kMinDarkness = 0.003;
  constexpr double kMostlySeen = 0.8;         // of the ring
  constexpr std::size_t kInvertedMost = 200;  // a median needs no more variances
  std::vector<Scatter> radii(radii_.size());
  Scatter darkness;
  for (std::size_t k = 0; k < beads.size(); ++k) {
    const Detection& b = beads[k];
    if (sums[k].pixels < kMostlySeen * ring_area(nominal_radius(b.radius), ring_px)) continue;
    Scatter& radius = radii[size_of(b.radius)];
    radius.values.push_back(b.radius);
    darkness.values.push_back(b.darkness);
    if (radius.variances.size() > kInvertedMost) continue;
    const Normal covariance = normal_of(sums[k]).inverse();
    radius.variances.push_back(covariance(kR, kR));
    darkness.variances.push_back(covariance(kA, kA));
  }
  for (std::size_t k = 0; k < radii_.size(); ++k)
    radii[k].learn(radii_[k], kMinRadius * nominal_radii_[k], rows);
  darkness.learn(darkness_, kMinDarkness, rows);
}

void PopulationPriors::add_to(Normal& a, Step& g, const Detection& bead) const {
  constexpr double kOfProposal = 0.25;  // px^-2: a proposal is accurate to 2 px
  const auto add = [&](int at, const Prior& prior, double value) {
    const double p = prior.precision(value);
    a(at, at) += p;
    g[at] += p * (prior.mean - value);
  };
  add(kR, radii_[size_of(bead.radius)], bead.radius);
  add(kA, darkness_, bead.darkness);
  a(kX, kX) += kOfProposal, a(kY, kY) += kOfProposal;
}

}  // namespace twincell::imaging
