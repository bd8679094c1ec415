#include "core/manifest.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "core/cancellation.hpp"
#include "core/error.hpp"
#include "core/file_identity.hpp"
#include "core/json_text.hpp"
#include "core/sha256.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kLargest = std::uintmax_t{256} << 20;  // maximum size of a manifest, bytes

/// Whether a name is a normalised relative path without "..", such as "a/b.csv", and not the manifest's.
bool stays_inside(const std::string& name) {
  const fs::path path(name);
  if (name.empty() || path.is_absolute() || path.lexically_normal() != path) return false;
  for (const fs::path& part : path)
    if (part == ".." || part == "." || part.empty()) return false;
  return name != Manifest::kName;
}

bool regular(const fs::path& path) {
  std::error_code ec;
  return fs::symlink_status(path, ec).type() == fs::file_type::regular;
}

/// SHA-256 of a file, cached per process for as long as the file is unchanged: the folders of large stacks
/// are compared with their manifests before, during and after a run. File system clocks are coarse, so that
/// a sum is cached only if the file was last changed more than kTicks before it was read.
std::string sum_of(const fs::path& file) {
  static std::mutex mutex;
  static std::map<FileIdentity, std::string> known;
  constexpr std::int64_t kTicks = 2'000'000'000;  // ns
  throw_if_cancelled();
  const std::optional<FileIdentity> identity = FileIdentity::of(file);
  if (!identity) return sha256_of(file);
  {
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(*identity); found != known.end()) return found->second;
  }
  const std::int64_t now =
      std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  std::string sum = sha256_of(file);
  if (std::max(identity->changed_ns, identity->modified_ns) + kTicks < now) {
    const std::lock_guard lock(mutex);
    known[*identity] = sum;
  }
  return sum;
}

}  // namespace

std::optional<Manifest> Manifest::read(const fs::path& folder) {
  const fs::path file = folder / kName;
  std::error_code ec;
  if (!regular(file) || fs::file_size(file, ec) > kLargest || ec) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  const auto document = nlohmann::json::parse(stream, nullptr, false);
  if (!document.is_object() || !document.contains("program") || document["program"] != "twincell" ||
      !document.contains("product") || !document["product"].is_string() || !document.contains("files") ||
      !document["files"].is_object())
    return std::nullopt;
  Manifest manifest{.product = document["product"], .files = {}};
  for (const auto& [name, hashes] : document["files"].items()) {
    if (!stays_inside(name) || !hashes.is_array()) return std::nullopt;
    for (const auto& hash : hashes) {
      if (!hash.is_string()) return std::nullopt;
      manifest.files[name].insert(hash.get<std::string>());
    }
  }
  return manifest;
}

Manifest Manifest::of(const fs::path& folder, const std::string& product) {
  Manifest manifest{.product = product, .files = {}};
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (regular(entry.path()) && entry.path() != folder / kName)
      manifest.files[entry.path().lexically_relative(folder).string()] = {sum_of(entry.path())};
  return manifest;
}

void Manifest::write(const fs::path& folder) const {
  nlohmann::json document = {
      {"program", "twincell"}, {"product", product}, {"files", nlohmann::json::object()}};
  for (const auto& [name, hashes] : files) document["files"][name] = hashes;
  const std::string text = json_text(document, 1) + "\n";
  const fs::path file = folder / kName;
  fs::path draft = folder / (std::string(".twincell-") + kName + "." + std::to_string(::getpid()));
  ::unlink(draft.c_str());
  const int out = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  bool good = out >= 0;
  for (std::size_t done = 0; good && done < text.size();) {
    const ssize_t n = ::write(out, text.data() + done, text.size() - done);
    good = n > 0;
    done += good ? static_cast<std::size_t>(n) : 0;
  }
  good = good && ::fsync(out) == 0;
  const int failure = errno;
  if (out >= 0) good = ::close(out) == 0 && good;
  if (!good || ::rename(draft.c_str(), file.c_str()) != 0) {
    const int why = good ? errno : failure;
    ::unlink(draft.c_str());
    throw RunError(file.string() + ": cannot be written (" + std::strerror(why) + ").");
  }
}

bool Manifest::unchanged(const fs::path& folder, const std::string& name) const {
  const auto listed = files.find(name);
  if (listed == files.end()) return false;
  fs::path at = folder;
  std::error_code ec;
  for (const fs::path& part : fs::path(name)) {
    at /= part;
    if (fs::is_symlink(fs::symlink_status(at, ec))) return false;
  }
  return regular(at) && listed->second.contains(sum_of(at));
}

}  // namespace twincell
