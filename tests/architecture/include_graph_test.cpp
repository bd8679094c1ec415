// Permitted includes between folders. The lists of files are read from the tree; this test states the order
// of the top folders and the folder that owns each outside library.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace twincell::include_graph_test {

namespace {

namespace fs = std::filesystem;
using Graph = std::map<std::string, std::set<std::string>>;

/// Top folder -> other top folders that it may include.
const Graph kAllowed = {
    {"core", {}},
    {"trajectory", {"core"}},
    {"analysis", {"core", "trajectory"}},
    {"imaging", {"core", "trajectory"}},
    {"sim", {"core", "trajectory"}},
    {"calibration", {"core", "trajectory", "analysis", "imaging", "sim"}},
    {"sweep", {"core", "trajectory", "analysis", "sim"}},
    {"twin", {"core", "trajectory", "analysis", "imaging", "sim", "calibration", "sweep"}},
    {"reproduce", {"core", "trajectory", "analysis", "sim", "calibration", "sweep", "twin"}},
    {"cli",
     {"core", "trajectory", "analysis", "imaging", "sim", "calibration", "sweep", "twin", "reproduce"}},
    {"python",
     {"core", "trajectory", "analysis", "imaging", "sim", "calibration", "sweep", "twin", "reproduce"}},
    {"bench", {"core", "trajectory", "analysis", "imaging", "sim", "calibration", "tests"}},
    {"tests",
     {"core", "trajectory", "analysis", "imaging", "sim", "calibration", "sweep", "twin", "reproduce"}},
};

/// Outside libraries that must be confined to one folder.
const std::vector<std::pair<std::string, std::set<std::string>>> kLibraryHomes = {
    {"opencv2/", {"imaging", "python", "tests", "bench"}},
    {"ceres/", {"calibration", "tests"}},
    {"toml++/", {"core"}},
    {"CLI/", {"cli", "bench"}},
    {"hdf5.h", {"core", "trajectory", "tests"}},
    {"mpi.h", {"cli"}},
    {"pybind11/", {"python"}},
};

const fs::path kRoot = TWINCELL_SOURCE_DIR;

std::string top_of(const std::string& path) {
  return path.substr(0, path.find('/'));
}

/// Folder of a file: "imaging/link" of imaging/link/assignment.cpp; the formats in imaging/stack/formats
/// belong to imaging/stack.
std::string room_of(const std::string& path) {
  const std::size_t first = path.find('/'), second = path.find('/', first + 1);
  return path.substr(0, second == std::string::npos ? first : second);
}

/// Module of a file: a header and its source form one module.
std::string module_of(const std::string& path) {
  return fs::path(path).replace_extension().string();
}

bool is_source(const fs::path& path) {
  return path.extension() == ".cpp" || path.extension() == ".hpp";
}

std::string text_of(const fs::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Include {
  std::string file;    ///< relative to the root
  std::string target;  ///< as written
  bool quoted;
};

std::vector<Include> all_includes() {
  const std::regex line_form(R"(^\s*#include\s+(["<])([^">]+)[">])");
  std::vector<Include> includes;
  for (const auto& [top, allowed] : kAllowed)
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      if (!is_source(entry.path())) continue;
      const std::string file = fs::relative(entry.path(), kRoot).string();
      std::ifstream stream(entry.path());
      std::smatch match;
      for (std::string line; std::getline(stream, line);)
        if (std::regex_search(line, match, line_form)) includes.push_back({file, match[2], match[1] == "\""});
    }
  return includes;
}

/// The first cycle of a graph, as "a -> b -> a"; empty if there is none.
std::string cycle_of(const Graph& graph) {
  std::set<std::string> done;
  std::vector<std::string> path;
  std::string found;
  const auto visit = [&](const auto& self, const std::string& node) -> void {
    if (!found.empty() || done.contains(node)) return;
    if (const auto at = std::find(path.begin(), path.end(), node); at != path.end()) {
      found = fmt::format("{} -> {}", fmt::join(at, path.end(), " -> "), node);
      return;
    }
    path.push_back(node);
    if (const auto edges = graph.find(node); edges != graph.end())
      for (const std::string& next : edges->second) self(self, next);
    path.pop_back();
    done.insert(node);
  };
  for (const auto& [node, edges] : graph) visit(visit, node);
  return found;
}

/// Includes between files of the tree, as edges between the names that `name` gives them.
template <class Name>
Graph graph_of(const std::vector<Include>& includes, Name name) {
  Graph graph;
  for (const Include& i : includes) {
    if (!i.quoted || !fs::exists(kRoot / i.target)) continue;
    const std::string from = name(i.file), to = name(i.target);
    if (from != to) graph[from].insert(to);
  }
  return graph;
}

TEST(IncludeGraph, EveryFolderHasItsPlace) {
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename();
    if (!entry.is_directory() || name.starts_with('.') || name.starts_with("build")) continue;
    bool sources = false;
    for (const auto& file : fs::recursive_directory_iterator(entry.path()))
      sources = sources || is_source(file.path());
    EXPECT_TRUE(!sources || kAllowed.contains(name)) << name << " holds sources and is not in kAllowed";
  }
}

TEST(IncludeGraph, ArrowsRunOneWay) {
  const auto includes = all_includes();
  ASSERT_GT(includes.size(), 50U) << "the sources were not found";
  for (const Include& i : includes) {
    if (!i.quoted || i.target == "twincell_version.hpp") continue;
    const std::string from = top_of(i.file), to = top_of(i.target);
    ASSERT_TRUE(fs::exists(kRoot / i.target))
        << i.file << " includes " << i.target << ", not a path from the root";
    EXPECT_TRUE(from == to || kAllowed.at(from).contains(to))
        << i.file << " includes " << i.target << ": " << from << " must not know " << to;
  }
}

