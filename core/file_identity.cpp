#include "core/file_identity.hpp"

#include <sys/stat.h>

namespace twincell {

std::optional<FileIdentity> FileIdentity::of(const std::filesystem::path& path) {
  struct stat s {};
  if (::stat(path.c_str(), &s) != 0) return std::nullopt;
  const auto ns = [](const timespec& t) {
    return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
  };
  return FileIdentity{.device = s.st_dev,
                      .inode = s.st_ino,
                      .bytes = static_cast<std::uint64_t>(s.st_size),
                      .modified_ns = ns(s.st_mtim),
                      .changed_ns = ns(s.st_ctim)};
}

}  // namespace twincell
