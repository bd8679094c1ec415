#include "imaging/camera/sensor.hpp"

#include <algorithm>
#include <cmath>

#include "imaging/camera/random.hpp"

namespace twincell::imaging {

namespace {

// Poisson distribution for few electrons, by inversion of the cumulative distribution.
double poisson(double mean, RandomStream& chance) {
  const double u = chance.uniform();
  double probability = std::exp(-mean), sum = probability;
  int n = 0;
  for (; u > sum && n < 200; ++n) {
    probability *= mean / (n + 1);
    sum += probability;
  }
  return n;
}

// A grey level with noise. Many electrons are normally distributed; as the sum of two normal numbers is
// normal, shot and read noise then take one random number.
double noisy(double level, const CameraOptions& o, RandomStream& chance) {
  constexpr double kMaxPoissonElectrons = 50;
  const double electrons = level * o.electrons_per_level;
  double variance = o.read_noise * o.read_noise;
  if (electrons > kMaxPoissonElectrons)
    variance += level / o.electrons_per_level;
  else if (electrons > 0)
    level = poisson(electrons, chance) / o.electrons_per_level;
  return variance > 0 ? level + std::sqrt(variance) * chance.normal() : level;
}

template <class Pixel>
void digitise(const cv::Mat1f& light, const CameraOptions& o, std::int64_t frame, cv::Mat& picture) {
  const double finer = std::ldexp(1.0, o.bits - 8), top = std::ldexp(1.0, o.bits) - 1;
  for (int y = 0; y < light.rows; ++y) {
    RandomStream chance(o.seed, Chance::noise, frame, y);
    auto* row = picture.ptr<Pixel>(y);
    for (int x = 0; x < light.cols; ++x) {
      const double level = noisy(double{light(y, x)}, o, chance);
      row[x] = static_cast<Pixel>(std::lrint(std::clamp((level + o.black_level) * finer, 0.0, top)));
    }
  }
}

}  // namespace

cv::Mat read_out(const cv::Mat1f& light, const CameraOptions& options, std::int64_t frame) {
  cv::Mat picture(light.size(), options.bits == 8 ? CV_8U : CV_16U);
  if (options.bits == 8)
    digitise<std::uint8_t>(light, options, frame, picture);
  else
    digitise<std::uint16_t>(light, options, frame, picture);
  return picture;
}

}  // namespace twincell::imaging
