#pragma once
/// \file
/// Runs the program as a user would and stores its output.

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace twincell {

struct Ran {
  int code = -1;  ///< exit code; 128 + signal if a signal ended it
  std::string out, err;
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
  Ran wait() {
    int status = 0;
    ::waitpid(child_, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text("out"), text("err")};
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
