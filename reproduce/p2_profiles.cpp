// Bhateja, Sharma & Singh 2016, Figs. 12 to 16: local temperature and packing fraction over height.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>

#include "reproduce/alternatives.hpp"
#include "reproduce/gas.hpp"

namespace twincell::reproduce {

namespace {

/// W = 5.58, 22.35, 50.3, 68.46, 85.01 of the paper.
const std::vector<int> kFrequencies = {1000, 2000, 3000, 3500, 3900};

/// The paper averages "the temperature T_z in a box" around z. It does not state which mean velocity is
/// subtracted, or how an instant with an empty box counts. Every figure is drawn for all readings. A target
/// is judged once, in the reading kCounted of all figures, and states the others next to it.
struct Reading {
  const char* result;  ///< array of the observable, analysis/gas/profiles.hpp
  const char* name;
  const char* said;       ///< appended to a line of the table
  const char* figure;     ///< appended to a figure's name
  const char* drawn;      ///< in a figure
  bool of_pairs = false;  ///< only instants with two beads or more in the slab contribute
};
constexpr Reading kReadings[] = {
    {"T_z_z", "about the slab's mean", "", "", "variance about the mean velocity of the slab"},
    {"T_z_frames_z", "mean over time, empty slabs 0", " (mean over time, an empty slab counts as 0)", "-time",
     "mean over time, an empty slab counts as 0"},
    {"T_z_instant_z", "about the slab's mean of the instant, fewer than two beads 0",
     " (about the slab's mean of the instant, fewer than two beads count as 0)", "-instant",
     "variance about the mean of the slab at each instant, fewer than two beads count as 0", true}};
/// The paper has one T_z(z), so one reading counts in Figs. 12, 14 and 16: the one that meets most of the
/// targets of the three together.
constexpr std::size_t kCounted = 2;

/// Title of a figure of the local temperature: what is drawn, and the reading in a second line.
std::string title_of(const std::string& what, const Reading& reading) {
  return what + "\n{/*0.85 T_z(z): " + reading.drawn + "}";
}

/// The targets in the reading that counts; the reason states the others, where the runs have them. \param
/// by_reading targets for each of kReadings
std::vector<Target> counted_of(const std::vector<std::vector<Target>>& by_reading) {
  std::vector<Target> targets = by_reading[kCounted];
  for (std::size_t k = 0; k < targets.size(); ++k) {
    Target& t = targets[k];
    if (t.verdict == Verdict::absent) continue;
    t.reason += fmt::format("{}reading: {}", t.reason.empty() ? "" : "; ", kReadings[kCounted].name);
    for (std::size_t r = 0; r < by_reading.size(); ++r)
      if (const Target& other = by_reading[r][k]; r != kCounted && other.verdict != Verdict::absent)
        t.reason += fmt::format("; {}: {}, {}", kReadings[r].name, word_of(other.verdict), other.measured);
  }
  return targets;
}

/// A profile over height with the relative errors of T and phi in each slab, estimated from the number of
/// beads in it summed over the cycles.
struct Profile {
  std::vector<double> z, t, phi, error, phi_error;

