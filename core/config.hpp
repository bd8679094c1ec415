#pragma once
/// \file
/// TOML configuration with source positions: every error message names file, line, column and key, and an
/// unknown key is an error.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"

namespace twincell {

/// Maximum size of a configuration, bytes.
inline constexpr std::uintmax_t kLargestConfig = std::uintmax_t{16} << 20;

/// One table of a configuration. Getters return nullopt for an absent key and throw ConfigError for a value
/// of the wrong type. Each query marks its key as known, even if the key is absent.
class ConfigSection {
 public:
  /// A number or an integer, finite.
  [[nodiscard]] std::optional<double> number(const std::string& key) const;
  /// A whole number.
  [[nodiscard]] std::optional<std::int64_t> integer(const std::string& key) const;
  /// true or false.
  [[nodiscard]] std::optional<bool> boolean(const std::string& key) const;
  /// A text.
  [[nodiscard]] std::optional<std::string> text(const std::string& key) const;
  /// A number or an integer within bounds; `open_lower` excludes the lower bound.
  /// \throws ConfigError as require_range
  [[nodiscard]] std::optional<double> number_in(const std::string& key, std::optional<double> lower,
                                                std::optional<double> upper = std::nullopt,
                                                bool open_lower = false) const;
  /// A whole number in [lower, upper].
  /// \throws ConfigError as require_range
  [[nodiscard]] std::optional<std::int64_t> integer_in(const std::string& key, std::int64_t lower,
                                                       std::int64_t upper) const;
  /// A list of exactly `count` finite numbers.
  [[nodiscard]] std::optional<std::vector<double>> numbers(const std::string& key, std::size_t count) const;
  /// A non-empty list of pairs [a, b] of finite numbers.
  [[nodiscard]] std::optional<std::vector<std::pair<double, double>>> pairs(const std::string& key) const;
  /// Whether the key is present and its value is a list, for keys that accept one number or several.
  [[nodiscard]] bool is_list(const std::string& key) const;
  /// A text that is one of `words`.
  /// \throws ConfigError listing them otherwise
  [[nodiscard]] std::optional<std::string> word(const std::string& key,
                                                const std::vector<std::string>& words) const;
  /// The subtable `key`; an absent table is an empty section.
  [[nodiscard]] ConfigSection section(const std::string& key) const;
  /// Whether the key is present.
  [[nodiscard]] bool has(const std::string& key) const;
  /// Source position of a key, or of its table if the key is absent. The empty key is the table itself.
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
  /// \throws InputError if the file cannot be read, is not a regular file, contains zero bytes or is larger
  /// than kLargestConfig; ConfigError "file:line:column: …" if it is not TOML, or if tables and lists are
  /// nested more than 100 levels deep
  static Config from_file(const std::filesystem::path& path);
  /// The configuration in a text.
  /// \param name of its origin, for messages
  /// \throws ConfigError as from_file
  static Config from_text(const std::string& text, const std::string& name);

  /// Merges `upper` into this configuration. Tables are merged; a key of `upper` replaces the same key here.
  void overlay(Config&& upper);
  /// If `upper` sets any of the mutually exclusive keys `alternatives` of `section`, removes all of them from
  /// this configuration, so that a user's choice replaces the preset's.
  void yield_to(const Config& upper, const std::string& section,
                const std::vector<std::string>& alternatives);
  /// Moves the value at path `from` of `lower` to path `to` of this configuration; intermediate tables are
  /// created as needed. Error messages about the value still name its original file and line.
  /// \pre `from` exists, `to` does not
  void adopt(Config& lower, const std::string& from, const std::string& to);
  /// Sets path `to` to `value` and removes the key at `from`. Error messages about `to` still name `from` and
  /// its source position.
  /// \pre `from` exists, `to` does not
  void restate(const std::string& from, const std::string& to, double value);
  /// Removes the key or table at `path`, if present.
  void erase(const std::string& path);
  /// Applies "section.key=value" from the command line. A value that is not valid TOML is read as text.
  void assign(const std::string& assignment);
  /// The top-level table.
  [[nodiscard]] ConfigSection root() const;
  /// \throws ConfigError for the first key that was never queried; the message suggests the most similar
  /// known key
  void refuse_unknown_keys() const;
  /// The resolved configuration as TOML.
  [[nodiscard]] std::string text() const;

 private:
  explicit Config(std::shared_ptr<ConfigSection::Shared> shared) : shared_(std::move(shared)) {}
  std::shared_ptr<ConfigSection::Shared> shared_;
};

}  // namespace twincell
