#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct Arrhenius {
  static constexpr int kParameters = 2;
  template <class T>
  static T value(double x, const T* p) {
    return p[0] - p[1] / x;
  }
};

}  // namespace

const Law& arrhenius_law() {
  static const Law law = make_law<Arrhenius>(
      {.name = "arrhenius",
       .formula = "ln y = c - E_b/x",
       .source = "Fortini & Huang 2015, sec. V, with x = K_m and y = p_s",
       .parameters = {"c", "E_b"},
       .logarithmic = true,
       .positive_x = true,
       .axis = Law::Axis::reciprocal,
       .lost = {},
       .starts = [](const std::vector<FitPoint>& points) {
         return Starts{
             least_squares(points, {[](double) { return 1.0; }, [](double x) { return -1 / x; }}).first};
       }});
  return law;
}

}  // namespace twincell::calibration
