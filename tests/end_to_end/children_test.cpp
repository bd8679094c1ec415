// Child processes inherit no open file of the program.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"

namespace twincell::children_test {
namespace {

namespace fs = std::filesystem;

/// A substitute for a program, first in PATH, that records the files it has open.
class Stub {
 public:
  explicit Stub(const std::string& name) : before_(std::getenv("PATH")) {
    put_file(folder_ / name, "#!/bin/bash\nfor f in /proc/$$/fd/*; do readlink \"$f\"; done >> '" +
                                 std::string(folder_ / "open") + "'\nexit 0\n");
    ::chmod((folder_ / name).c_str(), 0755);
    ::setenv("PATH", (folder_.path().string() + ":" + before_).c_str(), 1);
  }
  Stub(const Stub&) = delete;
  Stub& operator=(const Stub&) = delete;
  ~Stub() { ::setenv("PATH", before_.c_str(), 1); }
  [[nodiscard]] std::string open_files() const {
    std::ifstream file(folder_ / "open");
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  TemporaryFolder folder_;
  std::string before_;
};

TEST(Children, GnuplotInheritsNoFile) {
  const TemporaryFolder folder;
  put_file(folder / "s.toml",
           "preset = \"fortini-huang-2015\"\n[beads]\nlayers = 3\n[cell]\nwidth = 8\n[drive]\ngamma = 1.5\n"
           "[time]\ncycles = 2\ndiscard = 0\n");
  ASSERT_EQ(run_program({"simulate", folder / "s.toml", "-o", folder / "secret.h5", "-q"}).code, 0);
  const Stub gnuplot("gnuplot");
  const Ran ran = run_program({"analyze", folder / "secret.h5", "--figures", folder / "figures", "-q"});
  // The stub draws nothing, as gnuplot on a full disk, which ends without an error too.
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.err.find("gnuplot did not finish the picture"), std::string::npos) << ran.err;
  const std::string open = gnuplot.open_files();
  EXPECT_NE(open.find("/dev/null"), std::string::npos) << "gnuplot was not started";
  EXPECT_EQ(open.find("secret.h5"), std::string::npos) << open;
}

}  // namespace
}  // namespace twincell::children_test