TEST(IncludeGraph, LibrariesStayInTheirFolder) {
  for (const Include& i : all_includes())
    for (const auto& [prefix, homes] : kLibraryHomes)
      EXPECT_TRUE(i.target.rfind(prefix, 0) != 0 || homes.contains(top_of(i.file)))
          << i.file << " includes " << i.target;
}

TEST(IncludeGraph, NoCycleOfRooms) {
  EXPECT_EQ(cycle_of(graph_of(all_includes(), room_of)), "");
}

/// The rooms of a top folder in the order of its CMakeLists.txt; empty if it has none.
std::vector<std::string> rooms_of(const std::string& top) {
  const std::string cmake = text_of(kRoot / top / "CMakeLists.txt");
  const std::size_t begin = cmake.find("ROOMS ");
  if (begin == std::string::npos) return {};
  std::istringstream words(cmake.substr(begin + 6, cmake.find('\n', begin) - begin - 6));
  std::vector<std::string> rooms;
  for (std::string word; words >> word;)
    if (word.find('/') == std::string::npos) rooms.push_back(word == "." ? top : top + "/" + word);
  return rooms;
}

// The list ROOMS of a CMakeLists.txt is the order of the rooms: each may know those before it.
TEST(IncludeGraph, RoomsKnowOnlyEarlierRooms) {
  std::map<std::string, std::size_t> place;
  for (const auto& [top, allowed] : kAllowed) {
    const std::vector<std::string> rooms = rooms_of(top);
    for (std::size_t k = 0; k < rooms.size(); ++k) place[rooms[k]] = k;
  }
  ASSERT_GT(place.size(), 35U);
  for (const Include& i : all_includes()) {
    const auto from = place.find(room_of(i.file)), to = place.find(room_of(i.target));
    if (!i.quoted || from == place.end() || to == place.end() || top_of(i.file) != top_of(i.target)) continue;
    EXPECT_LE(to->second, from->second) << i.file << " includes " << i.target << ": " << to->first
                                        << " comes after " << from->first << " in ROOMS";
  }
}

TEST(IncludeGraph, NoCycleOfModules) {
  EXPECT_EQ(cycle_of(graph_of(all_includes(), module_of)), "");
}

// Test of the search for cycles.
TEST(IncludeGraph, ACycleThroughASourceIsFound) {
  // plan.cpp includes the kernel's header, and the kernel's header includes the plan's.
  const std::vector<std::pair<std::string, std::string>> lines = {
      {"sim/plan.cpp", "sim/kernel.hpp"}, {"sim/kernel.hpp", "sim/plan.hpp"}, {"sim/a.hpp", "sim/plan.hpp"}};
  Graph headers, modules;
  for (const auto& [from, to] : lines) {
    if (from.ends_with(".hpp")) headers[from].insert(to);
    modules[module_of(from)].insert(module_of(to));
  }
  EXPECT_EQ(cycle_of(headers), "");
  EXPECT_EQ(cycle_of(modules), "sim/plan -> sim/kernel -> sim/plan");
}

// Observables must not depend on each other: each may use the trajectory, the neighbours and the statistics
// only. An observable is a module of analysis whose header declares NAME_observable.
TEST(IncludeGraph, ObservablesDoNotKnowEachOther) {
  const std::regex maker(R"(extern const ObservableEntry \w+_observable;)");
  std::set<std::string> observables;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "analysis"))
    if (entry.path().extension() == ".hpp" && std::regex_search(text_of(entry.path()), maker))
      observables.insert(module_of(fs::relative(entry.path(), kRoot).string()));
  ASSERT_GE(observables.size(), 10U) << fmt::format("{}", fmt::join(observables, ", "));
  for (const Include& i : all_includes()) {
    const std::string from = module_of(i.file), to = module_of(i.target);
    EXPECT_TRUE(from == to || !observables.contains(from) || !observables.contains(to))
        << i.file << " includes " << i.target;
  }
}

// The installation must be complete: an installed header includes only installed headers of this project.
TEST(IncludeGraph, InterfacesIncludeInterfacesOnly) {
  const std::regex header(R"([\w/]+\.hpp)");
  std::set<std::string> interfaces;
  for (const auto& [top, allowed] : kAllowed) {
    const std::string cmake = text_of(kRoot / top / "CMakeLists.txt");
    std::size_t begin = cmake.find("INTERFACES");
    if (begin == std::string::npos) continue;
    const std::string list = cmake.substr(begin, cmake.find("PUBLIC", begin) - begin);
    for (auto it = std::sregex_iterator(list.begin(), list.end(), header); it != std::sregex_iterator(); ++it)
      interfaces.insert(top + "/" + it->str());
  }
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "sim/laws"))
    if (entry.path().extension() == ".hpp") interfaces.insert(fs::relative(entry.path(), kRoot).string());
  ASSERT_GT(interfaces.size(), 50U);
  for (const std::string& name : interfaces) EXPECT_TRUE(fs::exists(kRoot / name)) << name;
  for (const Include& i : all_includes())
    EXPECT_TRUE(!i.quoted || !interfaces.contains(i.file) || interfaces.contains(i.target))
        << i.file << " is installed and includes " << i.target << ", which is not";
}

}  // namespace

}  // namespace twincell::include_graph_test
