#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct Constant {
  static constexpr int kParameters = 1;
  template <class T>
  static T value(double /*x*/, const T* p) {
    return p[0];
  }
};

}  // namespace

const Law& constant_law() {
  static const Law law =
      make_law<Constant>({.name = "constant",
                          .formula = "y = a",
                          .source = "a mean",
                          .parameters = {"a"},
                          .lost = {},
                          .starts = [](const std::vector<FitPoint>& points) {
                            return Starts{least_squares(points, {[](double) { return 1.0; }}).first};
                          }});
  return law;
}

}  // namespace twincell::calibration
