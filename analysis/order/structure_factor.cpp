#include "analysis/order/structure_factor.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/observable/array_with_interval.hpp"
#include "trajectory/bed_window.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {
    {"S_q"}, {"S_q_low"}, {"S_q_high"}, {"S_q_wavenumber"}, {"S_q_peak"}, {"S_q_peak_wavenumber"}};
constexpr auto kBins = static_cast<std::size_t>(kStructureFactorRange / kStructureFactorWidth + 0.5);
const char* const kSource = "Hansen & McDonald, Theory of Simple Liquids, sec. 4.1";
constexpr double kPi = std::numbers::pi;

/// The wave numbers along one axis.
struct WaveAxis {
  double low = 0, length = 0;  ///< sigma
  bool tapered = false;        ///< weighted by a Hann window
  int most = 0;                ///< largest |n|

  [[nodiscard]] double step() const { return most > 0 ? 2 * kPi / length : 0; }
  [[nodiscard]] double weight(double r) const {
    if (!tapered) return 1;
    const double share = (r - low) / length;
    return share > 0 && share < 1 ? std::pow(std::sin(kPi * share), 2) : 0;
  }
  /// Whether the density of a uniform bed has this component.
  [[nodiscard]] bool shows_the_extent(int n) const { return std::abs(n) <= (tapered ? 1 : 0); }
};

WaveAxis wave_axis(const BedWindow& window, int a, const Box& box) {
  constexpr double kMinTaperedLength = 2;  // sigma
  if (box.dimension == 2 && a == 1) return {};
  const double longest = box.dimension == 2 ? 40 : 10;
  WaveAxis axis{.low = window.low[a], .length = window.high[a] - window.low[a]};
  axis.tapered = !box.periodic(static_cast<Axis>(a)) || axis.length > longest;
  if (axis.tapered && axis.length < kMinTaperedLength) return {};
  if (axis.length > longest) {
    axis.low += 0.5 * (axis.length - longest);
    axis.length = longest;
  }
  axis.most = static_cast<int>(kStructureFactorRange * axis.length / (2 * kPi));
  return axis;
}

/// cos and sin of n q_1 (r - low) for n = 0 .. most: columns 2 n and 2 n + 1.
Eigen::MatrixXd waves(const std::vector<Vec3>& centres, int a, const WaveAxis& axis) {
  const auto beads = static_cast<Eigen::Index>(centres.size());
  Eigen::MatrixXd table(beads, 2 * (axis.most + 1));
  for (Eigen::Index i = 0; i < beads; ++i) {
    const double angle = axis.step() * (centres[static_cast<std::size_t>(i)][a] - axis.low);
    for (int n = 0; n <= axis.most; ++n) {
      table(i, 2 * n) = std::cos(n * angle);
      table(i, 2 * n + 1) = std::sin(n * angle);
    }
  }
  return table;
}

/// S of all wave vectors of a frame, summed in bins.
struct Bins {
  std::vector<double> sum = std::vector<double>(kBins, 0), vectors = sum, wavenumber = sum;
  void add(double q, double s, double weight) {
    if (!(q < kStructureFactorRange)) return;
    const auto b = static_cast<std::size_t>(q / kStructureFactorWidth);
    sum[b] += weight * s;
    vectors[b] += weight;
    wavenumber[b] += weight * s * q;
  }
};

