#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "analysis/trajectory/error.hpp"
#include "sweep/store.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sweep {
namespace {

constexpr const char* kResult = R"({"id":"a","results":{"s_b":{"value":0.25}},"computed":{"seconds":1.5}})";

Point point() {
  Point p;
  p.id.push_back('a');
  return p;
}

TEST(SweepStore, AResultIsHeldAgainstItsSum) {
  const TemporaryFolder folder;
  const Store store(folder / "sweep");
  ASSERT_TRUE(store.claim(point()));
  store.keep(point(), kResult);
  const auto kept = store.result(point());
  ASSERT_TRUE(kept);
  auto document = nlohmann::json::parse(*kept);
  EXPECT_EQ(document["results"]["s_b"]["value"], 0.25);
  EXPECT_EQ(document["sha256"].get<std::string>().size(), 64U);

  const std::filesystem::path file = store.of(point()) / "result.json";
  document["results"]["s_b"]["value"] = 0.26;
  put_file(file, document.dump());
  EXPECT_THROW((void)store.result(point()), InputError);
  for (const char* damaged :
       {R"({"id":"a"})", R"({"id":7})", R"({"id":"a","results":3,"computed":{}})", "[]", "",
        R"({"id":"b","results":{},"computed":{}})", R"({"id":"a","results":{},"computed":1})"}) {
    put_file(file, damaged);
    EXPECT_THROW((void)store.result(point()), InputError) << damaged;
  }
  // Of a version without sums.
  put_file(file, kResult);
  EXPECT_TRUE(store.result(point()));
}

TEST(SweepStore, OnlyASweepsFolderIsWrittenInto) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "thesis");
  put_file(folder / "thesis/a.tex", "mine");
  EXPECT_THROW(Store(folder / "thesis"), ConfigError);
  EXPECT_FALSE(std::filesystem::exists(folder / "thesis/points"));
  const Store first(folder / "sweep");
  EXPECT_NO_THROW(Store(folder / "sweep"));
  EXPECT_NO_THROW(Store(folder / "thesis", Store::Access::read));
}

}  // namespace
}  // namespace twincell::sweep
