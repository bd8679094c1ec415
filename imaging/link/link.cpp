#include "imaging/link/link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "core/error.hpp"
#include "imaging/link/assignment.hpp"
#include "imaging/link/collective_matching.hpp"

namespace twincell {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kFar = 1e9;  // px, beyond any camera

/// The numbers of the linker. d: bead diameter. Costs are log-odds, natural logarithm. Where no source is
/// given, none is recorded.
struct LinkCosts {
  // Lookup and prediction.
  double settle_reach = 0.25;    ///< d; a detection this close has no rival, because discs do not overlap
  double lookup_reach = 0.5;     ///< d; reach of the lookup
  double rival_ratio = 2;        ///< a second candidate this many times farther away is no rival
  double neighbour_reach = 2.1;  ///< d; distance of neighbours whose steps are compared
  double good_fit = 0.95;        ///< fit, 0 .. 1, above which no further rule is tried
  double open_fraction = 0.03;   ///< of all tracks; with more open ones, the settled ones are checked again
  double agreeing_steps = 0.3;   ///< d; difference between neighbours' steps that agree
  double agreeing_predictions = 0.1;  ///< d; difference between predictions that agree
  double preference_margin = 0.05;    ///< d; a detection must be closer by this much to be preferred
  double common_shift_sigma =
      0.5;  ///< d; standard deviation of the common shift about that of the centre of mass
  std::size_t sample_tracks = 200;  ///< tracks on which the rules are tried
  int neighbour_rounds = 12;        ///< rounds of following neighbours

  // Assignment: exchange of two crossing links, by the closest approach of the centres.
  double passing_through = 0.6;    ///< d; below, one disc passes through the other
  double passing_clear = 0.8;      ///< d; above, it does not
  double exchange_cost_limit = 8;  ///< log-odds; most expensive exchange that is made to avoid it
  std::size_t max_edges = 16;      ///< choices of one track in the assignment

  // Collective matching: when, and among which choices.
  double touching_reach = 1.3;  ///< d; distance of touching neighbours
  double separation =
      0.8;  ///< d; difference of touching neighbours' steps beyond which the frame is rematched
  double matching_reach = 1.9;        ///< d; reach about an expected position
  std::size_t max_choices = 40;       ///< choices of one track
  std::size_t max_mean_choices = 25;  ///< mean choices of a track; with more, the matching is not attempted
  double least_outward_step = 0.1;    ///< d; smallest step of a bead that leaves an open picture
  double entry_margin = 1;            ///< d; distance from the border within which beads come into sight
  double left_over_reach = 8;  ///< d; largest distance between the last tracks and the detections left over

  // Densities of prediction errors.
  double prediction_width = 0.12;   ///< d; core width for the expected position, see `cost`
  double ballistic_width = 0.02;    ///< d; core width for free flight
  double ballistic_exponent = 2.5;  ///< its exponent
  // For a path with one collision. Width and exponent were fitted to the links of simulated convecting cells,
  // by their odds against the other choices. With the fitted cost, -2, fewer wrong links are removed than
  // with this one.
  double collision_width = 0.02;     ///< d; core width
  double collision_exponent = 1.25;  ///< its exponent
  double collision_cost = -4;        ///< log-odds; of a path with one collision

  // Costs of the explanations of a detection, and of having none.
  double ballistic_cost = 2;             ///< log-odds; being in free flight
  double any_position_cost = 6;          ///< log-odds; being anywhere within reach
  double type_change_cost = 3;           ///< log-odds; changing from tracer to bead or back
  double no_match_cost = 16;             ///< log-odds; having no detection
  double unconfirmed_no_match_cost = 0;  ///< log-odds; the same for a track seen in one frame only
  double leaving_cost = 0;  ///< log-odds; the same for a bead that leaves an open picture or is missing in it
};
constexpr LinkCosts kCosts;

PixelPoint operator+(PixelPoint a, PixelPoint b) {
  return {a.x_px + b.x_px, a.y_px + b.y_px};
}
PixelPoint operator-(PixelPoint a, PixelPoint b) {
  return {a.x_px - b.x_px, a.y_px - b.y_px};
}
PixelPoint operator*(double f, PixelPoint a) {
  return {f * a.x_px, f * a.y_px};
}
double square(PixelPoint a) {
  return a.x_px * a.x_px + a.y_px * a.y_px;
}

/// Median of each coordinate; reorders the points. 0 if there are no points.
PixelPoint median(std::vector<PixelPoint>& points) {
  if (points.empty()) return {};
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(),
                   [](PixelPoint a, PixelPoint b) { return a.x_px < b.x_px; });
  const double x = middle->x_px;
  std::nth_element(points.begin(), middle, points.end(),
                   [](PixelPoint a, PixelPoint b) { return a.y_px < b.y_px; });
  return {x, middle->y_px};
}

/// Cost of a link with squared prediction error r2. The errors have a narrow core and, from collisions
/// between two frames, a long tail: a density (1 + r^2/w^2)^(-3/2) / w^2 in the plane. The cost is its
/// negative logarithm, so that differences of costs are log-odds. With squared distances, the usual cost, one
/// large error would outweigh many small ones.
double cost(double r2, double width) {
  return 1.5 * std::log1p(r2 / (width * width)) + 2 * std::log(width);
}

}  // namespace

