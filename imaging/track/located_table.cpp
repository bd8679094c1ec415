#include "imaging/track/located_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "core/plural.hpp"
#include "imaging/track/inside_cell.hpp"
#include "trajectory/spacing.hpp"

namespace twincell::imaging {

namespace {

constexpr std::array<const char*, 8> kQuantities = {"frame",    "x",       "y",       "radius",
                                                    "diameter", "sigma_x", "sigma_y", "tracer"};

/// The columns of a table by quantity.
class Columns {
 public:
  Columns(const Table& table, const std::map<std::string, std::string>& renamed)
      : table_(table), renamed_(renamed) {
    for (const auto& [quantity, name] : renamed) {
      if (std::ranges::find(kQuantities, quantity) == kQuantities.end())
        throw ConfigError(
            {.file = {}, .key = "--columns"},
            fmt::format("there is no quantity '{}'; there are: {}.", quantity, fmt::join(kQuantities, ", ")));
      (void)values_of(quantity, name);
    }
  }
  /// The numbers of a quantity; null if the table has none.
  [[nodiscard]] const std::vector<double>* find(const std::string& quantity) const {
    const std::string name = name_of(quantity);
    return std::ranges::find(table_.names, name) == table_.names.end() ? nullptr : &values_of(quantity, name);
  }
  /// \throws ConfigError if the table has none
  [[nodiscard]] const std::vector<double>& at(const std::string& quantity) const {
    if (const auto* found = find(quantity)) return *found;
    throw ConfigError(
        {.file = table_.file, .key = quantity},
        fmt::format("this column is missing; --columns {}=NAME states another name. The columns are: {}.",
                    quantity, fmt::join(table_.names, ", ")));
  }
  [[noreturn]] void refuse(std::size_t row, const std::string& quantity, const std::string& complaint) const {
    throw InputError({.file = table_.file, .key = name_of(quantity)},
                     fmt::format("row {}: {}", row + 1, complaint));
  }

  /// The name of the column of a quantity.
  [[nodiscard]] std::string name_of(const std::string& quantity) const {
    const auto named = renamed_.find(quantity);
    return named == renamed_.end() ? quantity : named->second;
  }

 private:
  [[nodiscard]] const std::vector<double>& values_of(const std::string& quantity,
                                                     const std::string& name) const {
    return quantity == "tracer" ? table_.column_of_marks(name) : table_.column(name);
  }

