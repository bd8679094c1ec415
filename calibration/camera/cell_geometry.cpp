#include "calibration/camera/cell_geometry.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "calibration/camera/edge_lines.hpp"
#include "calibration/fit/outliers.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/median.hpp"

namespace twincell::calibration {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::size_t kPlateFrames =
    40;  // frames whose plate points enter the fit of rotation and distortion

/// Position of a picture point in the ideal picture: the formulas of Lens, templated for Ceres.
template <class T>
void ideal(const T& rotation_deg, const T& k1, double x, double y, cv::Size size, T* out) {
  const double mx = 0.5 * (size.width - 1), my = 0.5 * (size.height - 1),
               unit = 0.5 * std::hypot(size.width, size.height);
  const double u = x - mx, v = y - my, seen = std::hypot(u, v) / unit;
  T r = T(seen);
  for (int i = 0; i < 8; ++i) r -= (r * (1.0 + k1 * r * r) - seen) / (1.0 + 3.0 * k1 * r * r);
  const T shrink = seen > 1e-9 ? r / seen : T(1.0);
  const T c = cos(rotation_deg * kDegree), s = sin(rotation_deg * kDegree);
  out[0] = mx + shrink * (c * u - s * v);
  out[1] = my + shrink * (s * u + c * v);
}

/// Index of each parameter in the parameter vector; -1: not fitted, its value is 0.
struct Places {
  int x_left = -1, tilt_left = -1, x_right = -1, tilt_right = -1, rotation = -1, distortion = -1;
  std::vector<std::string> names;
  int add(const char* name) {
    names.emplace_back(name);
    return static_cast<int>(names.size()) - 1;
  }
};
template <class T>
T value_at(const T* p, int place) {
  return place < 0 ? T(0.0) : p[place];
}

/// Distance of a wall point from its line, divided by `error`. plate_row, from which the walls' heights
/// count, is constant.
struct WallResidual {
  imaging::PixelPoint at;
  double error, plate_row;
  bool left;
  Places places;
  cv::Size size;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    const T* p = parameters[0];
    T q[2];
    ideal(value_at(p, places.rotation), value_at(p, places.distortion), at.x_px, at.y_px, size, q);
    const T height = plate_row - q[1];
    residual[0] = left ? q[0] - (p[places.x_left] - tan(p[places.tilt_left] * kDegree) * height)
                       : q[0] - (p[places.x_right] + tan(p[places.tilt_right] * kDegree) * height);
    residual[0] /= error;
    return true;
  }
};

/// Rows of one frame's plate points relative to their mean, so that the plate's height cancels.
struct PlateResidual {
  std::vector<imaging::PixelPoint> at;
  double error;
  Places places;
  cv::Size size;
  template <class T>
  bool operator()(T const* const* parameters, T* residual) const {
    const T* p = parameters[0];
    T mean = T(0.0);
    for (std::size_t i = 0; i < at.size(); ++i) {
      T q[2];
      ideal(value_at(p, places.rotation), value_at(p, places.distortion), at[i].x_px, at[i].y_px, size, q);
      residual[i] = q[1];
      mean += q[1] / static_cast<double>(at.size());
    }
    for (std::size_t i = 0; i < at.size(); ++i) residual[i] = (residual[i] - mean) / error;
    return true;
  }
};

template <class Functor>
ceres::CostFunction* cost_of(Functor* functor, std::size_t parameters, std::size_t residuals) {
  auto* cost = new ceres::DynamicAutoDiffCostFunction<Functor, 8>(functor);
  cost->AddParameterBlock(static_cast<int>(parameters));
  cost->SetNumResiduals(static_cast<int>(residuals));
  return cost;
}

/// Height of the plate in the ideal picture, with its standard error from the scatter of the points.
PlateSighting sighting(const std::vector<imaging::PixelPoint>& points, double rotation_deg, double k1,
                       cv::Size size) {
  PlateSighting s{.height_px = kNaN, .sigma_px = kNaN, .points = 0};
  std::vector<double> rows;
  for (const imaging::PixelPoint& p : points) {
    double q[2];
    ideal(rotation_deg, k1, p.x_px, p.y_px, size, q);
    rows.push_back(-q[1]);
  }
  if (rows.size() < 3) return s;
  const double middle = upper_median(rows);
  std::vector<double> r;
  for (const double z : rows) r.push_back(z - middle);
  const double width = std::max(0.02, 3 * robust_spread(r));
  double sum = 0, squares = 0, n = 0;
  for (const double z : rows)
    if (std::abs(z - middle) < width) sum += z, squares += (z - middle) * (z - middle), ++n;
  s.height_px = sum / n;
  const double variance = squares / n - (s.height_px - middle) * (s.height_px - middle);
  s.sigma_px = std::sqrt(std::max(variance, 1e-6) / std::max(1.0, n - 1));
  s.points = static_cast<std::size_t>(n);
  return s;
}