Bins structure_factor(const std::vector<Vec3>& present, const Box& box) {
  const BedWindow window = bed_window(present, box, 0);
  const std::array<WaveAxis, 3> axis = {wave_axis(window, 0, box), wave_axis(window, 1, box),
                                        wave_axis(window, 2, box)};
  std::vector<Vec3> centres;
  std::vector<double> weights;
  for (const Vec3& r : present) {
    const Vec3 inside = box.wrap(r);
    const double w = axis[0].weight(inside.x()) * axis[1].weight(inside.y()) * axis[2].weight(inside.z());
    if (!(w > 0)) continue;
    centres.push_back(inside);
    weights.push_back(w);
  }
  Bins bins;
  if (centres.size() < 2) return bins;
  const Eigen::Map<const Eigen::ArrayXd> w(weights.data(), static_cast<Eigen::Index>(weights.size()));
  const double norm = w.square().sum();
  const Eigen::MatrixXd x = waves(centres, 0, axis[0]), y = waves(centres, 1, axis[1]),
                        z = waves(centres, 2, axis[2]);
  // S(-q) = S(q): half of the wave vectors with q_x > 0 and all with q_x = 0 are summed; weights make up.
  for (int ny = -axis[1].most; ny <= axis[1].most; ++ny) {
    const double sign = ny < 0 ? -1 : 1;
    const Eigen::ArrayXd cos_y = y.col(2 * std::abs(ny)).array() * w,
                         sin_y = sign * y.col(2 * std::abs(ny) + 1).array() * w;
    Eigen::MatrixXd xy(x.rows(), x.cols());
    for (int nx = 0; nx <= axis[0].most; ++nx) {
      const auto c = x.col(2 * nx).array(), s = x.col(2 * nx + 1).array();
      xy.col(2 * nx) = c * cos_y - s * sin_y;
      xy.col(2 * nx + 1) = c * sin_y + s * cos_y;
    }
    const Eigen::MatrixXd products = xy.transpose() * z;
    for (int nx = 0; nx <= axis[0].most; ++nx)
      for (int nz = -axis[2].most; nz <= axis[2].most; ++nz) {
        if (axis[0].shows_the_extent(nx) && axis[1].shows_the_extent(ny) && axis[2].shows_the_extent(nz))
          continue;
        const int k = 2 * std::abs(nz);
        const double side = nz < 0 ? -1 : 1;
        const double real = products(2 * nx, k) - side * products(2 * nx + 1, k + 1);
        const double imaginary = side * products(2 * nx, k + 1) + products(2 * nx + 1, k);
        const double q = Vec3(nx * axis[0].step(), ny * axis[1].step(), nz * axis[2].step()).norm();
        bins.add(q, (real * real + imaginary * imaginary) / norm, nx == 0 ? 1 : 2);
      }
  }
  return bins;
}

class StructureFactor : public Observable {
 public:
  explicit StructureFactor(const AnalysisContext& context)
      : info_(context.info), s_(kBins), wavenumber_(kBins, 0), weight_(kBins, 0) {}

  void add(const FrameView& view) override {
    if (info_.columns.phase && view.frame().phase != 0) return;
    const std::vector<Vec3> centres = present_centres(view.frame());
    if (centres.size() < 2) return;
    const Bins bins = structure_factor(centres, info_.box);
    for (std::size_t b = 0; b < kBins; ++b) {
      if (!(bins.vectors[b] > 0)) continue;
      s_[b].add(bins.sum[b] / bins.vectors[b]);
      wavenumber_[b] += bins.wavenumber[b];
      weight_[b] += bins.sum[b];
    }
  }

  [[nodiscard]] std::vector<Result> results() const override {
    std::vector<double> centres(kBins);
    std::size_t peak = kBins;
    for (std::size_t b = 0; b < kBins; ++b) {
      centres[b] = (static_cast<double>(b) + 0.5) * kStructureFactorWidth;
      if (s_[b].n() > 0 && (peak == kBins || s_[b].mean() > s_[peak].mean())) peak = b;
    }
    const std::string none = "no frame at phase 0 has two beads and a wave vector";
    const std::string rule = "wave vectors of the box; along axes without period Hann window over the bed";
    std::vector<Result> all = array_with_interval(
        s_, {.name = "S_q", .unit = "1", .n_of = "bins", .convention = rule, .source = kSource}, "frames",
        none);
    if (peak == kBins) {
      for (const char* name : {"S_q_wavenumber", "S_q_peak", "S_q_peak_wavenumber"})
        all.push_back(absent_result(name, none, kSource));
      return all;
    }
    all.push_back(array_of(centres,
                           {.name = "S_q_wavenumber",
                            .unit = "1/sigma",
                            .n_of = "bins",
                            .convention = "centres of the bins",
                            .source = kSource},
                           none));
    all.push_back({.name = "S_q_peak",
                   .values = {s_[peak].mean()},
                   .unit = "1",
                   .n = s_[peak].n(),
                   .n_of = "frames",
                   .no_interval = "the bin is chosen from the same frames as the value",
                   .convention = "largest bin of S_q; " + rule,
                   .source = kSource});
    all.push_back({.name = "S_q_peak_wavenumber",
                   .values = {wavenumber_[peak] / weight_[peak]},
                   .unit = "1/sigma",
                   .n = s_[peak].n(),
                   .n_of = "frames",
                   .no_interval = "the wavenumber is known to the spacing of the wave vectors of the box",
                   .convention = "mean |q| of the wave vectors in the bin of S_q_peak, weighted by their S",
                   .source = kSource});
    return all;
  }

 private:
  const TrajectoryInfo& info_;
  std::vector<SeriesAverage> s_;
  std::vector<double> wavenumber_, weight_;  ///< sums of S |q| and of S in each bin
};

}  // namespace

constinit const ObservableEntry structure_factor_observable = {kResults, &make_observable<StructureFactor>};

}  // namespace twincell::analysis
