#pragma once
/// \file
/// The list, kept in an output folder, of the files that this program wrote there. Only files that it lists
/// and that have not changed since are ever replaced or removed.

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace twincell {

struct Manifest {
  static constexpr const char* kName = "twincell-manifest.json";

  std::string product;                                 ///< what the folder is: "a report"
  std::map<std::string, std::set<std::string>> files;  ///< path below the folder -> SHA-256; two while a file
                                                       ///< is being replaced

  /// The manifest of a folder. Nothing if there is none, or if it is not one of ours: damaged, not a regular
  /// file, or naming anything outside the folder.
  static std::optional<Manifest> read(const std::filesystem::path& folder);
  /// Of all regular files below `folder` as they are now.
  static Manifest of(const std::filesystem::path& folder, const std::string& product);
  /// \throws RunError if it cannot be written
  void write(const std::filesystem::path& folder) const;

  /// Whether `name` is listed and the file below `folder` is still a regular file with a listed hash. A path
  /// that leads through a symbolic link is not.
  [[nodiscard]] bool unchanged(const std::filesystem::path& folder, const std::string& name) const;
};

}  // namespace twincell
