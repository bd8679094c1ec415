#include "cli/cost_locate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "imaging/benchmark/locating_cost.hpp"

namespace twincell::cli {

namespace {

constexpr std::array kSweeps = {0, 1, 2, 3, 4, 6, 30};
constexpr std::array kQuickSweeps = {0, 2, 30};
constexpr std::array kRings = {1.5, 2.0, 3.0, 4.0, 5.0};
constexpr std::array kDiameters = {6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0};
constexpr std::array kQuickDiameters = {8.0, 15.0};
constexpr std::array kNoise = {164.0, 51.0, 18.5, 8.5};
constexpr std::array kQuickNoise = {51.0, 18.5};
const imaging::LocateSetting kUsual{};
constexpr int kTracers = 20,
              kPhases = 20;  // tracers in a line, and least phases per cycle (Fortini & Huang 2015)

struct MeasuredLocating {
  std::vector<imaging::LocatePrecision> all;
  imaging::LocateScene scene;
  double accuracy;

  template <class Takes>
  [[nodiscard]] std::vector<imaging::LocatePrecision> those(const Takes& takes) const {
    std::vector<imaging::LocatePrecision> some;
    std::copy_if(all.begin(), all.end(), std::back_inserter(some),
                 [&](const imaging::LocatePrecision& p) { return takes(p.setting); });
    return some;
  }
  [[nodiscard]] std::vector<double> noise() const {
    std::vector<double> levels;
    for (const imaging::LocatePrecision& p : all)
      if (std::find(levels.begin(), levels.end(), p.setting.snr) == levels.end())
        levels.push_back(p.setting.snr);
    return levels;
  }
};

bool is_usual_picture(const imaging::LocateSetting& s) {
  return s.diameter_px == kUsual.diameter_px && s.snr == kUsual.snr;
}
bool is_usual_way(const imaging::LocateSetting& s) {
  return s.finder == kUsual.finder && s.ring_px == kUsual.ring_px && s.method == kUsual.method;
}

std::vector<imaging::LocateSetting> settings(bool quick) {
  std::vector<imaging::LocateSetting> all;
  const auto add = [&](const imaging::LocateSetting& s) {
    if (std::find(all.begin(), all.end(), s) == all.end()) all.push_back(s);
  };
  const auto ladder = [&](imaging::LocateSetting s, const auto& sweeps) {
    for (const int n : sweeps) {
      s.sweeps = n;
      add(s);
    }
  };
  const auto grid = [&](const auto& sweeps, const auto& noise, const auto& diameters) {
    ladder(kUsual, sweeps);
    for (const double snr : noise) ladder({.snr = snr}, sweeps);
    for (const double d : diameters) ladder({.diameter_px = d}, sweeps);
  };
  if (quick)
    grid(kQuickSweeps, kQuickNoise, kQuickDiameters);
  else
    grid(kSweeps, kNoise, kDiameters);
  for (const imaging::LocateSetting& s : std::vector(all))
    add({.method = "edges", .diameter_px = s.diameter_px, .snr = s.snr});
  for (const int n : {0, 30}) add({.finder = "hough", .sweeps = n});
  if (!quick)
    for (const double ring : kRings) add({.ring_px = ring});
  return all;
}

std::string way(const imaging::LocateSetting& s) {
  if (s.sweeps == 0) return s.finder + " alone";
  if (s.method == "edges") return s.finder + ", edges";
  std::string w = fmt::format(
      "{}, {}", s.finder,
      s.sweeps == kUsual.sweeps ? "fit" : fmt::format("{} sweep{}", s.sweeps, s.sweeps == 1 ? "" : "s"));
  if (s.ring_px != kUsual.ring_px) w += fmt::format(", ring {:g}", s.ring_px);
  return w;
}

nlohmann::json as_json(const imaging::LocatePrecision& p) {
  const imaging::LocateSetting& s = p.setting;
  return {{"finder", s.finder},
          {"refine", s.sweeps == 0 ? "none" : s.method},
          {"sweeps", s.sweeps},
          {"ring_px", s.ring_px},
          {"diameter_px", s.diameter_px},
          {"snr", s.snr},
          {"recall", p.recall},
          {"precision", p.precision},
          {"rms_px", p.rms},
          {"bound_px", p.bound},
          {"rms_over_bound", p.rms / p.bound},
          {"bias_px", {p.bias_x, p.bias_y}},
          {"locking_px", p.locking},
          {"locking_by_chance_px", p.locking_by_chance},
          {"ms_per_frame", 1e3 * p.seconds},
          {"s_b_noise",
           {{"one_tracer", imaging::bed_displacement_noise(p.relative(), 1, 1, kPhases)},
            {"tracers", imaging::bed_displacement_noise(p.relative(), kTracers, 1, kPhases)}}}};
}

nlohmann::json as_json(const MeasuredLocating& m) {
  nlohmann::json d = {{"what", "locate"},
                      {"scene",
                       {{"beads", m.scene.beads},
                        {"width_beads", m.scene.width},
                        {"height_beads", m.scene.height},
                        {"frames", m.scene.frames}}},
                      {"accuracy_px", m.accuracy},
                      {"s_b_threshold", analysis::kBouncingThreshold},
                      {"tracers", kTracers},
                      {"phases", kPhases}};
  for (const imaging::LocatePrecision& p : m.all) d["settings"].push_back(as_json(p));
  d["front"] = nlohmann::json::array();
  for (const imaging::LocatePrecision& p : imaging::front(m.all, kUsual.diameter_px, kUsual.snr))
    d["front"].push_back(as_json(p));
  for (const double snr : m.noise()) {
    const auto best = imaging::cheapest(m.all, kUsual.diameter_px, snr, m.accuracy);
    d["cheapest"].push_back({{"snr", snr}, {"setting", best ? as_json(*best) : nlohmann::json()}});
  }
  return d;
}

std::string table(const std::vector<imaging::LocatePrecision>& rows) {
  std::string s =
      fmt::format("  {:<22} {:>4} {:>5}  {:>7} {:>9}  {:>8} {:>8} {:>6}  {:>17}  {:>8}  {:>8}\n", "method",
                  "px", "SNR", "recall", "precision", "rms", "bound", "ratio", "bias", "locking", "ms");
  for (const imaging::LocatePrecision& p : rows)
    s += fmt::format(
        "  {:<22} {:>4g} {:>5g}  {:>7.4f} {:>9.4f}  {:>8.5f} {:>8.5f} {:>6.2f}  {:>+8.5f} {:>+8.5f}  "
        "{:>8.5f}  {:>8.1f}\n",
        way(p.setting), p.setting.diameter_px, p.setting.snr, p.recall, p.precision, p.rms, p.bound,
        p.rms / p.bound, p.bias_x, p.bias_y, p.locking, 1e3 * p.seconds);
  return s;
}

std::string as_text(const MeasuredLocating& m) {
  std::string s = fmt::format(
      "Accuracy against computing time. {} touching beads in a frame of {} x {} beads; {} such frames.\n"
      "rms: error per coordinate, px; bound: Cramér-Rao, px; bias in x and y, px; locking to pixels, px; ms: "
      "processor time per\n"
      "frame on one thread. \"fit\" sweeps until no bead moves.\n\n",
      m.scene.beads, m.scene.width, m.scene.height, m.scene.frames);
  s += table(m.those(is_usual_picture));
  s += "\nOther noise levels\n" + table(m.those([](const imaging::LocateSetting& o) {
         return o.diameter_px == kUsual.diameter_px && o.snr != kUsual.snr;
       }));
  s += "\nOther numbers of pixels per bead\n" +
       table(m.those([](const imaging::LocateSetting& o) { return o.diameter_px != kUsual.diameter_px; }));
  s += fmt::format(
           "\nFront, {:g} px, SNR {:g}: of the methods that find every bead, no other is both faster and "
           "more accurate\n",
           kUsual.diameter_px, kUsual.snr) +
       table(imaging::front(m.all, kUsual.diameter_px, kUsual.snr));
  s += fmt::format("\nFastest method with an rms error of at most {:g} px, {:g} px per bead\n", m.accuracy,
                   kUsual.diameter_px);
  for (const double snr : m.noise()) {
    const auto best = imaging::cheapest(m.all, kUsual.diameter_px, snr, m.accuracy);
    s += best ? fmt::format("  SNR {:>5g}: {} ({:.4f} px), {:.1f} ms per frame\n", snr, way(best->setting),
                            best->rms, 1e3 * best->seconds)
              : fmt::format("  SNR {:>5g}: no measured method\n", snr);
  }
  s += fmt::format(
      "\nApparent s_b of a bed at rest due to the errors of positions, in percent of sigma/30, one cycle of "
      "{} phases\n"
      "  {:>4} {:>5}  {:<12} {:>12} {:>12}\n",
      kPhases, "px", "SNR", "method", "one tracer", fmt::format("{} tracers", kTracers));
  for (const imaging::LocatePrecision& p : m.all) {
    const imaging::LocateSetting& o = p.setting;
    if (!is_usual_way(o) || (o.sweeps != 0 && o.sweeps != kUsual.sweeps)) continue;
    s += fmt::format("  {:>4g} {:>5g}  {:<12} {:>12.2f} {:>12.2f}\n", o.diameter_px, o.snr, way(o),
                     3000 * imaging::bed_displacement_noise(p.relative(), 1, 1, kPhases),
                     3000 * imaging::bed_displacement_noise(p.relative(), kTracers, 1, kPhases));
  }
  return s;
}

/// Three panels: locating methods, noise, pixels per bead. A horizontal line in the colour of a curve is the
/// Cramér-Rao bound of the curve.
class Panels {
 public:
  explicit Panels(std::string name) : name_(std::move(name)) {}
  void next(const char* error) {
    clauses_.emplace_back();
    errors_.push_back({.label = error, .logarithmic = true});
  }
  void curve(const std::vector<imaging::LocatePrecision>& points, const std::string& title,
             const char* colour, int shape, bool relative, bool line = true) {
    if (points.empty()) return;
    data_ += fmt::format("# {}: ms per frame, rms, bound, sweeps\n", title);
    for (const imaging::LocatePrecision& p : points) {
      const double unit = relative ? p.setting.diameter_px : 1;
      time_.show(1e3 * p.seconds);
      errors_.back().show(p.rms / unit);
      errors_.back().show(p.bound / unit);
      data_ += fmt::format("{:.4g} {:.4e} {:.4e} {}\n", 1e3 * p.seconds, p.rms / unit, p.bound / unit,
                           p.setting.sweeps);
    }
    data_ += "\n\n";
    add(fmt::format("'{}.dat' index {} using 1:2 with {} pt {} ps 0.9 lw {} lc rgb '{}' title '{}'", name_,
                    index_, line ? "linespoints" : "points", shape, analysis::figure_style::kCurve, colour,
                    title));
    if (line)
      add(fmt::format("'{}.dat' index {} using 1:3 with lines lw 1 dt 2 lc rgb '{}' notitle", name_, index_,
                      colour));
    ++index_;
  }
  [[nodiscard]] const std::string& data() const { return data_; }
  /// Commands of a panel. \param clauses more clauses
  [[nodiscard]] std::string plot(std::size_t panel, const std::string& title, int beads,
                                 const std::string& more = {}) const {
    analysis::figure_style::PlotAxis time = time_;
    time.label = fmt::format("processor time, ms per frame of {} beads", beads);
    return analysis::figure_style::axes(time, errors_[panel]) +
           analysis::figure_style::panel_title("abc"[panel], title) +
           fmt::format("plot {}{}\n", clauses_[panel], more);
  }