  const Table& table_;
  const std::map<std::string, std::string>& renamed_;
};

/// The number of each row's frame. \throws InputError for numbers that count no frames
std::vector<std::int64_t> frame_numbers(const Columns& columns) {
  constexpr double kMaxFrames = 1e7;
  std::vector<std::int64_t> numbers;
  const std::vector<double>& frames = columns.at("frame");
  const double first = *std::ranges::min_element(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!(frames[i] >= 0) || frames[i] != std::floor(frames[i]))
      columns.refuse(i, "frame",
                     fmt::format("{:g} is not a valid frame number; it must be a whole number of at least 0.",
                                 frames[i]));
    if (!(frames[i] - first < kMaxFrames))
      columns.refuse(
          i, "frame",
          fmt::format("{:g} is more than {:g} frames after the first, {:g}.", frames[i], kMaxFrames, first));
    numbers.push_back(static_cast<std::int64_t>(frames[i]));
  }
  return numbers;
}

/// The median of twice the radii; 0 without sizes.
double median_diameter(const Columns& columns) {
  const std::vector<double>*radius = columns.find("radius"), *diameter = columns.find("diameter");
  if (radius == nullptr && diameter == nullptr) return 0;
  const std::vector<double>& sizes = radius != nullptr ? *radius : *diameter;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (!(sizes[i] > 0 && sizes[i] < 1e6))
      columns.refuse(i, radius != nullptr ? "radius" : "diameter",
                     fmt::format("{:g} is not a valid size of a bead.", sizes[i]));
  return (radius != nullptr ? 2 : 1) * upper_median(sizes);
}

std::vector<Vec3> centres_of(const std::vector<TrackedBead>& beads) {
  std::vector<Vec3> centres;
  centres.reserve(beads.size());
  for (const TrackedBead& b : beads) centres.emplace_back(b.x_px, b.y_px, 0);
  return centres;
}

/// Says that the nearest neighbours of a frame are much closer than discs of one diameter can be.
std::string doubt_of_spacing(const std::vector<TrackedBead>& beads, double diameter_px) {
  constexpr std::size_t kMinBeads = 5;
  constexpr double kMinSpacing = 0.7;  // bead diameters
  if (beads.size() < kMinBeads) return {};
  const double spacing = median_spacing(centres_of(beads)) / diameter_px;
  if (spacing >= kMinSpacing) return {};
  return fmt::format(
      "the nearest neighbours in the first frame are {:.3g} bead diameters of {:.4g} px apart, so the "
      "diameter is wrong or the positions have another unit.",
      spacing, diameter_px);
}

/// The rows in the order of their frames. \throws InputError for a long gap: each number between the first
/// and the last is a frame, of some bytes
std::vector<std::size_t> rows_by_frame(const std::vector<std::int64_t>& numbers, const std::string& file) {
  constexpr std::int64_t kMaxEmptyFrames = 100'000;  // in a row
  std::vector<std::size_t> rows(numbers.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::stable_sort(rows, {}, [&](std::size_t row) { return numbers[row]; });
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (const std::int64_t before = numbers[rows[i - 1]], here = numbers[rows[i]];
        here - before > kMaxEmptyFrames)
      throw InputError({.file = file, .key = "frame"},
                       fmt::format("the {} frames between {} and {} contain no bead; check frame number {}.",
                                   here - before - 1, before, here, here));
  return rows;
}

/// Reads the bead of a row.
class BeadRows {
 public:
  BeadRows(const Columns& columns, double diameter_px)
      : columns_(columns),
        x_(columns.at("x")),
        y_(columns.at("y")),
        radius_(columns.find("radius")),
        diameter_(columns.find("diameter")),
        sigma_x_(columns.find("sigma_x")),
        sigma_y_(columns.find("sigma_y")),
        tracer_(columns.find("tracer")),
        diameter_px_(diameter_px) {}

  [[nodiscard]] bool have_errors() const { return sigma_x_ != nullptr && sigma_y_ != nullptr; }

  /// Sentences on standard errors that are not used, without a full stop.
  [[nodiscard]] std::vector<std::string> doubts_of_errors() const {
    if (!have_errors()) {
      if (sigma_x_ == nullptr && sigma_y_ == nullptr) return {};
      const bool has_x = sigma_x_ != nullptr;
      return {fmt::format(
          "the column {} is not used, because there is no column {}: the standard errors of the "
          "positions are unknown",
          columns_.name_of(has_x ? "sigma_x" : "sigma_y"), columns_.name_of(has_x ? "sigma_y" : "sigma_x"))};
    }
    std::size_t n = 0;
    for (std::size_t row = 0; row < x_.size(); ++row)
      if ((*sigma_x_)[row] == 0 || (*sigma_y_)[row] == 0) ++n;
    if (n == 0) return {};
    return {fmt::format("{} a standard error of 0, which no position has: the errors of {} are unknown",
                        plural(n, "row") + (n == 1 ? " has" : " have"), n == 1 ? "this row" : "these rows")};
  }

  /// \throws InputError for numbers out of range
  [[nodiscard]] TrackedBead bead(std::size_t row) const {
    constexpr double kMaxCoordinate = 1e6;  // px
    TrackedBead b{.x_px = x_[row], .y_px = y_[row]};
    b.radius_px = radius_of(row);
    constexpr double kSameSize = 0.05;  // of numbers with few digits, as in the other tables of beads
    if (radius_ != nullptr && diameter_ != nullptr &&
        !(std::abs(2 * b.radius_px - (*diameter_)[row]) <= kSameSize * (*diameter_)[row]))
      columns_.refuse(row, "diameter",
                      fmt::format("the radius is {:g} and the diameter {:g}, which is not twice the radius.",
                                  b.radius_px, (*diameter_)[row]));
    if (!(std::abs(b.x_px) < kMaxCoordinate))
      columns_.refuse(row, "x", fmt::format("{:g} is not a valid position.", b.x_px));
    if (!(std::abs(b.y_px) < kMaxCoordinate))
      columns_.refuse(row, "y", fmt::format("{:g} is not a valid position.", b.y_px));
    b.sigma_x_px = have_errors() ? (*sigma_x_)[row] : kNaN;
    b.sigma_y_px = have_errors() ? (*sigma_y_)[row] : kNaN;
    if (b.sigma_x_px < 0 || b.sigma_y_px < 0)
      columns_.refuse(row, "sigma_x", "a standard error is negative.");
    if (b.sigma_x_px == 0 || b.sigma_y_px == 0) b.sigma_x_px = b.sigma_y_px = kNaN;  // no position is exact
    const double flag = tracer_ != nullptr ? (*tracer_)[row] : 0;
    if (flag != 0 && flag != 1) columns_.refuse(row, "tracer", fmt::format("{:g} is neither 0 nor 1.", flag));
    b.tracer = flag == 1;
    return b;
  }

  /// \throws InputError for a bead of which nothing is in the picture
  void require_inside(const std::vector<std::size_t>& rows, int width, int height) const {
    const auto is_within = [&](std::size_t row, double at, int pixels) {
      const double beyond = 0.5 + std::max(0.0, radius_of(row));
      return at >= -beyond && at < pixels - 1 + beyond;
    };
    const auto is_outside = [&](std::size_t row) {
      return !is_within(row, x_[row], width) || !is_within(row, y_[row], height);
    };
    if (const auto found = std::ranges::find_if(rows, is_outside); found != rows.end())
      columns_.refuse(*found, is_within(*found, x_[*found], width) ? "y" : "x",
                      fmt::format("the bead at {:g}, {:g} is outside the picture of {} x {} px.", x_[*found],
                                  y_[*found], width, height));
  }

 private:
  [[nodiscard]] double radius_of(std::size_t row) const {
    return radius_ != nullptr ? (*radius_)[row]
                              : (diameter_ != nullptr ? (*diameter_)[row] : diameter_px_) / 2;
  }

  const Columns& columns_;
  const std::vector<double>&x_, &y_;
  const std::vector<double>*radius_, *diameter_, *sigma_x_, *sigma_y_, *tracer_;  // null: no such column
  double diameter_px_;                                                            // without sizes
};

/// Collects the beads of one frame after the other.
class FrameCollector {
 public:
  explicit FrameCollector(LocatedTable& all) : all_(all), frame_(all.range.first) {}

  /// \param frame not before that of the bead added last
  void add(const TrackedBead& bead, std::int64_t frame) {
    while (frame_ < frame) end_frame();
    right_ = std::max(right_, bead.x_px + bead.radius_px);
    bottom_ = std::max(bottom_, bead.y_px + bead.radius_px);
    beads_.push_back(bead);
  }

  /// Ends the last frame, and sets the doubt of the spacing and the size of the picture that contains all
  /// beads.
  void finish() {
    end_frame();
    if (all_.spacing_doubt.empty() && doubled_ > 0)
      all_.spacing_doubt = fmt::format(
          "{}, the first in frame {}, {} closer than {:g} diameters to another bead: are beads listed twice?",
          plural(doubled_, "bead"), doubled_frame_, doubled_ == 1 ? "lies" : "lie", kSameBead);
    all_.width_px = static_cast<int>(std::ceil(right_ + 0.5));
    all_.height_px = static_cast<int>(std::ceil(bottom_ + 0.5));
  }

 private:
  void end_frame() {
    if (frame_ == all_.range.first) all_.spacing_doubt = doubt_of_spacing(beads_, all_.diameter_px);
    if (const std::size_t again = listed_again(centres_of(beads_), kSameBead * all_.diameter_px); again > 0) {
      if (doubled_ == 0) doubled_frame_ = frame_;
      doubled_ += again;
    }
    all_.frames.append(beads_);
    beads_.clear();
    ++frame_;
  }

  LocatedTable& all_;
  std::int64_t frame_, doubled_frame_ = 0;
  std::vector<TrackedBead> beads_;  // of the frame
  double right_ = 0, bottom_ = 0;   // px
  std::size_t doubled_ = 0;
};

}  // namespace

bool is_located_table(const std::filesystem::path& name) {
  return name.extension() == ".csv" && !std::filesystem::is_directory(name);
}

LocatedTable read_located(const Table& table, const LocatedTableOptions& options,
                          const std::filesystem::path& folder) {
  const Columns columns(table, options.columns);
  const std::vector<std::int64_t> numbers = frame_numbers(columns);
  (void)columns.at("x"), (void)columns.at("y");  // their absence is reported before that of a size
  LocatedTable all{.frames = DetectionStore(folder)};
  all.diameter_px = options.diameter_px.value_or(median_diameter(columns));
  if (!(all.diameter_px > 0))
    throw InputError({.file = table.file, .key = {}},
                     "has no column radius or diameter; state the bead diameter (--diameter, px).");
  const BeadRows beads(columns, all.diameter_px);
  all.has_errors = beads.have_errors();
  all.doubts = beads.doubts_of_errors();

  const std::vector<std::size_t> rows = rows_by_frame(numbers, table.file);
  all.range.first = numbers[rows.front()];
  FrameCollector collector(all);
  for (const std::size_t row : rows) collector.add(beads.bead(row), numbers[row]);
  collector.finish();
  if (options.picture) {
    const auto [width, height] = *options.picture;
    beads.require_inside(rows, width, height);
    all.width_px = width;
    all.height_px = height;
    all.has_picture = true;
  }
  return all;
}

TrackedStack track_located(LocatedTable located, LinkOptions link, const CellDescription& cell,
                           const PhaseSource& source, const std::filesystem::path& folder,
                           Progress& progress) {
  if (!located.has_picture && (cell.rotation_deg != 0 || cell.distortion != 0))
    throw ConfigError(
        {.file = {}, .key = "--picture-size"},
        "is needed: rotation and distortion of the camera are about the centre of the picture.");
  const cv::Size picture(located.width_px, located.height_px);
  const InsideCell inside(cell, picture);
  DetectionStore kept(folder);
  std::size_t n_inside = 0, n_outside = 0;
  std::vector<TrackedBead> beads;
  for (std::size_t f = 0; f < located.frames.size(); ++f) {
    beads.clear();
    for (const TrackedBead& b : located.frames[f]) {
      if (inside({b.x_px, b.y_px}))
        beads.push_back(b);
      else
        ++n_outside;
    }
    n_inside += beads.size();
    kept.append(beads);
  }
  require_some_inside(cell, n_inside, n_outside, true);
  link.diameter_px = located.diameter_px;
  TrackedStack stack{link_detections(kept, link, cell, source, folder, progress)};
  stack.locator.diameter_px = located.diameter_px;
  stack.width_px = located.width_px;
  stack.height_px = located.height_px;
  stack.outside_cell = n_outside;
  stack.has_errors = located.has_errors;
  stack.range = located.range;
  stack.spacing_doubt = std::move(located.spacing_doubt);
  stack.settings_doubts.insert(stack.settings_doubts.end(), located.doubts.begin(), located.doubts.end());
  return stack;
}

}  // namespace twincell::imaging
