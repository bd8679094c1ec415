#include "imaging/drawing/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "imaging/camera/movie.hpp"
#include "imaging/track/annotation.hpp"
#include "imaging/track/overlay.hpp"
#include "trajectory/plate.hpp"
#include "trajectory/time_unit.hpp"

namespace twincell::imaging {

namespace {

const cv::Scalar kInk(40, 40, 40), kWall(60, 60, 60), kPeriodic(205, 205, 205), kTrack(120, 120, 120),
    kArrow(40, 40, 200), kChain(30, 30, 30), kRim(235, 235, 235);

}  // namespace

std::vector<std::size_t> indices_of(const TrajectorySource& source, const FrameRange& range) {
  const auto n = static_cast<std::int64_t>(source.n_frames());
  const std::int64_t end = range.end < 0 ? n : std::min(range.end, n);
  std::vector<std::size_t> indices;
  for (std::int64_t k = range.first; k < end; k += range.step) indices.push_back(static_cast<std::size_t>(k));
  if (indices.empty())
    throw ConfigError(
        Where{.file = source.name(), .key = "--frames"},
        n == 0 ? std::string("the trajectory has no frames.")
               : fmt::format("begins at frame {}, but the trajectory has {} frames.", range.first, n));
  return indices;
}

namespace {

std::vector<std::size_t> drawn_frames(const TrajectorySource& source, const DrawJob& job) {
  std::vector<std::size_t> indices = indices_of(source, job.frames);
  if (!job.film()) indices = {indices.back()};
  return indices;
}

bool visible(const Frame& frame, std::size_t i) {
  return frame.present(i) && frame.position[i].allFinite();
}

double plate_of(const Frame& frame, const TrajectoryInfo& info) {
  return plate_height(info, frame).value_or(info.box.lower.z());
}

/// Drive cycles that are over in a frame.
double cycles_of(const Frame& frame, const TrajectoryInfo& info) {
  return info.drive->cycles_at(frame.time);
}

/// Horizontal displacement of the cell.
Vec3 shift_of(const Frame& frame, const TrajectoryInfo& info) {
  Vec3 shift = sideways_displacement(info, frame);
  if (info.drive && info.drive->horizontal && !info.box.periodic(Axis::x)) {
    const double cycles = cycles_of(frame, info);
    shift.x() += info.drive->horizontal_displacement(cycles - std::floor(cycles));
  }
  return shift;
}

/// Largest numbers over the drawn frames, so that one scale serves the whole film.
struct Extremes {
  double bottom = 0, top = 0;  ///< sigma
  Vec3 shift = Vec3::Zero();   ///< largest horizontal displacement of the cell, sigma
  std::array<double, 2> colours = {INFINITY, -INFINITY};
  double speed = 0, force = 0;
};

Extremes extremes_of(const TrajectorySource& source, const std::vector<std::size_t>& indices,
                     const DrawJob& job, Progress& progress) {
  const TrajectoryInfo& info = source.info();
  Extremes e{.bottom = info.box.lower.z(), .top = info.box.lower.z() + 1};
  Frame frame;
  const auto widen = [&] {
    e.bottom = std::min(e.bottom, plate_of(frame, info));
    e.shift = e.shift.cwiseMax(shift_of(frame, info).cwiseAbs());
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      if (!visible(frame, i)) continue;
      const double radius = radius_of(info.radius, i);
      e.top = std::max(e.top, frame.position[i].z() + radius);
      e.bottom = std::min(e.bottom, frame.position[i].z() - radius);
    }
  };
  // Tracks begin before the first drawn frame.
  for (std::size_t k = indices.front() - std::min(indices.front(), job.tracks); k < indices.front(); ++k) {
    source.read(k, frame);
    widen();
  }
  for (std::size_t k = 0; k < indices.size(); ++k) {
    source.read(indices[k], frame);
    widen();
    if (job.vectors)
      for (const Vec3& velocity : frame.velocity)
        if (velocity.allFinite()) e.speed = std::max(e.speed, velocity.norm());
    if (job.contacts)
      for (const ContactForce& c : frame.contact_forces)
        e.force = std::max(e.force, std::abs(c.normal_force));
    if (job.colours.of && !job.colours.range)
      for (const double value : job.colours.of(indices[k], frame))
        if (std::isfinite(value)) e.colours = {std::min(e.colours[0], value), std::max(e.colours[1], value)};
    progress.update(static_cast<std::int64_t>(k), static_cast<std::int64_t>(2 * indices.size()));
  }
  e.top += 1;
  if (info.box.boundary[2] != Boundary::open)
    e.top = std::min(e.top, std::max(info.box.upper.z(), e.bottom + 1));
  if (info.box.periodic(Axis::z)) e.bottom = info.box.lower.z(), e.top = info.box.upper.z();
  if (job.colours.range) e.colours = *job.colours.range;
  if (!(e.colours[0] <= e.colours[1])) e.colours = {0, 1};  // no bead has a number
  return e;
}

/// A length of 1, 2 or 5 times a power of ten that is at most `most`.
double round_length(double most) {
  const double decade = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0})
    if (step * decade <= most) return step * decade;
  return decade;
}

