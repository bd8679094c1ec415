// twincell calibrate contacts infer: contact parameters for which the simulator reproduces the observables of
// a film.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/observable/no_such_result.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/statistics/statistics.hpp"
#include "calibration/contact/contact_figures.hpp"
#include "calibration/contact/inference.hpp"
#include "calibration/fit/curve_components.hpp"
#include "cli/calibrate.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/in_parallel.hpp"
#include "core/json_text.hpp"
#include "core/key_assignments.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {
namespace {

struct InferFlags {
  CalibrateFlags out;
  std::string measured, scene;
  std::vector<std::string> vary, assignments, onsets;
  std::vector<std::string> observables = {"s_b", "T_g"};
  int runs = 24;
  std::int64_t discard = 0;
};

/// Converts the complete text to a finite number. \throws std::invalid_argument
double number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw std::invalid_argument("number");
  return value;
}

calibration::Sought sought_of(const std::string& said) {
  const auto equals = said.find('='), colon = said.find(':', equals == std::string::npos ? 0 : equals);
  calibration::Sought s;
  try {
    if (equals == std::string::npos || colon == std::string::npos) throw std::invalid_argument("form");
    s = {said.substr(0, equals), number_of(said.substr(equals + 1, colon - equals - 1)),
         number_of(said.substr(colon + 1))};
  } catch (const std::exception&) {
    throw ConfigError({.file = {}, .key = "--vary"}, fmt::format("'{}' is not key=low:high.", said));
  }
  if (!(s.lower < s.upper))
    throw ConfigError({.file = {}, .key = "--vary"}, fmt::format("'{}': low must be below high.", said));
  return s;
}

/// The measured drive strength Gamma at which a bed begins to bounce or to convect.
struct MeasuredOnset {
  analysis::BedPhase phase = analysis::BedPhase::bouncing;
  double gamma = 0, error = 0;
  [[nodiscard]] std::string name() const { return "onset of " + analysis::onset_name(phase); }
  /// The observable whose crossing of its threshold defines the onset.
  [[nodiscard]] std::string observable() const {
    return phase == analysis::BedPhase::bouncing ? "s_b" : "s_c";
  }
  [[nodiscard]] double threshold() const {
    return phase == analysis::BedPhase::bouncing ? analysis::kBouncingThreshold
                                                 : analysis::kConvectionThreshold;
  }
  /// Range of Gamma in which runs search for the onset: three errors, and at least 15 %, to both sides.
  [[nodiscard]] calibration::Sought tried() const {
    const double reach = std::max(3 * error, 0.15 * gamma);
    return {"drive.gamma", std::max(gamma - reach, 0.1 * gamma), gamma + reach};
  }
};

/// The quantity that the surface describes, ln(1/10 + s/threshold). Below and above its threshold, s differs
/// by factors; far below it, s is only noise.
double level(double s, double threshold) {
  return std::log(0.1 + s / threshold);
}

MeasuredOnset onset_of(const std::string& said) {
  const auto bad = [&](const std::string& why) {
    return ConfigError({.file = {}, .key = "--onset"}, fmt::format("'{}' {}.", said, why));
  };
  const auto equals = said.find('='), error = said.find("+-");
  if (equals == std::string::npos || error == std::string::npos || error < equals)
    throw bad("is not bouncing=GAMMA+-ERROR or convecting=GAMMA+-ERROR");
  MeasuredOnset o;
  o.phase = analysis::phase_named(said.substr(0, equals));
  if (o.phase != analysis::BedPhase::bouncing && o.phase != analysis::BedPhase::convecting)
    throw bad("names neither bouncing nor convecting");
  try {
    o.gamma = number_of(said.substr(equals + 1, error - equals - 1));
    o.error = number_of(said.substr(error + 2));
  } catch (const std::exception&) {
    throw bad("is not bouncing=GAMMA+-ERROR or convecting=GAMMA+-ERROR");
  }
  if (!(o.gamma > 0) || !(o.error >= 0) || !std::isfinite(o.gamma) || !std::isfinite(o.error))
    throw bad("needs a Gamma above 0 and an error of at least 0");
  return o;
}

