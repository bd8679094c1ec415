#include "sim/device/device_kernel.hpp"

#include <fmt/format.h>

#include <string_view>
#include <type_traits>
#include <variant>

#include "sim/device/device_laws.hpp"

namespace twincell::sim {

namespace {

struct Row {
  std::string_view name, normal, tangential;
};
constexpr Row kRows[] = {
#define TWINCELL_ROW(name, normal, tangential) {#name, normal::kWord, tangential::kWord},
    TWINCELL_DEVICE_LAWS(TWINCELL_ROW)
#undef TWINCELL_ROW
};

/// The word of the law with this index in the list of its axis.
template <class Axis, std::size_t... kIndex>
std::string_view word_at(std::size_t index, std::index_sequence<kIndex...>) {
  constexpr std::string_view kWords[] = {std::variant_alternative_t<kIndex, Axis>::kWord...};
  return kWords[index];
}
template <class Axis>
std::string_view word_at(std::size_t index) {
  return word_at<Axis>(index, std::make_index_sequence<std::variant_size_v<Axis>>());
}

}  // namespace

std::optional<DeviceKernel> find_device_kernel(const KernelKey& key) {
  const std::string_view normal = word_at<NormalAxis>(key.normal),
                         tangential = word_at<TangentialAxis>(key.tangential),
                         rolling = word_at<RollingAxis>(key.rolling);
  // Beads that do not rotate have no rolling resistance.
  if (rolling != NoRolling::kWord && tangential != NoTangential::kWord) return std::nullopt;
  int index = 0;
  for (const Row& row : kRows) {
    if (row.normal == normal && row.tangential == tangential) {
      const bool space = key.dimension == 3, full = key.velocity == Velocity::full_step;
      return DeviceKernel{index + 2 * static_cast<int>(space) + static_cast<int>(full),
                          fmt::format("{}_{}d_{}", row.name, key.dimension, full ? "full" : "half")};
    }
    index += 4;
  }
  return std::nullopt;
}

std::string device_law_words() {
  std::string all;
  for (const Row& row : kRows)
    all += fmt::format("{}{} + {}", all.empty() ? "" : ", ", row.normal, row.tangential);
  return all;
}

}  // namespace twincell::sim
