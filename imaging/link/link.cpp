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
constexpr double kFar = 1e9;  // px; no camera reaches there

// All in diameters.
constexpr double kSafe = 0.25;       // discs do not overlap: a bead this near has no rival
constexpr double kLook = 0.5;        // how far one look reaches
constexpr double kRival = 2;         // a second this many times farther is no rival
constexpr double kNeighbours = 2.1;  // whose steps a bead's step is compared with
constexpr double kWell = 0.95;       // fit above which no other rule is tried
constexpr double kRough = 0.03;      // share of tracks left open above which settled ones are looked at again
constexpr double kAlike = 0.3;       // between neighbours' steps that agree
constexpr double kSame = 0.1;        // between predictions that say the same
constexpr double kSlack = 0.05;      // by which a detection must be nearer to be the better one
constexpr double kThrough = 0.6;   // between centres on their way: nearer, one disc passed through the other
constexpr double kBeside = 0.8;    // farther, it did not
constexpr double kPassing = 8;     // dearest exchange for the sake of not passing through
constexpr double kLikely = 0.5;    // how near the centre of mass leads to the common way
constexpr double kWidth = 0.12;    // of the core of the density of misses, see `cost`
constexpr double kTouching = 1.3;  // whose steps are compared
constexpr double kPart = 0.8;      // between neighbours' steps: beyond, something is amiss
constexpr double kAnywhere =
    1.9;  // how far from where it may be expected a bead is sought when all are matched
constexpr double kFarthest = 8;   // how far the last beads and detections left over may lie apart
constexpr double kFlight = 0.02;  // width of the density of misses in free flight, and its exponent
constexpr double kFlightTail = 2.5;
// Width of the density of misses of a way with a collision on it, and its exponent: fitted to links of
// simulated cells that convect, by their odds against the other choices. At the fitted price, -2, fewer wrong
// links go than at this one.
constexpr double kWay = 0.02;
constexpr double kWayTail = 1.25;
constexpr double kOfWay = -4;
// Prices, logarithms of odds:
constexpr double kOfFlight = 2;           // to be in free flight,
constexpr double kOfAnything = 6;         // to be anywhere within reach,
constexpr double kOfNowhere = 16;         // to be nowhere,
constexpr double kOfStranger = 0;         // the same for what was seen once,
constexpr double kOfLeaving = 0;          // and for what flies out of an open picture or is missing in it,
constexpr double kOfKind = 3;             // to change from tracer to bead
constexpr std::size_t kSample = 200;      // tracks on which the rules are tried
constexpr std::size_t kMostChoices = 40;  // the same where all are matched
constexpr std::size_t kMostOnAverage = 25;
constexpr std::size_t kMostEdges = 16;  // detections that one track may choose from
constexpr double kOutward = 0.1;        // step of a bead that leaves
constexpr double kCome = 1;             // from the border: where beads come into sight
constexpr int kRounds = 12;             // of learning from neighbours

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

/// Median by coordinate; reorders. 0 of nothing.
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

/// The misses of a prediction have a narrow core and, from collisions between two frames, a long tail: a
/// density (1 + r^2/w^2)^(-3/2) / w^2 in the plane. Its negative logarithm is the cost of a link, so that
/// differences of costs are logarithms of odds. With squared distances, the usual cost, one far miss
/// outweighs many near ones.
double cost(double r2, double width) {
  return 1.5 * std::log1p(r2 / (width * width)) + 2 * std::log(width);
}

}  // namespace

/// Points ordered by square cells, for the questions "who is nearest" and "who is within reach".
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
    // A few strays far away must not cost memory.
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
  // Clamped, so that looking outside finds the rim.
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

PixelPoint Linker::predict(std::size_t t, Rule rule, const FrameMoment& moment) const {
  const Track& track = tracks_[t];
  switch (rule) {
    case Rule::still:
      break;
    case Rule::step:
      return track.place + moment.interval * track.step;
    case Rule::cycle: {
      const PixelPoint p =
          cycle_places_[t * static_cast<std::size_t>(phases_) + static_cast<std::size_t>(moment.phase)];
      const PixelPoint there = p + track.drift;
      if (std::isfinite(there.x_px)) return there;
      return track.place + moment.interval * track.step;
    }
  }
  return track.place;
}