View view_for(const TrajectoryInfo& info, const DrawJob& job, const Extremes& e) {
  Box seen = info.box;
  seen.lower -= e.shift, seen.upper += e.shift;
  return {seen, e.bottom, e.top, static_cast<bool>(job.colours.of), job.pixels_per_sigma};
}

class Painter {
 public:
  Painter(const TrajectorySource& source, const DrawJob& job, const View& view, const Extremes& extremes)
      : source_(source), info_(source.info()), job_(job), view_(view), extremes_(extremes) {}

  cv::Mat3b paint(std::size_t index) {
    source_.read(index, frame_);
    cv::Mat3b picture(view_.size(), cv::Vec3b(255, 255, 255));
    draw_cell(picture, false);
    if (job_.tracks > 0) draw_tracks(picture, index);
    draw_beads(picture, index);
    if (info_.box.dimension == 3) draw_cell(picture, true);
    if (job_.contacts) draw_contacts(picture);
    if (job_.vectors) draw_vectors(picture);
    draw_texts(picture);
    return picture;
  }

 private:
  static constexpr int kShift = 4;  // bits of a pixel that OpenCV's coordinates keep
  static cv::Point fine(const cv::Point2d& p) {
    constexpr double kFine = 1 << kShift;
    constexpr double kMaxCoordinate = 1e8;  // 1/16 px; a bead may be far outside an open cell
    const auto whole = [=](double px) {
      return static_cast<int>(std::lround(std::clamp(px * kFine, -kMaxCoordinate, kMaxCoordinate)));
    };
    return {whole(p.x), whole(p.y)};
  }
  static void line(cv::Mat3b& picture, const cv::Point2d& a, const cv::Point2d& b, const cv::Scalar& colour,
                   int width) {
    cv::line(picture, fine(a), fine(b), colour, width, cv::LINE_AA, kShift);
  }
  static void disc(cv::Mat3b& picture, const cv::Point2d& at, double radius, const cv::Scalar& colour,
                   int width = cv::FILLED) {
    cv::circle(picture, fine(at), static_cast<int>(std::lround(radius * (1 << kShift))), colour, width,
               cv::LINE_AA, kShift);
  }
  void edge(cv::Mat3b& picture, const Vec3& a, const Vec3& b, Boundary kind, int width = 2) const {
    if (kind == Boundary::open) return;
    line(picture, view_.project(a).at, view_.project(b).at, kind == Boundary::wall ? kWall : kPeriodic,
         width);
  }
  [[nodiscard]] double radius(std::size_t i) const { return radius_of(info_.radius, i); }

  // The cell from its plate to the top of the picture. In 3D, the edges that meet in the corner nearest to
  // the eye lie in front of the beads.
  void draw_cell(cv::Mat3b& picture, bool front) const {
    const Box& box = info_.box;
    const Vec3 shift = shift_of(frame_, info_);
    const double plate = plate_of(frame_, info_), top = extremes_.top;
    const auto foot = [&](bool right, bool back, double z) {
      const double tilt = box.side_tilt[right ? 1 : 0] * CV_PI / 180;
      const double lean = std::tan(tilt) * (z - plate);
      return Vec3(shift + Vec3(right ? box.upper.x() + lean : box.lower.x() - lean,
                               back ? box.upper.y() : box.lower.y(), z));
    };
    if (box.dimension == 2) {
      for (const bool right : {false, true})
        edge(picture, foot(right, false, plate), foot(right, false, top), box.boundary[0]);
      edge(picture, foot(false, false, plate), foot(true, false, plate), box.boundary[2], 3);
      if (top >= box.upper.z())
        edge(picture, foot(false, false, top), foot(true, false, top), box.boundary[2]);
      return;
    }
    // The eye sees the corner (right, front, top) nearest.
    for (const bool right : {false, true})
      for (const bool back : {false, true})
        if ((right && !back) == front)
          edge(picture, foot(right, back, plate), foot(right, back, top), Boundary::wall, 1);
    for (const double z : {plate, top})
      for (const bool side : {false, true}) {
        if ((z == top && !side) == front)
          edge(picture, foot(false, side, z), foot(true, side, z), Boundary::wall, 1);
        if ((z == top && side) == front)
          edge(picture, foot(side, false, z), foot(side, true, z), Boundary::wall, 1);
      }
  }

