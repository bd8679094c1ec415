#include "imaging/find/hough_finder.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace twincell::imaging {

std::vector<Proposal> HoughFinder::find(const Prepared& image, const FindOptions& options) {
  constexpr int enlarge = 3;
  cv::Mat1b grey;
  cv::Mat1f light = 1 - image.darkness;
  if (!image.opaque.empty()) light.setTo(0, image.opaque);
  light.convertTo(grey, CV_8U, 220);
  cv::resize(grey, grey, cv::Size(), enlarge, enlarge, cv::INTER_CUBIC);
  cv::GaussianBlur(grey, grey, cv::Size(), 1.0);
  const double r = enlarge * options.radius_px;
  const double edge = 60;  // upper Canny threshold, grey levels
  // A score of 1 would mean that every edge pixel of the circle votes for the accumulator cell.
  const double needed = std::max(4.0, options.min_score * r);
  std::vector<cv::Vec3f> circles;
  cv::HoughCircles(grey, circles, cv::HOUGH_GRADIENT, 2, options.apart * 2 * r, edge, needed,
                   cvFloor(0.9 * r), cvCeil(1.1 * r));
  std::vector<Proposal> found;
  for (const cv::Vec3f& c : circles) {
    // The enlargement maps the centre of pixel i to 3 i + 1.
    const double x = (static_cast<double>(c[0]) - 1) / enlarge, y = (static_cast<double>(c[1]) - 1) / enlarge;
    found.push_back(
        {x, y, 1 - 0.5 * static_cast<double>(found.size()) / static_cast<double>(circles.size())});
  }
  return found;
}

}  // namespace twincell::imaging
