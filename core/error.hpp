#pragma once
/// \file
/// Errors that the user sees. Each message is one sentence that names the file, line, key, value and bound,
/// and each error carries the exit code of the program. Programming errors are asserts instead.

#include <optional>
#include <stdexcept>
#include <string>

namespace twincell {

/// Exit codes of the program; one table for all verbs.
enum class ExitCode : int {
  done = 0,
  failed = 1,         ///< error during the run
  usage = 2,          ///< invalid command line or configuration
  input = 3,          ///< an input file is unreadable or malformed
  partial = 5,        ///< stopped early, can be resumed
  interrupted = 130,  ///< SIGINT
  terminated = 143,   ///< SIGTERM
};

/// Position that an error message refers to. Empty or zero members are omitted from the text.
struct Where {
  std::string file;
  long line = 0;
  long column = 0;
  std::string key;

  /// "scene.toml:12:3: drive.gamma", or the members that are known.
  [[nodiscard]] std::string text() const;
};

/// Base class of all errors that are shown to the user. A sentence that ends without a full stop gets one.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& sentence);
  [[nodiscard]] ExitCode exit_code() const { return code_; }

 private:
  ExitCode code_;
};

/// An invalid configuration or command line: exit code 2.
class ConfigError : public Error {
 public:
  ConfigError(const Where& where, const std::string& complaint);
};

/// A file that is missing, truncated, malformed or not of the stated format: exit code 3.
class InputError : public Error {
 public:
  InputError(const Where& where, const std::string& complaint);
};

/// A run that failed after it started (overlap bound, non-finite number, full disk): exit code 1.
class RunError : public Error {
 public:
  explicit RunError(const std::string& sentence) : Error(ExitCode::failed, sentence) {}
};

/// The user or the system stopped the program by a signal: exit code 130 or 143.
class Interrupted : public Error {
 public:
  explicit Interrupted(
      ExitCode code, const std::string& sentence = "Stopped by a signal; no unfinished file was left behind.")
      : Error(code, sentence) {}
};

/// A sentence without its full stop, to be continued or put in brackets.
std::string without_full_stop(std::string sentence);

/// Checks lower <= value <= upper. Either bound may be absent; `open_lower` excludes the lower one.
/// \throws ConfigError if the value is out of range or not finite
void require_range(const Where& where, double value, std::optional<double> lower, std::optional<double> upper,
                   bool open_lower = false);

}  // namespace twincell
