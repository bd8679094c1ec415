// Convection rolls: the stream function against a closed form, and the count of rolls in flows of known rolls
// with noise.
#include "analysis/motion/rolls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "analysis/motion/convection_field.hpp"
#include "tests/support/validation.hpp"

namespace twincell::analysis::rolls_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kColumns = 10;

/// Blocks of a flow in 10 x `rows` cells: `m` rolls side by side in `floors` layers, with alternating senses
/// of rotation, maximum speed `speed`, and noise that doubles towards the surface.
CirculationBlocks blocks_of(int m, int floors, double speed, double noise, std::size_t rows,
                            std::size_t blocks, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  CirculationBlocks made;
  for (std::size_t b = 0; b < blocks; ++b) {
    DisplacementField field{.columns = kColumns, .rows = rows};
    const double kx = m * kPi / kColumns, kz = floors * kPi / static_cast<double>(rows),
                 k = std::max({kx, kz, 1e-9});
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < kColumns; ++c) {
        const double x = kx * (static_cast<double>(c) + 0.5), z = kz * (static_cast<double>(r) + 0.5);
        const double shaken = noise * (0.7 + 0.7 * static_cast<double>(r) / static_cast<double>(rows));
        field.ux.push_back(speed * kz / k * std::sin(x) * std::cos(z) + shaken * normal(generator));
        field.uz.push_back(-speed * kx / k * std::cos(x) * std::sin(z) + shaken * normal(generator));
      }
    const Circulation circulation = circulation_of(field);
    made.columns = circulation.columns;
    made.blocks.push_back(circulation.plaquettes);
  }
  return made;
}

}  // namespace

TEST(Rolls, StreamFunctionOfAnEigenvector) {
  // psi = sin(pi m (c + 1)/(C + 1)) sin(pi n (r + 1)/(R + 1)) is an eigenvector of the grid's Laplacian.
  const std::size_t columns = 7, rows = 4;
  std::vector<double> psi, circulation;
  const double a = 3 * kPi / 8, b = 2 * kPi / 5;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) {
      psi.push_back(std::sin(a * static_cast<double>(c + 1)) * std::sin(b * static_cast<double>(r + 1)));
      circulation.push_back((4 - 2 * std::cos(a) - 2 * std::cos(b)) * psi.back());
    }
  const std::vector<double> solved = stream_function(circulation, columns, false);
  double worst = 0;
  for (std::size_t i = 0; i < psi.size(); ++i) worst = std::max(worst, std::abs(solved[i] - psi[i]));
  test::validate({"V5.14", "stream function of an eigenvector of the grid", 0, 1e-14, "closed form"}, worst);

  // A single loop surrounded by holes: 4 psi = C.
  std::vector<double> alone(15, std::nan(""));
  alone[7] = 2;
  EXPECT_DOUBLE_EQ(stream_function(alone, 5, false)[7], 0.5);
  EXPECT_TRUE(std::isnan(stream_function(alone, 5, false)[6]));
  // Periodic: the same for every column, as if the grid were infinite.
  const std::vector<double> ring = stream_function(std::vector<double>(6, 1.0), 6, true);
  for (const double p : ring) EXPECT_NEAR(p, 0.5, 1e-14);  // 4 p - 2 p = 1
}

TEST(Rolls, FalseAlarmsAreAsManyAsStated) {
  std::mt19937_64 generator(3);
  // Six blocks have 64 signs: 2/64 is the largest rate that does not exceed the stated one.
  for (const auto& [blocks, rate] : {std::pair<std::size_t, double>{6, 2.0 / 64}, {15, kRollFalseAlarm}}) {
    const int trials = 600;
    int alarms = 0;
    for (int t = 0; t < trials; ++t)
      alarms += count_rolls(blocks_of(0, 0, 0, 0.3, 12, blocks, generator), 0) > 0 ? 1 : 0;
    test::validate(
        {"V5.14", "share of beds without flow that show a roll, " + std::to_string(blocks) + " blocks", rate,
         0.022, "signs of blocks are exchangeable"},
        static_cast<double>(alarms) / trials);
  }
}

TEST(Rolls, KnownRollsInNoiseAreCounted) {
  std::mt19937_64 generator(4);
  struct Case {
    int m, floors;
  };
  for (const Case c : {Case{1, 1}, Case{2, 1}, Case{4, 1}, Case{2, 2}}) {
    int right = 0, few = 0, many = 0;
    const int trials = 40;
    for (int t = 0; t < trials; ++t) {
      // The noise in a cell equals the maximum flow speed, so no single block shows the rolls.
      const auto rolls =
          static_cast<int>(count_rolls(blocks_of(c.m, c.floors, 0.3, 0.3, 12, 20, generator), 0));
      right += rolls == c.m * c.floors ? 1 : 0;
      few += rolls < c.m * c.floors ? 1 : 0;
      many += rolls > c.m * c.floors ? 1 : 0;
    }
    EXPECT_GE(right, 0.85 * trials) << c.m << " x " << c.floors << ": " << few << " too few, " << many
                                    << " too many";
  }
}

TEST(Rolls, WeakRollsAreLeftOut) {
  std::mt19937_64 generator(5);
  const CirculationBlocks blocks = blocks_of(2, 1, 0.1, 0.01, 12, 10, generator);
  EXPECT_EQ(count_rolls(blocks, 0), 2U);
  EXPECT_EQ(count_rolls(blocks, 1e3), 0U);
}

}  // namespace twincell::analysis::rolls_test
