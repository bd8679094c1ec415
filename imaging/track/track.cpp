#include "imaging/track/track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "imaging/cell/plate_row.hpp"
#include "imaging/phase/trigger_list.hpp"
#include "imaging/refine/paler_discs.hpp"
#include "imaging/settings/check_scale.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "imaging/stack/repeated_frames.hpp"
#include "imaging/track/inside_cell.hpp"
#include "imaging/track/locate_stack.hpp"
#include "imaging/track/locating_request.hpp"

namespace twincell::imaging {

namespace {

double bytes_of(const cv::Mat& frame) {
  return static_cast<double>(frame.total() * frame.elemSize());
}

/// The beads of all frames that are inside the cell, and the counts of excluded ones.
struct Detections {
  DetectionStore frames;
  std::size_t outside_cell = 0, wrong_radius = 0, paler = 0, rejected = 0;
  std::optional<Aspect> aspect;
  bool cut_by_frame = false;  ///< at least one bead is cut by the frame
};

/// A stack that keeps the size of its frames, and the evidence for their phases, as they are read.
class EvidenceCollectingSource : public FrameSource {
 public:
  EvidenceCollectingSource(FrameSource& frames, bool bright, StageTimes* times)
      : frames_(frames), bright_(bright), times_(times) {}
  bool next(cv::Mat& frame) override {
    Stage reading(times_, "reading", "frames");
    if (!frames_.next(frame)) return false;
    reading.count(1, bytes_of(frame));
    size_ = frame.size();
    if (const auto time = frames_.time_s()) evidence_.times_s.push_back(*time);
    evidence_.plate_px.push_back(plate_height_px(frame, bright_));
    repeated_.add(frame);
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return frames_.announced(); }
  [[nodiscard]] std::string current() const override { return frames_.current(); }
  [[nodiscard]] StackInfo info() const override { return frames_.info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return frames_.time_s(); }
  /// Of the frames read so far. \post the time stamps are as many as the frames, or none
  [[nodiscard]] LockEvidence evidence() const {
    LockEvidence all = evidence_;
    all.repeats = repeated_.repeats();
    all.copied = repeated_.copied();
    if (all.times_s.size() != all.plate_px.size()) all.times_s.clear();
    return all;
  }
  [[nodiscard]] const cv::Size& size() const { return size_; }

