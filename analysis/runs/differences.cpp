#include "analysis/runs/differences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "analysis/motion/tracers.hpp"
#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/runs/scaling_exponents.hpp"
#include "analysis/statistics/statistics.hpp"
#include "core/plural.hpp"

namespace twincell::analysis {
namespace {

/// A difference is significant if it exceeds at least this many standard errors.
constexpr double kSignificant = 2;
/// Minimum number of runs of one start for a reliable spread between seeds.
constexpr std::size_t kFewSeeds = 5;
/// Heights of the lines of tracers above mid-height, sigma.
constexpr std::array<double, 3> kLines = {-1, 0, 1};

/// The finite scalar result called `name`, or null.
const Result* scalar(const std::vector<Result>& results, const std::string& name) {
  const Result* found = seek_result(results, name);
  const bool usable = found != nullptr && found->present() && found->shape.empty() && found->text.empty() &&
                      std::isfinite(found->value());
  return usable ? found : nullptr;
}

/// Standard error from a result's interval. Absent for a number that never changed: its interval consists of
/// rounding errors and does not measure its uncertainty.
std::optional<double> standard_error(const Result& r) {
  if (!r.interval || !std::isfinite(r.interval->high - r.interval->low)) return std::nullopt;
  const double error = standard_error(uncut_interval(r));
  return error > 1e-12 * std::abs(r.value()) ? std::optional(error) : std::nullopt;
}

std::optional<double> in_quadrature(std::initializer_list<std::optional<double>> parts) {
  double sum = 0;
  bool any = false;
  for (const auto& part : parts)
    if (part) {
      sum += *part * *part;
      any = true;
    }
  return any ? std::optional(std::sqrt(sum)) : std::nullopt;
}

double deviation(const std::vector<double>& values) {
  const double m = mean(values);
  double sum = 0;
  for (const double v : values) sum += (v - m) * (v - m);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

/// Value of a result; an angle, which has the period of a hexagonal lattice, at its place nearest to
/// `reference`.
double value_near(const Result& r, double reference) {
  if (named_result(r.name).pooling != Pooling::angle) return r.value();
  return reference + std::remainder(r.value() - reference, kLatticePeriodDegrees);
}

/// Mean of a number over the runs `members`, with its error from their intervals. \param reference for an
/// angle
std::optional<Measured> measured(const std::vector<Run>& runs, const std::vector<std::size_t>& members,
                                 const std::string& name, double reference) {
  std::vector<double> values;
  double squares = 0;
  bool all = true;
  for (const std::size_t i : members) {
    const Result* r = scalar(runs[i].results, name);
    if (r == nullptr) continue;
    values.push_back(value_near(*r, reference));
    const auto error = standard_error(*r);
    all = all && error;
    squares += error ? *error * *error : 0;
  }
  if (values.empty()) return std::nullopt;
  Measured m{.value = mean(values)};
  if (all) m.error = std::sqrt(squares) / static_cast<double>(values.size());
  return m;
}

/// Error of a number of the experiments by a relative error that they share, as those of one camera and cell
/// do: |power value| times the mean of the relative errors.
/// \param power of what is in error, in the number
std::optional<double> error_by(std::optional<double> Run::*relative, double power,
                               const std::vector<Run>& runs, const Match& match, double value) {
  double sum = 0;
  bool any = false;
  for (const std::size_t i : match.experiments) {
    any = any || runs[i].*relative;
    sum += (runs[i].*relative).value_or(0);
  }
  if (!any || power == 0) return std::nullopt;
  return std::abs(power * value) * sum / static_cast<double>(match.experiments.size());
}

/// Error of a number of the experiments by that of the amplitude of the drive.
std::optional<double> error_by_drive(const Result& r, const std::vector<Run>& runs, const Match& match,
                                     double value) {
  const Run& experiment = runs[match.experiments.front()];
  const double above_plate = named_result(r.name).above_plate, amplitude = experiment.k_m / experiment.gamma;
  return above_plate > 0 ? error_by(&Run::amplitude_error, above_plate, runs, match, amplitude)
                         : error_by(&Run::amplitude_error, amplitude_power(r), runs, match, value);
}

/// Sets the spread between seeds of one start, and the difference between starts.
void compare_simulations(const std::vector<Run>& runs, const Match& match, Difference& d) {
  std::map<std::string, std::vector<double>> of_start;
  for (const std::size_t i : match.simulations)
    if (const Result* r = scalar(runs[i].results, d.quantity))
      of_start[runs[i].start].push_back(value_near(*r, d.experiment.value));
  double low = INFINITY, high = -INFINITY;
  for (const auto& [start, values] : of_start) {
    low = std::min(low, mean(values));
    high = std::max(high, mean(values));
    // The largest spread of all starts is used: crystals hardly differ from each other, but the experiment
    // may have a start that varies more.
    if (values.size() < 2) continue;
    const double spread = deviation(values);
    if (d.seeds && spread <= *d.seeds) continue;
    d.seeds = spread;
    d.seed_runs = values.size();
  }
  if (of_start.size() > 1) d.defects = high - low;
}

/// Standard deviation of E - S over the lines of tracers. The line is shifted on both sides, because an
/// effect of the choice that is equal on both sides is not a difference.
std::optional<double> spread_over_lines(const Checks& checks, const Match& match, const std::string& name) {
  std::vector<double> differences(kLines.size(), 0);
  for (const auto& [members, sign] :
       {std::pair{&match.experiments, 1.0}, std::pair{&match.simulations, -1.0}}) {
    std::vector<std::vector<double>> values;
    for (const auto& lines : checks.tracers)
      if (lines.quantity == name && std::find(members->begin(), members->end(), lines.run) != members->end())
        values.push_back(lines.values);
    if (values.empty()) return std::nullopt;
    for (std::size_t k = 0; k < differences.size(); ++k)
      for (const auto& v : values) differences[k] += sign * v[k] / static_cast<double>(values.size());
  }
  return deviation(differences);
}

/// A trajectory with other beads marked as tracers.
class Marked : public TrajectorySource {
 public:
  Marked(const TrajectorySource& base, const std::vector<std::size_t>& slots)
      : base_(base), info_(base.info()) {
    info_.tracer.assign(info_.n_beads, 0);
    for (const std::size_t slot : slots) info_.tracer[slot] = 1;
  }
  [[nodiscard]] const TrajectoryInfo& info() const override { return info_; }
  [[nodiscard]] std::size_t n_frames() const override { return base_.n_frames(); }
  void read(std::size_t index, Frame& frame) const override { base_.read(index, frame); }
  [[nodiscard]] std::string name() const override { return base_.name(); }

 private:
  const TrajectorySource& base_;
  TrajectoryInfo info_;
};

}  // namespace

std::optional<double> Difference::error() const {
  // Scale and drive alone say nothing of the scatter.
  if (!statistics && !seeds && !tracers) return std::nullopt;
  return in_quadrature({statistics, seed_error(), tracers, scale, drive});
}

std::optional<double> Difference::seed_error() const {
  if (!seeds || seed_runs < 2) return seeds;
  const auto n = static_cast<double>(seed_runs);
  return *seeds * std::sqrt(1 + 1 / n) * student_t_95(n - 1) / 1.96;
}

std::optional<double> Difference::in_errors() const {
  const auto e = error();
  if (!e || *e <= 0 || without_error) return std::nullopt;
  return remainder() / *e;
}

bool Difference::is_beyond_error() const {
  const auto t = in_errors();
  return t && std::abs(*t) > significant;
}

bool Difference::is_by_camera() const {
  return is_beyond_error() && camera_share().value_or(0) >= 1;
}

bool Difference::is_real() const {
  return is_beyond_error() && !is_by_camera() && !(defects && std::abs(remainder()) <= *defects);
}

std::optional<double> Difference::camera_share() const {
  if (!camera || std::abs(*camera) <= 0.5 * std::abs(difference()) || *camera * difference() <= 0)
    return std::nullopt;
  return *camera / difference();
}

std::string Difference::attribution() const {
  const double size = std::abs(difference());
  if (size == 0 && remainder() == 0) return "none: the same on both sides";
  const auto t = in_errors();
  if (without_error)
    return fmt::format("the error of the {} is not known, so that no conclusion is possible",
                       side_name(*without_error));
  if (!t) return "no error is known, so that no conclusion is possible";
  std::string by_camera;
  if (const auto share = camera_share())
    by_camera = *share < 1 ? fmt::format("camera and tracking cause {:.0f} % of it", 100 * *share)
                           : "camera and tracking cause all of it";
  if (!is_beyond_error()) {
    if (std::abs(*t) > kSignificant)
      return fmt::format("{:.1f} errors, no more than chance gives among so many numbers", std::abs(*t));
    if (!by_camera.empty() && size > kSignificant * *error())
      return by_camera + "; the rest is within its error";
    const std::pair<const char*, std::optional<double>> sources[] = {{"statistics", statistics},
                                                                     {"seeds", seed_error()},
                                                                     {"choice of tracers", tracers},
                                                                     {"scale", scale},
                                                                     {"amplitude of the drive", drive}};
    const auto largest = std::max_element(
        std::begin(sources), std::end(sources),
        [](const auto& a, const auto& b) { return a.second.value_or(0) < b.second.value_or(0); });
    std::string text = fmt::format("within its error, of which the largest part is {}", largest->first);
    if (largest->second == seed_error() && seeds && seed_runs < kFewSeeds)
      text += fmt::format(", known from {} runs only", seed_runs);
    return text;
  }
  if (is_by_camera()) return by_camera;
  if (!is_real())
    return fmt::format("{:.1f} errors; not larger than the difference between starts with other defects",
                       std::abs(*t));
  return fmt::format("{:.1f} errors: a real difference{}{}{}", std::abs(*t),
                     by_camera.empty() ? "" : ", though " + by_camera,
                     camera ? "" : ", unless camera and tracking cause it: nothing was filmed",
                     defects ? "" : "; one start alone does not show whether defects cause it");
}

std::vector<Checks::TracerLines> tracer_lines(const TrajectorySource& trajectory, std::size_t run,
                                              const AnalysisOptions& options) {
  AnalysisOptions few = options;
  few.only = {"s_b", "s_c"};
  few.tracers.clear();
  few.tracer_band.reset();
  Frame first;
  const std::size_t n = trajectory.n_frames();
  for (std::size_t i = 0; i < n; ++i) {
    trajectory.read(i, first);
    if (first.phase == 0 || !trajectory.info().columns.phase) break;
  }
  std::map<std::string, std::vector<double>> values;
  for (const double above : kLines) {
    const TracerChoice line = line_of_tracers(trajectory.info(), first, above);
    if (line.slots.empty()) return {};
    for (const Result& r : analyze(Marked(trajectory, line.slots), few))
      if (r.present() && std::isfinite(r.value())) values[r.name].push_back(r.value());
  }
  std::vector<Checks::TracerLines> lines;
  for (const auto& [name, v] : values)
    if (v.size() == kLines.size()) lines.push_back({run, name, v});
  return lines;
}

namespace {

/// The number of errors above which a difference is real, for all differences together.
double significant_errors(const std::vector<Difference>& differences) {
  std::vector<double> errors;
  for (const Difference& d : differences)
    if (const auto t = d.in_errors()) errors.push_back(std::abs(*t));
  std::sort(errors.begin(), errors.end(), std::greater<>());
  const auto m = static_cast<double>(errors.size());
  double limit = 0;  // the smallest t that counts
  for (std::size_t k = errors.size(); k-- > 0 && limit == 0;)
    if (std::erfc(errors[k] / std::numbers::sqrt2) <= kFalseShare * static_cast<double>(k + 1) / m)
      limit = std::nextafter(errors[k], 0.0);
  // None counts: the limit is above the largest.
  if (limit == 0 && !errors.empty()) limit = errors.front();
  return std::max(kSignificant, limit);
}

/// Whether an earlier number of the same match has the same values on both sides.
bool repeats(const std::vector<Difference>& earlier, const Difference& d) {
  return std::any_of(earlier.begin(), earlier.end(), [&](const Difference& e) {
    return e.match == d.match && e.unit == d.unit && e.experiment.value == d.experiment.value &&
           e.simulation.value == d.simulation.value && e.experiment.value != e.simulation.value;
  });
}

}  // namespace

std::vector<Difference> find_differences(const std::vector<Run>& runs, const std::vector<Match>& matches,
                                         const Checks& checks) {
  std::vector<Difference> differences;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const Match& match = matches[m];
    if (match.experiments.empty() || match.simulations.empty()) continue;
    for (const Result& r : runs[match.experiments.front()].results) {
      const auto experiment = measured(runs, match.experiments, r.name, r.value());
      if (!experiment) continue;
      const auto simulation = measured(runs, match.simulations, r.name, experiment->value);
      if (!simulation) continue;
      Difference d{.match = m,
                   .quantity = r.name,
                   .unit = r.unit,
                   .experiment = *experiment,
                   .simulation = *simulation};
      std::optional<double> other_error = simulation->error;
      for (const Checks::Filmed& filmed : checks.filmed) {
        if (std::find(match.simulations.begin(), match.simulations.end(), filmed.run) ==
            match.simulations.end())
          continue;
        const Result *seen = scalar(filmed.seen, r.name), *after = scalar(filmed.filmed, r.name);
        if (seen == nullptr || after == nullptr) continue;
        d.camera = value_near(*after, seen->value()) - seen->value();
        d.filmed = simulation->value + *d.camera;  // the effect of the camera, added to the mean of all seeds
        if (const auto error = standard_error(*after))
          other_error = std::max(*error, other_error.value_or(0));
      }
      d.statistics = in_quadrature({experiment->error, other_error});
      d.tracers = spread_over_lines(checks, match, r.name);
      d.scale = error_by(&Run::scale_error, length_power(r, runs[match.experiments.front()].box.dimension),
                         runs, match, experiment->value);
      d.drive = error_by_drive(r, runs, match, experiment->value);
      compare_simulations(runs, match, d);
      // The scatter between seeds contains that within a simulation.
      if (!experiment->error && (other_error || d.seeds || d.tracers))
        d.without_error = Side::experiment;
      else if (experiment->error && !other_error && !d.seeds)
        d.without_error = Side::simulation;
      if (!repeats(differences, d)) differences.push_back(std::move(d));
    }
  }
  const double significant = significant_errors(differences);
  for (Difference& d : differences) d.significant = significant;
  return differences;
}

namespace {
/// The columns Gamma and, for beds of several heights, N_l.
class Conditions {
 public:
  explicit Conditions(const std::vector<Match>& matches) : heights_(heights_of(matches).size() > 1) {}
  [[nodiscard]] std::string head() const { return row("Gamma", "N_l"); }
  [[nodiscard]] std::string of(const Match& match) const {
    return row(fmt::format("{:.3f}", match.gamma), fmt::format("{:.3g}", match.n_l));
  }

