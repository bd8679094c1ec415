#include "core/json_view.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.hpp"

namespace twincell {

using nlohmann::json;

struct JsonView::Document {
  json root;
  std::string file, advice;
};

namespace {

std::string with_article(const json& value) {
  switch (value.type()) {
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return "a list";
    case json::value_t::string:
      return "a text";
    case json::value_t::boolean:
      return "true or false";
    case json::value_t::null:
      return "null";
    default:
      return "a number";
  }
}

}  // namespace

JsonView JsonView::parse(const std::string& text, const std::string& file, const std::string& advice) {
  auto document = std::make_shared<Document>(Document{json::parse(text, nullptr, false), file, advice});
  const JsonView all(document, document->root, {});
  if (document->root.is_discarded()) all.refuse("is not JSON");
  return all;
}

void JsonView::refuse(const std::string& complaint) const {
  const std::string& advice = document_->advice;
  throw InputError({.file = document_->file, .key = key_},
                   complaint + (advice.empty() ? "." : "; " + advice + "."));
}

void JsonView::require(bool fits, const char* wanted) const {
  if (!fits) refuse(fmt::format("is {}; {} is needed", with_article(*value_), wanted));
}

std::optional<JsonView> JsonView::find(const std::string& key) const {
  require(value_->is_object(), "an object");
  const auto at = value_->find(key);
  if (at == value_->end()) return std::nullopt;
  return JsonView(document_, *at, key_.empty() ? key : key_ + "." + key);
}

JsonView JsonView::at(const std::string& key) const {
  if (auto found = find(key)) return *found;
  JsonView(document_, *value_, key_.empty() ? key : key_ + "." + key).refuse("is missing");
}

std::vector<std::pair<std::string, JsonView>> JsonView::members() const {
  require(value_->is_object(), "an object");
  std::vector<std::pair<std::string, JsonView>> all;
  for (const auto& [key, value] : value_->items())
    all.emplace_back(key, JsonView(document_, value, key_.empty() ? key : key_ + "." + key));
  return all;
}

std::vector<JsonView> JsonView::elements() const {
  require(value_->is_array(), "a list");
  std::vector<JsonView> all;
  all.reserve(value_->size());
  for (const json& value : *value_)
    all.push_back(JsonView(document_, value, fmt::format("{}[{}]", key_, all.size())));
  return all;
}

std::vector<JsonView> JsonView::elements(std::size_t count) const {
  auto all = elements();
  if (all.size() != count) refuse(fmt::format("has {} values; {} are needed", all.size(), count));
  return all;
}

std::string JsonView::text() const {
  require(value_->is_string(), "a text");
  return value_->get<std::string>();
}

bool JsonView::boolean() const {
  require(value_->is_boolean(), "true or false");
  return value_->get<bool>();
}

double JsonView::number() const {
  require(value_->is_number(), "a number");
  return value_->get<double>();
}

double JsonView::number_or_nan() const {
  if (value_->is_null()) return std::numeric_limits<double>::quiet_NaN();
  return number();
}

std::int64_t JsonView::integer(std::int64_t lowest, std::int64_t highest) const {
  require(value_->is_number_integer(), "a whole number");
  // Above 2^63 - 1 the value is unsigned, and get<int64_t> would wrap.
  const bool fits = !value_->is_number_unsigned() ||
                    value_->get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  const auto n = fits ? value_->get<std::int64_t>() : 0;
  if (!fits || n < lowest || n > highest)
    refuse(fmt::format("is {}; the value must be {} to {}", value_->dump(), lowest, highest));
  return n;
}

double JsonView::number_in(double lowest, double highest) const {
  const double x = number();
  if (x < lowest || x > highest)
    refuse(fmt::format("is {:g}; the value must be {:g} to {:g}", x, lowest, highest));
  return x;
}

}  // namespace twincell
