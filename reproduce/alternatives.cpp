#include "reproduce/alternatives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace twincell::reproduce {

namespace {

/// Number of met targets, and the negative number of failed ones: the greater, the better.
std::pair<std::ptrdiff_t, std::ptrdiff_t> merit(const std::vector<Target>& targets) {
  const auto number = [&](auto is) { return std::count_if(targets.begin(), targets.end(), is); };
  return {
      number([](const Target& t) { return t.verdict == Verdict::pass || t.verdict == Verdict::consistent; }),
      -number([](const Target& t) { return t.verdict == Verdict::fail; })};
}

}  // namespace

std::size_t meets_most(const std::vector<Alternative>& all) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (merit(all[i].targets) > merit(all[best].targets)) best = i;
  return best;
}

std::vector<Target> stating_all(const std::vector<Alternative>& all, std::size_t counted) {
  std::vector<Target> targets = all[counted].targets;
  if (all.size() == 1) return targets;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    targets[k].measured.clear();
    for (const Alternative& a : all)
      targets[k].measured += fmt::format("{}{}: {}{}", targets[k].measured.empty() ? "" : "; ", a.name,
                                         a.targets[k].measured.empty() ? "" : a.targets[k].measured + ", ",
                                         word_of(a.targets[k].verdict));
  }
  return targets;
}

}  // namespace twincell::reproduce
