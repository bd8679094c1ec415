#include "core/json_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::json_view_test {
namespace {

const char* const kText = R"({"a": {"b": [1, {"c": "word"}, null]}, "yes": true, "n": 7, "x": -2.5,
                             "large": 18446744073709551615})";

TEST(JsonView, ReadsWhatIsThere) {
  const JsonView all = JsonView::parse(kText, "f.json");
  EXPECT_EQ(all.at("a").at("b").elements(3)[1].at("c").text(), "word");
  EXPECT_TRUE(std::isnan(all.at("a").at("b").elements()[2].number_or_nan()));
  EXPECT_TRUE(all.at("yes").boolean());
  EXPECT_EQ(all.at("n").integer(7, 7), 7);
  EXPECT_EQ(all.at("n").number(), 7);
  EXPECT_EQ(all.at("x").number_in(-2.5, -2.5), -2.5);
  EXPECT_EQ(all.members().size(), 5U);
  EXPECT_EQ(all.members().front().first, "a");
  EXPECT_FALSE(all.find("z"));
  // A view keeps the document that it is in.
  const JsonView inner = JsonView::parse(kText, "f.json").at("a");
  EXPECT_EQ(inner.at("b").elements().size(), 3U);
}

TEST(JsonView, NamesFileKeyAndAdvice) {
  const JsonView all = JsonView::parse(kText, "f.json", "remove it");
  const auto refused = [&](const std::string& sentence, auto use) {
    try {
      use();
      ADD_FAILURE() << "accepted: " << sentence;
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()), "f.json: " + sentence);
    }
  };
  refused("z: is missing; remove it.", [&] { (void)all.at("z"); });
  refused("a.z: is missing; remove it.", [&] { (void)all.at("a").at("z"); });
  refused("a.b[1].d: is missing; remove it.", [&] { (void)all.at("a").at("b").elements()[1].at("d"); });
  refused("n: is a number; an object is needed; remove it.", [&] { (void)all.at("n").at("z"); });
  refused("n: is a number; an object is needed; remove it.", [&] { (void)all.at("n").find("z"); });
  refused("n: is a number; an object is needed; remove it.", [&] { (void)all.at("n").members(); });
  refused("n: is a number; a list is needed; remove it.", [&] { (void)all.at("n").elements(); });
  refused("a.b: has 3 values; 2 are needed; remove it.", [&] { (void)all.at("a").at("b").elements(2); });
  refused("a: is an object; a text is needed; remove it.", [&] { (void)all.at("a").text(); });
  refused("a.b: is a list; a number is needed; remove it.", [&] { (void)all.at("a").at("b").number(); });
  refused("a.b[2]: is null; a number is needed; remove it.",
          [&] { (void)all.at("a").at("b").elements()[2].number(); });
  refused("yes: is true or false; a number is needed; remove it.",
          [&] { (void)all.at("yes").number_or_nan(); });
  refused("n: is a number; true or false is needed; remove it.", [&] { (void)all.at("n").boolean(); });
  refused("x: is a number; a whole number is needed; remove it.", [&] { (void)all.at("x").integer(-9, 9); });
  refused("n: is 7; the value must be 8 to 9; remove it.", [&] { (void)all.at("n").integer(8, 9); });
  refused("x: is -2.5; the value must be 0 to 1; remove it.", [&] { (void)all.at("x").number_in(0, 1); });
  // 2^64 - 1 is no int64; it must not wrap to -1.
  refused("large: is 18446744073709551615; the value must be -1 to 9223372036854775807; remove it.",
          [&] { (void)all.at("large").integer(-1); });
  for (const char* text : {"", "{", "{\"a\": 1e999}", "{\"a\": NaN}", "\xff", "[1] 2"})
    expect_refusal<InputError>([&] { (void)JsonView::parse(text, "f.json"); }, "f.json: is not JSON.");
  refused("is a number; an object is needed.", [&] { (void)JsonView::parse("3", "f.json").at("a"); });
}

}  // namespace
}  // namespace twincell::json_view_test
