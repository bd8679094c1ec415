// Each top folder has its namespace: the files of imaging/ are in twincell::imaging. core and trajectory are
// the common vocabulary, in twincell itself. The folders are read from the tree.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace twincell::namespaces_test {

namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path kRoot = TWINCELL_SOURCE_DIR;

/// Folders whose names are in twincell itself.
const Names kVocabulary = {"core", "trajectory"};
/// Programs beside the product: their files are in the namespace of what they test or measure.
const Names kPrograms = {"tests", "bench"};

/// Top folders that have a namespace: those with sources, without the two lists above.
Names folders() {
  Names names;
  for (const auto& top : fs::directory_iterator(kRoot)) {
    const std::string name = top.path().filename();
    if (!top.is_directory() || name.starts_with('.') || name.starts_with("build")) continue;
    if (kVocabulary.contains(name) || kPrograms.contains(name)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(top.path()))
      if (entry.path().extension() == ".cpp") names.insert(name);
  }
  return names;
}

/// The first names after twincell in the lines of a file that begin with `keyword`: "sim" of
/// `namespace twincell::sim {`, "" of `namespace twincell {`. Forward declarations of the vocabulary's types
/// do not count.
Names names_after(const std::string& keyword, const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  const std::regex forward("(^|\n)namespace twincell \\{\n((class|struct) \\w+;\n)+\\}");
  const std::string all = std::regex_replace(text.str(), forward, "");
  const std::regex line("(^|\n)" + keyword + " twincell(::(\\w+))?");
  Names names;
  for (std::sregex_iterator it(all.begin(), all.end(), line), end; it != end; ++it) names.insert((*it)[3]);
  return names;
}

std::vector<fs::path> sources_of(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder))
    if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp")
      files.push_back(entry.path());
  return files;
}

TEST(Namespaces, EveryFolderHasItsOwn) {
  const Names all = folders();
  ASSERT_GE(all.size(), 8U) << "the sources were not found";
  for (const std::string& folder : all)
    for (const fs::path& file : sources_of(folder)) {
      const Names opened = names_after("namespace", file), used = names_after("using namespace", file);
      // The file of main() opens none and uses that of its folder.
      EXPECT_TRUE(opened == Names{folder} || (opened.empty() && used.contains(folder)))
          << file << " must be in namespace twincell::" << folder;
    }
}

TEST(Namespaces, TheVocabularyIsInNoneOfThem) {
  const Names all = folders();
  for (const std::string& folder : kVocabulary)
    for (const fs::path& file : sources_of(folder))
      for (const std::string& name : names_after("namespace", file))
        EXPECT_FALSE(all.contains(name)) << file << " opens namespace twincell::" << name;
}

TEST(Namespaces, EveryTestFileHasItsOwn) {  // the files are compiled in batches (tests/CMakeLists.txt)
  std::size_t files = 0;
  for (const fs::path& file : sources_of("tests")) {
    const std::string stem = file.stem();
    if (!stem.ends_with("_test") || file.extension() != ".cpp") continue;
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    ++files;
    EXPECT_TRUE(
        std::regex_search(text.str(), std::regex("(^|\n)namespace twincell(::\\w+)*::" + stem + " \\{\n")))
        << file << " must be in namespace twincell::" << stem << " or twincell::FOLDER::" << stem;
  }
  EXPECT_GE(files, 200U) << "the tests were not found";
}

}  // namespace

}  // namespace twincell::namespaces_test