/// Points sorted into square cells, for the search of points within a given distance.
class Linker::Grid {
 public:
  Grid(std::span<const PixelPoint> points, double cell) : size_(cell) {
    const std::size_t n = points.size();
    double x1 = 0, y1 = 0;
    if (n > 0) {
      x0_ = x1 = points[0].x_px;
      y0_ = y1 = points[0].y_px;
    }
    for (const PixelPoint p : points) {
      x0_ = std::min(x0_, p.x_px);
      x1 = std::max(x1, p.x_px);
      y0_ = std::min(y0_, p.y_px);
      y1 = std::max(y1, p.y_px);
    }
    // A few distant outliers must not cost memory.
    const double most = 4.0 * static_cast<double>(n) + 1024;
    while (((x1 - x0_) / size_ + 1) * ((y1 - y0_) / size_ + 1) > most) size_ *= 1.5;
    inverse_ = 1 / size_;
    nx_ = static_cast<int>((x1 - x0_) * inverse_) + 1;
    ny_ = static_cast<int>((y1 - y0_) * inverse_) + 1;
    first_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) + 1, 0);
    std::vector<std::int32_t> cell_of(n);
    for (std::size_t i = 0; i < n; ++i) {
      cell_of[i] = row(points[i].y_px) * nx_ + column(points[i].x_px);
      ++first_[static_cast<std::size_t>(cell_of[i]) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
    points_.resize(n);
    original_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(next[static_cast<std::size_t>(cell_of[i])]++);
      points_[k] = points[i];
      original_[k] = static_cast<std::int32_t>(i);
    }
  }
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] PixelPoint operator[](std::size_t k) const { return points_[k]; }
  [[nodiscard]] std::size_t original(std::size_t k) const { return static_cast<std::size_t>(original_[k]); }

  /// visit(k, squared distance) for all points within reach.
  template <class Visit>
  void within(PixelPoint p, double reach, Visit&& visit) const {
    if (points_.empty()) return;
    const int i0 = column(p.x_px - reach), i1 = column(p.x_px + reach);
    const int j1 = row(p.y_px + reach);
    const double most = reach * reach;
    for (int j = row(p.y_px - reach); j <= j1; ++j) {
      const auto end = first_[static_cast<std::size_t>(j * nx_ + i1) + 1];
      for (auto k = first_[static_cast<std::size_t>(j * nx_ + i0)]; k < end; ++k) {
        const double r2 = square(points_[static_cast<std::size_t>(k)] - p);
        if (r2 <= most) visit(static_cast<std::size_t>(k), r2);
      }
    }
  }

 private:
  // Clamped, so that a search outside the grid uses the cells at its rim.
  [[nodiscard]] int column(double x) const {
    return static_cast<int>(std::clamp((x - x0_) * inverse_, 0.0, static_cast<double>(nx_ - 1)));
  }
  [[nodiscard]] int row(double y) const {
    return static_cast<int>(std::clamp((y - y0_) * inverse_, 0.0, static_cast<double>(ny_ - 1)));
  }
  double size_, inverse_ = 0, x0_ = 0, y0_ = 0;
  int nx_ = 1, ny_ = 1;
  std::vector<std::int32_t> first_, original_;
  std::vector<PixelPoint> points_;
};

void LinkReport::add(const LinkReport& f) {
  frames += f.frames;
  links += f.links;
  settled += f.settled;
  bridged += f.bridged;
  ambiguous += f.ambiguous;
  births += f.births;
  losses += f.losses;
  networks += f.networks;
  largest_network = std::max(largest_network, f.largest_network);
  unsolved += f.unsolved;
  rematched += f.rematched;
  unclear_shifts += f.unclear_shifts;
}

Linker::Linker(const LinkOptions& options, int phases_per_cycle)
    : options_(options), phases_(phases_per_cycle > kMostPhases ? 0 : phases_per_cycle) {
  auto at = [](const char* key) { return Where{.file = {}, .key = key}; };
  require_range(at("diameter"), options.diameter_px, 0, std::nullopt, true);
  require_range(at("range"), options.range_diameters, 0, 10, true);
  require_range(at("memory"), options.memory, 0, 1000);
  require_range(at("max-shift"), options.max_shift_diameters, 0, 10);
  require_range(at("ambiguous-odds"), options.ambiguous_odds, 1, std::nullopt);
  cycle_of_phase_.assign(static_cast<std::size_t>(phases_), -2);
}

PixelPoint Linker::predict(std::size_t t, PredictionRule rule, const FrameTime& time) const {
  const Track& track = tracks_[t];
  switch (rule) {
    case PredictionRule::still:
      break;
    case PredictionRule::step:
      return track.place + time.interval * track.step;
    case PredictionRule::cycle: {
      const PixelPoint p =
          cycle_places_[t * static_cast<std::size_t>(phases_) + static_cast<std::size_t>(time.phase)];
      const PixelPoint there = p + track.drift;
      if (std::isfinite(there.x_px)) return there;
      return track.place + time.interval * track.step;
    }
  }
  return track.place;
}

namespace {

/// Quality of fit between shifted predictions and detections: mean over the tracks of 1 - (r / 0.25 d)^2,
/// with 0 for r > 0.25 d.
template <class Grid>
double fit(const std::vector<PixelPoint>& expected, PixelPoint shift, const Grid& grid, double d) {
  if (expected.empty()) return 0;
  const double reach = kCosts.settle_reach * d;
  double sum = 0;
  for (const PixelPoint p : expected) {
    double least = reach * reach;
    grid.within(p + shift, reach, [&](std::size_t, double r2) { least = std::min(least, r2); });
    sum += 1 - least / (reach * reach);
  }
  return sum / static_cast<double>(expected.size());
}

/// Median displacement from the predictions to the nearest detections. It is repeated `times` times; each
/// repetition searches about the predictions shifted by the previous result.
template <class Grid>
PixelPoint median_displacement(const std::vector<PixelPoint>& expected, const Grid& grid, double d,
                               PixelPoint shift, int times) {
  std::vector<PixelPoint> displacements;
  for (; times > 0; --times) {
    displacements.clear();
    for (const PixelPoint p : expected) {
      double least = std::numeric_limits<double>::infinity();
      std::size_t nearest = 0;
      grid.within(p + shift, kCosts.lookup_reach * d, [&](std::size_t k, double r2) {
        if (r2 < least) {
          least = r2;
          nearest = k;
        }
      });
      if (std::isfinite(least)) displacements.push_back(grid[nearest] - p);
    }
    if (displacements.empty()) return shift;
    shift = median(displacements);
  }
  return shift;
}

struct Shift {
  PixelPoint px;
  bool unclear = false;  // another shift fits nearly as well
};

/// Most common displacement: the peak of the histogram of all displacements from predictions to detections
/// within reach, in cells of d/8 summed over 3 x 3 cells. Except at its rim, a crystal looks the same after a
/// shift by a lattice vector. Among peaks of nearly equal height, the weight therefore favours the one
/// nearest to `likely`.
template <class Grid>
Shift most_common_displacement(const std::vector<PixelPoint>& expected, const Grid& grid, double d,
                               double reach, PixelPoint likely) {
  const double cell = d / 8;
  const int half = static_cast<int>(std::ceil(reach / cell)) + 1;
  const auto n = static_cast<std::size_t>(2 * half + 1);
  std::vector<int> count(n * n);
  auto at = [&](int i, int j) {
    return static_cast<std::size_t>(j + half) * n + static_cast<std::size_t>(i + half);
  };
  auto cell_of = [&](double v) { return static_cast<int>(std::lround(v / cell)); };
  for (const PixelPoint p : expected)
    grid.within(p, reach, [&](std::size_t k, double) {
      const PixelPoint displacement = grid[k] - p;
      ++count[at(cell_of(displacement.x_px), cell_of(displacement.y_px))];
    });
  std::vector<double> sums(n * n);
  double best = 0;
  int best_i = 0, best_j = 0;
  for (int j = 1 - half; j < half; ++j)
    for (int i = 1 - half; i < half; ++i) {
      double sum = 0;
      for (int b = -1; b <= 1; ++b)
        for (int a = -1; a <= 1; ++a) sum += count[at(i + a, j + b)];
      sum *= std::exp(-0.5 * square(PixelPoint{i * cell, j * cell} - likely) /
                      (kCosts.common_shift_sigma * kCosts.common_shift_sigma * d * d));
      sums[at(i, j)] = sum;
      if (sum > best) {
        best = sum;
        best_i = i;
        best_j = j;
      }
    }
  if (best <= 0) return {};
  double rival = 0;
  for (int j = 1 - half; j < half; ++j)
    for (int i = 1 - half; i < half; ++i)
      if (std::max(std::abs(i - best_i), std::abs(j - best_j)) > 4) rival = std::max(rival, sums[at(i, j)]);
  return {median_displacement(expected, grid, d, {best_i * cell, best_j * cell}, 1), rival > 0.98 * best};
}

}  // namespace

