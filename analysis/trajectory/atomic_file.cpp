#include "analysis/trajectory/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "analysis/trajectory/error.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

/// Waits until a file, or the names in a folder, are on the disk; false if the disk refused. What cannot be
/// waited for (some network file systems) counts as done.
bool sync_to_disk(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return true;
  const bool refused = ::fsync(file) != 0 && (errno == EIO || errno == ENOSPC || errno == EDQUOT);
  ::close(file);
  return !refused;
}

}  // namespace

AtomicPath::AtomicPath(fs::path final_path, Kind kind) : final_(std::move(final_path)) {
  while (!final_.empty() && !final_.has_filename())
    final_ = final_.parent_path();  // "report/" means "report"
  const Where where{final_.string(), 0, 0, ""};
  if (final_.empty()) throw ConfigError({}, "The output has no name.");
  const fs::path parent = final_.has_parent_path() ? final_.parent_path() : fs::path(".");
  std::error_code ec;
  if (!fs::is_directory(parent, ec))
    throw ConfigError(where, "the output's folder '" + parent.string() + "' does not exist.");
  if (::access(parent.c_str(), W_OK | X_OK) != 0)
    throw ConfigError(where, "the output's folder '" + parent.string() + "' cannot be written to.");
  const bool exists = fs::exists(final_, ec);
  if (kind == Kind::file && exists && fs::is_directory(final_, ec))
    throw ConfigError(where, "the output is a folder where a file is to be written.");
  if (kind == Kind::folder && exists && !fs::is_directory(final_, ec))
    throw ConfigError(where, "the output is a file where a folder is to be written.");
  part_ = final_;
  part_ += ".part";
  fs::remove_all(part_, ec);
  if (kind == Kind::folder && !fs::create_directory(part_, ec))
    throw ConfigError(where, "the folder cannot be made (" + ec.message() + ").");
}

AtomicPath::AtomicPath(AtomicPath&& other) noexcept
    : final_(std::move(other.final_)),
      part_(std::move(other.part_)),
      open_(std::exchange(other.open_, false)) {}

AtomicPath::~AtomicPath() {
  std::error_code ec;
  if (open_) fs::remove_all(part_, ec);
}

void AtomicPath::commit() {
  commit_as(final_);
}

void AtomicPath::commit_as(const fs::path& other_name) {
  std::error_code ec;
  if (fs::is_directory(part_, ec))
    fs::remove_all(other_name, ec);
  else if (!sync_to_disk(part_))
    throw RunError(part_.string() + ": the disk did not take it (" + std::strerror(errno) + ").");
  fs::rename(part_, other_name, ec);
  if (ec)
    throw RunError(other_name.string() + ": the finished output cannot be given its name (" + ec.message() +
                   ").");
  open_ = false;
  sync_to_disk(other_name.has_parent_path() ? other_name.parent_path() : fs::path("."));
}

void write_text_file(const fs::path& path, const std::string& text) {
  AtomicPath out(path);
  {
    std::ofstream stream(out.part(), std::ios::binary);
    stream << text;
    stream.flush();
    if (!stream) throw RunError(path.string() + ": writing failed (" + std::strerror(errno) + ").");
  }
  out.commit();
}

std::string read_text_file(const fs::path& path, std::uintmax_t most) {
  const auto refuse = [&](const std::string& complaint) {
    throw InputError({path.string(), 0, 0, ""}, complaint);
  };
  struct File {
    int number;
    ~File() {
      if (number >= 0) ::close(number);
    }
  };
  // Not blocking: to open a pipe that nobody writes into would never end.
  const File file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)};
  if (file.number < 0)
    refuse(errno == ENOENT || errno == ENOTDIR
               ? "the file does not exist."
               : std::string("the file cannot be read (") + std::strerror(errno) + ").");
  struct stat about {};
  if (::fstat(file.number, &about) != 0)
    refuse(std::string("the file cannot be read (") + std::strerror(errno) + ").");
  if (S_ISDIR(about.st_mode)) refuse("this is a folder, a file is needed.");
  if (!S_ISREG(about.st_mode)) refuse("this is a device, a pipe or a socket; a regular file is needed.");
  const auto too_large = [&] {
    refuse("the file is larger than the " + std::to_string(most) + " bytes that such a file may have.");
  };
  if (static_cast<std::uintmax_t>(about.st_size) > most) too_large();
  std::string text;
  text.reserve(static_cast<std::size_t>(about.st_size) + 1);
  for (std::string piece(1 << 16, '\0');;) {
    const ssize_t got = ::read(file.number, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::string("the file cannot be read (") + std::strerror(errno) + ").");
    if (got == 0) return text;
    text.append(piece, 0, static_cast<std::size_t>(got));
    if (text.size() > most) too_large();  // it grew meanwhile
  }
}

}  // namespace twincell
