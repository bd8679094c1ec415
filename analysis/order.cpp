#include "analysis/order.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace twincell {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// a_m = (4 pi/13) |Y_6m(pi/2, 0)|^2 for m = 0, 2, 4, 6; odd m vanish in the plane. With Y_lm of the standard
/// library, which is normalised as in Steinhardt's definition.
const std::array<double, 4>& planar_weights() {
  static const std::array<double, 4> weights = [] {
    std::array<double, 4> a{};
    for (unsigned h = 0; h < 4; ++h) {
      const double y = std::sph_legendre(6, 2 * h, std::numbers::pi / 2);
      a[h] = 4 * std::numbers::pi / 13 * y * y;
    }
    return a;
  }();
  return weights;
}

class BondOrderObservable : public Observable {
 public:
  explicit BondOrderObservable(const AnalysisContext& context)
      : cutoff_(context.cutoff), dimension_(context.info.box.dimension) {}

  void add(const FrameView& view) override {
    if (dimension_ != 2) return;
    last_ = bond_order(view.neighbours());
    add_mean(q6_, last_.q6);
    add_mean(psi6_, last_.psi6);
    add_mean(psi4_, last_.psi4);
    std::size_t hexagonal = 0, square = 0, beads = 0;
    for (std::size_t i = 0; i < last_.q6.size(); ++i) {
      if (!view.frame().present(i)) continue;
      ++beads;
      const Structure s = structure_of(last_, i);
      hexagonal += s == Structure::hexagonal ? 1 : 0;
      square += s == Structure::square ? 1 : 0;
    }
    if (beads == 0) return;
    hexagonal_.add(static_cast<double>(hexagonal) / static_cast<double>(beads));
    square_.add(static_cast<double>(square) / static_cast<double>(beads));
  }

  [[nodiscard]] std::vector<Result> results() const override {
    const std::string source = "Steinhardt et al. 1983 as used in Fortini & Huang 2015, sec. III";
    const std::string rule = fmt::format("neighbours: centres within {:.4g} sigma", cutoff_);
    const std::string mean_rule = "mean over beads with at least 2 neighbours and over frames; " + rule;
    std::vector<Result> all;
    all.push_back(mean_result("q6", q6_, mean_rule, source));
    all.push_back(mean_result("psi6", psi6_, mean_rule, source));
    all.push_back(mean_result("psi4", psi4_, mean_rule, source));
    all.push_back(mean_result("hexagonal_fraction", hexagonal_,
                              "share of beads with 6 neighbours and |q6 - 0.741| < 0.05; " + rule, source));
    all.push_back(mean_result("square_fraction", square_,
                              "share of beads with 4 neighbours and |q6 - 0.586| < 0.03; " + rule, source));
    all.push_back(bead_result("q6_beads", last_.q6, rule, source));
    all.push_back(bead_result("psi6_beads", last_.psi6, rule, source));
    all.push_back(bead_result("psi4_beads", last_.psi4, rule, source));
    return all;
  }

 private:
  static void add_mean(BlockAverage& average, const std::vector<double>& values) {
    double sum = 0;
    std::size_t n = 0;
    for (const double value : values)
      if (std::isfinite(value)) {
        sum += value;
        ++n;
      }
    if (n > 0) average.add(sum / static_cast<double>(n));
  }

  [[nodiscard]] std::string reason() const {
    return dimension_ != 2 ? "the cell is not planar" : "no bead has two neighbours";
  }

  [[nodiscard]] Result mean_result(const std::string& name, const BlockAverage& average,
                                   const std::string& convention, const std::string& source) const {
    if (average.n() == 0) return absent_result(name, reason(), source);
    Result r{.name = name, .values = {average.mean()}, .unit = "1", .n = average.n(), .n_of = "frames"};
    r.interval = average.interval("frames");
    r.convention = convention;
    r.source = source;
    return r;
  }

  [[nodiscard]] Result bead_result(const std::string& name, const std::vector<double>& values,
                                   const std::string& rule, const std::string& source) const {
    Result r{.name = name, .values = values, .shape = {values.size()}, .unit = "1"};
    for (const double value : values) r.n += std::isfinite(value) ? 1 : 0;
    if (r.n == 0) return absent_result(name, reason(), source);
    r.n_of = "beads";
    r.convention = "last frame; NaN for a bead with fewer than 2 neighbours; " + rule;
    r.source = source;
    return r;
  }

  double cutoff_;
  int dimension_;
  BondOrder last_;
  BlockAverage q6_, psi6_, psi4_, hexagonal_, square_;
};

}  // namespace

BondOrder bond_order(const Neighbours& neighbours) {
  const std::size_t n = neighbours.first.size() - 1;
  BondOrder order{std::vector<double>(n, kNaN), std::vector<double>(n, kNaN), std::vector<double>(n, kNaN),
                  std::vector<std::size_t>(n, 0)};
  const auto& a = planar_weights();
  for (std::size_t i = 0; i < n; ++i) {
    order.n_bonds[i] = neighbours.count(i);
    if (order.n_bonds[i] < 2) continue;
    std::complex<double> sum2 = 0, sum4 = 0, sum6 = 0;
    neighbours.for_each(i, [&](std::size_t, const Vec3& bond) {
      const std::complex<double> e1 =
          std::complex<double>(bond.x(), bond.z()) / std::hypot(bond.x(), bond.z());
      const std::complex<double> e2 = e1 * e1, e4 = e2 * e2;
      sum2 += e2;
      sum4 += e4;
      sum6 += e4 * e2;
    });
    const double bonds = static_cast<double>(order.n_bonds[i]);
    order.psi4[i] = std::abs(sum4) / bonds;
    order.psi6[i] = std::abs(sum6) / bonds;
    order.q6[i] =
        std::sqrt(a[0] + 2 * (a[1] * std::norm(sum2) + a[2] * std::norm(sum4) + a[3] * std::norm(sum6)) /
                             (bonds * bonds));
  }
  return order;
}

Structure structure_of(const BondOrder& order, std::size_t bead) {
  const double q6 = order.q6[bead];
  if (std::isnan(q6)) return Structure::undefined;
  if (order.n_bonds[bead] == 6 && std::abs(q6 - 0.741) < 0.05) return Structure::hexagonal;
  if (order.n_bonds[bead] == 4 && std::abs(q6 - 0.586) < 0.03) return Structure::square;
  return Structure::other;
}

std::unique_ptr<Observable> make_bond_order(const AnalysisContext& context) {
  return std::make_unique<BondOrderObservable>(context);
}

}  // namespace twincell