  /// T and phi of a slab.
  [[nodiscard]] Estimate temperature(std::size_t k) const { return with_error(t[k], error[k]); }
  [[nodiscard]] Estimate fraction(std::size_t k) const { return with_error(phi[k], phi_error[k]); }
  /// Slab with the largest T; empty without a temperature.
  [[nodiscard]] std::optional<std::size_t> hottest() const {
    std::optional<std::size_t> top;
    for (std::size_t k = 0; k < t.size(); ++k)
      if (std::isfinite(t[k]) && (!top || t[k] > t[*top])) top = k;
    return top;
  }
  /// Height of the largest T. The interval holds the slabs that may be the hottest within their errors.
  /// \pre there is a temperature
  [[nodiscard]] Estimate hottest_height() const { return top_of(t, error, *hottest()); }
  /// Slab with the largest phi.
  [[nodiscard]] std::size_t densest() const {
    return static_cast<std::size_t>(std::max_element(phi.begin(), phi.end()) - phi.begin());
  }
  /// Height of the largest phi, as hottest_height.
  [[nodiscard]] Estimate densest_height() const { return top_of(phi, phi_error, densest()); }
  /// A second maximum of T above the first one. It exceeds the minimum between them by three errors of the
  /// difference and by a twentieth of the first maximum.
  struct Second {
    double z = 0;         ///< height
    Estimate over_first;  ///< temperature relative to the first maximum
  };
  [[nodiscard]] std::optional<Second> second() const {
    constexpr double kErrors = 3;
    std::optional<std::size_t> first, dip;
    std::optional<Second> found;
    for (std::size_t k = 0; k < t.size(); ++k) {
      if (!std::isfinite(t[k])) continue;
      if (!first || (t[k] > t[*first] && !dip)) first = k;
      if (t[k] < t[*first] * (1 - kErrors * std::hypot(error[k], error[*first])) &&
          (!dip || t[k] < t[*dip])) {
        dip = k;
        if (!found) continue;
      }
      if (!dip || k <= *dip) continue;
      if (t[k] - t[*dip] >
              std::max(kRise * t[*first], kErrors * std::hypot(error[k] * t[k], error[*dip] * t[*dip])) &&
          (!found || t[k] > found->over_first.value * t[*first])) {
        const double ratio = t[k] / t[*first], half = 2 * ratio * std::hypot(error[k], error[*first]);
        found = Second{z[k], {.value = ratio, .low = ratio - half, .high = ratio + half}};
      }
    }
    return found;
  }

  /// Pass if there is a second maximum. Fail if the errors exclude one: above the first maximum, no slab can
  /// exceed a lower one by a twentieth of that maximum. Else inconclusive. \pre there is a temperature
  [[nodiscard]] Verdict has_second() const {
    if (second()) return Verdict::pass;
    const std::size_t first = *hottest();
    double least = t[first] * (1 + 2 * error[first]), rise = 0;
    for (std::size_t k = first + 1; k < t.size(); ++k) {
      if (!std::isfinite(t[k])) continue;
      rise = std::max(rise, t[k] * (1 + 2 * error[k]) - least);
      least = std::min(least, t[k] * (1 - 2 * error[k]));
    }
    return rise < kRise * t[first] ? Verdict::fail : Verdict::inconclusive;
  }
  /// Pass if the errors exclude a second maximum, fail if there is one, else inconclusive.
  [[nodiscard]] Verdict lacks_second() const {
    const Verdict has = has_second();
    return has == Verdict::pass ? Verdict::fail : has == Verdict::fail ? Verdict::pass : has;
  }