  // Paths end at the present position. A step over a periodic boundary is left out.
  void draw_tracks(cv::Mat3b& picture, std::size_t index) {
    const std::size_t first = index > job_.tracks ? index - job_.tracks : 0;
    while (!past_.empty() && past_.front().first < first) past_.pop_front();
    for (std::size_t k = past_.empty() ? first : past_.back().first + 1; k <= index; ++k) {
      Frame frame;
      source_.read(k, frame);
      for (std::size_t i = 0; i < frame.position.size(); ++i)
        if (!visible(frame, i)) frame.position[i].setConstant(std::numeric_limits<double>::quiet_NaN());
      past_.emplace_back(k, std::move(frame.position));
    }
    for (std::size_t k = 1; k < past_.size(); ++k)
      for (std::size_t i = 0; i < past_[k].second.size(); ++i) {
        const Vec3 step = past_[k].second[i] - past_[k - 1].second[i];
        const Vec3 from = info_.box.wrap(past_[k - 1].second[i]), to = info_.box.wrap(past_[k].second[i]);
        if (!step.allFinite() || (to - from - step).norm() > 1e-6) continue;
        line(picture, view_.project(from).at, view_.project(to).at, kTrack, 1);
      }
  }

  // The farthest first, so that nearer beads hide farther ones.
  void draw_beads(cv::Mat3b& picture, std::size_t index) const {
    const std::vector<double> values =
        job_.colours.of ? job_.colours.of(index, frame_) : std::vector<double>();
    std::vector<std::pair<Projected, std::size_t>> beads;
    for (std::size_t i = 0; i < frame_.position.size(); ++i)
      if (visible(frame_, i)) beads.emplace_back(view_.project(info_.box.wrap(frame_.position[i])), i);
    std::stable_sort(beads.begin(), beads.end(),
                     [](const auto& a, const auto& b) { return a.first.depth > b.first.depth; });
    const bool solid = info_.box.dimension == 3;
    for (const auto& [p, i] : beads) {
      const cv::Vec3b map =
          values.empty() ? cv::Vec3b(222, 190, 150) : map_colour(values[i], extremes_.colours);
      constexpr double kFade = 0.6, kDark = 0.55, kGloss = 0.45;
      const double fade = kFade * p.depth;
      const cv::Scalar own(map[0], map[1], map[2]), white(255, 255, 255);
      const cv::Scalar colour = own * (1 - fade) + white * fade;
      const cv::Scalar rim = own * (kDark * (1 - fade)) + white * fade;
      const double r = radius(i) * p.scale;
      disc(picture, p.at, r, rim);
      disc(picture, p.at, std::max(r - std::max(1.0, 0.05 * r), 0.5 * r), colour);
      if (solid)
        disc(picture, p.at - cv::Point2d(0.3 * r, 0.3 * r), 0.25 * r, colour * (1 - kGloss) + white * kGloss);
    }
  }

  void draw_contacts(cv::Mat3b& picture) const {
    if (extremes_.force <= 0) return;
    struct Line {
      cv::Point2d from, to;
      int width;
    };
    std::vector<Line> lines;
    for (const ContactForce& c : frame_.contact_forces) {
      const auto i = static_cast<std::size_t>(c.i);
      if (!visible(frame_, i)) continue;
      const Vec3 from = info_.box.wrap(frame_.position[i]);
      const double other = c.j >= 0 ? radius(static_cast<std::size_t>(c.j)) : 0;
      const Vec3 to = from - c.normal * (radius(i) + other - c.overlap);
      const Projected a = view_.project(from), b = view_.project(to);
      const double width = kWidestLine * a.scale * std::abs(c.normal_force) / extremes_.force;
      if (width < 0.25) continue;  // px: would look as thick as a line of one pixel
      lines.push_back({a.at, b.at, std::max(1, static_cast<int>(std::lround(width)))});
    }
    // A light rim keeps the lines readable on dark beads.
    for (const Line& l : lines) line(picture, l.from, l.to, kRim, l.width + 2);
    for (const Line& l : lines) line(picture, l.from, l.to, kChain, l.width);
  }

