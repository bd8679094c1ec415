#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <optional>

namespace twincell {

/// What distinguishes a file from every other file and from its own earlier contents. Programs can set the
/// time of modification, but not that of the status change.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t modified_ns = 0;  ///< content, since 1970
  std::int64_t changed_ns = 0;   ///< content, name or permissions, since 1970

  auto operator<=>(const FileIdentity&) const = default;

  /// The identity of the file that a path leads to through links; nothing if there is none.
  static std::optional<FileIdentity> of(const std::filesystem::path& path);
};

}  // namespace twincell
