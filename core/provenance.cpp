#include "core/provenance.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/json_text.hpp"
#include "core/sha256.hpp"
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

std::uintmax_t size_of(const fs::path& path) {
  if (!fs::is_directory(path)) return fs::file_size(path);
  std::uintmax_t total = 0;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.is_regular_file()) total += entry.file_size();
  return total;
}

}  // namespace

std::string version_line() {
  return fmt::format("twincell {} ({})", TWINCELL_VERSION, TWINCELL_GIT);
}

std::string version_json() {
  return json_text(version_object(), 2);
}

std::string Provenance::to_json() const {
  nlohmann::json out = version_object();
  out["utc"] = utc_now();
  out["command_line"] = command_line;
  out["threads"] = threads;
  if (seed) out["seed"] = *seed;
  if (!config.empty()) out["config"] = config;
  if (!plan.empty()) out["plan"] = nlohmann::json::parse(plan);
  out["inputs"] = nlohmann::json::array();
  for (const auto& input : inputs)
    out["inputs"].push_back(
        {{"path", input.string()}, {"bytes", size_of(input)}, {"sha256", sha256_of(input)}});
  return json_text(out);
}

}  // namespace twincell