  void draw_vectors(cv::Mat3b& picture) const {
    if (extremes_.speed <= 0) return;
    for (std::size_t i = 0; i < frame_.position.size(); ++i) {
      if (!visible(frame_, i) || !frame_.velocity[i].allFinite()) continue;
      const Vec3 from = info_.box.wrap(frame_.position[i]);
      const Vec3 to = from + frame_.velocity[i] * (kLongestArrow / extremes_.speed);
      draw_arrow(picture, view_.project(from).at, view_.project(to).at, kArrow, 1);
    }
  }

  void draw_texts(cv::Mat3b& picture) const {
    const cv::Rect cell = view_.cell();
    constexpr int kTitleGap = 14;  // px above the cell
    draw_label(picture, frame_title(frame_, info_), {cell.x, cell.y - kTitleGap}, kInk);
    draw_scale_bar(picture);
    if (job_.colours.of) draw_colour_bar(picture);
  }

  void draw_scale_bar(cv::Mat3b& picture) const {
    const cv::Rect cell = view_.cell();
    const bool mm = info_.scale.sigma_m.has_value();
    const double unit = mm ? *info_.scale.sigma_m * 1000 : 1;  // of sigma
    const double length = round_length(cell.width / 4.0 / view_.pixels_per_sigma() * unit);
    const int px = static_cast<int>(std::lround(length / unit * view_.pixels_per_sigma()));
    const int y = cell.y + cell.height + 20;
    cv::line(picture, {cell.x, y}, {cell.x + px, y}, kInk, 3);
    std::vector<std::string> parts = {fmt::format("{:g} {}", length, mm ? "mm" : "sigma")};
    if (job_.vectors) parts.push_back(fmt::format("longest arrow {:.3g} sigma/t0", extremes_.speed));
    if (job_.contacts) parts.push_back(fmt::format("widest line {:.3g} m g", extremes_.force));
    // In a narrow picture the last parts stand beside the bar.
    std::string text = parts.front(), beside;
    for (std::size_t k = 1; k < parts.size(); ++k) {
      const std::string longer = text + "   " + parts[k];
      if (beside.empty() && text_width(longer) < picture.cols - cell.x)
        text = longer;
      else
        beside += (beside.empty() ? "" : "   ") + parts[k];
    }
    draw_label(picture, text, {cell.x, y + 22}, kInk);
    if (!beside.empty()) draw_label(picture, beside, {cell.x + px + 12, y + 4}, kInk);
  }

  void draw_colour_bar(cv::Mat3b& picture) const {
    const cv::Rect cell = view_.cell();
    constexpr int kGap = 18, kWidth = 14, kMaxHeight = 300;  // px
    const int height = std::min(cell.height - 20, kMaxHeight), left = cell.x + cell.width + kGap;
    const int top = cell.y + 20;
    for (int y = 0; y < height; ++y) {
      const cv::Vec3b c = map_colour(1 - static_cast<double>(y) / (height - 1), {0, 1});
      cv::line(picture, {left, top + y}, {left + kWidth, top + y}, cv::Scalar(c[0], c[1], c[2]));
    }
    const std::string& unit = job_.colours.unit;
    draw_text(picture, job_.colours.name, {left - 8, cell.y - 14}, kInk);
    if (!unit.empty()) draw_text(picture, unit, {left - 8, cell.y + 6}, kInk);
    for (const double share : {0.0, 0.5, 1.0}) {
      const double value = extremes_.colours[0] + share * (extremes_.colours[1] - extremes_.colours[0]);
      const int y = top + static_cast<int>(std::lround((1 - share) * (height - 1)));
      draw_text(picture, fmt::format("{:.3g}", value), {left + kWidth + 6, y + 5}, kInk);
    }
  }

  const TrajectorySource& source_;
  const TrajectoryInfo& info_;
  const DrawJob& job_;
  const View& view_;
  const Extremes& extremes_;
  Frame frame_;
  std::deque<std::pair<std::size_t, std::vector<Vec3>>> past_;  // frames that tracks show, with their numbers
};

