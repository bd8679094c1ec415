#include "analysis/order/orientation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "ordered_fraction", .range = Range::share},
                                    {"orientation", Pooling::angle},
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
    // Near 45 degrees, which equals -15, the angles of successive frames may jump by 60 degrees, and their
    // mean would be wrong. Each angle is therefore unwrapped to the value nearest the first.
    const double angle = lattice_angle(sum.real(), sum.imag());
    if (angle_.n() == 0) first_ = angle;
    angle_.add(first_ + std::remainder(angle - first_, kLatticePeriodDegrees));
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
    return {
        mean("ordered_fraction", ordered_, "1",
             fmt::format("share of beads with psi6 > {} among those not at a surface", kOrdered),
             dimension_ != 2 ? planar : "every bead is at a surface"),
        back(mean(
            "orientation", angle_, "degrees",
            fmt::format(
                "arg of the sum of psi_6 over beads with |psi_6| > {}, divided by 6; -15 to 45: A 0, B 30",
                kOrdered),
            none)),
        mean("orientation_a", a_, "1", near + "0", none), mean("orientation_b", b_, "1", near + "30", none),
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
  /// Maps a mean angle, and its interval with it, back to the range -15 … 45.
  static Result back(Result angle) {
    if (!angle.present()) return angle;
    const double turns = turns_of_lattice(angle.value());
    angle.values[0] -= turns;
    if (angle.interval) {
      angle.interval->low -= turns;
      angle.interval->high -= turns;
    }
    return angle;
  }

  std::string rule_;
  int dimension_;
  double first_ = 0;
  std::vector<double> last_;
  SeriesAverage ordered_, angle_, a_, b_;
};

}  // namespace

double turns_of_lattice(double degrees) {
  return kLatticePeriodDegrees * std::floor((degrees - kLowestOrientation) / kLatticePeriodDegrees);
}

constinit const ObservableEntry orientation_observable = {kResults, &make_observable<Orientation>};

}  // namespace twincell::analysis
