#include "analysis/runs/windows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "analysis/motion/centre_of_mass.hpp"
#include "core/cancellation.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/plural.hpp"

namespace twincell::analysis {

namespace {

/// The frames of a trajectory from `begin` to before `end`.
class Part : public TrajectorySource {
 public:
  Part(const TrajectorySource& whole, std::size_t begin, std::size_t end)
      : whole_(whole), begin_(begin), end_(end) {}
  [[nodiscard]] const TrajectoryInfo& info() const override { return whole_.info(); }
  [[nodiscard]] std::size_t n_frames() const override { return end_ - begin_; }
  void read(std::size_t index, Frame& frame) const override { whole_.read(begin_ + index, frame); }
  [[nodiscard]] std::string name() const override { return whole_.name(); }

 private:
  const TrajectorySource& whole_;
  std::size_t begin_, end_;
};

/// A window's place in the trajectory.
struct Place {
  std::int64_t first_cycle;
  std::size_t begin, end;  ///< frames
  double time;             ///< of its first frame, t0
  double fraction;         ///< phase of its first frame
};

double fraction_of(const TrajectoryInfo& info, const Frame& frame) {
  return static_cast<double>(std::max(0, frame.phase)) / std::max(1, info.phases_per_cycle);
}

/// Number of the cycle in which a ramp that returns begins to do so, as `frame` counts its cycles.
std::optional<std::int64_t> turn_of(const TrajectoryInfo& info, const Frame& frame) {
  if (!info.drive || !info.drive->ramp || !info.drive->ramp->returns) return {};
  const DriveRamp& ramp = *info.drive->ramp;
  const double before = info.drive->cycles_at(frame.time) - fraction_of(info, frame);
  return frame.cycle + std::llround(ramp.first + ramp.cycles / 2 - before);
}

/// Windows from the first cycle after `discard` ones, and again from the turn of the drive, so that none
/// contains both directions. Those that end beyond the turn or the last frame go to `left_out`.
std::vector<Place> places_of(const TrajectorySource& trajectory, std::int64_t discard, std::int64_t cycles,
                             std::vector<CycleRange>& left_out) {
  std::vector<Place> places;
  Frame frame;
  std::int64_t first = -1, last = -1;
  std::optional<std::int64_t> turn;
  const auto leave_out_beyond = [&](std::int64_t end) {
    if (places.empty() || places.back().first_cycle + cycles <= end) return;
    left_out.push_back({places.back().first_cycle, end - 1});
    places.pop_back();
  };
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    throw_if_cancelled();
    trajectory.read(f, frame);
    if (frame.cycle < 0) continue;
    if (first < 0) {
      first = frame.cycle + discard;
      turn = turn_of(trajectory.info(), frame);
    }
    if (frame.cycle < first) continue;
    if (turn && frame.cycle >= *turn) {
      leave_out_beyond(*turn);
      first = std::max(first, *turn);
      turn.reset();
    }
    const std::int64_t start = first + (frame.cycle - first) / cycles * cycles;
    if (places.empty() || places.back().first_cycle != start)
      places.push_back({start, f, f, frame.time, fraction_of(trajectory.info(), frame)});
    places.back().end = f + 1;
    last = frame.cycle;
  }
  leave_out_beyond(last + 1);
  return places;
}

std::optional<double> rest_height_of(const TrajectorySource& trajectory) {
  Frame frame;
  trajectory.read(0, frame);
  std::string why_not;
  return resting_height(trajectory.info(), frame, why_not);
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.10g}", value) : "";
}

}  // namespace

