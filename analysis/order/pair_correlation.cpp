#include "analysis/order/pair_correlation.hpp"

#include <cmath>
#include <numbers>

#include "analysis/observable/array_with_interval.hpp"
#include "core/cancellation.hpp"
#include "core/constants.hpp"
#include "trajectory/bed_window.hpp"

namespace twincell::analysis {
namespace {

/// In definition 1 the bins were [0, w), [w, 2w), ..., so that beads in contact lay on the edge of two bins.
/// Definition 2 divided by the density of all beads, so that N points without interaction had 1 - 1/N.
constexpr int kDefinition = 3, kDefinitionOfBins = 2;
constexpr NamedResult kResults[] = {
    {.name = "g_r", .definition = kDefinition},
    {.name = "g_r_low", .definition = kDefinition},
    {.name = "g_r_high", .definition = kDefinition},
    {.name = "g_r_distance", .definition = kDefinitionOfBins},
    {.name = "g_peak", .range = Range::not_negative, .definition = kDefinition},
    {.name = "g_peak_distance", .definition = kDefinitionOfBins}};
constexpr auto kBins = static_cast<std::size_t>(kPairCorrelationRange / kPairCorrelationWidth + 0.5);
const char* const kSource = "Ripley 1988, ch. 3";

/// Centre and edges of bin b, sigma: the centres are multiples of the width, the first of them one width.
constexpr double centre_of(std::size_t b) {
  return (static_cast<double>(b) + 1) * kPairCorrelationWidth;
}
constexpr double inner_edge(std::size_t b) {
  return (static_cast<double>(b) + 0.5) * kPairCorrelationWidth;
}
constexpr double outer_edge(std::size_t b) {
  return (static_cast<double>(b) + 1.5) * kPairCorrelationWidth;
}
constexpr double kFarthest = outer_edge(kBins - 1);

constexpr double kMargin = 0.5;  // sigma, of the window: a bead reaches half its diameter beyond its centre

class PairCorrelation : public Observable {
 public:
  explicit PairCorrelation(const AnalysisContext& context) : info_(context.info), g_(kBins) {
    for (const Axis axis : {Axis::x, Axis::y, Axis::z})
      if (info_.box.periodic(axis))
        farthest_ = std::min(farthest_, info_.box.size()[static_cast<int>(axis)] / 2);
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    const std::vector<Vec3> beads = present_centres(frame);
    if (beads.size() < 2) return;
    const BedWindow window = bed_window(beads, info_.box, kMargin);
    if (window.beads < 2) return;
    // A bead is no neighbour of its own: the density is that of the other beads.
    const double density = static_cast<double>(window.beads - 1) / window.content;
    // The farthest edge of a bin up to which each bead is a reference bead, and the pairs in those bins.
    const Neighbours pairs = find_neighbours(frame, info_.box, farthest_ + kRounding);
    std::vector<std::size_t> references(kBins, 0), found(kBins, 0);
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      throw_if_cancelled();
      if (!frame.present(i) || !frame.position[i].allFinite()) continue;
      const double depth = std::min(window.depth(frame.position[i]), farthest_);
      if (!(depth >= outer_edge(0) - kRounding)) continue;
      const std::size_t bins =
          depth >= kFarthest - kRounding
              ? kBins
              : static_cast<std::size_t>(depth / kPairCorrelationWidth - 0.5 + kRounding);
      for (std::size_t b = 0; b < bins; ++b) ++references[b];
      pairs.for_each(i, [&](std::size_t, const Vec3& bond) {
        const double r = bond.norm();
        if (r < inner_edge(0)) return;
        const auto b = static_cast<std::size_t>(r / kPairCorrelationWidth - 0.5);
        if (b < bins) ++found[b];
      });
    }
    for (std::size_t b = 0; b < kBins; ++b)
      if (references[b] > 0)
        g_[b].add(static_cast<double>(found[b]) /
                  (static_cast<double>(references[b]) * density * content_of(b)));
  }

  [[nodiscard]] std::vector<Result> results() const override {
    std::vector<double> values(kBins, kNaN), centres(kBins);
    std::size_t peak = kBins;
    for (std::size_t b = 0; b < kBins; ++b) {
      centres[b] = centre_of(b);
      if (g_[b].n() == 0) continue;
      values[b] = g_[b].mean();
      if (peak == kBins || values[b] > values[peak]) peak = b;
    }
    const std::string none = "no frame has a bead that is farther than a bin from the edges of the bed";
    const std::string rule =
        "beads farther than r from the edges of the bed, density of the N - 1 other beads of the bed between "
        "its 0.5 and 99.5 percentiles; up to half a period, as farther pairs have several images";
    const auto scalar = [&](const char* name, double value, const char* unit, const std::string& convention,
                            const char* why_no_interval) {
      if (peak == kBins) return absent_result(name, none, kSource);
      Result r{.name = name,
               .values = {value},
               .unit = unit,
               .n = g_[peak].n(),
               .n_of = "frames",
               .no_interval = why_no_interval,
               .convention = convention,
               .source = kSource};
      return r;
    };
    std::vector<Result> all = array_with_interval(
        g_, {.name = "g_r", .unit = "1", .n_of = "bins", .convention = rule, .source = kSource}, "frames",
        none);
    all.push_back(peak == kBins ? absent_result("g_r_distance", none, kSource)
                                : array_of(centres,
                                           {.name = "g_r_distance",
                                            .unit = "sigma",
                                            .n_of = "bins",
                                            .convention = "centres of the bins",
                                            .source = kSource},
                                           none));
    all.push_back(scalar("g_peak", peak == kBins ? kNaN : values[peak], "1", "largest bin of g_r; " + rule,
                         "the bin is chosen from the same frames as the value"));
    all.push_back(scalar("g_peak_distance", peak == kBins ? kNaN : centres[peak], "sigma",
                         "centre of the bin of g_peak",
                         "the distance is known to half the width of a bin, 0.025 sigma"));
    return all;
  }

 private:
  /// Area (3D: volume) of bin b.
  [[nodiscard]] double content_of(std::size_t b) const {
    const double inner = inner_edge(b), outer = outer_edge(b);
    return info_.box.dimension == 2 ? std::numbers::pi * (outer * outer - inner * inner)
                                    : 4 * std::numbers::pi / 3 * (std::pow(outer, 3) - std::pow(inner, 3));
  }

  static constexpr double kRounding = 1e-9;
  const TrajectoryInfo& info_;
  double farthest_ = kFarthest;  ///< half of the shortest period, sigma
  std::vector<SeriesAverage> g_;
};

}  // namespace

constinit const ObservableEntry pair_correlation_observable = {kResults, &make_observable<PairCorrelation>};

}  // namespace twincell::analysis
