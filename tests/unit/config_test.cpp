// Lists in configurations.

#include "analysis/trajectory/config.hpp"

#include <gtest/gtest.h>

namespace twincell {
namespace {

std::string complaint(const std::string& value) {
  try {
    static_cast<void>(
        Config::from_text("[a]\nkey = " + value + "\n", "f.toml").root().section("a").pairs("key"));
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Config, ListsOfPairs) {
  const Config config = Config::from_text("points = [[0, 0.5], [2.5, 1]]\n", "f.toml");
  const auto points = config.root().pairs("points");
  ASSERT_TRUE(points);
  EXPECT_EQ(*points, (std::vector<std::pair<double, double>>{{0, 0.5}, {2.5, 1}}));
  EXPECT_FALSE(config.root().pairs("absent"));
  EXPECT_NO_THROW(config.refuse_unknown_keys());
  for (const char* bad : {"1", "[]", "[1, 2]", "[[1, 2], 3]", "[[1]]", "[[1, 2, 3]]", "[[1, \"2\"]]",
                          "[[1, nan]]", "[[inf, 1]]", "\"[[1, 2]]\""})
    EXPECT_EQ(complaint(bad), "f.toml:2:7: a.key: a list of pairs of numbers is needed, [[a, b], [c, d]].")
        << bad;
}

TEST(Config, NumbersOfAListAreFinite) {
  const Config config = Config::from_text("good = [1, 2.5]\nbad = [1, nan]\none = 1\n", "f.toml");
  EXPECT_EQ(config.root().numbers("good", 2), (std::vector<double>{1, 2.5}));
  EXPECT_THROW(static_cast<void>(config.root().numbers("good", 3)), ConfigError);
  EXPECT_THROW(static_cast<void>(config.root().numbers("bad", 2)), ConfigError);
  EXPECT_TRUE(config.root().is_list("good"));
  EXPECT_FALSE(config.root().is_list("one"));
  EXPECT_FALSE(config.root().is_list("absent"));
}

TEST(Config, AKeyStandsInItsTable) {
  const ConfigSection root = Config::from_text("[a]\nb = 1\n[a.c]\nd = 2\n", "f.toml").root();
  EXPECT_EQ(root.where("a.b").text(), "f.toml:2:5: a.b");
  EXPECT_EQ(root.where("a.c.d").text(), "f.toml:4:5: a.c.d");
  EXPECT_EQ(root.where("a.c.absent").text(), "f.toml:3:1: a.c.absent");
  EXPECT_EQ(root.where("absent.b").text(), "f.toml: absent.b");
}

}  // namespace
}  // namespace twincell
