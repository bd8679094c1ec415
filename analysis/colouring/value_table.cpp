#include "analysis/colouring/value_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>
#include <utility>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/table.hpp"

namespace twincell::analysis {

namespace {

/// The name of the column of numbers.
std::string column_of_numbers(const Table& table) {
  std::vector<std::string> others;
  for (const std::string& name : table.names) {
    if (name == "value") return name;
    if (name != "frame" && name != "particle") others.push_back(name);
  }
  if (others.size() == 1) return others.front();
  throw ConfigError(Where{.file = table.file, .key = "value"},
                    others.empty()
                        ? "there is no column of numbers beside frame and particle."
                        : fmt::format("there is no column of this name, and several could be meant: {}.",
                                      fmt::join(others, ", ")));
}

/// The entry of a row as a whole number below `n`.
std::size_t index_of(const Table& table, const std::string& column, std::size_t row, std::size_t n) {
  const double x = table.column(column)[row];
  if (!(x >= 0 && x < static_cast<double>(n) && x == std::floor(x)))
    throw InputError({.file = table.file, .key = column},
                     fmt::format("row {}: {:g} is not a whole number from 0 to {}, the {}s of the trajectory",
                                 row + 1, x, n - 1, column));
  return static_cast<std::size_t>(x);
}

}  // namespace

ValueTable::ValueTable(const std::filesystem::path& file, std::size_t n_frames, std::size_t n_beads)
    : n_beads_(n_beads) {
  const Table table = read_table(file);
  name_ = column_of_numbers(table);
  const std::vector<double>& numbers = table.column(name_);
  std::set<std::pair<std::size_t, std::size_t>> given;
  for (std::size_t row = 0; row < table.n_rows(); ++row) {
    const std::size_t frame = index_of(table, "frame", row, n_frames),
                      bead = index_of(table, "particle", row, n_beads);
    if (!given.emplace(frame, bead).second)
      throw InputError(
          {.file = table.file, .key = "particle"},
          fmt::format("row {}: particle {} has a second number in frame {}", row + 1, bead, frame));
    values_.try_emplace(frame, n_beads, kNaN).first->second[bead] = numbers[row];
  }
}

std::vector<double> ValueTable::of(std::size_t frame) const {
  const auto found = values_.find(frame);
  return found == values_.end() ? std::vector<double>(n_beads_, kNaN) : found->second;
}

}  // namespace twincell::analysis
