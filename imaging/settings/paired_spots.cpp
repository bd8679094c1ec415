#include "imaging/settings/paired_spots.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/median.hpp"

namespace twincell::imaging {

namespace {

struct Offset {
  double x = 0, y = 0;
};

/// The nearest disc to each, and the distance of the second nearest, px.
struct Neighbour {
  std::size_t first = 0;
  double distance = HUGE_VAL, second = HUGE_VAL;
};

template <class Place>
std::vector<Neighbour> neighbours_of(const std::vector<Place>& places) {
  std::vector<Neighbour> all(places.size());
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < places.size(); ++b) {
      if (a == b) continue;
      const double r = std::hypot(places[b].x - places[a].x, places[b].y - places[a].y);
      if (r < all[a].distance)
        all[a] = {b, r, all[a].distance};
      else
        all[a].second = std::min(all[a].second, r);
    }
  return all;
}

/// The median of a quantity of all offsets.
double median_of(const std::vector<Offset>& offsets, double Offset::*of) {
  std::vector<double> values;
  for (const Offset& o : offsets) values.push_back(o.*of);
  return upper_median(std::move(values));
}

}  // namespace

std::optional<SpotPairs> spot_pairs(const std::vector<Detection>& discs) {
  constexpr std::size_t kMinPairs = 10, kMostDiscs = 5000;
  constexpr double kNearlyAll = 0.8;  // of the discs
  constexpr double kCloser = 0.8;     // than to the second neighbour, for most of the pairs
  constexpr double kAlike = 0.15;     // deviation of an offset from the common one, in its length
  constexpr double kFew = 0.1;        // pairs of which the nearest are as near
  if (discs.size() < 2 * kMinPairs || discs.size() > kMostDiscs) return std::nullopt;
  const std::vector<Neighbour> near = neighbours_of(discs);
  std::vector<Offset> offsets;
  std::vector<SpotPairs::Middle> middles;
  std::vector<double> closer;
  for (std::size_t a = 0; a < discs.size(); ++a) {
    const std::size_t b = near[a].first;
    if (b < a || near[b].first != a) continue;
    Offset o{discs[b].x - discs[a].x, discs[b].y - discs[a].y};
    if (!offsets.empty() && o.x * offsets.front().x + o.y * offsets.front().y < 0) o = {-o.x, -o.y};
    offsets.push_back(o);
    middles.push_back({0.5 * (discs[a].x + discs[b].x), 0.5 * (discs[a].y + discs[b].y)});
    closer.push_back(near[a].distance / std::min(near[a].second, near[b].second));
  }
  const double least = 0.5 * kNearlyAll * static_cast<double>(discs.size());
  if (static_cast<double>(offsets.size()) < least || offsets.size() < kMinPairs) return std::nullopt;
  const double dx = median_of(offsets, &Offset::x), dy = median_of(offsets, &Offset::y);
  const auto alike = std::count_if(offsets.begin(), offsets.end(), [&](const Offset& o) {
    return std::hypot(o.x - dx, o.y - dy) < kAlike * std::hypot(dx, dy);
  });
  if (static_cast<double>(alike) < least || upper_median(std::move(closer)) > kCloser) return std::nullopt;
  std::vector<double> apart;
  for (const Neighbour& n : neighbours_of(middles)) apart.push_back(n.distance);
  std::sort(apart.begin(), apart.end());
  const double touching = apart[static_cast<std::size_t>(kFew * static_cast<double>(apart.size()))];
  return SpotPairs{dx < 0 ? -dx : dx, dx < 0 ? -dy : dy, touching, std::move(middles)};
}

bool are_between(const std::vector<Detection>& discs, const SpotPairs& pairs) {
  constexpr double kOff = 0.25;  // of the distance of the two
  const double apart = std::hypot(pairs.dx_px, pairs.dy_px);
  std::vector<double> along;
  for (const Detection& d : discs) {
    double nearest = HUGE_VAL, off = 0;
    for (const SpotPairs::Middle& m : pairs.middles) {
      const double x = d.x - m.x, y = d.y - m.y, r = std::hypot(x, y);
      if (r < nearest) nearest = r, off = std::abs(x * pairs.dx_px + y * pairs.dy_px) / apart;
    }
    along.push_back(off);
  }
  return !along.empty() && upper_median(std::move(along)) < kOff * apart;
}

}  // namespace twincell::imaging
