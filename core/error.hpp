#pragma once
/// \file
/// Errors a user can meet. Each is one sentence that names the file, line, key, value and bound, and carries
/// the exit code of the program. Faults of our own are asserts, not these.

#include <optional>
#include <stdexcept>
#include <string>

namespace twincell {

/// Exit codes of the program; one table for all verbs.
enum class ExitCode : int {
  done = 0,
  failed = 1,         ///< went wrong while running
  usage = 2,          ///< command line or configuration
  input = 3,          ///< a file that cannot be read or is malformed
  gate = 4,           ///< finished, but a quality gate failed
  partial = 5,        ///< stopped early, can be resumed
  interrupted = 130,  ///< SIGINT
  terminated = 143,   ///< SIGTERM
};

/// Where a complaint points to. Empty or zero parts are left out of the text.
struct Where {
  std::string file;
  long line = 0;
  long column = 0;
  std::string key;

  /// "scene.toml:12:3: drive.gamma", or as much of it as is known.
  [[nodiscard]] std::string text() const;
};

/// Base of all errors meant for a user's eyes.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
  [[nodiscard]] ExitCode exit_code() const { return code_; }

 private:
  ExitCode code_;
};

/// A configuration or command line that asks for something impossible: exit code 2.
class ConfigError : public Error {
 public:
  ConfigError(const Where& where, const std::string& complaint);
};

/// A file that is missing, truncated, malformed or not what it claims: exit code 3.
class InputError : public Error {
 public:
  InputError(const Where& where, const std::string& complaint);
};

/// A run that went wrong after it began (overlap bound, non-finite number, full disk): exit code 1.
class RunError : public Error {
 public:
  explicit RunError(const std::string& sentence) : Error(ExitCode::failed, sentence) {}
};

/// The user or the system asked the program to stop: exit code 130 or 143.
class Interrupted : public Error {
 public:
  explicit Interrupted(
      ExitCode code, const std::string& sentence = "Stopped by a signal; no unfinished file was left behind.")
      : Error(code, sentence) {}
};

/// Throws ConfigError unless lower <= value <= upper (either bound may be absent; `open_lower` excludes the
/// lower one). A value that is not finite never passes.
void require_range(const Where& where, double value, std::optional<double> lower, std::optional<double> upper,
                   bool open_lower = false);

}  // namespace twincell
