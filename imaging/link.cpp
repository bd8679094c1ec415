#include "imaging/link.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "analysis/trajectory/error.hpp"

namespace twincell {

namespace {

constexpr double kSafe = 0.3;           // diameters
constexpr double kVelocityTrust = 0.8;  // share of the last own step that the next is expected to repeat

/// Points in square bins, for the question "who is within reach".
class Bins {
 public:
  Bins(const std::vector<PixelPoint>& points, double size) : points_(points), size_(size) {
    for (std::size_t i = 0; i < points.size(); ++i)
      bins_[key(bin(points[i].x_px), bin(points[i].y_px))].push_back(i);
  }
  template <class Visit>
  void within(PixelPoint p, double reach, Visit&& visit) const {
    const std::int64_t n = static_cast<std::int64_t>(std::ceil(reach / size_));
    const std::int64_t bx = bin(p.x_px), by = bin(p.y_px);
    for (std::int64_t j = by - n; j <= by + n; ++j)
      for (std::int64_t i = bx - n; i <= bx + n; ++i) {
        const auto found = bins_.find(key(i, j));
        if (found == bins_.end()) continue;
        for (const std::size_t k : found->second) {
          const double dx = points_[k].x_px - p.x_px, dy = points_[k].y_px - p.y_px;
          if (dx * dx + dy * dy <= reach * reach) visit(k, dx, dy);
        }
      }
  }

 private:
  [[nodiscard]] std::int64_t bin(double v) const { return static_cast<std::int64_t>(std::floor(v / size_)); }
  static std::int64_t key(std::int64_t i, std::int64_t j) { return j * 1'000'003 + i; }
  const std::vector<PixelPoint>& points_;
  double size_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> bins_;
};

// Peak of the histogram of all pair shifts within reach, counted in cells of d/8 and over 3 x 3 of them; of
// equal peaks the shortest shift. Then the median of the shifts that fall there.
PixelPoint common_motion(const std::vector<PixelPoint>& from, const Bins& to, double d, double reach) {
  const double cell = d / 8;
  const int half = static_cast<int>(std::ceil(reach / cell)) + 1;
  const auto n = static_cast<std::size_t>(2 * half + 1);
  std::vector<int> count(n * n);
  auto index = [&](int i, int j) {
    return static_cast<std::size_t>(j + half) * n + static_cast<std::size_t>(i + half);
  };
  auto cell_of = [&](double v) { return static_cast<int>(std::lround(v / cell)); };
  for (const PixelPoint& p : from)
    to.within(p, reach, [&](std::size_t, double dx, double dy) { ++count[index(cell_of(dx), cell_of(dy))]; });
  int best = 0, best_i = 0, best_j = 0;
  for (int j = 1 - half; j < half; ++j)
    for (int i = 1 - half; i < half; ++i) {
      int sum = 0;
      for (int b = -1; b <= 1; ++b)
        for (int a = -1; a <= 1; ++a) sum += count[index(i + a, j + b)];
      if (sum > best || (sum == best && i * i + j * j < best_i * best_i + best_j * best_j)) {
        best = sum;
        best_i = i;
        best_j = j;
      }
    }
  if (best < 3) return {};
  std::vector<double> dxs, dys;
  for (const PixelPoint& p : from)
    to.within(p, reach, [&](std::size_t, double dx, double dy) {
      if (std::abs(cell_of(dx) - best_i) > 1 || std::abs(cell_of(dy) - best_j) > 1) return;
      dxs.push_back(dx);
      dys.push_back(dy);
    });
  auto median = [](std::vector<double>& v) {
    const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
    std::nth_element(v.begin(), middle, v.end());
    return *middle;
  };
  return {median(dxs), median(dys)};
}

struct Candidate {
  std::size_t track, detection;
  double cost;  // squared distance less the price of leaving both alone; negative: worth having
};

std::size_t root(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Groups of tracks and detections joined by candidates; each solved as a dense problem in which every track
// may also stay alone at cost 0.
void solve_groups(const std::vector<Candidate>& candidates, std::size_t n_tracks, std::size_t n_detections,
                  std::vector<std::int64_t>& track_of) {
  std::vector<std::size_t> parent(n_tracks + n_detections);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (const Candidate& c : candidates) parent[root(parent, c.track)] = root(parent, n_tracks + c.detection);
  std::unordered_map<std::size_t, std::vector<Candidate>> groups;
  std::vector<std::size_t> order;
  for (const Candidate& c : candidates) {
    const std::size_t r = root(parent, c.track);
    if (groups[r].empty()) order.push_back(r);
    groups[r].push_back(c);
  }
  for (const std::size_t r : order) {
    const std::vector<Candidate>& group = groups[r];
    std::vector<std::size_t> tracks, detections;
    for (const Candidate& c : group) {
      tracks.push_back(c.track);
      detections.push_back(c.detection);
    }
    auto unique = [](std::vector<std::size_t>& v) {
      std::sort(v.begin(), v.end());
      v.erase(std::unique(v.begin(), v.end()), v.end());
    };
    unique(tracks);
    unique(detections);
    const std::size_t n = tracks.size(), m = detections.size() + n;
    const double forbidden = 1e12;
    std::vector<double> cost(n * m, forbidden);
    auto place = [](const std::vector<std::size_t>& v, std::size_t x) {
      return static_cast<std::size_t>(std::lower_bound(v.begin(), v.end(), x) - v.begin());
    };
    for (const Candidate& c : group)
      cost[place(tracks, c.track) * m + place(detections, c.detection)] = c.cost;
    for (std::size_t i = 0; i < n; ++i) cost[i * m + detections.size() + i] = 0;
    const std::vector<std::size_t> column = assign(cost, n, m);
    for (std::size_t i = 0; i < n; ++i)
      if (column[i] < detections.size())
        track_of[detections[column[i]]] = static_cast<std::int64_t>(tracks[i]);
  }
}

}  // namespace

std::vector<std::size_t> assign(const std::vector<double>& cost, std::size_t n, std::size_t m) {
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> u(n + 1), v(m + 1);
  std::vector<std::size_t> row_of(m + 1, 0), way(m + 1, 0);  // rows and columns from 1; 0 is nobody
  for (std::size_t i = 1; i <= n; ++i) {
    row_of[0] = i;
    std::size_t j0 = 0;
    std::vector<double> least(m + 1, infinity);
    std::vector<bool> used(m + 1, false);
    do {
      used[j0] = true;
      const std::size_t i0 = row_of[j0];
      double delta = infinity;
      std::size_t j1 = 0;
      for (std::size_t j = 1; j <= m; ++j) {
        if (used[j]) continue;
        const double reduced = cost[(i0 - 1) * m + j - 1] - u[i0] - v[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          way[j] = j0;
        }
        if (least[j] < delta) {
          delta = least[j];
          j1 = j;
        }
      }
      for (std::size_t j = 0; j <= m; ++j) {
        if (used[j]) {
          u[row_of[j]] += delta;
          v[j] -= delta;
        } else {
          least[j] -= delta;
        }
      }
      j0 = j1;
    } while (row_of[j0] != 0);
    do {
      const std::size_t j1 = way[j0];
      row_of[j0] = row_of[j1];
      j0 = j1;
    } while (j0 != 0);
  }
  std::vector<std::size_t> column(n);
  for (std::size_t j = 1; j <= m; ++j)
    if (row_of[j] != 0) column[row_of[j] - 1] = j - 1;
  return column;
}

Linker::Linker(const LinkOptions& options) : options_(options) {
  auto at = [](const char* key) { return Where{.file = {}, .key = key}; };
  require_range(at("diameter"), options.diameter_px, 0, std::nullopt, true);
  require_range(at("range"), options.range_diameters, 0, 10, true);
  require_range(at("memory"), options.memory, 0, 1000);
  require_range(at("max-shift"), options.max_shift_diameters, 0, 10);
}

std::vector<std::int64_t> Linker::next(const std::vector<PixelPoint>& detections) {
  const double d = options_.diameter_px;
  const Bins bins(detections, d);
  std::vector<PixelPoint> places;
  for (const Track& t : tracks_)
    if (t.missed == 0) places.push_back(t.place);
  shift_ = options_.max_shift_diameters > 0 ? common_motion(places, bins, d, options_.max_shift_diameters * d)
                                            : PixelPoint{};

  // Candidates of each track about its predicted place.
  std::vector<Candidate> candidates;
  std::vector<PixelPoint> predicted;
  std::vector<double> nearest(detections.size(), std::numeric_limits<double>::infinity());
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    predicted.push_back({track.place.x_px + shift_.x_px + kVelocityTrust * track.own_step.x_px,
                         track.place.y_px + shift_.y_px + kVelocityTrust * track.own_step.y_px});
    const double reach = options_.range_diameters * d * (1 + 0.5 * track.missed);
    bins.within(predicted[t], reach, [&](std::size_t k, double dx, double dy) {
      candidates.push_back({t, k, dx * dx + dy * dy - reach * reach});
      nearest[k] = std::min(nearest[k], dx * dx + dy * dy);
    });
  }

