// The device kernels as code for graphics cards: complete, and with no operation that rounds differently from
// the processor's.

#include "sim/device/device_code.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "sim/device/device_kernel.hpp"
#include "sim/device/device_laws.hpp"

namespace twincell::sim::device_code_test {
namespace {

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

class DeviceCode : public testing::Test {
 protected:
  void SetUp() override {
    if (device_code().empty()) GTEST_SKIP() << "no clang++ for NVPTX was found when the program was built";
  }
};

TEST_F(DeviceCode, HasEveryKernelThatTheSolverAsksFor) {
  ASSERT_EQ(device_code().size(), static_cast<std::size_t>(DeviceLawSet::kCount));
  int kernels = 0;
  for (std::size_t normal = 0; normal < std::variant_size_v<NormalAxis>; ++normal)
    for (std::size_t tangential = 0; tangential < std::variant_size_v<TangentialAxis>; ++tangential)
      for (const int dimension : {2, 3})
        for (const Velocity velocity : {Velocity::half_step, Velocity::full_step}) {
          const auto kernel = find_device_kernel({dimension, normal, tangential, 0, velocity});
          if (!kernel) continue;
          ++kernels;
          const std::string text = device_code()[static_cast<std::size_t>(kernel->index / 4)];
          EXPECT_EQ(count(text, ".visible .entry " + kernel->name + "("), 1U) << kernel->name;
        }
  EXPECT_EQ(kernels, 4 * DeviceLawSet::kCount);
}

TEST_F(DeviceCode, EveryOperationIsCorrectlyRounded) {
  for (const std::string text : device_code()) {
    EXPECT_GT(count(text, "fma.rn.f64"), 100U);
    EXPECT_GT(count(text, "div.rn.f64"), 0U);
    // The assembler of the driver may fuse a product and a sum that do not state their rounding.
    EXPECT_FALSE(std::regex_search(text, std::regex(R"(\b(mul|add|sub|mad|fma|div|sqrt|rcp)\.f64)")));
    for (const char* inexact : {".approx", ".ftz", ".full.", ".f32", ".f16"})
      EXPECT_EQ(count(text, inexact), 0U) << inexact;
    EXPECT_EQ(count(text, ".extern"), 0U) << "calls a function that the card does not have";
  }
}

TEST_F(DeviceCode, ThreadsWaitForEachOther) {
  for (const std::string text : device_code()) EXPECT_GE(count(text, "bar."), 4U * 5U);
}

}  // namespace
}  // namespace twincell::sim::device_code_test
