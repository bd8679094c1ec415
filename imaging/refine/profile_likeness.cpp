#include "imaging/refine/profile_likeness.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace twincell::imaging {

namespace {

/// Sums of a picture over a disc, given as a mask with one run of pixels in each row, around each pixel that
/// is far enough from the border. With sums along the rows this takes two reads a row of the disc, fewer
/// operations than a correlation by Fourier transforms.
cv::Mat1d sums_over(const cv::Mat1f& picture, const cv::Mat1f& disc) {
  cv::Mat1d before(picture.rows, picture.cols + 1);  // sum of a row up to a pixel
  for (int y = 0; y < picture.rows; ++y) {
    before(y, 0) = 0;
    for (int x = 0; x < picture.cols; ++x)
      before(y, x + 1) = before(y, x) + static_cast<double>(picture(y, x));
  }
  cv::Mat1d sums = cv::Mat1d::zeros(picture.rows - disc.rows + 1, picture.cols - disc.cols + 1);
  for (int row = 0; row < disc.rows; ++row) {
    const int width = cv::countNonZero(disc.row(row)), first = (disc.cols - width) / 2;
    for (int y = 0; y < sums.rows && width > 0; ++y) {
      const double *from = before[y + row] + first, *to = from + width;
      double* sum = sums[y];
      for (int x = 0; x < sums.cols; ++x) sum[x] += to[x] - from[x];
    }
  }
  return sums;
}

}  // namespace

cv::Mat1f likeness(const cv::Mat1f& picture, const DiscProfile& f, double least_level) {
  const double radius = f.radius_px;
  const int reach = cvCeil(radius) + 1;
  const int side = 2 * reach + 1;
  cv::Mat1f disc = cv::Mat1f::zeros(side, side), profile = disc.clone();
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double r = std::hypot(x - reach, y - reach);
      if (r >= radius) continue;
      disc(y, x) = 1;
      profile(y, x) = static_cast<float>(level_at(f, r).value);
    }
  profile -= disc * (cv::sum(profile)[0] / cv::sum(disc)[0]);
  const double n = cv::sum(disc)[0], of_profile = profile.dot(profile);
  cv::Mat1f wide, both;
  cv::copyMakeBorder(picture, wide, reach, reach, reach, reach, cv::BORDER_REPLICATE);
  cv::matchTemplate(wide, profile, both, cv::TM_CCORR);
  const cv::Mat1d sum = sums_over(wide, disc), squares = sums_over(wide.mul(wide), disc);
  cv::Mat1f like = cv::Mat1f::zeros(picture.size());
  for (int y = 0; y < like.rows; ++y)
    for (int x = 0; x < like.cols; ++x) {
      const double s = sum(y, x), common = static_cast<double>(both(y, x)),
                   of_picture = squares(y, x) - s * s / n;
      if (common > least_level * of_profile && of_picture > 0)
        like(y, x) = static_cast<float>(common / std::sqrt(of_profile * of_picture));
    }
  return like;
}

}  // namespace twincell::imaging
