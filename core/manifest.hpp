#pragma once
/// \file
/// Manifest of an output folder: the list of the files that this program wrote there. Only listed files that
/// have not changed since are ever replaced or removed.

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace twincell {

/// Files of one output folder, with their hashes.
struct Manifest {
  static constexpr const char* kName = "twincell-manifest.json";

  std::string product;  ///< kind of the folder, with its article: "a report"
  /// Path in the folder -> SHA-256; two while a file is replaced.
  std::map<std::string, std::set<std::string>> files;

  /// Reads the manifest of a folder. Returns nullopt if there is none or if it is invalid: damaged, larger
  /// than 256 MiB, not written by this program, not a regular file, or naming a file outside the folder.
  static std::optional<Manifest> read(const std::filesystem::path& folder);
  /// Builds the manifest of all regular files below `folder` in their present state.
  static Manifest of(const std::filesystem::path& folder, const std::string& product);
  /// \throws RunError if it cannot be written
  void write(const std::filesystem::path& folder) const;

  /// Whether `name` is listed and the file below `folder` is still a regular file with a listed hash. False
  /// for a path through a symbolic link.
  [[nodiscard]] bool unchanged(const std::filesystem::path& folder, const std::string& name) const;
};

}  // namespace twincell