struct Chosen {
  std::vector<WallRow> left, right;
  std::vector<std::vector<imaging::PixelPoint>> plate;  // [some frames]
};

FitReport solve_geometry(const Chosen& c, const Places& places, std::vector<double>& p, cv::Size size,
                         const double (&error)[3], Residuals residuals) {
  ceres::Problem problem;
  const std::size_t n = places.names.size();
  for (const bool left : {true, false})
    for (const WallRow& row : left ? c.left : c.right)
      problem.AddResidualBlock(cost_of(new WallResidual{row.at, error[left ? 0 : 1] / std::sqrt(row.frames),
                                                        row.floor, left, places, size},
                                       n, 1),
                               nullptr, p.data());
  for (const auto& frame : c.plate)
    if (frame.size() >= 3)
      problem.AddResidualBlock(cost_of(new PlateResidual{frame, error[2], places, size}, n, frame.size()),
                               nullptr, p.data());
  return solve(problem, p.data(), places.names, residuals);
}

/// Factor by which the squared error of a mean of residuals exceeds that of independent residuals. An object
/// at an edge, such as a bead or a dust particle, shifts all points of one block together. \param
/// block_and_residual block number and residual of each point \param fitted number of parameters fitted to
/// all points
double block_factor(const std::vector<std::pair<int, double>>& block_and_residual, double fitted) {
  std::map<int, double> sums;
  double squares = 0, of_blocks = 0;
  for (const auto& [block, r] : block_and_residual) sums[block] += r, squares += r * r;
  for (const auto& [block, sum] : sums) of_blocks += sum * sum;
  const auto n = static_cast<double>(sums.size());
  if (n < fitted + 3 || squares <= 0) return 1;
  return std::max(1.0, of_blocks / squares * n / (n - fitted));
}

}  // namespace

std::vector<double> CellGeometry::heights_px() const {
  std::vector<double> h;
  for (const PlateSighting& s : heights) h.push_back(s.height_px);
  return h;
}
double CellGeometry::width_px() const {
  return fit.value("x_right") - fit.value("x_left");
}
double CellGeometry::width_error_px() const {
  if (fit.covariance.size() == 0) return kNaN;
  const auto place = [&](const char* name) {
    return std::find(fit.names.begin(), fit.names.end(), name) - fit.names.begin();
  };
  const auto l = place("x_left"), r = place("x_right");
  return std::sqrt(fit.covariance(l, l) + fit.covariance(r, r) - 2 * fit.covariance(l, r));
}

namespace {

/// The edges of a cell and the parameters that are fitted to them. The steps are in the order of their use.
class GeometryFit {
 public:
  GeometryFit(const StackEdges& edges, bool with_distortion)
      : edges_(edges), size_(edges.size), window_(with_distortion ? 3 * kEdgeWindow_px : kEdgeWindow_px) {
    choose_points();
    choose_parameters(with_distortion);
  }

  /// Fits in rounds: after each, estimates the scatter of each edge and rejects outliers. The last round is
  /// weighted and includes the correlation within blocks.
  void fit() {
    constexpr int kRounds = 4;
    kept_ = all_;
    for (int round = 1; round < kRounds; ++round) {
      report_ = solve_geometry(kept_, places_, p_, size_, error_, Residuals::unweighted);
      put_floors(value_at(p_.data(), places_.rotation), value_at(p_.data(), places_.distortion));
      kept_ = {};
      reject_wall_outliers(all_.left, true, kept_.left);
      reject_wall_outliers(all_.right, false, kept_.right);
      reject_plate_outliers();
    }
    include_correlation();
    report_ = solve_geometry(kept_, places_, p_, size_, error_, Residuals::weighted);
    add_systematic_errors();
  }

  /// The edges without the walls that are not straight lines; absent if all are.
  [[nodiscard]] std::optional<StackEdges> without_false_walls() const {
    const bool false_left = has_left_ && !is_line("x_left"), false_right = has_right_ && !is_line("x_right");
    if (!false_left && !false_right) return std::nullopt;
    StackEdges lines = edges_;
    if (false_left) lines.left.clear();
    if (false_right) lines.right.clear();
    return lines;
  }

