// The arrows of the design, enforced: who may include whom. Links alone do not hold a layout together.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Folder -> folders it may include besides itself. analysis/trajectory stands on its own, apart from
/// analysis.
const std::map<std::string, std::set<std::string>> kAllowed = {
    {"trajectory", {}},
    {"analysis", {"trajectory"}},
    {"imaging", {"trajectory"}},
    {"sim", {"trajectory"}},
    {"calibration", {"trajectory", "analysis", "imaging", "sim"}},
    {"sweep", {"trajectory", "analysis", "sim"}},
    {"reproduce", {"trajectory", "analysis", "sim", "calibration", "sweep"}},
    {"cli", {"trajectory", "analysis", "imaging", "sim", "calibration", "sweep", "reproduce"}},
    {"bench", {"trajectory", "analysis", "imaging", "sim", "calibration", "tests"}},
    {"tests", {"trajectory", "analysis", "imaging", "sim", "calibration", "sweep", "reproduce"}},
};

/// Outside libraries that must stay inside one folder.
const std::vector<std::pair<std::string, std::set<std::string>>> kLibraryHomes = {
    {"opencv2/", {"imaging", "tests", "bench"}},
    {"ceres/", {"calibration", "tests"}},
    {"toml++/", {"trajectory"}},
    {"CLI/", {"cli", "bench"}},
    {"hdf5.h", {"trajectory", "tests"}},
    {"mpi.h", {"cli"}},
};

std::string module_of(const std::string& path) {
  if (path.rfind("analysis/trajectory/", 0) == 0) return "trajectory";
  return path.substr(0, path.find('/'));
}

struct Include {
  std::string file;  ///< relative to the root
  std::string target;
  bool quoted;
};

std::vector<Include> all_includes() {
  const fs::path root = TWINCELL_SOURCE_DIR;
  const std::regex line_form(R"(^\s*#include\s+(["<])([^">]+)[">])");
  std::vector<Include> includes;
  for (const auto& [module, allowed] : kAllowed) {
    const fs::path folder = root / (module == "trajectory" ? "analysis/trajectory" : module);
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
      const std::string file = fs::relative(entry.path(), root).string();
      if (module_of(file) != module) continue;
      std::ifstream stream(entry.path());
      std::smatch match;
      for (std::string line; std::getline(stream, line);)
        if (std::regex_search(line, match, line_form)) includes.push_back({file, match[2], match[1] == "\""});
    }
  }
  return includes;
}

TEST(IncludeGraph, ArrowsRunOneWay) {
  const auto includes = all_includes();
  ASSERT_GT(includes.size(), 50U) << "the sources were not found";
  for (const Include& i : includes) {
    if (!i.quoted || i.target == "twincell_version.hpp") continue;
    const std::string from = module_of(i.file), to = module_of(i.target);
    ASSERT_TRUE(fs::exists(fs::path(TWINCELL_SOURCE_DIR) / i.target))
        << i.file << " includes " << i.target << ", not a path from the root";
    EXPECT_TRUE(from == to || kAllowed.at(from).contains(to))
        << i.file << " includes " << i.target << ": " << from << " must not know " << to;
  }
}

TEST(IncludeGraph, LibrariesStayInTheirFolder) {
  for (const Include& i : all_includes())
    for (const auto& [prefix, homes] : kLibraryHomes)
      EXPECT_TRUE(i.target.rfind(prefix, 0) != 0 || homes.contains(module_of(i.file)))
          << i.file << " includes " << i.target;
}

// One observable must not lean on another: each sees the trajectory, the neighbours and the statistics only.
TEST(IncludeGraph, ObservablesDoNotKnowEachOther) {
  const std::set<std::string> observables = {
      "order",      "orientation",          "grains",           "defects", "convection", "profiles",
      "barycentre", "granular_temperature", "phase_thresholds", "slip"};
  for (const Include& i : all_includes()) {
    if (module_of(i.file) != "analysis" || module_of(i.target) != "analysis" || !i.quoted) continue;
    const std::string from = fs::path(i.file).stem(), to = fs::path(i.target).stem();
    EXPECT_TRUE(from == to || !observables.contains(from) || !observables.contains(to))
        << i.file << " includes " << i.target;
  }
}

TEST(IncludeGraph, NoCycles) {
  std::map<std::string, std::set<std::string>> edges;
  for (const Include& i : all_includes())
    if (i.quoted && i.file.ends_with(".hpp")) edges[i.file].insert(i.target);
  std::set<std::string> done;
  std::vector<std::string> path;
  auto visit = [&](auto&& self, const std::string& file) -> void {
    if (const auto at = std::find(path.begin(), path.end(), file); at != path.end()) {
      FAIL() << fmt::format("include cycle: {} -> {}", fmt::join(at, path.end(), " -> "), file);
    }
    if (done.contains(file)) return;
    path.push_back(file);
    for (const std::string& next : edges[file]) self(self, next);
    path.pop_back();
    done.insert(file);
  };
  for (const auto& entry : std::map(edges)) visit(visit, entry.first);
}

}  // namespace
