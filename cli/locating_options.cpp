// Options of the verbs that locate beads.

#include "cli/locating_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>

#include "cli/output.hpp"
#include "cli/stack_info.hpp"
#include "core/error.hpp"
#include "imaging/preprocess/flat_field.hpp"

namespace twincell::cli {

void add_locating_flags(CLI::App& verb, LocatingFlags& flags) {
  verb.add_option(
          "--diameter", flags.diameters,
          "Bead diameter, px, or up to 8 different diameters; default: the scale in CELL.toml if there "
          "is one, otherwise determined from the first frame")
      ->check(CLI::Range(3.0, 400.0))
      ->expected(1, 8);
  verb.add_option("--locator", flags.locator.finder, "Method that finds candidates for beads; default: vote")
      ->check(CLI::IsMember(finder_names()));
  verb.add_option("--min-score", flags.locator.find.min_score,
                  "Smallest share of the edge of a circle that must be visible, 0 to 1; default: 0.04");
  verb.add_option("--refine", flags.locator.refine.method, refiners_help())
      ->check(CLI::IsMember(refiner_names()));
  CLI::Option* bright =
      verb.add_flag("--bright", flags.locator.preprocess.bright, "Beads are brighter than the background");
  verb.add_flag(
          "--dark", flags.dark,
          "Beads are darker than the background; default: as CELL.toml states if there is one, otherwise "
          "determined from the first frame")
      ->excludes(bright);
  CLI::Option* flat = verb.add_option("--flat", flags.flat,
                                      "Divide every frame by a flat field: a stack of the cell without "
                                      "beads, or 'stack' for the light between "
                                      "the back-lit beads of the stack itself; default: no flat field");
  verb.add_option("--background", flags.background,
                  "Picture of the cell without beads: every frame is divided by it, or with --bright it is "
                  "subtracted; default: none")
      ->excludes(flat);
  verb.add_option(
      "--roi", flags.roi,
      "Part of the picture that is searched: left,top,width,height, px; coordinates remain those of "
      "the whole picture; default: all of it");
  verb.add_option("--mask", flags.mask,
                  "Picture of the size of the frames that is 0 where no bead is searched; default: none");
  verb.add_option("--frames", flags.frames,
                  "Frames that are read: A:B or A:B:STEP, from frame A, counted from 0, to the one before B; "
                  "default: all");
}

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
  cv::Mat picture;
  if (!open_frames(file)->next(picture))
    throw InputError(Where{.file = file, .key = {}}, "holds no picture.");
  return picture != 0;
}

}  // namespace

LocatorOptions locator_of(const LocatingFlags& flags, std::optional<double> scale_px,
                          std::optional<bool> bright) {
  LocatorOptions locator = flags.locator;
  if (!flags.diameters.empty()) {
    locator.diameter_px = flags.diameters.front();
    locator.other_diameters_px.assign(flags.diameters.begin() + 1, flags.diameters.end());
  } else {
    locator.diameter_px = scale_px.value_or(0);
  }
  if (!flags.dark) locator.preprocess.bright |= bright.value_or(false);
  locator.polarity_known = flags.dark || flags.locator.preprocess.bright || bright.has_value();
  return locator;
}

Region region_of(const LocatingFlags& flags) {
  Region region;
  if (!flags.roi.empty()) region.roi = read_roi(flags.roi);
  if (!flags.mask.empty()) region.mask = read_mask(flags.mask);
  return region;
}

nlohmann::json restrictions(const LocatingFlags& flags) {
  nlohmann::json said;
  for (const auto& [name, value] :
       {std::pair{"roi", &flags.roi}, std::pair{"mask", &flags.mask}, std::pair{"frames", &flags.frames},
        std::pair{"flat", &flags.flat}, std::pair{"background", &flags.background}})
    if (!value->empty()) said[name] = *value;
  return said;
}

FrameRange frames_of(const LocatingFlags& flags) {
  return flags.frames.empty() ? FrameRange{} : read_frame_range(flags.frames, "--frames");
}

std::unique_ptr<FrameSource> open_for_locating(const std::string& stack, const LocatingFlags& flags,
                                               const LocatorOptions& locator, const Common& common) {
  auto frames = chosen_frames(open_stack(stack, common), frames_of(flags));
  if (!flags.background.empty()) {
    const auto picture = open_frames(flags.background);
    return locator.preprocess.bright ? without_background(std::move(frames), mean_of(*picture))
                                     : flattened(std::move(frames), flat_of_blank(*picture));
  }
  if (flags.flat.empty()) return frames;
  return flattened(std::move(frames), flags.flat == "stack"
                                          ? flat_of_stack(*open_frames(stack), *open_frames(stack))
                                          : flat_of_blank(*open_frames(flags.flat)));
}

void check_locating(const LocatingFlags& flags, bool bright) {
  if (flags.flat == "stack" && bright)
    throw ConfigError(Where{.file = {}, .key = "--flat"},
                      "'stack' uses the light between dark beads, but these beads are brighter than the "
                      "background; give frames of the cell without beads.");
}

PhaseLock lock_of_chosen(PhaseLock lock, const FrameRange& range) {
  if (!lock.locked() || range.all()) return lock;
  if (lock.frames_per_cycle % range.step != 0)
    throw ConfigError(
        Where{.file = {}, .key = "--frames"},
        fmt::format("takes every frame number {}, which does not divide the {} frames per cycle.", range.step,
                    lock.frames_per_cycle));
  const std::int64_t first = (lock.first_phase + range.first) % lock.frames_per_cycle;
  lock.frames_per_cycle = static_cast<int>(lock.frames_per_cycle / range.step);
  lock.first_phase = static_cast<int>(first / range.step);
  lock.offset = (lock.offset + static_cast<double>(first % range.step)) / static_cast<double>(range.step);
  return lock;
}

}  // namespace twincell::cli