  // Settled at once: detections within 0.3 d of the prediction of a track that nobody else is nearer to.
  std::vector<std::int64_t> track_of(detections.size(), -1);
  std::vector<bool> settled(tracks_.size(), false);
  for (const Candidate& c : candidates) {
    const double dx = detections[c.detection].x_px - predicted[c.track].x_px,
                 dy = detections[c.detection].y_px - predicted[c.track].y_px, square = dx * dx + dy * dy;
    if (square > nearest[c.detection] || square > kSafe * kSafe * d * d || track_of[c.detection] >= 0)
      continue;
    if (settled[c.track]) continue;
    settled[c.track] = true;
    track_of[c.detection] = static_cast<std::int64_t>(c.track);
  }
  std::erase_if(candidates,
                [&](const Candidate& c) { return settled[c.track] || track_of[c.detection] >= 0; });
  solve_groups(candidates, tracks_.size(), detections.size(), track_of);

  // Survivors, the missing within memory, and the newly born, in order of identity.
  std::vector<std::int64_t> ids(detections.size());
  std::vector<bool> seen(tracks_.size(), false);
  std::vector<Track> alive;
  for (std::size_t k = 0; k < detections.size(); ++k) {
    const PixelPoint p = detections[k];
    if (track_of[k] < 0) {
      ids[k] = n_tracks_++;
      alive.push_back({ids[k], p, {}, 0});
      continue;
    }
    const auto t = static_cast<std::size_t>(track_of[k]);
    const Track& old = tracks_[t];
    seen[t] = true;
    ids[k] = old.id;
    const double frames = old.missed + 1;
    alive.push_back(
        {old.id,
         p,
         {(p.x_px - old.place.x_px - shift_.x_px) / frames, (p.y_px - old.place.y_px - shift_.y_px) / frames},
         0});
  }
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Track track = tracks_[t];
    if (seen[t] || ++track.missed > options_.memory) continue;
    track.place = {track.place.x_px + shift_.x_px, track.place.y_px + shift_.y_px};
    alive.push_back(track);
  }
  std::sort(alive.begin(), alive.end(), [](const Track& a, const Track& b) { return a.id < b.id; });
  tracks_ = std::move(alive);
  return ids;
}

}  // namespace twincell
