#include "imaging/link/direct_links.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/constants.hpp"
#include "imaging/link/link_costs.hpp"

namespace twincell::imaging {

namespace {

/// The nearest of several partners, and the squared distances of the two nearest.
struct Nearest {
  double r2 = kInfinity, second = kInfinity;
  std::int32_t partner = -1;
  void offer(double distance2, std::int32_t who) {
    if (distance2 < r2) {
      second = r2;
      r2 = distance2;
      partner = who;
    } else {
      second = std::min(second, distance2);
    }
  }
};

Nearest nearest_detection(const FrameMatch& m, std::size_t t) {
  Nearest nearest;
  m.detections.within(m.expected[t], kLinkCosts.lookup_reach * m.options.diameter_px,
                      [&](std::size_t k, double r2) { nearest.offer(r2, static_cast<std::int32_t>(k)); });
  return nearest;
}

/// Distance of another detection than the nearest from the position in free flight, if it fits nearly as
/// well.
double rival_distance(const FrameMatch& m, std::size_t t, const Nearest& nearest) {
  const double d = m.options.diameter_px;
  if (square(m.ballistic[t] - m.expected[t]) <
      kLinkCosts.agreeing_predictions * kLinkCosts.agreeing_predictions * d * d)
    return kInfinity;
  const double reach =
      std::min(std::sqrt(nearest.r2) + kLinkCosts.preference_margin * d, kLinkCosts.settle_reach * d);
  double distance = kInfinity;
  m.detections.within(m.ballistic[t], reach, [&](std::size_t k, double r2) {
    if (static_cast<std::int32_t>(k) != nearest.partner) distance = std::min(distance, std::sqrt(r2));
  });
  return distance;
}

/// The displacements of the linked neighbours of a track from their expected positions.
class NeighbourDisplacements {
 public:
  explicit NeighbourDisplacements(const FrameMatch& match)
      : match_(match), places_(places_of(match.tracks), 1.1 * match.options.diameter_px) {}

  /// Valid until the next call; may be reordered.
  std::vector<PixelPoint>& around(std::size_t t) {
    displacements_.clear();
    places_.within(match_.tracks[t].place, kLinkCosts.neighbour_reach * match_.options.diameter_px,
                   [&](std::size_t k, double) {
                     const std::size_t other = places_.original(k);
                     if (match_.detection_of[other] >= 0 && other != t)
                       displacements_.push_back(match_.detected(other) - match_.expected_no_floor[other]);
                   });
    return displacements_;
  }

