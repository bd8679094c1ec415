#include "imaging/link/rematch.hpp"

#include <algorithm>
#include <cmath>

#include "imaging/link/assignment.hpp"
#include "imaging/link/collective_matching.hpp"
#include "imaging/link/link_costs.hpp"

namespace twincell::imaging {

namespace {

// Cost of having no detection. A visible bead does not vanish, unless it leaves an open picture, that is,
// crosses the bounding box of all detections so far.
double cost_of_no_match(const FrameMatch& m, std::size_t t) {
  const Track& track = m.tracks[t];
  if (m.before.is_unconfirmed(track)) return kLinkCosts.unconfirmed_no_match_cost;
  if (m.options.closed) return kLinkCosts.no_match_cost;
  if (track.missed > 0) return kLinkCosts.leaving_cost;
  const PixelPoint from = track.place, to = from + track.step, low = m.before.low, high = m.before.high;
  const double least = kLinkCosts.least_outward_step * m.options.diameter_px;
  const auto leaves = [&](double x, double was, double lowest, double highest) {
    return (x < lowest && was - x > least) || (x > highest && x - was > least);
  };
  return leaves(to.x_px, from.x_px, low.x_px, high.x_px) || leaves(to.y_px, from.y_px, low.y_px, high.y_px)
             ? kLinkCosts.leaving_cost
             : kLinkCosts.no_match_cost;
}

// For each detection, in the order of the grid: whether it may be a bead that came into an open picture. Such
// a detection is near the border of the bounding box of all detections so far, and no track is expected
// there.
std::vector<std::uint8_t> newcomers(const FrameMatch& m) {
  std::vector<std::uint8_t> new_there(m.detections.size(), 0);
  if (m.options.closed) return new_there;
  const double d = m.options.diameter_px, margin = kLinkCosts.entry_margin * d;
  const PixelPoint low = m.before.low, high = m.before.high;
  for (std::size_t k = 0; k < m.detections.size(); ++k) {
    const PixelPoint p = m.detections[k];
    new_there[k] = p.x_px < low.x_px + margin || p.y_px < low.y_px + margin || p.x_px > high.x_px - margin ||
                   p.y_px > high.y_px - margin;
  }
  for (std::size_t t = 0; t < m.tracks.size(); ++t)
    for (const PixelPoint p : {m.expected[t], m.ballistic[t]})
      m.detections.within(p, kLinkCosts.lookup_reach * d, [&](std::size_t k, double) { new_there[k] = 0; });
  return new_there;
}

struct CollisionPath {
  double miss2;   // squared distance of the detection from the one-collision line, diameters squared
  double length;  // of that line, diameters
};

// Distance of a detection from the line of all one-collision paths. A bead that is hit once between two
// frames has its old velocity before the hit and its new velocity after it. Its step therefore ends on the
// straight line between the end of the step that repeats the previous free flight and the end of the step
// from which the following free flight continues. Gravity does not change this, because its terms are linear
// in the time of the hit.
CollisionPath collision_path(const FrameMatch& m, std::size_t track, PixelPoint to, PixelPoint step_back) {
  const double d = m.options.diameter_px;
  const PixelPoint from_flight = to - m.ballistic[track],
                   line = m.tracks[track].place + step_back - m.ballistic[track];
  const double l2 = square(line), dot = from_flight.x_px * line.x_px + from_flight.y_px * line.y_px;
  const double part = l2 > 0 ? std::clamp(dot / l2, 0.0, 1.0) : 0;
  return {square(from_flight - part * line) / (d * d), std::sqrt(l2) / d};
}

// Cost of the cheapest explanation of track t being at detection k.
double cost_at(const FrameMatch& m, std::size_t t, std::size_t k, const std::vector<PixelPoint>& steps_back) {
  const double d = m.options.diameter_px;
  const Track& track = m.tracks[t];
  const PixelPoint at = m.detections[k];
  double least = kLinkCosts.any_position_cost;
  least = std::min(
      least, cost(square(at - m.expected[t]) / (d * d), kLinkCosts.prediction_width * (1 + track.missed)));
  if (track.missed == 0) {
    const double width = kLinkCosts.ballistic_width;
    least = std::min(least, kLinkCosts.ballistic_exponent *
                                    std::log1p(square(at - m.ballistic[t]) / (width * width * d * d)) +
                                2 * std::log(width) + kLinkCosts.ballistic_cost);
  }
  if (track.missed == 0 && !steps_back.empty() && std::isfinite(steps_back[k].x_px)) {
    const double width = kLinkCosts.collision_width;
    const CollisionPath w = collision_path(m, t, at, steps_back[k]);
    least = std::min(least, kLinkCosts.collision_exponent * std::log1p(w.miss2 / (width * width)) +
                                std::log(width * (width + w.length)) + kLinkCosts.collision_cost);
  }
  if (m.changes_type(t, k)) least += kLinkCosts.type_change_cost;
  return least;
}

// Choices of a track: the detections within reach of the positions where it may be, with their costs; the
// cheapest if they are many.
void find_choices(const FrameMatch& m, std::size_t t, const std::vector<PixelPoint>& steps_back,
                  std::vector<Edge>& choices) {
  const Track& track = m.tracks[t];
  const double no_match = cost_of_no_match(m, t);
  const double reach = std::min(kLinkCosts.matching_reach, m.options.range_diameters) * m.options.diameter_px;
  choices.clear();
  const auto look = [&](PixelPoint about) {
    m.detections.within(about, reach, [&](std::size_t k, double) {
      if (std::any_of(choices.begin(), choices.end(), [&](const Edge& e) { return e.column == k; })) return;
      choices.push_back({static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(k),
                         cost_at(m, t, k, steps_back) - no_match});
    });
  };
  look(m.expected[t]);
  if (track.missed == 0) {
    look(m.ballistic[t]);
    look(track.place + m.time.interval * m.before.step);
    look(track.place);
  }
  keep_cheapest(choices, kLinkCosts.max_choices);
}

// Replaces all earlier links by those of the matching.
void take(FrameMatch& m, const CollectiveMatching& matching) {
  std::fill(m.detection_of.begin(), m.detection_of.end(), -1);
  std::fill(m.ambiguous.begin(), m.ambiguous.end(), std::uint8_t{0});
  m.report.settled = m.report.ambiguous = 0;
  m.report.rematched = 1;
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    const std::int64_t k = matching.column_of_row[t];
    if (k < 0) continue;
    m.detection_of[t] = static_cast<std::int32_t>(k);
    if (matching.margin[t] < std::log(kAmbiguousOdds)) m.mark_ambiguous(static_cast<std::size_t>(k));
  }
}

}  // namespace

