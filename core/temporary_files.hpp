#pragma once
/// \file
/// Temporary files and folders beside an output, and the lock that keeps two runs from one output. Both are
/// removed at every end of the process that it can see: return, exception, signal; after SIGKILL the next run
/// with the same output removes them.

#include <filesystem>
#include <string>

namespace twincell {

/// The exclusive right to write an output, held until it is destroyed or the process ends, however it ends.
class OutputLock {
 public:
  /// \param final absolute path of the output; a process may hold the lock of one output several times
  /// \throws ConfigError if another process holds it
  explicit OutputLock(std::filesystem::path final);
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;
  ~OutputLock();

 private:
  std::filesystem::path final_;
};

/// Holds the lock of an output until the process ends.
void hold_until_exit(const std::filesystem::path& final);

/// Makes an empty file or folder beside `final` under a name that nobody has, and removes what killed runs
/// left of the same output. The file's name keeps the extension of `final`. \throws ConfigError
std::filesystem::path make_temporary(const std::filesystem::path& final, bool folder);

/// Takes a file or folder that somebody else made into the same care.
void care_for_temporary(const std::filesystem::path& path);

/// The folder for what needs no name: TMPDIR, or /tmp. \throws RunError saying so if it cannot be used
std::filesystem::path folder_for_temporaries();

/// Ends the care for a temporary that was made: it has been renamed, or removed.
void forget_temporary(const std::filesystem::path& path);

/// Removes all temporaries and locks of the process. Async-signal-safe.
void remove_temporaries() noexcept;

}  // namespace twincell
