#include <cmath>

#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct Power {
  static constexpr int kParameters = 2;
  template <class T>
  static T value(double x, const T* p) {
    return p[0] + p[1] * std::log(x);
  }
};

}  // namespace

const Law& power_law() {
  static const Law law = make_law<Power>(
      {.name = "power",
       .formula = "ln y = ln_C + alpha ln x",
       .source = "Bhateja et al. 2016, Tables I and II",
       .parameters = {"ln_C", "alpha"},
       .logarithmic = true,
       .positive_x = true,
       .axis = Law::Axis::logarithmic,
       .lost = {},
       .starts = [](const std::vector<FitPoint>& points) {
         return Starts{
             least_squares(points, {[](double) { return 1.0; }, [](double x) { return std::log(x); }}).first};
       }});
  return law;
}

}  // namespace twincell::calibration
