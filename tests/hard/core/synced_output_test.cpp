// Outputs reach the disk before they get their names. fsync() of this program is replaced by one that records
// the path, and that fails on request as a full or broken disk does.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <vector>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::synced_output_test {

namespace {

struct Sync {
  std::string path;
  bool placed;  ///< whether the final output had appeared by then
};
std::vector<Sync>& syncs() {
  static std::vector<Sync> all;
  return all;
}
std::string& broken() {  ///< name of the file whose sync fails
  static std::string name;
  return name;
}
std::string& awaited() {  ///< a path of the final output
  static std::string path;
  return path;
}

}  // namespace

extern "C" int fsync(int file) {
  std::error_code ec;
  const auto path = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file), ec);
  syncs().push_back({path.string(), !awaited().empty() && std::filesystem::exists(awaited())});
  if (!broken().empty() && path.filename() == broken()) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, file));
}

namespace twincell {
namespace {

class SyncedOutput : public ::testing::Test {
 protected:
  void SetUp() override { broken().clear(), awaited().clear(), syncs().clear(); }
  void TearDown() override { broken().clear(), awaited().clear(); }

  void write_folder(const std::string& name, const std::string& text) const {
    AtomicPath output(folder_ / name, Product::whole_folder("a test's folder"));
    std::filesystem::create_directory(output.part() / "inner");
    put_file(output.part() / "a.txt", text);
    put_file(output.part() / "inner/b.txt", text);
    output.commit();
  }
  /// Whether something of this name was synced before the output appeared.
  static bool synced_before(const std::string& name) {
    return std::any_of(syncs().begin(), syncs().end(), [&](const Sync& s) {
      return std::filesystem::path(s.path).filename() == name && !s.placed;
    });
  }

  TemporaryFolder folder_;
};

TEST_F(SyncedOutput, AFileIsOnDiskBeforeItHasItsName) {
  awaited() = folder_ / "x.txt";
  write_text_file(folder_ / "x.txt", "text");
  ASSERT_FALSE(syncs().empty());
  EXPECT_FALSE(syncs().front().placed);
}

TEST_F(SyncedOutput, EveryFileOfAFolderIsOnDiskBeforeTheFolderHasItsName) {
  awaited() = folder_ / "out/a.txt";
  write_folder("out", "text");
  for (const char* name : {"a.txt", "inner", "b.txt"}) EXPECT_TRUE(synced_before(name)) << name;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/inner/b.txt"));
  EXPECT_FALSE(syncs().empty() || !syncs().back().placed) << "the name itself is synced last";
}

TEST_F(SyncedOutput, ReplacingFilesAreOnDiskBeforeTheyHaveTheirNames) {
  write_folder("out", "one");
  put_file(folder_ / "out/foreign.txt", "mine");  // so that the folders are not exchanged in one step
  syncs().clear();
  write_folder("out", "two");
  for (const char* name : {"a.txt", "inner", "b.txt"}) EXPECT_TRUE(synced_before(name)) << name;
  EXPECT_EQ(read_text_file(folder_ / "out/a.txt"), "two");
  EXPECT_EQ(read_text_file(folder_ / "out/foreign.txt"), "mine");
}

TEST_F(SyncedOutput, AFileThatTheDiskRefusesLeavesTheOldOutput) {
  write_folder("out", "one");
  for (const char* name : {"a.txt", "b.txt", "inner"}) {
    broken() = name;
    expect_refusal<RunError>([&] { write_folder("out", "two"); }, name, "could not be written to disk",
                             "Input/output error");
    EXPECT_EQ(read_text_file(folder_ / "out/a.txt"), "one");
    EXPECT_EQ(names_in(folder_.path()), std::vector<std::string>{"out"}) << "no temporary folder is left";
  }
}

}  // namespace
}  // namespace twincell

}  // namespace twincell::synced_output_test
