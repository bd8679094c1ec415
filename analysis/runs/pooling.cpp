#include "analysis/runs/pooling.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <complex>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/order/lattice_orientation.hpp"
#include "analysis/runs/bed_keys.hpp"
#include "analysis/runs/phase_diagram.hpp"
#include "analysis/statistics/statistics.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "trajectory/boundary_words.hpp"

namespace twincell::analysis {
namespace {

/// Circular mean with the period of a hexagonal lattice.
double mean_angle(const std::vector<double>& degrees) {
  std::complex<double> sum = 0;
  for (const double a : degrees) sum += std::polar(1.0, 2 * std::numbers::pi * a / kLatticePeriodDegrees);
  return std::arg(sum) * kLatticePeriodDegrees / (2 * std::numbers::pi);
}

/// Transforms a value to the scale in which means over runs are taken. Angles are unwrapped to the period
/// about `centre`.
double onto(Pooling rule, double value, double centre) {
  if (rule == Pooling::root_mean_square) return value * value;
  return rule == Pooling::angle ? centre + std::remainder(value - centre, kLatticePeriodDegrees) : value;
}
/// Inverse of `onto`; angles stay unwrapped.
double back(Pooling rule, double value) {
  return rule == Pooling::root_mean_square ? std::sqrt(std::max(0.0, value)) : value;
}

/// The scalar values of the runs that have one.
struct Values {
  std::vector<double> values;                 ///< on the scale in which means are taken
  std::vector<std::optional<double>> errors;  ///< standard errors from the runs' own intervals, same scale
  std::vector<std::string> methods;           ///< methods of those intervals
};

Values values_of(const std::vector<const Result*>& runs, Pooling rule) {
  std::vector<double> plain;
  for (const Result* r : runs) plain.push_back(r->value());
  const double centre = rule == Pooling::angle ? mean_angle(plain) : 0;
  Values v;
  for (const Result* r : runs) {
    v.values.push_back(onto(rule, r->value(), centre));
    std::optional<double> error;
    if (r->interval && std::isfinite(r->interval->high - r->interval->low)) {
      const Interval own = uncut_interval(*r);
      error = (onto(rule, own.high, centre) - onto(rule, own.low, centre)) / (2 * kStandardErrors);
      v.methods.push_back(r->interval->method.substr(0, r->interval->method.find_first_of(":;(")));
      while (v.methods.back().ends_with(' ')) v.methods.back().pop_back();
    }
    v.errors.push_back(error);
  }
  return v;
}

/// Interval from the scatter between runs, widened to the uncertainties of the single runs. Absent if the
/// runs agree and have no uncertainty.
std::optional<Interval> interval_over_runs(const Values& v) {
  const std::size_t n = v.values.size();
  const double centre = mean(v.values), count = static_cast<double>(n);
  double squares = 0, own = 0;
  for (const double x : v.values) squares += (x - centre) * (x - centre);
  for (const auto& e : v.errors) own += e ? *e * *e : 0;
  const double scatter = std::sqrt(squares / (count - 1) / count);
  const double half_own = kStandardErrors * std::sqrt(own) / count;
  if (scatter <= 1e-12 * std::abs(centre) && half_own <= 1e-12 * std::abs(centre)) return std::nullopt;
  const std::string of = fmt::format("{} runs", n);
  std::optional<Interval> interval = mean_interval(v.values, of);
  if (!interval) interval = Interval{centre, centre, 0.95, of + " that agree"};
  if (interval->low <= centre - half_own && interval->high >= centre + half_own) return interval;
  interval->low = std::min(interval->low, centre - half_own);
  interval->high = std::max(interval->high, centre + half_own);
  interval->method += fmt::format(", widened to the runs' own intervals ({})", v.methods.front());
  return interval;
}

/// Convention of a pooled result: how many runs have it, and the convention of the first of them.
std::string convention_of(const std::vector<const Result*>& with, std::size_t runs, const std::string& how) {
  const std::string part = with.size() == runs
                               ? fmt::format("{} runs", runs)
                               : fmt::format("the {} of {} runs that have it", with.size(), runs);
  return fmt::format("{} over {}; in the first: {}", how, part, with.front()->convention);
}

Result pooled_word(const std::vector<const Result*>& with, std::size_t runs) {
  std::map<std::string, std::size_t> count;
  for (const Result* r : with) ++count[r->text];
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const auto& [word, n] : count) ranked.emplace_back(n, word);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> counts;
  for (const auto& [n, word] : ranked) counts.push_back(fmt::format("{} in {}", word, n));
  const std::string said = fmt::format("{} of {} runs", fmt::join(counts, ", "), runs);
  const Result& first = *with.front();
  if (ranked.size() > 1 && ranked[0].first == ranked[1].first)
    return absent_result(first.name, "the runs do not agree: " + said, first.source);
  Result r{.name = first.name, .text = ranked.front().second, .n = with.size(), .n_of = "runs"};
  r.convention = said + "; in the first: " + first.convention;
  r.source = first.source;
  return r;
}

Result pooled_scalar(const std::vector<const Result*>& with, const std::vector<double>& of_runs) {
  const Result& first = *with.front();
  const Pooling rule = named_result(first.name).pooling;
  Result r{.name = first.name, .unit = first.unit, .n = with.size(), .n_of = "runs"};
  r.of_runs = of_runs;
  r.source = first.source;
  const Values v = values_of(with, rule);
  if (rule == Pooling::sum) {
    r.values = {mean(v.values) * static_cast<double>(with.size())};
    r.convention = convention_of(with, of_runs.size(), "sum");
    r.no_interval = "a count, exact";
    return r;
  }
  // The mean of unwrapped angles is put back into the range of the angle of a run.
  const double turns = rule == Pooling::angle ? turns_of_lattice(mean(v.values)) : 0;
  r.values = {back(rule, mean(v.values)) - turns};
  r.convention =
      convention_of(with, of_runs.size(), rule == Pooling::root_mean_square ? "root mean square" : "mean");
  if (with.size() == 1) {
    r.interval = first.interval;
    r.no_interval = first.no_interval;
    if (r.interval) r.interval->method += ", of the only run that has it";
    return r;
  }
  if (rule == Pooling::probability && *std::max_element(v.values.begin(), v.values.end()) == 0) {
    double trials = 0;
    for (const Result* run : with) trials += static_cast<double>(run->n);
    r.interval =
        binomial_interval(0, trials, fmt::format("{} {} of {} runs", trials, first.n_of, with.size()));
    return r;
  }
  r.interval = interval_over_runs(v);
  if (!r.interval) {
    r.no_interval = "the same in every run";
    return r;
  }
  r.interval->low = back(rule, r.interval->low) - turns;
  r.interval->high = back(rule, r.interval->high) - turns;
  return cut_interval(std::move(r));
}

/// The present result of that name of each run, or null.
std::vector<const Result*> each(const std::vector<std::vector<Result>>& runs, const std::string& name) {
  std::vector<const Result*> found;
  for (const auto& results : runs) {
    const Result* r = seek_result(results, name);
    found.push_back(r != nullptr && r->present() ? r : nullptr);
  }
  return found;
}

std::vector<const Result*> without_null(std::vector<const Result*> results) {
  std::erase(results, nullptr);
  return results;
}

/// A sparse profile: the elements of the runs are matched by their abscissas, those of all runs.
/// \param of_runs [runs] the profile, or null \param along [runs] its abscissas, or null
Result pooled_profile(const std::vector<const Result*>& of_runs, const std::vector<const Result*>& along) {
  const std::vector<const Result*> with = without_null(of_runs);
  const Result& first = *with.front();
  const NamedResult named = named_result(first.name);
  constexpr double kSameHeight = 1e-6;  // sigma; slabs are about one apart
  struct Element {
    double abscissa;
    std::vector<double> values;
  };
  std::map<std::int64_t, Element> elements;
  const auto key = [](double z) { return std::llround(z / kSameHeight); };
  for (const Result* a : without_null(along))
    for (const double z : a->values) elements.try_emplace(key(z), Element{z, {}});
  for (std::size_t r = 0; r < of_runs.size(); ++r) {
    if (of_runs[r] == nullptr || along[r] == nullptr) continue;
    std::map<std::int64_t, double> of_run;
    for (std::size_t k = 0; k < std::min(along[r]->values.size(), of_runs[r]->values.size()); ++k)
      of_run[key(along[r]->values[k])] = of_runs[r]->values[k];
    for (auto& [at, element] : elements) {
      const auto here = of_run.find(at);
      const double value = here == of_run.end() ? named.elsewhere : here->second;
      if (std::isfinite(value)) element.values.push_back(value);
    }
  }
  const bool is_abscissa = first.name == named.along;
  Result r{
      .name = first.name, .shape = {elements.size()}, .unit = first.unit, .n = with.size(), .n_of = "runs"};
  for (const auto& [at, element] : elements)
    r.values.push_back(is_abscissa ? element.abscissa : element.values.empty() ? kNaN : mean(element.values));
  r.convention = is_abscissa ? fmt::format("those of all runs; in the first: {}", first.convention)
                             : convention_of(with, of_runs.size(), "mean, at equal abscissas,");
  r.no_interval = "no interval is computed for the elements of an array";
  r.source = first.source;
  return r;
}

/// NAME_low or NAME_high of an array NAME: that end of the interval over the runs of each element.
/// \param arrays [runs] NAME, or null \param ends, other [runs] the ends of the runs' own intervals, or null
Result pooled_ends(const std::string& name, const std::vector<const Result*>& arrays,
                   const std::vector<const Result*>& ends, const std::vector<const Result*>& other) {
  const std::vector<const Result*> with = without_null(arrays);
  const bool low = name.ends_with("_low");
  std::size_t size = with.front()->values.size();
  for (const Result* r : with) size = std::min(size, r->values.size());
  Result r{.name = name, .shape = {size}, .unit = with.front()->unit, .n = with.size(), .n_of = "runs"};
  for (std::size_t e = 0; e < size; ++e) {
    Values v;
    double own = kNaN;
    for (std::size_t run = 0; run < arrays.size(); ++run) {
      if (arrays[run] == nullptr || !std::isfinite(arrays[run]->values[e])) continue;
      const bool known = ends[run] != nullptr && other[run] != nullptr && e < ends[run]->values.size() &&
                         e < other[run]->values.size();
      const double width = known ? std::abs(ends[run]->values[e] - other[run]->values[e]) : kNaN;
      if (known) own = ends[run]->values[e];
      v.values.push_back(arrays[run]->values[e]);
      v.errors.push_back(std::isfinite(width) ? std::optional(width / (2 * kStandardErrors)) : std::nullopt);
      v.methods.emplace_back("of each run");
    }
    const std::optional<Interval> interval = v.values.size() > 1 ? interval_over_runs(v) : std::nullopt;
    // One run has its own interval; runs that agree to the last digit have that of any of them.
    r.values.push_back(!interval ? own : low ? interval->low : interval->high);
  }
  r.convention = convention_of(
      with, arrays.size(), fmt::format("{} end of the 95 % interval of the mean", low ? "lower" : "upper"));
  r.no_interval = "an end of an interval";
  r.source = with.front()->source;
  return r;
}

Result pooled_array(const std::vector<const Result*>& with, std::size_t runs) {
  const Result& first = *with.front();
  if (named_result(first.name).pooling == Pooling::per_bead)
    return absent_result(first.name, "values of single beads: the beads of different runs do not correspond",
                         first.source);
  std::vector<std::size_t> shape = first.shape;
  bool cut = false;
  for (const Result* r : with) {
    if (r->shape.size() != shape.size() || !std::equal(shape.begin() + 1, shape.end(), r->shape.begin() + 1))
      return absent_result(first.name, "its shape differs from run to run", first.source);
    cut = cut || r->shape.front() != shape.front();
    shape.front() = std::min(shape.front(), r->shape.front());
  }
  const Pooling rule = named_result(first.name).pooling;
  Result r{.name = first.name, .shape = shape, .unit = first.unit, .n = with.size(), .n_of = "runs"};
  std::size_t size = 1;
  for (const std::size_t s : shape) size *= s;
  for (std::size_t e = 0; e < size; ++e) {
    std::vector<double> of_element;
    for (const Result* run : with)
      if (std::isfinite(run->values[e])) of_element.push_back(onto(rule, run->values[e], 0));
    const double scale = rule == Pooling::sum ? static_cast<double>(of_element.size()) : 1;
    r.values.push_back(of_element.empty() ? kNaN : back(rule, scale * mean(of_element)));
  }
  r.convention = convention_of(with, runs,
                               rule == Pooling::root_mean_square ? "root mean square"
                               : rule == Pooling::sum            ? "sum"
                                                                 : "mean");
  if (cut) r.convention += fmt::format("; up to the end of the shortest, {}", shape.front());
  r.no_interval = "no interval is computed for the elements of an array";
  r.source = first.source;
  return r;
}

/// The array of which a result is an end of the intervals, and the result with their other ends; empty if the
/// result is no such end.
std::pair<std::string, std::string> interval_of(const std::string& name) {
  for (const auto& [end, other] : {std::pair<std::string, std::string>{"_low", "_high"}, {"_high", "_low"}})
    if (name.ends_with(end)) {
      const std::string array = name.substr(0, name.size() - end.size());
      return {array, array + other};
    }
  return {};
}

/// A sparse profile or an end of intervals, which is pooled by other results; nullopt for another result.
std::optional<Result> pooled_by_others(const std::vector<std::vector<Result>>& runs,
                                       const std::string& name) {
  const std::vector<const Result*> of_runs = each(runs, name);
  const auto missing = [&](const std::string& what) {
    return absent_result(name, fmt::format("it is pooled by {}, which no run has", what),
                         find_result(runs.front(), name).source);
  };
  if (const std::string along(named_result(name).along); !along.empty()) {
    if (without_null(of_runs).empty()) return std::nullopt;
    const std::vector<const Result*> abscissas = each(runs, along);
    return without_null(abscissas).empty() ? missing(along) : pooled_profile(of_runs, abscissas);
  }
  if (const auto [array, other] = interval_of(name); !array.empty()) {
    const std::vector<const Result*> arrays = each(runs, array), with = without_null(arrays);
    if (with.empty()) return without_null(of_runs).empty() ? std::nullopt : std::optional(missing(array));
    // One run alone has the intervals that it has, or none.
    if (with.size() == 1 && without_null(of_runs).empty()) return std::nullopt;
    return pooled_ends(name, arrays, of_runs, each(runs, other));
  }
  return std::nullopt;
}

/// Whether a number may be equal in two runs by chance: a count, or a ratio of small counts.
bool may_recur(double value) {
  constexpr int kMaxDenominator = 1000;
  if (!std::isfinite(value)) return true;
  for (int q = 1; q <= kMaxDenominator; ++q)
    if (std::abs(value * q - std::round(value * q)) <= 1e-11 * std::abs(value * q)) return true;
  return false;
}

bool same_run(const std::vector<Result>& a, const std::vector<Result>& b) {
  const auto same = [](double u, double v) { return u == v || (std::isnan(u) && std::isnan(v)); };
  bool told = false;
  if (a.size() != b.size()) return false;
  for (const Result& r : a) {
    const Result* other = seek_result(b, r.name);
    if (other == nullptr || r.text != other->text || r.values.size() != other->values.size() ||
        !std::equal(r.values.begin(), r.values.end(), other->values.begin(), same))
      return false;
    told = told ||
           (!named_result(r.name).may_repeat && !std::all_of(r.values.begin(), r.values.end(), may_recur));
  }
  return told;
}

}  // namespace

