#include "sim/laws/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace twincell::sim {

PairScale equal_beads(double radius, double mass, double inertia_factor) {
  const double one = 1 / mass + 1 / (inertia_factor * mass);  // 1/m + R^2/I
  return {mass / 2, radius / 2, 2 * one};
}

PairScale bead_and_wall(double radius, double mass, double inertia_factor) {
  return {mass, radius, 1 / mass + 1 / (inertia_factor * mass)};
}

const std::vector<std::string>& normal_damping_keys() {
  static const std::vector<std::string> keys = {"gamma_n", "c_n", "restitution"};
  return keys;
}

const std::vector<std::string>& tangential_damping_keys() {
  static const std::vector<std::string> keys = {"gamma_t", "c_t", "c_t_over_c_n"};
  return keys;
}

std::optional<double> ContactTable::number(const std::string& key, std::optional<double> lower,
                                           std::optional<double> upper, bool open_lower) const {
  std::optional<double> found;
  for (const ConfigSection& t : tables_) {
    const auto value = t.number_in(key, lower, upper, open_lower);  // outer tables are checked too
    if (!found) found = value;
  }
  return found;
}

double ContactTable::required(const std::string& key, std::optional<double> lower,
                              std::optional<double> upper, bool open_lower) const {
  if (const auto value = number(key, lower, upper, open_lower)) return *value;
  throw ConfigError(where(key), "the chosen contact law needs this key.");
}

std::optional<std::string> ContactTable::word(const std::string& key,
                                              const std::vector<std::string>& words) const {
  std::optional<std::string> found;
  for (const ConfigSection& t : tables_) {
    const auto value = t.word(key, words);
    if (!found) found = value;
  }
  return found;
}

std::string ContactTable::which_of(const std::vector<std::string>& keys) const {
  std::string found;
  for (const ConfigSection& t : tables_) {
    std::vector<std::string> given;
    for (const auto& key : keys)
      if (t.has(key)) given.push_back(key);
    if (given.size() > 1)
      throw ConfigError(t.where(given[1]), fmt::format("contradicts '{}': only one of {} can be given.",
                                                       given[0], fmt::join(keys, ", ")));
    if (found.empty() && !given.empty()) found = given[0];
  }
  return found;
}

Where ContactTable::where(const std::string& key) const {
  for (const ConfigSection& t : tables_)
    if (t.has(key)) return t.where(key);
  return tables_.empty() ? Where{} : tables_.back().where(key);
}

double read_friction(const ContactTable& table) {
  return table.number("mu", 0, 1e12).value_or(0.6);
}

double read_tangential_stiffness(const ContactTable& table) {
  return table.number("k_t", 0, 1e12).value_or(1e4);
}

}  // namespace twincell::sim
