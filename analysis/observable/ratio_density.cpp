#include "analysis/observable/ratio_density.hpp"

#include "analysis/observable/array_with_interval.hpp"

namespace twincell::analysis {

RatioDensity::RatioDensity(double range, double width)
    : width_(width), density_(static_cast<std::size_t>(range / width + 0.5)) {}

void RatioDensity::add(std::span<const double> values, double mean) {
  std::vector<double> counts(density_.size(), 0);
  for (const double value : values) {
    const double bin = value / mean / width_;
    if (bin >= 0 && bin < static_cast<double>(counts.size())) ++counts[static_cast<std::size_t>(bin)];
  }
  const auto n = static_cast<double>(values.size());
  for (std::size_t b = 0; b < counts.size(); ++b) density_[b].add(counts[b] / (n * width_));
}

std::vector<Result> RatioDensity::results(const std::string& name, const std::string& what,
                                          const std::string& which, const std::string& source,
                                          const std::string& none) const {
  std::vector<Result> all = array_with_interval(density_,
                                                {.name = name + "_density",
                                                 .unit = "1",
                                                 .n_of = "bins",
                                                 .convention = what + " over the mean of its frame; " + which,
                                                 .source = source},
                                                "frames", none);
  if (density_.front().n() == 0) {
    all.push_back(absent_result(name + "_ratio", none, source));
    return all;
  }
  std::vector<double> centres(density_.size());
  for (std::size_t b = 0; b < centres.size(); ++b) centres[b] = (static_cast<double>(b) + 0.5) * width_;
  all.push_back(array_of(centres,
                         {.name = name + "_ratio",
                          .unit = "1",
                          .n_of = "bins",
                          .convention = "centres of the bins",
                          .source = source},
                         none));
  return all;
}

}  // namespace twincell::analysis
