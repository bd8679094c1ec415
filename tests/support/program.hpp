#pragma once
/// \file
/// Runs the program as a user would and stores its output.

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/folder_events.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell {

struct Ran {
  int code = -1;  ///< exit code; 128 + signal if a signal ended it
  std::string out, err;
  double cpu_s = 0;  ///< processor time of all its threads
};

/// A running program.
class RunningProgram {
 public:
  /// \param words arguments of twincell
  explicit RunningProgram(const std::vector<std::string>& words) {
    const std::string out = folder_ / "out", err = folder_ / "err";
    std::vector<std::string> all{TWINCELL_PROGRAM};
    all.insert(all.end(), words.begin(), words.end());
    std::vector<char*> argv;
    for (auto& word : all) argv.push_back(word.data());
    argv.push_back(nullptr);
    child_ = ::fork();
    if (child_ == 0) {
      ::dup2(::open("/dev/null", O_RDONLY), 0);
      ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), 1);
      ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), 2);
      ::execv(TWINCELL_PROGRAM, argv.data());
      ::_exit(127);
    }
  }
  [[nodiscard]] pid_t id() const { return child_; }
  void signal(int number) const { ::kill(child_, number); }
  /// Blocks until `reached`, which is asked after each change below `folder`.
  ///
  /// \return false if the program ended first
  [[nodiscard]] bool wait_until(const std::filesystem::path& folder,
                                const std::function<bool()>& reached) const {
    FolderEvents changes(folder);
    while (!reached())
      if (changes.wait(child_) == 0) return reached();
    return true;
  }
  /// Blocks until the program has written on standard error, as it does at each percent of its work where
  /// TWINCELL_PROGRESS_S is 0.
  ///
  /// \return false if the program ended first
  [[nodiscard]] bool wait_for_a_line() const {
    return wait_until(folder_.path(), [&] { return !text("err").empty(); });
  }
  /// Processor time that the program has used, s.
  [[nodiscard]] double cpu_s() const {
    clockid_t clock{};
    timespec used{};
    if (::clock_getcpuclockid(child_, &clock) == 0) ::clock_gettime(clock, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  }
  Ran wait() {
    int status = 0;
    rusage used{};
    ::wait4(child_, &status, 0, &used);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text("out"), text("err"),
            seconds(used.ru_utime) + seconds(used.ru_stime)};
  }

 private:
  [[nodiscard]] std::string text(const std::string& name) const {
    std::ostringstream all;
    all << std::ifstream(folder_ / name).rdbuf();
    return all.str();
  }

  TemporaryFolder folder_;
  pid_t child_ = -1;
};

inline Ran run_program(const std::vector<std::string>& words) {
  return RunningProgram(words).wait();
}

/// Names of all entries of a folder, sorted, to check that no files were left behind.
inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace twincell