namespace {

/// How well predictions moved by a shift meet the detections: mean over the tracks of 1 - (r / 0.25 d)^2, 0
/// beyond.
template <class Grid>
double fit(const std::vector<PixelPoint>& expected, PixelPoint shift, const Grid& grid, double d) {
  if (expected.empty()) return 0;
  const double reach = kSafe * d;
  double sum = 0;
  for (const PixelPoint p : expected) {
    double least = reach * reach;
    grid.within(p + shift, reach, [&](std::size_t, double r2) { least = std::min(least, r2); });
    sum += 1 - least / (reach * reach);
  }
  return sum / static_cast<double>(expected.size());
}

/// Median way from the predictions to the detections nearest to them, twice: about them, then about where the
/// first has led.
template <class Grid>
PixelPoint median_way(const std::vector<PixelPoint>& expected, const Grid& grid, double d, PixelPoint shift,
                      int times) {
  std::vector<PixelPoint> ways;
  for (; times > 0; --times) {
    ways.clear();
    for (const PixelPoint p : expected) {
      double least = std::numeric_limits<double>::infinity();
      std::size_t nearest = 0;
      grid.within(p + shift, kLook * d, [&](std::size_t k, double r2) {
        if (r2 < least) {
          least = r2;
          nearest = k;
        }
      });
      if (std::isfinite(least)) ways.push_back(grid[nearest] - p);
    }
    if (ways.empty()) return shift;
    shift = median(ways);
  }
  return shift;
}

struct Shift {
  PixelPoint px;
  bool unclear = false;  // another one is nearly as good
};

/// Peak of the histogram of all ways from predictions to detections within reach, counted in cells of d/8 and
/// over 3 x 3 of them. A crystal looks the same a lattice vector on, but for its rim: of peaks nearly as high
/// the one nearest to `likely` is taken.
template <class Grid>
Shift commonest_way(const std::vector<PixelPoint>& expected, const Grid& grid, double d, double reach,
                    PixelPoint likely) {
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
      const PixelPoint way = grid[k] - p;
      ++count[at(cell_of(way.x_px), cell_of(way.y_px))];
    });
  std::vector<double> sums(n * n);
  double best = 0;
  int best_i = 0, best_j = 0;
  for (int j = 1 - half; j < half; ++j)
    for (int i = 1 - half; i < half; ++i) {
      double sum = 0;
      for (int b = -1; b <= 1; ++b)
        for (int a = -1; a <= 1; ++a) sum += count[at(i + a, j + b)];
      sum *= std::exp(-0.5 * square(PixelPoint{i * cell, j * cell} - likely) / (kLikely * kLikely * d * d));
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
  return {median_way(expected, grid, d, {best_i * cell, best_j * cell}, 1), rival > 0.98 * best};
}

}  // namespace

// The rule that fits best, and with it the common departure from it.
void Linker::predict_all(const Grid& grid, const FrameMoment& moment) {
  const double d = options_.diameter_px;
  std::vector<std::size_t> alive;
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    if (tracks_[t].missed == 0) alive.push_back(t);
  const std::size_t stride = std::max<std::size_t>(1, alive.size() / kSample);
  std::vector<Rule> rules = {Rule::still, Rule::step};
  const bool remembers = moment.phase >= 0 && moment.phase < phases_ && moment.cycle > 0 &&
                         cycle_of_phase_[static_cast<std::size_t>(moment.phase)] == moment.cycle - 1;
  if (remembers) rules.push_back(Rule::cycle);
  PixelPoint centre;
  for (std::size_t k = 0; k < grid.size(); ++k) centre = centre + grid[k];
  const bool moves = options_.max_shift_diameters > 0 && !alive.empty() && grid.size() > 0;
  if (moves) centre = (1.0 / static_cast<double>(grid.size())) * centre;
  Rule best_rule = Rule::step;
  PixelPoint best_shift;
  double best_fit = -1;
  for (const Rule rule : rules) {
    std::vector<PixelPoint> sample;
    PixelPoint mean;
    for (std::size_t a = 0; a < alive.size(); ++a) {
      const PixelPoint p = predict(alive[a], rule, moment);
      mean = mean + p;
      if (a % stride == 0) sample.push_back(p);
    }
    PixelPoint shift;
    if (moves) {
      // The centre of mass knows no lattice: it moves with the whole, whatever looks alike.
      shift = centre - (1.0 / static_cast<double>(alive.size())) * mean;
      if (square(shift) > options_.max_shift_diameters * options_.max_shift_diameters * d * d) shift = {};
      shift = median_way(sample, grid, d, shift, 2);
    }
    const double f = fit(sample, shift, grid, d);
    if (f > best_fit + 0.03) {
      best_fit = f;
      best_rule = rule;
      best_shift = shift;
    }
    if (best_fit > kWell) break;
  }
  if (moves && best_fit < 0.5) {
    std::vector<PixelPoint> expected;
    PixelPoint mean;
    for (const std::size_t t : alive) {
      expected.push_back(predict(t, best_rule, moment));
      mean = mean + expected.back();
    }
    mean = centre - (1.0 / static_cast<double>(alive.size())) * mean;
    const Shift other = commonest_way(expected, grid, d, options_.max_shift_diameters * d, mean);
    if (fit(expected, other.px, grid, d) > fit(expected, best_shift, grid, d)) best_shift = other.px;
    last_.unclear_shifts += other.unclear ? 1 : 0;
  }
  // Nothing is lower than what lies lowest: a bed that lands is stopped by the plate, and its lowest row
  // leads the others.
  double floor = -kFar;
  for (std::size_t k = 0; k < grid.size(); ++k) floor = std::max(floor, grid[k].y_px);
  auto above_floor = [&](PixelPoint p) { return PixelPoint{p.x_px, std::min(p.y_px, floor)}; };
  flying_.resize(tracks_.size());
  expected_.resize(tracks_.size());
  falling_.resize(tracks_.size());
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    flying_[t] = above_floor(in_flight(t, moment));
    const PixelPoint p =
        tracks_[t].missed == 0 ? predict(t, best_rule, moment) : tracks_[t].place + moment.interval * step_;
    falling_[t] = p + best_shift;
    expected_[t] = above_floor(falling_[t]);
  }
}

