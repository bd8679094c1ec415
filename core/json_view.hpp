#pragma once
/// \file
/// Checked reading of JSON that comes from a file. nlohmann's `operator[]` on a constant object is undefined
/// for a missing key, and its exceptions name no file. Use this for all JSON that a user can edit.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace twincell {

/// A value inside a JSON document. Every getter throws InputError "FILE: points[3].axes: is missing." for a
/// missing key or a value of another type. The views of a document share it, so that it lives as long as
/// they.
class JsonView {
 public:
  /// \param file name of the file in messages
  /// \param advice what the user can do about a damaged file, added to each message after a semicolon
  /// \throws InputError if the text is not JSON
  static JsonView parse(const std::string& text, const std::string& file, const std::string& advice = {});

  /// Member `key` of an object.
  [[nodiscard]] JsonView at(const std::string& key) const;
  /// Member `key` of an object; nullopt if it is absent.
  [[nodiscard]] std::optional<JsonView> find(const std::string& key) const;
  /// Whether an object has the member `key`.
  [[nodiscard]] bool has(const std::string& key) const { return find(key).has_value(); }
  /// Members of an object, sorted by key.
  [[nodiscard]] std::vector<std::pair<std::string, JsonView>> members() const;
  /// Elements of an array.
  [[nodiscard]] std::vector<JsonView> elements() const;
  /// Elements of an array of exactly `count`.
  [[nodiscard]] std::vector<JsonView> elements(std::size_t count) const;

  /// The value as a text.
  /// \throws InputError, as all of these, if it has another type or is out of range
  [[nodiscard]] std::string text() const;
  /// true or false.
  [[nodiscard]] bool boolean() const;
  /// A finite number.
  [[nodiscard]] double number() const;
  /// A number, or NaN for null, which is how JSON holds a number that is not finite.
  [[nodiscard]] double number_or_nan() const;
  /// A whole number in [lowest, highest].
  [[nodiscard]] std::int64_t integer(std::int64_t lowest, std::int64_t highest = INT64_MAX) const;
  /// A number in [lowest, highest].
  [[nodiscard]] double number_in(double lowest, double highest) const;

  /// The value itself.
  [[nodiscard]] const nlohmann::json& value() const { return *value_; }
  /// Path of the value in the document, "points[3].axes"; empty for the document.
  [[nodiscard]] const std::string& key() const { return key_; }
  /// \throws InputError with file, key, complaint and advice.
  /// \param complaint without a full stop
  [[noreturn]] void refuse(const std::string& complaint) const;

 private:
  struct Document;
  JsonView(std::shared_ptr<const Document> document, const nlohmann::json& value, std::string key)
      : document_(std::move(document)), value_(&value), key_(std::move(key)) {}
  void require(bool fits, const char* wanted) const;

  std::shared_ptr<const Document> document_;
  const nlohmann::json* value_;
  std::string key_;
};

}  // namespace twincell
