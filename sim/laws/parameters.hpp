#pragma once
/// \file
/// Where laws find their parameters, and what those may depend on.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"

namespace twincell::sim {

/// The masses and radii that meet in a contact.
struct PairScale {
  double m_eff;    ///< m_i m_j/(m_i + m_j); the bead's mass at a wall
  double r_eff;    ///< R_i R_j/(R_i + R_j); the bead's radius at a wall
  double inv_m_t;  ///< 1/m_t = 1/m_i + 1/m_j + R_i^2/I_i + R_j^2/I_j; of the bead alone at a wall
};

/// Keys of which one says it all: the inner table's choice displaces the outer one's, a scene's the preset's.
const std::vector<std::string>& normal_damping_keys();
const std::vector<std::string>& tangential_damping_keys();

/// The tables in which one kind of contact looks for its keys: its own first ([contact.lid], say), then
/// [contact.wall], then [contact].
class ContactTable {
 public:
  ContactTable() = default;
  explicit ContactTable(std::vector<ConfigSection> innermost_first) : tables_(std::move(innermost_first)) {}

  /// The number under `key`, within bounds. \throws ConfigError naming file, line, key, value and bound
  [[nodiscard]] std::optional<double> number(const std::string& key,
                                             std::optional<double> lower = std::nullopt,
                                             std::optional<double> upper = std::nullopt,
                                             bool open_lower = false) const;
  /// As number(). \throws ConfigError also if the key is absent
  [[nodiscard]] double required(const std::string& key, std::optional<double> lower = std::nullopt,
                                std::optional<double> upper = std::nullopt, bool open_lower = false) const;
  [[nodiscard]] std::optional<std::string> word(const std::string& key,
                                                const std::vector<std::string>& words) const;
  /// The one of mutually exclusive keys that the innermost table with any of them names; empty if none does.
  /// \throws ConfigError if a table names two
  [[nodiscard]] std::string which_of(const std::vector<std::string>& keys) const;
  /// Where a key stands, or where it could.
  [[nodiscard]] Where where(const std::string& key) const;

 private:
  std::vector<ConfigSection> tables_;
};

}  // namespace twincell::sim