// In free flight a step repeats itself, and grows by the fall.
PixelPoint Linker::in_flight(std::size_t t, const FrameMoment& moment) const {
  return tracks_[t].place + moment.interval * tracks_[t].step +
         PixelPoint{0, options_.fall_px * moment.interval * moment.interval};
}

// Detections within 0.25 d of the track that expects them there, neither having a rival. A bead that would be
// met better somewhere else if it were in free flight is left to the assignment.
void Linker::settle(const Grid& grid, std::span<const std::uint8_t> tracers) {
  const double d = options_.diameter_px, infinity = std::numeric_limits<double>::infinity();
  struct Suitor {
    double r2 = std::numeric_limits<double>::infinity(), second = std::numeric_limits<double>::infinity();
    std::int32_t track = -1;
  };
  std::vector<Suitor> suitors(grid.size());
  struct Choice {
    double r2, second;
    std::int32_t detection;
  };
  std::vector<Choice> choices(tracks_.size());
  disputed_.assign(tracks_.size(), infinity);
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Choice c{infinity, infinity, -1};
    grid.within(expected_[t], kLook * d, [&](std::size_t k, double r2) {
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
    Suitor& s = suitors[static_cast<std::size_t>(c.detection)];
    if (c.r2 < s.r2) {
      s.second = s.r2;
      s.r2 = c.r2;
      s.track = static_cast<std::int32_t>(t);
    } else {
      s.second = std::min(s.second, c.r2);
    }
    if (square(flying_[t] - expected_[t]) < kSame * kSame * d * d) continue;
    const double reach = std::min(std::sqrt(c.r2) + kSlack * d, kSafe * d);
    grid.within(flying_[t], reach, [&](std::size_t k, double r2) {
      if (static_cast<std::int32_t>(k) != c.detection) disputed_[t] = std::min(disputed_[t], std::sqrt(r2));
    });
  }
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Choice& c = choices[t];
    if (c.detection < 0 || c.r2 > kSafe * kSafe * d * d || tracks_[t].missed > 0 || disputed_[t] < infinity)
      continue;
    const auto k = static_cast<std::size_t>(c.detection);
    const Suitor& s = suitors[k];
    if (s.track != static_cast<std::int32_t>(t)) continue;
    if (kRival * kRival * c.r2 >= std::min(c.second, s.second)) continue;
    if (!tracers.empty() && tracers[grid.original(k)] != tracks_[t].tracer) continue;
    detection_of_[t] = c.detection;
    track_of_[k] = static_cast<std::int32_t>(t);
    ++last_.settled;
  }
}

