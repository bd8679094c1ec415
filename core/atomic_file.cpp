#include "core/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/manifest.hpp"
#include "core/output_rules.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

/// Syncs a file, or the entries of a folder, to disk. \returns 0, or the error number of an I/O error or a
/// full disk. A file system without sync (some network file systems) counts as synced.
int sync_to_disk(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return 0;
  const int why = ::fsync(file) == 0 ? 0 : errno;
  ::close(file);
  return why == EIO || why == ENOSPC || why == EDQUOT ? why : 0;
}

void require_on_disk(const fs::path& path) {
  if (const int why = sync_to_disk(path); why != 0)
    throw RunError(path.string() + ": it could not be written to disk (" + std::strerror(why) + ").");
}

/// Syncs all files and folders below a folder, and the folder. \throws RunError naming the first that fails
void require_tree_on_disk(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (!entry.is_symlink() && (entry.is_regular_file() || entry.is_directory()))
      paths.push_back(entry.path());
  // Start writing all files before the first sync waits; a folder of many frames is then written in one go
  // rather than file by file.
  for (const fs::path& path : paths)
    if (const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW); file >= 0) {
      (void)::sync_file_range(file, 0, 0, SYNC_FILE_RANGE_WRITE);
      ::close(file);
    }
  for (const fs::path& path : paths) require_on_disk(path);
  require_on_disk(folder);
}

/// Whether a new file may be placed at `name` in a folder: there is no such file or it is listed and
/// unchanged, and no parent folder in `name` is a link or a file.
bool replaceable(const fs::path& folder, const Manifest& manifest, const std::string& name) {
  std::error_code ec;
  fs::path at = folder;
  for (const fs::path& part : fs::path(name).parent_path()) {
    at /= part;
    const fs::file_status status = fs::symlink_status(at, ec);
    if (!fs::exists(status)) return true;
    if (!fs::is_directory(status)) return false;
  }
  return !fs::exists(fs::symlink_status(folder / name, ec)) || manifest.unchanged(folder, name);
}

/// Whether a folder contains only files that its manifest lists and that are unchanged.
bool only_listed(const fs::path& folder, const Manifest& manifest) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory() && !entry.is_symlink()) continue;
    const std::string name = entry.path().lexically_relative(folder).string();
    if (name != Manifest::kName && !manifest.unchanged(folder, name)) return false;
  }
  return true;
}

/// Gives a file that replaces another the permissions, and where possible the owner, of the other.
void keep_rights(const fs::path& old, const fs::path& fresh) {
  struct stat about = {};
  if (::stat(old.c_str(), &about) != 0) return;
  constexpr mode_t kRights = S_IRWXU | S_IRWXG | S_IRWXO;
  if (::chown(fresh.c_str(), about.st_uid, about.st_gid) != 0) errno = 0;  // another user's file
  if (::chmod(fresh.c_str(), about.st_mode & kRights) != 0) errno = 0;
}

/// Removes the listed, unchanged files of a folder, its manifest, and the folders that are then empty.
void remove_listed(const fs::path& folder, const Manifest& manifest) {
  std::error_code ec;
  for (const auto& [name, hashes] : manifest.files)
    if (manifest.unchanged(folder, name)) fs::remove(folder / name, ec);
  fs::remove(folder / Manifest::kName, ec);
  std::vector<fs::path> folders = {folder};
  for (const auto& entry : fs::recursive_directory_iterator(folder, ec))
    if (entry.is_directory(ec) && !entry.is_symlink(ec)) folders.push_back(entry.path());
  for (std::size_t i = folders.size(); i-- > 0;)
    fs::remove(folders[i], ec);  // fails for a folder that is not empty
}

/// Final names of the outputs that this process has begun, by their temporary names. Those that were finished
/// are removed.
struct FinalNames {
  std::mutex mutex;
  std::map<std::string, std::string> of;
};
FinalNames& final_names() {
  static FinalNames all;
  return all;
}

}  // namespace

