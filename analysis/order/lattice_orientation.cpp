#include "analysis/order/lattice_orientation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/statistics/ratio_average.hpp"

namespace twincell::analysis {
namespace {

/// Least length of the sum of psi_6, in standard errors: the sum of lattices without a common direction
/// reaches it in 0.1 % of runs.
constexpr double kLeastErrors = 4;
/// Least length of the sum over one frame, in the root of this times the number of ordered beads.
constexpr double kLeastAligned = 8;

/// Definition 1 of orientation was the mean over frames of the angle of each frame.
constexpr NamedResult kResults[] = {{.name = "ordered_fraction", .range = Range::share},
                                    {.name = "orientation", .pooling = Pooling::angle, .definition = 2},
                                    {.name = "orientation_a", .range = Range::share, .main = true},
                                    {.name = "orientation_b", .range = Range::share, .main = true},
                                    {"orientation_beads", Pooling::per_bead}};

const char* const kSource = "Fortini & Huang 2015, Fig. 2";

/// The tolerance includes a lattice rotated by exactly the width despite rounding.
bool within_width(double angle, double other) {
  return misorientation(angle, other) <= kOrientationWidth + 1e-9;
}

class Orientation : public Observable {
 public:
  explicit Orientation(const AnalysisContext& context)
      : rule_(neighbour_rule_text(context)), dimension_(context.info.box.dimension) {}

  void add(const FrameView& view) override {
    if (dimension_ != 2) return;
    const BondOrder& order = view.order();
    const auto& enclosed = view.cells().enclosed;
    last_ = order.angle;
    std::complex<double> sum = 0;
    std::size_t bulk = 0, bulk_ordered = 0, ordered = 0, a = 0, b = 0;
    for (std::size_t i = 0; i < order.psi6.size(); ++i) {
      bulk += enclosed[i];
      if (!(order.psi6[i] > kOrdered)) continue;
      bulk_ordered += enclosed[i];
      ++ordered;
      sum += std::polar(order.psi6[i], 6 * order.angle[i] * std::numbers::pi / 180);
      a += within_width(order.angle[i], 0) ? 1 : 0;
      b += within_width(order.angle[i], 30) ? 1 : 0;
    }
    const auto share = [](std::size_t part, std::size_t whole) {
      return static_cast<double>(part) / static_cast<double>(whole);
    };
    if (bulk > 0) ordered_.add(share(bulk_ordered, bulk));
    if (ordered == 0) return;
    sum_.add(sum.real(), sum.imag());
    ordered_beads_ += static_cast<double>(ordered);
    a_.add(share(a, ordered));
    b_.add(share(b, ordered));
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string planar = "the cell is not planar";
    const std::string none = dimension_ != 2 ? planar : fmt::format("no bead has psi6 > {}", kOrdered);
    const auto mean = [&](const char* name, const SeriesAverage& series, const char* unit,
                          const std::string& convention, const std::string& why) {
      return mean_of(series,
                     {.name = name,
                      .unit = unit,
                      .n_of = "frames",
                      .convention = convention + ", mean over frames; " + rule_,
                      .source = kSource},
                     why);
    };
    const std::string near = fmt::format(
        "share of beads with psi6 > {} whose lattice is within {} degrees of ", kOrdered, kOrientationWidth);
    return {mean("ordered_fraction", ordered_, "1",
                 fmt::format("share of beads with psi6 > {} among those not at a surface", kOrdered),
                 dimension_ != 2 ? planar : "every bead is at a surface"),
            direction(none), mean("orientation_a", a_, "1", near + "0", none),
            mean("orientation_b", b_, "1", near + "30", none),
            array_of(
                last_,
                {.name = "orientation_beads",
                 .unit = "degrees",
                 .n_of = "beads",
                 .convention = "last frame, -15 to 45; NaN for a bead with fewer than 2 neighbours; " + rule_,
                 .source = kSource},
                dimension_ != 2 ? planar : "no bead has two neighbours")};
  }

 private:
  /// Angle of the sum over all frames, with the interval of its component across that direction. Absent if
  /// the sum may be one of psi_6 without a common direction.
  /// \param none why there is no sum, if no frame has one
  [[nodiscard]] Result direction(const std::string& none) const {
    constexpr const char* kName = "orientation";
    if (sum_.n() == 0) return absent_result(kName, none, kSource);
    const auto [real, imaginary] = sum_.means();
    const double length = std::hypot(real, imaginary), beads = ordered_beads_ / static_cast<double>(sum_.n());
    const double c = length > 0 ? real / length : 1, s = length > 0 ? imaginary / length : 0;
    const SeriesAverage along = sum_.combination(c, s), across = sum_.combination(-s, c);
    const std::optional<Interval> interval = across.interval("frames");
    double squares = 0, errors = 0;
    for (const auto& component : {along.interval("frames"), interval})
      if (component) squares += std::pow(standard_error(*component), 2), errors += 1;
    // Without an error over frames, the ordered beads count as independent (Rayleigh's test, exp(-8)).
    const bool scatters = errors > 0;
    const double least =
        scatters ? kLeastErrors * std::sqrt(squares / errors) : std::sqrt(kLeastAligned * beads);
    if (!(length >= least))
      return absent_result(
          kName,
          fmt::format("the lattices have no common direction: the sum of psi_6 is {:.2g} of that of {:.3g} "
                      "aligned ordered beads in a frame, less than {}",
                      length / beads, beads,
                      scatters ? fmt::format("{:g} of its standard errors", kLeastErrors)
                               : fmt::format("sqrt({:g} n) of n independent beads", kLeastAligned)),
          kSource);
    Result r{.name = kName,
             .values = {lattice_angle(real, imaginary)},
             .unit = "degrees",
             .n = sum_.n(),
             .n_of = "frames",
             .convention = fmt::format("arg of the sum of psi_6 over beads with |psi_6| > {} of all frames, "
                                       "divided by 6; -15 to 45: A 0, B 30; {}",
                                       kOrdered, rule_),
             .source = kSource};
    if (!interval) {
      r.no_interval = across.why_no_interval("frames");
      return r;
    }
    const auto turned_by = [&](double component) {
      return std::asin(std::clamp(component / length, -1.0, 1.0)) * 180 / std::numbers::pi / 6;
    };
    r.interval = interval;
    r.interval->low = r.value() + turned_by(interval->low);
    r.interval->high = r.value() + turned_by(interval->high);
    return r;
  }

  std::string rule_;
  int dimension_;
  std::vector<double> last_;
  double ordered_beads_ = 0;  ///< of all frames with ordered beads
  RatioAverage sum_;  ///< real and imaginary part of the sum of psi_6 over the ordered beads of a frame
  SeriesAverage ordered_, a_, b_;
};

}  // namespace

double turns_of_lattice(double degrees) {
  return kLatticePeriodDegrees * std::floor((degrees - kLowestOrientation) / kLatticePeriodDegrees);
}

constinit const ObservableEntry orientation_observable = {
    kResults, &make_observable<Orientation>, {"neighbours", "cell_radius"}};

}  // namespace twincell::analysis
