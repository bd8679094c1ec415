#include "analysis/trajectory/provenance.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <openssl/evp.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "analysis/trajectory/error.hpp"
#include "twincell_version.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

std::string processor() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

nlohmann::json version_object() {
  return {
      {"program", "twincell"},
      {"version", TWINCELL_VERSION},
      {"git", TWINCELL_GIT},
      {"compiler", TWINCELL_COMPILER},
      {"libraries",
       {{"hdf5", hdf5_version()},
        {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)}}},
      {"processor", processor()}};
}

/// Feeds a file to a digest piece by piece.
class Sha256 {
 public:
  Sha256() { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  void add(const char* data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    std::string text;
    for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_{EVP_MD_CTX_new(), EVP_MD_CTX_free};
};

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::uintmax_t size_of(const fs::path& path) {
  if (!fs::is_directory(path)) return fs::file_size(path);
  std::uintmax_t total = 0;
  for (const auto& file : files_in(path)) total += fs::file_size(file);
  return total;
}

}  // namespace

std::string version_line() {
  return fmt::format("twincell {} ({})", TWINCELL_VERSION, TWINCELL_GIT);
}

std::string version_json() {
  return version_object().dump(2);
}

std::string sha256_of(const fs::path& path) {
  Sha256 digest;
  if (fs::is_directory(path)) {
    for (const auto& file : files_in(path)) {
      const std::string line = file.filename().string() + "\n" + sha256_of(file) + "\n";
      digest.add(line.data(), line.size());
    }
    return digest.hex();
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError({path.string(), 0, 0, ""}, "the file cannot be read.");
  std::vector<char> buffer(1 << 16);
  while (stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || stream.gcount() > 0)
    digest.add(buffer.data(), static_cast<std::size_t>(stream.gcount()));
  return digest.hex();
}

std::string Provenance::to_json() const {
  nlohmann::json out = version_object();
  out["utc"] = utc_now();
  out["command_line"] = command_line;
  out["threads"] = threads;
  if (seed) out["seed"] = *seed;
  if (!config.empty()) out["config"] = config;
  out["inputs"] = nlohmann::json::array();
  for (const auto& input : inputs)
    out["inputs"].push_back(
        {{"path", input.string()}, {"bytes", size_of(input)}, {"sha256", sha256_of(input)}});
  return out.dump();
}

}  // namespace twincell
