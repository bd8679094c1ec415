// Lists in configurations.

#include "core/config.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "core/atomic_file.hpp"
#include "core/toml_leaves.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::config_test {
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

TEST(Config, ADecimalCommaIsNamed) {
  const auto said = [](const std::string& line) -> std::string {
    try {
      (void)Config::from_text("[a]\n" + line + "\n", "f.toml").root().section("a").number("key");
    } catch (const ConfigError& e) {
      return e.what();
    }
    return "accepted";
  };
  constexpr const char* kHint = "; a decimal number is written with a point: -1.5.";
  for (const char* line : {"key = -1,5", "key = -1,5  # g", "key = \"-1,5\"", "key = [-1,5]", "\tkey=-1,5"})
    EXPECT_TRUE(said(line).ends_with(kHint)) << line << ": " << said(line);
  for (const char* line :
       {"key = 1,", "key = -1,5,2", "key = \"-1,5", "key = [-1,-5]", "key = -1,5 m", "key # = -1,5"})
    EXPECT_EQ(said(line).find("with a point"), std::string::npos) << line << ": " << said(line);
  EXPECT_NE(said("key = 1,5" + std::string(1000000, ' ')), "accepted");
}

TEST(Config, AKeyStandsInItsTable) {
  const ConfigSection root = Config::from_text("[a]\nb = 1\n[a.c]\nd = 2\n", "f.toml").root();
  EXPECT_EQ(root.where("a.b").text(), "f.toml:2:5: a.b");
  EXPECT_EQ(root.where("a.c.d").text(), "f.toml:4:5: a.c.d");
  EXPECT_EQ(root.where("a.c.absent").text(), "f.toml:3:1: a.c.absent");
  EXPECT_EQ(root.where("absent.b").text(), "f.toml: absent.b");
}

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(Config::from_text(text, "f.toml"));
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "accepted";
}
std::string repeated(const std::string& piece, int n) {
  std::string all;
  for (int k = 0; k < n; ++k) all += piece;
  return all;
}

// At a depth of some thousands the parser would exhaust the stack.
TEST(Config, WholeNumbersAreWrittenInDecimalDigits) {
  const std::vector<TomlLeaf> leaves = toml_leaves("[axes]\nstart.seed = [1, 0x3C, 0b1]\nmu = 0.5\n", "axes");
  ASSERT_EQ(leaves.size(), 2U);
  for (const TomlLeaf& leaf : leaves)
    EXPECT_EQ(leaf.items, leaf.path == "mu" ? std::vector<std::string>{"0.5"}
                                            : (std::vector<std::string>{"1", "60", "1"}));
}

TEST(Config, DepthIsBounded) {
  constexpr int kMany = 50'000;
  const std::string deep = "tables and lists are nested more than 100 levels deep.";
  for (const std::string& text :
       {repeated("a.", kMany) + "a = 1\n", "\n\n[" + repeated("a.", kMany) + "a]\n",
        "[[" + repeated("a.", kMany) + "a]]\n", "a = " + repeated("[", kMany) + repeated("]", kMany) + "\n",
        "a = " + repeated("{a = ", kMany) + "1" + repeated("}", kMany) + "\n",
        "a = " + repeated("{a.a.a.a.a = ", 25) + "1" + repeated("}", 25) + "\n",
        "[" + repeated("a.", 60) + "a]\n" + repeated("a.", 60) + "a = 1\n",
        "b = '''\n'''\n" + repeated("a.", kMany) + "a = 1\n",
        "a = \"\\\"\"\nb = ''''x'''''\n" + repeated("'.'.", kMany) + "a = 1\n"})
    EXPECT_NE(refusal(text).find(deep), std::string::npos) << text.substr(0, 40) << ": " << refusal(text);
  EXPECT_EQ(refusal(repeated("a.", kMany) + "a = 1\n"), "f.toml:1: " + deep);
  // Dots that do not add depth.
  for (const std::string& text :
       {repeated("a.", 90) + "a = 1.5\n", "a = \"" + repeated("[{.", 999) + "\"\n",
        "a = 1 # " + repeated("[.", 999) + "\n", "a = [" + repeated("1.5, ", 999) + "]\n",
        "a = \"\"\"" + repeated(".\n", 999) + "\"\"\"\n", "a = '" + repeated(".", 999) + "'\nb = 1.5\n"})
    EXPECT_EQ(refusal(text), "accepted") << text.substr(0, 40);
  std::string lines;
  for (int k = 0; k < 999; ++k)
    lines.append("a").append(std::to_string(k)).append(".b = [1.5, {c.d = 2.5}]\n");
  EXPECT_EQ(refusal(lines), "accepted");
}

TEST(Config, SizeIsBounded) {
  EXPECT_NE(refusal("#" + std::string(kLargestConfig, ' ')).find("that a configuration may have"),
            std::string::npos);
}

// A file that is not a regular file may never end.
TEST(Config, OnlyRegularFilesAreRead) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe", file = folder / "file", absent = folder / "absent";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto said = [](const std::string& path, std::uintmax_t most = kLargestText) {
    try {
      return "read " + read_text_file(path, most);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
  };
  for (const std::string& path : {pipe, std::string("/dev/zero"), std::string("/dev/null")})
    EXPECT_EQ(said(path), path + ": this is a device, a pipe or a socket; a regular file is needed.");
  EXPECT_EQ(said("/"), "/: this is a folder; a file is needed.");
  EXPECT_EQ(said(absent), absent + ": the file does not exist.");
  std::ofstream(file) << "1234567";
  EXPECT_EQ(said(file), "read 1234567");
  EXPECT_EQ(said(file, 7), "read 1234567");
  EXPECT_NE(said(file, 6).find("larger than the 6 bytes"), std::string::npos);
}

TEST(Config, WholeNumbersAreComparedAsSuch) {
  const auto root = Config::from_text("a = 9007199254740993\n", "f.toml").root();
  EXPECT_THROW(static_cast<void>(root.integer_in("a", 0, std::int64_t{1} << 53)), ConfigError);
  EXPECT_EQ(root.integer_in("a", 0, (std::int64_t{1} << 53) + 1), 9007199254740993);
}

TEST(Config, KeysAreGivenOnceAndByTheirOwnName) {
  EXPECT_NE(refusal("a = 1\na = 2\n").find("f.toml:2"), std::string::npos);
  EXPECT_NE(refusal("[a]\nb = 1\n[a]\nc = 2\n").find("f.toml:3"), std::string::npos);
  const Config quoted = Config::from_text("\"a.b\" = 1\n", "f.toml");
  static_cast<void>(quoted.root().section("a").number("b"));
  expect_refusal<ConfigError>(
      [&] { quoted.refuse_unknown_keys(); },
      "f.toml:1:9: a.b: is a name in quotes, in which a point does not separate table and key");
}

}  // namespace
}  // namespace twincell::config_test
