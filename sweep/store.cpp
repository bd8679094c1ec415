#include "sweep/store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/atomic_file.hpp"
#include "core/json_text.hpp"
#include "core/output_rules.hpp"
#include "core/sha256.hpp"

namespace twincell::sweep {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSum = "sha256";

/// SHA-256 of a result without its own checksum and without "computed", which differs between machines.
std::string sum_of(nlohmann::json document) {
  document.erase(kSum);
  document.erase("computed");
  const std::string text = json_text(document);
  Sha256 sum;
  sum.add(text.data(), text.size());
  return sum.hex();
}

/// Whether a document is the complete result of this point. Results of earlier versions have no checksum.
bool is_sound(const nlohmann::json& document, const Point& point) {
  if (!document.is_object() || !document.contains("id") || document["id"] != point.id) return false;
  if (!document.contains("computed") || !document["computed"].is_object()) return false;
  if (document.contains(kSum)) return document[kSum] == sum_of(document);
  return document.contains("failed") || (document.contains("results") && document["results"].is_object());
}

template <class Work>
void storing(const fs::path& folder, Work work) {
  try {
    work();
  } catch (const Error& e) {
    throw NotStored(
        fmt::format("{} The results so far are kept in {}; the same command continues from there.", e.what(),
                    folder.string()));
  }
}

}  // namespace

Claim::Claim(Claim&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
Claim& Claim::operator=(Claim&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}
Claim::~Claim() {
  if (file_ >= 0) ::close(file_);
}

Store::Store(fs::path folder, Access access) : folder_(std::move(folder)) {
  if (access == Access::read) return;
  // Folders of earlier versions have no manifest; their folder `points` identifies them.
  std::error_code ec;
  if (!fs::is_directory(folder_ / "points", ec)) claim_shared_folder(folder_, Product::runs());
  fs::create_directory(folder_ / "points", ec);
  if (ec || ::access((folder_ / "points").c_str(), R_OK | W_OK | X_OK) != 0)
    throw ConfigError({folder_.string(), 0, 0, ""},
                      fmt::format("the folder of the sweep cannot be made or written to ({}).",
                                  ec ? ec.message() : std::strerror(errno)));
}

void Store::announce(const Plan& plan, const Point& point) const {
  const fs::path file = of(point) / "point.json";
  std::error_code ec;
  if (fs::exists(file, ec)) return;
  storing(folder_, [&] {
    nlohmann::json j = {{"id", point.id},
                        {"replica", point.replica},
                        {"seed", point.seed},
                        {"particle_steps", point.work},
                        {"scene", point.scene}};
    for (std::size_t a = 0; a < plan.axes.size(); ++a) j["axes"][plan.axes[a].key] = point.values[a];
    if (point.at) j["axes"][plan.search->key] = *point.at;
    write_text_file(file, json_text(j, 2) + "\n");
  });
}

std::optional<std::string> Store::result(const Point& point) const {
  const fs::path file = of(point) / "result.json";
  std::error_code ec;
  if (!fs::exists(file, ec)) return std::nullopt;
  std::string text = read_text_file(file);
  const auto document = nlohmann::json::parse(text, nullptr, false);
  if (!is_sound(document, point))
    throw InputError(
        {file.string(), 0, 0, ""},
        "the result is damaged; remove the file, and the same command computes the point again.");
  return text;
}

std::optional<Claim> Store::claim(const Point& point) const {
  const fs::path file = of(point) / "lock";
  std::error_code ec;
  fs::create_directory(of(point), ec);  // an error shows when the file in it is opened
  const int lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock < 0)
    storing(folder_, [&] {
      throw RunError(fmt::format("{}: the file cannot be made ({}).", file.string(), std::strerror(errno)));
    });
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(lock);
    return std::nullopt;
  }
  return Claim(lock);
}

bool Store::claimed(const Point& point) const {
  const int lock = ::open((of(point) / "lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (lock < 0) return false;
  const bool taken = ::flock(lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(lock);
  return taken;
}

void Store::keep(const Point& point, const std::string& result) const {
  auto document = nlohmann::json::parse(result);
  document[kSum] = sum_of(document);
  storing(folder_, [&] { write_text_file(of(point) / "result.json", json_text(document) + "\n"); });
}

}  // namespace twincell::sweep
