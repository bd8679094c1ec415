#include "core/temporary_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <random>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/output_rules.hpp"
#include "core/sha256.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

/// Paths that a signal handler may read: in fixed storage, without allocation. Paths that do not fit are
/// removed only by destructors.
struct Slot {
  std::atomic<bool> taken{false}, filled{false};
  std::array<char, 4096> path{};
};
std::array<Slot, 64> slots;
/// Locked during a search of the slots: the search for one path reads other slots, which another thread may
/// free at the same time. A signal handler takes no lock; it reads filled slots only.
std::mutex slots_mutex;

void remember(const fs::path& path) {
  const std::string text = path.string();
  const std::lock_guard guard(slots_mutex);
  for (Slot& slot : slots) {
    if (text.size() >= slot.path.size() || slot.taken.exchange(true)) continue;
    std::memcpy(slot.path.data(), text.c_str(), text.size() + 1);
    slot.filled.store(true);
    return;
  }
}

void forget(const fs::path& path) {
  const std::lock_guard guard(slots_mutex);
  for (Slot& slot : slots)
    if (slot.filled.load() && path.string() == slot.path.data()) {
      slot.filled.store(false);
      slot.taken.store(false);
      return;
    }
}

/// Common prefix of the temporaries of one output: a hash, which also fits if the name has 255 bytes.
std::string stem_of(const fs::path& final) {
  Sha256 sum;
  const std::string name = final.filename().string();
  sum.add(name.data(), name.size());
  return kTemporaryPrefix + sum.hex().substr(0, 16);
}

/// Whether the path is inside an unfinished folder. Such a folder belongs to one process and needs no locks.
bool in_own_folder(const fs::path& path) {
  for (const fs::path& part : path.parent_path())
    if (part.string().starts_with(kTemporaryPrefix)) return true;
  return false;
}

struct Held {
  int file = -1;
  int times = 0;
  fs::path name;
};
struct Locks {
  std::mutex mutex;
  std::map<fs::path, Held> held;  ///< by output
  ~Locks() {
    for (auto& [final, lock] : held) {
      ::unlink(lock.name.c_str());
      ::close(lock.file);
    }
  }
};
Locks& locks() {
  static Locks all;
  return all;
}

/// Opens and locks a file of this name; -1 if the file system has no locks or the file cannot be created.
/// \throws ConfigError if another process holds the lock
int locked(const fs::path& name, const fs::path& final) {
  for (;;) {
    const int file = ::open(name.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0) return -1;
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
      const bool taken = errno == EWOULDBLOCK;
      ::close(file);
      if (!taken) return -1;
      throw ConfigError({final.string(), 0, 0, ""}, "another process is writing this output.");
    }
    // The previous owner may have removed the name between the two calls above; this lock is then useless.
    struct stat by_name = {}, by_file = {};
    if (::stat(name.c_str(), &by_name) == 0 && ::fstat(file, &by_file) == 0 &&
        by_name.st_ino == by_file.st_ino && by_name.st_dev == by_file.st_dev)
      return file;
    ::close(file);
  }
}

/// Removes temporaries that killed runs left behind. \pre this process holds the lock of the output
void remove_leftovers(const fs::path& final) {
  const std::string stem = stem_of(final) + "-";
  std::error_code ec;
  std::vector<fs::path> found;
  for (fs::directory_iterator at(final.parent_path(), ec), end; !ec && at != end; at.increment(ec)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(stem) && name.find(".part", stem.size()) == stem.size() + 12)
      found.push_back(at->path());
  }
  for (const fs::path& path : found) fs::remove_all(path, ec);
}

}  // namespace

OutputLock::OutputLock(fs::path final) : final_(std::move(final)) {
  if (in_own_folder(final_)) return;
  const std::lock_guard guard(locks().mutex);
  Held& held = locks().held[final_];
  if (held.times == 0) {
    held.name = final_.parent_path() / (stem_of(final_) + ".lock");
    try {
      held.file = locked(held.name, final_);
    } catch (...) {
      locks().held.erase(final_);
      throw;
    }
    if (held.file >= 0) {
      remember(held.name);
      remove_leftovers(final_);
    }
  }
  ++held.times;
}

OutputLock::OutputLock(OutputLock&& other) noexcept : final_(std::exchange(other.final_, {})) {}

OutputLock::~OutputLock() {
  if (final_.empty()) return;
  const std::lock_guard guard(locks().mutex);
  const auto found = locks().held.find(final_);
  if (found == locks().held.end() || --found->second.times > 0) return;
  if (found->second.file >= 0) {
    // Unlinked while locked, so that no other process locks a name that is being removed.
    ::unlink(found->second.name.c_str());
    forget(found->second.name);
    ::close(found->second.file);
  }
  locks().held.erase(found);
}

void hold_until_exit(const fs::path& final) {
  locks();  // constructed before `held`, so that it outlives `held`
  static std::vector<OutputLock> held;
  held.emplace_back(final);
}

fs::path make_temporary(const fs::path& final, bool folder) {
  static constexpr const char* kLetters = "0123456789abcdefghijklmnopqrstuv";
  std::random_device chance;
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::string name = stem_of(final) + "-";
    for (int k = 0; k < 12; ++k) name += kLetters[chance() % 32];
    name += ".part";
    if (!folder && final.extension().string().size() < 16) name += final.extension().string();
    const fs::path path = final.parent_path() / name;
    if (folder) {
      if (::mkdir(path.c_str(), 0777) == 0) {
        if (!in_own_folder(path)) remember(path);
        return path;
      }
    } else if (const int file =
                   ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
               file >= 0) {
      ::close(file);
      if (!in_own_folder(path)) remember(path);
      return path;
    }
    if (errno != EEXIST)
      throw ConfigError({final.string(), 0, 0, ""},
                        fmt::format("no file can be created in its folder ({}).", std::strerror(errno)));
  }
  throw RunError(final.string() + ": no free temporary name was found in its folder.");
}

void care_for_temporary(const fs::path& path) {
  remember(path);
}

fs::path folder_for_temporaries() {
  std::error_code missing;
  fs::path folder = fs::temp_directory_path(missing);
  if (missing)
    throw RunError(
        fmt::format("The folder for temporary files (TMPDIR) cannot be used: {}.", missing.message()));
  return folder;
}

void forget_temporary(const fs::path& path) {
  forget(path);
}

void remove_temporaries() noexcept {
  for (Slot& slot : slots) {
    if (!slot.filled.load()) continue;
    if (::unlink(slot.path.data()) == 0) continue;
    // The path is a folder. It is renamed first, so that running threads cannot write into it any more.
    // Walking a folder is not async-signal-safe, but starting a program is.
    static std::array<char, 4096 + 8> aside;
    const std::size_t length = ::strlen(slot.path.data());
    std::memcpy(aside.data(), slot.path.data(), length);
    std::memcpy(aside.data() + length, ".old", 5);
    const bool moved = ::rename(slot.path.data(), aside.data()) == 0;
    const pid_t child = ::vfork();
    if (child == 0) {
      const char* words[] = {"rm", "-rf", "--", moved ? aside.data() : slot.path.data(), nullptr};
      ::execv("/bin/rm", const_cast<char* const*>(words));
      ::_exit(127);
    }
    if (child > 0) ::waitpid(child, nullptr, 0);
  }
}

}  // namespace twincell