 private:
  [[nodiscard]] std::string row(const std::string& gamma, const std::string& n_l) const {
    return fmt::format("{:>7}", gamma) + (heights_ ? fmt::format("{:>6}", n_l) : std::string());
  }
  bool heights_;
};
}  // namespace

std::string differences_text(const std::vector<Difference>& differences, const std::vector<Match>& matches) {
  if (differences.empty()) return {};
  const auto part = [](const std::optional<double>& v) {
    return v ? fmt::format("{:.3g}", *v) : std::string("-");
  };
  const Conditions conditions(matches);
  std::string text = fmt::format("{}  {:<22}{:>11}{:>11}{:>11}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}  {}\n",
                                 conditions.head(), "number", "experiment", "simulation", "difference",
                                 "camera", "statist.", "seeds", "tracers", "scale", "drive", "attributed to");
  for (const Difference& d : differences)
    text += fmt::format("{}  {:<22}{:>11.4g}{:>11.4g}{:>11.3g}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}  {}\n",
                        conditions.of(matches[d.match]), d.quantity, d.experiment.value, d.simulation.value,
                        d.difference(), part(d.camera), part(d.statistics), part(d.seeds), part(d.tracers),
                        part(d.scale), part(d.drive), d.attribution());
  return text;
}

std::string real_differences_text(const std::vector<Difference>& differences,
                                  const std::vector<Match>& matches) {
  if (differences.empty()) return {};
  const Conditions conditions(matches);
  std::string rows;
  std::size_t others = 0, without_error = 0, by_camera = 0;
  std::size_t real = 0, not_filmed = 0;
  bool other_starts = true;
  for (const Difference& d : differences) {
    if (!d.is_real()) {
      ++(!d.in_errors() ? without_error : d.is_by_camera() ? by_camera : others);
      continue;
    }
    ++real;
    const auto share = d.camera_share();
    const double errors = std::abs(d.in_errors().value_or(0));
    rows += fmt::format("{}  {:<24} {:>11.4g} {:>11.4g} {:>11.3g} {:>9}{}\n", conditions.of(matches[d.match]),
                        d.quantity, d.experiment.value, d.simulation.value, d.difference(),
                        errors < 1e5 ? fmt::format("{:.1f}", errors) : fmt::format("{:.1e}", errors),
                        share ? fmt::format("  camera {:.0f} %", 100 * std::min(1.0, *share)) : "");
    not_filmed += d.camera ? 0 : 1;
    other_starts = other_starts && d.defects.has_value();
  }
  if (!rows.empty()) {
    rows = fmt::format("{}  {:<24}{:>12}{:>12}{:>12}{:>10}\n", conditions.head(), "real difference",
                       "experiment", "simulation", "difference", "errors") +
           rows;
    if (not_filmed == real)
      rows += "nothing was filmed, so that camera and tracking may cause a difference\n";
    else if (not_filmed > 0)
      rows += fmt::format(
          "{} of these numbers {} not known in the filmed simulation, so that camera and tracking may cause "
          "the difference\n",
          not_filmed, not_filmed == 1 ? "is" : "are");
    if (!other_starts) rows += "one start alone does not show whether defects cause a difference\n";
  }
  if (by_camera > 0)
    rows += fmt::format("camera and tracking cause all of the difference of {}\n",
                        plural(by_camera, "other number"));
  if (without_error > 0)
    rows += fmt::format("no error is known of {}, so that nothing follows from {}\n",
                        plural(without_error, "other number"), without_error == 1 ? "it" : "them");
  return rows + fmt::format("{} {} within {} errors (differences.csv in the report).\n",
                            plural(others, rows.empty() ? "number" : "other number"),
                            others == 1 ? "agrees" : "agree", others == 1 ? "its" : "their");
}

}  // namespace twincell::analysis
