#include "imaging/preprocess/region.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "core/median.hpp"

namespace twincell::imaging {

void Region::check(cv::Size picture) const {
  if (!roi.empty() && (roi & cv::Rect({0, 0}, picture)) != roi)
    throw ConfigError(
        Where{.file = {}, .key = "--roi"},
        fmt::format("is {},{},{},{} (left, top, width, height), which reaches beyond the picture "
                    "of {} x {} px.",
                    roi.x, roi.y, roi.width, roi.height, picture.width, picture.height));
  if (mask.empty()) return;
  const Where where{.file = {}, .key = "--mask"};
  if (mask.size() != picture)
    throw ConfigError(where, fmt::format("has {} x {} px, but the frames have {} x {} px.", mask.cols,
                                         mask.rows, picture.width, picture.height));
  if (cv::countNonZero(roi.empty() ? mask : cv::Mat1b(mask(roi))) == 0)
    throw ConfigError(where, fmt::format("is 0 everywhere{}, so that nothing of the picture of {} x {} px is "
                                         "left to search.",
                                         roi.empty() ? "" : " in --roi", picture.width, picture.height));
}

cv::Mat Region::seen(const cv::Mat& picture) const {
  if (whole()) return picture;
  check(picture.size());
  const cv::Rect part = roi.empty() ? cv::Rect({0, 0}, picture.size()) : roi;
  cv::Mat seen = picture(part).clone();
  if (mask.empty()) return seen;
  const cv::Mat1b hidden = mask(part) == 0;
  cv::Mat1f grey;
  seen.convertTo(grey, CV_32F);
  std::vector<float> values;
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x)
      if (hidden(y, x) == 0) values.push_back(grey(y, x));
  seen.setTo(static_cast<double>(upper_median(std::move(values))), hidden);
  return seen;
}

bool Region::cuts(double x, double y, double radius) const {
  if (mask.empty()) return false;
  constexpr double kRing_px = 2.5;  // the fit uses the pixels about the rim
  radius += kRing_px;
  const cv::Rect around =
      cv::Rect(cvFloor(x - radius), cvFloor(y - radius), cvCeil(2 * radius) + 2, cvCeil(2 * radius) + 2) &
      cv::Rect({0, 0}, mask.size());
  for (int row = around.y; row < around.br().y; ++row)
    for (int column = around.x; column < around.br().x; ++column)
      if (mask(row, column) == 0 && std::hypot(column - x, row - y) <= radius) return true;
  return false;
}

bool RegionFrames::next(cv::Mat& frame) {
  cv::Mat whole;
  if (!frames_.next(whole)) return false;
  whole_size_ = whole.size();
  frame = region_.seen(whole);
  return true;
}

}  // namespace twincell::imaging
