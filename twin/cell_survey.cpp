#include "twin/cell_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/drive/bed_in_view.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "imaging/stack/chosen_frames.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::twin {
namespace {

/// The frames of a stack up to the first one that cannot be read.
class ReadableFrames : public imaging::FrameSource {
 public:
  explicit ReadableFrames(const std::filesystem::path& stack) : all_(imaging::open_frames(stack)) {}
  bool next(cv::Mat& frame) override {
    if (!unreadable_.empty()) return false;
    try {
      if (!all_->next(frame)) return false;
    } catch (const InputError& e) {
      if (read_ == 0) throw;
      unreadable_ = e.what();
      return false;
    }
    ++read_;
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return all_->announced(); }
  [[nodiscard]] std::string current() const override { return all_->current(); }
  [[nodiscard]] imaging::StackInfo info() const override { return all_->info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return all_->time_s(); }
  [[nodiscard]] const std::string& unreadable() const { return unreadable_; }
  [[nodiscard]] std::size_t read() const { return read_; }

 private:
  std::unique_ptr<imaging::FrameSource> all_;
  std::string unreadable_;
  std::size_t read_ = 0;
};

/// Bead size and polarity from the first frames; sizes in a dozen frames.
/// \returns the locator, if there are beads
std::optional<imaging::LocatorOptions> survey_beads(CellSurvey& s, const SurveyOptions& options,
                                                    const ProgressOf& progress) {
  constexpr int kFrames = 12;
  const char* remedy = "give the bead diameter in px with --diameter";
  imaging::LocatorOptions given;
  given.diameter_px = options.diameter_px;
  given.polarity_known = false;
  imaging::LocatorOptions found;
  {
    ReadableFrames frames(s.stack);
    imaging::FramesAhead ahead(frames);
    const auto bar = progress("bead size");
    bar->update(0, 1);
    if (const cv::Mat* first = ahead.look(0)) s.picture = first->clone();
    s.size = s.picture.size();
    s.info = frames.info();
    try {
      const imaging::LocatorConfiguration c = imaging::configure_locator(ahead, given, options.threads);
      found = c.locator;
      s.frame = static_cast<std::size_t>(c.frame);
      for (const std::string& doubt : imaging::settings_doubts(c.choice, found.refine.method))
        s.notes.push_back(doubt + ".");
      s.picture = ahead.look(s.frame)->clone();
      s.discs = imaging::locate(s.picture, found).beads;
    } catch (const InputError&) {
      s.missing.push_back({"the bead diameter", "no round beads stand out in the first frames", remedy});
      return std::nullopt;
    }
    bar->update(1, 1);
  }
  // A single blob is no bed: an evenly lit cell looks like one large disc.
  constexpr std::size_t kMinDiscs = 3;
  if (options.diameter_px <= 0 && s.discs.size() < kMinDiscs) {
    s.discs.clear();
    s.missing.push_back({"the bead diameter", "no round beads stand out in the first frames", remedy});
    return std::nullopt;
  }
  s.bright = found.preprocess.bright;
  s.diameter_stated = options.diameter_px > 0;
  s.diameter_px = s.diameter_stated ? options.diameter_px : found.diameter_px;
  s.refine = found.refine.method;
  s.other_diameters_px = found.other_diameters_px;
  try {
    ReadableFrames frames(s.stack);
    const auto bar = progress("beads");
    const calibration::BeadFrames beads =
        calibration::locate_beads(frames, found, std::nullopt, kFrames, options.threads, *bar);
    s.beads = calibration::count_beads(beads);
    s.aspect = beads.aspect;
  } catch (const InputError& e) {
    s.missing.push_back({"the bead diameter",
                         fmt::format("too few beads are seen ({})", without_full_stop(e.what())), remedy});
    return std::nullopt;
  }
  return found;
}

/// Whether beads lie below the plate by more than a third of their diameter. The lowest edge is then no plate
/// but the lower side of the bed or the picture's border. Single discs, and discs beyond the walls, are dirt
/// or misread.
bool beads_below_plate(const CellSurvey& s) {
  const auto& heights = s.geometry->heights;
  if (s.frame >= heights.size() || !std::isfinite(heights[s.frame].height_px)) return false;
  const double row = s.geometry->plate_row - heights[s.frame].height_px;
  constexpr double kMaxShareBelow = 0.03;  // of the beads
  const auto x_of = [&](bool seen, const char* wall, double otherwise) {
    return seen ? s.geometry->fit.value(wall) : otherwise;
  };
  const double left = x_of(s.geometry->has_left, "x_left", 0),
               right = x_of(s.geometry->has_right, "x_right", s.geometry->size.width);
  const auto below = std::count_if(s.discs.begin(), s.discs.end(), [&](const imaging::Detection& d) {
    return d.x > left && d.x < right && d.y + d.radius > row + 2 * d.radius / 3;
  });
  return below > 1 && static_cast<double>(below) > kMaxShareBelow * static_cast<double>(s.discs.size());
}

/// The fitted motion, if the lowest edge moves as a plate does.
void survey_plate(CellSurvey& s, const SurveyOptions& options, const std::vector<std::uint8_t>& repeats) {
  constexpr double kMinShareSeen = 0.9;
  const auto heights = s.geometry->heights_px();
  const auto seen = std::count_if(heights.begin(), heights.end(), [](double h) { return std::isfinite(h); });
  const auto unseen = [&](const std::string& why) {
    s.missing.push_back(
        {"the plate", why,
         fmt::format("{}, or film with the plate's upper edge and a plate below it that is as {} as the "
                     "beads in the picture",
                     options.gamma ? "state camera.origin_px and the drive by hand"
                                   : "state --drive-gamma, so that the motion of the bed shows it",
                     s.bright ? "bright" : "dark")});
    s.geometry->has_plate = false;
  };
  if (!s.geometry->has_plate || seen == 0)
    return unseen("no edge of a plate is seen at the bottom of the picture");
  if (static_cast<double>(seen) < kMinShareSeen * static_cast<double>(heights.size()))
    return unseen(fmt::format("its edge is seen in only {} of {} frames", seen, heights.size()));
  if (beads_below_plate(s)) return unseen("beads are seen below the lowest edge, so this edge is no plate");
  s.plate_row = calibration::Estimate{s.geometry->plate_row, s.geometry->plate_row_error};
  try {
    s.drive = calibration::fit_drive(heights, {.frames_per_cycle = 0,
                                               .mend = true,
                                               .model_error = calibration::kHeightModelError_px,
                                               .repeats = repeats});
  } catch (const InputError& e) {
    s.missing.push_back({"the plate's motion", without_full_stop(e.what()),
                         "give at least one whole cycle of frames, or state the drive by hand"});
    // Without a cycle, the row is the mean height only if the plate does not move.
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    if (heights.size() < 2 || !(*high - *low < 1)) s.plate_row.reset();
    return;
  }
  s.plate_row = calibration::Estimate{s.geometry->plate_row - s.drive->z0,
                                      std::hypot(s.drive->z0_error, s.geometry->plate_row_error_of_map)};
  s.drive->amplitude_error =
      std::hypot(s.drive->amplitude_error, s.drive->amplitude * s.geometry->stretch_error);
  s.notes.insert(s.notes.end(), s.drive->notes.begin(), s.drive->notes.end());
  if (s.drive->dropped > 0)
    s.notes.push_back(
        fmt::format("by the plate, {} missing between the first and the last one; track and "
                    "match find them too",
                    s.drive->dropped == 1 ? "1 frame is" : fmt::format("{} frames are", s.drive->dropped)));
  if (s.drive->frames_per_cycle == 0)
    s.missing.push_back(
        {kFramesPerCycle,
         fmt::format("the period of {:.6g} +- {:.1g} frames is not a whole number over the stack",
                     s.drive->period, s.drive->period_error),
         "track and match take the phase of each frame from the plate with --phase-lock found"});
}

void survey_edges(CellSurvey& s, const SurveyOptions& options, const ProgressOf& progress) {
  const double diameter = calibration::diameter_for_edges(s.stack, s.bright, s.diameter_px);
  ReadableFrames frames(s.stack);
  const auto bar = progress("edges of walls and plate");
  const calibration::StackEdges edges = calibration::read_stack_edges(
      frames, {.bright = s.bright, .diameter_px = diameter, .refine = s.refine}, options.threads, *bar);
  s.n_frames = frames.read();
  s.unreadable = frames.unreadable();
  s.frame_rate_hz = calibration::frame_rate_of({}, edges, s.stack);
  if (s.info.playback) s.playback_hz = s.info.frame_rate_hz;
  try {
    s.geometry = calibration::fit_cell_geometry(edges);
  } catch (const InputError&) {
    const char* why = "no edge of the cell is seen in the picture";
    s.missing.push_back({"the side walls", why, "state cell.width and camera.origin_px by hand"});
    s.missing.push_back({"the plate", why,
                         options.gamma ? "state camera.origin_px and the drive by hand"
                                       : "state --drive-gamma, so that the motion of the bed shows it"});
    return;
  }
  survey_plate(s, options, edges.repeats);
  if (!s.has_walls())
    s.missing.push_back(
        {s.geometry->has_left    ? "the right wall"
         : s.geometry->has_right ? "the left wall"
                                 : "the side walls",
         fmt::format(
             "a wall needs a border of 3 px at the side of the picture, or a straight bar, as {} as the "
             "beads",
             s.bright ? "bright" : "dark"),
         "state cell.width and camera.origin_px by hand, or cell.sides = \"periodic\""});
}

/// Adds an upright wall to the parameters of a cell.
void add_wall(calibration::FitReport& fit, const std::string& side, const calibration::Estimate& x) {
  fit.names.insert(fit.names.end(), {"x_" + side, "tilt_" + side});
  fit.values.insert(fit.values.end(), {x.value, 0});
  fit.standard_errors.insert(fit.standard_errors.end(), {x.error, 0});
  const auto n = static_cast<Eigen::Index>(fit.names.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  const Eigen::Index before = fit.covariance.rows();
  covariance.topLeftCorner(before, before) = fit.covariance;
  covariance(n - 2, n - 2) = x.error * x.error;
  fit.covariance = covariance;
}

/// Walls and plate that no edge shows, from the beads that touch them.
void survey_bed(CellSurvey& s, const imaging::LocatorOptions& locator, const SurveyOptions& options,
                const ProgressOf& progress) {
  constexpr int kMaxFrames = 2000;
  const auto frames = imaging::chosen_frames(std::make_unique<ReadableFrames>(s.stack), {.end = kMaxFrames});
  const auto bar = progress("beads of all frames");
  const calibration::BeadFrames beads =
      calibration::locate_beads(*frames, locator, std::nullopt, kMaxFrames, options.threads, *bar);
  // A bed that the picture cuts may have its walls outside. Single beads that fly out of it do not matter.
  constexpr double kMaxShareCut = 0.01;
  double all = 0, cut = 0;
  for (std::size_t f = 0; f < beads.frames.size(); ++f) {
    all += static_cast<double>(beads.counts[f]);
    cut += static_cast<double>(beads.counts[f] - beads.frames[f].size());
  }
  if (cut > kMaxShareCut * all) {
    s.notes.push_back(
        "the border of the picture cuts beads, so walls and plate are not taken from the beads that touch "
        "them");
    return;
  }
  const auto found = [&](const std::string& what) {
    std::erase_if(s.missing, [&](const NotMeasured& m) { return m.what.find(what) != std::string::npos; });
  };
  if (!s.has_walls()) {
    if (!s.geometry) s.geometry.emplace().size = s.size;
    calibration::CellGeometry& g = *s.geometry;
    const double diameter = s.beads->diameter.value;
    const auto left = g.has_left ? std::nullopt : calibration::wall_of_bed(beads, diameter, false),
               right = g.has_right ? std::nullopt : calibration::wall_of_bed(beads, diameter, true);
    if ((g.has_left || left) && (g.has_right || right)) {
      if (left) add_wall(g.fit, "left", *left);
      if (right) add_wall(g.fit, "right", *right);
      g.has_left = g.has_right = s.walls_of_bed = true;
      found("wall");
    }
  }
  if (s.plate_row || s.drive || !options.gamma) return;
  try {
    const calibration::PlateOfBed plate =
        calibration::plate_of_bed(beads, s.beads->diameter.value, *options.gamma);
    const auto n = static_cast<double>(plate.phases.frames_per_cycle);
    calibration::DriveFit& d = s.drive.emplace();
    d.amplitude = plate.amplitude.value, d.amplitude_error = plate.amplitude.error;
    d.frames_per_cycle = plate.phases.frames_per_cycle;
    d.first_phase = plate.phases.first_phase;
    d.period = n;
    d.period_error = 0.5 * n / static_cast<double>(beads.frames.size());  // half a frame over the stack
    d.omega = 2 * std::numbers::pi / n;
    d.phi = d.omega * d.first_phase;
    if (!s.geometry) s.geometry.emplace().size = s.size;
    s.geometry->heights.clear();
    for (std::size_t f = 0; f < plate.heights.size(); ++f) {
      d.frames.push_back({.tick = static_cast<double>(f)});
      s.geometry->heights.push_back({.height_px = plate.heights[f]});
    }
    s.plate_row = plate.row;
    s.plate_of_bed = true;
    found("plate");
  } catch (const InputError& e) {
    s.notes.push_back(
        fmt::format("the plate is not found from the bed either ({})", without_full_stop(e.what())));
  }
}

}  // namespace

CellSurvey survey_cell(const std::filesystem::path& stack, const SurveyOptions& options,
                       const ProgressOf& progress) {
  CellSurvey s{.stack = stack};
  const auto locator = survey_beads(s, options, progress);
  survey_edges(s, options, progress);
  if (locator && (!s.has_walls() || !s.plate_row)) survey_bed(s, *locator, options, progress);
  s.notes.insert(s.notes.begin(), s.info.notes.begin(), s.info.notes.end());
  if (const std::string doubt = s.aspect ? s.aspect->doubt() : ""; !doubt.empty())
    s.notes.push_back(doubt + ".");
  if (!s.unreadable.empty())
    s.notes.insert(s.notes.begin(),
                   fmt::format("only the first {} frames are used: {}", s.n_frames, s.unreadable));
  return s;
}

}  // namespace twincell::twin