// What settled neighbours had in common, the others may have too; and who has nothing in common with them was
// settled by chance. Pushing predictions apart where discs would overlap, from the plate upwards, was tried
// instead: fewer links went wrong in beds that convect (by 7 in 100), more in beds that bounce, a quarter
// slower.
void Linker::follow_neighbours(const Grid& grid) {
  const double d = options_.diameter_px;
  local_.assign(tracks_.size(), {kNaN, kNaN});
  std::vector<std::int32_t> open;
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    if (detection_of_[t] < 0) open.push_back(static_cast<std::int32_t>(t));
  if (open.empty() || open.size() == tracks_.size()) return;
  std::vector<PixelPoint> places;
  for (const Track& t : tracks_) places.push_back(t.place);
  const Grid neighbours(places, 1.1 * d);
  std::vector<PixelPoint> ways;
  auto gather = [&](std::size_t t) {
    ways.clear();
    neighbours.within(tracks_[t].place, kNeighbours * d, [&](std::size_t k, double) {
      const std::size_t other = neighbours.original(k);
      if (const std::int32_t with = detection_of_[other]; with >= 0 && other != t)
        ways.push_back(grid[static_cast<std::size_t>(with)] - falling_[other]);
    });
  };
  if (static_cast<double>(open.size()) > kRough * static_cast<double>(tracks_.size())) {
    std::vector<std::int32_t> odd;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      if (detection_of_[t] < 0) continue;
      gather(t);
      const PixelPoint way = grid[static_cast<std::size_t>(detection_of_[t])] - falling_[t];
      std::size_t alike = 0;
      for (const PixelPoint w : ways) alike += square(w - way) < kAlike * kAlike * d * d ? 1 : 0;
      if (ways.size() >= 3 && 3 * alike < 1 * ways.size()) odd.push_back(static_cast<std::int32_t>(t));
    }
    for (const std::int32_t t : odd) {
      std::int32_t& k = detection_of_[static_cast<std::size_t>(t)];
      track_of_[static_cast<std::size_t>(k)] = -1;
      k = -1;
      open.push_back(t);
      --last_.settled;
    }
  }
  std::vector<std::pair<double, std::int32_t>> suitor(grid.size());
  for (int round = 0; round < kRounds && !open.empty(); ++round) {
    std::vector<std::pair<std::int32_t, std::int32_t>> wishes;
    std::fill(suitor.begin(), suitor.end(), std::pair{std::numeric_limits<double>::infinity(), -1});
    for (const std::int32_t open_track : open) {
      const auto t = static_cast<std::size_t>(open_track);
      gather(t);
      if (ways.size() < 3) continue;
      local_[t] = median(ways);
      const PixelPoint p = falling_[t] + local_[t];
      const double reach = std::min(kSafe * d, disputed_[t] - kSlack * d);
      if (reach <= 0) continue;
      double least = reach * reach;
      std::int32_t nearest = -1;
      grid.within(p, reach, [&](std::size_t k, double r2) {
        if (track_of_[k] >= 0 || r2 >= least) return;
        least = r2;
        nearest = static_cast<std::int32_t>(k);
      });
      if (nearest < 0) continue;
      wishes.emplace_back(open_track, nearest);
      auto& s = suitor[static_cast<std::size_t>(nearest)];
      s = std::min(s, std::pair{least, open_track});
    }
    bool any = false;
    for (const auto& [t, k] : wishes) {
      if (suitor[static_cast<std::size_t>(k)].second != t) continue;
      detection_of_[static_cast<std::size_t>(t)] = k;
      track_of_[static_cast<std::size_t>(k)] = t;
      any = true;
    }
    if (!any) break;
    std::erase_if(open, [&](std::int32_t t) { return detection_of_[static_cast<std::size_t>(t)] >= 0; });
  }
}

namespace {

/// Least distance of two beads that move straight and evenly.
double closest(PixelPoint from_a, PixelPoint to_a, PixelPoint from_b, PixelPoint to_b) {
  const PixelPoint before = from_a - from_b, change = to_a - to_b - before;
  const double c2 = square(change), dot = before.x_px * change.x_px + before.y_px * change.y_px;
  return std::sqrt(square(before + (c2 > 0 ? std::clamp(-dot / c2, 0.0, 1.0) : 0) * change));
}

/// Discs of one layer cannot pass through each other, which a sum of costs does not know. Two links that
/// would need it are exchanged, if that is allowed and not too dear.
void exchange_passers(Assignment& best, const std::vector<Edge>& edges, const std::vector<PixelPoint>& from,
                      const std::vector<PixelPoint>& to, double d) {
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
      if (closest(from[i], a, from[j], b) > kThrough * d || closest(from[i], b, from[j], a) < kBeside * d)
        continue;
      if (e->cost + cost_of(j, mine) - cost_of(i, mine) - cost_of(j, theirs) > kPassing) continue;
      std::swap(mine, theirs);
      std::swap(row_of[static_cast<std::size_t>(mine)], row_of[static_cast<std::size_t>(theirs)]);
      break;
    }
  }
}

}  // namespace