/// One result of analyze: a number, or a curve.
struct Observed {
  std::string name;
  std::vector<double> values;  ///< one NaN if the result is absent
  double error = 0;
  bool curve = false;
  std::string absent = {};
};

std::vector<Observed> observe(const TrajectorySource& trajectory, const std::vector<std::string>& names,
                              std::int64_t discard) {
  analysis::AnalysisOptions options;
  options.discard_cycles = discard;
  options.only = names;
  const std::vector<analysis::Result> results = analysis::analyze(trajectory, options);
  std::vector<Observed> all;
  for (const std::string& name : names) {
    const analysis::Result& r = analysis::find_result(results, name);
    if (!r.text.empty())
      throw ConfigError({.file = {}, .key = "--observables"},
                        fmt::format("'{}' is neither a number nor a curve.", name));
    Observed o{.name = name, .values = {kNaN}, .curve = !r.shape.empty(), .absent = r.absent};
    if (r.present()) o.values = r.values;
    if (r.present() && r.interval) o.error = analysis::standard_error(*r.interval);
    all.push_back(std::move(o));
  }
  return all;
}

/// The observables of the film. \throws InputError if one is absent or has no value in some elements
std::vector<Observed> of_film(const InferFlags& o) {
  const H5mdReader film(o.measured);
  std::vector<Observed> measured = observe(film, o.observables, o.discard);
  for (const Observed& m : measured) {
    if (!m.absent.empty())
      throw InputError(
          {.file = o.measured, .key = m.name},
          fmt::format("has no value in this film ({}); select other observables with --observables.",
                      m.absent));
    const auto holes =
        std::count_if(m.values.begin(), m.values.end(), [](double v) { return !std::isfinite(v); });
    if (holes > 0)
      throw InputError(
          {.file = o.measured, .key = m.name},
          fmt::format("has no value in {} of {} elements; select other observables with --observables.",
                      holes, m.values.size()));
  }
  return measured;
}

/// All runs of the simulator: at the drive of the film, and at drives around each onset.
class Runs {
 public:
  Runs(const InferFlags& o, const Common& common, std::vector<calibration::Sought> sought,
       const std::vector<Observed>& measured, const std::vector<MeasuredOnset>& onsets)
      : o_(o), common_(common), sought_(std::move(sought)), measured_(measured), onsets_(onsets) {
    std::vector<calibration::Sought> ranges = sought_;
    for (const MeasuredOnset& onset : onsets_) ranges.push_back(onset.tried());
    places_ = calibration::spread_points(ranges, o.runs);
    of_film.resize(places_.size());
    of_onset.assign(onsets_.size(), std::vector<double>(places_.size(), kNaN));
  }

