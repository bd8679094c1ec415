#pragma once
/// \file
/// Lines, marks and texts on a picture, smoothed, in whole pixels.

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace twincell::imaging {

/// Writes a text with its base line at `at`; ASCII only.
void draw_text(cv::Mat3b& picture, const std::string& text, cv::Point at, const cv::Scalar& colour);
/// The same with a white rim, so that it can be read on beads too.
void draw_label(cv::Mat3b& picture, const std::string& text, cv::Point at, const cv::Scalar& colour);
/// Width of such a text, px.
int text_width(const std::string& text);
/// Draws a straight line of the given width, px.
void draw_line(cv::Mat3b& picture, cv::Point a, cv::Point b, const cv::Scalar& colour, int width = 1);
/// Draws an arrow from a to b.
void draw_arrow(cv::Mat3b& picture, cv::Point a, cv::Point b, const cv::Scalar& colour, int width);
/// Draws an open polygon through the points.
void draw_curve(cv::Mat3b& picture, const std::vector<cv::Point>& points, const cv::Scalar& colour);
/// Draws the outline of a rectangle.
void draw_box(cv::Mat3b& picture, cv::Rect box, const cv::Scalar& colour);
/// Draws a filled circle of the given radius, px.
void draw_dot(cv::Mat3b& picture, cv::Point at, int radius, const cv::Scalar& colour);
/// Rounds grey levels down to multiples of 8. Noise of the camera below that shows nothing in a drawing, and
/// doubles the size of its file.
void flatten_noise(cv::Mat3b& picture);

}  // namespace twincell::imaging
