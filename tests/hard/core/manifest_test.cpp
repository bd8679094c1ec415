// Manifests: a changed file is always detected, even with its old size and time; an unchanged file is read
// once.

#include "core/manifest.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "core/sha256.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::manifest_test {
namespace {

namespace fs = std::filesystem;

/// Number of bytes that this process has read so far.
std::uint64_t bytes_read() {
  std::ifstream io("/proc/self/io");
  std::string word;
  std::uint64_t n = 0;
  while (io >> word >> n)
    if (word == "rchar:") return n;
  return 0;
}

TEST(Manifest, AFileThatHasNotChangedIsReadOnce) {
  // A file of the source tree, whose last modification is not recent.
  const fs::path folder = fs::path(TWINCELL_SOURCE_DIR) / "docs";
  const std::string name = "scene.md";
  const auto size = fs::file_size(folder / name);
  ASSERT_GT(size, 10'000U);
  const Manifest manifest{.product = "docs", .files = {{name, {sha256_of(folder / name)}}}};
  if (bytes_read() == 0) GTEST_SKIP() << "/proc/self/io cannot be read.";
  std::uint64_t before = bytes_read();
  EXPECT_TRUE(manifest.unchanged(folder, name));
  EXPECT_GE(bytes_read() - before, size);
  before = bytes_read();
  for (int k = 0; k < 10; ++k) EXPECT_TRUE(manifest.unchanged(folder, name));
  EXPECT_LT(bytes_read() - before, size);
}

TEST(Manifest, ChangedFileIsDetectedDespiteEqualSizeAndTime) {
  const TemporaryFolder folder;
  put_file(folder / "a", "old bytes");
  // A file whose modification time is set to the distant past.
  const timespec long_ago[2] = {{1'000'000'000, 0}, {1'000'000'000, 0}};
  ASSERT_EQ(::utimensat(AT_FDCWD, (folder / "a").c_str(), long_ago, 0), 0);
  const Manifest manifest = Manifest::of(folder.path(), "a folder");
  EXPECT_TRUE(manifest.unchanged(folder.path(), "a"));
  put_file(folder / "a", "new bytes");
  ASSERT_EQ(::utimensat(AT_FDCWD, (folder / "a").c_str(), long_ago, 0), 0);
  EXPECT_FALSE(manifest.unchanged(folder.path(), "a"));
}

}  // namespace
}  // namespace twincell::manifest_test