  /// \throws as read_scene, before the first run starts
  void simulate() {
    const std::size_t kinds = onsets_.size() + 1, first = o_.measured.empty() ? 1 : 0,
                      jobs = places_.size() * (kinds - first);
    for (std::size_t kind = first; kind < kinds; ++kind) (void)scene(0, kind);
    ProgressBar bar(common_, "runs");
    std::atomic<std::int64_t> done{0};
    const auto shows = std::this_thread::get_id();
    in_parallel(jobs, common_.n_threads(), [&](std::size_t job) {
      run(job % places_.size(), first + job / places_.size());
      ++done;
      if (std::this_thread::get_id() == shows) bar.update(done, static_cast<std::int64_t>(jobs));
    });
  }

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] std::vector<double> theta(std::size_t i) const {
    return {places_[i].begin(), places_[i].begin() + static_cast<std::ptrdiff_t>(sought_.size())};
  }
  /// Gamma of run i in the search for an onset.
  [[nodiscard]] double drive(std::size_t i, std::size_t onset) const {
    return places_[i][sought_.size() + onset];
  }

  std::vector<std::vector<Observed>> of_film;  ///< [runs][observables]
  std::vector<std::vector<double>> of_onset;   ///< [onsets][runs], level()

 private:
  /// The scene of run i. Kind 0 uses the drive of the film; kind k > 0 uses the drive for onset k - 1.
  [[nodiscard]] sim::Scene scene(std::size_t i, std::size_t kind) const {
    std::vector<std::string> all = o_.assignments;
    for (std::size_t k = 0; k < sought_.size(); ++k)
      all.push_back(fmt::format("{}={:.9g}", sought_[k].name, places_[i][k]));
    if (kind > 0) all.push_back(fmt::format("drive.gamma={:.9g}", drive(i, kind - 1)));
    all.push_back(fmt::format("start.seed={}", common_.seed.value_or(1) + kind * places_.size() + i));
    return sim::read_scene(o_.scene, all);
  }

  void run(std::size_t i, std::size_t kind) {
    sim::Simulation simulation(scene(i, kind));
    MemoryTrajectory trajectory(simulation.trajectory_info());
    simulation.run(trajectory);
    if (kind == 0) {
      of_film[i] = observe(trajectory, o_.observables, o_.discard);
      for (std::size_t k = 0; k < measured_.size(); ++k) refuse_other_length(of_film[i][k], measured_[k]);
      return;
    }
    const MeasuredOnset& onset = onsets_[kind - 1];
    const Observed s = observe(trajectory, {onset.observable()}, o_.discard).front();
    of_onset[kind - 1][i] = level(s.values.front(), onset.threshold());
  }

  /// \throws ConfigError for a curve whose length differs from that of the film. Checked in each run, so that
  /// the first run already fails, not the evaluation after all runs.
  static void refuse_other_length(const Observed& run, const Observed& film) {
    if (!film.curve || !run.absent.empty() || run.values.size() == film.values.size()) return;
    throw ConfigError({.file = {}, .key = "--observables"},
                      fmt::format("{} has {} elements in the film and {} in the scene; time.phases and the "
                                  "cell of the scene must be those of the film.",
                                  film.name, film.values.size(), run.values.size()));
  }

  const InferFlags& o_;
  const Common& common_;
  std::vector<calibration::Sought> sought_;
  const std::vector<Observed>& measured_;
  const std::vector<MeasuredOnset>& onsets_;
  std::vector<std::vector<double>> places_;  ///< parameters, then Gamma for each onset
};

/// A measured curve and the curves of the runs, reduced to numbers.
struct ComparedCurve {
  Observed measured;
  calibration::CurveComponents components;
  std::size_t first = 0;  ///< index of its first number among the observables
};

/// The input of infer_parameters(), and the curves that are part of it.
struct Question {
  std::vector<calibration::MeasuredObservable> measured;
  std::vector<calibration::SimulatedPoint> runs;
  std::vector<ComparedCurve> curves;

  /// Adds one observable: its measured value and its value in each run. \param at condition of each run;
  /// empty if the observable has none
  void add(calibration::MeasuredObservable number, const std::vector<double>& of_runs,
           const std::vector<double>& at) {
    measured.push_back(std::move(number));
    for (std::size_t i = 0; i < runs.size(); ++i) {
      runs[i].y.push_back(of_runs[i]);
      runs[i].at.push_back(at.empty() ? kNaN : at[i]);
    }
  }
};

/// Adds a curve as one number for each form (principal component) in which the curves of the runs differ.
void add_curve(Question& question, const Runs& runs, std::size_t k, const Observed& measured) {
  std::vector<std::vector<double>> curves;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Observed& run = runs.of_film[i][k];
    curves.push_back(run.absent.empty() ? run.values : std::vector<double>{});
  }
  ComparedCurve c{measured, calibration::components_of(curves), question.measured.size()};
  const std::vector<double> numbers = c.components.numbers(measured.values);
  for (std::size_t form = 0; form < numbers.size(); ++form) {
    std::vector<double> of_runs;
    for (const auto& curve : curves)
      of_runs.push_back(curve.empty() ? kNaN : c.components.numbers(curve)[form]);
    question.add({fmt::format("{} form {}", measured.name, form + 1), numbers[form], 0}, of_runs, {});
  }
  question.curves.push_back(std::move(c));
}

