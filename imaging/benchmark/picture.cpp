#include "imaging/benchmark/picture.hpp"

#include <cmath>
#include <random>

#include "imaging/benchmark/stamp.hpp"

namespace twincell::imaging::rendered {

cv::Mat1d expected(const Picture& picture) {
  cv::Mat1d share(picture.height, picture.width, 1.0);
  Profiles profiles(picture.blur);
  for (const Disc& disc : picture.discs) {
    const Stamp stamp(picture, disc, profiles.of(disc.radius));
    const cv::Rect& w = stamp.window();
    for (int y = w.y; y < w.y + w.height; ++y)
      for (int x = w.x; x < w.x + w.width; ++x)
        share(y, x) += stamp.glare(x, y) - disc.contrast * stamp.covered(x, y);
  }
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      share(y, x) = picture.pedestal + light_at(picture, x, y) * share(y, x);
  return share;
}

cv::Mat1b expose(const cv::Mat1d& expected, const Picture& picture, double snr, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  cv::Mat1b picture8(expected.size());
  for (int y = 0; y < expected.rows; ++y)
    for (int x = 0; x < expected.cols; ++x)
      picture8(y, x) = cv::saturate_cast<uchar>(
          expected(y, x) +
          std::sqrt(variance(expected(y, x), picture.light, picture, snr)) * normal(generator));
  return picture8;
}

}  // namespace twincell::imaging::rendered
