#include "cli/cost_gas.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "analysis/report/figure_style.hpp"
#include "sim/accuracy/work_precision.hpp"

namespace twincell::cli {

namespace {

using analysis::figure_style::PlotAxis;
using sim::GasCase;
using sim::GasTemperature;
using sim::StepSetting;

struct Method {
  StepSetting setting;
  bool event_driven;
};

std::string name_of(const GasTemperature& g) {
  const std::string steps = fmt::format("{}, n = {:g}", g.setting.integrator, g.setting.n);
  return g.gas.event_driven ? "event-driven; " + steps : steps;
}

/// The methods that are compared. The first is that of the paper's own simulations.
std::vector<Method> methods(bool quick) {
  const StepSetting verlet{}, fine{.integrator = "split", .n = 25.37},
      coarse{.integrator = "split", .n = 10.37};
  if (quick) return {{verlet, false}, {coarse, false}, {coarse, true}};
  return {{verlet, false}, {fine, false}, {coarse, false}, {fine, true}, {coarse, true}};
}

/// The temperatures of one gas by all methods; the first is by the first of methods().
using SystemTemperatures = std::vector<GasTemperature>;

constexpr double kW = 50;  ///< drive strength; strong

std::vector<SystemTemperatures> measure_temperatures(bool quick, const Common& common) {
  const std::vector<std::string> systems =
      quick ? std::vector<std::string>{"rough-2d"} : std::vector<std::string>{"rough-2d", "smooth-3d"};
  std::vector<SystemTemperatures> all;
  for (const std::string& system : systems) {
    all.emplace_back();
    for (const Method& m : methods(quick)) {
      const GasCase gas{system, kW, m.event_driven};
      ProgressBar bar(common,
                      fmt::format("{}, {}{}, n = {:g}", system, m.event_driven ? "event-driven, " : "",
                                  m.setting.integrator, m.setting.n));
      all.back().push_back(sim::gas_temperature(m.setting, gas, quick ? 600 : 3000, bar));
    }
  }
  return all;
}

/// Processor time of one period, ms.
double ms_per_period(const GasTemperature& g) {
  return 1e3 * g.seconds / g.periods;
}

/// Difference of two values of T_z in combined standard errors.
double errors_from(const GasTemperature& first, const GasTemperature& g) {
  return (g.value - first.value) / std::hypot(g.standard_error, first.standard_error);
}

const GasTemperature& cheapest_of(const SystemTemperatures& of_system) {
  const GasTemperature* cheapest = &of_system.front();
  for (const GasTemperature& g : of_system)
    if (g.seconds / g.periods < cheapest->seconds / cheapest->periods) cheapest = &g;
  return *cheapest;
}

/// Time per period of the first method divided by that of the cheapest.
double gain_of(const SystemTemperatures& of_system) {
  const GasTemperature &first = of_system.front(), &cheapest = cheapest_of(of_system);
  return first.seconds / first.periods / (cheapest.seconds / cheapest.periods);
}

nlohmann::json as_json(const std::vector<SystemTemperatures>& all, double accuracy) {
  nlohmann::json d;
  for (const SystemTemperatures& of_system : all) {
    const GasTemperature& first = of_system.front();
    for (const GasTemperature& g : of_system)
      d["gas"].push_back({{"system", g.gas.system},
                          {"w", g.gas.w},
                          {"stepping", g.gas.event_driven ? "event-driven" : "steps"},
                          {"integrator", g.setting.integrator},
                          {"n", g.setting.n},
                          {"t_z", g.value},
                          {"standard_error", g.standard_error},
                          {"periods", g.periods},
                          {"seconds", g.seconds},
                          {"ms_per_period", ms_per_period(g)},
                          {"seconds_to_accuracy", g.seconds_to(accuracy)},
                          {"errors_from_first", errors_from(first, g)}});
    d["gain"][first.gas.system] = gain_of(of_system);
  }
  d["accuracy"] = accuracy;
  return d;
}

std::string as_text(const std::vector<SystemTemperatures>& all, double accuracy) {
  std::string s = fmt::format(
      "T_z of the gases of the second paper at W = {:g}: processor time per period, T_z, and the time after "
      "which its\n"
      "statistical error is {:g} of its value (this error falls with the square root of the length of a "
      "run).\n",
      kW, accuracy);
  for (const SystemTemperatures& of_system : all) {
    const GasTemperature& first = of_system.front();
    s += fmt::format("\n{}\n", first.gas.system);
    for (const GasTemperature& g : of_system) {
      s += fmt::format("  {:<26} {:8.3f} ms  {:.4f} +- {:.4f} m V_p^2 from {} periods  {:8.3g} s", name_of(g),
                       ms_per_period(g), g.value, g.standard_error, g.periods, g.seconds_to(accuracy));
      s += &g == &first ? "\n" : fmt::format("  {:+.1f} errors from the first\n", errors_from(first, g));
    }
    s += fmt::format("  {} needs {:.1f} times less time per period than {}\n",
                     name_of(cheapest_of(of_system)), gain_of(of_system), name_of(first));
  }
  return s;
}

/// Adds the data of a run to the figure: its error after the time that it took, and after a tenth of it and
/// up to a hundred times as long, because the error falls with the square root of the length.
void add_data(analysis::Figure& f, const GasTemperature& g, PlotAxis& time, PlotAxis& error) {
  f.data += fmt::format("# {}, {}: s of processor time, relative standard error of T_z\n", g.gas.system,
                        name_of(g));
  for (const double times : {0.1, 1.0, 10.0, 100.0}) {
    const double seconds = times * g.seconds, relative = g.standard_error / g.value / std::sqrt(times);
    time.show(seconds);
    error.show(relative);
    f.data += fmt::format("{:.4g} {:.4g}\n", seconds, relative);
  }
  f.data += "\n\n";
}

analysis::Figure figure(const std::vector<SystemTemperatures>& all, double accuracy) {
  analysis::Figure f{.name = "gas_cost",
                     .title = "Accuracy against computing time: T_z of a gas",
                     .width = 720,
                     .height = static_cast<int>(380 * all.size())};
  std::string panels;
  std::size_t panel = 0;
  int index = 0;
  for (const SystemTemperatures& of_system : all) {
    const GasTemperature& first = of_system.front();
    PlotAxis time{.label = "processor time, s", .logarithmic = true},
        error{.label = "standard error of T_z/T_z", .logarithmic = true};
    error.show(accuracy);
    std::string clauses;
    for (const GasTemperature& g : of_system) {
      add_data(f, g, time, error);
      // A line shows the error of longer and shorter runs; a point marks the run that was made.
      clauses += fmt::format(
          "'{0}.dat' index {1} with lines dt {2} lw {3} lt {4} title '{5}', '' index {1} every ::1::1 "
          "with points lt {4} notitle, ",
          f.name, index, g.gas.event_driven ? 1 : 2, analysis::figure_style::kCurve, 1 + &g - &first,
          name_of(g));
      ++index;
    }
    panels +=
        analysis::figure_style::axes(time, error) +
        analysis::figure_style::panel_title(static_cast<char>('a' + panel++), first.gas.system) +
        fmt::format("plot {}{} with lines {} notitle\n", clauses, accuracy, analysis::figure_style::kStated);
  }
  f.plot = fmt::format("set multiplot layout {},1\nset key outside right top vertical\n{}unset multiplot\n",
                       all.size(), panels);
  return f;
}

}  // namespace

CostReport cost_of_gas(double accuracy, bool quick, const Common& common) {
  const std::vector<SystemTemperatures> all = measure_temperatures(quick, common);
  return {as_json(all, accuracy), as_text(all, accuracy), figure(all, accuracy)};
}

}  // namespace twincell::cli
