#include "twin/cell_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "imaging/geometry/lens.hpp"
#include "imaging/track/annotation.hpp"
#include "imaging/track/overlay.hpp"

namespace twincell::twin {
namespace {

const cv::Scalar kWall(220, 110, 20), kPlate(50, 40, 215), kAxis(160, 0, 140), kText(40, 40, 40),
    kQuiet(130, 130, 130), kDot(60, 60, 60);
constexpr int kPanel = 620, kBorder = 18, kLine = 24;

/// Draws on the enlarged frame in coordinates of the ideal picture.
class Canvas {
 public:
  Canvas(cv::Mat3b& picture, int enlarge, std::optional<imaging::Lens> lens)
      : picture_(picture), enlarge_(enlarge), lens_(std::move(lens)) {}
  [[nodiscard]] cv::Point at(double x, double y) const {
    imaging::PixelPoint p{x, y};
    if (lens_) p = lens_->picture_from_ideal(p);
    return {cvRound(enlarge_ * (p.x_px + 0.5) - 0.5), cvRound(enlarge_ * (p.y_px + 0.5) - 0.5)};
  }
  /// A line, in pieces that follow the distortion; every second piece is drawn if `dashed`.
  void line(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, bool dashed = false, int width = 1) {
    const int pieces = std::max(2, cvRound(cv::norm(b - a) * enlarge_ / 8)) | 1;
    for (int k = 0; k < pieces; k += dashed ? 2 : 1) {
      const cv::Point2d p = a + (b - a) * k / pieces, q = a + (b - a) * (k + 1) / pieces;
      imaging::draw_line(picture_, at(p.x, p.y), at(q.x, q.y), colour, width);
    }
  }
  void arrow(cv::Point2d a, cv::Point2d b, const cv::Scalar& colour, const std::string& name) {
    constexpr int kWidth = 2, kAside = 6;
    imaging::draw_arrow(picture_, at(a.x, a.y), at(b.x, b.y), colour, kWidth);
    imaging::draw_label(picture_, name, at(b.x, b.y) + cv::Point(kAside, kAside), colour);
  }

