#pragma once
/// \file
/// TOML configuration with positions: every complaint names file, line, column and key, and no key is
/// ignored.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"

namespace twincell {

/// Largest configuration, bytes.
inline constexpr std::uintmax_t kLargestConfig = std::uintmax_t{16} << 20;

/// One table of a configuration. Getters return nothing for an absent key and throw ConfigError for one of
/// the wrong type. Asking for a key marks it as known.
class ConfigSection {
 public:
  [[nodiscard]] std::optional<double> number(const std::string& key) const;
  [[nodiscard]] std::optional<std::int64_t> integer(const std::string& key) const;
  [[nodiscard]] std::optional<bool> boolean(const std::string& key) const;
  [[nodiscard]] std::optional<std::string> text(const std::string& key) const;
  /// A number or whole number within bounds. \throws ConfigError as require_range
  [[nodiscard]] std::optional<double> number_in(const std::string& key, std::optional<double> lower,
                                                std::optional<double> upper = std::nullopt,
                                                bool open_lower = false) const;
  [[nodiscard]] std::optional<std::int64_t> integer_in(const std::string& key, std::int64_t lower,
                                                       std::int64_t upper) const;
  /// A list of exactly `count` finite numbers.
  [[nodiscard]] std::optional<std::vector<double>> numbers(const std::string& key, std::size_t count) const;
  /// A list, not empty, of pairs [a, b] of finite numbers.
  [[nodiscard]] std::optional<std::vector<std::pair<double, double>>> pairs(const std::string& key) const;
  /// Whether the key is there and holds a list: for keys that take one number or several.
  [[nodiscard]] bool is_list(const std::string& key) const;
  /// One of `words`; \throws ConfigError naming them otherwise.
  [[nodiscard]] std::optional<std::string> word(const std::string& key,
                                                const std::vector<std::string>& words) const;
  /// A table below this one; an absent table is an empty section.
  [[nodiscard]] ConfigSection section(const std::string& key) const;
  /// Whether the key is there.
  [[nodiscard]] bool has(const std::string& key) const;
  /// Where a key stands, or where its table stands if it is absent; of the empty key: the table itself.
  [[nodiscard]] Where where(const std::string& key) const;

 private:
  friend class Config;
  struct Shared;
  ConfigSection(std::shared_ptr<Shared> shared, std::string path)
      : shared_(std::move(shared)), path_(std::move(path)) {}
  [[nodiscard]] std::string full(const std::string& key) const {
    return path_.empty() || key.empty() ? path_ + key : path_ + "." + key;
  }

  std::shared_ptr<Shared> shared_;
  std::string path_;
};

/// A whole configuration.
class Config {
 public:
  /// \throws InputError if the file cannot be read, is no regular file or is larger than kLargestConfig;
  /// ConfigError "file:line:column: …" if it is not TOML, or its tables lie more than 100 deep in each other
  static Config from_file(const std::filesystem::path& path);
  static Config from_text(const std::string& text, const std::string& name);

  /// Lays `upper` over this one: its keys win, tables are merged.
  void overlay(Config&& upper);
  /// Removes the other members of a group of mutually exclusive keys of `section` when `upper` names one of
  /// them, so that a user's choice displaces a preset's.
  void yield_to(const Config& upper, const std::string& section,
                const std::vector<std::string>& alternatives);
  /// Moves what `lower` has at the path `from` to the path `to` of this one, tables between made as needed;
  /// it keeps its own file and line for complaints. \pre `from` is there, `to` is not
  void adopt(Config& lower, const std::string& from, const std::string& to);
  /// Puts `value` at the path `to` and removes the key at `from`; complaints about `to` go on to name `from`
  /// and where it stood. \pre `from` is there, `to` is not
  void restate(const std::string& from, const std::string& to, double value);
  /// Removes the key or table at `path`, if it is there.
  void erase(const std::string& path);
  /// "section.key=value" from the command line; a value that is not TOML is taken as text.
  void assign(const std::string& assignment);
  [[nodiscard]] ConfigSection root() const;
  /// \throws ConfigError for the first key that nobody asked for, with the nearest known one
  void refuse_unknown_keys() const;
  /// The resolved configuration as TOML.
  [[nodiscard]] std::string text() const;

 private:
  explicit Config(std::shared_ptr<ConfigSection::Shared> shared) : shared_(std::move(shared)) {}
  std::shared_ptr<ConfigSection::Shared> shared_;
};

/// Levenshtein distance, for "did you mean".
std::size_t edit_distance(const std::string& a, const std::string& b);

}  // namespace twincell
