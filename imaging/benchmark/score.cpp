#include "imaging/benchmark/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "core/error.hpp"
#include "core/table_text.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

namespace fs = std::filesystem;

namespace {

/// A table with named columns.
class Table {
 public:
  explicit Table(const fs::path& file) : file_(file), in_(read_table_text(file)) {
    std::string line;
    std::getline(in_, line);
    const std::vector<std::string> names = field_texts(line);
    check_column_names(names, {.file = file.string(), .line = 1, .key = {}});
    for (std::size_t i = 0; i < names.size(); ++i) column_[names[i]] = i;
    width_ = names.size();
    for (const char* needed : {"x_px", "y_px", "r_px"})
      if (!has(needed))
        throw InputError(Where{.file = file.string(), .line = 1, .key = needed}, "is not a column.");
  }
  bool next_row() {
    std::string line;
    do {
      if (!std::getline(in_, line)) return false;
      ++line_;
    } while (line.empty());
    row_ = field_texts(line);
    if (row_.size() != width_)
      throw InputError(Where{.file = file_.string(), .line = line_, .key = {}},
                       "has a different number of cells from the header row.");
    return true;
  }
  [[nodiscard]] bool has(const std::string& name) const { return column_.count(name) > 0; }
  [[nodiscard]] const std::string& text(const std::string& name) const { return row_[column_.at(name)]; }
  [[nodiscard]] double number(const std::string& name) const {
    const std::string& t = text(name);
    double value = 0;
    const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), value);
    if (error != std::errc() || end != t.data() + t.size() || !std::isfinite(value))
      throw InputError(where(name), "is '" + t + "', not a finite number.");
    return value;
  }
  /// An integer within bounds.
  [[nodiscard]] std::int64_t whole(const std::string& name, double lower, double upper) const {
    const double value = number(name);
    if (!(value >= lower && value <= upper) || value != std::floor(value))
      throw InputError(where(name), fmt::format("is {}; it must be a whole number from {:.0f} to {:.0f}.",
                                                text(name), lower, upper));
    return static_cast<std::int64_t>(value);
  }
  [[nodiscard]] Where where(const std::string& name) const {
    return {.file = file_.string(), .line = line_, .key = name};
  }

 private:
  fs::path file_;
  std::istringstream in_;
  std::map<std::string, std::size_t> column_;
  std::vector<std::string> row_;
  std::size_t width_ = 0;
  long line_ = 1;
};

TruthBead bead(const Table& t) {
  TruthBead b;
  constexpr double kLargestId = 1e15;
  if (t.has("id")) b.id = t.whole("id", -1, kLargestId);
  b.x = t.number("x_px");
  b.y = t.number("y_px");
  b.r = t.number("r_px");
  if (!(b.r > 0)) throw InputError(t.where("r_px"), fmt::format("is {:g}; a radius is greater than 0.", b.r));
  if (t.has("u_px")) b.u = t.number("u_px");
  if (t.has("kind")) b.counts = t.text("kind") == "black";
  return b;
}

}  // namespace

Scorer::Scorer(ScoredRows rows) : rows_(rows) {
  if (rows.first > rows.last)
    throw ConfigError(Where{.file = {}, .key = "--scored-rows"},
                      fmt::format("begin with {:g} and end with {:g}; the first must not exceed the last.",
                                  rows.first, rows.last));
}

void require_scored(const Score& score, const fs::path& truth) {
  if (score.truths == 0)
    throw InputError(Where{.file = truth.string(), .key = {}},
                     "has no bead in the frames and rows that are scored, so there is no score.");
}

void Scorer::add(const std::vector<TruthBead>& truth, const std::vector<FoundBead>& found) {
  struct Pair {
    double distance;
    std::size_t t, f;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < truth.size(); ++t)
    for (std::size_t f = 0; f < found.size(); ++f) {
      const double distance = std::hypot(found[f].x - truth[t].x, found[f].y - truth[t].y);
      if (distance <= truth[t].r) pairs.push_back({distance, t, f});
    }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<bool> truth_taken(truth.size()), find_taken(found.size());
  std::vector<Link> links;
  auto scored = [&](double y) { return y >= rows_.first && y <= rows_.last; };
  for (const Pair& p : pairs) {
    if (truth_taken[p.t] || find_taken[p.f]) continue;
    truth_taken[p.t] = find_taken[p.f] = true;
    const TruthBead& b = truth[p.t];
    if (!b.counts || !scored(b.y)) continue;
    const double dx = found[p.f].x - b.x, dy = found[p.f].y - b.y;
    ++sums_.found;
    squares_ += dx * dx + dy * dy;
    sum_x_ += dx;
    sum_y_ += dy;
    // Uncertainties within 1 % are equal; a clearly smaller one restarts the sums of the surest beads.
    constexpr double kAlike = 1.01;
    if (b.u * kAlike < least_u_) least_u_ = b.u, squares_sure_ = 0, sums_.sure = 0;
    if (b.u <= least_u_ * kAlike) squares_sure_ += dx * dx + dy * dy, ++sums_.sure;
    if (b.id >= 0 && found[p.f].track >= 0) links.push_back({b.id, found[p.f].track});
  }
  for (const TruthBead& b : truth)
    if (b.counts && scored(b.y)) ++sums_.truths;
  for (std::size_t f = 0; f < found.size(); ++f)
    if (!find_taken[f] && scored(found[f].y)) ++sums_.false_finds;
  for (const Link& now : links)
    for (const Link& before : previous_)
      if (now.id == before.id) {
        ++sums_.links;
        if (now.track != before.track) ++sums_.wrong_links;
      }
  previous_ = std::move(links);
}

Score Scorer::score() const {
  Score s = sums_;
  if (s.found > 0) {
    const double n = static_cast<double>(s.found);
    s.rms = std::sqrt(squares_ / (2 * n));
    s.rms_sure = std::sqrt(squares_sure_ / (2 * static_cast<double>(s.sure)));
    s.bias_x = sum_x_ / n;
    s.bias_y = sum_y_ / n;
  }
  return s;
}

std::vector<std::vector<TruthBead>> read_truth(const fs::path& path) {
  std::vector<std::vector<TruthBead>> frames;
  if (!fs::is_directory(path)) {
    Table table(path);
    while (table.next_row()) {
      constexpr double kLastFrame = 1e7 - 1;
      const auto frame =
          table.has("frame") ? static_cast<std::size_t>(table.whole("frame", 0, kLastFrame)) : 0;
      if (frames.size() <= frame) frames.resize(frame + 1);
      frames[frame].push_back(bead(table));
    }
    return frames;
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path)) {
    const std::string name = entry.path().filename().string();
    if (name == "truth.csv") return read_truth(entry.path());
    if (name.starts_with("truth_") && name.ends_with(".csv")) files.push_back(entry.path());
  }
  if (files.empty())
    throw InputError(Where{.file = path.string(), .key = {}}, "contains neither truth.csv nor truth_NN.csv.");
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  for (const fs::path& file : files) {
    Table table(file);
    frames.emplace_back();
    while (table.next_row()) frames.back().push_back(bead(table));
  }
  return frames;
}

}  // namespace twincell::imaging