void Linker::say_ambiguous(std::size_t detection) {
  if (std::exchange(ambiguous_[detection], std::uint8_t{1}) == 0) ++last_.ambiguous;
}

void Linker::assign_rest(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameMoment& moment) {
  const double d = options_.diameter_px;
  const double alone = cost(options_.range_diameters * options_.range_diameters, kWidth);
  std::vector<std::int32_t> rows;
  std::vector<Edge> edges, own;
  std::vector<std::int32_t> column_of(grid.size(), -1), columns;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (detection_of_[t] >= 0) continue;
    const Track& track = tracks_[t];
    const double width = kWidth * (1 + track.missed);
    const double range = options_.range_diameters * (1 + 0.5 * track.missed) * d;
    // Where it may be, and the price of having to believe so.
    std::vector<std::pair<PixelPoint, double>> guesses = {{expected_[t], 0}};
    if (std::isfinite(local_[t].x_px)) {
      guesses.front().second = 0.7;
      guesses.emplace_back(falling_[t] + local_[t], 0);
    }
    if (track.missed == 0) {
      guesses.emplace_back(track.place + moment.interval * step_, 0.7);
      guesses.emplace_back(flying_[t], 0);
    }
    own.clear();
    grid.within(expected_[t], range, [&](std::size_t k, double) {
      if (track_of_[k] >= 0) return;
      double least = std::numeric_limits<double>::infinity();
      for (const auto& [guess, price] : guesses)
        least = std::min(least, cost(square(grid[k] - guess) / (d * d), width) + price);
      if (!tracers.empty() && tracers[grid.original(k)] != track.tracer) least += kOfKind;
      if (least >= alone) return;
      own.push_back({static_cast<std::uint32_t>(rows.size()), static_cast<std::uint32_t>(k), least - alone});
    });
    if (own.empty()) continue;
    if (own.size() > kMostEdges) {
      std::nth_element(own.begin(), own.begin() + kMostEdges, own.end(), [](const Edge& a, const Edge& b) {
        return a.cost < b.cost || (a.cost == b.cost && a.column < b.column);
      });
      own.resize(kMostEdges);
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
  Assignment best = assign(rows.size(), columns.size(), edges);
  last_.networks = static_cast<std::int64_t>(best.networks);
  last_.largest_network = static_cast<std::int64_t>(best.largest_network);
  last_.unsolved = static_cast<std::int64_t>(best.unsolved);
  const double least_margin = std::log(options_.ambiguous_odds);
  std::vector<PixelPoint> from, to;
  for (const std::int32_t t : rows) from.push_back(tracks_[static_cast<std::size_t>(t)].place);
  for (const std::int32_t k : columns) to.push_back(grid[static_cast<std::size_t>(k)]);
  exchange_passers(best, edges, from, to, d);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (best.column_of_row[i] < 0) continue;
    const std::int32_t k = columns[static_cast<std::size_t>(best.column_of_row[i])];
    detection_of_[static_cast<std::size_t>(rows[i])] = k;
    track_of_[static_cast<std::size_t>(k)] = rows[i];
    if (best.margin[i] >= least_margin) continue;
    say_ambiguous(grid.original(static_cast<std::size_t>(k)));
  }
}

// Where touching neighbours stay together, and nobody is lost while a place is left over, the frame is
// understood.
bool Linker::neighbours_part(const Grid& grid) const {
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
    bool parts = false;
    neighbours.within(tracks_[t].place, kTouching * d, [&](std::size_t k, double) {
      const std::size_t other = neighbours.original(k);
      if (tracks_[other].missed > 0 || detection_of_[other] < 0) return;
      const PixelPoint theirs = grid[static_cast<std::size_t>(detection_of_[other])] - tracks_[other].place;
      parts = parts || square(theirs - step) > kPart * kPart * d * d;
    });
    if (parts) return true;
  }
  return false;
}

// What came one frame ago may be no bead: a speck of dust, there for one frame, must not take a bead's place.
bool Linker::stranger(const Track& track) const {
  return track.seen == 1 && total_.frames > 1;
}

// As many detections as tracks, none of which was missing or came just now.
bool Linker::all_there(const Grid& grid) const {
  return grid.size() == tracks_.size() && std::all_of(tracks_.begin(), tracks_.end(), [&](const Track& t) {
           return t.missed == 0 && !stranger(t);
         });
}