bool neighbours_separate(const FrameMatch& m) {
  const double d = m.options.diameter_px;
  const PointGrid neighbours(places_of(m.tracks), 1.1 * d);
  const bool left_over = std::find(m.track_of.begin(), m.track_of.end(), -1) != m.track_of.end();
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    if (m.tracks[t].missed > 0) continue;
    if (m.detection_of[t] < 0) {
      if (left_over) return true;
      continue;
    }
    const PixelPoint step = m.detected(t) - m.tracks[t].place;
    bool separates = false;
    neighbours.within(m.tracks[t].place, kLinkCosts.touching_reach * d, [&](std::size_t k, double) {
      const std::size_t other = neighbours.original(k);
      if (m.tracks[other].missed > 0 || m.detection_of[other] < 0) return;
      const PixelPoint theirs = m.detected(other) - m.tracks[other].place;
      separates = separates || square(theirs - step) > kLinkCosts.separation * kLinkCosts.separation * d * d;
    });
    if (separates) return true;
  }
  return false;
}

void match_all(FrameMatch& m, const std::vector<PixelPoint>& steps_back) {
  std::vector<Edge> choices, own;
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    find_choices(m, t, steps_back, own);
    choices.insert(choices.end(), own.begin(), own.end());
  }
  // In one layer of discs each bead has about a dozen choices. With many more, the points are not such a
  // layer, and the matching would take too long.
  if (choices.size() > kLinkCosts.max_mean_choices * std::min(m.tracks.size(), m.detections.size())) return;
  std::vector<PixelPoint> detections;
  for (std::size_t k = 0; k < m.detections.size(); ++k) detections.push_back(m.detections[k]);
  const std::vector<std::uint8_t> new_there = newcomers(m);
  take(m, match_collectively(places_of(m.tracks), detections, choices, m.options.diameter_px,
                             {m.detection_of, m.options.closed && m.is_complete(), new_there}));
}

bool follows_ballistic(const FrameMatch& m, const std::vector<PixelPoint>& steps_back) {
  const double d = m.options.diameter_px;
  std::size_t unexpected = 0, explained = 0;
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    if (m.detection_of[t] < 0 || m.tracks[t].missed > 0) continue;
    const auto k = static_cast<std::size_t>(m.detection_of[t]);
    const double miss2 = square(m.detections[k] - m.expected[t]) / (d * d);
    if (!std::isfinite(steps_back[k].x_px) || miss2 <= kLinkCosts.settle_reach * kLinkCosts.settle_reach)
      continue;
    ++unexpected;
    explained += 4 * collision_path(m, t, m.detections[k], steps_back[k]).miss2 < miss2 ? 1 : 0;
  }
  return 3 * explained > unexpected;
}

// A longer reach for all beads was tried: it gives as many beads a wrong detection as a right one.
void link_left_over(FrameMatch& m) {
  if (!m.options.closed || !m.is_complete()) return;
  const double farthest = kLinkCosts.left_over_reach * m.options.diameter_px;
  std::vector<std::size_t> tracks, left;
  std::vector<std::uint8_t> taken(m.detections.size(), 0);
  for (std::size_t t = 0; t < m.tracks.size(); ++t)
    if (m.detection_of[t] < 0)
      tracks.push_back(t);
    else
      taken[static_cast<std::size_t>(m.detection_of[t])] = 1;
  for (std::size_t k = 0; k < m.detections.size(); ++k)
    if (taken[k] == 0) left.push_back(k);
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    for (std::size_t j = 0; j < left.size(); ++j) {
      const std::size_t t = tracks[i];
      const PixelPoint p = m.detections[left[j]];
      const double r2 =
          std::min({square(p - m.expected[t]), square(p - m.ballistic[t]), square(p - m.tracks[t].place)});
      if (r2 < farthest * farthest)  // all costs are negative, so as many as possible are assigned
        edges.push_back(
            {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), std::sqrt(r2) - 2 * farthest});
    }
  const Assignment best = assign(tracks.size(), left.size(), edges);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (best.column_of_row[i] < 0) continue;
    const std::size_t k = left[static_cast<std::size_t>(best.column_of_row[i])];
    m.detection_of[tracks[i]] = static_cast<std::int32_t>(k);
    m.mark_ambiguous(k);
  }
}

}  // namespace twincell::imaging
