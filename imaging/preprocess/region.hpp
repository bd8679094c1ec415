#pragma once
/// \file
/// Part of the picture in which beads are searched: a rectangle, a mask, or both.

#include <memory>
#include <opencv2/core.hpp>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// Region of a picture. Default: the whole picture.
struct Region {
  cv::Rect roi;  ///< px; empty: the whole picture. A bead cut by its side is treated as one cut by the frame
  cv::Mat1b mask;  ///< of the size of the picture, 0 where nothing is searched; empty: everywhere

  [[nodiscard]] bool whole() const { return roi.empty() && mask.empty(); }
  /// \throws ConfigError naming the option, its value and the picture's size if the rectangle reaches beyond
  ///     the picture, or the mask has another size or leaves nothing
  void check(cv::Size picture) const;
  /// The rectangle cut out of a picture. Masked pixels have the median of the others.
  /// \throws ConfigError as check
  [[nodiscard]] cv::Mat seen(const cv::Mat& picture) const;
  /// Whether a disc, or the 2.5 px about its rim that the fit needs, contains masked pixels. Lengths
  /// and position in px of the whole picture.
  [[nodiscard]] bool cuts(double x, double y, double radius) const;
  /// Left upper corner of the rectangle, by which positions found in seen() are shifted.
  [[nodiscard]] cv::Point corner() const { return roi.tl(); }
};

/// A stack of which only the region is shown: every frame as Region::seen.
class RegionFrames : public FrameSource {
 public:
  /// \pre `frames` outlives this
  RegionFrames(FrameSource& frames, const Region& region) : frames_(frames), region_(region) {}
  bool next(cv::Mat& frame) override;
  [[nodiscard]] std::size_t announced() const override { return frames_.announced(); }
  [[nodiscard]] std::string current() const override { return frames_.current(); }
  [[nodiscard]] StackInfo info() const override { return frames_.info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return frames_.time_s(); }
  /// Size of the whole picture of the last frame; 0 x 0 before the first.
  [[nodiscard]] cv::Size whole_size() const { return whole_size_; }

 private:
  FrameSource& frames_;
  const Region& region_;
  cv::Size whole_size_;
};

}  // namespace twincell::imaging
