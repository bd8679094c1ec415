#include "core/memory_bandwidth.hpp"

#include <gtest/gtest.h>

namespace twincell::memory_bandwidth_test {
namespace {

// Between a tenth of one DDR2 channel, for machines that do much else, and more than any machine has.
TEST(MemoryBandwidth, IsPhysicallyPlausible) {
  for (const int threads : {1, 2, 3}) {
    const std::optional<double> found = memory_bandwidth(threads);
    if (!found) GTEST_SKIP() << "less than 512 MB are free";
    EXPECT_GT(*found, 5e8) << threads;
    EXPECT_LT(*found, 1e13) << threads;
  }
}

}  // namespace
}  // namespace twincell::memory_bandwidth_test
