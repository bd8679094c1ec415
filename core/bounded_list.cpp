#include "core/bounded_list.hpp"

#include "core/key_record.hpp"

namespace twincell {

std::optional<std::vector<double>> numbers_in(const ConfigSection& section, const std::string& key,
                                              std::size_t count, double lower, double upper) {
  const auto values = section.numbers(key, count);
  const Where where = section.where(key);
  record_key(where.key, {.item = {lower, upper}});
  if (values)
    for (const double value : *values) require_range(where, value, lower, upper);
  return values;
}

}  // namespace twincell
