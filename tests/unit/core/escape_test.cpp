// User strings embedded in other languages.

#include "core/escape.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

namespace twincell::escape_test {
namespace {

TEST(Escape, ControlCharactersAndBytesThatAreNoText) {
  EXPECT_EQ(one_line("two\nlines\t\x1b[1m\x7f"), "two lines  [1m ");
  EXPECT_EQ(one_line("caf\xc3\xa9 \xff\xc3"), "caf\xc3\xa9 \xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(one_line(""), "");
}

TEST(Escape, Html) {
  EXPECT_EQ(html_text("<img src='x' alt=\"&\">"), "&lt;img src=&#39;x&#39; alt=&quot;&amp;&quot;&gt;");
  EXPECT_EQ(html_text("\xff"), "\xEF\xBF\xBD");
}

TEST(Escape, Csv) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(csv_field("a\rb"), "\"a\rb\"");
}

// The shell itself shows how it parses a word.
TEST(Escape, ShellWordsAreOneWord) {
  EXPECT_EQ(shell_word("a/b-1.toml"), "a/b-1.toml");
  EXPECT_EQ(shell_word(""), "''");
  for (const std::string text :
       {"with space", "it's", "$(echo x)", "`echo x`", "a;b&c|d>e<f", "\"q\"", "$HOME", "*?[a]", "~", "#x",
        "\\", "two\nlines", "!x", "{a,b}", "\xff\xfe"}) {
    std::FILE* shell = ::popen(("printf %s " + shell_word(text)).c_str(), "r");  // NOLINT: that is the test
    ASSERT_NE(shell, nullptr);
    std::array<char, 100> said{};
    const std::size_t n = std::fread(said.data(), 1, said.size(), shell);
    ::pclose(shell);
    EXPECT_EQ(std::string(said.data(), n), text);
  }
}

}  // namespace
}  // namespace twincell::escape_test
