// docs/observables.md lists every result of `analyze`, and no other.

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "analysis/observable/observable.hpp"

namespace twincell::observables_page_test {

namespace {

TEST(ObservablesPage, ListsEveryResultOnce) {
  std::ostringstream page;
  page << std::ifstream(std::string(TWINCELL_SOURCE_DIR) + "/docs/observables.md").rdbuf();
  const std::string all = page.str();
  const std::size_t begin = all.find("| results | what they are | where |"), end = all.find("\n\n", begin);
  ASSERT_NE(begin, std::string::npos);
  const std::string table = all.substr(begin, end - begin);

  std::multiset<std::string> listed;
  std::istringstream rows(table);
  for (std::string row; std::getline(rows, row);) {
    const std::string names = row.substr(0, row.find('|', 1));
    const std::regex name("`([A-Za-z0-9_]+)`");
    for (std::sregex_iterator it(names.begin(), names.end(), name), none; it != none; ++it)
      listed.insert((*it)[1]);
  }
  const std::vector<std::string> results = twincell::analysis::result_names();
  EXPECT_EQ(listed, std::multiset<std::string>(results.begin(), results.end()));
}

}  // namespace

}  // namespace twincell::observables_page_test