// Chooses the rule that fits best and estimates the common shift of all beads from it.
void Linker::predict_all(const Grid& grid, const FrameTime& time) {
  const double d = options_.diameter_px;
  std::vector<std::size_t> alive;
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    if (tracks_[t].missed == 0) alive.push_back(t);
  const std::size_t stride = std::max<std::size_t>(1, alive.size() / kCosts.sample_tracks);
  std::vector<PredictionRule> rules = {PredictionRule::still, PredictionRule::step};
  const bool remembers = time.phase >= 0 && time.phase < phases_ && time.cycle > 0 &&
                         cycle_of_phase_[static_cast<std::size_t>(time.phase)] == time.cycle - 1;
  if (remembers) rules.push_back(PredictionRule::cycle);
  PixelPoint centre;
  for (std::size_t k = 0; k < grid.size(); ++k) centre = centre + grid[k];
  const bool moves = options_.max_shift_diameters > 0 && !alive.empty() && grid.size() > 0;
  if (moves) centre = (1.0 / static_cast<double>(grid.size())) * centre;
  // Rules: the first is kept unless a later one fits clearly better.
  PredictionRule best_rule = PredictionRule::step;
  PixelPoint best_shift;
  double best_fit = -1;
  for (const PredictionRule rule : rules) {
    std::vector<PixelPoint> sample;
    PixelPoint mean;
    for (std::size_t a = 0; a < alive.size(); ++a) {
      const PixelPoint p = predict(alive[a], rule, time);
      mean = mean + p;
      if (a % stride == 0) sample.push_back(p);
    }
    PixelPoint shift;
    if (moves) {
      // Start from the centre of mass, which moves with the bed and has no lattice ambiguity.
      shift = centre - (1.0 / static_cast<double>(alive.size())) * mean;
      if (square(shift) > options_.max_shift_diameters * options_.max_shift_diameters * d * d) shift = {};
      shift = median_displacement(sample, grid, d, shift, 2);
    }
    const double f = fit(sample, shift, grid, d);
    if (f > best_fit + 0.03) {
      best_fit = f;
      best_rule = rule;
      best_shift = shift;
    }
    if (best_fit > kCosts.good_fit) break;
  }
  // Poor fit: search all common shifts within reach.
  if (moves && best_fit < 0.5) {
    std::vector<PixelPoint> expected;
    PixelPoint mean;
    for (const std::size_t t : alive) {
      expected.push_back(predict(t, best_rule, time));
      mean = mean + expected.back();
    }
    mean = centre - (1.0 / static_cast<double>(alive.size())) * mean;
    const Shift other = most_common_displacement(expected, grid, d, options_.max_shift_diameters * d, mean);
    if (fit(expected, other.px, grid, d) > fit(expected, best_shift, grid, d)) best_shift = other.px;
    last_.unclear_shifts += other.unclear ? 1 : 0;
  }
  // Floor: no bead is expected below the lowest detection. The plate stops a landing bed, and its lowest row
  // lands first.
  double floor = -kFar;
  for (std::size_t k = 0; k < grid.size(); ++k) floor = std::max(floor, grid[k].y_px);
  auto above_floor = [&](PixelPoint p) { return PixelPoint{p.x_px, std::min(p.y_px, floor)}; };
  ballistic_.resize(tracks_.size());
  expected_.resize(tracks_.size());
  expected_no_floor_.resize(tracks_.size());
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    ballistic_[t] = above_floor(in_flight(t, time));
    const PixelPoint p =
        tracks_[t].missed == 0 ? predict(t, best_rule, time) : tracks_[t].place + time.interval * step_;
    expected_no_floor_[t] = p + best_shift;
    expected_[t] = above_floor(expected_no_floor_[t]);
  }
}

// Position in free flight: the step repeats itself and grows by the fall.
PixelPoint Linker::in_flight(std::size_t t, const FrameTime& time) const {
  return tracks_[t].place + time.interval * tracks_[t].step +
         PixelPoint{0, options_.fall_px * time.interval * time.interval};
}

// Links detections within 0.25 d of the expected position of a track if neither has a rival. If the position
// in free flight fits another detection better, the track is left to the assignment.
void Linker::settle(const Grid& grid, std::span<const std::uint8_t> tracers) {
  const double d = options_.diameter_px, infinity = std::numeric_limits<double>::infinity();
  struct Candidate {
    double r2 = std::numeric_limits<double>::infinity(), second = std::numeric_limits<double>::infinity();
    std::int32_t track = -1;
  };
  std::vector<Candidate> candidates(grid.size());
  struct Choice {
    double r2, second;
    std::int32_t detection;
  };
  std::vector<Choice> choices(tracks_.size());
  rival_distance_.assign(tracks_.size(), infinity);
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Choice c{infinity, infinity, -1};
    grid.within(expected_[t], kCosts.lookup_reach * d, [&](std::size_t k, double r2) {
      if (r2 < c.r2) {
        c.second = c.r2;
        c.r2 = r2;
        c.detection = static_cast<std::int32_t>(k);
      } else {
        c.second = std::min(c.second, r2);
      }
    });
    choices[t] = c;
    if (c.detection < 0 || tracks_[t].missed > 0) continue;
    Candidate& s = candidates[static_cast<std::size_t>(c.detection)];
    if (c.r2 < s.r2) {
      s.second = s.r2;
      s.r2 = c.r2;
      s.track = static_cast<std::int32_t>(t);
    } else {
      s.second = std::min(s.second, c.r2);
    }
    if (square(ballistic_[t] - expected_[t]) <
        kCosts.agreeing_predictions * kCosts.agreeing_predictions * d * d)
      continue;
    const double reach = std::min(std::sqrt(c.r2) + kCosts.preference_margin * d, kCosts.settle_reach * d);
    grid.within(ballistic_[t], reach, [&](std::size_t k, double r2) {
      if (static_cast<std::int32_t>(k) != c.detection)
        rival_distance_[t] = std::min(rival_distance_[t], std::sqrt(r2));
    });
  }
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Choice& c = choices[t];
    if (c.detection < 0 || c.r2 > kCosts.settle_reach * kCosts.settle_reach * d * d ||
        tracks_[t].missed > 0 || rival_distance_[t] < infinity)
      continue;
    const auto k = static_cast<std::size_t>(c.detection);
    const Candidate& s = candidates[k];
    if (s.track != static_cast<std::int32_t>(t)) continue;
    if (kCosts.rival_ratio * kCosts.rival_ratio * c.r2 >= std::min(c.second, s.second)) continue;
    if (!tracers.empty() && tracers[grid.original(k)] != tracks_[t].tracer) continue;
    detection_of_[t] = c.detection;
    track_of_[k] = static_cast<std::int32_t>(t);
    ++last_.settled;
  }
}