  /// The fit, and what is derived from it: residuals of the edges, then the plate's height in every frame.
  /// \param distortion k1 that counts, 0 if it is not significant
  [[nodiscard]] CellGeometry geometry(double distortion) const {
    CellGeometry g;
    g.size = size_;
    g.blur_px = edges_.blur_px;
    g.has_plate = has_plate_, g.has_left = has_left_, g.has_right = has_right_;
    g.plate_row = plate_row_;
    g.fit = report_;
    g.distortion = distortion;
    g.rotation_deg = has_plate_ ? report_.value("rotation") : 0;
    add_residuals(g);
    add_heights(g);
    return g;
  }
  [[nodiscard]] const FitReport& report() const { return report_; }

 private:
  void choose_points();
  void put_floors(double rotation_deg, double k1);
  void choose_parameters(bool with_distortion);
  void reject_wall_outliers(const std::vector<WallRow>& wall, bool left, std::vector<WallRow>& kept);
  void reject_plate_outliers();
  void include_correlation();
  void add_systematic_errors();
  void add_residuals(CellGeometry& g) const;
  void add_heights(CellGeometry& g) const;
  void add_errors_of_map(CellGeometry& g) const;

  /// Whether a fitted wall is one: beads cut by the border of the frame can look like a wall, but their rims
  /// do not form a line.
  [[nodiscard]] bool is_line(const char* name) const {
    constexpr double kLargest_px = 0.25;
    return report_.standard_errors.empty() || report_.standard_error(name) < kLargest_px;
  }
  [[nodiscard]] std::vector<imaging::PixelPoint> plate_points(std::size_t frame) const {
    return on_plate(edges_.plate[frame], slope_, window_);
  }
  [[nodiscard]] double wall_residual(const WallRow& row, bool left) const {
    const double* values = p_.data();
    double r = 0;
    WallResidual{row.at, 1, row.floor, left, places_, size_}(&values, &r);
    return r;
  }
  [[nodiscard]] std::vector<double> plate_residuals(const std::vector<imaging::PixelPoint>& frame) const;

