#include "imaging/link/min_cut.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace twincell::min_cut_test {

using namespace imaging;

TEST(MinCut, IsTheCheapestOfAllChoices) {
  // Against all 2^8 choices.
  constexpr std::size_t kNodes = 8;
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> cost(-3, 3);
  std::uniform_int_distribution<std::size_t> node(0, kNodes - 1);
  for (int problem = 0; problem < 200; ++problem) {
    struct Two {
      std::size_t stays, moves;
      double cost;
    };
    std::vector<double> one(kNodes);
    std::vector<Two> two;
    MinCut cut(kNodes);
    for (std::size_t v = 0; v < kNodes; ++v) cut.move(v, one[v] = cost(generator));
    for (int e = 0; e < 16; ++e) {
      two.push_back({node(generator), node(generator), std::abs(cost(generator))});
      if (two.back().stays == two.back().moves) continue;
      cut.stay_and_move(two.back().stays, two.back().moves, two.back().cost);
    }
    auto total = [&](auto moves) {
      double sum = 0;
      for (std::size_t v = 0; v < kNodes; ++v) sum += moves(v) ? one[v] : 0;
      for (const Two& t : two) sum += !moves(t.stays) && moves(t.moves) ? t.cost : 0;
      return sum;
    };
    double least = 0;
    for (unsigned choice = 0; choice < 1U << kNodes; ++choice)
      least = std::min(least, total([&](std::size_t v) { return (choice >> v & 1U) != 0; }));
    const std::vector<std::uint8_t> found = cut.solve();
    EXPECT_NEAR(total([&](std::size_t v) { return found[v] != 0; }), least, 1e-9);
  }
}

TEST(MinCut, AmongEqualCutsTheLargestIsTaken) {
  EXPECT_TRUE(MinCut(0).solve().empty());
  MinCut cut(3);
  cut.move(1, 0);
  cut.move(2, -1);
  cut.stay_and_move(1, 2, 2);  // node 2 gains by moving only if node 1 moves too, which costs nothing
  EXPECT_EQ(cut.solve(), (std::vector<std::uint8_t>{1, 1, 1}));
}

}  // namespace twincell::min_cut_test