// Predicts open tracks from their settled neighbours, and reopens settled tracks that do not agree with their
// neighbours and were settled by chance. An alternative was tried: pushing predictions apart where discs
// would overlap, from the plate upwards. Fewer links were wrong in convecting beds (by 7 in 100), more in
// bouncing beds, and it was a quarter slower.
void Linker::follow_neighbours(const Grid& grid) {
  const double d = options_.diameter_px;
  neighbour_correction_.assign(tracks_.size(), {kNaN, kNaN});
  std::vector<std::int32_t> open;
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    if (detection_of_[t] < 0) open.push_back(static_cast<std::int32_t>(t));
  if (open.empty() || open.size() == tracks_.size()) return;
  std::vector<PixelPoint> places;
  for (const Track& t : tracks_) places.push_back(t.place);
  const Grid neighbours(places, 1.1 * d);
  std::vector<PixelPoint> displacements;
  auto gather = [&](std::size_t t) {
    displacements.clear();
    neighbours.within(tracks_[t].place, kCosts.neighbour_reach * d, [&](std::size_t k, double) {
      const std::size_t other = neighbours.original(k);
      if (const std::int32_t with = detection_of_[other]; with >= 0 && other != t)
        displacements.push_back(grid[static_cast<std::size_t>(with)] - expected_no_floor_[other]);
    });
  };
  // Check: reopen settled tracks whose correction differs from that of most neighbours.
  if (static_cast<double>(open.size()) > kCosts.open_fraction * static_cast<double>(tracks_.size())) {
    std::vector<std::int32_t> odd;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      if (detection_of_[t] < 0) continue;
      gather(t);
      const PixelPoint displacement =
          grid[static_cast<std::size_t>(detection_of_[t])] - expected_no_floor_[t];
      std::size_t alike = 0;
      for (const PixelPoint w : displacements)
        alike += square(w - displacement) < kCosts.agreeing_steps * kCosts.agreeing_steps * d * d ? 1 : 0;
      if (displacements.size() >= 3 && 3 * alike < 1 * displacements.size())
        odd.push_back(static_cast<std::int32_t>(t));
    }
    for (const std::int32_t t : odd) {
      std::int32_t& k = detection_of_[static_cast<std::size_t>(t)];
      track_of_[static_cast<std::size_t>(k)] = -1;
      k = -1;
      open.push_back(t);
      --last_.settled;
    }
  }
  // Rounds: link open tracks next to settled ones, so that links spread through the bed.
  std::vector<std::pair<double, std::int32_t>> candidate(grid.size());
  for (int round = 0; round < kCosts.neighbour_rounds && !open.empty(); ++round) {
    std::vector<std::pair<std::int32_t, std::int32_t>> proposals;
    std::fill(candidate.begin(), candidate.end(), std::pair{std::numeric_limits<double>::infinity(), -1});
    for (const std::int32_t open_track : open) {
      const auto t = static_cast<std::size_t>(open_track);
      gather(t);
      if (displacements.size() < 3) continue;
      neighbour_correction_[t] = median(displacements);
      const PixelPoint p = expected_no_floor_[t] + neighbour_correction_[t];
      const double reach =
          std::min(kCosts.settle_reach * d, rival_distance_[t] - kCosts.preference_margin * d);
      if (reach <= 0) continue;
      double least = reach * reach;
      std::int32_t nearest = -1;
      grid.within(p, reach, [&](std::size_t k, double r2) {
        if (track_of_[k] >= 0 || r2 >= least) return;
        least = r2;
        nearest = static_cast<std::int32_t>(k);
      });
      if (nearest < 0) continue;
      proposals.emplace_back(open_track, nearest);
      auto& s = candidate[static_cast<std::size_t>(nearest)];
      s = std::min(s, std::pair{least, open_track});
    }
    bool any = false;
    for (const auto& [t, k] : proposals) {
      if (candidate[static_cast<std::size_t>(k)].second != t) continue;
      detection_of_[static_cast<std::size_t>(t)] = k;
      track_of_[static_cast<std::size_t>(k)] = t;
      any = true;
    }
    if (!any) break;
    std::erase_if(open, [&](std::int32_t t) { return detection_of_[static_cast<std::size_t>(t)] >= 0; });
  }
}