  const StackEdges& edges_;
  cv::Size size_;
  double slope_ = 0;  // of the plate
  double window_;     // half width of the band of points that belong to the plate, px
  bool has_plate_ = false, has_left_ = false, has_right_ = false;
  double plate_row_ = 0;  // mean over the frames whose walls are used
  Chosen all_, kept_;
  Places places_;
  std::vector<double> p_;        // the parameters
  double error_[3] = {1, 1, 1};  // of a point on the left wall, the right wall, the plate
  FitReport report_;
};

double mean_x(const std::vector<WallRow>& wall) {
  double sum = 0;
  for (const WallRow& row : wall) sum += row.at.x_px / static_cast<double>(wall.size());
  return sum;
}

void GeometryFit::choose_points() {
  constexpr std::size_t kMinRows = 8;  // of a wall
  const std::size_t stride = std::max<std::size_t>(1, edges_.plate.size() / kPlateFrames);
  const std::optional<double> slope = plate_slope(edges_.plate, stride);
  has_plate_ = slope.has_value();
  slope_ = slope.value_or(0);
  for (std::size_t f = 0; f < edges_.plate.size(); f += stride) all_.plate.push_back(plate_points(f));
  all_.left = rows_of_wall(edges_.left, 0);
  all_.right = rows_of_wall(edges_.right, 1);
  put_floors(std::atan(slope_) / kDegree, 0);
  has_left_ = all_.left.size() >= kMinRows;
  has_right_ = all_.right.size() >= kMinRows;
  // With the wrong polarity the edges of beads are found, from the other side: a right wall left of the left
  // wall is an error.
  if (has_left_ && has_right_ && mean_x(all_.right) <= mean_x(all_.left)) has_left_ = has_right_ = false;
  if (!has_left_) all_.left.clear();
  if (!has_right_) all_.right.clear();
  if (!has_plate_ && !has_left_ && !has_right_)
    throw InputError(
        {.file = {}, .key = "edges"},
        "neither a plate nor a wall is seen: each needs a dark border of 3 px with light next to it, or with "
        "--bright a bright one with darkness next to it.");
}

// Sets the plate row of each wall row: its mean over the frames in which the row is seen, in the ideal
// picture; the mean over all frames where the plate is not detected.
void GeometryFit::put_floors(double rotation_deg, double k1) {
  std::vector<double> floors;
  double known = 0, sum = 0;
  for (std::size_t w = 0; w < std::max(edges_.left.size(), edges_.right.size()); ++w) {
    const std::size_t f = w * edges_.stride;
    const PlateSighting s = f < edges_.plate.size() ? sighting(plate_points(f), rotation_deg, k1, size_)
                                                    : PlateSighting{.height_px = kNaN};
    floors.push_back(-s.height_px);
    if (std::isfinite(s.height_px)) sum -= s.height_px, ++known;
  }
  plate_row_ = known > 0 ? sum / known : edges_.size.height - 1;
  for (std::vector<WallRow>* wall : {&all_.left, &all_.right})
    for (WallRow& row : *wall) {
      row.floor = 0;
      for (const std::size_t f : row.seen)
        row.floor += (std::isfinite(floors[f]) ? floors[f] : plate_row_) / row.frames;
    }
}

// Parameters and start values. Without a plate there is no level, and the rotation cannot be distinguished
// from tilts of the walls.
void GeometryFit::choose_parameters(bool with_distortion) {
  const auto add = [&](const char* name, double start) {
    p_.push_back(start);
    return places_.add(name);
  };
  if (has_plate_) places_.rotation = add("rotation", std::atan(slope_) / kDegree);
  if (has_left_) {
    places_.x_left = add("x_left", mean_x(all_.left));
    places_.tilt_left = add("tilt_left", 0);
  }
  if (has_right_) {
    places_.x_right = add("x_right", mean_x(all_.right));
    places_.tilt_right = add("tilt_right", 0);
  }
  if (with_distortion) places_.distortion = add("distortion", 0);
}

std::vector<double> GeometryFit::plate_residuals(const std::vector<imaging::PixelPoint>& frame) const {
  std::vector<double> r(frame.size()), q;
  for (const imaging::PixelPoint& at : frame) {
    double place[2];
    ideal(value_at(p_.data(), places_.rotation), value_at(p_.data(), places_.distortion), at.x_px, at.y_px,
          size_, place);
    q.push_back(place[1]);
  }
  const double middle = q.empty() ? 0 : upper_median(q);
  for (std::size_t i = 0; i < q.size(); ++i) r[i] = q[i] - middle;
  return r;
}

// The scatter of its points gives the error of an edge; points beyond kWorstSigma are rejected.
void GeometryFit::reject_wall_outliers(const std::vector<WallRow>& wall, bool left,
                                       std::vector<WallRow>& kept) {
  double& error = error_[left ? 0 : 1];
  std::vector<double> r;
  for (const WallRow& row : wall) r.push_back(wall_residual(row, left) * std::sqrt(row.frames));
  error = std::max(1e-3, robust_spread(r));
  for (std::size_t i = 0; i < r.size(); ++i)
    if (std::abs(r[i]) < kWorstSigma * error) kept.push_back(wall[i]);
}

// Likewise, with one scatter for all frames.
void GeometryFit::reject_plate_outliers() {
  std::vector<double> pooled;
  for (const auto& frame : all_.plate)
    for (const double r : plate_residuals(frame)) pooled.push_back(r);
  error_[2] = std::max(1e-3, robust_spread(pooled));
  for (const auto& frame : all_.plate) {
    const auto r = plate_residuals(frame);
    kept_.plate.emplace_back();
    for (std::size_t i = 0; i < r.size(); ++i)
      if (std::abs(r[i]) < kWorstSigma * error_[2]) kept_.plate.back().push_back(frame[i]);
  }
}

// Enlarges the errors by the correlation within blocks that are one bead wide.
void GeometryFit::include_correlation() {
  constexpr double kFittedToEdge = 3;  // parameters
  const auto block_of = [&](double place) { return static_cast<int>(place / edges_.diameter_px); };
  for (const bool left : {true, false}) {
    std::vector<std::pair<int, double>> r;
    for (const WallRow& row : left ? kept_.left : kept_.right)
      r.emplace_back(block_of(row.at.y_px), wall_residual(row, left) * std::sqrt(row.frames));
    error_[left ? 0 : 1] *= std::sqrt(block_factor(r, kFittedToEdge));
  }
  std::vector<std::pair<int, double>> r;
  for (const auto& frame : kept_.plate) {
    const auto of_frame = plate_residuals(frame);
    for (std::size_t i = 0; i < frame.size(); ++i) r.emplace_back(block_of(frame[i].x_px), of_frame[i]);
  }
  error_[2] *= std::sqrt(block_factor(r, kFittedToEdge));
}

// Systematic error: an offset of kEdgeModelError_px at one end of a line also changes its tilt.
void GeometryFit::add_systematic_errors() {
  if (report_.covariance.size() == 0) return;
  const auto add_error = [&](int place, double more) {
    if (place < 0) return;
    report_.covariance(place, place) += more * more;
    report_.standard_errors[static_cast<std::size_t>(place)] = std::sqrt(report_.covariance(place, place));
  };
  const auto span = [](const std::vector<WallRow>& wall) {
    return wall.empty() ? 1.0 : std::max(1.0, wall.back().at.y_px - wall.front().at.y_px);
  };
  constexpr double e = kEdgeModelError_px;
  add_error(places_.x_left, e);
  add_error(places_.x_right, e);
  add_error(places_.tilt_left, e / span(kept_.left) / kDegree);
  add_error(places_.tilt_right, e / span(kept_.right) / kDegree);
  add_error(places_.rotation, e / size_.width / kDegree);
  add_error(places_.distortion, 4 * e / std::hypot(size_.width, size_.height));
}

void GeometryFit::add_residuals(CellGeometry& g) const {
  for (const bool left : {true, false})
    for (const WallRow& row : left ? kept_.left : kept_.right)
      g.residuals.push_back({row.at, wall_residual(row, left)});
  for (const auto& frame : kept_.plate) {
    const auto r = plate_residuals(frame);
    for (std::size_t i = 0; i < r.size(); ++i) g.residuals.push_back({frame[i], r[i]});
  }
}

// Height of the plate in every frame, above its mean row.
void GeometryFit::add_heights(CellGeometry& g) const {
  double sum = 0, squares = 0, n = 0;
  for (std::size_t f = 0; f < edges_.plate.size(); ++f) {
    const PlateSighting s = sighting(plate_points(f), g.rotation_deg, g.distortion, g.size);
    g.heights.push_back(s);
    if (!std::isfinite(s.height_px)) continue;
    sum -= s.height_px;
    squares += s.sigma_px * s.sigma_px;
    ++n;
  }
  if (n == 0) return;
  g.plate_row = sum / n;
  if (g.fit.covariance.size() > 0) add_errors_of_map(g);
  g.plate_row_error = std::hypot(std::sqrt(squares) / n, g.plate_row_error_of_map);
  for (PlateSighting& s : g.heights) s.height_px += g.plate_row;
}

// Errors of rotation and distortion also shift and stretch the heights.
void GeometryFit::add_errors_of_map(CellGeometry& g) const {
  const PlateSighting *low = nullptr, *high = nullptr;
  for (const PlateSighting& s : g.heights) {
    if (!std::isfinite(s.height_px)) continue;
    if (!low || s.height_px < low->height_px) low = &s;
    if (!high || s.height_px > high->height_px) high = &s;
  }
  const auto moved = [&](const PlateSighting& s, int place) {
    const auto frame = static_cast<std::size_t>(&s - g.heights.data());
    const double step = g.fit.standard_errors[static_cast<std::size_t>(place)];
    const double turn = place == places_.rotation ? step : 0, bend = place == places_.distortion ? step : 0;
    return sighting(plate_points(frame), g.rotation_deg + turn, g.distortion + bend, g.size).height_px -
           s.height_px;
  };
  for (const int place : {places_.rotation, places_.distortion}) {
    if (place < 0) continue;
    const double up = moved(*high, place), down = moved(*low, place);
    g.plate_row_error_of_map = std::hypot(g.plate_row_error_of_map, 0.5 * (up + down));
    if (high->height_px > low->height_px)
      g.stretch_error = std::hypot(g.stretch_error, (up - down) / (high->height_px - low->height_px));
  }
}

}  // namespace

CellGeometry fit_cell_geometry(const StackEdges& edges, bool with_distortion) {
  GeometryFit fit(edges, with_distortion);
  fit.fit();
  if (const auto lines = fit.without_false_walls()) return fit_cell_geometry(*lines, with_distortion);
  if (!with_distortion) return fit.geometry(0);
  const double found = fit.report().value("distortion"), error = fit.report().standard_error("distortion");
  // An insignificant distortion would reduce the accuracy of all other parameters.
  const bool significant = std::abs(found) > 3 * error;
  CellGeometry g = significant ? fit.geometry(found) : fit_cell_geometry(edges, false);
  g.distortion_found = found;
  g.distortion_error = error;
  return g;
}

}  // namespace twincell::calibration
