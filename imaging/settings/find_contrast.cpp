#include "imaging/settings/find_contrast.hpp"

#include "imaging/refine/refiner.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell::imaging {

double find_contrast(const cv::Mat& grey, const LocatorOptions& options) {
  const Refiner& refiner = refiner_named(options.refine.method);
  PreprocessOptions plain = options.preprocess;
  plain.contrast = 1;
  if (refiner.model == DiscModel::shared_profile) return 1;
  const double contrast = contrast_of(prepare(grey, plain, options.diameter_px / 2).darkness);
  if (refiner.model == DiscModel::circle || refiner.layers) return contrast;
  if (contrast >= kOpaque) return 1;
  const cv::Mat part = busiest(grey, kExaminedSide);
  const auto explained = [&](double by) {
    return settle_plain(part, options, {plain.bright, options.diameter_px, by}).explained;
  };
  return explained(contrast) > kPaleClearly * explained(1) ? contrast : 1;
}

}  // namespace twincell::imaging