Question question_of(const Runs& runs, const std::vector<Observed>& measured,
                     const std::vector<MeasuredOnset>& onsets) {
  Question question;
  for (std::size_t i = 0; i < runs.size(); ++i) question.runs.push_back({.theta = runs.theta(i), .y = {}});
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (measured[k].curve) {
      add_curve(question, runs, k, measured[k]);
      continue;
    }
    std::vector<double> of_runs;
    for (std::size_t i = 0; i < runs.size(); ++i) of_runs.push_back(runs.of_film[i][k].values.front());
    question.add({measured[k].name, measured[k].values.front(), measured[k].error}, of_runs, {});
  }
  for (std::size_t k = 0; k < onsets.size(); ++k) {
    std::vector<double> at;
    for (std::size_t i = 0; i < runs.size(); ++i) at.push_back(runs.drive(i, k));
    question.add({.name = onsets[k].name(),
                  .value = level(onsets[k].threshold(), onsets[k].threshold()),
                  .error = 0,
                  .at = calibration::Condition{onsets[k].tried(), onsets[k].gamma, onsets[k].error}},
                 runs.of_onset[k], at);
  }
  return question;
}

/// Reports each observable: measured value, value at the best parameters, and scatter of one run. An onset is
/// converted to a drive strength.
void tell_observables(const Question& question, const calibration::Inference& inference,
                      CalibrationResult& out) {
  out.text += "observable            measured      best fit      scatter of one run\n";
  for (std::size_t i = 0; i < question.measured.size(); ++i) {
    const calibration::MeasuredObservable& m = question.measured[i];
    double value = m.value, error = m.error, predicted = inference.predicted[i],
           scatter = inference.scatter[i];
    if (m.at) {
      const double slope = inference.slope[i];
      value = m.at->value;
      error = m.at->error;
      predicted = value + (m.value - predicted) / slope;
      scatter = std::abs(scatter / slope);
    }
    out.document["observables"].push_back({{"name", m.name},
                                           {"measured", value},
                                           {"error", error},
                                           {"predicted", number_or_null(predicted)},
                                           {"scatter", number_or_null(scatter)}});
    out.text += fmt::format("{:<20}  {:<12.5g}  {:<12.5g}  {:.2g}\n", m.name, value, predicted, scatter);
  }
}

void tell_curves(const Question& question, const calibration::Inference& inference, CalibrationResult& out) {
  constexpr double kMaxMisfit = 3;
  for (const ComparedCurve& c : question.curves) {
    const auto first = inference.predicted.begin() + static_cast<std::ptrdiff_t>(c.first);
    const std::vector<double> predicted = c.components.curve(
        std::vector<double>(first, first + static_cast<std::ptrdiff_t>(c.components.forms.size())));
    const double misfit = c.components.misfit(c.measured.values);
    out.document["curves"].push_back({{"name", c.measured.name},
                                      {"measured", c.measured.values},
                                      {"predicted", predicted},
                                      {"forms", c.components.forms},
                                      {"mean", c.components.mean},
                                      {"misfit", misfit},
                                      {"misfit_of_runs", c.components.left_out}});
    if (misfit > kMaxMisfit * c.components.left_out)
      out.notes.push_back(
          fmt::format("{} has a shape that no run has: its residual is {:.2g}, that of the curves of the "
                      "runs {:.2g} (rms)",
                      c.measured.name, misfit, c.components.left_out));
    out.figures.push_back(calibration::curve_figure(c.measured.name, c.measured.values, predicted));
  }
}

