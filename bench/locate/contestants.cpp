#include "bench/locate/contestants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "imaging/locate/locator.hpp"

namespace twincell::bench {

namespace {

// The only function here that calls this library's locator.
std::vector<cv::Point2d> ours(const cv::Mat1b& frame, imaging::LocatorOptions options,
                              const imaging::rendered::Case& of) {
  options.diameter_px = of.diameter;
  options.other_diameters_px = of.other_diameters;
  std::vector<cv::Point2d> centres;
  for (const imaging::Detection& bead : imaging::locate(frame, options).beads)
    centres.emplace_back(bead.x, bead.y);
  return centres;
}

// True if the options select the refinement method by name.
template <class Options>
constexpr bool kNamesRefinements = requires(Options o) {
  o.method = std::string();
};

template <class Options>
void refine_by(Options& options, const std::string& method) {
  if constexpr (kNamesRefinements<Options>) options.method = method;
}

}  // namespace

std::vector<cv::Point2d> opencv_hough(const cv::Mat1b& frame, const imaging::rendered::Case& of,
                                      const HoughSettings& s) {
  cv::Mat picture = frame;
  if (s.smooth > 0) cv::GaussianBlur(frame, picture = cv::Mat(), {}, s.smooth);
  if (s.enlarge != 1) cv::resize(picture, picture, {}, s.enlarge, s.enlarge, cv::INTER_CUBIC);
  double least = of.diameter * s.enlarge, most = least;
  for (const double other : of.other_diameters)
    least = std::min(least, other * s.enlarge), most = std::max(most, other * s.enlarge);
  std::vector<cv::Vec3f> circles;
  cv::HoughCircles(picture, circles, s.mode, s.mode == cv::HOUGH_GRADIENT ? 1 : 1.5, s.apart * least, s.edge,
                   s.votes, cvFloor(0.5 * least * (1 - s.radius_slack)),
                   cvCeil(0.5 * most * (1 + s.radius_slack)));
  std::vector<cv::Point2d> centres;
  for (const cv::Vec3f& c : circles)
    centres.emplace_back((double{c[0]} + 0.5) / s.enlarge - 0.5, (double{c[1]} + 0.5) / s.enlarge - 0.5);
  return centres;
}

std::vector<std::pair<std::string, HoughSettings>> hough_grid() {
  std::vector<std::pair<std::string, HoughSettings>> grid;
  for (const double enlarge : {1.0, 2.0, 3.0})
    for (const double smooth : {0.0, 0.7})
      for (const double edge : {30.0, 60.0, 120.0, 200.0})
        for (const double apart : {0.6, 0.8}) {
          for (const double votes : {3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 13.0})
            grid.emplace_back(fmt::format("gradient x{} smooth {} edge {} votes {} apart {}", enlarge, smooth,
                                          edge, votes, apart),
                              HoughSettings{cv::HOUGH_GRADIENT, enlarge, smooth, edge, votes, apart, 0.15});
          for (const double votes : {0.3, 0.5, 0.7, 0.8, 0.9})
            grid.emplace_back(
                fmt::format("alt x{} smooth {} edge {} votes {} apart {}", enlarge, smooth, edge, votes,
                            apart),
                HoughSettings{cv::HOUGH_GRADIENT_ALT, enlarge, smooth, edge, votes, apart, 0.15});
        }
  return grid;
}

std::vector<Contestant> contestants() {
  std::vector<Contestant> all;
  std::vector<std::string> methods{""};
  if (kNamesRefinements<imaging::RefineOptions>) methods = {"exact", "fast"};
  for (const std::string& finder : imaging::finder_names())
    for (const std::string& method : methods) {
      imaging::LocatorOptions options;
      options.finder = finder;
      refine_by(options.refine, method);
      all.push_back({fmt::format("twincell {}{}{}", finder, method.empty() ? "" : " ", method),
                     [options](const cv::Mat1b& frame, const imaging::rendered::Case& of) {
                       return ours(frame, options, of);
                     }});
    }
  auto hough = [&](const char* name, const HoughSettings& settings) {
    all.push_back({name, [settings](const cv::Mat1b& frame, const imaging::rendered::Case& of) {
                     return opencv_hough(frame, of, settings);
                   }});
  };
  // Without enlargement: the best setting of `locate_truth --tune`. With enlargement: tuned by hand on the
  // random packing.
  hough("opencv gradient", {cv::HOUGH_GRADIENT, 1, 0, 120, 4, 0.7, 0.15});
  hough("opencv gradient, enlarged", {cv::HOUGH_GRADIENT, 3, 0, 60, 10, 0.8, 0.15});
  hough("opencv alt", {cv::HOUGH_GRADIENT_ALT, 1, 0, 60, 0.5, 0.8, 0.15});
  hough("opencv alt, enlarged", {cv::HOUGH_GRADIENT_ALT, 3, 0, 60, 0.5, 0.8, 0.15});
  return all;
}

}  // namespace twincell::bench