void check(const TrajectorySource& source, const DrawJob& job) {
  const std::string kind = job.output.extension().string();
  if (kind != ".png" && kind != ".mp4" && kind != ".avi")
    throw ConfigError(
        Where{.file = {}, .key = "--output"},
        fmt::format("is '{}'; a picture is written as .png, a film as .mp4 or .avi, a page as .html.",
                    job.output.string()));
  require_drawable(source, job);
}

void check_colours(const BeadColours& colours) {
  if (!colours.range) return;
  const auto [low, high] = *colours.range;
  if (!colours.of)
    throw ConfigError(Where{.file = {}, .key = "--colour-range"},
                      "applies to a number; choose one by --colour.");
  if (!std::isfinite(low) || !std::isfinite(high) || low >= high)
    throw ConfigError(Where{.file = {}, .key = "--colour-range"},
                      fmt::format("is {:g} to {:g}, but must be a number and a larger one.", low, high));
}

}  // namespace

void require_drawable(const TrajectorySource& source, const DrawJob& job) {
  const TrajectoryInfo& info = source.info();
  const auto refuse = [&](const char* key, const std::string& why) {
    throw ConfigError(Where{.file = source.name(), .key = key}, why);
  };
  if (job.vectors && !info.columns.velocity)
    refuse("--vectors", "needs velocities, which this trajectory does not have.");
  if (job.contacts && !info.columns.contact_forces)
    refuse(
        "--contacts",
        "needs contacts (simulate --contacts, the key time.contacts), which this trajectory does not have.");
  check_colours(job.colours);
}

std::string frame_title(const Frame& frame, const TrajectoryInfo& info) {
  std::string text = frame.cycle >= 0             ? fmt::format("cycle {}", frame.cycle)
                     : time_is_frame_number(info) ? fmt::format("frame {:g}", frame.time)
                                                  : fmt::format("t = {:.4g} t0", frame.time);
  if (frame.phase >= 0 && info.phases_per_cycle > 0)
    text += fmt::format("   phase {}/{}", frame.phase, info.phases_per_cycle);
  if (info.conditions.gamma) text += fmt::format("   Gamma {:.4g}", *info.conditions.gamma);
  if (info.drive && info.drive->ramp)
    text += fmt::format("   Gamma {:.4g}", info.drive->at(cycles_of(frame, info)).gamma());
  return text;
}

Vec3 cell_displacement(const Frame& frame, const TrajectoryInfo& info) {
  Vec3 displacement = shift_of(frame, info);
  displacement.z() = plate_of(frame, info);
  return displacement;
}

cv::Vec3b map_colour(double value, const std::array<double, 2>& range) {
  static const cv::Mat3b map = [] {
    cv::Mat1b levels(1, 256);
    std::iota(levels.begin(), levels.end(), std::uint8_t{0});
    cv::Mat3b colours;
    cv::applyColorMap(levels, colours, cv::COLORMAP_VIRIDIS);
    return colours;
  }();
  if (!std::isfinite(value)) return {190, 190, 190};
  const double span = range[1] - range[0];
  const double share = span > 0 ? std::clamp((value - range[0]) / span, 0.0, 1.0) : 0.5;
  return map(0, static_cast<int>(std::lround(255 * share)));
}

View view_of(const TrajectorySource& source, const DrawJob& job) {
  return view_for(source.info(), job, extremes_of(source, drawn_frames(source, job), job, Progress::none()));
}

Drawn draw(const TrajectorySource& source, const DrawJob& job, Progress& progress) {
  check(source, job);
  const std::vector<std::size_t> indices = drawn_frames(source, job);
  const Extremes extremes = extremes_of(source, indices, job, progress);
  const View view = view_for(source.info(), job, extremes);
  Painter painter(source, job, view, extremes);
  if (job.film()) {
    Movie movie(job.output, view.size(), job.frames_per_second);
    for (std::size_t k = 0; k < indices.size(); ++k) {
      movie.add(painter.paint(indices[k]), 8);
      progress.update(static_cast<std::int64_t>(indices.size() + k + 1),
                      static_cast<std::int64_t>(2 * indices.size()));
    }
    movie.commit();
  } else {
    write_png(job.output, painter.paint(indices.back()));
  }
  return {.frames = indices.size(), .range = extremes.colours, .size = view.size()};
}

}  // namespace twincell::imaging
