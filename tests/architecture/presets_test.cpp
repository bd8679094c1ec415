// Each alternative of a name filter in CMakePresets.json must select a test. ctest does not complain about an
// alternative that selects none while another selects some.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace twincell::presets_test {

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = TWINCELL_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ostringstream all;
  all << std::ifstream(file).rdbuf();
  return all.str();
}

/// The names of all tests as ctest has them: "unit.Drive.GammaOfASine".
std::vector<std::string> test_names() {
  const std::regex test(R"(\bTEST(_F|_P)?\(\s*(\w+),\s*(\w+)\))");
  std::vector<std::string> names;
  for (const auto& kind : fs::directory_iterator(kRoot / "tests")) {
    if (!kind.is_directory()) continue;
    for (const auto& file : fs::recursive_directory_iterator(kind.path())) {
      if (file.path().extension() != ".cpp") continue;
      const std::string text = text_of(file.path());
      for (std::sregex_iterator it(text.begin(), text.end(), test), end; it != end; ++it)
        names.push_back(kind.path().filename().string() + "." + (*it)[2].str() + "." + (*it)[3].str());
    }
  }
  return names;
}

/// The alternatives of a regular expression without groups.
std::vector<std::string> alternatives_of(const std::string& filter) {
  std::vector<std::string> parts;
  std::istringstream in(filter);
  for (std::string part; std::getline(in, part, '|');) parts.push_back(part);
  return parts;
}

TEST(Presets, EachAlternativeOfAFilterSelectsATest) {
  const nlohmann::json presets = nlohmann::json::parse(text_of(kRoot / "CMakePresets.json"));
  const std::vector<std::string> names = test_names();
  EXPECT_GT(names.size(), 1000U);
  int filters = 0;
  for (const auto& preset : presets.at("testPresets"))
    for (const char* side : {"include", "exclude"}) {
      const nlohmann::json::json_pointer pointer("/filter/" + std::string(side) + "/name");
      if (!preset.contains(pointer)) continue;
      ++filters;
      const std::string filter = preset.at(pointer);
      ASSERT_EQ(filter.find('('), std::string::npos) << "This test does not read groups: " << filter;
      for (const std::string& alternative : alternatives_of(filter)) {
        const std::regex pattern(alternative);
        const bool selects = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
          return std::regex_search(name, pattern);
        });
        EXPECT_TRUE(selects) << "CMakePresets.json, test preset " << preset.at("name") << ": " << alternative
                             << " is the name of no test.";
      }
    }
  EXPECT_GT(filters, 0);
}

}  // namespace

}  // namespace twincell::presets_test
