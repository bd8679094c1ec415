// twincell draw TRAJ.h5 -o picture.png | film.mp4: a trajectory as a drawing, without a camera.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "analysis/colouring/colouring.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/counted.hpp"
#include "core/output_rules.hpp"
#include "imaging/drawing/drawing.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

constexpr const char* kPlain = "plain";  ///< the word of --colour for beads of one colour

struct DrawOptions {
  std::string trajectory, frames, colour = kPlain;
  std::vector<double> range;
  bool fps_said = false;
  imaging::DrawJob job;
};

void run(DrawOptions& o, const Common& common) {
  if (o.fps_said && !o.job.film())
    throw ConfigError({.file = {}, .key = "--fps"}, "applies to a film; the output is a picture.");
  require_output(o.job.output, o.job.film() ? Product::film() : Product::picture());
  if (!o.frames.empty()) o.job.frames = imaging::read_frame_range(o.frames, "--frames");
  if (!o.range.empty()) o.job.colours.range = {o.range[0], o.range[1]};
  const H5mdReader trajectory(o.trajectory);
  if (o.colour != kPlain) {
    const analysis::Colouring& colouring = analysis::colouring_named(o.colour, trajectory, "--colour");
    o.job.colours.name = colouring.word;
    o.job.colours.unit = colouring.unit;
    o.job.colours.of = [&](std::size_t index, const Frame& frame) {
      return colouring.of({.source = trajectory, .index = index, .frame = frame});
    };
  }
  imaging::Drawn drawn;
  {
    ProgressBar bar(common, "draw");
    drawn = imaging::draw(trajectory, o.job, bar);
  }
  nlohmann::json document = {{"output", o.job.output.string()},
                             {"frames", drawn.frames},
                             {"width_px", drawn.size.width},
                             {"height_px", drawn.size.height},
                             {"colour", o.colour}};
  std::string text =
      fmt::format("{}, {} x {} px", counted(drawn.frames, "frame"), drawn.size.width, drawn.size.height);
  if (o.colour != kPlain) {
    document["range"] = drawn.range;
    text +=
        fmt::format(", {} {:.4g} to {:.4g} {}", o.colour, drawn.range[0], drawn.range[1], o.job.colours.unit);
    while (text.back() == ' ') text.pop_back();
  }
  print_result(common, document, fmt::format("{}\n{}\n", text, o.job.output.string()));
}

}  // namespace

void add_draw(CLI::App& program, Common& common) {
  auto o = std::make_shared<DrawOptions>();
  CLI::App& verb = add_verb(program, common, "draw",
                            "Draw a trajectory as a picture or a film: beads coloured by a number, the cell, "
                            "tracks, velocities and contact forces.",
                            "twincell draw sim.h5 -o film.mp4 --colour speed");
  verb.add_option("trajectory", o->trajectory, "Trajectory file (H5MD)")->required();
  // Whether it is a picture or a film depends on the name; run() checks what may be replaced.
  common.outputs.push_back({verb.add_option("-o,--output", o->job.output,
                                            "File to write. .png: the last of the frames; .mp4 or .avi: a "
                                            "film of all frames")
                                ->required(),
                            nullptr, Product::picture()});
  verb.add_option("--frames", o->frames,
                  "Frames that are drawn: A:B or A:B:STEP, from frame A, counted from 0, to the one before "
                  "B; default: all");
  std::string help = "Number that the colour of a bead shows. plain: none";
  std::vector<std::string> words = {kPlain};
  for (const analysis::Colouring& colouring : analysis::colourings()) {
    help += fmt::format("; {}: {}", colouring.word, colouring.help);
    words.emplace_back(colouring.word);
  }
  verb.add_option("--colour", o->colour, help)
      ->check(CLI::IsMember(words))
      ->option_text(kWord)
      ->capture_default_str();
  verb.add_option("--colour-range", o->range,
                  "Numbers at the two ends of the colour map; default: the smallest and the largest of the "
                  "drawn frames")
      ->expected(2);
  verb.add_option("--tracks", o->job.tracks,
                  "Number of frames before the drawn one over which the path of each bead is drawn")
      ->check(CLI::Range(1, 100000));
  verb.add_flag("--vectors", o->job.vectors, "Draw velocities as arrows; the longest is 2 sigma long");
  verb.add_flag("--contacts", o->job.contacts,
                "Draw contacts as lines, whose width is proportional to the normal force (simulate "
                "--contacts)");
  verb.add_option("--pixels-per-sigma", o->job.pixels_per_sigma,
                  "Scale; default: the longer side of the cell is about 900 px")
      ->check(CLI::Range(0.1, 1000.0));
  CLI::Option* const fps =
      verb.add_option("--fps", o->job.frames_per_second, "Frames per second of the film; default: 25");
  verb.callback([o, fps, &common] {
    o->fps_said = fps->count() > 0;
    run(*o, common);
  });
}

}  // namespace twincell::cli
