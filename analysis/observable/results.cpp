#include "analysis/observable/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "core/hdf5.hpp"
#include "core/json_text.hpp"
#include "core/json_view.hpp"

namespace twincell::analysis {
namespace {

std::string value_text(const Result& r) {
  if (!r.text.empty()) return r.text;
  if (r.shape.empty()) return fmt::format("{:.6g}", r.value());
  double low = NAN, high = NAN;
  for (const double v : r.values) {
    low = std::fmin(low, v);
    high = std::fmax(high, v);
  }
  return fmt::format("{} values, {:.4g} to {:.4g}", fmt::join(r.shape, " x "), low, high);
}

std::string interval_text(const Result& r) {
  return r.interval ? fmt::format("[{:.6g}, {:.6g}]", r.interval->low, r.interval->high) : "-";
}

nlohmann::json to_json(const Result& r) {
  nlohmann::json j;
  j["source"] = r.source;
  if (!r.present()) {
    j["absent"] = r.absent;
    return j;
  }
  if (!r.text.empty()) {
    j["value"] = r.text;
  } else if (r.shape.empty()) {
    j["value"] = number_or_null(r.value());
  } else {
    j["value"] = nlohmann::json::array();
    for (const double v : r.values) j["value"].push_back(number_or_null(v));
    j["shape"] = r.shape;
  }
  if (!r.unit.empty()) j["unit"] = r.unit;
  j["n"] = r.n;
  j["n_of"] = r.n_of;
  j["convention"] = r.convention;
  if (r.interval)
    j["interval"] = {{"low", number_or_null(r.interval->low)},
                     {"high", number_or_null(r.interval->high)},
                     {"level", r.interval->level},
                     {"method", r.interval->method}};
  else if (!r.no_interval.empty())
    j["no_interval"] = r.no_interval;
  for (const double v : r.of_runs) j["runs"].push_back(number_or_null(v));
  return j;
}

/// Text for an HDF5 attribute, which is ASCII: every other byte becomes '?'.
std::string ascii(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c >= 128; }, '?');
  return text;
}

void write_result(hid_t results, const Result& r) {
  const h5::Handle group = h5::create_group(results, r.name);
  h5::write_attribute(group.get(), "source", ascii(r.source));
  if (!r.present()) {
    h5::write_attribute(group.get(), "absent", ascii(r.absent));
    return;
  }
  h5::write_attribute(group.get(), "unit", ascii(r.unit));
  h5::write_attribute(group.get(), "convention", ascii(r.convention));
  h5::write_attribute(group.get(), "n_of", r.n_of);
  h5::write_attribute(group.get(), "n", static_cast<int>(std::min<std::size_t>(r.n, 2147483647)));
  if (!r.text.empty()) {
    h5::write_text(group.get(), "value", r.text);
  } else if (r.shape.empty()) {
    h5::write_scalar(group.get(), "value", r.value());
  } else {
    h5::write_dataset(group.get(), "value", r.values.data(),
                      std::vector<hsize_t>(r.shape.begin(), r.shape.end()));
  }
  if (r.interval) {
    const double bounds[2] = {r.interval->low, r.interval->high};
    h5::write_dataset(group.get(), "interval", bounds, {2});
    h5::write_attribute(group.get(), "interval_method",
                        ascii(fmt::format("{:.0f} %, {}", 100 * r.interval->level, r.interval->method)));
  } else if (!r.no_interval.empty()) {
    h5::write_attribute(group.get(), "no_interval", ascii(r.no_interval));
  }
  if (!r.of_runs.empty()) h5::write_dataset(group.get(), "runs", r.of_runs.data(), {r.of_runs.size()});
}

/// Text of an optional member; empty if it is absent.
std::string text_of(const JsonView& object, const char* key) {
  const auto member = object.find(key);
  return member ? member->text() : std::string();
}

std::vector<double> numbers_of(const JsonView& list) {
  std::vector<double> values;
  for (const JsonView& v : list.elements()) values.push_back(v.number_or_nan());
  return values;
}

