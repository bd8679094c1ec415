#include "imaging/track/debug_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "imaging/disc/ring_normal_equations.hpp"
#include "imaging/track/overlay.hpp"

namespace twincell::imaging {

namespace {

/// Darkness values shown as black and white: 0 and 1, extended to the range of all but the most extreme 200th
/// at either end. Discs with rings brighter than the background have negative darkness.
std::pair<double, double> shades_of(const cv::Mat1f& darkness) {
  std::vector<float> levels(darkness.begin(), darkness.end());
  if (levels.empty()) return {0, 1};
  const auto far = static_cast<std::ptrdiff_t>(levels.size() / 200);
  std::nth_element(levels.begin(), levels.begin() + far, levels.end());
  const double low = static_cast<double>(levels[static_cast<std::size_t>(far)]);
  std::nth_element(levels.begin(), levels.end() - 1 - far, levels.end());
  return {std::min(0.0, low), std::max(1.0, static_cast<double>(*(levels.end() - 1 - far)))};
}

/// Values as grey levels; the first of the shades is black, the second white.
cv::Mat3b grey_of(const cv::Mat1f& values, std::pair<double, double> shades = {0, 1}) {
  const double steps = 255 / (shades.second - shades.first);
  cv::Mat1b byte;
  values.convertTo(byte, CV_8U, steps, -steps * shades.first);
  cv::Mat3b picture;
  cv::cvtColor(byte, picture, cv::COLOR_GRAY2BGR);
  return picture;
}

/// Model picture of discs with a common profile, on its ground.
cv::Mat1f model_of(const DiscProfile& profile, const std::vector<Detection>& beads, cv::Size size) {
  cv::Mat1f model(size, static_cast<float>(profile.ground));
  const double behind = static_cast<double>(profile.levels.size()) / DiscProfile::kPerPixel;
  for (const Detection& b : beads) {
    const double shrink = profile.radius_px / b.radius;
    const int reach = cvCeil(behind / shrink);
    for (int y = std::max(0, cvFloor(b.y) - reach); y <= std::min(size.height - 1, cvCeil(b.y) + reach); ++y)
      for (int x = std::max(0, cvFloor(b.x) - reach); x <= std::min(size.width - 1, cvCeil(b.x) + reach); ++x)
        model(y, x) += static_cast<float>(b.darkness * profile.at(std::hypot(x - b.x, y - b.y) * shrink));
  }
  return model;
}

cv::Mat1f model_of(const LocatorStages& stages) {
  if (stages.refined.profile.radius_px > 0)
    return model_of(stages.refined.profile, stages.refined.beads, stages.image.darkness.size());
  const cv::Size size = stages.image.darkness.size();
  cv::Mat1f model = cv::Mat1f::zeros(size.height, size.width + kSpareColumns);
  const EdgeBlur blur{.variance = std::pow(std::max(0.3, stages.refined.blur_px), 2),
                      .path = stages.refined.path_px};
  for (const Detection& b : stages.refined.beads) add_disc(model, {b.x, b.y, b.radius, b.darkness}, blur);
  return model.colRange(0, size.width).clone();
}

std::vector<Detection> dropped_of(const LocatorStages& stages) {
  std::vector<Detection> all = stages.refined.dropped;
  all.insert(all.end(), stages.judged.dropped.begin(), stages.judged.dropped.end());
  return all;
}

void circle(cv::Mat3b& picture, const Detection& b, int enlarge, const cv::Scalar& colour) {
  constexpr int shift = 4, one = 1 << shift;
  const auto enlarged = [&](double v) { return cvRound((enlarge * (v + 0.5) - 0.5) * one); };
  cv::circle(picture, {enlarged(b.x), enlarged(b.y)}, cvRound(enlarge * b.radius * one), colour, 1,
             cv::LINE_AA, shift);
}

std::string candidates_csv(const LocatorStages& stages) {
  std::string text = "x,y,radius,darkness,interior,score,ring_share,sigma_x,sigma_y,verdict\n";
  std::vector<Detection> all = stages.judged.beads;
  const std::vector<Detection> dropped = dropped_of(stages);
  all.insert(all.end(), dropped.begin(), dropped.end());
  for (const Detection& b : all)
    text +=
        fmt::format("{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.5f},{:.5f},{}\n", b.x, b.y, b.radius,
                    b.darkness, b.interior, b.score, b.ring_share, b.sigma_x, b.sigma_y, word_of(b.verdict));
  return text;
}

}  // namespace

void write_debug_pictures(const std::filesystem::path& place, const cv::Mat& grey,
                          const LocatorOptions& options) {
  AtomicPath output(place, debug_folder());
  const std::filesystem::path& folder = output.part();
  const LocatorStages stages = locate_stages(grey, options);
  const int enlarge = std::max(1, 1200 / std::max(1, std::max(grey.cols, grey.rows)));

  const auto shades = shades_of(stages.image.darkness);
  cv::Mat3b darkness = grey_of(stages.image.darkness, shades);
  if (!stages.image.opaque.empty()) darkness.setTo(cv::Vec3b(160, 60, 60), stages.image.opaque);
  write_png(folder / "1_darkness.png", darkness);

  std::vector<Detection> proposed;
  for (const Proposal& p : stages.proposals) {
    Detection b;
    b.x = p.x, b.y = p.y, b.radius = options.diameter_px / 2;
    proposed.push_back(b);
  }
  write_png(folder / "2_proposals.png", draw_overlay(grey, proposed, enlarge));

  const cv::Mat1f model = model_of(stages);
  write_png(folder / "3_model.png", grey_of(model, shades));
  const cv::Mat1f residual = 0.5 + (stages.image.darkness - model) / 0.4;
  write_png(folder / "4_residual.png", grey_of(residual));

  cv::Mat3b judged = draw_overlay(grey, stages.judged.beads, enlarge);
  const cv::Scalar red(40, 40, 230);
  for (const Detection& b : dropped_of(stages)) {
    circle(judged, b, enlarge, red);
    cv::putText(judged, std::to_string(static_cast<int>(b.verdict)),
                {cvRound(enlarge * b.x), cvRound(enlarge * b.y)}, cv::FONT_HERSHEY_SIMPLEX, 0.35, red, 1,
                cv::LINE_AA);
  }
  write_png(folder / "5_judged.png", judged);
  write_text_file(folder / "candidates.csv", candidates_csv(stages));
  output.commit();
}

}  // namespace twincell::imaging
