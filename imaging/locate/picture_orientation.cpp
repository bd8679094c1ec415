#include "imaging/locate/picture_orientation.hpp"

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

namespace twincell {

namespace {

struct Moments {
  double x, y;  // sum over pixels of value times the distance from the middle
};

/// Exact for whole numbers, and so the same however the picture is held; for others as good as doubles are.
template <class T>
Moments moments_of(const cv::Mat& picture) {
  // 65536 rows of 16 bits fill 32.
  using Line = std::conditional_t<std::is_integral_v<T>, std::uint32_t, double>;
  using Sum = std::conditional_t<std::is_integral_v<T>, std::int64_t, double>;
  std::vector<Line> columns(static_cast<std::size_t>(picture.cols), 0);
  Sum down = 0, along = 0;
  for (int y = 0; y < picture.rows; ++y) {
    const T* row = picture.ptr<T>(y);
    Line sum = 0;
    Line* column = columns.data();
    for (int x = 0; x < picture.cols; ++x) column[x] += static_cast<Line>(row[x]);
    for (int x = 0; x < picture.cols; ++x) sum += static_cast<Line>(row[x]);
    down += static_cast<Sum>(sum) * static_cast<Sum>(2 * y - (picture.rows - 1));
  }
  for (int x = 0; x < picture.cols; ++x)
    along +=
        static_cast<Sum>(columns[static_cast<std::size_t>(x)]) * static_cast<Sum>(2 * x - (picture.cols - 1));
  return {static_cast<double>(along), static_cast<double>(down)};
}

}  // namespace

cv::Mat PictureOrientation::turned(const cv::Mat& picture) const {
  cv::Mat stood, result;
  // Into a picture of its own: OpenCV would transpose a square one in place.
  if (transpose)
    cv::transpose(picture, stood);
  else
    stood = picture;
  if (!flip_x && !flip_y) return stood;
  cv::flip(stood, result, flip_x && flip_y ? -1 : flip_x ? 1 : 0);
  return result;
}

Detection PictureOrientation::back(Detection d, cv::Size size) const {
  const cv::Size turned = transpose ? cv::Size(size.height, size.width) : size;
  if (flip_x) d.x = turned.width - 1 - d.x;
  if (flip_y) d.y = turned.height - 1 - d.y;
  if (transpose) {
    std::swap(d.x, d.y);
    std::swap(d.sigma_x, d.sigma_y);
  }
  return d;
}

std::array<double, 2> PictureOrientation::back(std::array<double, 2> way) const {
  if (flip_x != flip_y) way[1] = -way[1];
  if (transpose) std::swap(way[0], way[1]);
  return way[0] < 0 ? std::array{-way[0], -way[1]} : way;
}

PictureOrientation canonical_picture_orientation(const cv::Mat& picture) {
  const Moments m = picture.depth() == CV_8U    ? moments_of<std::uint8_t>(picture)
                    : picture.depth() == CV_16U ? moments_of<std::uint16_t>(picture)
                                                : moments_of<float>(picture);
  PictureOrientation o;
  // Only a square can be told from its transpose by nothing but its content.
  o.transpose = picture.cols != picture.rows ? picture.cols > picture.rows : std::abs(m.x) > std::abs(m.y);
  o.flip_x = (o.transpose ? m.y : m.x) > 0;
  o.flip_y = (o.transpose ? m.x : m.y) > 0;
  return o;
}

}  // namespace twincell
