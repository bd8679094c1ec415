#include "imaging/stack/formats/frame_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "core/median.hpp"
#include "core/plural.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging::frames {
namespace {

using Number = std::int64_t;

constexpr std::size_t kMinPictures = 2;  // of a series

struct Numbered {
  Number number;
  std::string name;
};

/// The last number in a name, with what precedes it, and the sign between the two, if there is one.
struct Parts {
  std::string series;
  char sign = 0;
  Number number = 0;
};

/// Nothing for a name without a number, or with one of more than 18 digits.
std::optional<Parts> parts_of(const std::string& name) {
  constexpr const char* kDigits = "0123456789";
  constexpr std::size_t kMaxDigits = 18;
  const std::string stem = std::filesystem::path(name).stem().string();
  const std::size_t last = stem.find_last_of(kDigits);
  if (last == std::string::npos) return std::nullopt;
  const std::size_t before = stem.find_last_not_of(kDigits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  if (last + 1 - first > kMaxDigits) return std::nullopt;
  Parts parts;
  std::from_chars(stem.data() + first, stem.data() + last + 1, parts.number);
  const bool has_sign = first > 0 && (stem[first - 1] == '+' || stem[first - 1] == '-');
  if (has_sign) parts.sign = stem[first - 1];
  parts.series = stem.substr(0, first - (has_sign ? 1 : 0));
  return parts;
}

/// Whether the numbers of all names have signs, and both occur in one series: cameras with a trigger in the
/// middle of a recording count so. A '-' alone separates a name from its number.
bool have_signs(const std::vector<std::string>& names) {
  std::map<std::string, std::set<char>> signs;
  for (const std::string& name : names) {
    const auto parts = parts_of(name);
    if (!parts || parts->sign == 0) return false;
    signs[parts->series].insert(parts->sign);
  }
  return !signs.empty() && std::ranges::all_of(signs, [](const auto& s) { return s.second.size() == 2; });
}

/// The numbered pictures of each series.
std::map<std::string, std::vector<Numbered>> series_of(const std::vector<std::string>& names) {
  const bool with_signs = have_signs(names);
  std::map<std::string, std::vector<Numbered>> series;
  for (const std::string& name : names) {
    const auto parts = parts_of(name);
    if (!parts) continue;
    if (with_signs)
      series[parts->series].push_back({parts->sign == '-' ? -parts->number : parts->number, name});
    else
      series[parts->series + (parts->sign != 0 ? std::string(1, parts->sign) : std::string())].push_back(
          {parts->number, name});
  }
  return series;
}

/// "7 and 30 to 39": the numbers that are skipped, the first few ranges.
std::string skipped_numbers(const std::vector<Numbered>& pictures, Number step) {
  constexpr std::size_t kMaxRanges = 4;
  std::vector<std::string> ranges;
  std::size_t more = 0;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    const Number first = pictures[i - 1].number + step, last = pictures[i].number - step;
    if (first > last) continue;
    if (ranges.size() == kMaxRanges)
      ++more;
    else
      ranges.push_back(first == last ? fmt::format("{}", first) : fmt::format("{} to {}", first, last));
  }
  return fmt::format("{}{}", fmt::join(ranges, ", "),
                     more > 0 ? fmt::format(" and {} more ranges", more) : "");
}

/// The sentence on numbers that several pictures have, such as f_1.png and f_1.tif; empty: none.
std::string repeated_numbers(std::vector<Numbered> pictures) {
  std::stable_sort(pictures.begin(), pictures.end(),
                   [](const Numbered& a, const Numbered& b) { return a.number < b.number; });
  std::size_t repeats = 0;
  const Numbered* first = nullptr;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    if (pictures[i].number != pictures[i - 1].number) continue;
    if (++repeats == 1) first = &pictures[i - 1];
  }
  if (repeats == 0) return {};
  return fmt::format(
      "{} a number that another picture has too, first {} and {}; each is read as a frame of its own, so "
      "remove copies and other versions of a frame.",
      repeats == 1 ? "1 picture has" : fmt::format("{} pictures have", repeats), first[0].name,
      first[1].name);
}

}  // namespace

void sort_as_frames(std::vector<std::string>& names) {
  std::ranges::sort(names, natural_less);
  if (!have_signs(names)) return;
  std::ranges::stable_sort(names, [](const std::string& a, const std::string& b) {
    const Parts x = *parts_of(a), y = *parts_of(b);
    if (x.series != y.series) return natural_less(x.series, y.series);
    return (x.sign == '-' ? -x.number : x.number) < (y.sign == '-' ? -y.number : y.number);
  });
}

std::vector<std::string> outside_the_series(const std::vector<std::string>& names) {
  constexpr std::size_t kMinSeries = 8;
  constexpr double kMinShare = 0.9;
  const auto series = series_of(names);
  const auto largest = std::ranges::max_element(series, {}, [](const auto& s) { return s.second.size(); });
  if (largest == series.end() || largest->second.size() < kMinSeries ||
      static_cast<double>(largest->second.size()) < kMinShare * static_cast<double>(names.size()))
    return {};
  const std::string& prefix = largest->first;
  const std::string root = prefix.substr(0, prefix.find_last_not_of(" _-.(") + 1);
  std::set<std::string> inside;
  for (const auto& [name, pictures] : series)
    if (pictures.size() > 1)
      for (const Numbered& picture : pictures) inside.insert(picture.name);
  std::vector<std::string> outside;
  for (const std::string& name : names) {
    const std::string stem = std::filesystem::path(name).stem().string();
    const bool continued = !root.empty() && (stem == root || prefix.starts_with(stem));
    if (!inside.contains(name) && !continued) outside.push_back(name);
  }
  return outside;
}

std::vector<std::string> notes_on_names(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxNamed = 3;
  constexpr double kMinEvenShare = 0.75;  // of the steps between numbers
  auto series = series_of(names);
  std::erase_if(series, [](const auto& s) { return s.second.size() < kMinPictures; });
  if (series.size() > 1) {
    std::vector<std::string> each;
    for (const auto& [name, pictures] : series)
      if (each.size() < kMaxNamed) each.push_back(fmt::format("'{}' ({} frames)", name, pictures.size()));
    return {
        fmt::format("the names belong to {} series, {}{}; they are read as one stack, so put each camera or "
                    "recording into its own folder.",
                    series.size(), fmt::join(each, ", "), series.size() > kMaxNamed ? ", …" : "")};
  }
  if (series.empty()) return {};
  const std::vector<Numbered>& pictures = series.begin()->second;
  if (std::string repeated = repeated_numbers(pictures); !repeated.empty()) return {std::move(repeated)};
  std::vector<Number> steps;
  for (std::size_t i = 1; i < pictures.size(); ++i)
    steps.push_back(pictures[i].number - pictures[i - 1].number);
  const Number step = upper_median(steps);
  if (step <= 0) return {};
  Number missing = 0;
  for (const Number s : steps) {
    if (s <= 0 || s % step != 0) return {};
    missing += s / step - 1;
  }
  const auto even = std::count(steps.begin(), steps.end(), step);
  if (missing == 0 || static_cast<double>(even) < kMinEvenShare * static_cast<double>(steps.size()))
    return {};
  return {
      fmt::format("the numbers in the names skip {}: {}; the phases of the frames after a gap need "
                  "--phase-lock found, or a stack without the gap.",
                  plural(missing, "frame"), skipped_numbers(pictures, step))};
}

}  // namespace twincell::imaging::frames