std::string in_final_names(std::string message) {
  const std::lock_guard guard(final_names().mutex);
  for (const auto& [part, name] : final_names().of)
    for (std::size_t at = 0; (at = message.find(part, at)) != std::string::npos; at += name.size())
      message.replace(at, part.size(), name);
  return message;
}

AtomicPath::AtomicPath(const fs::path& final_path, Product product)
    : given_(final_path), final_(require_output(final_path, product)), product_(std::move(product)) {
  while (!given_.empty() && !given_.has_filename() && given_ != given_.root_path())
    given_ = given_.parent_path();  // "report/" means "report"
  if (final_ == kStandardOutput) {
    part_ = make_temporary(folder_for_temporaries() / "standard-output", false);
    return;
  }
  lock_.emplace(final_);
  part_ = make_temporary(final_, product_.folder);
  const std::lock_guard guard(final_names().mutex);
  final_names().of.emplace(part_.string(), given_.string());
}

AtomicPath::AtomicPath(AtomicPath&& other) noexcept
    : given_(std::move(other.given_)),
      final_(std::move(other.final_)),
      product_(std::move(other.product_)),
      lock_(std::move(other.lock_)),
      part_(std::move(other.part_)),
      open_(std::exchange(other.open_, false)) {
  other.lock_.reset();
}

AtomicPath::~AtomicPath() {
  if (!open_) {
    if (part_.empty()) return;  // moved from
    const std::lock_guard guard(final_names().mutex);
    final_names().of.erase(part_.string());
    return;
  }
  std::error_code ec;
  fs::remove_all(part_, ec);
  forget_temporary(part_);
}

void AtomicPath::commit() {
  if (final_ == kStandardOutput) return print();  // the destructor removes the file
  if (product_.folder)
    place_folder(final_);
  else
    place_file(final_);
  open_ = false;
  forget_temporary(part_);
  (void)sync_to_disk(final_.parent_path());
}

fs::path AtomicPath::commit_as(const fs::path& other_name, const Product& product) {
  product_ = product;
  given_ = other_name;
  try {
    final_ = require_output(other_name, product_);
  } catch (const ConfigError& e) {
    const fs::path kept = keep_beside(final_.parent_path() / other_name.filename());
    if (kept.empty()) throw RunError(e.what());
    return kept;
  }
  commit();
  return given_;
}

void AtomicPath::give_way(const fs::path& target, const std::string& obstacle) {
  fail_and_keep(target, obstacle + " and is not replaced");
}

void AtomicPath::fail_and_keep(const fs::path& target, const std::string& why) {
  const fs::path kept = keep_beside(target);
  throw RunError(
      kept.empty()
          ? fmt::format("{}: {}, and no other name in its folder can be given.", given_.string(), why)
          : fmt::format("{}: {}; the finished output is {}.", given_.string(), why, kept.string()));
}

fs::path AtomicPath::keep_beside(const fs::path& target) {
  for (int k = 1; k < 10000; ++k) {
    fs::path other = target.parent_path() / fmt::format("{}.twincell-{}", target.filename().string(), k);
    if (::renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, other.c_str(), RENAME_NOREPLACE) != 0) continue;
    open_ = false;
    forget_temporary(part_);
    return other;
  }
  return {};
}

void AtomicPath::place_file(const fs::path& target) {
  require_on_disk(part_);
  std::error_code ec;
  if (fs::exists(fs::symlink_status(target, ec)) &&
      (!fs::is_regular_file(target, ec) || !may_replace(target, product_)))
    give_way(target, "a file of that name appeared or changed during the run");
  keep_rights(target, part_);
  fs::rename(part_, target, ec);
  if (ec) fail_and_keep(target, "the output cannot take this name (" + ec.message() + ")");
}

