#include "imaging/camera/noise_matched_camera.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell::imaging {

CameraOptions with_noise_of(FrameSource& stack, double diameter_px, bool bright, CameraOptions camera) {
  constexpr int kFrames = 3;
  constexpr double kMaxReadNoise = 50, kMinElectrons = 0.1, kMaxElectrons = 1e9;
  double dark = 0, light = 0;
  int n = 0;
  cv::Mat frame;
  cv::RNG chance(1);
  for (; n < kFrames && stack.next(frame); ++n) {
    // The median of integer grey levels is an integer, so noise below one or two levels would be wrong by a
    // factor. A dither of one level removes this error; its variance is subtracted below.
    cv::Mat1f grey, dither(frame.size());
    frame.convertTo(grey, CV_32F);
    const bool counted = frame.depth() != CV_32F;
    chance.fill(dither, cv::RNG::UNIFORM, -0.5, 0.5);
    if (counted) grey += dither;
    const Prepared prepared = prepare(grey, {.bright = bright}, diameter_px / 2);
    const Noise noise = noise_of(prepared.darkness);
    const double level = counted ? 1 / static_cast<double>(prepared.light[0]) : 0;
    dark += std::max(0.0, noise.dark - level * level / 12);
    light += noise.light;
  }
  if (n == 0) throw InputError({.file = stack.current(), .key = {}}, "the stack contains no frames.");
  const double levels = camera.backlight;
  const double counted = std::pow(2.0, 8 - camera.bits);
  const double read = dark / n * levels * levels - counted * counted / 12;
  camera.bright = bright;
  camera.read_noise = std::min(kMaxReadNoise, std::sqrt(std::max(0.0, read)));
  camera.electrons_per_level =
      light > 0 ? std::clamp(n / (light * levels), kMinElectrons, kMaxElectrons) : 0;  // 0: no shot noise
  return camera;
}

}  // namespace twincell::imaging