// A bead in sight does not vanish, unless it flies out of an open picture: beyond all that was ever seen.
double Linker::price_of_nowhere(std::size_t t) const {
  if (stranger(tracks_[t])) return kOfStranger;
  if (options_.closed) return kOfNowhere;
  if (tracks_[t].missed > 0) return kOfLeaving;
  const PixelPoint from = tracks_[t].place, to = from + tracks_[t].step;
  const double least = kOutward * options_.diameter_px;
  const auto leaves = [&](double x, double was, double low, double high) {
    return (x < low && was - x > least) || (x > high && x - was > least);
  };
  return leaves(to.x_px, from.x_px, low_.x_px, high_.x_px) ||
                 leaves(to.y_px, from.y_px, low_.y_px, high_.y_px)
             ? kOfLeaving
             : kOfNowhere;
}

// By detection in the order of the grid, whether it may be a bead that came into an open picture: near the
// border of all that was ever seen, where no track leads.
std::vector<std::uint8_t> Linker::newcomers(const Grid& grid) const {
  std::vector<std::uint8_t> new_there(grid.size(), 0);
  if (options_.closed) return new_there;
  const double d = options_.diameter_px, margin = kCome * d;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const PixelPoint p = grid[k];
    new_there[k] = p.x_px < low_.x_px + margin || p.y_px < low_.y_px + margin ||
                   p.x_px > high_.x_px - margin || p.y_px > high_.y_px - margin;
  }
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    for (const PixelPoint p : {expected_[t], flying_[t]})
      grid.within(p, kLook * d, [&](std::size_t k, double) { new_there[k] = 0; });
  return new_there;
}

// By detection in the order of the grid, the step that would have led there in free flight, to go on as the
// bead there does; NaN where it is not known. A copy of the linker goes ahead by the links found so far.
std::vector<PixelPoint> Linker::steps_back(const Grid& grid, std::span<const PixelPoint> detections,
                                           const FrameMoment& moment, std::span<const std::uint8_t> tracers,
                                           const FrameAhead& ahead) const {
  std::vector<PixelPoint> steps(grid.size(), {kNaN, kNaN});
  if (ahead.moment.interval <= 0) return steps;
  Linker scout = *this;
  for (std::int32_t& k : scout.detection_of_)
    if (k >= 0) k = static_cast<std::int32_t>(grid.original(static_cast<std::size_t>(k)));
  std::vector<std::int64_t> ids(detections.size(), -1);
  scout.update(detections, tracers, moment, ids);
  scout.last_ = {.frames = 1};
  scout.link(ahead.detections, ahead.moment, ahead.tracers, nullptr);
  std::vector<PixelPoint> onward(detections.size(), {kNaN, kNaN});
  for (std::size_t t = 0; t < scout.tracks_.size(); ++t) {
    const Track& track = scout.tracks_[t];
    if (track.missed > 0 || scout.detection_of_[t] < 0) continue;
    const PixelPoint there = ahead.detections[static_cast<std::size_t>(scout.detection_of_[t])];
    onward[static_cast<std::size_t>(track.detection)] =
        (moment.interval / ahead.moment.interval) * (there - track.place) -
        PixelPoint{0, options_.fall_px * moment.interval * moment.interval};
  }
  for (std::size_t k = 0; k < grid.size(); ++k) steps[k] = onward[grid.original(k)];
  return steps;
}

// A bead that is hit once between two frames goes on as before until then, and as after from then on:
// whenever that was, its step ends on the straight line between the step that free flight repeats and the
// step that free flight goes on from. So it does with the fall, whose terms are linear in the moment of the
// hit.
Linker::Way Linker::way(std::size_t track, PixelPoint to, PixelPoint step_back) const {
  const double d = options_.diameter_px;
  const PixelPoint from_flight = to - flying_[track],
                   line = tracks_[track].place + step_back - flying_[track];
  const double l2 = square(line), dot = from_flight.x_px * line.x_px + from_flight.y_px * line.y_px;
  const double part = l2 > 0 ? std::clamp(dot / l2, 0.0, 1.0) : 0;
  return {square(from_flight - part * line) / (d * d), std::sqrt(l2) / d};
}

// Whether beads go on as they went: else, as in tables that hop, what comes next tells nothing of a link. Of
// those that are not where they are expected, one in three must lie twice as near to such a way.
bool Linker::flies_on(const Grid& grid, const std::vector<PixelPoint>& steps_back) const {
  const double d = options_.diameter_px;
  std::size_t unexpected = 0, told = 0;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (detection_of_[t] < 0 || tracks_[t].missed > 0) continue;
    const auto k = static_cast<std::size_t>(detection_of_[t]);
    const double miss2 = square(grid[k] - expected_[t]) / (d * d);
    if (!std::isfinite(steps_back[k].x_px) || miss2 <= kSafe * kSafe) continue;
    ++unexpected;
    told += 4 * way(t, grid[k], steps_back[k]).miss2 < miss2 ? 1 : 0;
  }
  return 3 * told > unexpected;
}

