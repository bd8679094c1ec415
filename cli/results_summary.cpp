#include "cli/results_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/plural.hpp"

namespace twincell::cli {

namespace {

/// The number, or the count and the extremes of a list.
std::string value_text(const analysis::Result& r) {
  if (r.shape.empty()) return fmt::format("{:.6g}", r.value());
  std::vector<double> finite;
  std::copy_if(r.values.begin(), r.values.end(), std::back_inserter(finite),
               [](double x) { return std::isfinite(x); });
  if (finite.empty()) return fmt::format("{} values", r.values.size());
  const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
  return fmt::format("{} values, {:.4g} to {:.4g}", r.values.size(), *low, *high);
}

std::string row(const analysis::Result& r) {
  if (!r.present()) return fmt::format("{:<25} absent: {}\n", r.name, r.absent);
  const std::string interval =
      r.interval ? fmt::format("[{:.6g}, {:.6g}]", r.interval->low, r.interval->high) : "-";
  const std::string unit = fmt::format("{:<15} {} {}\n", r.unit, r.n, r.n_of);
  return r.shape.empty() ? fmt::format("{:<25} {:<13} {:<26} {}", r.name, value_text(r), interval, unit)
                         : fmt::format("{:<25} {:<40} {}", r.name, value_text(r), unit);
}

}  // namespace

std::string results_summary(const std::vector<analysis::Result>& results, bool requested) {
  constexpr const char* kVerdict = "phase";  // printed first
  std::string text, other_words, rows;
  std::size_t numbers = 0, lists = 0, absent = 0;
  for (const analysis::Result& r : results) {
    const bool present = r.present(), scalar = r.shape.empty();
    if (present && !r.text.empty())
      (r.name == kVerdict ? text : other_words) += fmt::format("{}: {} ({})\n", r.name, r.text, r.convention);
    else if (requested || (present && scalar && analysis::named_result(r.name).main))
      rows += row(r);
    else
      ++(!present ? absent : scalar ? numbers : lists);
  }
  text += other_words;
  if (!rows.empty())
    text +=
        fmt::format("{:<25} {:<13} {:<26} {:<15} from\n", "result", "value", "95 % interval", "unit") + rows;
  if (numbers + lists + absent > 0)
    text += fmt::format("not printed: {}, {}, {} absent; -v prints them, and how each is computed\n",
                        plural(numbers, "number"), plural(lists, "list"), absent);
  return text;
}

}  // namespace twincell::cli