namespace {

/// Closest approach of two beads that move along straight lines at constant velocity.
double closest(PixelPoint from_a, PixelPoint to_a, PixelPoint from_b, PixelPoint to_b) {
  const PixelPoint before = from_a - from_b, change = to_a - to_b - before;
  const double c2 = square(change), dot = before.x_px * change.x_px + before.y_px * change.y_px;
  return std::sqrt(square(before + (c2 > 0 ? std::clamp(-dot / c2, 0.0, 1.0) : 0) * change));
}

/// Exchanges two links on which one disc would pass through the other, if the exchanged links are allowed and
/// not too expensive. Discs of one layer cannot pass through each other, but a sum of single costs does not
/// express that.
void exchange_crossing_links(Assignment& best, const std::vector<Edge>& edges,
                             const std::vector<PixelPoint>& from, const std::vector<PixelPoint>& to,
                             double d) {
  auto edges_of = [&](std::size_t row) {
    return std::equal_range(edges.begin(), edges.end(), Edge{static_cast<std::uint32_t>(row), 0, 0},
                            [](const Edge& a, const Edge& b) { return a.row < b.row; });
  };
  auto cost_of = [&](std::size_t row, std::int64_t column) {
    const auto [begin, end] = edges_of(row);
    const auto e = std::find_if(begin, end, [&](const Edge& a) { return a.column == column; });
    return e == end ? std::numeric_limits<double>::infinity() : e->cost;
  };
  std::vector<std::int64_t> row_of(to.size(), Assignment::kAlone);
  for (std::size_t i = 0; i < from.size(); ++i)
    if (best.column_of_row[i] >= 0)
      row_of[static_cast<std::size_t>(best.column_of_row[i])] = static_cast<std::int64_t>(i);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::int64_t& mine = best.column_of_row[i];
    if (mine < 0) continue;
    const auto [begin, end] = edges_of(i);
    for (auto e = begin; e != end; ++e) {
      if (row_of[e->column] < 0 || e->column == mine) continue;
      const auto j = static_cast<std::size_t>(row_of[e->column]);
      std::int64_t& theirs = best.column_of_row[j];
      const PixelPoint a = to[static_cast<std::size_t>(mine)], b = to[static_cast<std::size_t>(theirs)];
      if (closest(from[i], a, from[j], b) > kCosts.passing_through * d ||
          closest(from[i], b, from[j], a) < kCosts.passing_clear * d)
        continue;
      if (e->cost + cost_of(j, mine) - cost_of(i, mine) - cost_of(j, theirs) > kCosts.exchange_cost_limit)
        continue;
      std::swap(mine, theirs);
      std::swap(row_of[static_cast<std::size_t>(mine)], row_of[static_cast<std::size_t>(theirs)]);
      break;
    }
  }
}

}  // namespace

void Linker::mark_ambiguous(std::size_t detection) {
  if (std::exchange(ambiguous_[detection], std::uint8_t{1}) == 0) ++last_.ambiguous;
}

// Assigns the remaining tracks to the remaining detections at minimum total cost.
void Linker::assign_rest(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameTime& time) {
  const double d = options_.diameter_px;
  // Edges: for each open track, the free detections that are cheaper than staying alone.
  const double alone = cost(options_.range_diameters * options_.range_diameters, kCosts.prediction_width);
  std::vector<std::int32_t> rows;
  std::vector<Edge> edges, own;
  std::vector<std::int32_t> column_of(grid.size(), -1), columns;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (detection_of_[t] >= 0) continue;
    const Track& track = tracks_[t];
    const double width = kCosts.prediction_width * (1 + track.missed);
    const double range = options_.range_diameters * (1 + 0.5 * track.missed) * d;
    // Possible positions, each with the cost of assuming it.
    std::vector<std::pair<PixelPoint, double>> guesses = {{expected_[t], 0}};
    if (std::isfinite(neighbour_correction_[t].x_px)) {
      guesses.front().second = 0.7;
      guesses.emplace_back(expected_no_floor_[t] + neighbour_correction_[t], 0);
    }
    if (track.missed == 0) {
      guesses.emplace_back(track.place + time.interval * step_, 0.7);
      guesses.emplace_back(ballistic_[t], 0);
    }
    own.clear();
    grid.within(expected_[t], range, [&](std::size_t k, double) {
      if (track_of_[k] >= 0) return;
      double least = std::numeric_limits<double>::infinity();
      for (const auto& [guess, extra] : guesses)
        least = std::min(least, cost(square(grid[k] - guess) / (d * d), width) + extra);
      if (!tracers.empty() && tracers[grid.original(k)] != track.tracer) least += kCosts.type_change_cost;
      if (least >= alone) return;
      own.push_back({static_cast<std::uint32_t>(rows.size()), static_cast<std::uint32_t>(k), least - alone});
    });
    if (own.empty()) continue;
    if (own.size() > kCosts.max_edges) {
      std::nth_element(own.begin(), own.begin() + kCosts.max_edges, own.end(),
                       [](const Edge& a, const Edge& b) {
                         return a.cost < b.cost || (a.cost == b.cost && a.column < b.column);
                       });
      own.resize(kCosts.max_edges);
    }
    for (Edge& e : own) {
      std::int32_t& column = column_of[e.column];
      if (column < 0) {
        column = static_cast<std::int32_t>(columns.size());
        columns.push_back(static_cast<std::int32_t>(e.column));
      }
      e.column = static_cast<std::uint32_t>(column);
      edges.push_back(e);
    }
    rows.push_back(static_cast<std::int32_t>(t));
  }
  if (rows.empty()) return;
  // Assignment, then the exchange of links on crossing paths.
  Assignment best = assign(rows.size(), columns.size(), edges);
  last_.networks = static_cast<std::int64_t>(best.networks);
  last_.largest_network = static_cast<std::int64_t>(best.largest_network);
  last_.unsolved = static_cast<std::int64_t>(best.unsolved);
  const double least_margin = std::log(options_.ambiguous_odds);
  std::vector<PixelPoint> from, to;
  for (const std::int32_t t : rows) from.push_back(tracks_[static_cast<std::size_t>(t)].place);
  for (const std::int32_t k : columns) to.push_back(grid[static_cast<std::size_t>(k)]);
  exchange_crossing_links(best, edges, from, to, d);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (best.column_of_row[i] < 0) continue;
    const std::int32_t k = columns[static_cast<std::size_t>(best.column_of_row[i])];
    detection_of_[static_cast<std::size_t>(rows[i])] = k;
    track_of_[static_cast<std::size_t>(k)] = rows[i];
    if (best.margin[i] >= least_margin) continue;
    mark_ambiguous(grid.original(static_cast<std::size_t>(k)));
  }
}

// Whether the links are implausible: touching neighbours separate, or a track has no detection although one
// is left over.
bool Linker::neighbours_separate(const Grid& grid) const {
  const double d = options_.diameter_px;
  std::vector<PixelPoint> places;
  for (const Track& t : tracks_) places.push_back(t.place);
  const Grid neighbours(places, 1.1 * d);
  const bool left_over = std::find(track_of_.begin(), track_of_.end(), -1) != track_of_.end();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (tracks_[t].missed > 0) continue;
    if (detection_of_[t] < 0) {
      if (left_over) return true;
      continue;
    }
    const PixelPoint step = grid[static_cast<std::size_t>(detection_of_[t])] - tracks_[t].place;
    bool separates = false;
    neighbours.within(tracks_[t].place, kCosts.touching_reach * d, [&](std::size_t k, double) {
      const std::size_t other = neighbours.original(k);
      if (tracks_[other].missed > 0 || detection_of_[other] < 0) return;
      const PixelPoint theirs = grid[static_cast<std::size_t>(detection_of_[other])] - tracks_[other].place;
      separates = separates || square(theirs - step) > kCosts.separation * kCosts.separation * d * d;
    });
    if (separates) return true;
  }
  return false;
}

