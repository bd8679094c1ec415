#include "imaging/phase/trigger_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <complex>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/median.hpp"
#include "core/table_text.hpp"

namespace twincell::imaging {

namespace {

constexpr double kMostCycles = 1e15;
constexpr int kMostPhases = 100000;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const auto begin = cell.find_first_not_of(" \t"), end = cell.find_last_not_of(" \t");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  if (line.ends_with(',')) cells.emplace_back();
  return cells;
}

/// Reads the list and returns the cycles elapsed at each frame.
std::vector<double> read_cycles(const std::filesystem::path& file, std::optional<double> drive_hz) {
  std::istringstream lines(read_table_text(file));
  std::string line;
  int number = 0;
  auto refuse = [&](const std::string& key, const std::string& complaint) {
    throw InputError(Where{.file = file.string(), .line = number, .column = 0, .key = key}, complaint);
  };
  auto next_line = [&] {
    while (std::getline(lines, line)) {
      ++number;
      if (line.find_first_not_of(" \t") != std::string::npos && line[0] != '#') return true;
    }
    return false;
  };
  if (!next_line()) refuse("", "the list of triggers is empty.");
  const std::vector<std::string> names = split(line);
  check_column_names(names, Where{.file = file.string(), .line = number, .key = {}});
  auto column = [&](const char* name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
  const auto n = static_cast<std::ptrdiff_t>(names.size());
  const std::ptrdiff_t frame = column("frame"), time = column("time_s"), cycle = column("cycles");
  if (time == n && cycle == n) refuse("", "a column time_s or cycles is needed.");
  if (time < n && cycle < n)
    refuse("time_s", "and cycles are the same quantity; remove one of the two columns.");
  if (cycle == n && !drive_hz)
    throw ConfigError(Where{.file = {}, .key = "drive-hz"},
                      "the list of triggers is in seconds, so the frequency of the drive is needed.");
  // Lines: one frame each, in the order of the stack.
  std::vector<double> cycles;
  while (next_line()) {
    const std::vector<std::string> cells = split(line);
    if (cells.size() != names.size())
      refuse("", fmt::format("{} fields; the header line has {}.", cells.size(), names.size()));
    auto value = [&](std::ptrdiff_t at) {
      double v = 0;
      const std::string& cell = cells[static_cast<std::size_t>(at)];
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v);
      if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(v))
        refuse(names[static_cast<std::size_t>(at)], fmt::format("'{}' is not a number.", cell));
      return v;
    };
    if (frame < n && value(frame) != static_cast<double>(cycles.size()))
      refuse("frame", fmt::format("{} where {} was expected; every frame of the stack needs its line.",
                                  cells[static_cast<std::size_t>(frame)], cycles.size()));
    const double now = cycle < n ? value(cycle) : value(time) * *drive_hz;
    if (std::abs(now) > kMostCycles) refuse(cycle < n ? "cycles" : "time_s", "the time exceeds 1e15 cycles.");
    if (!cycles.empty() && now < cycles.back())
      refuse(cycle < n ? "cycles" : "time_s",
             "the time decreases; frames must be in the order in which they were taken.");
    cycles.push_back(now);
  }
  if (cycles.empty()) refuse("", "the list of triggers contains no frame.");
  if (cycles.size() > 1 && cycles.back() == cycles.front())
    refuse(cycle < n ? "cycles" : "time_s",
           fmt::format("is {:g} in all {} frames; a list of triggers must give the time of each frame.",
                       cycle < n ? cycles.front() : cycles.front() / *drive_hz, cycles.size()));
  return cycles;
}

}  // namespace

PhaseTable read_triggers(const std::filesystem::path& file, std::optional<double> drive_hz,
                         int frames_per_cycle) {
  const std::vector<double> cycles = read_cycles(file, drive_hz);
  PhaseTable table;
  table.method = PhaseMethod::triggers;
  std::vector<double> steps;
  for (std::size_t f = 1; f < cycles.size(); ++f) steps.push_back(cycles[f] - cycles[f - 1]);
  const double step = steps.empty() ? 0 : upper_median(std::move(steps));
  if (frames_per_cycle <= 0) {
    if (!(step > 0) || 1 / step > kMostPhases)
      throw InputError(
          Where{.file = file.string(), .key = {}},
          "the number of frames per cycle cannot be found from the list; give it with --frames-per-cycle.");
    frames_per_cycle = std::max(1, static_cast<int>(std::lround(1 / step)));
  }
  table.frames_per_cycle = frames_per_cycle;
  const double n = frames_per_cycle;
  // A delay that all frames share is no jitter: their mean position between two phases, on the circle.
  std::complex<double> around;
  for (const double c : cycles) around += std::polar(1.0, 2 * std::numbers::pi * c * n);
  table.offset = std::arg(around) / (2 * std::numbers::pi);
  const auto ticks_at = [&](double c) { return std::round(c * n - table.offset); };
  const double first = ticks_at(cycles.front());
  table.first_phase = static_cast<int>(static_cast<std::int64_t>(first) -
                                       static_cast<std::int64_t>(std::floor(first / n)) * frames_per_cycle);
  double squares = 0, sum = 0;
  std::vector<std::int64_t> ticks;
  for (const double c : cycles) {
    const double tick = ticks_at(c), late = c * n - table.offset - tick;
    squares += late * late;
    sum += late;
    ticks.push_back(static_cast<std::int64_t>(tick - first));
  }
  set_phases(table, ticks);
  if (const double elapsed = cycles.back() - cycles.front(); elapsed > 0)
    table.period_frames = std::round(elapsed * n) / elapsed;
  // The mean on the circle is the arithmetic mean to second order only.
  const double mean = sum / static_cast<double>(cycles.size());
  table.offset += mean;
  table.jitter = std::sqrt(std::max(0.0, squares / static_cast<double>(cycles.size()) - mean * mean));
  return table;
}

}  // namespace twincell::imaging
