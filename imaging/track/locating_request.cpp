#include "imaging/track/locating_request.hpp"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.hpp"
#include "imaging/preprocess/flat_field.hpp"
#include "imaging/preprocess/open_flattened.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::imaging {

namespace {

cv::Rect read_roi(const std::string& text) {
  int numbers[4] = {};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int i = 0; i < 4; ++i) {
    const auto [last, error] = std::from_chars(at, end, numbers[i]);
    const bool stops_right = i < 3 ? last != end && *last == ',' : last == end;
    if (error != std::errc() || !stops_right || numbers[i] < (i < 2 ? 0 : 1))
      throw ConfigError(
          Where{.file = {}, .key = "--roi"},
          fmt::format("is '{}', but must be left,top,width,height in whole px, the first two 0 or "
                      "more, the others at least 1.",
                      text));
    at = last + 1;
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

cv::Mat1b read_mask(const std::string& file) {
  const auto frames = open_frames(file);
  cv::Mat picture, another;
  if (!frames->next(picture)) throw InputError(Where{.file = file, .key = {}}, "holds no picture.");
  if (frames->next(another))
    throw InputError(Where{.file = file, .key = {}}, "holds several pictures, but a mask is one picture.");
  return picture != 0;
}

}  // namespace

LocatorOptions locator_of(const LocatingRequest& request, std::optional<double> scale_px,
                          std::optional<bool> bright, const std::optional<std::string>& refine) {
  LocatorOptions locator = request.locator;
  if (refine && !request.refine_given) locator.refine.method = *refine;
  if (request.diameters.empty()) {
    locator.diameter_px = scale_px.value_or(0);
    locator.diameter_of_scale = scale_px.has_value();
  } else {
    locator.diameter_px = request.diameters.front();
    locator.other_diameters_px.assign(request.diameters.begin() + 1, request.diameters.end());
  }
  if (!request.dark) locator.preprocess.bright |= bright.value_or(false);
  locator.polarity_known = request.dark || request.locator.preprocess.bright || bright.has_value();
  return locator;
}

Region region_of(const LocatingRequest& request) {
  Region region;
  if (!request.roi.empty()) region.roi = read_roi(request.roi);
  if (!request.mask.empty()) region.mask = read_mask(request.mask);
  return region;
}

nlohmann::json restrictions(const LocatingRequest& request) {
  nlohmann::json said;
  for (const auto& [name, value] : {std::pair{"roi", &request.roi}, std::pair{"mask", &request.mask},
                                    std::pair{"frames", &request.frames}, std::pair{"flat", &request.flat},
                                    std::pair{"background", &request.background}})
    if (!value->empty()) said[name] = *value;
  return said;
}

FrameRange frames_of(const LocatingRequest& request) {
  return request.frames.empty() ? FrameRange{} : read_frame_range(request.frames, "--frames");
}

std::unique_ptr<FrameSource> prepare_frames(std::unique_ptr<FrameSource> frames, const std::string& stack,
                                            const LocatingRequest& request, const LocatorOptions& locator) {
  frames = chosen_frames(std::move(frames), frames_of(request));
  if (request.background.empty()) return flattened_by(std::move(frames), stack, request.flat);
  const auto picture = open_frames(request.background);
  return locator.preprocess.bright ? without_background(std::move(frames), mean_of(*picture))
                                   : flattened(std::move(frames), flat_of_blank(*picture));
}

std::vector<GivenOption> given_options(const LocatingRequest& r) {
  const LocatorOptions& l = r.locator;
  const LocatorOptions usual;
  std::vector<GivenOption> given;
  const auto add = [&](bool is_given, const char* name, std::vector<std::string> values,
                       bool of_discs = false) {
    if (is_given) given.push_back({name, std::move(values), of_discs});
  };
  std::vector<std::string> diameters;
  for (const double d : r.diameters) diameters.push_back(fmt::format("{}", d));
  add(!diameters.empty(), "--diameter", diameters, true);
  add(r.dark, "--dark", {}, true);
  add(l.preprocess.bright, "--bright", {}, true);
  add(l.refine.method != usual.refine.method, "--refine", {l.refine.method}, true);
  add(l.finder != usual.finder, "--locator", {l.finder});
  add(l.find.min_score != usual.find.min_score, "--min-score", {fmt::format("{}", l.find.min_score)});
  add(l.judge.min_score != usual.judge.min_score, "--min-explained", {fmt::format("{}", l.judge.min_score)});
  for (const auto& [name, value] :
       {std::pair{"--flat", &r.flat}, std::pair{"--background", &r.background}, std::pair{"--roi", &r.roi},
        std::pair{"--mask", &r.mask}, std::pair{"--frames", &r.frames}})
    add(!value->empty(), name, {*value});
  return given;
}

std::string option_for_frames(const LocatingRequest& request) {
  for (const GivenOption& option : given_options(request))
    if (option.name != "--diameter" || option.values.size() > 1) return option.name;
  return request.refine_given ? "--refine" : "";
}

Located in_whole_picture(Located located, const Region& region) {
  if (region.whole()) return located;
  for (std::vector<Detection>* list : {&located.beads, &located.dropped}) {
    for (Detection& d : *list) {
      d.x += region.corner().x;
      d.y += region.corner().y;
    }
    std::erase_if(*list, [&](const Detection& d) { return region.cuts(d.x, d.y, d.radius); });
  }
  return located;
}

SettingsChoice in_whole_picture(SettingsChoice choice, const Region& region) {
  for (LargerDisc& d : choice.larger) {
    d.x += region.corner().x;
    d.y += region.corner().y;
  }
  std::erase_if(choice.larger,
                [&](const LargerDisc& d) { return region.cuts(d.x, d.y, 0.5 * d.diameter_px); });
  return choice;
}

}  // namespace twincell::imaging
