#include "core/hdf5_open.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <string>

#include "core/cancellation.hpp"
#include "core/error.hpp"
#include "core/file_identity.hpp"
#include "core/hdf5_trial.hpp"

namespace twincell::h5 {

namespace {

namespace fs = std::filesystem;

/// Exit codes of the child.
constexpr int kRead = 0, kNoMemory = 1;

Handle opened(const fs::path& file) {
  return Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
}

/// What became of the children of this process, by the file that they read: see complaint_of.
struct Tried {
  std::mutex mutex;
  std::map<FileIdentity, std::string> complaints;
};
Tried& tried() {
  static Tried all;
  return all;
}

/// Address space of this process, bytes; without allocation.
rlim_t address_space() {
  std::array<char, 64> text{};
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t n = file < 0 ? 0 : ::read(file, text.data(), text.size() - 1);
  if (file >= 0) ::close(file);
  const auto pages = n > 0 ? std::strtoull(text.data(), nullptr, 10) : 0;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

/// Lowers a soft limit. The hard one stays above it: at the hard limit of processor time, the signal is
/// SIGKILL, which may have other causes.
void limit(__rlimit_resource resource, rlim_t most) {
  rlimit now{};
  if (::getrlimit(resource, &now) != 0) return;
  now.rlim_cur = std::min(most, now.rlim_cur);
  ::setrlimit(resource, &now);
}

/// Ends the child if the library reports that it got no memory: the reader, without the limit, would get it.
herr_t end_without_memory(hid_t stack, void*) {
  const auto visit = [](unsigned, const H5E_error2_t* entry, void*) -> herr_t {
    if (entry->maj_num == H5E_RESOURCE && entry->min_num == H5E_NOSPACE) ::_exit(kNoMemory);
    return 0;
  };
  H5Ewalk2(stack, H5E_WALK_DOWNWARD, visit, nullptr);
  return 0;
}

/// The child: reads the file under limits, without signal handlers, input and output of its parent.
[[noreturn]] void be_the_child(const fs::path& file, std::uint64_t bytes) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (const int standard : {0, 1, 2}) ::dup2(nowhere, standard);
  constexpr std::uint64_t kBytesPerSecond = 50'000'000, kSeconds = 3, kWall = 300;
  constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, kSeconds + bytes / kBytesPerSecond);
  if (const rlim_t now = address_space(); now > 0) limit(RLIMIT_AS, now + kMemory + 4 * bytes);
  ::alarm(static_cast<unsigned>(kWall + bytes / kBytesPerSecond));  // for a file system that never answers
  H5Eset_auto2(H5E_DEFAULT, end_without_memory, nullptr);
  try {
    if (const Handle handle = opened(file); handle) try_to_read(handle.get());
  } catch (const std::bad_alloc&) {
    ::_exit(kNoMemory);
  } catch (const std::exception&) {  // left to the reader
  }
  ::_exit(kRead);
}

/// Forks while this thread holds the lock of the HDF5 library, which calls H5Piterate's visitor with it. The
/// child has no other threads, so a lock that one of them held would never be released. (The C library
/// itself keeps malloc usable in the child.)
pid_t fork_with_hdf5() {
  pid_t child = -1;
  const auto visit = [](hid_t, const char*, void* to) -> herr_t {
    *static_cast<pid_t*>(to) = ::fork();
    return 1;
  };
  H5Piterate(H5P_FILE_ACCESS, nullptr, visit, &child);
  return child;
}

/// Waits for the child; kills it if cancellation is requested.
/// \return its status, or 0 if it cannot be known
int status_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return 0;
    if (cancellation_requested() != 0 && !finishing_first()) ::kill(child, SIGKILL);
  }
  return status;
}

/// Why the file of a child with this status cannot be read; empty if it can, or if the status is not due to
/// the file.
std::string complaint_of(int status) {
  if (WIFEXITED(status))
    return WEXITSTATUS(status) == kRead
               ? ""
               : "the file is damaged, or its chunks are too large: the HDF5 library asks for more than a "
                 "gigabyte to read it.";
  switch (WTERMSIG(status)) {
    case SIGSEGV:
    case SIGBUS:
    case SIGABRT:
    case SIGFPE:
    case SIGILL:
      return "the file is damaged: the HDF5 library crashes on it.";
    case SIGXCPU:
      return "the file is damaged: the HDF5 library does not come to an end with it.";
    default:
      return "";
  }
}

/// See complaint_of.
std::string complaint_about(const fs::path& file) {
  const std::optional<FileIdentity> identity = FileIdentity::of(file);
  if (!identity) return {};
  {
    const std::lock_guard lock(tried().mutex);
    if (const auto known = tried().complaints.find(*identity); known != tried().complaints.end())
      return known->second;
  }
  const pid_t child = fork_with_hdf5();
  if (child == 0) be_the_child(file, identity->bytes);
  if (child < 0) return {};
  const std::string complaint = complaint_of(status_of(child));
  throw_if_cancelled();
  const std::lock_guard lock(tried().mutex);
  return tried().complaints[*identity] = complaint;
}

}  // namespace

Handle open_file(const fs::path& file) {
  quiet();
  std::error_code ec;
  if (!fs::is_regular_file(file, ec)) return {};
  if (const std::string complaint = complaint_about(file); !complaint.empty())
    throw InputError({file.string(), 0, 0, ""}, complaint);
  return opened(file);
}

}  // namespace twincell::h5
