#include "twin/stated_strengths.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace twincell::twin {

namespace {

constexpr double kAlike = 1.08;  // ratio of two Gamma/A; strengths are often stated with two digits

double rate_of(const StackDrive& d) {
  return d.gamma / d.amplitude;
}

/// The drives with the smallest and the largest Gamma/A.
auto range_of(const std::vector<StackDrive>& drives) {
  return std::ranges::minmax_element(drives, {}, rate_of);
}

/// The strengths in the order of the stacks, as they would have to be for the largest to belong to the
/// largest amplitude. Empty if Gamma/A is not the same then either.
std::string order_of_amplitudes(std::vector<StackDrive> drives) {
  std::vector<double> gammas;
  for (const StackDrive& d : drives) gammas.push_back(d.gamma);
  std::ranges::sort(gammas);
  std::vector<StackDrive*> by_amplitude;
  for (StackDrive& d : drives) by_amplitude.push_back(&d);
  std::ranges::sort(by_amplitude, {}, &StackDrive::amplitude);
  for (std::size_t i = 0; i < gammas.size(); ++i) by_amplitude[i]->gamma = gammas[i];
  const auto [least, most] = range_of(drives);
  if (rate_of(*most) > kAlike * rate_of(*least)) return {};
  std::vector<std::string> ordered;
  for (const StackDrive& d : drives) ordered.push_back(fmt::format("{:g}", d.gamma));
  return fmt::format("{}", fmt::join(ordered, ","));
}

}  // namespace

std::string strengths_doubt(const std::vector<StackDrive>& drives) {
  std::vector<StackDrive> known;
  for (const StackDrive& d : drives)
    if (d.gamma > 0 && d.amplitude > 0 &&
        (known.empty() || d.frames_per_cycle == known.front().frames_per_cycle))
      known.push_back(d);
  if (known.size() < 2) return {};
  const auto [least, most] = range_of(known);
  if (rate_of(*most) <= kAlike * rate_of(*least)) return {};
  const std::string order = order_of_amplitudes(known);
  return fmt::format(
      "Gamma/A, which is omega^2/g and the same at one frequency, is {:.3g} in {} and {:.3g} in {}; if the "
      "frequency was not changed, a strength is wrong or belongs to another stack{}.",
      rate_of(*least), least->name, rate_of(*most), most->name,
      order.empty() ? "" : ": in the order " + order + " they agree with the amplitudes");
}

}  // namespace twincell::twin