void AtomicPath::print() {
  std::ifstream stream(part_, std::ios::binary);
  bool good = static_cast<bool>(stream);
  for (std::vector<char> piece(1 << 16); good && stream;) {
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto got = static_cast<std::size_t>(stream.gcount());
    good = std::fwrite(piece.data(), 1, got, stdout) == got;
  }
  if (!good || std::fflush(stdout) != 0) throw RunError("The output cannot be written to standard output.");
}

void AtomicPath::place_folder(const fs::path& target) {
  const auto fail = [&](const std::error_code& ec) {
    throw RunError(given_.string() + ": the finished output cannot be renamed to this path (" + ec.message() +
                   ").");
  };
  require_tree_on_disk(part_);
  Manifest fresh = Manifest::of(part_, product_.name);
  std::error_code ec;
  const auto old = Manifest::read(target);
  if (!old) {
    // The target is absent or empty; anything else has appeared during the run.
    fresh.write(part_);
    require_on_disk(part_);  // the manifest's name
    fs::rename(part_, target, ec);
    if (ec == std::errc::directory_not_empty || ec == std::errc::file_exists ||
        ec == std::errc::not_a_directory)
      give_way(target, "a folder or file of that name appeared during the run");
    if (ec) fail_and_keep(target, "the output cannot take this name (" + ec.message() + ")");
    return;
  }
  if (!product_.shared && only_listed(target, *old)) {
    // All files in it are ours: exchange the two folders in one step.
    fresh.write(part_);
    require_on_disk(part_);
    if (::renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) {
      remove_listed(part_, *old);
      return;
    }
  }
  for (const auto& [name, hashes] : fresh.files)
    if (!replaceable(target, *old, name))
      give_way(target, "'" + name + "' in it was not written by twincell, or has changed since,");
  // Otherwise replace file by file. At every instant the manifest lists each file of ours, old or new.
  Manifest both = *old;
  for (const auto& [name, hashes] : fresh.files) both.files[name].insert(hashes.begin(), hashes.end());
  both.write(target);
  for (const auto& [name, hashes] : fresh.files) {
    fs::create_directories((target / name).parent_path(), ec);
    fs::rename(part_ / name, target / name, ec);
    if (ec) fail(ec);
  }
  for (const auto& [name, hashes] : old->files) {
    if (fresh.files.contains(name)) continue;
    if (product_.shared)
      fresh.files[name] = hashes;
    else if (old->unchanged(target, name))
      fs::remove(target / name, ec);
  }
  // The new names must reach the disk before the manifest stops listing the old files.
  std::set<fs::path> folders = {target};
  for (const auto& [name, hashes] : fresh.files) folders.insert((target / name).parent_path());
  for (const fs::path& folder : folders) require_on_disk(folder);
  fresh.write(target);
  (void)sync_to_disk(target);
  fs::remove_all(part_, ec);
}

void write_text_file(const fs::path& path, const std::string& text, const Product& product) {
  AtomicPath out(path, product);
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
  if (path.empty()) refuse("the name of a file to read is empty.");
  struct File {
    int number;
    ~File() {
      if (number >= 0) ::close(number);
    }
  };
  // Non-blocking: opening a pipe without a writer would never return.
  const File file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)};
  if (file.number < 0)
    refuse(errno == ENOENT || errno == ENOTDIR
               ? "the file does not exist."
               : std::string("the file cannot be read (") + std::strerror(errno) + ").");
  struct stat about {};
  if (::fstat(file.number, &about) != 0)
    refuse(std::string("the file cannot be read (") + std::strerror(errno) + ").");
  if (S_ISDIR(about.st_mode)) refuse("this is a folder; a file is needed.");
  if (!S_ISREG(about.st_mode)) refuse("this is a device, a pipe or a socket; a regular file is needed.");
  const auto too_large = [&] {
    refuse("the file is larger than the " + std::to_string(most) + " bytes allowed.");
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
    if (text.size() > most) too_large();  // the file grew while it was read
  }
}

}  // namespace twincell
