#include "imaging/phase/trigger_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "core/constants.hpp"
#include "core/table_text.hpp"
#include "imaging/phase/phases_of_times.hpp"

namespace twincell::imaging {

namespace {

constexpr double kMaxCycles = 1e15;

/// Reads the list and returns the cycles elapsed at each frame; NaN for a frame without a time.
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
  const std::vector<std::string> names = field_texts(line);
  check_column_names(names, Where{.file = file.string(), .line = number, .key = {}});
  auto column = [&](const char* name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
  const auto n = static_cast<std::ptrdiff_t>(names.size());
  const std::ptrdiff_t frame = column("frame"), time = column("time_s"), cycle = column("cycles");
  if (time == n && cycle == n) refuse("", "a column time_s or cycles is needed.");
  if (time < n && cycle < n)
    refuse("time_s", "and cycles are the same quantity; remove one of the two columns.");
  if (cycle == n && !drive_hz)
    throw ConfigError(Where{.file = {}, .key = "--drive-hz"},
                      "the list of triggers is in seconds, so the frequency of the drive is needed.");
  // Lines: one frame each, in the order of the stack.
  std::vector<double> cycles;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  std::size_t timed = 0;
  while (next_line()) {
    const std::vector<std::string> cells = field_texts(line);
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
    const std::ptrdiff_t stated = cycle < n ? cycle : time;
    if (frame < n && cells[static_cast<std::size_t>(stated)].empty()) {  // out of lock
      cycles.push_back(kNaN);
      continue;
    }
    const double now = cycle < n ? value(cycle) : value(time) * *drive_hz;
    if (std::abs(now) > kMaxCycles) refuse(cycle < n ? "cycles" : "time_s", "the time exceeds 1e15 cycles.");
    if (now < last)
      refuse(cycle < n ? "cycles" : "time_s",
             "the time decreases; frames must be in the order in which they were taken.");
    cycles.push_back(last = now);
    first = std::min(first, now);
    ++timed;
  }
  if (cycles.empty()) refuse("", "the list of triggers contains no frame.");
  if (timed == 0)
    refuse(names[static_cast<std::size_t>(cycle < n ? cycle : time)],
           "is empty in all lines; no frame has a time.");
  if (timed > 1 && last == first)
    refuse(cycle < n ? "cycles" : "time_s",
           fmt::format("is {:g} in all {} frames; a list of triggers must give the time of each frame.",
                       cycle < n ? first : first / *drive_hz, timed));
  return cycles;
}

}  // namespace

PhaseTable read_triggers(const std::filesystem::path& file, std::optional<double> drive_hz,
                         int frames_per_cycle) {
  const std::vector<double> cycles = read_cycles(file, drive_hz);
  PhaseTable table{.method = PhaseMethod::triggers};
  if (!set_phases_of_times(table, cycles, frames_per_cycle))
    throw InputError(
        Where{.file = file.string(), .key = {}},
        "the number of frames per cycle cannot be found from the list; give it with --frames-per-cycle.");
  if (!table.out_of_lock.empty())
    table.warning += (table.warning.empty() ? "" : "; ") + out_of_lock_in_words(table);
  return table;
}

}  // namespace twincell::imaging