 private:
  void add(const std::string& clause) { clauses_.back() += (clauses_.back().empty() ? "" : ", ") + clause; }
  std::string name_, data_;
  std::vector<std::string> clauses_;
  analysis::figure_style::PlotAxis time_{.label = {}, .logarithmic = true};
  std::vector<analysis::figure_style::PlotAxis> errors_;  ///< of each panel
  int index_ = 0;
};

analysis::Figure figure(const MeasuredLocating& m) {
  // Each colour also has its own point shape.
  constexpr auto kColours = analysis::colours::kCurves;
  constexpr std::array<int, 7> kShapes = {7, 9, 5, 11, 13, 6, 4};
  analysis::Figure f{
      .name = "locating", .title = "Accuracy against computing time", .width = 720, .height = 1080};
  Panels panels(f.name);
  panels.next("rms error per coordinate, px");
  panels.curve(
      m.those([](const imaging::LocateSetting& s) { return is_usual_picture(s) && is_usual_way(s); }),
      "vote, then 0, 1, 2 … sweeps", kColours[0], kShapes[0], false);
  panels.curve(
      m.those([](const imaging::LocateSetting& s) { return is_usual_picture(s) && s.finder == "hough"; }),
      "hough, alone and fitted", kColours[1], kShapes[1], false, false);
  panels.curve(
      m.those([](const imaging::LocateSetting& s) { return is_usual_picture(s) && s.method == "edges"; }),
      "vote, edges", kColours[3], kShapes[3], false, false);
  panels.curve(m.those([](const imaging::LocateSetting& s) {
    return is_usual_picture(s) && s.finder == kUsual.finder && s.ring_px != kUsual.ring_px;
  }),
               "rings of 1.5 to 5 px", kColours[2], kShapes[2], false, false);
  panels.next("rms error per coordinate, px");
  std::size_t k = 0;
  for (const double snr : m.noise()) {
    panels.curve(m.those([&](const imaging::LocateSetting& s) {
      return s.diameter_px == kUsual.diameter_px && s.snr == snr && is_usual_way(s);
    }),
                 fmt::format("SNR {:g}", snr), kColours[k % 7], kShapes[k % 7], false);
    ++k;
  }
  panels.next("rms error per coordinate, σ");
  k = 0;
  std::vector<double> diameters;
  for (const imaging::LocatePrecision& p : m.all)
    if (std::find(diameters.begin(), diameters.end(), p.setting.diameter_px) == diameters.end())
      diameters.push_back(p.setting.diameter_px);
  std::sort(diameters.begin(), diameters.end());
  for (const double d : diameters) {
    panels.curve(m.those([&](const imaging::LocateSetting& s) {
      return s.diameter_px == d && s.snr == kUsual.snr && is_usual_way(s);
    }),
                 fmt::format("{:g} px", d), kColours[k % 7], kShapes[k % 7], true);
    ++k;
  }
  f.data = panels.data();
  const int beads = m.scene.beads;
  f.plot = "set multiplot layout 3,1\nset key outside right top vertical\n" +
           panels.plot(0, "15 px, SNR 51; dashed: Cramér–Rao bound", beads) +
           panels.plot(1, "noise, 15 px", beads) +
           panels.plot(2, "pixels per bead, SNR 51", beads,
                       fmt::format(", 1./30 with lines {} title 'σ/30'", analysis::figure_style::kStated)) +
           "unset multiplot\n";
  return f;
}

}  // namespace

CostReport cost_of_locating(double accuracy_px, bool quick, const Common& common) {
  MeasuredLocating m;
  m.accuracy = accuracy_px;
  if (quick) m.scene = {.beads = 200, .width = 20, .height = 20, .frames = 1};
  ProgressBar bar(common, "errors and times");
  m.all = imaging::locate_precision(settings(quick), m.scene, quick ? 1 : 5, bar);
  return {as_json(m), as_text(m), figure(m)};
}

}  // namespace twincell::cli
