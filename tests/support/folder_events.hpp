#pragma once
/// \file
/// Changes of files as events of the kernel, for which a test waits without a clock.

#include <poll.h>
#include <sys/inotify.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace twincell {

/// Events of a folder and of everything below it, from the construction on.
class FolderEvents {
 public:
  static constexpr std::uint32_t kChanges = IN_CREATE | IN_MODIFY | IN_MOVED_TO | IN_DELETE;
  static constexpr std::uint32_t kChangesAndOpens = kChanges | IN_OPEN;

  explicit FolderEvents(std::filesystem::path folder, std::uint32_t kinds = kChanges)
      : folder_(std::move(folder)), kinds_(kinds), events_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)) {
    watch_all();
  }
  ~FolderEvents() { ::close(events_); }
  FolderEvents(const FolderEvents&) = delete;
  FolderEvents& operator=(const FolderEvents&) = delete;

  /// Blocks until something happens in the folder.
  ///
  /// \return the number of events, or 0 if the child process ended before one
  std::size_t wait(pid_t child) {
    const int process = static_cast<int>(::syscall(SYS_pidfd_open, child, 0));
    std::array<pollfd, 2> either{pollfd{events_, POLLIN, 0}, pollfd{process, POLLIN, 0}};
    std::size_t happened = 0;
    do {
      ::poll(either.data(), either.size(), -1);
      if (either[0].revents != 0) happened = read_all();
      watch_all();  // folders that are new
    } while (happened == 0 && either[1].revents == 0);
    ::close(process);
    return happened;
  }

 private:
  std::size_t read_all() {
    alignas(inotify_event) std::array<char, 1 << 16> bytes;
    std::size_t count = 0;
    const ssize_t size = ::read(events_, bytes.data(), bytes.size());
    for (ssize_t at = 0; at < size;) {
      inotify_event event;
      std::memcpy(&event, bytes.data() + at, sizeof event);
      at += static_cast<ssize_t>(sizeof event + event.len);
      // watch_all() itself opens and closes the folders.
      const bool lists_a_folder = (event.mask & IN_ISDIR) != 0 && (event.mask & (IN_OPEN | IN_CLOSE)) != 0;
      count += lists_a_folder ? 0 : 1;
    }
    return count;
  }
  void watch_all() {
    ::inotify_add_watch(events_, folder_.c_str(), kinds_);
    std::error_code gone;  // a folder may be removed meanwhile
    for (std::filesystem::recursive_directory_iterator entry(folder_, gone), end; !gone && entry != end;
         entry.increment(gone))
      if (entry->is_directory(gone)) ::inotify_add_watch(events_, entry->path().c_str(), kinds_);
  }

  std::filesystem::path folder_;
  std::uint32_t kinds_;
  int events_;
};

}  // namespace twincell
