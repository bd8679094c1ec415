// Bhateja, Sharma & Singh 2016, Fig. 11: T_z/(m g d) for several A/d at fixed W, and against W at A = d.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

constexpr double kW[] = {4.52, 5.58, 8.04};
constexpr double kAmplitudes[] = {1, 0.5, 0.1};

/// T_z at kW[i] and kAmplitudes[j].
std::optional<Estimate> t_z(const Gas& gas, std::size_t i, std::size_t j) {
  return gas.points(j)[i].get("T_z");
}

/// Mean over the three W of 100 (T_z(j)/T_z(k) - 1), in %, with its interval.
std::optional<Estimate> mean_change(const Gas& gas, std::size_t j, std::size_t k) {
  Estimate sum{.value = 0, .low = {}, .high = {}};
  double squares = 0;
  for (std::size_t i = 0; i < std::size(kW); ++i) {
    const auto a = t_z(gas, i, j), b = t_z(gas, i, k);
    if (!a || !b) return std::nullopt;
    const Estimate q = quotient(*a, *b);
    sum.value += 100 * (q.value - 1) / 3;
    squares += q.low ? std::pow(100 * (*q.high - *q.low) / 2 / 3, 2) : std::nan("");
  }
  if (std::isfinite(squares)) {
    sum.low = sum.value - std::sqrt(squares);
    sum.high = sum.value + std::sqrt(squares);
  }
  return sum;
}

/// |e| with its interval.
Estimate size_of(const Estimate& e) {
  Estimate size{.value = std::abs(e.value), .low = {}, .high = {}};
  if (!e.low || !e.high) return size;
  size.low = std::max({0.0, *e.low, -*e.high});
  size.high = std::max(-*e.low, *e.high);
  return size;
}

Reproduction run(const Request& request) {
  const GasSize& size = gas_size_for(request, 0.15);
  Gas gas(request);
  for (const double amplitude : kAmplitudes)
    gas.add({.name = fmt::format("2D rough, A/d = {:g}", amplitude),
             .scene = fmt::format("preset = \"bhateja-2016-rough-2d\"\ndrive.amplitude = {}", amplitude),
             .values = {std::begin(kW), std::end(kW)},
             .relative_error = size.relative_error / 2,  // the differences are a few per cent
             // At fixed W the period is proportional to the amplitude, but the relaxation times of the bed
             // are not.
             .cycles = static_cast<int>(2 * size.cycles / amplitude),
             .discard = static_cast<int>(100 / amplitude)});
  Reproduction r;
  r.title = "Bhateja et al. 2016, Fig. 11: temperature with amplitude at fixed W";
  r.complete = gas.run();
  Target rise{"T_z(W = 8.04)/T_z(4.52) at A = d", "1.50 +- 0.05", "", Verdict::absent, ""};
  if (const auto a = t_z(gas, 2, 0), b = t_z(gas, 0, 0); a && b) {
    const Estimate q = quotient(*a, *b);
    rise.measured = q.text();
    rise.verdict = judge(q, 1.45, 1.55);
  }
  Target fall{"A/d from 1 to 0.1 at fixed W, mean change", "-15 % +- 4 %", "", Verdict::absent, ""};
  if (const auto change = mean_change(gas, 2, 0)) {
    fall.measured = change->text() + " %";
    fall.verdict = judge(*change, -19, -11);
  }
  Target small{"A/d from 0.5 to 0.1 at fixed W, mean change", "3 % +- 2 % in size", "", Verdict::absent, ""};
  if (const auto change = mean_change(gas, 2, 1)) {
    small.measured = change->text() + " %";
    small.verdict = judge(size_of(*change), 1, 5);
  }
  r.targets = {rise, fall, small};
  std::vector<Series> all;
  for (std::size_t j = 0; j < std::size(kAmplitudes); ++j)
    all.push_back(series_of(fmt::format("A/d = {:g}", kAmplitudes[j]), gas.points(j), "T_z"));
  r.table = gas.table();
  r.measured = gas.as_json();
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  r.cheaper.emplace_back("A/d = 1, 0.5, 0.1 alone");
  SeriesFigure figure{
      .name = "p2-fig11",
      .panel = 0,
      .title = "Amplitude at fixed W, 2D rough, N = 4",
      .x = {.label = "W = V_p^2/(d g)"},
      .y = {.label = "T_z/(m g d)", .low = 0},
      .caption =
          "At each W the amplitude falls from A = d (circles) to 0.1 d, with 95 % intervals. "
          "Dashed: what the paper's text states, from the circle at W = 4.52 to 1.5 times its "
          "T_z at 8.04, and 15 % below the circles, its mean change for A = 0.1 d. Form of "
          "Bhateja et al. 2016, Fig. 11."};
  constexpr double kStatedRise = 1.5, kStatedFall = 0.85,
                   kHalfWidth_W = 0.12;  // the paper: +50 %, -15 %; a drawn dash
  const auto stated = [&](double x_1, double y_1, double x_2, double y_2) {
    figure.marks += fmt::format("set arrow from {:.6g},{:.6g} to {:.6g},{:.6g} nohead back {}\n", x_1, y_1,
                                x_2, y_2, analysis::figure_style::kStated);
    figure.y.show(y_2);
  };
  if (const auto t = t_z(gas, 0, 0)) {
    stated(kW[0], t->value, kW[2], kStatedRise * t->value);
    figure.entries = {analysis::figure_style::stated_line_entry("paper: +50 %; −15 %")};
  }
  for (std::size_t i = 0; i < std::size(kW); ++i)
    if (const auto t = t_z(gas, i, 0))
      stated(kW[i] - kHalfWidth_W, kStatedFall * t->value, kW[i] + kHalfWidth_W, kStatedFall * t->value);
  r.figures = {series_figure(figure, all)};
  return r;
}

}  // namespace

Reproducible p2_fig11() {
  return gas_entry("p2-fig11", "temperature against amplitude at fixed W", run);
}

}  // namespace twincell::reproduce
