#include "imaging/locate/picture_orientation.hpp"

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

namespace twincell::imaging {

namespace {

struct FirstMoments {
  double x, y;  // sum over pixels of value times twice the distance from the centre
};

/// First moments of the brightness. For integer pixels they are exact, and so independent of the orientation;
/// for other pixels they have double precision.
template <class T>
FirstMoments first_moments(const cv::Mat& picture) {
  // 32 bits are enough for the sum of 65536 pixels of 16 bits.
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
  // Into a separate picture, because OpenCV would transpose a square one in place.
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

std::array<double, 2> PictureOrientation::back(std::array<double, 2> displacement) const {
  if (flip_x != flip_y) displacement[1] = -displacement[1];
  if (transpose) std::swap(displacement[0], displacement[1]);
  return displacement[0] < 0 ? std::array{-displacement[0], -displacement[1]} : displacement;
}

PictureOrientation canonical_picture_orientation(const cv::Mat& picture) {
  const FirstMoments m = picture.depth() == CV_8U    ? first_moments<std::uint8_t>(picture)
                         : picture.depth() == CV_16U ? first_moments<std::uint16_t>(picture)
                                                     : first_moments<float>(picture);
  PictureOrientation o;
  // The shape of a picture decides its transposition; for a square, the content must decide.
  o.transpose = picture.cols != picture.rows ? picture.cols > picture.rows : std::abs(m.x) > std::abs(m.y);
  o.flip_x = (o.transpose ? m.y : m.x) > 0;
  o.flip_y = (o.transpose ? m.x : m.y) > 0;
  return o;
}

}  // namespace twincell::imaging
