#include "calibration/laws/model.hpp"

namespace twincell::calibration {
namespace {

struct ArrheniusBreak {
  static constexpr int kParameters = 4;
  template <class T>
  static T value(double x, const T* p) {
    const T beyond = 1.0 / x - 1.0 / p[3];
    return p[0] - (beyond > T(0) ? p[1] : p[2]) * beyond;
  }
};

}  // namespace

const Law& arrhenius_break_law() {
  static const Law law =
      make_law<ArrheniusBreak>({.name = "arrhenius_break",
                                .formula = "ln y = ln_y_b - E (1/x - 1/x_b), E = E_1 below x_b and E_2 above",
                                .source = "Fortini & Huang 2015, Fig. 5(b), with x = K_m and y = p_s",
                                .parameters = {"ln_y_b", "E_1", "E_2", "x_b"},
                                .logarithmic = true,
                                .positive_x = true,
                                .axis = Law::Axis::reciprocal,
                                .nested = "arrhenius",
                                .lost = {"x_b"},
                                .starts =
                                    [](const std::vector<FitPoint>& points) {
                                      // In u = 1/x, x < x_b is above the bend.
                                      auto starts = bend_starts(points, [](double x) { return 1 / x; });
                                      for (auto& s : starts) s = {s[0], -s[2], -s[1], 1 / s[3]};
                                      return starts;
                                    },
                                .squares_bent_at =
                                    [](const std::vector<FitPoint>& points, double bend) {
                                      const auto u = [](double x) { return 1 / x; };
                                      return bent_line(points, u, u(bend)).second;
                                    }});
  return law;
}

}  // namespace twincell::calibration
