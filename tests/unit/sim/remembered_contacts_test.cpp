#include "sim/stepping/remembered_contacts.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace twincell::sim::remembered_contacts_test {
namespace {

struct Contact {
  std::int32_t i, j;
  double first, second;
};

RememberedContacts of(const std::vector<Contact>& contacts, std::size_t beads) {
  return {beads, 2, [&](auto visit) {
            for (const Contact& c : contacts)
              visit(c.i, c.j, [&](std::size_t m) { return m == 0 ? c.first : c.second; });
          }};
}

TEST(RememberedContacts, EachContactIsFoundWithItsNumbers) {
  // In no order; -1 and -2 are walls 0 and 1.
  const RememberedContacts all = of(
      {{3, 4, 10, 11}, {0, 2, 20, 21}, {3, -1, 30, 31}, {0, 1, 40, 41}, {4, -2, 50, 51}, {0, -1, 60, 61}}, 5);
  EXPECT_FALSE(all.empty());
  const auto numbers = [&](std::int32_t i, std::int32_t j) {
    const double* at = all.find(i, j);
    return at == nullptr ? std::vector<double>{} : std::vector<double>{at[0], at[1]};
  };
  EXPECT_EQ(numbers(3, 4), (std::vector<double>{10, 11}));
  EXPECT_EQ(numbers(0, 2), (std::vector<double>{20, 21}));
  EXPECT_EQ(numbers(0, 1), (std::vector<double>{40, 41}));
  EXPECT_EQ(numbers(1, 2), std::vector<double>{});
  EXPECT_EQ(numbers(4, 3), std::vector<double>{});

  std::map<std::int32_t, double> wall[3];
  for (const std::size_t w : {0U, 1U, 2U})
    all.at_wall(w, [&](std::int32_t bead, const double* at) { wall[w][bead] = at[1]; });
  EXPECT_EQ(wall[0], (std::map<std::int32_t, double>{{0, 61}, {3, 31}}));
  EXPECT_EQ(wall[1], (std::map<std::int32_t, double>{{4, 51}}));
  EXPECT_TRUE(wall[2].empty());
}

TEST(RememberedContacts, NoneAreRemembered) {
  const RememberedContacts none = of({}, 3);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.find(2, 3), nullptr);
  EXPECT_TRUE(of({}, 0).empty());
}

}  // namespace
}  // namespace twincell::sim::remembered_contacts_test
