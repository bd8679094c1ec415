#include "imaging/track/track.hpp"

#include <algorithm>
#include <utility>

#include "imaging/phase/trigger_list.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/track/locate_stack.hpp"

namespace twincell {

namespace {

bool outside(const CellDescription& cell, cv::Size picture, const Detection& b) {
  if (!cell.origin || !cell.pixels_per_sigma) return false;
  const Vec3 r = cell.pixel_frame(picture).cell_from_pixel({b.x, b.y});
  return (cell.width && (r.x() < 0 || r.x() > *cell.width)) || (cell.height && r.z() > *cell.height + 0.5);
}

/// The beads of all frames that are inside the cell, and the counts of excluded ones.
struct Detections {
  DetectionStore frames;
  cv::Size picture;
  std::size_t outside_cell = 0, wrong_radius = 0;
  bool cut_by_frame = false;  ///< at least one bead is cut by the frame
};

Detections detect(FramesAhead& frames, const LocatorOptions& locator, const CellDescription& cell,
                  int threads, Progress& progress, const std::filesystem::path& folder) {
  Detections all{.frames = DetectionStore(folder), .picture = {}};
  std::vector<TrackedBead> beads;
  locate_stack(
      frames, locator, threads,
      [&](std::int64_t, const cv::Mat& grey, const Located& found) {
        all.picture = grey.size();
        all.wrong_radius += static_cast<std::size_t>(
            std::count_if(found.dropped.begin(), found.dropped.end(),
                          [](const Detection& b) { return b.verdict == Verdict::wrong_radius; }));
        beads.clear();
        for (const Detection& b : found.beads) {
          if (outside(cell, grey.size(), b)) {
            ++all.outside_cell;
            continue;
          }
          all.cut_by_frame = all.cut_by_frame || b.edge;
          beads.push_back({.x_px = b.x,
                           .y_px = b.y,
                           .radius_px = b.radius,
                           .tracer = b.tracer,
                           .sigma_x_px = b.sigma_x,
                           .sigma_y_px = b.sigma_y});
        }
        all.frames.append(beads);
      },
      progress);
  return all;
}

/// The smallest of the diameters, which is the smallest distance of two beads.
double smallest_diameter(const LocatorOptions& locator) {
  double smallest = locator.diameter_px;
  for (const double other : locator.other_diameters_px) smallest = std::min(smallest, other);
  return smallest;
}

}  // namespace

TrackedStack track_stack(FrameSource& stack, const LocatorOptions& given, LinkOptions link,
                         const CellDescription& cell, int threads, Progress& progress,
                         const PhaseSource& source, const std::filesystem::path& folder) {
  // An unreadable list of triggers is rejected before the work, not after it.
  if (source.method == PhaseMethod::triggers)
    (void)read_triggers(source.triggers, source.drive_hz, cell.phase_lock.frames_per_cycle);
  FramesAhead frames(stack);
  const LocatorOptions locator = configure_locator(frames, given).locator;
  const Detections detected = detect(frames, locator, cell, threads, progress, folder);
  // If the frame cuts beads, others enter and leave.
  link.closed = cell.sides == Boundary::wall && !detected.cut_by_frame;
  link.diameter_px = smallest_diameter(locator);
  return {link_detections(detected.frames, link, cell, source, folder),
          locator,
          detected.picture.width,
          detected.picture.height,
          detected.outside_cell,
          detected.wrong_radius};
}

}  // namespace twincell
