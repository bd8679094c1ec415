#pragma once
/// \file
/// Priors of a bead's radius R and darkness a: the scatter of R and a from bead to bead, for each size.
///
/// Beads of one kind are alike, so no bead needs a radius and a darkness fitted from noise. Before the first
/// sweep the priors are wide. After it their means are the medians over the beads. From the second sweep on
/// their spreads are the observed scatter less that of the fit alone:
///     spread^2 = robust_spread(v, median v)^2 - median of the variances of the fit.

#include <cstddef>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/refine/refiner.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

/// Prior of R or a: a Gaussian with wide shoulders, so that a bead that clearly differs is not pulled to the
/// mean.
struct Prior {
  double mean, spread;
  /// 1/spread^2, less for a value beyond four spreads.
  [[nodiscard]] double precision(double value) const {
    const double off = (value - mean) / (4 * spread);
    return 1 / (spread * spread * (1 + off * off));
  }
};

/// The priors of a frame, one of R for each size and one of a for all beads.
class PopulationPriors {
 public:
  /// \param radius_px radius of the first size; the options give the further sizes and the relative scatter
  PopulationPriors(double radius_px, const RefineOptions& options);

  /// Radii of the sizes, as given; px.
  [[nodiscard]] const std::vector<double>& nominal_radii() const { return nominal_radii_; }
  /// Index of the size closest to a radius, by the logarithm of their ratio.
  [[nodiscard]] std::size_t size_of(double radius_px) const;
  /// Radius, as given, of the size closest to a radius, px.
  [[nodiscard]] double nominal_radius(double radius_px) const { return nominal_radii_[size_of(radius_px)]; }
  [[nodiscard]] double smallest() const;
  [[nodiscard]] double largest() const;
  [[nodiscard]] bool several_sizes() const { return nominal_radii_.size() > 1; }
  [[nodiscard]] const std::vector<Prior>& radii() const { return radii_; }
  [[nodiscard]] const Prior& darkness() const { return darkness_; }

  /// Before the first sweep: the expected darkness of all beads, about 1 for opaque ones.
  void expect_darkness(double mean) { darkness_.mean = mean; }
  /// After the first sweep, in which every disc has a wide prior: narrows the priors, because most discs of a
  /// size are alike.
  void expect_alike(const std::vector<Detection>& beads);
  /// Estimates the scatter of R and a from bead to bead. A prior is unchanged if fewer than 20 beads show
  /// most of their rim.
  /// \param sums of the beads, from the last sweep
  /// \param ring_px half width of the ring
  /// \param rows row step of the fit that gave the values
  void learn(const std::vector<Detection>& beads, const std::vector<RingSums>& sums, double ring_px,
             int rows);
  /// Adds the priors to the normal equations of a bead.
  void add_to(Normal& a, Step& g, const Detection& bead) const;

 private:
  std::vector<double> nominal_radii_;
  std::vector<Prior> radii_;
  Prior darkness_{1, 0.3};
};

}  // namespace twincell::imaging