 private:
  cv::Mat3b& picture_;
  int enlarge_;
  std::optional<imaging::Lens> lens_;
};

/// Walls, plate, origin, axes and scale bar on the frame.
void draw_edges(cv::Mat3b& picture, int enlarge, const CellSurvey& s, const CellDraft& draft) {
  std::optional<imaging::Lens> lens;
  if (s.geometry && (s.geometry->rotation_deg != 0 || s.geometry->distortion != 0))
    lens = imaging::Lens(s.size, s.geometry->rotation_deg, s.geometry->distortion);
  Canvas canvas(picture, enlarge, lens);
  const double w = s.size.width, h = s.size.height;
  if (s.geometry) {
    const calibration::CellGeometry& g = *s.geometry;
    constexpr double kDegree = std::numbers::pi / 180;
    const double base = s.plate_row ? s.plate_row->value : g.has_plate ? g.plate_row : h;
    if (g.has_left) {
      const double x = g.fit.value("x_left"), t = std::tan(g.fit.value("tilt_left") * kDegree);
      canvas.line({x - t * base, 0}, {x, base}, kWall, false, 2);
    }
    if (g.has_right) {
      const double x = g.fit.value("x_right"), t = std::tan(g.fit.value("tilt_right") * kDegree);
      canvas.line({x + t * base, 0}, {x, base}, kWall, false, 2);
    }
    const double left = g.has_left ? g.fit.value("x_left") : 0,
                 right = g.has_right ? g.fit.value("x_right") : w;
    if (s.plate_row) canvas.line({left, base}, {right, base}, kPlate, false, 2);
    if (s.drive)
      for (const double extreme : {base - s.drive->amplitude, base + s.drive->amplitude})
        canvas.line({left, extreme}, {right, extreme}, kPlate, true);
    if (g.has_left && s.plate_row) {
      const double arm = draft.pixels_per_sigma ? 2 * *draft.pixels_per_sigma : h / 10;
      canvas.arrow({left, base}, {left + arm, base}, kAxis, "x");
      canvas.arrow({left, base}, {left, base - arm}, kAxis, "z");
    }
  }
  if (draft.pixels_per_sigma) {
    // The longest of 1, 2, 5, 10, ... diameters that fits into a third of the frame.
    double n = 1;
    for (const double longer : {1., 2., 5., 10., 20., 50., 100.})
      if (longer * *draft.pixels_per_sigma < w / 3) n = longer;
    constexpr int kMargin = 14, kRim = 7, kBar = 3;
    const int length = cvRound(n * *draft.pixels_per_sigma * enlarge);
    const cv::Point end(picture.cols - kMargin, kMargin), begin(end.x - length, end.y);
    imaging::draw_line(picture, begin, end, cv::Scalar(255, 255, 255), kRim);
    imaging::draw_line(picture, begin, end, kAxis, kBar);
    const std::string text = fmt::format("{:g} bead diameter{}", n, n == 1 ? "" : "s");
    const int wide = imaging::text_width(text);
    imaging::draw_label(picture, text, {std::min(begin.x, end.x - wide), end.y + kLine - 4}, kAxis);
  }
}

struct Entry {
  std::string text;
  cv::Scalar colour;
};

std::string with_error(const calibration::Estimate& e, const char* unit) {
  return fmt::format("{} +- {} {}", value_text(e), error_text(e.error), unit);
}

std::vector<Entry> entries(const CellSurvey& s, const CellDraft& draft) {
  std::vector<Entry> list;
  const cv::Scalar green(40, 140, 0);
  list.push_back({fmt::format("{} frames of {} x {} px; frame {} is shown", s.n_frames, s.size.width,
                              s.size.height, s.frame),
                  kText});
  if (s.beads)
    list.push_back(
        {fmt::format("{:.0f} beads, diameter {}", s.beads->count.value, with_error(s.beads->diameter, "px")),
         green});
  if (std::any_of(s.discs.begin(), s.discs.end(), [](const imaging::Detection& d) { return d.tracer; }))
    list.push_back({"  magenta: tracers, brighter inside", cv::Scalar(255, 0, 255)});
  if (s.has_walls())
    list.push_back(
        {"walls apart " + with_error({s.geometry->width_px(), s.geometry->width_error_px()}, "px"), kWall});
  if (s.plate_row) list.push_back({"plate at row " + with_error(*s.plate_row, "px"), kPlate});
  if (s.drive) {
    list.push_back(
        {"  amplitude " + with_error({s.drive->amplitude, s.drive->amplitude_error}, "px"), kPlate});
    list.push_back({"  period " + with_error({s.drive->period, s.drive->period_error}, "frames"), kPlate});
    if (s.drive->frames_per_cycle > 0)
      list.push_back(
          {fmt::format("  first frame at phase {} of {}", s.drive->first_phase, s.drive->frames_per_cycle),
           kPlate});
  }
  for (const char* key : {"camera.pixels_per_sigma", "camera.origin_px", "camera.rotation_deg",
                          "camera.distortion", "cell.width_sigma", "cell.width_mm", "drive.amplitude_sigma",
                          "drive.frequency_hz", "drive.gamma", "scale.sigma_mm"})
    if (const DraftKey* k = draft.find(key))
      list.push_back(
          {std::string(key) + " = " + (k->open ? "to be filled in" : k->value), k->open ? kPlate : kAxis});
  if (draft.gamma && draft.gamma->error > 0)
    list.push_back({"Gamma = A omega^2/g = " + with_error(*draft.gamma, ""), kAxis});
  for (const NotMeasured& m : s.missing) list.push_back({"not measured: " + m.what, kPlate});
  return list;
}

/// Heights of the plate over the first three cycles, with the fit.
void draw_motion(cv::Mat3b& picture, cv::Rect area, const CellSurvey& s) {
  const calibration::DriveFit& d = *s.drive;
  constexpr double kCycles = 3, kHeadroom = 1.15;
  const double last = std::min(kCycles * d.period, static_cast<double>(d.frames.size() - 1));
  const auto place = [&](double frame, double height) {
    return cv::Point(area.x + cvRound(frame / last * area.width),
                     area.y + cvRound(area.height * (0.5 - height / (2 * kHeadroom * d.amplitude))));
  };
  imaging::draw_box(picture, area, kQuiet);
  imaging::draw_line(picture, place(0, 0), place(last, 0), kQuiet);
  std::vector<cv::Point> curve;
  for (int k = 0; k <= area.width; ++k) {
    const double t = last * k / area.width;
    curve.push_back(place(t, d.amplitude * std::sin(d.omega * t + d.phi)));
  }
  imaging::draw_curve(picture, curve, kPlate);
  for (std::size_t f = 0; f < d.frames.size() && d.frames[f].tick <= last; ++f)
    if (const double h = s.geometry->heights[f].height_px; std::isfinite(h))
      imaging::draw_dot(
          picture,
          place(d.frames[f].tick, std::clamp(h - d.z0, -kHeadroom * d.amplitude, kHeadroom * d.amplitude)), 3,
          kDot);
  imaging::draw_text(picture,
                     s.plate_of_bed ? "lower side of the bed, px, against frame: seen (dots); plate (line)"
                                    : "height of the plate, px, against frame: seen (dots), fitted (line)",
                     {area.x, area.y - 8}, kText);
  imaging::draw_text(picture, "0", {area.x - 2, area.y + area.height + kLine - 4}, kText);
  imaging::draw_text(picture, fmt::format("{:.0f}", last),
                     {area.x + area.width - 2 * kBorder, area.y + area.height + kLine - 4}, kText);
}

}  // namespace

cv::Mat3b draw_cell(const CellSurvey& s, const CellDraft& draft) {
  constexpr int kMaxWidth_px = 1200, kMaxFactor = 3, kPlotHeight_px = 200;
  const int enlarge = std::clamp(kMaxWidth_px / std::max(1, s.size.width), 1, kMaxFactor);
  cv::Mat3b frame = imaging::draw_overlay(s.picture, s.discs, enlarge);
  imaging::flatten_noise(frame);
  draw_edges(frame, enlarge, s, draft);
  const std::vector<Entry> list = entries(s, draft);
  const int text = kBorder + kLine * static_cast<int>(list.size());
  const int needed = text + (s.drive ? 3 * kLine + kPlotHeight_px : 0) + kBorder;
  cv::Mat3b page(std::max(frame.rows, needed), frame.cols + kPanel, cv::Vec3b(255, 255, 255));
  frame.copyTo(page(cv::Rect(0, 0, frame.cols, frame.rows)));
  const int x = frame.cols + kBorder;
  for (std::size_t i = 0; i < list.size(); ++i)
    imaging::draw_text(page, list[i].text, {x, kBorder + kLine * static_cast<int>(i) + 10}, list[i].colour);
  if (s.drive) draw_motion(page, {x, text + 2 * kLine, kPanel - 2 * kBorder, kPlotHeight_px}, s);
  return page;
}

}  // namespace twincell::twin
