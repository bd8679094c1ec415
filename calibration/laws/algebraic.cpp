#include <cmath>

#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct Algebraic {
  static constexpr int kParameters = 3;
  template <class T>
  static T value(double x, const T* p) {
    using std::exp;
    return p[0] * (1.0 + p[2] * exp(-p[1] * std::log(x)));
  }
};

}  // namespace

const Law& algebraic_law() {
  static const Law law =
      make_law<Algebraic>({.name = "algebraic",
                           .formula = "y = a (1 + c x^-b)",
                           .source = "Bhateja et al. 2016, Table III, with x = W",
                           .parameters = {"a", "b", "c"},
                           .positive_x = true,
                           .axis = Law::Axis::logarithmic,
                           .nested = "constant",
                           .lost = {"b", "c"},
                           .starts = [](const std::vector<FitPoint>& points) {
                             return decay_starts(points, {0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5},
                                                 [](double b, double x) { return std::pow(x, -b); });
                           }});
  return law;
}

}  // namespace twincell::calibration
