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
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
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
      (void)table.column(name);
    }
  }
  /// The numbers of a quantity; null if the table has none.
  [[nodiscard]] const std::vector<double>* find(const std::string& quantity) const {
    const std::string name = name_of(quantity);
    return std::ranges::find(table_.names, name) == table_.names.end() ? nullptr : &table_.column(name);
  }
  /// \throws ConfigError if the table has none
  [[nodiscard]] const std::vector<double>& at(const std::string& quantity) const {
    if (const auto* found = find(quantity)) return *found;
    throw ConfigError(
        {.file = table_.file, .key = quantity},
        fmt::format("this column is missing; --columns {}=NAME states another name. There are: {}.", quantity,
                    fmt::join(table_.names, ", ")));
  }
  [[noreturn]] void refuse(std::size_t row, const std::string& quantity, const std::string& complaint) const {
    throw InputError({.file = table_.file, .key = name_of(quantity)},
                     fmt::format("row {}: {}", row + 1, complaint));
  }

 private:
  [[nodiscard]] std::string name_of(const std::string& quantity) const {
    const auto named = renamed_.find(quantity);
    return named == renamed_.end() ? quantity : named->second;
  }

  const Table& table_;
  const std::map<std::string, std::string>& renamed_;
};

/// The number of each row's frame. \throws InputError for numbers that count no frames
std::vector<std::int64_t> frame_numbers(const Columns& columns) {
  constexpr double kMostFrames = 1e7;
  std::vector<std::int64_t> numbers;
  const std::vector<double>& frames = columns.at("frame");
  const double first = *std::ranges::min_element(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!(frames[i] >= 0) || frames[i] != std::floor(frames[i]))
      columns.refuse(i, "frame",
                     fmt::format("{:g} is no number of a frame, which is whole and at least 0.", frames[i]));
    if (!(frames[i] - first < kMostFrames))
      columns.refuse(
          i, "frame",
          fmt::format("{:g} is more than {:g} frames after the first, {:g}.", frames[i], kMostFrames, first));
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
                     fmt::format("{:g} is no size of a bead.", sizes[i]));
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
  constexpr std::size_t kFewest = 5;
  constexpr double kClosest = 0.7;
  if (beads.size() < kFewest) return {};
  const double spacing = median_spacing(centres_of(beads)) / diameter_px;
  if (spacing >= kClosest) return {};
  return fmt::format(
      "the nearest neighbours in the first frame are {:.3g} bead diameters of {:.4g} px apart, so the "
      "diameter is wrong or the positions have another unit.",
      spacing, diameter_px);
}

}  // namespace

bool is_located_table(const std::filesystem::path& name) {
  return name.extension() == ".csv" && !std::filesystem::is_directory(name);
}

LocatedTable read_located(const Table& table, const LocatedTableOptions& options,
                          const std::filesystem::path& folder) {
  constexpr double kFarthest = 1e6;  // px
  const Columns columns(table, options.columns);
  const std::vector<std::int64_t> numbers = frame_numbers(columns);
  const std::vector<double>&x = columns.at("x"), &y = columns.at("y");
  const std::vector<double>*radius = columns.find("radius"), *diameter = columns.find("diameter"),
        *sigma_x = columns.find("sigma_x"), *sigma_y = columns.find("sigma_y"),
        *tracer = columns.find("tracer");
  LocatedTable all{.frames = DetectionStore(folder)};
  all.diameter_px = options.diameter_px.value_or(median_diameter(columns));
  if (!(all.diameter_px > 0))
    throw InputError({.file = table.file, .key = {}},
                     "has no column radius or diameter; state the bead diameter (--diameter, px).");
  all.has_errors = sigma_x != nullptr && sigma_y != nullptr;

  std::vector<std::size_t> rows(numbers.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::stable_sort(rows, {}, [&](std::size_t row) { return numbers[row]; });
  // Each number between the first and the last is a frame, of some bytes.
  constexpr std::int64_t kMostEmpty = 100'000;
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (const std::int64_t before = numbers[rows[i - 1]], here = numbers[rows[i]]; here - before > kMostEmpty)
      throw InputError({.file = table.file, .key = "frame"},
                       fmt::format("no bead is in the {} frames between {} and {}; is the number {} right?",
                                   here - before - 1, before, here, here));
  all.range.first = numbers[rows.front()];
  std::vector<TrackedBead> beads;
  double right = 0, bottom = 0;
  std::int64_t frame = all.range.first, doubled_frame = 0;
  std::size_t doubled = 0;
  const auto end_frame = [&] {
    if (frame == all.range.first) all.spacing_doubt = doubt_of_spacing(beads, all.diameter_px);
    if (const std::size_t again = listed_again(centres_of(beads), kSameBead * all.diameter_px); again > 0) {
      if (doubled == 0) doubled_frame = frame;
      doubled += again;
    }
    all.frames.append(beads);
    beads.clear();
    ++frame;
  };
  for (const std::size_t row : rows) {
    while (frame < numbers[row]) end_frame();
    TrackedBead b{.x_px = x[row], .y_px = y[row]};
    b.radius_px = radius != nullptr     ? (*radius)[row]
                  : diameter != nullptr ? (*diameter)[row] / 2
                                        : all.diameter_px / 2;
    if (!(std::abs(b.x_px) < kFarthest))
      columns.refuse(row, "x", fmt::format("{:g} is no position.", b.x_px));
    if (!(std::abs(b.y_px) < kFarthest))
      columns.refuse(row, "y", fmt::format("{:g} is no position.", b.y_px));
    b.sigma_x_px = all.has_errors ? (*sigma_x)[row] : kNaN;
    b.sigma_y_px = all.has_errors ? (*sigma_y)[row] : kNaN;
    if (b.sigma_x_px < 0 || b.sigma_y_px < 0) columns.refuse(row, "sigma_x", "a standard error is negative.");
    const double flag = tracer != nullptr ? (*tracer)[row] : 0;
    if (flag != 0 && flag != 1) columns.refuse(row, "tracer", fmt::format("{:g} is neither 0 nor 1.", flag));
    b.tracer = flag == 1;
    right = std::max(right, b.x_px + b.radius_px);
    bottom = std::max(bottom, b.y_px + b.radius_px);
    beads.push_back(b);
  }
  end_frame();
  if (all.spacing_doubt.empty() && doubled > 0)
    all.spacing_doubt = fmt::format(
        "{}, the first in frame {}, {} closer than {:g} diameters to another bead: are beads listed twice?",
        counted(doubled, "bead"), doubled_frame, doubled == 1 ? "lies" : "lie", kSameBead);
  all.width_px = static_cast<int>(std::ceil(right + 0.5));
  all.height_px = static_cast<int>(std::ceil(bottom + 0.5));
  if (options.picture) {
    const auto [width, height] = *options.picture;
    const auto is_outside = [&](std::size_t row) {
      return !(x[row] >= -0.5 && x[row] < width - 0.5 && y[row] >= -0.5 && y[row] < height - 0.5);
    };
    if (const auto found = std::ranges::find_if(rows, is_outside); found != rows.end())
      columns.refuse(*found, x[*found] >= -0.5 && x[*found] < width - 0.5 ? "y" : "x",
                     fmt::format("the bead at {:g}, {:g} is outside the picture of {} x {} px.", x[*found],
                                 y[*found], width, height));
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
  return stack;
}

}  // namespace twincell::imaging
