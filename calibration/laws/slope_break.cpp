#include <cmath>

#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct SlopeBreak {
  static constexpr int kParameters = 4;
  template <class T>
  static T value(double x, const T* p) {
    using std::log;
    // ln |x_b|, so that a trial step below 0 has a finite value and is rejected for its cost.
    const T beyond = std::log(x) - 0.5 * log(p[3] * p[3]);
    return p[0] + (beyond < T(0) ? p[1] : p[2]) * beyond;
  }
};

}  // namespace

const Law& slope_break_law() {
  static const Law law =
      make_law<SlopeBreak>({.name = "slope_break",
                            .formula = "ln y = ln_y_b + s ln(x/x_b), s = s_1 below x_b and s_2 above",
                            .source = "Fortini & Huang 2015, Fig. 4",
                            .parameters = {"ln_y_b", "s_1", "s_2", "x_b"},
                            .logarithmic = true,
                            .positive_x = true,
                            .axis = Law::Axis::logarithmic,
                            .nested = "power",
                            .lost = {"x_b"},
                            .starts =
                                [](const std::vector<FitPoint>& points) {
                                  auto starts = bend_starts(points, [](double x) { return std::log(x); });
                                  for (auto& start : starts) start[3] = std::exp(start[3]);
                                  return starts;
                                },
                            .squares_bent_at =
                                [](const std::vector<FitPoint>& points, double bend) {
                                  const auto u = [](double x) { return std::log(x); };
                                  return bent_line(points, u, u(bend)).second;
                                }});
  return law;
}

}  // namespace twincell::calibration