std::vector<std::size_t> repeated_runs(const std::vector<std::vector<Result>>& runs) {
  std::vector<std::size_t> first(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    first[i] = i;
    for (std::size_t k = 0; k < i && first[i] == i; ++k)
      if (same_run(runs[k], runs[i])) first[i] = k;
  }
  return first;
}

std::vector<std::string> needed_to_pool(const std::vector<std::string>& only) {
  std::vector<std::string> needed = only;
  const std::vector<std::string> known = result_names();
  const auto need = [&](const std::string& name) {
    if (std::find(needed.begin(), needed.end(), name) == needed.end() &&
        std::find(known.begin(), known.end(), name) != known.end())
      needed.push_back(name);
  };
  for (const std::string& name : only) {
    if (const std::string along(named_result(name).along); !along.empty()) need(along);
    if (const auto [array, other] = interval_of(name); !array.empty()) need(array), need(other);
  }
  return needed;
}

std::vector<Result> pool(const std::vector<std::vector<Result>>& runs, const std::vector<std::string>& only) {
  assert(!runs.empty());
  const std::vector<std::size_t> first = repeated_runs(runs);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (first[i] != i)
      throw ConfigError({.file = {}, .key = "runs"},
                        fmt::format("runs {} and {} are the same run, to the last digit; another seed or "
                                    "repeat is needed to measure the scatter",
                                    first[i] + 1, i + 1));
  std::vector<Result> pooled;
  for (const Result& like : runs.front()) {
    if (auto by_others = pooled_by_others(runs, like.name)) {
      pooled.push_back(std::move(*by_others));
      continue;
    }
    std::vector<const Result*> with;
    std::vector<double> of_runs;
    const Result* none = nullptr;
    for (const auto& results : runs) {
      const Result* r = seek_result(results, like.name);
      const bool has = r != nullptr && r->present();
      if (has) with.push_back(r);
      if (!has && r != nullptr && none == nullptr) none = r;
      of_runs.push_back(has && r->shape.empty() && r->text.empty() ? r->value() : kNaN);
    }
    if (with.empty())
      pooled.push_back(*none);
    else if (!with.front()->text.empty())
      pooled.push_back(pooled_word(with, runs.size()));
    else if (with.front()->shape.empty())
      pooled.push_back(pooled_scalar(with, of_runs));
    else
      pooled.push_back(pooled_array(with, runs.size()));
  }
  if (!only.empty())
    std::erase_if(pooled,
                  [&](const Result& r) { return std::find(only.begin(), only.end(), r.name) == only.end(); });
  return pooled;
}

