#include <cmath>

#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct Exponential {
  static constexpr int kParameters = 3;
  template <class T>
  static T value(double x, const T* p) {
    using std::exp;
    return p[0] * (1.0 + p[2] * exp(-p[1] * x));
  }
};

}  // namespace

const Law& exponential_law() {
  static const Law law = make_law<Exponential>(
      {.name = "exponential",
       .formula = "y = a (1 + c exp(-b x))",
       .source = "Bhateja et al. 2016, Table III, with x = W",
       .parameters = {"a", "b", "c"},
       .nested = "constant",
       .lost = {"b", "c"},
       .starts = [](const std::vector<FitPoint>& points) {
         const auto [least, most] = std::minmax_element(
             points.begin(), points.end(), [](const FitPoint& p, const FitPoint& q) { return p.x < q.x; });
         std::vector<double> rates;  // decay lengths from ten spans of x to a hundredth
         for (const double r : {0.1, 0.3, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 100.0})
           rates.push_back(r / (most->x - least->x));
         return decay_starts(points, rates, [](double b, double x) { return std::exp(-b * x); });
       }});
  return law;
}

}  // namespace twincell::calibration
