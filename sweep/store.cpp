#include "sweep/store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "analysis/observable/results.hpp"
#include "core/atomic_file.hpp"
#include "core/json_text.hpp"
#include "core/json_view.hpp"
#include "core/output_rules.hpp"
#include "core/sha256.hpp"
#include "sweep/conditions.hpp"

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

/// Checks that a document is the complete result of this point. Its readers rely on these keys and types.
/// Results of the first versions have no checksum. \throws InputError naming the key
void require_result(const JsonView& result, const Point& point) {
  if (const JsonView id = result.at("id"); id.text() != point.id)
    id.refuse(fmt::format("is '{}', but the folder is that of point '{}'", id.text(), point.id));
  const JsonView computed = result.at("computed");
  (void)computed.members();
  if (const auto seconds = computed.find("seconds")) (void)seconds->number_or_nan();
  if (const auto sum = result.find(kSum); sum && sum->text() != sum_of(result.value()))
    sum->refuse("does not fit the content");
  // Versions that store the processor time store a checksum too.
  if (!result.has(kSum) && computed.has("processor_seconds"))
    result.refuse("has no sha256, so it was changed by hand");
  if (const auto failed = result.find("failed"))
    (void)failed->text();
  else
    (void)result.at("results");
  if (const auto results = result.find("results")) (void)analysis::results_from_json(*results);
  if (const auto answer = result.find("answer"); answer && !answer->value().is_null())
    (void)answer->boolean();
  if (const auto cycles = result.find("n_cycles")) (void)cycles->integer(0);
  if (const auto conditions = result.find("conditions")) (void)conditions_from_json(*conditions);
  for (const char* key : {"contact_fraction", "rest_height"})
    if (const auto number = result.find(key)) (void)number->number_or_nan();
  if (const auto until = result.find("until")) {
    (void)until->at("reached").boolean();
    (void)until->at("text").text();
  }
  if (const auto stopped = result.find("stopped")) (void)stopped->text();
  if (const auto warnings = result.find("warnings"))
    for (const JsonView& text : warnings->elements()) (void)text.text();
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

/// Whether a folder `points` holds points of a sweep. Folders of earlier versions have no manifest.
bool holds_points(const fs::path& points) {
  std::error_code ec, ignored;
  for (fs::directory_iterator at(points, ec), end; !ec && at != end; at.increment(ec))
    if (fs::exists(at->path() / "point.json", ignored) || fs::exists(at->path() / "result.json", ignored))
      return true;
  return false;
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
  std::error_code ec;
  if (!holds_points(folder_ / "points")) claim_shared_folder(folder_, Product::runs());
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
  require_result(JsonView::parse(text, file.string(),
                                 "the result is damaged: remove the file, and the same command computes the "
                                 "point again"),
                 point);
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

std::vector<std::string> Store::finished() const {
  std::vector<std::string> ids;
  std::error_code ec;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "points", ec))
    if (std::filesystem::exists(entry.path() / "result.json", ec))
      ids.push_back(entry.path().filename().string());
  return ids;
}

void Store::keep(const Point& point, const std::string& result) const {
  auto document = nlohmann::json::parse(result);
  document[kSum] = sum_of(document);
  storing(folder_, [&] { write_text_file(of(point) / "result.json", json_text(document) + "\n"); });
}

}  // namespace twincell::sweep