std::vector<Result> analyze_together(
    std::size_t runs, const AnalysisOptions& options,
    const std::function<std::vector<Result>(std::size_t, const AnalysisOptions&)>& analyse) {
  if (runs == 1) return analyse(0, options);
  AnalysisOptions of_run = options;
  of_run.only = needed_to_pool(options.only);
  std::vector<std::vector<Result>> results;
  for (std::size_t i = 0; i < runs; ++i) results.push_back(analyse(i, of_run));
  return pool(results, options.only);
}

RunEnds::RunEnds(const TrajectorySource& run) : n_frames(run.n_frames()) {
  if (n_frames == 0) return;
  run.read(0, first);
  run.read(n_frames - 1, last);
}

bool RunEnds::of_same_run(const RunEnds& other) const {
  const auto same = [](const Frame& f, const Frame& g) {
    return f.position.size() == g.position.size() &&
           std::equal(f.position.begin(), f.position.end(), g.position.begin(),
                      [](const Vec3& u, const Vec3& v) { return u == v || (u.hasNaN() && v.hasNaN()); });
  };
  return n_frames > 0 && n_frames == other.n_frames && same(first, other.first) && same(last, other.last);
}

namespace {

/// The same for beads in any order: the sum over the beads of the hash (FNV-1a) of their coordinates.
std::uint64_t hash_of(const Frame& frame) {
  std::uint64_t sum = 0;
  for (const Vec3& r : frame.position) {
    if (r.hasNaN()) continue;
    std::uint64_t hash = 14695981039346656037U;
    for (const double x : {r.x(), r.y(), r.z()})
      for (int byte = 0; byte < 8; ++byte)
        hash = (hash ^ ((std::bit_cast<std::uint64_t>(x) >> (8 * byte)) & 0xffU)) * 1099511628211U;
    sum += hash;
  }
  return sum;
}

/// The first frame in which each arrangement of beads is seen.
using Arrangements = std::unordered_map<std::uint64_t, std::size_t>;

Arrangements arrangements_of(const TrajectorySource& run) {
  Arrangements seen;
  Frame frame;
  for (std::size_t f = 0; f < run.n_frames(); ++f) {
    run.read(f, frame);
    seen.emplace(hash_of(frame), f);
  }
  return seen;
}

/// A frame of one run and the equal one of another, if they have one; the first frames may be one start of
/// two runs.
std::optional<std::pair<std::size_t, std::size_t>> shared_frame(const Arrangements& a,
                                                                const Arrangements& b) {
  std::optional<std::pair<std::size_t, std::size_t>> earliest;
  for (const auto& [hash, of_b] : b)
    if (const auto at = a.find(hash); at != a.end() && at->second + of_b > 0)
      if (!earliest || of_b < earliest->second) earliest = {at->second, of_b};
  return earliest;
}

}  // namespace

