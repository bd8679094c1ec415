#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct Line {
  static constexpr int kParameters = 2;
  template <class T>
  static T value(double x, const T* p) {
    return p[0] + p[1] * x;
  }
};

}  // namespace

const Law& line_law() {
  static const Law law = make_law<Line>(
      {.name = "line",
       .formula = "y = a + b x",
       .source = "a straight line",
       .parameters = {"a", "b"},
       .lost = {},
       .starts = [](const std::vector<FitPoint>& points) {
         return Starts{least_squares(points, {[](double) { return 1.0; }, [](double x) { return x; }}).first};
       }});
  return law;
}

}  // namespace twincell::calibration
