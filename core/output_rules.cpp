#include "core/output_rules.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <mutex>
#include <sstream>
#include <vector>

#include "core/error.hpp"
#include "core/manifest.hpp"
#include "core/picture_names.hpp"
#include "core/sha256.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

/// The registered inputs, and whether --force is set.
struct Rules {
  std::mutex mutex;
  std::vector<fs::path> inputs;  ///< canonical
  bool force = false;
  std::atomic<bool> has_force = false;  ///< there is an option --force
};
Rules& rules() {
  static Rules all;
  return all;
}

bool same_file(const fs::path& a, const fs::path& b) {
  struct stat of_a = {}, of_b = {};
  return ::stat(a.c_str(), &of_a) == 0 && ::stat(b.c_str(), &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

/// Whether `path` is `folder` or is below it; the inodes are compared at each level.
bool lies_in(const fs::path& path, const fs::path& folder) {
  for (fs::path at = path;; at = at.parent_path()) {
    if (same_file(at, folder)) return true;
    if (at == at.parent_path()) return false;
  }
}

std::vector<fs::path> inputs() {
  const std::lock_guard lock(rules().mutex);
  return rules().inputs;
}

/// Whether a folder or file is a mount point, judged by its parent folder and by the kernel's list of them.
bool is_mount_point(const fs::path& folder) {
  struct stat here = {}, above = {};
  if (::stat(folder.c_str(), &here) == 0 && ::stat((folder / "..").c_str(), &above) == 0 &&
      (here.st_dev != above.st_dev || here.st_ino == above.st_ino))
    return true;
  std::ifstream mounts("/proc/self/mountinfo");
  for (std::string line; std::getline(mounts, line);) {
    std::istringstream words(line);
    std::string word, name;
    for (int k = 0; k < 5; ++k) words >> word;
    for (std::size_t i = 0; i < word.size(); ++i)
      if (word[i] == '\\' && i + 3 < word.size()) {  // "\040" stands for a space
        name += static_cast<char>(std::strtol(word.substr(i + 1, 3).c_str(), nullptr, 8));
        i += 3;
      } else {
        name += word[i];
      }
    if (name == folder.string()) return true;
  }
  return false;
}

/// Whether the system lets no one but its owner replace an existing file: its folder is sticky, as /tmp is,
/// and neither belongs to this user.
bool kept_by_sticky_folder(const fs::path& file) {
  struct stat here = {}, above = {};
  const uid_t user = ::geteuid();
  return user != 0 && ::lstat(file.c_str(), &here) == 0 && ::stat(file.parent_path().c_str(), &above) == 0 &&
         (above.st_mode & S_ISVTX) != 0 && here.st_uid != user && above.st_uid != user;
}

bool is_temporary(const fs::path& name) {
  return name.filename().string().starts_with(kTemporaryPrefix);
}

/// Name of the first entry of a folder in order of names; empty if there is none. In a folder that several
/// processes share, unfinished outputs do not count, since one of them may be a manifest.
std::string first_entry(const fs::path& folder, bool shared, const Where& where) {
  std::string first;
  std::error_code ec;
  for (fs::directory_iterator at(folder, ec), end; !ec && at != end; at.increment(ec)) {
    const std::string name = at->path().filename().string();
    if (!(shared && is_temporary(at->path())) && (first.empty() || name < first)) first = name;
  }
  if (ec) throw ConfigError(where, "the output's folder cannot be read (" + ec.message() + ").");
  return first;
}

bool is_forced() {
  const std::lock_guard lock(rules().mutex);
  return rules().force;
}

/// How the user may proceed, as the end of a message about a file in the way.
std::string or_by_force() {
  return rules().has_force ? ", or replace it with --force" : "";
}

/// Refuses an existing file that its user protects, or that belongs to another product.
void require_unprotected(const fs::path& final, const Product& product, const Where& where) {
  struct stat about = {};
  constexpr mode_t kWritable = S_IWUSR | S_IWGRP | S_IWOTH;  // root may write to any file
  if (::stat(final.c_str(), &about) != 0) return;
  if ((about.st_mode & kWritable) == 0 || ::access(final.c_str(), W_OK) != 0)
    throw ConfigError(where, fmt::format("the file is write-protected; choose another name, or change its "
                                         "permissions{}.",
                                         or_by_force()));
  const bool is_data = product.is_trajectory() || product.sign == Product::Sign::failed_run ||
                       product.sign == Product::Sign::results_group;
  if (!is_data) return;
  const auto manifest = Manifest::read(final.parent_path());
  if (manifest && manifest->files.contains(final.filename().string()))
    throw ConfigError(where, fmt::format("the file belongs to the folder '{}', which is {}; choose another "
                                         "name{}.",
                                         final.parent_path().string(), manifest->product, or_by_force()));
}

void require_file(const fs::path& final, const Product& product, const Where& where) {
  std::error_code ec;
  if (final.filename() == Manifest::kName)
    throw ConfigError(where, "this name is that of the list of the files in a folder of twincell.");
  const fs::file_status status = fs::status(final, ec);
  for (const fs::path& input : inputs()) {
    if (fs::exists(status) && same_file(final, input))
      throw ConfigError(where,
                        fmt::format("the output is an input of the same command, '{}'.", input.string()));
    if (!fs::is_directory(input, ec)) continue;
    if ((product.sign == Product::Sign::picture_software || is_named_as_picture(final)) &&
        same_file(final.parent_path(), input))
      throw ConfigError(where,
                        fmt::format("the folder '{}' is an input, and a picture in it would be one of its "
                                    "frames; name a file elsewhere.",
                                    input.string()));
    if (fs::exists(status) && lies_in(final, input) && !is_product(final, product))
      throw ConfigError(where, fmt::format("the output is a file of the input '{}'.", input.string()));
  }
  if (!fs::exists(status)) return;
  if (fs::is_directory(status))
    throw ConfigError(where, "the output is a folder where a file is to be written.");
  if (!fs::is_regular_file(status))
    throw ConfigError(where, "the output is not a regular file (a device, pipe or socket).");
  // Both would be refused only when the finished output is renamed, after all the work.
  if (is_mount_point(final))
    throw ConfigError(where, "the file is a mount point and cannot be replaced; choose another name.");
  if (kept_by_sticky_folder(final))
    throw ConfigError(
        where, fmt::format("the file belongs to another user, and in the folder '{}' (sticky bit) only "
                           "its owner can replace it; choose another name.",
                           final.parent_path().string()));
  if (!may_replace(final, product))
    throw ConfigError(where,
                      fmt::format("the file exists and {}; choose another name{}.",
                                  product.sign == Product::Sign::none
                                      ? fmt::format("{} does not state which program made it", product.name)
                                      : fmt::format("is not {} made by twincell", product.name),
                                  or_by_force()));
  if (!is_forced()) require_unprotected(final, product, where);
}

void require_unchanged(const fs::path& folder, const Manifest& manifest, const Where& where) {
  std::error_code ec;
  for (const auto& [name, hashes] : manifest.files)
    if (fs::exists(fs::symlink_status(folder / name, ec)) && !manifest.unchanged(folder, name))
      throw ConfigError(where,
                        fmt::format("'{}' in it has changed since twincell wrote it; move it, or name a new "
                                    "folder.",
                                    name));
}

/// Refuses files of others that have the names of those that the product will write.
void require_names_free(const fs::path& folder, const Manifest& manifest, const Product& product,
                        const Where& where) {
  std::error_code ec;
  for (const std::string& name : product.files)
    if (fs::exists(fs::symlink_status(folder / name, ec)) && !manifest.unchanged(folder, name))
      throw ConfigError(where, fmt::format("'{}' in it {}; move it, or name a new folder.", name,
                                           manifest.files.contains(name)
                                               ? "has changed since twincell wrote it"
                                               : "was not written by twincell and would be replaced"));
}

void require_folder(const fs::path& final, const Product& product, const Where& where) {
  std::error_code ec;
  if (!fs::exists(final, ec)) return;
  if (!fs::is_directory(final, ec))
    throw ConfigError(where, "the output is a file where a folder is to be written.");
  const fs::path here = fs::current_path(ec);
  if (!ec && lies_in(here, final))
    throw ConfigError(where, same_file(here, final)
                                 ? "the output is the working directory; name a new folder."
                                 : "the output is a folder above the working directory.");
  if (is_mount_point(final)) throw ConfigError(where, "the output is a mount point; name a folder below it.");
  for (const fs::path& input : inputs())
    if (lies_in(input, final))
      throw ConfigError(where, fmt::format("the output folder contains the input '{}'.", input.string()));
  if (::access(final.c_str(), R_OK | W_OK | X_OK) != 0)
    throw ConfigError(where, "the output's folder cannot be written to.");
  const std::string first = first_entry(final, product.shared, where);
  if (first.empty() && !product.shared && kept_by_sticky_folder(final))  // it is replaced as a whole
    throw ConfigError(
        where, fmt::format("the folder belongs to another user, and in the folder '{}' (sticky bit) only "
                           "its owner can replace it; name a new folder.",
                           final.parent_path().string()));
  if (first.empty()) return;
  const auto manifest = Manifest::read(final);
  if (!manifest)
    throw ConfigError(where,
                      fmt::format("the folder is not empty and was not made by twincell: '{}' is in the way; "
                                  "name a new folder.",
                                  first));
  if (manifest->product != product.name)
    throw ConfigError(where, fmt::format("the folder is {}, and the output is {}; name a new folder.",
                                         manifest->product, product.name));
  if (!product.shared) require_unchanged(final, *manifest, where);
  require_names_free(final, *manifest, product, where);
}

}  // namespace

void protect_input(const fs::path& path) {
  std::error_code ec;
  const fs::path canonical = fs::canonical(path, ec);
  if (ec) return;
  const std::lock_guard lock(rules().mutex);
  auto& all = rules().inputs;
  if (std::find(all.begin(), all.end(), canonical) == all.end()) all.push_back(canonical);
}

void replace_by_force(bool allowed) {
  const std::lock_guard lock(rules().mutex);
  rules().force = allowed;
  rules().has_force = true;
}

bool may_replace(const fs::path& file, const Product& product) {
  return is_product(file, product) || is_forced();
}

fs::path require_output(const fs::path& path, const Product& product) {
  const Where where{path.string(), 0, 0, ""};
  if (path.empty()) throw ConfigError({}, "The output has no name.");
  if (path == kStandardOutput) {
    if (product.is_text()) return path;
    throw ConfigError({},
                      fmt::format("The output '-' is standard output, which takes tables, TOML and JSON; {} "
                                  "needs a name.",
                                  product.name));
  }
  const bool slash = !path.has_filename();
  std::error_code ec;
  if (fs::is_symlink(fs::symlink_status(path, ec)) && !fs::exists(path, ec))
    throw ConfigError(where, "the output is a symbolic link to something that does not exist.");
  fs::path final = fs::weakly_canonical(fs::absolute(path, ec), ec);
  if (ec) throw ConfigError(where, "the output's name cannot be resolved (" + ec.message() + ").");
  while (!final.has_filename() && final != final.root_path()) final = final.parent_path();
  if (final == final.root_path())
    throw ConfigError(where, "the output is the root folder; name a folder below it.");
  const fs::path parent = final.parent_path();
  if (!fs::is_directory(parent, ec))
    throw ConfigError(where, "the output's folder '" + parent.string() + "' does not exist.");
  if (slash && !product.folder && !fs::is_directory(final, ec))
    throw ConfigError(where, "the name ends with a slash, but the output is a file.");
  if (product.folder)
    require_folder(final, product, where);
  else
    require_file(final, product, where);
  if (::access(parent.c_str(), W_OK | X_OK) != 0 && !(product.shared && fs::exists(final, ec)))
    throw ConfigError(where, "the output's folder '" + parent.string() + "' cannot be written to.");
  return final;
}

fs::path claim_shared_folder(const fs::path& path, const Product& product) {
  fs::path final = require_output(path, product);
  std::error_code ec;
  fs::create_directory(final, ec);
  if (ec || !fs::is_directory(final, ec))
    throw ConfigError({path.string(), 0, 0, ""}, "the folder cannot be made (" + ec.message() + ").");
  if (!Manifest::read(final)) Manifest{.product = product.name, .files = {}}.write(final);
  return final;
}

void unlist_files(const fs::path& folder) {
  auto manifest = Manifest::read(folder);
  if (!manifest || manifest->files.empty()) return;
  require_unchanged(folder, *manifest, {folder.string(), 0, 0, ""});
  manifest->files.clear();
  manifest->write(folder);
}

void list_files(const fs::path& folder, const std::vector<std::string>& names) {
  auto manifest = Manifest::read(folder);
  if (!manifest) return;
  for (const std::string& name : names) manifest->files[name] = {sha256_of(folder / name)};
  manifest->write(folder);
}

}  // namespace twincell
