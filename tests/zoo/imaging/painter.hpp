#pragma once
/// \file
/// A painter of pictures for tests of the locator. It shares no code and no disc model with the locator:
/// objects are painted one over the other on a canvas with 16 samples per pixel, and then the canvas is
/// blurred by the lens, averaged over the pixels, and read out with shot and read noise.
///
/// Positions are in px; (0, 0) is the centre of the first pixel.

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

namespace twincell::zoo {

/// Canvas of light levels, in grey levels of the camera.
class Painter {
 public:
  Painter(int side, double level)
      : side_(side), canvas_(side * kSamples, side * kSamples, static_cast<float>(level)) {}
  [[nodiscard]] int side() const { return side_; }

  /// Sets every sample within the circle to shade(u, v, level before), with u and v from -1 to 1 across it.
  template <class Shade>
  void disc(double x, double y, double radius, Shade&& shade) {
    over(cv::Rect2d(x - radius, y - radius, 2 * radius, 2 * radius), [&](double sx, double sy, float& level) {
      const double u = (sx - x) / radius, v = (sy - y) / radius;
      if (u * u + v * v < 1) level = static_cast<float>(shade(u, v, static_cast<double>(level)));
    });
  }

  /// Sets every sample of the window for which shade(x, y, level before) gives another level.
  template <class Shade>
  void area(const cv::Rect2d& window, Shade&& shade) {
    over(window, [&](double sx, double sy, float& level) {
      level = static_cast<float>(shade(sx, sy, static_cast<double>(level)));
    });
  }
  template <class Shade>
  void everywhere(Shade&& shade) {
    area({-0.5, -0.5, static_cast<double>(side_), static_cast<double>(side_)}, std::forward<Shade>(shade));
  }

  /// Writes letters of a height in px, with the lower left corner at (x, y).
  void text(const std::string& letters, double x, double y, double height, double level) {
    constexpr double kHeight = 21;  // of the font at scale 1, px
    cv::putText(canvas_, letters, {at(x), at(y)}, cv::FONT_HERSHEY_SIMPLEX, height * kSamples / kHeight,
                cv::Scalar(level), std::max(1, static_cast<int>(0.12 * height * kSamples)));
  }

  /// The picture that the camera takes: lens blur (standard deviation, px), read noise and shot noise of that
  /// standard deviation at level 200, 8 bits.
  [[nodiscard]] cv::Mat1b exposed(double blur_px, double noise, std::uint64_t seed) const {
    cv::Mat1f seen;
    cv::GaussianBlur(canvas_, seen, {0, 0}, blur_px * kSamples, 0, cv::BORDER_REPLICATE);
    cv::resize(seen, seen, {side_, side_}, 0, 0, cv::INTER_AREA);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    cv::Mat1b picture(side_, side_);
    for (int y = 0; y < side_; ++y)
      for (int x = 0; x < side_; ++x) {
        const auto level = static_cast<double>(seen(y, x));
        picture(y, x) = cv::saturate_cast<uchar>(
            level + noise * std::sqrt(0.2 + 0.8 * std::max(0.0, level) / 200) * normal(random));
      }
    return picture;
  }

 private:
  static constexpr int kSamples = 4;  // per px and direction
  static int at(double px) { return static_cast<int>(std::lround((px + 0.5) * kSamples - 0.5)); }

  template <class Use>
  void over(const cv::Rect2d& window, Use&& use) {
    const int left = std::max(0, at(window.x)), right = std::min(canvas_.cols - 1, at(window.br().x));
    const int top = std::max(0, at(window.y)), low = std::min(canvas_.rows - 1, at(window.br().y));
    for (int j = top; j <= low; ++j)
      for (int i = left; i <= right; ++i)
        use((i + 0.5) / kSamples - 0.5, (j + 0.5) / kSamples - 0.5, canvas_(j, i));
  }

  int side_;
  cv::Mat1f canvas_;
};

}  // namespace twincell::zoo