 private:
  const FrameMatch& match_;
  PointGrid places_;
  std::vector<PixelPoint> displacements_;
};

/// Whether less than a third of at least three linked neighbours are displaced like a linked track.
bool is_odd(const FrameMatch& m, std::size_t t, const std::vector<PixelPoint>& displacements) {
  const double d = m.options.diameter_px;
  const PixelPoint displacement = m.detected(t) - m.expected_no_floor[t];
  std::size_t agreeing = 0;
  for (const PixelPoint w : displacements)
    agreeing +=
        square(w - displacement) < kLinkCosts.agreeing_steps * kLinkCosts.agreeing_steps * d * d ? 1 : 0;
  return displacements.size() >= 3 && 3 * agreeing < displacements.size();
}

/// Reopens settled tracks that are odd. \param open they are added to it
void reopen_odd(FrameMatch& m, NeighbourDisplacements& neighbours, std::vector<std::int32_t>& open) {
  std::vector<std::int32_t> odd;
  for (std::size_t t = 0; t < m.tracks.size(); ++t)
    if (m.detection_of[t] >= 0 && is_odd(m, t, neighbours.around(t)))
      odd.push_back(static_cast<std::int32_t>(t));
  for (const std::int32_t t : odd) {
    std::int32_t& k = m.detection_of[static_cast<std::size_t>(t)];
    m.track_of[static_cast<std::size_t>(k)] = -1;
    k = -1;
    open.push_back(t);
    --m.report.settled;
  }
}

/// The nearest free detection to the position that the neighbours of an open track predict, with its squared
/// distance; partner -1 if there is none within reach. Sets the correction from the neighbours.
Nearest predicted_by_neighbours(FrameMatch& m, NeighbourDisplacements& neighbours, std::size_t t) {
  constexpr std::size_t kMinNeighbours = 3;
  const double d = m.options.diameter_px;
  Nearest nearest;
  std::vector<PixelPoint>& displacements = neighbours.around(t);
  if (displacements.size() < kMinNeighbours) return nearest;
  m.neighbour_correction[t] = median(displacements);
  const double reach =
      std::min(kLinkCosts.settle_reach * d, m.rival_distance[t] - kLinkCosts.preference_margin * d);
  if (reach <= 0) return nearest;
  nearest.r2 = reach * reach;
  m.detections.within(m.expected_no_floor[t] + m.neighbour_correction[t], reach,
                      [&](std::size_t k, double r2) {
                        if (m.track_of[k] >= 0 || r2 >= nearest.r2) return;
                        nearest.r2 = r2;
                        nearest.partner = static_cast<std::int32_t>(k);
                      });
  return nearest;
}

/// Links open tracks next to settled ones; of several tracks that lead to a detection, the nearest.
/// \returns whether any was linked
bool link_next_to_settled(FrameMatch& m, NeighbourDisplacements& neighbours,
                          const std::vector<std::int32_t>& open,
                          std::vector<std::pair<double, std::int32_t>>& candidate) {
  std::vector<std::pair<std::int32_t, std::int32_t>> proposals;
  std::fill(candidate.begin(), candidate.end(), std::pair{kInfinity, -1});
  for (const std::int32_t t : open) {
    const Nearest nearest = predicted_by_neighbours(m, neighbours, static_cast<std::size_t>(t));
    if (nearest.partner < 0) continue;
    proposals.emplace_back(t, nearest.partner);
    auto& s = candidate[static_cast<std::size_t>(nearest.partner)];
    s = std::min(s, std::pair{nearest.r2, t});
  }
  bool any = false;
  for (const auto& [t, k] : proposals) {
    if (candidate[static_cast<std::size_t>(k)].second != t) continue;
    m.detection_of[static_cast<std::size_t>(t)] = k;
    m.track_of[static_cast<std::size_t>(k)] = t;
    any = true;
  }
  return any;
}

}  // namespace

void link_without_rivals(FrameMatch& m) {
  const double d = m.options.diameter_px;
  // Look-ups in both directions: the nearest detections of each track, the nearest tracks of each detection.
  std::vector<Nearest> of_detection(m.detections.size()), of_track(m.tracks.size());
  m.rival_distance.assign(m.tracks.size(), kInfinity);
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    const Nearest nearest = of_track[t] = nearest_detection(m, t);
    if (nearest.partner < 0 || m.tracks[t].missed > 0) continue;
    of_detection[static_cast<std::size_t>(nearest.partner)].offer(nearest.r2, static_cast<std::int32_t>(t));
    m.rival_distance[t] = rival_distance(m, t, nearest);
  }
  // Links: pairs that are each other's nearest, without a rival on either side.
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    const Nearest& c = of_track[t];
    if (c.partner < 0 || c.r2 > kLinkCosts.settle_reach * kLinkCosts.settle_reach * d * d ||
        m.tracks[t].missed > 0 || m.rival_distance[t] < kInfinity)
      continue;
    const auto k = static_cast<std::size_t>(c.partner);
    const Nearest& s = of_detection[k];
    if (s.partner != static_cast<std::int32_t>(t)) continue;
    if (kLinkCosts.rival_ratio * kLinkCosts.rival_ratio * c.r2 >= std::min(c.second, s.second)) continue;
    if (m.changes_type(t, k)) continue;
    m.detection_of[t] = c.partner;
    m.track_of[k] = static_cast<std::int32_t>(t);
    ++m.report.settled;
  }
}

// An alternative was tried: pushing predictions apart where discs would overlap, from the plate upwards.
// Fewer links were wrong in convecting beds (by 7 in 100), more in bouncing beds, and it was a quarter
// slower.
void follow_neighbours(FrameMatch& m) {
  m.neighbour_correction.assign(m.tracks.size(), {kNaN, kNaN});
  std::vector<std::int32_t> open;
  for (std::size_t t = 0; t < m.tracks.size(); ++t)
    if (m.detection_of[t] < 0) open.push_back(static_cast<std::int32_t>(t));
  if (open.empty() || open.size() == m.tracks.size()) return;
  NeighbourDisplacements neighbours(m);
  // With many open tracks, some of the settled ones were settled by chance.
  if (static_cast<double>(open.size()) > kLinkCosts.open_fraction * static_cast<double>(m.tracks.size()))
    reopen_odd(m, neighbours, open);
  // Rounds, so that links spread through the bed.
  std::vector<std::pair<double, std::int32_t>> candidate(m.detections.size());
  for (int round = 0; round < kLinkCosts.neighbour_rounds && !open.empty(); ++round) {
    if (!link_next_to_settled(m, neighbours, open, candidate)) break;
    std::erase_if(open, [&](std::int32_t t) { return m.detection_of[static_cast<std::size_t>(t)] >= 0; });
  }
}

}  // namespace twincell::imaging
