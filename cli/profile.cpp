#include "cli/profile.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/memory_bandwidth.hpp"

namespace twincell::cli {

namespace {

/// Three digits.
std::string three_digits(double value) {
  return fmt::format("{:.{}f}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0);
}

/// A number with three digits and the prefix of its unit: "147 M".
std::string with_prefix(double value) {
  constexpr std::array<std::pair<double, const char*>, 6> kPrefixes = {
      {{1e12, "T"}, {1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}}};
  for (const auto& [size, prefix] : kPrefixes)
    if (value >= 0.9995 * size) return three_digits(value / size) + " " + prefix;
  return three_digits(1e6 * value) + " u";
}

/// A share of the bound, percent: two digits, and no more after the point than two.
std::string percent(double share) {
  const double value = 100 * share;
  return fmt::format("{:.{}f} %", value, value < 0.995 ? 2 : value < 9.95 ? 1 : 0);
}

std::string line(const StageTimes::Row& row, double total, std::optional<double> bandwidth) {
  std::string text =
      fmt::format("{:<25} {:>8}s {:>6.1f} %", row.name, with_prefix(row.seconds), 100 * row.seconds / total);
  if (row.count > 0 || row.bytes > 0) {
    const std::string number = row.count > 0 ? with_prefix(row.per_second()) : "",
                      unit = row.count > 0 ? row.unit + "/s" : "";
    text += fmt::format(" {:>8}{}{}", number, number.ends_with(' ') || number.empty() ? "" : " ", unit);
  }
  if (row.bytes > 0) {
    constexpr std::size_t kRate = 70;  // columns up to the end of the rate
    text.resize(std::max(text.size(), kRate), ' ');
    text += fmt::format(" {:>8}B/s", with_prefix(row.bytes_per_second()));
    if (bandwidth) text += fmt::format(" {:>9}", percent(row.bytes_per_second() / *bandwidth));
  }
  return text + "\n";
}

nlohmann::json as_json(const StageTimes::Row& row, double total, std::optional<double> bandwidth) {
  nlohmann::json j = {{"stage", row.name}, {"seconds", row.seconds}, {"share", row.seconds / total}};
  if (row.count > 0) j.update({{"count", row.count}, {"unit", row.unit}, {"per_second", row.per_second()}});
  if (row.bytes > 0) {
    j.update({{"bytes", row.bytes}, {"bytes_per_second", row.bytes_per_second()}});
    if (bandwidth) j["share_of_bandwidth"] = row.bytes_per_second() / *bandwidth;
  }
  return j;
}

}  // namespace

void Profile::state(const std::string& name, std::int64_t value) {
  counters_[name] = value;
}

void Profile::add_to(nlohmann::json& document, std::string& text, int threads) const {
  if (!wanted_) return;
  const double processor = process_cpu_seconds() - processor_;
  std::vector<StageTimes::Row> rows = times_.rows();
  double elapsed = 0;
  for (const StageTimes::Row& row : rows) elapsed += row.seconds;
  if (!sum_.empty()) rows = sum_;
  double total = 0;
  for (const StageTimes::Row& row : rows) total += row.seconds;
  total = std::max(total, 1e-9);  // a coarse clock may not have advanced

  // The threads of a sum work side by side, so each has its part of the bandwidth.
  std::optional<double> bandwidth;
  if (std::any_of(rows.begin(), rows.end(), [](const StageTimes::Row& row) { return row.bytes > 0; }))
    bandwidth = memory_bandwidth(threads);
  if (bandwidth && !sum_.empty()) *bandwidth /= threads;

  text += fmt::format("{:<25} {:>9} {:>8} {:>8}{:18} {:>11} {:>9}\n", "stage", "time", "share", "rate", "",
                      "memory", "of bound");
  nlohmann::json stages = nlohmann::json::array();
  for (const StageTimes::Row& row : rows) {
    stages.push_back(as_json(row, total, bandwidth));
    text += line(row, total, bandwidth);
  }
  text += fmt::format("{:<25} {:>8}s          {:>8.2f} processors busy\n",
                      sum_.empty() ? "total" : fmt::format("total of {} threads", threads),
                      with_prefix(total), processor / std::max(elapsed, 1e-9));
  document["profile"] = {{"seconds", total},
                         {"elapsed_seconds", elapsed},
                         {"processor_seconds", processor},
                         {"threads", threads},
                         {"stages", stages}};
  if (bandwidth) {
    document["profile"]["memory_bytes_per_second"] = *bandwidth;
    text += fmt::format("bound: {}B/s, which {} from main memory\n", with_prefix(*bandwidth),
                        threads == 1   ? "one thread reads"
                        : sum_.empty() ? fmt::format("{} threads together read", threads)
                                       : fmt::format("each of {} threads reads", threads));
  }
  for (const auto& [name, value] : counters_.items())
    text += fmt::format("{:<25} {:>9}\n", name, value.get<std::int64_t>());
  if (!counters_.empty()) document["profile"]["counters"] = counters_;
}

void add_profile_option(CLI::App& verb, bool& profile) {
  verb.add_flag("--profile", profile,
                "Print at the end where the time went: stages with their elapsed time, share, rate and bound "
                "(docs/running.md)");
}

}  // namespace twincell::cli
