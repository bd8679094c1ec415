#pragma once
/// \file
/// Temporary files and folders in the folder of an output, and the lock that prevents two runs from writing
/// the same output. Both are removed when the process ends by return, exception or signal. After SIGKILL, the
/// next run with the same output removes them.

#include <filesystem>
#include <string>

namespace twincell {

/// Exclusive lock of an output, released by the destructor or by any end of the process. Locking also removes
/// temporaries of the same output that killed runs left behind.
class OutputLock {
 public:
  /// \param final absolute path of the output; a process may lock the same output several times
  /// \throws ConfigError if another process holds the lock
  explicit OutputLock(std::filesystem::path final);
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;
  ~OutputLock();

 private:
  std::filesystem::path final_;
};

/// Locks an output until the process ends.
void hold_until_exit(const std::filesystem::path& final);

/// Creates an empty file or folder with a unique name in the folder of `final`. The name of a file has the
/// extension of `final`.
/// \throws ConfigError if it cannot be created, RunError if no free name is found
std::filesystem::path make_temporary(const std::filesystem::path& final, bool folder);

/// Registers a file or folder that was created elsewhere for removal by remove_temporaries.
void care_for_temporary(const std::filesystem::path& path);

/// Folder for temporary files that are not tied to the folder of an output: TMPDIR, or /tmp.
/// \throws RunError if it cannot be used
std::filesystem::path folder_for_temporaries();

/// Unregisters a temporary file or folder that has been renamed or removed.
void forget_temporary(const std::filesystem::path& path);

/// Removes all registered temporary files, folders and locks of the process. Async-signal-safe.
void remove_temporaries() noexcept;

}  // namespace twincell