 private:
  FrameSource& frames_;
  bool bright_;
  StageTimes* times_;
  cv::Size size_;
  LockEvidence evidence_;
  RepeatedFrames repeated_;
};

/// Whether a candidate that no disc explains lies where a bead would have room. Candidates in gaps have none.
bool has_room(const Detection& candidate, const std::vector<Detection>& beads) {
  constexpr double kRoom = 1.6;  // radii, between centres
  return candidate.verdict == Verdict::unexplained &&
         std::none_of(beads.begin(), beads.end(), [&](const Detection& b) {
           return std::hypot(b.x - candidate.x, b.y - candidate.y) < kRoom * b.radius;
         });
}

Detections detect(FramesAhead& frames, const CellDescription& cell, const TrackingOptions& options,
                  const cv::Size& picture, Progress& progress, StageTimes* times) {
  Stage locating(times, "locating", "beads");
  const Region& region = options.region;
  Detections all{.frames = DetectionStore(options.folder)};
  std::vector<TrackedBead> beads;
  std::size_t inside = 0;
  const InsideCell in_cell(cell, picture);
  constexpr std::int64_t kAspectFrames = 12;
  const std::int64_t stride =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(frames.source().announced()) / kAspectFrames);
  RimAspect aspect;
  locate_stack(
      frames, options.locator, options.threads,
      [&](std::int64_t frame, const cv::Mat& grey, const Located& found) {
        if (frame % stride == 0) aspect.add(grey, found.beads, found.path_px);
        all.wrong_radius += static_cast<std::size_t>(
            std::count_if(found.dropped.begin(), found.dropped.end(),
                          [](const Detection& b) { return b.verdict == Verdict::wrong_radius; }));
        locating.count(static_cast<double>(found.beads.size()), bytes_of(grey));
        beads.clear();
        for (Detection b : found.beads) {
          b.x += region.corner().x;
          b.y += region.corner().y;
          if (region.cuts(b.x, b.y, b.radius)) continue;
          if (!in_cell({b.x, b.y})) {
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
        const auto counts = [&](const Detection& d) {
          const double x = d.x + region.corner().x, y = d.y + region.corner().y;
          return !region.cuts(x, y, d.radius) && in_cell({x, y});
        };
        for (const Detection& d : paler_discs(found.beads, found.dropped)) all.paler += counts(d) ? 1 : 0;
        for (const Detection& d : found.dropped)
          all.rejected += has_room(d, found.beads) && counts(d) ? 1 : 0;
        inside += beads.size();
        all.frames.append(beads);
      },
      progress);
  require_some_inside(cell, inside, all.outside_cell);
  all.aspect = aspect.value();
  return all;
}

/// Checks for cancellation and leaves the bar of the frames, which are all located, as it is.
class CancellationOnlyProgress : public Progress {
 public:
  explicit CancellationOnlyProgress(Progress& frames) : frames_(frames) {}
  void update(std::int64_t /*done*/, std::int64_t /*total*/) override { frames_.update(0, 0); }

 private:
  Progress& frames_;
};

/// The smallest of the diameters, which is the smallest distance of two beads.
double smallest_diameter(const LocatorOptions& locator) {
  double smallest = locator.diameter_px;
  for (const double other : locator.other_diameters_px) smallest = std::min(smallest, other);
  return smallest;
}

}  // namespace

std::string TrackedStack::scale_doubt(const CellDescription& cell) const {
  const std::string sizes = cell.disc_px() ? sizes_that_differ(locator, *cell.disc_px()) : "";
  if (sizes.empty()) return {};
  return fmt::format(
      "a bead of one sigma is {:g} px wide (camera.{}), but the discs are {} px wide: {:.3g} sigma",
      *cell.disc_px(), cell.disc_width_px ? "disc_width_px" : "pixels_per_sigma", sizes,
      smallest_diameter(locator) / *cell.disc_px());
}

std::string TrackedStack::paler_doubt() const {
  constexpr double kMany = 0.02;  // of the beads
  std::size_t beads = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) beads += frames.count(f);
  const auto left_out = static_cast<double>(paler);
  if (left_out <= kMany * static_cast<double>(beads)) return {};
  return fmt::format(
      "{:.2g} paler discs in a frame were left out: if they are beads, such as tracers, N_l, the results and "
      "a twin lack them (twincell locate --candidates lists them)",
      left_out / static_cast<double>(frames.size()));
}

std::vector<std::string> TrackedStack::doubts(const CellDescription& cell) const {
  std::vector<std::string> all;
  for (const std::string& doubt : settings_doubts) all.push_back(doubt + ".");
  for (const std::string& doubt :
       {phases.warning, camera_moved(), missing_beads(), empty_frames(), paler_doubt(), rejected_doubt(),
        surplus_tracks(), scale_doubt(cell), aspect_doubt(), still_discs()})
    if (!doubt.empty()) all.push_back(doubt + ".");
  return all;
}

std::string TrackedStack::rejected_doubt() const {
  constexpr double kMinInFrame = 0.5;
  const double in_frame =
      static_cast<double>(rejected) / static_cast<double>(std::max<std::size_t>(1, frames.size()));
  if (in_frame < kMinInFrame) return {};
  return fmt::format(
      "in {:.2g} places of a frame, in which a bead has room, a candidate was left out because no disc "
      "explains it: if they are beads, N_l, the results and a twin lack them (twincell locate --overlay)",
      in_frame);
}

TrackedStack track_stack(FrameSource& stack, const CellDescription& cell, const TrackingOptions& given,
                         Progress& progress, StageTimes* times) {
  // An unreadable list of triggers is rejected before the work, not after it.
  if (given.phases.method == PhaseMethod::triggers)
    (void)read_triggers(given.phases.triggers, given.phases.drive_hz, cell.phase_lock.frames_per_cycle);
  EvidenceCollectingSource watched(stack, given.locator.preprocess.bright, times);
  RegionFrames seen(watched, given.region);
  FramesAhead frames(seen);
  TrackingOptions options = given;
  std::vector<std::string> doubts;
  {
    const Stage configuring(times, "settings");
    const LocatorConfiguration found = configure_locator(frames, given.locator, given.threads);
    options.locator = found.locator;
    doubts = settings_doubts(in_whole_picture(found.choice, given.region), given.locator.refine.method);
  }
  const Detections detected = detect(frames, cell, options, watched.size(), progress, times);
  // If the frame cuts beads, others enter and leave.
  LinkOptions& link = options.link;
  link.closed = cell.sides == Boundary::wall && !detected.cut_by_frame;
  link.diameter_px = smallest_diameter(options.locator);
  Stage linking(times, "linking", "links");
  CancellationOnlyProgress cancellation(progress);
  LinkedDetections linked = link_detections(detected.frames, link, cell, options.phases, options.folder,
                                            cancellation, watched.evidence());
  linking.count(static_cast<double>(linked.links.links));
  TrackedStack tracked{std::move(linked),     options.locator,       watched.size().width,
                       watched.size().height, detected.outside_cell, detected.wrong_radius,
                       detected.paler,        detected.rejected};
  tracked.aspect = detected.aspect;
  tracked.settings_doubts = std::move(doubts);
  return tracked;
}

}  // namespace twincell::imaging
