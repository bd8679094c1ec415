// docs/validation.md must contain every row of the verification plan that a verification test checks.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace twincell::validation_page_test {

namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream all;
  all << std::ifstream(file).rdbuf();
  return all.str();
}

TEST(ValidationPage, HasEveryIdThatATestChecks) {
  const std::filesystem::path root = TWINCELL_SOURCE_DIR;
  const std::string page = text_of(root / "docs/validation.md");
  const std::regex id("\"(V[0-9]+(\\.[0-9]+)?)\"");
  std::set<std::string> ids;
  for (const auto& file : std::filesystem::recursive_directory_iterator(root / "tests/verification")) {
    if (!file.is_regular_file()) continue;
    const std::string text = text_of(file.path());
    for (std::sregex_iterator it(text.begin(), text.end(), id), end; it != end; ++it) ids.insert((*it)[1]);
  }
  EXPECT_GT(ids.size(), 40U);
  for (const std::string& one : ids)
    EXPECT_NE(page.find("\n| " + one + " | "), std::string::npos)
        << "docs/validation.md has no row " << one << "; ./run validation makes it.";
}

}  // namespace

}  // namespace twincell::validation_page_test