// Whether a track is unconfirmed. A track that began one frame ago may be no bead: a speck of dust visible in
// one frame must not take the detection of a bead.
bool Linker::is_unconfirmed(const Track& track) const {
  return track.seen == 1 && total_.frames > 1;
}

// Whether there are as many detections as tracks and no track is missing or unconfirmed.
bool Linker::is_complete(const Grid& grid) const {
  return grid.size() == tracks_.size() && std::all_of(tracks_.begin(), tracks_.end(), [&](const Track& t) {
           return t.missed == 0 && !is_unconfirmed(t);
         });
}

// Cost of having no detection. A visible bead does not vanish, unless it leaves an open picture, that is,
// crosses the bounding box of all detections so far.
double Linker::cost_of_no_match(std::size_t t) const {
  if (is_unconfirmed(tracks_[t])) return kCosts.unconfirmed_no_match_cost;
  if (options_.closed) return kCosts.no_match_cost;
  if (tracks_[t].missed > 0) return kCosts.leaving_cost;
  const PixelPoint from = tracks_[t].place, to = from + tracks_[t].step;
  const double least = kCosts.least_outward_step * options_.diameter_px;
  const auto leaves = [&](double x, double was, double low, double high) {
    return (x < low && was - x > least) || (x > high && x - was > least);
  };
  return leaves(to.x_px, from.x_px, low_.x_px, high_.x_px) ||
                 leaves(to.y_px, from.y_px, low_.y_px, high_.y_px)
             ? kCosts.leaving_cost
             : kCosts.no_match_cost;
}

// For each detection, in the order of the grid: whether it may be a bead that came into an open picture. Such
// a detection is near the border of the bounding box of all detections so far, and no track is expected
// there.
std::vector<std::uint8_t> Linker::newcomers(const Grid& grid) const {
  std::vector<std::uint8_t> new_there(grid.size(), 0);
  if (options_.closed) return new_there;
  const double d = options_.diameter_px, margin = kCosts.entry_margin * d;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const PixelPoint p = grid[k];
    new_there[k] = p.x_px < low_.x_px + margin || p.y_px < low_.y_px + margin ||
                   p.x_px > high_.x_px - margin || p.y_px > high_.y_px - margin;
  }
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    for (const PixelPoint p : {expected_[t], ballistic_[t]})
      grid.within(p, kCosts.lookup_reach * d, [&](std::size_t k, double) { new_there[k] = 0; });
  return new_there;
}

// For each detection, in the order of the grid: the step that would have led there in free flight if the bead
// continues to the frame ahead in free flight; NaN if unknown. A copy of the linker advances with the present
// links.
std::vector<PixelPoint> Linker::steps_back(const Grid& grid, std::span<const PixelPoint> detections,
                                           const FrameTime& time, std::span<const std::uint8_t> tracers,
                                           const FrameAhead& ahead) const {
  std::vector<PixelPoint> steps(grid.size(), {kNaN, kNaN});
  if (ahead.time.interval <= 0) return steps;
  Linker lookahead = *this;
  for (std::int32_t& k : lookahead.detection_of_)
    if (k >= 0) k = static_cast<std::int32_t>(grid.original(static_cast<std::size_t>(k)));
  std::vector<std::int64_t> ids(detections.size(), -1);
  lookahead.update(detections, tracers, time, ids);
  lookahead.last_ = {.frames = 1};
  lookahead.link(ahead.detections, ahead.time, ahead.tracers, nullptr);
  std::vector<PixelPoint> onward(detections.size(), {kNaN, kNaN});
  for (std::size_t t = 0; t < lookahead.tracks_.size(); ++t) {
    const Track& track = lookahead.tracks_[t];
    if (track.missed > 0 || lookahead.detection_of_[t] < 0) continue;
    const PixelPoint there = ahead.detections[static_cast<std::size_t>(lookahead.detection_of_[t])];
    onward[static_cast<std::size_t>(track.detection)] =
        (time.interval / ahead.time.interval) * (there - track.place) -
        PixelPoint{0, options_.fall_px * time.interval * time.interval};
  }
  for (std::size_t k = 0; k < grid.size(); ++k) steps[k] = onward[grid.original(k)];
  return steps;
}

// Distance of a detection from the line of all one-collision paths. A bead that is hit once between two
// frames has its old velocity before the hit and its new velocity after it. Its step therefore ends on the
// straight line between the end of the step that repeats the previous free flight and the end of the step
// from which the following free flight continues. Gravity does not change this, because its terms are linear
// in the time of the hit.
Linker::CollisionPath Linker::collision_path(std::size_t track, PixelPoint to, PixelPoint step_back) const {
  const double d = options_.diameter_px;
  const PixelPoint from_flight = to - ballistic_[track],
                   line = tracks_[track].place + step_back - ballistic_[track];
  const double l2 = square(line), dot = from_flight.x_px * line.x_px + from_flight.y_px * line.y_px;
  const double part = l2 > 0 ? std::clamp(dot / l2, 0.0, 1.0) : 0;
  return {square(from_flight - part * line) / (d * d), std::sqrt(l2) / d};
}

// Whether beads follow ballistic paths. Otherwise, as in tables of hopping points, the next frame is no
// evidence for a link. Of the beads that are not at their expected position, more than one in three must be
// closer to a one-collision path by a factor of two.
bool Linker::follows_ballistic(const Grid& grid, const std::vector<PixelPoint>& steps_back) const {
  const double d = options_.diameter_px;
  std::size_t unexpected = 0, explained = 0;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (detection_of_[t] < 0 || tracks_[t].missed > 0) continue;
    const auto k = static_cast<std::size_t>(detection_of_[t]);
    const double miss2 = square(grid[k] - expected_[t]) / (d * d);
    if (!std::isfinite(steps_back[k].x_px) || miss2 <= kCosts.settle_reach * kCosts.settle_reach) continue;
    ++unexpected;
    explained += 4 * collision_path(t, grid[k], steps_back[k]).miss2 < miss2 ? 1 : 0;
  }
  return 3 * explained > unexpected;
}