std::vector<Window> analyze_windows(const TrajectorySource& trajectory, const AnalysisOptions& options,
                                    std::int64_t cycles, Progress& progress,
                                    std::vector<CycleRange>* left_out) {
  const Where where{.file = trajectory.name(), .key = "window_cycles"};
  if (cycles < 1) throw ConfigError(where, fmt::format("a window of {} cycles is empty; at least 1", cycles));
  if (options.cycles > 0)
    throw ConfigError({.file = {}, .key = "--cycles"}, "chooses cycles, but the windows cover all of them");
  if (trajectory.n_frames() == 0)
    throw InputError({.file = trajectory.name(), .key = {}}, "the trajectory contains no frame");
  if (!trajectory.info().columns.phase)
    throw ConfigError(where, "the frames of the trajectory have no cycle number");
  std::vector<CycleRange> no_window;
  const std::vector<Place> places = places_of(trajectory, options.discard_cycles, cycles, no_window);
  if (left_out != nullptr) *left_out = no_window;
  if (places.empty())
    throw ConfigError(where,
                      fmt::format("no window of {} fits into the trajectory", plural(cycles, "cycle")));
  AnalysisOptions one = options;
  one.discard_cycles = 0;
  one.cycles = cycles;
  if (!one.rest_height) {
    one.rest_height = rest_height_of(trajectory);
    one.rest_height_is = "of the first frame of the run, at rest";
  }
  std::vector<Window> windows;
  for (const Place& place : places) {
    Window window{.first_cycle = place.first_cycle, .cycles = cycles, .drive = {}, .results = {}};
    if (const std::optional<Drive>& drive = trajectory.info().drive) {
      const double begin = drive->cycles_at(place.time) - place.fraction;
      window.drive = {drive->at(begin), drive->at(begin + static_cast<double>(cycles))};
    }
    window.results = analyze(Part(trajectory, place.begin, place.end), one);
    windows.push_back(std::move(window));
    progress.update(static_cast<std::int64_t>(windows.size()), static_cast<std::int64_t>(places.size()));
  }
  return windows;
}

std::vector<std::string> names_of_numbers(const std::vector<Window>& windows) {
  std::vector<std::string> names;
  for (const Result& r : windows.front().results)
    if (std::all_of(windows.begin(), windows.end(),
                    [&](const Window& w) { return find_result(w.results, r.name).shape.empty(); }))
      names.push_back(r.name);
  return names;
}

std::string windows_csv(const std::vector<Window>& windows) {
  std::string text = "first_cycle,cycles,gamma_begin,gamma_end,omega_begin,omega_end";
  const std::vector<std::string> names = names_of_numbers(windows);
  const auto is_present = [&](const std::string& name) {
    return std::any_of(windows.begin(), windows.end(),
                       [&](const Window& w) { return find_result(w.results, name).present(); });
  };
  const auto is_word = [&](const std::string& name) {
    return std::any_of(windows.begin(), windows.end(),
                       [&](const Window& w) { return !find_result(w.results, name).text.empty(); });
  };
  for (const std::string& name : names) {
    fmt::format_to(std::back_inserter(text), ",{0}", name);
    if (is_present(name) && !is_word(name))
      fmt::format_to(std::back_inserter(text), ",{0}_low,{0}_high", name);
  }
  text += '\n';
  for (const Window& w : windows) {
    fmt::format_to(std::back_inserter(text), "{},{}", w.first_cycle, w.cycles);
    if (w.drive)
      fmt::format_to(std::back_inserter(text), ",{},{},{},{}", number((*w.drive)[0].gamma()),
                     number((*w.drive)[1].gamma()), number((*w.drive)[0].omega), number((*w.drive)[1].omega));
    else
      text += ",,,,";
    for (const std::string& name : names) {
      const Result& r = find_result(w.results, name);
      if (!is_present(name)) {
        text += ',';
        continue;
      }
      if (is_word(name)) {
        fmt::format_to(std::back_inserter(text), ",{}", csv_field(r.text));
        continue;
      }
      const bool known = r.present() && r.interval.has_value();
      fmt::format_to(std::back_inserter(text), ",{},{},{}", number(r.value()),
                     known ? number(r.interval->low) : "", known ? number(r.interval->high) : "");
    }
    text += '\n';
  }
  return text;
}

}  // namespace twincell::analysis