 private:
  static constexpr double kRise = 0.05;  ///< smallest rise of a second maximum, relative to the first
  static Estimate with_error(double y, double relative) {
    return {.value = y, .low = y * (1 - 2 * relative), .high = y * (1 + 2 * relative)};
  }
  [[nodiscard]] Estimate top_of(const std::vector<double>& y, const std::vector<double>& errors,
                                std::size_t top) const {
    constexpr double kHalf = 0.5;
    Estimate e{.value = z[top], .low = z[top] - kHalf, .high = z[top] + kHalf};
    for (std::size_t k = 0; k < y.size(); ++k)
      if (std::isfinite(y[k]) && y[k] * (1 + 2 * errors[k]) >= y[top] * (1 - 2 * errors[top])) {
        e.low = std::min(*e.low, z[k] - kHalf);
        e.high = std::max(*e.high, z[k] + kHalf);
      }
    return e;
  }
};

/// Beads of a slab that vary independently, of `beads` at an instant. About the mean of the instant n beads
/// leave n - 1; for independent beads the mean of that over the instants is beads - 1 + exp(-beads).
double varying(const Reading& reading, double beads) {
  return reading.of_pairs ? beads + std::expm1(-beads) : beads;
}

std::optional<Profile> profile_of(const GasPoint& p, const Reading& reading, double floor_area, bool flat) {
  const auto z = p.arrays.find("profile_z"), t = p.arrays.find(reading.result), phi = p.arrays.find("phi_z");
  if (z == p.arrays.end() || t == p.arrays.end() || phi == p.arrays.end()) return std::nullopt;
  Profile profile{z->second, t->second, phi->second, {}, {}};
  // Count the beads of a slab once per cycle. A slab that only a few beads crossed gets no temperature.
  constexpr double kMinBeadCounts = 100;
  const double bead = flat ? std::numbers::pi / 4 : std::numbers::pi / 6;
  for (std::size_t k = 0; k < profile.phi.size(); ++k) {
    const double beads = profile.phi[k] * floor_area / bead, cycles = static_cast<double>(p.cycles);
    profile.error.push_back(std::sqrt(2 / std::max(1.0, varying(reading, beads) * cycles)));
    profile.phi_error.push_back(std::sqrt(2 / std::max(1.0, beads * cycles)));
    if (beads * cycles < kMinBeadCounts) profile.t[k] = std::nan("");
  }
  return profile;
}

double area_of(int dimension) {
  return dimension == 2 ? 10 : 25;
}

std::string height(double z) {
  return fmt::format("z = {:g}", z);
}

/// Lower end of the target "off the base": above the slab that lies on the plate.
const double kOffTheBase = std::nextafter(1.0, 2.0);

/// Profiles as the figures show them, from the base on.
Series temperatures(const std::string& title, const Profile& p) {
  Series s{.title = title, .x = {}, .y = {}};
  for (std::size_t k = 0; k < p.z.size(); ++k) {
    if (!std::isfinite(p.t[k]) || p.z[k] < 0) continue;
    s.x.push_back(p.z[k]);
    s.y.push_back(p.temperature(k));
  }
  return s;
}

Series packing(const std::string& title, const Profile& p) {
  Series s{.title = title, .x = {}, .y = {}};
  for (std::size_t k = 0; k < p.z.size(); ++k) {
    if (p.z[k] < 0) continue;
    s.x.push_back(p.z[k]);
    s.y.push_back(p.fraction(k));
  }
  return s;
}

std::string described(const Profile& p) {
  const auto top = p.hottest();
  if (!top) return "no temperature";
  const auto second = p.second();
  return fmt::format(
      "hottest at z = {}, {}", p.hottest_height().text(),
      second ? fmt::format("second peak at {}, {} of the first", height(second->z), second->over_first.text())
             : std::string("no second peak"));
}

Reproduction begun(Gas& gas, const std::string& title) {
  Reproduction r;
  r.title = title;
  r.complete = gas.run();
  r.table = gas.table();
  r.measured = gas.as_json(true);
  r.conditions = gas.conditions();
  r.runs = gas.runs_text();
  r.cheaper = gas.cheaper();
  return r;
}

// ---------------------------------------------------------------- Figs. 12 and 13

/// Profile of the bed at one depth and frequency.
using ProfileOf = std::function<std::optional<Profile>(std::size_t depth, std::size_t frequency)>;

std::vector<Target> targets_12(const std::vector<double>& depths, const ProfileOf& of) {
  Target low{"W = 5.58: falls with height, low second peak before vanishing", "every N", "", Verdict::absent,
             ""};
  std::vector<Verdict> verdicts;
  for (std::size_t d = 0; d < depths.size(); ++d)
    if (const auto p = of(d, 0); p && p->hottest()) {
      low.measured +=
          fmt::format("{}N = {:g}: {}", low.measured.empty() ? "" : "; ", depths[d], described(*p));
      constexpr double kBase = 3;
      verdicts.push_back(all_of({judge(p->hottest_height(), 0, kBase), p->has_second()}));
    }
  constexpr std::size_t kDepthsOfFigure = 4;  // N = 4, 6, 8, 10
  low.verdict = all_of(verdicts, kDepthsOfFigure);
  if (all_of(verdicts) == Verdict::inconclusive)
    low.reason = "a second peak neither stands out of the noise of its slabs nor is excluded";

  Target warm{"W = 22.35, N = 4: no second peak, hottest 7 to 10 d above the base", "7 to 10", "",
              Verdict::absent, ""};
  if (const auto p = of(0, 1); p && p->hottest()) {
    warm.measured = described(*p);
    warm.verdict = all_of({judge(p->hottest_height(), 7, 10), p->lacks_second()});
  }
  Target back{"W = 50.3, N = 4: the second peak is back", "a second peak", "", Verdict::absent, ""};
  if (const auto p = of(0, 2); p && p->hottest()) {
    back.measured = described(*p);
    back.verdict = p->has_second();
  }
  Target equal{"W = 85.01, N = 4: second peak comparable to the first", "0.7 to 1.3 of it", "",
               Verdict::absent, ""};
  if (const auto p = of(0, 4); p && p->hottest()) {
    equal.measured = described(*p);
    const auto second = p->second();
    equal.verdict = second ? judge(second->over_first, 0.7, 1.3) : p->has_second();
  }
  Target off{"W = 50.3: hottest off the base for deep beds as well", "z > 1", "", Verdict::absent, ""};
  if (const auto p = of(depths.size() - 1, 2); p && p->hottest()) {
    off.measured = fmt::format("N = {:g}: {}", depths.back(), described(*p));
    off.verdict = judge(p->hottest_height(), kOffTheBase, kUnbounded);
  }
  return {low, warm, back, equal, off};
}

Reproduction run_12(const Request& request) {
  const GasSize& size = gas_size_for(request);
  std::vector<double> depths = {4, 8};
  if (request.full) depths = {4, 6, 8, 10};
  Gas gas(request);
  for (const double n : depths) {
    GasCurve curve{.name = fmt::format("3D smooth, N = {:g}", n),
                   .scene = "preset = \"bhateja-2016-smooth-3d\"",
                   .relative_error = size.relative_error,
                   .cycles = size.cycles};
    if (n != 4) curve.scene += fmt::format("\nbeads.layers = {}", n);
    for (const int rpm : kFrequencies) curve.values.push_back(w_of_rpm(rpm));
    gas.add(curve);
  }
  Reproduction r = begun(
      gas, "Bhateja et al. 2016, Figs. 12 and 13: local temperature over height, deep and shallow beds");
  static constexpr const char* kNames[] = {"p2-fig12a", "p2-fig12b", "p2-fig12c", "p2-fig13a", "p2-fig13b"};
  std::string lines;
  std::vector<std::vector<Target>> by_reading;
  for (const Reading& reading : kReadings) {
    const ProfileOf of = [&](std::size_t depth, std::size_t k) {
      return profile_of(gas.points(depth)[k], reading, area_of(3), false);
    };
    for (std::size_t d = 0; d < depths.size(); ++d)
      for (std::size_t k = 0; k < kFrequencies.size(); ++k)
        if (const auto p = of(d, k))
          lines += fmt::format("  {}, W = {:.4g}{}: {}\n", gas.curve(d).name, gas.points(d)[k].at,
                               reading.said, described(*p));
    by_reading.push_back(targets_12(depths, of));
    for (std::size_t k = 0; k < kFrequencies.size(); ++k) {
      std::vector<Series> series;
      for (std::size_t d = 0; d < depths.size(); ++d)
        if (const auto p = of(d, k)) series.push_back(temperatures(fmt::format("N = {:g}", depths[d]), *p));
      if (series.empty()) continue;
      SeriesFigure figure{
          .name = std::string(kNames[k]) + reading.figure,
          .panel = kNames[k][std::string_view(kNames[k]).size() - 1],
          .title = title_of(fmt::format("3D smooth, W = {:.4g}", w_of_rpm(kFrequencies[k])), reading),
          .x = {.label = "z/d", .low = 0},
          .y = {.label = "T_z(z)/(m g d)", .low = 0},
          .caption =
              fmt::format("3D smooth, slabs of d, T_z(z) as {}; bars of two errors. Form of Bhateja et al. "
                          "2016, Figs. 12 and 13.",
                          reading.drawn)};
      if (k == 1) {
        figure.marks = analysis::figure_style::stated_band_x(7, 10);
        figure.entries = {analysis::figure_style::stated_band_entry("paper: hottest, N = 4")};
      }
      r.figures.push_back(series_figure(figure, series));
    }
  }
  r.targets = counted_of(by_reading);
  r.table = lines + r.table;
  r.cheaper.push_back(fmt::format("{} depths", depths.size()));
  return r;
}

// ---------------------------------------------------------------- Figs. 14 and 15

struct Pair {
  std::vector<std::optional<Profile>> smooth, rough;  ///< one per frequency of kFrequencies
};

void add_pair(Gas& gas, const Request& request) {
  const GasSize& size = gas_size_for(request);
  gas.add(GasSystem{3, false}, size, kFrequencies);
  gas.add(GasSystem{3, true}, size, kFrequencies);
}

Pair pair_of(const Gas& gas, const Reading& reading) {
  Pair pair;
  for (std::size_t k = 0; k < kFrequencies.size(); ++k) {
    pair.smooth.push_back(profile_of(gas.points(0)[k], reading, area_of(3), false));
    pair.rough.push_back(profile_of(gas.points(1)[k], reading, area_of(3), false));
  }
  return pair;
}

std::vector<analysis::Figure> pair_figures(const std::string& name, const Pair& pair, bool of_packing,
                                           const Reading& reading) {
  // Limit the axis: a single bead far above the bed would compress the bed into a corner of the figure.
  constexpr double kShown = 1e-3;
  std::vector<analysis::Figure> figures;
  for (const bool rough : {false, true}) {
    std::vector<Series> series;
    double top = 0;
    for (std::size_t k = 0; k < kFrequencies.size(); ++k)
      if (const auto& p = (rough ? pair.rough : pair.smooth)[k]) {
        const std::string title = fmt::format("W = {:.4g}", w_of_rpm(kFrequencies[k]));
        series.push_back(of_packing ? packing(title, *p) : temperatures(title, *p));
        for (std::size_t i = 0; i < p->z.size(); ++i)
          if (p->phi[i] > kShown) top = std::max(top, p->z[i]);
      }
    if (series.empty()) continue;
    for (Series& s : series) {
      const auto end = std::upper_bound(s.x.begin(), s.x.end(), top);
      s.y.resize(static_cast<std::size_t>(end - s.x.begin()));
      s.x.erase(end, s.x.end());
    }
    const std::string system = fmt::format("3D {}, N = 4", rough ? "rough" : "smooth");
    figures.push_back(series_figure(
        {.name = name + (rough ? "b" : "a") + reading.figure,
         .panel = rough ? 'b' : 'a',
         .title = of_packing ? system : title_of(system, reading),
         .x = {.label = "z/d", .low = 0},
         .y = {.label = of_packing ? "φ(z)" : "T_z(z)/(m g d)", .low = 0},
         .caption =
             of_packing
                 ? "Packing fraction, 100 grains, N = 4, slabs of d; bars of two errors. Form of Bhateja et "
                   "al. 2016, Fig. 15."
                 : fmt::format("100 grains, N = 4, slabs of d, T_z(z) as {}; bars of two errors. Form of "
                               "Bhateja et al. 2016, Fig. 14.",
                               reading.drawn)},
        series));
  }
  return figures;
}

std::vector<Target> targets_14(const Pair& pair) {
  Target rises{"T_z(z) rises with W", "at every height below 10 d", "", Verdict::absent, ""};
  std::vector<Verdict> verdicts;
  for (const auto* side : {&pair.smooth, &pair.rough})
    for (std::size_t k = 1; k < side->size(); ++k) {
      const auto &lower = (*side)[k - 1], &upper = (*side)[k];
      if (!lower || !upper) continue;
      for (std::size_t i = 0; i < lower->z.size(); ++i)
        for (std::size_t j = 0; j < upper->z.size(); ++j)
          if (lower->z[i] == upper->z[j] && lower->z[i] > 1 && lower->z[i] < 10 &&
              std::isfinite(lower->t[i]) && std::isfinite(upper->t[j])) {
            verdicts.push_back(above(upper->temperature(j), lower->temperature(i)));
          }
    }
  rises.measured =
      verdicts.empty()
          ? ""
          : fmt::format("{} pairs of slabs, {} rise", verdicts.size(),
                        std::count(verdicts.begin(), verdicts.end(), Verdict::pass)) +
                fmt::format(", {} fall", std::count(verdicts.begin(), verdicts.end(), Verdict::fail));
  rises.verdict = all_of(verdicts);
  const auto last = kFrequencies.size() - 1;
  Target smooth{"W = 85: second peak for smooth grains", "yes", "", Verdict::absent, ""};
  if (const auto& p = pair.smooth[last]) {
    smooth.measured = described(*p);
    smooth.verdict = p->hottest() ? p->has_second() : Verdict::absent;
  }
  Target rough{"no second peak for rough grains", "none at any W", "", Verdict::absent, ""};
  verdicts.clear();
  for (std::size_t k = 0; k < pair.rough.size(); ++k)
    if (const auto& p = pair.rough[k]; p && p->hottest()) {
      verdicts.push_back(p->lacks_second());
      if (p->second())
        rough.measured += fmt::format("W = {:.4g}: {}. ", w_of_rpm(kFrequencies[k]), described(*p));
    }
  if (!verdicts.empty() && rough.measured.empty())
    rough.measured = fmt::format("none seen at {} W, excluded at {}", verdicts.size(),
                                 std::count(verdicts.begin(), verdicts.end(), Verdict::pass));
  rough.verdict = all_of(verdicts, pair.rough.size());
  Target off{"hottest off the base at high W, smooth", "z > 1 at W >= 22", "", Verdict::absent, ""};
  verdicts.clear();
  for (std::size_t k = 1; k < pair.smooth.size(); ++k)
    if (const auto& p = pair.smooth[k]; p && p->hottest()) {
      verdicts.push_back(judge(p->hottest_height(), kOffTheBase, kUnbounded));
      off.measured += fmt::format("{}z = {}", off.measured.empty() ? "" : ", ", p->hottest_height().text());
    }
  off.verdict = all_of(verdicts);
  return {rises, smooth, rough, off};
}

Reproduction run_14(const Request& request) {
  Gas gas(request);
  add_pair(gas, request);
  Reproduction r =
      begun(gas, "Bhateja et al. 2016, Fig. 14: local temperature over height, 3D smooth and rough");
  std::vector<std::vector<Target>> by_reading;
  for (const Reading& reading : kReadings) {
    const Pair pair = pair_of(gas, reading);
    by_reading.push_back(targets_14(pair));
    for (analysis::Figure& figure : pair_figures("p2-fig14", pair, false, reading))
      r.figures.push_back(figure);
  }
  r.targets = counted_of(by_reading);
  return r;
}

Reproduction run_15(const Request& request) {
  Gas gas(request);
  add_pair(gas, request);
  Reproduction r =
      begun(gas, "Bhateja et al. 2016, Fig. 15: packing fraction over height, 3D smooth and rough");
  const Pair pair = pair_of(gas, kReadings[kCounted]);
  Target rough{"phi(z) peaks nearer to the base and higher when rough", "at each W", "", Verdict::absent, ""};
  Target moves{"the peak of phi moves up with W", "monotonic", "", Verdict::absent, ""};
  Target apart{"phi and T peak at different heights", "at W >= 22", "", Verdict::absent, ""};
  std::vector<Verdict> nearer, up, different;
  std::vector<Estimate> peaks;
  for (std::size_t k = 0; k < kFrequencies.size(); ++k) {
    const auto &s = pair.smooth[k], &q = pair.rough[k];
    if (s && q) {
      const Estimate zs = s->densest_height(), zq = q->densest_height();
      nearer.push_back(all_of({above(zs, zq), above(q->fraction(q->densest()), s->fraction(s->densest()))}));
      rough.measured += fmt::format("{}W = {:.3g}: {:.2g} at z = {}, rough {:.2g} at {}",
                                    rough.measured.empty() ? "" : "; ", w_of_rpm(kFrequencies[k]),
                                    s->phi[s->densest()], zs.text(), q->phi[q->densest()], zq.text());
    }
    if (s) {
      moves.measured +=
          fmt::format("{}{}", moves.measured.empty() ? "z = " : ", ", s->densest_height().text());
      // Neighbouring W may share a slab, so only a peak that moves down counts before the ends are compared.
      if (!peaks.empty() && above(peaks.back(), s->densest_height()) == Verdict::pass)
        up.push_back(Verdict::fail);
      peaks.push_back(s->densest_height());
    }
    if (k > 0 && s && s->hottest()) {
      different.push_back(differ(s->hottest_height(), s->densest_height()));
      apart.measured += fmt::format("{}{} and {}", apart.measured.empty() ? "z = " : ", ",
                                    s->densest_height().text(), s->hottest_height().text());
    }
  }
  if (peaks.size() > 1) up.push_back(above(peaks.back(), peaks.front()));
  rough.verdict = all_of(nearer);
  moves.verdict = all_of(up);
  apart.verdict = all_of(different);
  r.targets = {rough, moves, apart};
  r.figures = pair_figures("p2-fig15", pair, true, kReadings[0]);
  return r;
}

// ---------------------------------------------------------------- Fig. 16

constexpr double kStations[] = {0.5, 2.5, 4.5, 7.5, 11.5};

/// T_z(z)/(m V_p^2) of a system at a height, against W.
Series station(const Gas& gas, std::size_t curve, const Reading& reading, int dimension, double z) {
  Series s{.title = fmt::format("z = {:g} d", z), .x = {}, .y = {}};
  for (const GasPoint& point : gas.points(curve)) {
    const auto p = profile_of(point, reading, area_of(dimension), dimension == 2);
    if (!p || point.at < 1 || point.solid()) continue;  // a solid bed has no temperature
    for (std::size_t k = 0; k < p->z.size(); ++k)
      if (p->z[k] == z && std::isfinite(p->t[k])) {
        const double t = p->t[k] / point.at;  // V_p^2 = W d g
        s.x.push_back(point.at);
        s.y.push_back({.value = t, .low = t * (1 - 2 * p->error[k]), .high = t * (1 + 2 * p->error[k])});
      }
  }
  return s;
}

/// Target that a series falls, or rises, from W = 5 to the largest W.
Target trend_target(const std::string& name, const Series& s, bool falls) {
  constexpr double kFrom = 5;
  Target t{name + ", z = " + s.title.substr(4), falls ? "falls with W" : "rises with W", "", Verdict::absent,
           "the paper's heights stand in its legend alone"};
  std::size_t first = 0;
  while (first < s.x.size() && s.x[first] < kFrom) ++first;
  if (first + 1 >= s.x.size()) return t;
  t.measured = fmt::format("{} at W = {:.3g}, {} at {:.3g}", s.y[first].text(), s.x[first], s.y.back().text(),
                           s.x.back());
  const std::vector<Estimate> from(s.y.begin() + static_cast<std::ptrdiff_t>(first), s.y.end());
  const Trend found = trend_of(from, !falls);
  t.verdict = found.verdict;
  if (found.against)
    t.measured += fmt::format("; {} from {} at W = {:.3g} to {} at {:.3g}", falls ? "rises" : "falls",
                              from[found.against->first].text(), s.x[first + found.against->first],
                              from[found.against->second].text(), s.x[first + found.against->second]);
  return t;
}

/// The mean of T_z(z) over the volume, eq. 1 of the paper, scaled as the stations.
Series volume_of(const std::vector<GasPoint>& points) {
  Series s{.title = "mean over the volume", .x = {}, .y = {}};
  for (const GasPoint& p : points)
    if (const auto t = p.get("T_z_volume"); t && p.at >= 1 && !p.solid()) {
      s.x.push_back(p.at);
      s.y.push_back({.value = t->value / p.at, .low = {}, .high = {}});
    }
  return s;
}

/// Target that the mean over the volume becomes constant in W at a smaller W than at any fixed height.
Target volume_first(const std::string& name, const Series& volume, const std::vector<Series>& stations) {
  Target t{name + ": the mean over the volume flattens before those at fixed heights",
           "from a smaller W on than at any height", "", Verdict::absent,
           "flat: within 5 % of the last value, errors counted; the volume: eq. 1, slabs of equal weight"};
  const auto whole = flat_from(volume, true);
  std::vector<Verdict> verdicts;
  std::string at_heights;
  for (const Series& s : stations)
    if (const auto local = flat_from(s, true); local && whole && std::min(volume.x.size(), s.x.size()) > 2) {
      verdicts.push_back(above(*local, *whole));
      at_heights += fmt::format("{}{:.3g} ({})", at_heights.empty() ? "" : ", ", local->value, s.title);
    }
  if (verdicts.empty()) return t;
  t.measured = fmt::format("flat from W = {:.3g} on, at heights from {}", whole->value, at_heights);
  t.verdict = all_of(verdicts);
  return t;
}

Reproduction run_16(const Request& request) {
  const GasSize& size = gas_size_for(request);
  Gas gas(request);
  for (const GasSystem& system : gas_systems()) gas.add(system, size, size.rpm);
  Reproduction r =
      begun(gas, "Bhateja et al. 2016, Fig. 16: scaled local temperature at fixed heights against W");
  std::vector<std::vector<Target>> by_reading;
  for (const Reading& reading : kReadings) {
    std::vector<Target>& targets = by_reading.emplace_back();
    for (std::size_t c = 0; c < gas_systems().size(); ++c) {
      const GasSystem& system = gas_systems()[c];
      std::vector<Series> series;
      for (const double z : kStations) series.push_back(station(gas, c, reading, system.dimension, z));
      targets.push_back(trend_target(system.name() + ": lowest z", series[0], true));
      targets.push_back(trend_target(system.name() + ": low z", series[1], true));
      targets.push_back(trend_target(system.name() + ": high z", series[4], false));
      targets.push_back(volume_first(system.name(), volume_of(gas.points(c)), series));
      // Runs of an earlier version do not have every reading.
      if (&reading != &kReadings[kCounted] &&
          std::ranges::all_of(series, [](const Series& s) { return s.x.empty(); }))
        continue;
      r.figures.push_back(series_figure(
          {.name = fmt::format("p2-fig16{}{}", "bdac"[c], reading.figure),
           .panel = "bdac"[c],
           .title = title_of(system.name() + ", N = 4", reading),
           .x = w_axis(),
           .y = {.label = "T_z(z)/(m V_p^2)", .low = 0},
           .caption = fmt::format("{}, slabs of d at fixed heights, T_z(z) as {}; bars of two errors. "
                                  "Form of Bhateja et al. 2016, Fig. 16.",
                                  system.name(), reading.drawn)},
          series));
    }
  }
  r.targets = counted_of(by_reading);
  return r;
}

}  // namespace

Reproducible p2_fig12() {
  Reproducible entry = gas_entry(
      "p2-fig12", "local temperature against height, shallow and deep beds (Figs. 12 and 13)", run_12);
  entry.time_share = 2;
  return entry;
}
Reproducible p2_fig13() {
  Reproducible entry = gas_entry("p2-fig13", "same as p2-fig12, which also draws Fig. 13", run_12);
  entry.same_as = "p2-fig12";
  return entry;
}
Reproducible p2_fig14() {
  return gas_entry_of("p2-fig2", "p2-fig14", "local temperature against height, 3D smooth and rough", run_14);
}
Reproducible p2_fig15() {
  return gas_entry_of("p2-fig2", "p2-fig15", "packing fraction against height, 3D smooth and rough", run_15);
}
Reproducible p2_fig16() {
  return gas_entry_of("p2-fig2", "p2-fig16", "scaled local temperature against W at fixed heights", run_16);
}

}  // namespace twincell::reproduce