// Matches all tracks and detections collectively and replaces the links.
void Linker::match_all(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameTime& time,
                       const std::vector<PixelPoint>& steps_back) {
  const double d = options_.diameter_px;
  // Choices: for each detection within reach of a track, the cost of the cheapest explanation.
  std::vector<PixelPoint> places, detections;
  for (std::size_t k = 0; k < grid.size(); ++k) detections.push_back(grid[k]);
  std::vector<Edge> choices, own;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    places.push_back(track.place);
    own.clear();
    const double no_match = cost_of_no_match(t);
    const double reach = std::min(kCosts.matching_reach, options_.range_diameters) * d;
    auto look = [&](PixelPoint about) {
      grid.within(about, reach, [&](std::size_t k, double) {
        if (std::any_of(own.begin(), own.end(), [&](const Edge& e) { return e.column == k; })) return;
        double least = kCosts.any_position_cost;
        least = std::min(least, cost(square(grid[k] - expected_[t]) / (d * d),
                                     kCosts.prediction_width * (1 + track.missed)));
        if (track.missed == 0)
          least =
              std::min(least, kCosts.ballistic_exponent *
                                      std::log1p(square(grid[k] - ballistic_[t]) /
                                                 (kCosts.ballistic_width * kCosts.ballistic_width * d * d)) +
                                  2 * std::log(kCosts.ballistic_width) + kCosts.ballistic_cost);
        if (track.missed == 0 && !steps_back.empty() && std::isfinite(steps_back[k].x_px)) {
          const CollisionPath w = collision_path(t, grid[k], steps_back[k]);
          least = std::min(least, kCosts.collision_exponent * std::log1p(w.miss2 / (kCosts.collision_width *
                                                                                    kCosts.collision_width)) +
                                      std::log(kCosts.collision_width * (kCosts.collision_width + w.length)) +
                                      kCosts.collision_cost);
        }
        if (!tracers.empty() && tracers[grid.original(k)] != track.tracer) least += kCosts.type_change_cost;
        own.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(k), least - no_match});
      });
    };
    look(expected_[t]);
    if (track.missed == 0) {
      look(ballistic_[t]);
      look(track.place + time.interval * step_);
      look(track.place);
    }
    if (own.size() > kCosts.max_choices) {
      std::nth_element(own.begin(), own.begin() + kCosts.max_choices, own.end(),
                       [](const Edge& a, const Edge& b) {
                         return a.cost < b.cost || (a.cost == b.cost && a.column < b.column);
                       });
      own.resize(kCosts.max_choices);
    }
    choices.insert(choices.end(), own.begin(), own.end());
  }
  // In one layer of discs each bead has about a dozen choices. With many more, the points are no such layer
  // and the matching would take too long.
  if (choices.size() > kCosts.max_mean_choices * std::min(tracks_.size(), grid.size())) return;
  const std::vector<std::uint8_t> new_there = newcomers(grid);
  const CollectiveMatching match = match_collectively(
      places, detections, choices, d, {detection_of_, options_.closed && is_complete(grid), new_there});
  // Links: the matching replaces all earlier ones.
  std::fill(detection_of_.begin(), detection_of_.end(), -1);
  std::fill(ambiguous_.begin(), ambiguous_.end(), std::uint8_t{0});
  last_.settled = last_.ambiguous = 0;
  last_.rematched = 1;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const std::int64_t k = match.column_of_row[t];
    if (k < 0) continue;
    detection_of_[t] = static_cast<std::int32_t>(k);
    if (match.margin[t] >= std::log(options_.ambiguous_odds)) continue;
    mark_ambiguous(grid.original(static_cast<std::size_t>(k)));
  }
}

// Links the last tracks to the detections left over. A bead that is hit hard may move farther than the search
// reaches. If all beads are present, the detections left over belong to the tracks left over. No prediction
// supports such a link, so it is marked ambiguous. (A longer reach for all beads was tried: it gives as many
// beads a wrong detection as a right one.)
void Linker::link_left_over(const Grid& grid) {
  if (!options_.closed || !is_complete(grid)) return;
  const double farthest = kCosts.left_over_reach * options_.diameter_px;
  std::vector<std::size_t> tracks, left;
  std::vector<std::uint8_t> taken(grid.size(), 0);
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    if (detection_of_[t] < 0)
      tracks.push_back(t);
    else
      taken[static_cast<std::size_t>(detection_of_[t])] = 1;
  for (std::size_t k = 0; k < grid.size(); ++k)
    if (taken[k] == 0) left.push_back(k);
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    for (std::size_t j = 0; j < left.size(); ++j) {
      const std::size_t t = tracks[i];
      const PixelPoint p = grid[left[j]];
      const double r2 =
          std::min({square(p - expected_[t]), square(p - ballistic_[t]), square(p - tracks_[t].place)});
      if (r2 < farthest * farthest)  // all costs are negative, so as many as possible are assigned
        edges.push_back(
            {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), std::sqrt(r2) - 2 * farthest});
    }
  const Assignment best = assign(tracks.size(), left.size(), edges);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (best.column_of_row[i] < 0) continue;
    const std::size_t k = left[static_cast<std::size_t>(best.column_of_row[i])];
    detection_of_[tracks[i]] = static_cast<std::int32_t>(k);
    mark_ambiguous(grid.original(k));
  }
}

