// Placeholders of a configuration: refused by name at every query, replaceable by an assignment.
#include "core/placeholder.hpp"

#include <gtest/gtest.h>

#include "core/config.hpp"
#include "tests/support/complaint.hpp"

namespace twincell::placeholder_test {
namespace {

const std::string kText =
    "[scale]\nsigma_mm = \"FILL IN: bead diameter in mm\"\n[drive]\ngamma = \"FILL IN: A omega^2/g\"\n";

TEST(Placeholder, EveryKindOfQueryNamesTheKeyTheLineAndTheOthers) {
  const Config config = Config::from_text(kText, "CELL.toml");
  const ConfigSection scale = config.root().section("scale");
  const auto refused = [](auto query) {
    expect_refusal<ConfigError>(query, "CELL.toml:2", "scale.sigma_mm",
                                "not filled in yet: bead diameter in mm", "as are drive.gamma");
  };
  refused([&] { (void)scale.number("sigma_mm"); });
  refused([&] { (void)scale.integer("sigma_mm"); });
  refused([&] { (void)scale.numbers("sigma_mm", 2); });
  refused([&] { (void)scale.boolean("sigma_mm"); });
  refused([&] { (void)scale.text("sigma_mm"); });
  refused([&] { (void)scale.word("sigma_mm", {"a", "b"}); });
}

TEST(Placeholder, AnAssignmentReplacesIt) {
  Config config = Config::from_text(kText, "CELL.toml");
  config.assign("scale.sigma_mm=2.5");
  EXPECT_DOUBLE_EQ(config.root().section("scale").number("sigma_mm").value(), 2.5);
}

TEST(Placeholder, OtherTextsAreNone) {
  const Config config = Config::from_text("from = \"FILL.toml\"\n", "a");
  EXPECT_EQ(config.root().text("from").value(), "FILL.toml");
}

}  // namespace
}  // namespace twincell::placeholder_test
