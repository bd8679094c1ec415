#include "imaging/track/annotation.hpp"

#include <opencv2/imgproc.hpp>

namespace twincell::imaging {
namespace {
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kSize = 0.5;
}  // namespace

void draw_text(cv::Mat3b& picture, const std::string& text, cv::Point at, const cv::Scalar& colour) {
  cv::putText(picture, text, at, kFont, kSize, colour, 1, cv::LINE_AA);
}

void draw_label(cv::Mat3b& picture, const std::string& text, cv::Point at, const cv::Scalar& colour) {
  constexpr int kRim = 4;
  cv::putText(picture, text, at, kFont, kSize, cv::Scalar(255, 255, 255), kRim, cv::LINE_AA);
  draw_text(picture, text, at, colour);
}

int text_width(const std::string& text) {
  return cv::getTextSize(text, kFont, kSize, 1, nullptr).width;
}

void draw_line(cv::Mat3b& picture, cv::Point a, cv::Point b, const cv::Scalar& colour, int width) {
  cv::line(picture, a, b, colour, width, cv::LINE_AA);
}

void draw_arrow(cv::Mat3b& picture, cv::Point a, cv::Point b, const cv::Scalar& colour, int width) {
  constexpr double kHead = 0.2;
  cv::arrowedLine(picture, a, b, colour, width, cv::LINE_AA, 0, kHead);
}

void draw_curve(cv::Mat3b& picture, const std::vector<cv::Point>& points, const cv::Scalar& colour) {
  cv::polylines(picture, points, false, colour, 1, cv::LINE_AA);
}

void draw_box(cv::Mat3b& picture, cv::Rect box, const cv::Scalar& colour) {
  cv::rectangle(picture, box, colour);
}

void draw_dot(cv::Mat3b& picture, cv::Point at, int radius, const cv::Scalar& colour) {
  cv::circle(picture, at, radius, colour, cv::FILLED, cv::LINE_AA);
}

void flatten_noise(cv::Mat3b& picture) {
  constexpr int kLevels = 0xF8;
  cv::bitwise_and(picture, cv::Scalar::all(kLevels), picture);
}

}  // namespace twincell::imaging