// Updates the tracks from the links: linked tracks, missing tracks within memory, new tracks.
void Linker::update(std::span<const PixelPoint> detections, std::span<const std::uint8_t> tracers,
                    const FrameTime& time, std::vector<std::int64_t>& ids) {
  const auto phases = static_cast<std::size_t>(phases_);
  const bool in_cycle = phases > 0 && time.phase >= 0 && time.phase < phases_;
  const auto phase = static_cast<std::size_t>(in_cycle ? time.phase : 0);
  const bool remembers = in_cycle && cycle_of_phase_[phase] == time.cycle - 1;

  // Common step: mean and median over the linked beads.
  std::vector<PixelPoint> steps;
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    if (detection_of_[t] >= 0 && tracks_[t].missed == 0)
      steps.push_back(detections[static_cast<std::size_t>(detection_of_[t])] - tracks_[t].place);
  const double per_interval = time.interval > 0 ? 1 / time.interval : 0;
  const bool first = total_.frames == 0;
  if (first)
    std::copy_if(first_steps_.begin(), first_steps_.end(), std::back_inserter(steps),
                 [](PixelPoint step) { return std::isfinite(step.x_px); });
  mean_step_ = {};
  for (const PixelPoint step : steps) mean_step_ = mean_step_ + step;
  if (!steps.empty()) mean_step_ = (1.0 / static_cast<double>(steps.size())) * mean_step_;
  const std::size_t stride = std::max<std::size_t>(1, steps.size() / (2 * kCosts.sample_tracks));
  for (std::size_t i = 1; i * stride < steps.size(); ++i) steps[i] = steps[i * stride];
  steps.resize((steps.size() + stride - 1) / stride);
  const PixelPoint moved = median(steps);  // in this frame
  if (first)
    step_ = moved;  // which is per interval
  else if (time.interval > 0)
    step_ = per_interval * moved;

  // Tracks: linked ones take the new position, missing ones move with the common step.
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Track& track = tracks_[t];
    PixelPoint* ring = phases > 0 ? &cycle_places_[t * phases] : nullptr;
    if (detection_of_[t] < 0) {
      ++track.missed;
      track.place = track.place + moved;
      if (in_cycle) ring[phase] = {kNaN, kNaN};
      continue;
    }
    const auto k = static_cast<std::size_t>(detection_of_[t]);
    const PixelPoint p = detections[k];
    ids[k] = track.id;
    ++last_.links;
    last_.bridged += track.missed > 0 ? 1 : 0;
    if (track.missed > 0)
      track.step = (1.0 / (track.missed + 1)) * (p - track.place - moved) + step_;
    else if (time.interval > 0)
      track.step = per_interval * (p - track.place);
    track.place = p;
    track.missed = 0;
    ++track.seen;
    track.detection = static_cast<std::int32_t>(k);
    if (!tracers.empty()) track.tracer = tracers[k];
    if (in_cycle) {
      const PixelPoint old = ring[phase];
      const PixelPoint drift = p - old;
      track.drift = remembers && std::isfinite(drift.x_px) ? drift : PixelPoint{};
      ring[phase] = p;
    }
  }

  // Losses: the last track takes the slot of a track that ends.
  for (std::size_t t = 0; t < tracks_.size();) {
    if (tracks_[t].missed <= options_.memory) {
      ++t;
      continue;
    }
    ++last_.losses;
    const std::size_t end = tracks_.size() - 1;
    if (t != end) {
      tracks_[t] = tracks_[end];
      std::copy_n(cycle_places_.begin() + static_cast<std::ptrdiff_t>(end * phases), phases,
                  cycle_places_.begin() + static_cast<std::ptrdiff_t>(t * phases));
    }
    tracks_.pop_back();
    cycle_places_.resize(tracks_.size() * phases);
  }
  // Births: a detection without a track begins one.
  for (std::size_t k = 0; k < detections.size(); ++k) {
    if (ids[k] >= 0) continue;
    ids[k] = n_tracks_++;
    ++last_.births;
    const bool known = k < first_steps_.size() && std::isfinite(first_steps_[k].x_px);
    tracks_.push_back({.id = ids[k],
                       .place = detections[k],
                       .step = known ? first_steps_[k] : step_,
                       .drift = {},
                       .missed = 0,
                       .detection = static_cast<std::int32_t>(k),
                       .tracer = tracers.empty() ? std::uint8_t{0} : tracers[k]});
    cycle_places_.resize(tracks_.size() * phases, {kNaN, kNaN});
    if (in_cycle) cycle_places_[(tracks_.size() - 1) * phases + phase] = detections[k];
  }
  for (const PixelPoint p : detections) {
    low_ = {std::min(low_.x_px, p.x_px), std::min(low_.y_px, p.y_px)};
    high_ = {std::max(high_.x_px, p.x_px), std::max(high_.y_px, p.y_px)};
  }
  if (in_cycle) cycle_of_phase_[phase] = time.cycle;
  first_steps_.clear();
}

// In reversed time the next step of free flight is the negative of the last step plus the fall.
Linker Linker::reversed() const {
  Linker back = *this;
  const PixelPoint fall{0, options_.fall_px};
  for (Track& track : back.tracks_) {
    track.step = -1.0 * (track.step + fall);
    track.drift = {};
  }
  back.step_ = -1.0 * (step_ + fall);
  back.mean_step_ = -1.0 * (mean_step_ + fall);
  std::fill(back.cycle_of_phase_.begin(), back.cycle_of_phase_.end(),
            std::numeric_limits<std::int64_t>::min());
  std::fill(back.cycle_places_.begin(), back.cycle_places_.end(), PixelPoint{kNaN, kNaN});
  return back;
}

// Links one frame. The links are left in detection_of_, their quality in ambiguous_ and last_.
void Linker::link(std::span<const PixelPoint> detections, const FrameTime& time,
                  std::span<const std::uint8_t> tracers, const FrameAhead* ahead) {
  ambiguous_.assign(detections.size(), 0);
  const Grid grid(detections, 1.1 * options_.diameter_px);
  detection_of_.assign(tracks_.size(), -1);
  track_of_.assign(detections.size(), -1);
  predict_all(grid, time);
  settle(grid, tracers);
  const std::int64_t open = static_cast<std::int64_t>(tracks_.size()) - last_.settled;
  follow_neighbours(grid);
  assign_rest(grid, tracers, time);
  const bool rough = static_cast<double>(open) > kCosts.open_fraction * static_cast<double>(tracks_.size());
  // If all beads are present, a single ambiguous link justifies the collective matching. If some are missing,
  // nearly every frame has an ambiguous link, and it is mostly right.
  if ((last_.ambiguous > 0 && (rough || is_complete(grid))) || (rough && neighbours_separate(grid)))
    match_all(grid, tracers, time, {});
  if (last_.rematched > 0 && ahead != nullptr) {
    const std::vector<PixelPoint> back = steps_back(grid, detections, time, tracers, *ahead);
    if (follows_ballistic(grid, back)) {
      const std::vector<std::int32_t> first = detection_of_;
      match_all(grid, tracers, time, back);
      // A link that the frame ahead has changed is ambiguous, whatever its odds are now.
      for (std::size_t t = 0; t < tracks_.size(); ++t) {
        if (detection_of_[t] < 0 || detection_of_[t] == first[t]) continue;
        mark_ambiguous(grid.original(static_cast<std::size_t>(detection_of_[t])));
      }
    }
  }
  link_left_over(grid);
  for (std::int32_t& k : detection_of_)
    if (k >= 0) k = static_cast<std::int32_t>(grid.original(static_cast<std::size_t>(k)));
}

namespace {

void require_places(std::span<const PixelPoint> detections, std::int64_t frame) {
  for (std::size_t k = 0; k < detections.size(); ++k)
    if (!(std::abs(detections[k].x_px) < kFar && std::abs(detections[k].y_px) < kFar))
      throw RunError(fmt::format("frame {}, detection {}: ({}, {}) is not a position in a picture.", frame, k,
                                 detections[k].x_px, detections[k].y_px));
}

}  // namespace

std::vector<std::int64_t> Linker::next(std::span<const PixelPoint> detections, const FrameTime& time,
                                       std::span<const std::uint8_t> tracers, const FrameAhead* ahead) {
  require_places(detections, total_.frames);
  if (ahead != nullptr) require_places(ahead->detections, total_.frames + 1);
  last_ = {.frames = 1};
  link(detections, time, tracers, ahead);
  std::vector<std::int64_t> ids(detections.size(), -1);
  update(detections, tracers, time, ids);
  total_.add(last_);
  return ids;
}

}  // namespace twincell