void Linker::match_all(const Grid& grid, std::span<const std::uint8_t> tracers, const FrameMoment& moment,
                       const std::vector<PixelPoint>& steps_back) {
  const double d = options_.diameter_px;
  std::vector<PixelPoint> places, detections;
  for (std::size_t k = 0; k < grid.size(); ++k) detections.push_back(grid[k]);
  std::vector<Edge> choices, own;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    places.push_back(track.place);
    own.clear();
    const double nowhere = price_of_nowhere(t);
    const double reach = std::min(kAnywhere, options_.range_diameters) * d;
    auto look = [&](PixelPoint about) {
      grid.within(about, reach, [&](std::size_t k, double) {
        if (std::any_of(own.begin(), own.end(), [&](const Edge& e) { return e.column == k; })) return;
        double price = kOfAnything;
        price = std::min(price, cost(square(grid[k] - expected_[t]) / (d * d), kWidth * (1 + track.missed)));
        if (track.missed == 0)
          price = std::min(
              price, kFlightTail * std::log1p(square(grid[k] - flying_[t]) / (kFlight * kFlight * d * d)) +
                         2 * std::log(kFlight) + kOfFlight);
        if (track.missed == 0 && !steps_back.empty() && std::isfinite(steps_back[k].x_px)) {
          const Way w = way(t, grid[k], steps_back[k]);
          price = std::min(price, kWayTail * std::log1p(w.miss2 / (kWay * kWay)) +
                                      std::log(kWay * (kWay + w.length)) + kOfWay);
        }
        if (!tracers.empty() && tracers[grid.original(k)] != track.tracer) price += kOfKind;
        own.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(k), price - nowhere});
      });
    };
    look(expected_[t]);
    if (track.missed == 0) {
      look(flying_[t]);
      look(track.place + moment.interval * step_);
      look(track.place);
    }
    if (own.size() > kMostChoices) {
      std::nth_element(own.begin(), own.begin() + kMostChoices, own.end(), [](const Edge& a, const Edge& b) {
        return a.cost < b.cost || (a.cost == b.cost && a.column < b.column);
      });
      own.resize(kMostChoices);
    }
    choices.insert(choices.end(), own.begin(), own.end());
  }
  // Discs of one layer leave each bead a dozen choices; what leaves many more is no such layer, and endless.
  if (choices.size() > kMostOnAverage * std::min(tracks_.size(), grid.size())) return;
  const std::vector<std::uint8_t> new_there = newcomers(grid);
  const CollectiveMatching match = match_collectively(
      places, detections, choices, d, {detection_of_, options_.closed && all_there(grid), new_there});
  std::fill(detection_of_.begin(), detection_of_.end(), -1);
  std::fill(ambiguous_.begin(), ambiguous_.end(), std::uint8_t{0});
  last_.settled = last_.ambiguous = 0;
  last_.rematched = 1;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const std::int64_t k = match.column_of_row[t];
    if (k < 0) continue;
    detection_of_[t] = static_cast<std::int32_t>(k);
    if (match.margin[t] >= std::log(options_.ambiguous_odds)) continue;
    say_ambiguous(grid.original(static_cast<std::size_t>(k)));
  }
}

// A bead that is hit hard may go farther than is looked. Where all are there, the detections that are left
// over are the beads that are; nothing foretold it, so it is said to be ambiguous. (To look farther for all
// beads instead gives as many of them a wrong place as it gives a right one.)
void Linker::link_left_over(const Grid& grid) {
  if (!options_.closed || !all_there(grid)) return;
  const double farthest = kFarthest * options_.diameter_px;
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
          std::min({square(p - expected_[t]), square(p - flying_[t]), square(p - tracks_[t].place)});
      if (r2 < farthest * farthest)  // as many as can be
        edges.push_back(
            {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), std::sqrt(r2) - 2 * farthest});
    }
  const Assignment best = assign(tracks.size(), left.size(), edges);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (best.column_of_row[i] < 0) continue;
    const std::size_t k = left[static_cast<std::size_t>(best.column_of_row[i])];
    detection_of_[tracks[i]] = static_cast<std::int32_t>(k);
    say_ambiguous(grid.original(k));
  }
}

