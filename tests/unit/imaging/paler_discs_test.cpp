// Which pale candidates may be discs of another darkness.
#include "imaging/refine/paler_discs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace twincell::imaging::paler_discs_test {
namespace {

Detection at(double x, double y, Verdict verdict = Verdict::bead, double darkness = 0.38) {
  Detection d;
  d.x = x, d.y = y, d.radius = 10, d.verdict = verdict, d.darkness = darkness;
  return d;
}

TEST(PalerDiscs, NeedTheRoomOfADiscAndCountOnce) {
  // A triangle of beads in contact; its gap is 1.15 R from their centres.
  const std::vector<Detection> beads = {at(0, 0), at(20, 0), at(10, std::sqrt(300.0))};
  const std::vector<Detection> dropped = {at(10, std::sqrt(300.0) / 3, Verdict::pale),
                                          at(10, -17.3, Verdict::pale), at(11, -18, Verdict::pale),
                                          at(40, 0, Verdict::pale), at(60, 0, Verdict::unexplained)};
  const std::vector<Detection> paler = paler_discs(beads, dropped);
  ASSERT_EQ(paler.size(), 2U);
  EXPECT_EQ(paler[0].y, -17.3);
  EXPECT_EQ(paler[1].x, 40);
}

TEST(PalerDiscs, HaveOneDarkness) {
  const auto row = [](const std::vector<double>& darkness) {
    std::vector<Detection> dropped;
    for (const double d : darkness)
      dropped.push_back(at(20.0 * static_cast<double>(dropped.size()), 0, Verdict::pale, d));
    return paler_discs({}, dropped).size();
  };
  EXPECT_EQ(row({0.36, 0.37, 0.375, 0.38, 0.36}), 5U);
  EXPECT_EQ(row({0.36, 0.37, 0.375, 0.38, 0.1}), 5U) << "one mark hides no tracers";
  EXPECT_EQ(row({0.13, 0.19, 0.25, 0.32, 0.39}), 0U);
}

}  // namespace
}  // namespace twincell::imaging::paler_discs_test
