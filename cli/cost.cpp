// twincell cost sim: accuracy and time of the integrators and time steps. cost gas, cost locate and cost
// calibration have their own files.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure.hpp"
#include "analysis/report/figure_style.hpp"
#include "cli/cost_calibration.hpp"
#include "cli/cost_gas.hpp"
#include "cli/cost_locate.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "sim/accuracy/work_precision.hpp"

namespace twincell::cli {

namespace {

using sim::StepSetting;
using sim::WorkPrecision;

Product cost_folder() {
  return Product::whole_folder("a study of costs");
}

struct CostOptions {
  std::string what, output;
  std::optional<double> accuracy;
  bool quick = false;
};

const StepSetting kReference{};  ///< the setting of the papers' simulations: Verlet, some 50 steps

struct Measured {
  std::vector<WorkPrecision> all;
  std::vector<sim::GasTemperature> gas;
  WorkPrecision reference, equal, equal_mean;
  sim::EqualImpacts equal_impacts;
  double accuracy = 0;
  std::optional<WorkPrecision> cheapest;

  [[nodiscard]] double time_ratio(const WorkPrecision& w) const {
    return reference.cost.seconds_per_time / w.cost.seconds_per_time;
  }
};

Measured measure(const CostOptions& options, const Common& common) {
  constexpr double kAccuracy = 1e-3;
  Measured m;
  m.accuracy = options.accuracy.value_or(kAccuracy);
  {
    ProgressBar bar(common, "errors and times");
    m.all = sim::work_precision(sim::study_settings(options.quick), options.quick ? 1 : 3, bar);
  }
  m.reference = *std::find_if(m.all.begin(), m.all.end(),
                              [](const WorkPrecision& w) { return w.setting == kReference; });
  m.equal = sim::equal_accuracy(m.all, m.reference);
  m.equal_mean = sim::equal_accuracy(m.all, m.reference, true);
  m.cheapest = sim::cheapest(m.all, sim::kPaperStiffness, m.accuracy);
  m.equal_impacts = sim::equal_impacts(sim::bed_impacts(), sim::impact_scene(), "verlet", "split",
                                       sim::kComparedSpinError, sim::kBedPhases);
  std::vector<StepSetting> in_gas = {kReference};
  for (const StepSetting& s : {m.equal.setting, sim::longest_study_step()})
    if (std::find(in_gas.begin(), in_gas.end(), s) == in_gas.end()) in_gas.push_back(s);
  for (const StepSetting& s : in_gas) {
    ProgressBar bar(common, fmt::format("gas, {}, n = {:g}", s.integrator, s.n));
    m.gas.push_back(sim::gas_temperature(s, {}, options.quick ? 50 : 1500, bar));
  }
  return m;
}

nlohmann::json as_json(const StepSetting& s) {
  return {{"integrator", s.integrator}, {"n", s.n}, {"k_n", s.k_n}};
}
nlohmann::json as_json(const sim::EntryPhaseSpread& s) {
  return {{"mean", s.mean}, {"rms", s.rms}, {"max", s.largest}};
}
nlohmann::json as_json(const StepSetting& s, const sim::ImpactErrors& e) {
  nlohmann::json d = as_json(s);
  d["restitution"] = as_json(e.restitution);
  d["tangential"] = as_json(e.tangential);
  d["spin"] = as_json(e.spin);
  d["spin_change"] = e.spin_change;
  return d;
}
nlohmann::json as_json(const WorkPrecision& w) {
  nlohmann::json d = as_json(w.setting);
  d["error"] = w.collision.restitution();
  d["restitution"] = {{"pair", as_json(w.collision.restitution_pair)},
                      {"wall", as_json(w.collision.restitution_wall)}};
  d["oblique"] = {{"pair", as_json(w.collision.sticking_pair)}, {"wall", as_json(w.collision.sticking_wall)}};
  d["bed"] = {{"kinetic_energy_per_bead", w.bed.kinetic_energy},
              {"floor_force", w.bed.floor_force},
              {"overlap", w.bed.overlap}};
  d["seconds_per_bead"] = {{"step", w.cost.seconds_per_time * w.cost.dt},
                           {"contact_time", w.cost.seconds_per_time * w.cost.contact_time},
                           {"t0", w.cost.seconds_per_time}};
  return d;
}

nlohmann::json as_json(const Measured& m) {
  nlohmann::json d;
  for (const WorkPrecision& w : m.all) d["settings"].push_back(as_json(w));
  for (const WorkPrecision& w : m.all) d["sliding"].push_back(as_json(w.setting, w.impacts));
  for (const WorkPrecision& w : sim::front(m.all, sim::kPaperStiffness)) d["front"].push_back(as_json(w));
  for (const sim::GasTemperature& g : m.gas) {
    nlohmann::json one = as_json(g.setting);
    one["t_z"] = g.value;
    one["standard_error"] = g.standard_error;
    one["periods"] = g.periods;
    one["seconds"] = g.seconds;
    one["seconds_to_one_percent"] = g.seconds_to(0.01);
    d["gas"].push_back(one);
  }
  const auto ratio = [&](const WorkPrecision& w) {
    return nlohmann::json{{"verlet", as_json(m.reference)},
                          {"split", as_json(w)},
                          {"step_ratio", m.reference.setting.n / w.setting.n},
                          {"time_ratio", m.time_ratio(w)}};
  };
  d["equal_accuracy"] = ratio(m.equal);
  d["equal_mean_accuracy"] = ratio(m.equal_mean);
  d["equal_impacts"] = {{"spin_share", sim::kComparedSpinError},
                        {"verlet", as_json(m.equal_impacts.slow, m.equal_impacts.slow_errors)},
                        {"split", as_json(m.equal_impacts.fast, m.equal_impacts.fast_errors)},
                        {"step_ratio", m.equal_impacts.slow.n / m.equal_impacts.fast.n}};
  d["accuracy"] = m.accuracy;
  d["cheapest"] = m.cheapest ? as_json(*m.cheapest) : nlohmann::json();
  return d;
}

std::string table(const std::vector<WorkPrecision>& rows) {
  std::string s =
      fmt::format("  {:<9} {:>7} {:>5}  {:>8} {:>8}  {:>8}  {:>8} {:>8}  {:>6} {:>8} {:>7}\n", "integrator",
                  "n", "k_n", "mean e", "max e", "oblique", "floor", "overlap", "step", "contact", "t0");
  for (const WorkPrecision& w : rows) {
    const auto& e = w.collision;
    const double mean = std::abs(e.restitution_pair.mean) > std::abs(e.restitution_wall.mean)
                            ? e.restitution_pair.mean
                            : e.restitution_wall.mean;
    s += fmt::format(
        "  {:<9} {:>7g} {:>5.0e}  {:>+8.1e} {:>8.1e}  {:>8.1e}  {:>8.1e} {:>8.1e}  {:>6.1f} {:>8.3f} "
        "{:>7.1f}\n",
        w.setting.integrator, w.setting.n, w.setting.k_n, mean, e.restitution(), e.sticking(),
        w.bed.floor_force, w.bed.overlap, 1e9 * w.cost.seconds_per_time * w.cost.dt,
        1e6 * w.cost.seconds_per_time * w.cost.contact_time, 1e6 * w.cost.seconds_per_time);
  }
  return s;
}

std::string named(const StepSetting& s) {
  return fmt::format("{}, n = {:g}", s.integrator, s.n);
}

/// Table of the errors in the impacts of a driven bed, one row per setting.
std::string sliding_table(const Measured& m, const std::vector<WorkPrecision>& rows) {
  std::string s = fmt::format(
      "\nImpacts of a driven bed, sliding and sticking (200 impacts at Gamma = 2 and 3): errors of e, and "
      "errors of v_t' and\n"
      "R w' over the speed of the surfaces; friction changes R w by {:.3f} of that speed, rms\n"
      "  {:<9} {:>7}  {:>8} {:>8}  {:>8} {:>8}  {:>8} {:>8}\n",
      m.reference.impacts.spin_change, "integrator", "n", "e rms", "max", "v_t rms", "max", "R w rms", "max");
  for (const WorkPrecision& w : rows) {
    const sim::ImpactErrors& e = w.impacts;
    s += fmt::format("  {:<9} {:>7g}  {:>8.1e} {:>8.1e}  {:>8.1e} {:>8.1e}  {:>8.1e} {:>8.1e}\n",
                     w.setting.integrator, w.setting.n, e.restitution.rms, e.restitution.largest,
                     e.tangential.rms, e.tangential.largest, e.spin.rms, e.spin.largest);
  }
  const sim::EqualImpacts& equal = m.equal_impacts;
  return s + fmt::format(
                 "  For an rms error of the spin of {:g} %: verlet, n = {:.4g}; at least as accurate in e, "
                 "v_t' and R w': split, n = {:.3g}, {:.0f} times fewer steps\n",
                 100 * sim::kComparedSpinError, equal.slow.n, equal.fast.n, equal.slow.n / equal.fast.n);
}

std::string as_text(const Measured& m) {
  std::string s =
      "Errors: of e, mean and largest over entry phases (the larger of pair and plate); oblique: largest of "
      "v_t'/v_t without\n"
      "slip; floor and overlap: floor force and overlaps at rest. Time per bead: ns per step, us per contact "
      "time, us per t0.\n";
  std::vector<WorkPrecision> own, others;
  for (const WorkPrecision& w : m.all) {
    const auto like = [&](const StepSetting& o) {
      return w.setting.integrator == o.integrator && w.setting.n == o.n;
    };
    if (w.setting.k_n == sim::kPaperStiffness)
      own.push_back(w);
    else if (like(m.reference.setting) || like(m.equal.setting))
      others.push_back(w);
  }
  s += table(own);
  if (!others.empty()) s += "\nOther values of k_n\n" + table(others);
  s += fmt::format("\nFront, k_n = {:g}: no other setting is both faster and more accurate\n",
                   sim::kPaperStiffness) +
       table(sim::front(m.all, sim::kPaperStiffness));
  s += sliding_table(m, own);
  s += "\nT_z of a driven gas, 40 beads, W = 20\n";
  for (const sim::GasTemperature& g : m.gas) {
    const sim::GasTemperature& first = m.gas.front();
    s += fmt::format(
        "  {:<20} {:.4f} +- {:.4f} m V_p^2 from {} periods in {:.3g} s; an error of 1 % takes {:.3g} s",
        named(g.setting), g.value, g.standard_error, g.periods, g.seconds, g.seconds_to(0.01));
    if (&g != &first)
      s += fmt::format("; {:+.1f} standard errors from the first",
                       (g.value - first.value) / std::hypot(g.standard_error, first.standard_error));
    s += "\n";
  }
  double apart = 0;
  for (const sim::GasTemperature& g : m.gas)
    apart = std::max(apart, std::abs(g.value / m.gas.front().value - 1));
  const sim::GasTemperature& first = m.gas.front();
  s += fmt::format(
      "  These steps change T_z by at most {:.1f} %, while the statistical error of a run is {:.1f} %. A "
      "tenth of that error\n"
      "  takes a hundred times as long; the choice of the step saves at most a factor of {:.1f}.\n",
      100 * apart, 100 * first.standard_error / first.value,
      first.seconds / std::min_element(m.gas.begin(), m.gas.end(), [](const auto& x, const auto& y) {
                        return x.seconds < y.seconds;
                      })->seconds);
  const auto equal = [&](const WorkPrecision& w) {
    return fmt::format("{} ({:.1e}): {:.2f} times fewer steps, {:.2f} times less time\n", named(w.setting),
                       w.collision.restitution(), m.reference.setting.n / w.setting.n, m.time_ratio(w));
  };
  s += fmt::format("\nCheapest setting that is at least as accurate as {} (largest error of e {:.1e}):\n",
                   named(m.reference.setting), m.reference.collision.restitution());
  s += "  in every collision:        " + equal(m.equal);
  s += "  and in the mean over many: " + equal(m.equal_mean);
  s += m.cheapest
           ? fmt::format("Largest error of e at most {:g}: {} ({:.1e}), {:.1f} us per bead and t0\n",
                         m.accuracy, named(m.cheapest->setting), m.cheapest->collision.restitution(),
                         1e6 * m.cheapest->cost.seconds_per_time)
           : fmt::format("No setting measured has a largest error of e of at most {:g}.\n", m.accuracy);
  return s;
}

/// Figure of three panels against time: error of head-on collisions, error of oblique collisions without
/// slip, and error of the spin in the impacts of a bed. One curve per integrator; the curves at the papers'
/// k_n are bold.
analysis::Figure figure(const Measured& m) {
  struct Style {
    const char* integrator;
    const char* colour;
    int point;
  };
  // Each colour also has its own point shape.
  constexpr std::array<Style, 3> kStyles = {
      {{"verlet", analysis::colours::kBlue, analysis::figure_style::kCircle},
       {"predicted", analysis::colours::kOrange, analysis::figure_style::kSquare},
       {"split", analysis::colours::kVermilion, analysis::figure_style::kTriangle}}};
  analysis::Figure f{
      .name = "work_precision", .title = "Accuracy against computing time", .width = 720, .height = 760};
  analysis::figure_style::PlotAxis time{.label = "processor time, µs per bead and t_0", .logarithmic = true};
  std::array<analysis::figure_style::PlotAxis, 3> errors;
  errors.fill({.label = "error", .logarithmic = true});
  std::vector<double> stiffnesses;
  for (const WorkPrecision& w : m.all)
    if (std::find(stiffnesses.begin(), stiffnesses.end(), w.setting.k_n) == stiffnesses.end())
      stiffnesses.push_back(w.setting.k_n);
  std::array<std::string, 3> clauses;
  int index = 0;
  for (const double k_n : stiffnesses)
    for (const Style& style : kStyles) {
      f.data +=
          fmt::format("# {} k_n {:g}: us a bead and t0, largest error of e, of v_t'/v_t, rms of R w', n\n",
                      style.integrator, k_n);
      for (const WorkPrecision& w : m.all)
        if (w.setting.k_n == k_n && w.setting.integrator == style.integrator) {
          time.show(1e6 * w.cost.seconds_per_time);
          errors[0].show(w.collision.restitution());
          errors[1].show(w.collision.sticking());
          errors[2].show(w.impacts.spin.rms);
          f.data +=
              fmt::format("{:.4g} {:.3e} {:.3e} {:.3e} {:g}\n", 1e6 * w.cost.seconds_per_time,
                          w.collision.restitution(), w.collision.sticking(), w.impacts.spin.rms, w.setting.n);
        }
      f.data += "\n\n";
      const bool bold = k_n == sim::kPaperStiffness;
      for (std::size_t panel = 0; panel < clauses.size(); ++panel)
        clauses[panel] += fmt::format(
            "{}'{}.dat' index {} using 1:{} with linespoints pt {} ps {} lw {} lc rgb '{}' notitle",
            clauses[panel].empty() ? "" : ", ", f.name, index, panel + 2, style.point, bold ? 0.9 : 0.4,
            bold ? analysis::figure_style::kCurve : 0.7, style.colour);
      ++index;
    }
  constexpr std::array<const char*, 3> kTitles = {"head-on: largest |e − e_{exact}|",
                                                  "oblique, no slip: largest, v_t^′/v_t",
                                                  "impacts of a bed: rms, Rω^′/v"};
  const analysis::figure_style::Panels panels(2, 2, f.width, f.height, 1);
  f.plot = analysis::figure_style::Panels::begin();
  for (std::size_t panel = 0; panel < clauses.size(); ++panel)
    f.plot += panels.panel(panel) + analysis::figure_style::axes(time, errors[panel]) +
              analysis::figure_style::panel_title("abc"[panel], kTitles[panel]) +
              fmt::format("plot {}\n", clauses[panel]);
  std::vector<std::string> key;
  for (const Style& style : kStyles)
    key.push_back(fmt::format("keyentry with linespoints pt {} ps 0.9 lc rgb '{}' title '{}'", style.point,
                              style.colour, style.integrator));
  f.plot += panels.end(key);
  f.caption =
      "Errors of single collisions and of the impacts of a bed against the processor time. Bold: k_n of the "
      "papers; thin: other k_n.";
  return f;
}

CostReport cost_of_stepping(const CostOptions& options, const Common& common) {
  const Measured m = measure(options, common);
  return {as_json(m), as_text(m), figure(m)};
}

void run(const CostOptions& options, const Common& common) {
  constexpr double kAccuracy_px = 0.01, kAccuracy_gas = 0.01;
  const bool locate = options.what == "locate";
  if (options.accuracy && options.what == "calibration")
    throw ConfigError({.file = {}, .key = "--accuracy"},
                      "has no effect on cost calibration, which has no setting to choose.");
  if (options.accuracy)
    require_range({.file = {}, .key = "--accuracy"}, *options.accuracy, locate ? 1e-6 : 1e-12,
                  locate ? 100 : 1);
  std::optional<AtomicPath> folder;  // opened first: an unwritable folder is reported before the work
  if (!options.output.empty()) {
    folder.emplace(options.output, cost_folder());
  }
  CostReport report =
      locate ? cost_of_locating(options.accuracy.value_or(kAccuracy_px), options.quick, common)
      : options.what == "gas" ? cost_of_gas(options.accuracy.value_or(kAccuracy_gas), options.quick, common)
      : options.what == "calibration" ? cost_of_calibrating(options.quick, common)
                                      : cost_of_stepping(options, common);
  report.document["provenance"] = nlohmann::json::parse(common.provenance().to_json());
  if (folder) {
    analysis::draw(report.figure, folder->part());
    write_text_file(folder->part() / "table.txt", report.text);
    folder->commit();
    report.document["output"] = options.output;
    report.text += options.output + "\n";
  }
  print_result(common, report.document, report.text);
}

}  // namespace

void add_cost(CLI::App& program, Common& common) {
  auto options = std::make_shared<CostOptions>();
  CLI::App& verb = add_verb(program, common, "cost",
                            "Measure accuracy against computing time of the simulator, the locator or the "
                            "calibration. Prints a table; -o also writes it to a folder, with a figure.",
                            "twincell cost sim --quick --accuracy 1e-3 -o cost");
  verb.add_option("what", options->what,
                  "What to measure. sim: integrators, steps per contact, stiffness; gas: time steps and "
                  "event-driven motion for the temperature of a gas; locate: finders, fit, noise, pixels per "
                  "bead; calibration: number of frames")
      ->required()
      ->check(CLI::IsMember({"sim", "gas", "locate", "calibration"}));
  writes(common, verb, verb.add_option("-o,--output", options->output, "Folder for the figure and the table"),
         cost_folder());
  verb.add_option("--accuracy", options->accuracy,
                  "Requested accuracy, for which the cheapest setting (sim, locate) or the time (gas) is "
                  "printed. sim: largest error of e, 1e-12 to 1, default 1e-3; gas: relative error of T_z, "
                  "1e-12 to 1, default 0.01; locate: rms error, px, 1e-6 to 100, default 0.01");
  verb.add_flag("--quick", options->quick, "Measure fewer settings, and time each only once");
  verb.callback([options, &common] { run(*options, common); });
}

}  // namespace twincell::cli
