#include "analysis/order/bond_order.hpp"

#include <cmath>

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "q6", .range = Range::share, .main = true},
                                    {.name = "psi6", .range = Range::share},
                                    {.name = "psi4", .range = Range::share},
                                    {.name = "hexagonal_fraction", .range = Range::share, .main = true},
                                    {.name = "square_fraction", .range = Range::share},
                                    {"q6_beads", Pooling::per_bead},
                                    {"psi6_beads", Pooling::per_bead},
                                    {"psi4_beads", Pooling::per_bead}};

const char* const kSource = "Steinhardt et al. 1983 as used in Fortini & Huang 2015, sec. III";

class BondOrderObservable : public Observable {
 public:
  explicit BondOrderObservable(const AnalysisContext& context)
      : rule_(neighbour_rule_text(context)), dimension_(context.info.box.dimension) {}

  void add(const FrameView& view) override {
    if (dimension_ != 2) return;
    last_ = view.order();
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
    const std::string mean_rule = "mean over beads with at least 2 neighbours and over frames; " + rule_;
    return {mean("q6", q6_, mean_rule),
            mean("psi6", psi6_, mean_rule),
            mean("psi4", psi4_, mean_rule),
            mean("hexagonal_fraction", hexagonal_,
                 "share of beads with 6 neighbours and |q6 - 0.741| < 0.05; " + rule_),
            mean("square_fraction", square_,
                 "share of beads with 4 neighbours and |q6 - 0.586| < 0.03; " + rule_),
            beads("q6_beads", last_.q6),
            beads("psi6_beads", last_.psi6),
            beads("psi4_beads", last_.psi4)};
  }

 private:
  static void add_mean(SeriesAverage& average, const std::vector<double>& values) {
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

  [[nodiscard]] Result mean(const std::string& name, const SeriesAverage& series,
                            const std::string& convention) const {
    return mean_of(series,
                   {.name = name, .unit = "1", .n_of = "frames", .convention = convention, .source = kSource},
                   reason());
  }

  [[nodiscard]] Result beads(const std::string& name, const std::vector<double>& values) const {
    return array_of(values,
                    {.name = name,
                     .unit = "1",
                     .n_of = "beads",
                     .convention = "last frame; NaN for a bead with fewer than 2 neighbours; " + rule_,
                     .source = kSource},
                    reason());
  }

  std::string rule_;
  int dimension_;
  BondOrder last_;
  SeriesAverage q6_, psi6_, psi4_, hexagonal_, square_;
};

}  // namespace

constinit const ObservableEntry bond_order_observable = {
    kResults, &make_observable<BondOrderObservable>, {"neighbours"}};

}  // namespace twincell::analysis
