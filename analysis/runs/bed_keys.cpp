#include "analysis/runs/bed_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/config.hpp"
#include "core/toml_leaves.hpp"

namespace twincell::analysis {

namespace {

bool is_of_the_bed(std::string_view key) {
  constexpr std::array<std::string_view, 3> kTables = {"contact.", "beads.", "cell."};
  constexpr std::array<std::string_view, 5> kElsewhere = {"beads.count", "beads.layers", "cell.width",
                                                          "cell.depth", "cell.height"};
  return std::ranges::any_of(kTables, [&](std::string_view table) { return key.starts_with(table); }) &&
         std::ranges::none_of(kElsewhere, [&](std::string_view other) {
           return key == other || (key.starts_with(other) && key[other.size()] == '_');
         });
}

/// The keys of the scene of a provenance for which `wanted` is true.
template <class Wanted>
std::map<std::string, std::string> keys_of(const std::string& provenance_json, Wanted wanted) {
  const auto provenance = nlohmann::json::parse(provenance_json, nullptr, false);
  if (!provenance.is_object()) return {};
  const auto config = provenance.find("config");
  if (config == provenance.end() || !config->is_string()) return {};
  const auto text = config->get<std::string>();
  try {
    (void)Config::from_text(text, "provenance");
  } catch (const Error&) {  // of another program
    return {};
  }
  std::map<std::string, std::string> all;
  for (TomlLeaf& leaf : toml_leaves(text, ""))
    if (wanted(leaf.path)) all[leaf.path] = std::move(leaf.literal);
  for (auto& [name, value] : all) {  // 0.6 instead of 0.59999999999999998
    double number = 0;
    const char* end = value.data() + value.size();
    if (const auto read = std::from_chars(value.data(), end, number);
        read.ec == std::errc() && read.ptr == end)
      value = fmt::format("{}", number);
  }
  return all;
}

}  // namespace

std::map<std::string, std::string> bed_keys(const std::string& provenance_json) {
  return keys_of(provenance_json, is_of_the_bed);
}

std::map<std::string, std::string> motion_keys(const std::string& provenance_json) {
  constexpr std::array<std::string_view, 2> kOfTheRun = {"time.", "until."};
  auto all = keys_of(provenance_json, [&](std::string_view key) {
    return std::ranges::none_of(kOfTheRun, [&](std::string_view table) { return key.starts_with(table); });
  });
  return all.contains("start.from") ? std::map<std::string, std::string>() : all;
}

}  // namespace twincell::analysis