std::vector<std::size_t> shape_of(const JsonView& list, std::size_t count) {
  std::vector<std::size_t> shape;
  std::size_t product = 1;
  for (const JsonView& extent : list.elements()) {
    shape.push_back(static_cast<std::size_t>(extent.integer(0, 1LL << 31)));
    if (shape.size() > 8 || (product *= std::max<std::size_t>(shape.back(), 1)) > (std::size_t{1} << 31))
      list.refuse("is the shape of more values than any result has");
  }
  std::size_t values = 1;
  for (const std::size_t extent : shape) values *= extent;
  if (shape.empty() || values != count)
    list.refuse(
        fmt::format("is the shape of {} values, but the result has {}", shape.empty() ? 1 : values, count));
  return shape;
}

Result from_json(const std::string& name, const JsonView& j) {
  if (const auto why = j.find("absent")) {
    if (why->text().empty()) why->refuse("is empty; a reason is needed");
    return absent_result(name, why->text(), text_of(j, "source"));
  }
  const JsonView value = j.at("value");
  const auto n = j.find("n");
  Result r{.name = name,
           .unit = text_of(j, "unit"),
           .n = n ? static_cast<std::size_t>(n->integer(0)) : 0,
           .n_of = text_of(j, "n_of"),
           .no_interval = text_of(j, "no_interval"),
           .convention = text_of(j, "convention"),
           .source = text_of(j, "source")};
  if (value.value().is_string()) {
    r.text = value.text();
    if (r.text.empty()) value.refuse("is empty; a word is needed");
  } else if (value.value().is_array()) {
    r.values = numbers_of(value);
    r.shape = shape_of(j.at("shape"), r.values.size());
  } else {
    r.values = {value.number_or_nan()};
  }
  if (const auto interval = j.find("interval")) {
    const auto level = interval->find("level");
    r.interval = Interval{interval->at("low").number_or_nan(), interval->at("high").number_or_nan(),
                          level ? level->number_in(0, 1) : 0.95, text_of(*interval, "method")};
  }
  if (const auto runs = j.find("runs")) r.of_runs = numbers_of(*runs);
  return r;
}

}  // namespace

std::string results_text(const std::vector<Result>& results) {
  std::size_t name_width = 6, value_width = 5, interval_width = 12;
  for (const Result& r : results) {
    name_width = std::max(name_width, r.name.size());
    if (!r.present()) continue;
    value_width = std::max(value_width, value_text(r).size());
    interval_width = std::max(interval_width, interval_text(r).size());
  }
  std::string text = fmt::format("{:<{}}  {:<{}}  {:<{}}  {:<9}  count\n", "result", name_width, "value",
                                 value_width, "95 % interval", interval_width, "unit");
  for (const Result& r : results) {
    if (!r.present()) {
      text += fmt::format("{:<{}}  absent: {}\n", r.name, name_width, r.absent);
      continue;
    }
    text += fmt::format("{:<{}}  {:<{}}  {:<{}}  {:<9}  {} {}\n", r.name, name_width, value_text(r),
                        value_width, interval_text(r), interval_width, r.unit, r.n, r.n_of);
  }
  text += "\nHow each result is computed\n";
  for (const Result& r : results) {
    if (!r.present()) continue;
    text += fmt::format("  {}: {}", r.name, r.convention);
    if (r.interval) text += fmt::format("; interval: {}", r.interval->method);
    if (!r.interval && !r.no_interval.empty()) text += fmt::format("; no interval: {}", r.no_interval);
    text += fmt::format(" ({})\n", r.source);
  }
  return text;
}

std::string results_json(const std::vector<Result>& results) {
  nlohmann::json document = nlohmann::json::object();
  for (const Result& r : results) document[r.name] = to_json(r);
  return json_text(document);
}

std::vector<Result> results_from_json(const JsonView& document) {
  std::vector<Result> results;
  for (const auto& [name, j] : document.members()) results.push_back(from_json(name, j));
  return results;
}

void write_results(const std::filesystem::path& path, const std::vector<Result>& results,
                   const std::string& provenance_json) {
  AtomicPath output(path, Product::results());
  h5::quiet();
  {
    const h5::Handle file = h5::own(H5Fcreate(output.part().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                                    "Creating " + path.string());
    const h5::Handle group = h5::create_group(file.get(), "results");
    for (const Result& r : results) write_result(group.get(), r);
    h5::write_text(file.get(), "provenance", provenance_json);
    h5::check(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), "Writing " + path.string());
  }
  output.commit();
}

}  // namespace twincell::analysis