// Survivors, the missing within memory, and the newly born.
void Linker::update(std::span<const PixelPoint> detections, std::span<const std::uint8_t> tracers,
                    const FrameMoment& moment, std::vector<std::int64_t>& ids) {
  const auto phases = static_cast<std::size_t>(phases_);
  const bool in_cycle = phases > 0 && moment.phase >= 0 && moment.phase < phases_;
  const auto phase = static_cast<std::size_t>(in_cycle ? moment.phase : 0);
  const bool remembers = in_cycle && cycle_of_phase_[phase] == moment.cycle - 1;

  std::vector<PixelPoint> steps;
  for (std::size_t t = 0; t < tracks_.size(); ++t)
    if (detection_of_[t] >= 0 && tracks_[t].missed == 0)
      steps.push_back(detections[static_cast<std::size_t>(detection_of_[t])] - tracks_[t].place);
  const double per_interval = moment.interval > 0 ? 1 / moment.interval : 0;
  const bool first = total_.frames == 0;
  if (first)
    std::copy_if(first_steps_.begin(), first_steps_.end(), std::back_inserter(steps),
                 [](PixelPoint step) { return std::isfinite(step.x_px); });
  mean_step_ = {};
  for (const PixelPoint step : steps) mean_step_ = mean_step_ + step;
  if (!steps.empty()) mean_step_ = (1.0 / static_cast<double>(steps.size())) * mean_step_;
  const std::size_t stride = std::max<std::size_t>(1, steps.size() / (2 * kSample));
  for (std::size_t i = 1; i * stride < steps.size(); ++i) steps[i] = steps[i * stride];
  steps.resize((steps.size() + stride - 1) / stride);
  const PixelPoint moved = median(steps);  // in this frame
  if (first)
    step_ = moved;  // which is per interval
  else if (moment.interval > 0)
    step_ = per_interval * moved;

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
    else if (moment.interval > 0)
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

  // The dead make room for the last.
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
  if (in_cycle) cycle_of_phase_[phase] = moment.cycle;
  first_steps_.clear();
}

// A step back of free flight is the step that led here, with the fall that it lacked.
Linker Linker::turned() const {
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

// Leaves the links in detection_of_ and what they are in ambiguous_ and last_.
void Linker::link(std::span<const PixelPoint> detections, const FrameMoment& moment,
                  std::span<const std::uint8_t> tracers, const FrameAhead* ahead) {
  ambiguous_.assign(detections.size(), 0);
  const Grid grid(detections, 1.1 * options_.diameter_px);
  detection_of_.assign(tracks_.size(), -1);
  track_of_.assign(detections.size(), -1);
  predict_all(grid, moment);
  settle(grid, tracers);
  const std::int64_t open = static_cast<std::int64_t>(tracks_.size()) - last_.settled;
  follow_neighbours(grid);
  assign_rest(grid, tracers, moment);
  const bool rough = static_cast<double>(open) > kRough * static_cast<double>(tracks_.size());
  // One ambiguous link among beads that are all there is worth a second look; where some are missing there is
  // one in nearly every frame, and it is mostly right.
  if ((last_.ambiguous > 0 && (rough || all_there(grid))) || (rough && neighbours_part(grid)))
    match_all(grid, tracers, moment, {});
  if (last_.rematched > 0 && ahead != nullptr) {
    const std::vector<PixelPoint> back = steps_back(grid, detections, moment, tracers, *ahead);
    if (flies_on(grid, back)) {
      const std::vector<std::int32_t> first = detection_of_;
      match_all(grid, tracers, moment, back);
      // What the frame ahead has changed is said to be ambiguous, whatever the odds are now.
      for (std::size_t t = 0; t < tracks_.size(); ++t) {
        if (detection_of_[t] < 0 || detection_of_[t] == first[t]) continue;
        say_ambiguous(grid.original(static_cast<std::size_t>(detection_of_[t])));
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
      throw RunError(fmt::format("frame {}, detection {}: ({}, {}) is no place in a picture.", frame, k,
                                 detections[k].x_px, detections[k].y_px));
}

}  // namespace

std::vector<std::int64_t> Linker::next(std::span<const PixelPoint> detections, const FrameMoment& moment,
                                       std::span<const std::uint8_t> tracers, const FrameAhead* ahead) {
  require_places(detections, total_.frames);
  if (ahead != nullptr) require_places(ahead->detections, total_.frames + 1);
  last_ = {.frames = 1};
  link(detections, moment, tracers, ahead);
  std::vector<std::int64_t> ids(detections.size(), -1);
  update(detections, tracers, moment, ids);
  total_.add(last_);
  return ids;
}

}  // namespace twincell
