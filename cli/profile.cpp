#include "cli/profile.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

namespace twincell::cli {

namespace {

double total_of(const std::vector<StageTimes::Row>& rows) {
  double total = 0;
  for (const StageTimes::Row& row : rows) total += row.seconds;
  return total;
}

std::string line(const StageTimes::Row& row, double total) {
  std::string text =
      fmt::format("{:<26} {:>10.3f} s {:>6.1f} %", row.name, row.seconds, 100 * row.seconds / total);
  if (row.count > 0) text += fmt::format("  {:>10.3g} {}/s", row.per_second(), row.unit);
  return text + "\n";
}

}  // namespace

void Profile::state(const std::string& name, std::int64_t value) {
  counters_[name] = value;
}

void Profile::add_to(nlohmann::json& document, std::string& text) const {
  if (!wanted_) return;
  const double processor = processor_seconds() - processor_;
  const std::vector<StageTimes::Row> rows = times_.rows();
  const double total = std::max(total_of(rows), 1e-9);

  nlohmann::json stages = nlohmann::json::array();
  text += fmt::format("{:<26} {:>12} {:>8}  {:>10}\n", "stage", "time", "share", "rate");
  for (const StageTimes::Row& row : rows) {
    stages.push_back({{"stage", row.name}, {"seconds", row.seconds}, {"share", row.seconds / total}});
    if (row.count > 0)
      stages.back().update({{"count", row.count}, {"unit", row.unit}, {"per_second", row.per_second()}});
    text += line(row, total);
  }
  text +=
      fmt::format("{:<26} {:>10.3f} s          {:.2f} processors busy\n", "total", total, processor / total);
  for (const auto& [name, value] : counters_.items())
    text += fmt::format("{:<26} {:>12}\n", name, value.get<std::int64_t>());
  document["profile"] = {{"seconds", total}, {"processor_seconds", processor}, {"stages", stages}};
  if (!counters_.empty()) document["profile"]["counters"] = counters_;
}

void add_profile_option(CLI::App& verb, bool& profile) {
  verb.add_flag("--profile", profile,
                "Print at the end where the time went: stages with their elapsed time, share and rate");
}

}  // namespace twincell::cli