void tell_profiles(const InferFlags& o, const Question& question, const calibration::Inference& inference,
                   CalibrationResult& out) {
  const auto& known = quantities();
  std::vector<std::string> by = o.measured.empty() ? std::vector<std::string>{} : o.observables;
  for (const calibration::MeasuredObservable& m : question.measured)
    if (m.at) by.push_back(m.name);
  out.text = "profile likelihood, 95 % intervals\n";
  for (const calibration::Profile& p : inference.profiles) {
    out.document["profiles"].push_back({{"parameter", p.sought.name},
                                        {"best", p.best},
                                        {"low", p.low},
                                        {"high", p.high},
                                        {"open_low", p.open_low},
                                        {"open_high", p.open_high},
                                        {"undetermined", p.undetermined()},
                                        {"at", p.at},
                                        {"chi2", p.chi2}});
    out.text += fmt::format("  {:<24} {:<9.4g} [{:.4g}, {:.4g}]{}\n", p.sought.name, p.best, p.low, p.high,
                            p.undetermined()            ? "  undetermined"
                            : p.open_low || p.open_high ? "  bounded on one side"
                                                        : "");
    const bool writable =
        std::any_of(known.begin(), known.end(), [&](const Quantity& q) { return q.name == p.sought.name; });
    if (writable && std::isfinite(p.standard_error))
      out.measured.push_back(
          {.name = p.sought.name,
           .value = {p.best},
           .standard_error = {p.standard_error},
           .method = fmt::format("{} simulations matched in {}", o.runs, fmt::join(by, ", ")),
           .data = data_hash(o.measured.empty() ? o.scene : o.measured)});
  }
}

/// \throws ConfigError for an observable that does not exist or is named twice: its value would count as two
/// measurements
void check_observables(const std::vector<std::string>& names) {
  const auto refuse = [](const std::string& complaint) {
    throw ConfigError({.file = {}, .key = "--observables"}, complaint);
  };
  const std::vector<std::string> known = analysis::result_names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == "onset")
      refuse(
          "'onset' cannot be computed from one film; give the measured onset with --onset "
          "bouncing=GAMMA+-ERROR.");
    if (std::find(known.begin(), known.end(), names[k]) == known.end())
      refuse(analysis::no_such_result(names[k]) + '.');
    for (std::size_t m = 0; m < k; ++m)
      if (names[m] == names[k]) refuse(fmt::format("names {} twice.", names[k]));
  }
}