std::vector<std::string> require_one_condition(const std::vector<const TrajectorySource*>& trajectories) {
  constexpr double kSameDrive = 0.02, kSameBeads = 0.1;
  const auto refuse = [](const TrajectorySource& a, const TrajectorySource& b, const std::string& why) {
    throw ConfigError({.file = b.name(), .key = {}},
                      fmt::format("cannot be pooled with {}: {}", a.name(), why));
  };
  std::vector<RunEnds> ends;
  std::vector<std::map<std::string, std::string>> keys, motions;
  std::vector<std::string> doubts;
  for (const TrajectorySource* t : trajectories) {
    ends.emplace_back(*t);
    motions.push_back(motion_keys(t->info().provenance_json));
    keys.push_back(bed_keys(t->info().provenance_json));
  }
  for (std::size_t i = 1; i < trajectories.size(); ++i) {
    const TrajectorySource &a = *trajectories.front(), &b = *trajectories[i];
    const TrajectoryInfo &p = a.info(), &q = b.info();
    const auto words = [&](const std::string& what, const std::string& of_a, const std::string& of_b) {
      if (of_a != of_b) refuse(a, b, fmt::format("{} {} there, {} here", what, of_a, of_b));
    };
    const auto numbers = [&](const std::string& what, double of_a, double of_b, double tolerance) {
      if (std::abs(of_a - of_b) > tolerance * std::max(std::abs(of_a), std::abs(of_b)))
        refuse(a, b,
               fmt::format("{} is {:.6g} there, {:.6g} here; at most {:g} % apart", what, of_a, of_b,
                           100 * tolerance));
    };
    // Conditions: every run is compared with the first one.
    words("source:", word_of(p.source), word_of(q.source));
    numbers("the dimension", p.box.dimension, q.box.dimension, 0);
    numbers("the number of phases per cycle", p.phases_per_cycle, q.phases_per_cycle, 0);
    words("drive:", p.drive ? "known" : "not known", q.drive ? "known" : "not known");
    if (p.drive) {
      const auto axis = [](const TrajectoryInfo& t) {
        return std::string(1, "xyz"[static_cast<int>(t.drive->axis)]);
      };
      words("the drive is along", axis(p), axis(q));
      numbers("Gamma", p.drive->gamma(), q.drive->gamma(), kSameDrive);
      numbers("the gravity", p.drive->gravity, q.drive->gravity, kSameDrive);
      numbers("omega", p.drive->omega, q.drive->omega, kSameDrive);
      words("the drive is", p.drive->formula(), q.drive->formula());
    }
    words("the sides are", sides_word(p.box.boundary[0]), sides_word(q.box.boundary[0]));
    numbers("the cell's width", p.box.size().x(), q.box.size().x(), kSameDrive);
    numbers("the number of beads", static_cast<double>(ends[0].first.n_present()),
            static_cast<double>(ends[i].first.n_present()), kSameBeads);
    words("start:", p.conditions.start, q.conditions.start);
    if (!keys[0].empty() && !keys[i].empty()) {
      std::set<std::string> named;
      for (const auto& of_run : {keys[0], keys[i]})
        for (const auto& [key, value] : of_run) named.insert(key);
      const auto said = [&](std::size_t run, const std::string& key) {
        const auto at = keys[run].find(key);
        return at == keys[run].end() ? std::string("not stated") : at->second;
      };
      for (const std::string& key : named) words(key + " is", said(0, key), said(i, key));
    } else if (keys[0].empty() != keys[i].empty()) {
      doubts.push_back(
          fmt::format("{} does not contain its scene: whether its beads, contacts and cell are those of {} "
                      "is not checked.",
                      (keys[0].empty() ? a : b).name(), (keys[0].empty() ? b : a).name()));
    }
    for (std::size_t k = 0; k < i; ++k)
      if (ends[k].of_same_run(ends[i]))
        refuse(*trajectories[k], b,
               "both contain the same run, bead for bead; another seed or repeat is needed to measure the "
               "scatter");
      else if (q.source == Origin::simulation && trajectories[k]->info().source == Origin::simulation &&
               !motions[i].empty() && motions[k] == motions[i])
        refuse(*trajectories[k], b,
               "both begin with the same bed, and differ at most in the tables [time] and [until]; another "
               "seed is "
               "needed to measure the scatter");
  }
  // Last, because it reads every frame.
  std::vector<Arrangements> arrangements;
  for (const TrajectorySource* t : trajectories) {
    arrangements.push_back(arrangements_of(*t));
    for (std::size_t k = 0; k + 1 < arrangements.size(); ++k)
      if (const auto frames = shared_frame(arrangements[k], arrangements.back()))
        refuse(
            *trajectories[k], *t,
            fmt::format("frame {} there and frame {} here are equal, bead for bead, so that they are parts "
                        "of one run; another seed or repeat is needed to measure the scatter",
                        frames->first, frames->second));
  }
  return doubts;
}

}  // namespace twincell::analysis
