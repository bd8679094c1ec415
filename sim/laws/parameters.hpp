#pragma once
/// \file
/// Parameter lookup for contact laws: the tables from which a law reads its keys, and the masses and radii on
/// which its constants may depend.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"

namespace twincell::sim {

/// Effective mass (m), effective radius (sigma) and inverse tangential mass (1/m) of a contact.
struct PairScale {
  double m_eff;    ///< m_i m_j/(m_i + m_j); the bead's mass at a wall
  double r_eff;    ///< R_i R_j/(R_i + R_j); the bead's radius at a wall
  double inv_m_t;  ///< 1/m_t = 1/m_i + 1/m_j + R_i^2/I_i + R_j^2/I_j; at a wall, the terms of the bead only
};

/// Scale of a contact of two equal beads.
/// \param radius sigma
/// \param mass m
/// \param inertia_factor I/(m R^2)
PairScale equal_beads(double radius, double mass, double inertia_factor);
/// Scale of a contact of a bead and a wall; parameters as equal_beads.
PairScale bead_and_wall(double radius, double mass, double inertia_factor);

/// Mutually exclusive keys of the normal damping: at most one per table. A key of an inner table overrides
/// any key of its group in an outer table, and a key of the scene overrides one of the preset.
const std::vector<std::string>& normal_damping_keys();
/// The same of the tangential damping.
const std::vector<std::string>& tangential_damping_keys();

/// The tables in which one kind of contact looks up its keys: first its own ([contact.lid], for example),
/// then [contact.wall], then [contact].
class ContactTable {
 public:
  ContactTable() = default;
  explicit ContactTable(std::vector<ConfigSection> innermost_first) : tables_(std::move(innermost_first)) {}

  /// Returns the number at `key`, in its reduced unit, checked against the bounds.
  /// \throws ConfigError naming file, line, key, value and bound
  [[nodiscard]] std::optional<double> number(const std::string& key,
                                             std::optional<double> lower = std::nullopt,
                                             std::optional<double> upper = std::nullopt,
                                             bool open_lower = false) const;
  /// Like number(), but the key is mandatory.
  /// \throws ConfigError also if the key is absent
  [[nodiscard]] double required(const std::string& key, std::optional<double> lower = std::nullopt,
                                std::optional<double> upper = std::nullopt, bool open_lower = false) const;
  /// Returns the word at `key`.
  /// \throws ConfigError if it is none of `words`
  [[nodiscard]] std::optional<std::string> word(const std::string& key,
                                                const std::vector<std::string>& words) const;
  /// Returns the key that is set, of a group of mutually exclusive keys, in the innermost table that sets any
  /// of them; empty if no table does.
  /// \throws ConfigError if one table sets two
  [[nodiscard]] std::string which_of(const std::vector<std::string>& keys) const;
  /// Position of a key in its file; if it is absent, the position where it could be set.
  [[nodiscard]] Where where(const std::string& key) const;

 private:
  std::vector<ConfigSection> tables_;
};

/// Reads the friction coefficient `mu`, default 0.6.
double read_friction(const ContactTable& table);
/// Reads the stiffness of a tangential spring `k_t`, m g/sigma, default 1e4.
double read_tangential_stiffness(const ContactTable& table);

}  // namespace twincell::sim