void run_infer(const InferFlags& o, const Common& common) {
  std::vector<calibration::Sought> sought;
  refuse_contradictory_assignments(o.assignments);
  for (const std::string& said : o.vary) {
    sought.push_back(sought_of(said));
    const std::string& name = sought.back().name;
    for (std::size_t k = 0; k + 1 < sought.size(); ++k)
      if (sought[k].name == name)
        throw ConfigError({.file = {}, .key = "--vary"}, fmt::format("names {} twice.", name));
    for (const std::string& assignment : o.assignments)
      if (assigned_key(assignment) == name)
        throw ConfigError({.file = {}, .key = "--vary"},
                          fmt::format("varies {}, which --set {} fixes.", name, assignment));
  }
  if (sought.size() > 3)
    throw ConfigError({.file = {}, .key = "--vary"},
                      fmt::format("names {} parameters; at most 3 can be inferred.", sought.size()));
  for (std::size_t k = 0; k < sought.size(); ++k)
    for (const double end : {sought[k].lower, sought[k].upper}) {
      std::vector<std::string> all = o.assignments;
      all.push_back(fmt::format("{}={:.9g}", sought[k].name, end));
      try {
        (void)sim::read_scene(o.scene, all);
      } catch (const ConfigError& e) {
        throw ConfigError({.file = {}, .key = "--vary"},
                          fmt::format("'{}': with {:g} the scene is refused: {}", o.vary[k], end, e.what()));
      }
    }
  std::vector<MeasuredOnset> onsets;
  for (const std::string& said : o.onsets) {
    onsets.push_back(onset_of(said));
    for (std::size_t k = 0; k + 1 < onsets.size(); ++k)
      if (onsets[k].phase == onsets.back().phase)
        throw ConfigError({.file = {}, .key = "--onset"},
                          fmt::format("names the {} twice; give the mean of the two.", onsets.back().name()));
  }
  // These keys are set for every run: the seed always, Gamma in the search for an onset.
  for (const calibration::Sought& s : sought)
    if (s.name == "start.seed" ||
        (!onsets.empty() && (s.name == "drive.gamma" || s.name.starts_with("drive.peak_acceleration"))))
      throw ConfigError(
          {.file = {}, .key = "--vary"},
          fmt::format("varies {}, which {}.", s.name,
                      s.name == "start.seed" ? "differs in every run anyway" : "--onset searches"));
  if (o.measured.empty() && onsets.empty())
    throw ConfigError({.file = {}, .key = "--onset"}, "or a trajectory of the experiment is required.");
  if (!o.measured.empty()) check_observables(o.observables);
  const std::vector<Observed> measured = o.measured.empty() ? std::vector<Observed>{} : of_film(o);
  Runs runs(o, common, sought, measured, onsets);
  runs.simulate();
  const Question question = question_of(runs, measured, onsets);
  const calibration::Inference inference =
      calibration::infer_parameters(sought, question.runs, question.measured);

  CalibrationResult out;
  out.notes = inference.notes;
  out.document["measured_from"] = o.measured;
  out.document["chi2"] = inference.chi2;
  out.document["freedom"] = inference.freedom;
  tell_profiles(o, question, inference, out);
  tell_observables(question, inference, out);
  out.text += fmt::format("chi^2 = {:.3g}, {:g} degrees of freedom\n", inference.chi2, inference.freedom);
  out.figures = {calibration::profile_figure(inference)};
  tell_curves(question, inference, out);
  finish_calibration(o.out, common, std::move(out));
}

}  // namespace

void add_calibrate_infer(CLI::App& contacts, Common& common) {
  auto o = std::make_shared<InferFlags>();
  CLI::App& kind =
      add_verb(contacts, common, "infer",
               "Infer the contact parameters for which the simulator reproduces the measured observables. "
               "Prints each with its 95 % interval; -o also writes them to a calibration file.",
               "twincell calibrate contacts infer exp.h5 --scene scene.toml --vary "
               "contact.restitution=0.7:0.95 --observables s_k,flight_time --runs 12");
  takes_seed(kind, common);
  kind.add_option("measured", o->measured, "Trajectory of the experiment (H5MD); optional with --onset");
  kind.add_option("--scene", o->scene, "Scene file of the same cell (TOML)")->required();
  kind.add_option("--vary", o->vary, "Parameter to infer and its range, as section.key=low:high; up to three")
      ->required()
      ->take_all();
  kind.add_option("--observables", o->observables,
                  "Numbers and curves that analyze computes, comma separated")
      ->delimiter(',')
      ->capture_default_str();
  kind.add_option("--onset", o->onsets,
                  "Measured onset, as bouncing=GAMMA+-ERROR or convecting=GAMMA+-ERROR; may be repeated")
      ->take_all();
  kind.add_option("--runs", o->runs, "Number of simulations; the same number again for each --onset")
      ->check(CLI::Range(5, 100000))
      ->capture_default_str();
  kind.add_option("--discard", o->discard,
                  "Number of cycles skipped at the start, in the film and in the simulations")
      ->check(CLI::Range(0, 1 << 30))
      ->capture_default_str();
  kind.add_option("--set", o->assignments,
                  "Set a key of the scene, as section.key=value; overrides the file; may be repeated")
      ->take_all();
  add_output_flags(kind, common, o->out, "profile");
  kind.callback([o, &common] { run_infer(*o, common); });
}

}  // namespace twincell::cli
