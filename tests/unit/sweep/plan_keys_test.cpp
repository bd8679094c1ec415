// The table of the keys of a plan against the reader.
#include "sweep/plan_keys.hpp"

#include "sweep/plan.hpp"
#include "tests/support/key_table_checks.hpp"

namespace twincell::sweep::plan_keys_test {
namespace {

TEST(PlanKeys, ExamplesAreReadAndWhatIsOutOfRangeIsRefused) {
  expect_examples_and_ranges(plan_keys());
}

TEST(PlanKeys, EveryKeyThatIsReadHasARow) {
  expect_a_row_for_every_query(plan_keys(), [](const std::string& key) { return key; });
  expect_a_row_for_every_query_in({"sweep/plan.cpp"}, plan_keys());
}

TEST(PlanKeys, StatedDefaultsChangeNothing) {
  const auto told = [](const Assignments& assignments) {
    std::string text = "scene.preset = \"fortini-huang-2015\"\n";
    for (const std::string& assignment : assignments) text += assignment + "\n";
    const Plan p = read_plan_text(text, "an example");
    return fmt::format("{} {} {} {} {} {}", p.seed, p.stop_early, p.seeds, p.search ? p.search->key : "",
                       p.search ? p.search->runs : 0, p.search ? p.search->batch : 0);
  };
  EXPECT_EQ(expect_defaults_change_nothing(plan_keys(), told), 6);
}

}  // namespace
}  // namespace twincell::sweep::plan_keys_test
