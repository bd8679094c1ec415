// Options of the verbs that locate beads.

#include "cli/locating_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/output.hpp"
#include "cli/stack_info.hpp"
#include "core/escape.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell::cli {

void add_locating_options(CLI::App& verb, imaging::LocatingRequest& request) {
  const OptionHeading heading(verb, "Locating the beads");
  verb.add_option(
          "--diameter", request.diameters,
          "Bead diameter, px, or up to 8 different diameters; default: the scale in CELL.toml if there "
          "is one, otherwise determined from the first frame")
      ->check(CLI::Range(3.0, 400.0))
      ->expected(1, 8);
  verb.add_option("--locator", request.locator.finder,
                  "Method that finds candidates for beads; default: vote")
      ->check(CLI::IsMember(imaging::finder_names()));
  verb.add_option("--min-score", request.locator.find.min_score,
                  "Smallest share of the edge of a circle that must be visible, 0.01 to 1; default: 0.04");
  verb.add_option("--min-explained", request.locator.judge.min_score,
                  "Smallest score of a bead, 0 to 1: share of the variance around its edge that the disc "
                  "explains; default: 0.5");
  verb.add_option("--refine", request.locator.refine.method,
                  "Method that finds the position of each bead to a fraction of a pixel. " +
                      imaging::refiners_help() + "; default: as CELL.toml states if it does, otherwise exact")
      ->check(CLI::IsMember(imaging::refiner_names()))
      ->each([&request](const std::string&) { request.refine_given = true; });
  CLI::Option* bright =
      verb.add_flag("--bright", request.locator.preprocess.bright, "Beads are brighter than the background");
  verb.add_flag(
          "--dark", request.dark,
          "Beads are darker than the background; default: as CELL.toml states if there is one, otherwise "
          "determined from the first frame")
      ->excludes(bright);
  CLI::Option* flat = verb.add_option("--flat", request.flat,
                                      "Divide every frame by a flat field: a stack of the cell without "
                                      "beads, or 'stack' for the light between the back-lit beads of the "
                                      "stack itself; default: no flat field");
  verb.add_option("--background", request.background,
                  "Picture of the cell without beads: every frame is divided by it, or with --bright it is "
                  "subtracted; default: none")
      ->excludes(flat);
  verb.add_option(
      "--roi", request.roi,
      "Part of the picture that is searched: left,top,width,height, px; coordinates remain those of "
      "the whole picture; default: all of it");
  verb.add_option("--mask", request.mask,
                  "Picture of the size of the frames that is 0 where no bead is searched; default: none");
  verb.add_option("--frames", request.frames,
                  "Frames that are read: A:B or A:B:STEP, from frame A, counted from 0, to the one before B; "
                  "default: all");
}

namespace {
std::string words_of(const imaging::LocatingRequest& request, bool of_discs) {
  std::string words;
  for (const imaging::GivenOption& option : imaging::given_options(request)) {
    // The page of `locate --view` sets the least score itself.
    if (option.of_discs != of_discs || option.name == "--min-explained") continue;
    words += " " + option.name;
    for (const std::string& value : option.values) words += " " + shell_word(value);
  }
  return words;
}
}  // namespace

std::string command_words(const imaging::LocatingRequest& request) {
  return words_of(request, false);
}

std::string command_words_of_discs(const imaging::LocatingRequest& request) {
  return words_of(request, true);
}

namespace {

/// A stack whose complaint about a damaged frame says how to read the frames before it.
class UpToDamage : public imaging::FrameSource {
 public:
  UpToDamage(std::unique_ptr<imaging::FrameSource> frames, const imaging::FrameRange& range)
      : frames_(std::move(frames)), range_(range) {}
  bool next(cv::Mat& frame) override {
    try {
      if (!frames_->next(frame)) return false;
    } catch (const InputError& e) {
      if (read_ == 0) throw;
      throw InputError({},
                       fmt::format("{}; --frames {}:{} reads those before it.", without_full_stop(e.what()),
                                   range_.first, range_.number(read_ - 1) + 1));
    }
    ++read_;
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return frames_->announced(); }
  [[nodiscard]] std::string current() const override { return frames_->current(); }
  [[nodiscard]] imaging::StackInfo info() const override { return frames_->info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return frames_->time_s(); }

 private:
  std::unique_ptr<imaging::FrameSource> frames_;
  imaging::FrameRange range_;
  std::int64_t read_ = 0;
};

}  // namespace

std::unique_ptr<imaging::FrameSource> open_for_locating(const std::string& stack,
                                                        const imaging::LocatingRequest& request,
                                                        const imaging::LocatorOptions& locator,
                                                        const Common& common) {
  auto frames = open_stack(stack, common);
  const imaging::FrameRange range = imaging::frames_of(request);
  if (const auto n = static_cast<std::int64_t>(frames->announced()); n > 0 && range.end > n)
    note(common, fmt::format("--frames ends before frame {}, but {} has {} frames.", range.end, stack, n));
  return std::make_unique<UpToDamage>(imaging::prepare_frames(std::move(frames), stack, request, locator),
                                      range);
}

}  // namespace twincell::cli
