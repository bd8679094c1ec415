#include "imaging/stack/formats/frame_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <map>

#include "core/counted.hpp"
#include "core/median.hpp"

namespace twincell::imaging::frames {
namespace {

using Number = std::int64_t;

constexpr std::size_t kFewest = 2;  // pictures of a series

struct Numbered {
  Number number;
  std::string name;
};

/// The numbered pictures of each series. A name without a number, or with one of more than 18 digits, is in
/// none.
std::map<std::string, std::vector<Numbered>> series_of(const std::vector<std::string>& names) {
  constexpr const char* kDigits = "0123456789";
  constexpr std::size_t kMostDigits = 18;
  std::map<std::string, std::vector<Numbered>> series;
  for (const std::string& name : names) {
    const std::string stem = std::filesystem::path(name).stem().string();
    const std::size_t last = stem.find_last_of(kDigits);
    if (last == std::string::npos) continue;
    const std::size_t before = stem.find_last_not_of(kDigits, last);
    const std::size_t first = before == std::string::npos ? 0 : before + 1;
    if (last + 1 - first > kMostDigits) continue;
    Number number = 0;
    std::from_chars(stem.data() + first, stem.data() + last + 1, number);
    series[stem.substr(0, first)].push_back({number, name});
  }
  return series;
}

/// "7 and 30 to 39": the numbers that are skipped, the first few ranges.
std::string skipped_numbers(const std::vector<Numbered>& pictures, Number step) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> ranges;
  std::size_t more = 0;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    const Number first = pictures[i - 1].number + step, last = pictures[i].number - step;
    if (first > last) continue;
    if (ranges.size() == kMost)
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

std::vector<std::string> notes_on_names(const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 3;
  constexpr double kEven = 0.75;
  auto series = series_of(names);
  std::erase_if(series, [](const auto& s) { return s.second.size() < kFewest; });
  if (series.size() > 1) {
    std::vector<std::string> each;
    for (const auto& [name, pictures] : series)
      if (each.size() < kNamed) each.push_back(fmt::format("'{}' ({} frames)", name, pictures.size()));
    return {
        fmt::format("the names belong to {} series, {}{}; they are read as one stack, so put each camera or "
                    "recording into its own folder.",
                    series.size(), fmt::join(each, ", "), series.size() > kNamed ? ", …" : "")};
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
  if (missing == 0 || static_cast<double>(even) < kEven * static_cast<double>(steps.size())) return {};
  return {
      fmt::format("the numbers in the names skip {}: {}; the phases of the frames after a gap need "
                  "--phase-lock found, or a stack without the gap.",
                  counted(missing, "frame"), skipped_numbers(pictures, step))};
}

}  // namespace twincell::imaging::frames
