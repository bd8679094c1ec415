// Names that the system refuses: known before the work where that is possible; otherwise the finished output
// is kept under another name. Needs a mount namespace or the right to change the user.

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "core/atomic_file.hpp"
#include "core/output_rules.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::refused_names_test {
namespace {

namespace fs = std::filesystem;

/// What `work` returns in a child process; "unable" if `prepare` fails there.
std::string in_child(const std::function<bool()>& prepare, const std::function<std::string()>& work,
                     const fs::path& answer) {
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string said = prepare() ? work() : "unable";
    std::ofstream(answer) << said << std::flush;
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return read_text_file(answer);
}

const Product kTable = Product::table("x,y");

TEST(RefusedNames, AFileThatIsAMountPoint) {
  const TemporaryFolder folder;
  const fs::path target = folder / "t.csv", other = folder / "o.csv", early = folder / "e.csv";
  for (const fs::path& file : {target, other, early}) put_file(file, "x,y\n1,2\n");
  EXPECT_EQ(complaint_of([&] { (void)require_output(target, kTable); }), "");
  const auto bind = [&](const fs::path& to) {
    return ::mount(other.c_str(), to.c_str(), nullptr, MS_BIND, nullptr) == 0;
  };
  const auto isolated = [&] {
    return (::unshare(CLONE_NEWNS) == 0 || ::unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) &&
           ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
  };
  const std::string before =
      in_child([&] { return isolated() && bind(early); },
               [&] { return complaint_of([&] { (void)require_output(early, kTable); }); }, folder / "answer");
  if (before == "unable") GTEST_SKIP() << "no mount namespace can be made here";
  EXPECT_NE(before.find("the file is a mount point"), std::string::npos) << before;
  // It becomes one during the run: the output is not lost.
  const std::string during = in_child(
      isolated,
      [&] {
        return complaint_of([&] {
          AtomicPath out(target, kTable);
          put_file(out.part(), "x,y\n3,4\n");
          if (bind(target)) out.commit();
        });
      },
      folder / "answer");
  EXPECT_NE(during.find("the output cannot take this name"), std::string::npos) << during;
  EXPECT_NE(during.find("t.csv.twincell-1."), std::string::npos) << during;
  EXPECT_EQ(read_text_file(folder / "t.csv.twincell-1"), "x,y\n3,4\n");
}

TEST(RefusedNames, AFileOfAnotherUserInAStickyFolder) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root to make a file of another user";
  const TemporaryFolder folder;
  const fs::path shared = folder / "shared", target = shared / "t.csv";
  fs::create_directory(shared);
  put_file(target, "x,y\n1,2\n");
  ASSERT_EQ(::chmod(target.c_str(), 0666), 0);
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  constexpr uid_t kOther = 65534;
  const auto said = [&](mode_t mode) {
    EXPECT_EQ(::chmod(shared.c_str(), mode), 0);
    return in_child([&] { return ::setresuid(kOther, kOther, kOther) == 0; },
                    [&] { return complaint_of([&] { (void)require_output(target, kTable); }); },
                    folder / ("answer-" + std::to_string(mode)));
  };
  EXPECT_EQ(said(0777), "");
  const std::string refused = said(01777);
  EXPECT_NE(refused.find("the file belongs to another user, and in the folder"), std::string::npos)
      << refused;
}

}  // namespace
}  // namespace twincell::refused_names_test
