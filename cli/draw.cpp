// twincell draw TRAJ.h5 -o picture.png | film.mp4 | page.html: a trajectory as a drawing, without a camera.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "analysis/colouring/colouring.hpp"
#include "analysis/colouring/value_table.hpp"
#include "cli/draw_page.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/output_rules.hpp"
#include "core/plural.hpp"
#include "imaging/drawing/drawing.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

constexpr const char* kPlain = "plain";  ///< the word of --colour for beads of one colour

struct DrawOptions {
  std::string trajectory, frames;
  std::string colour = kPlain;  ///< word of a colouring, or name of a table
  std::vector<double> range;
  bool fps_said = false;
  bool coloured = false;  ///< some bead of the drawn frames has a number
  imaging::DrawJob job;
};

/// Adds the range of the colours: ", speed 0 to 2.5 sigma/t0".
void add_range(const DrawOptions& o, const std::array<double, 2>& range, nlohmann::json& document,
               std::string& text) {
  if (o.colour == kPlain) return;
  if (!o.coloured) {
    document["range"] = nullptr;
    text += fmt::format(", no bead of which has a number for {}", o.colour);
    return;
  }
  document["range"] = range;
  text += fmt::format(", {} {:.4g} to {:.4g} {}", o.colour, range[0], range[1], o.job.colours.unit);
  while (text.back() == ' ') text.pop_back();
}

void write_page(const H5mdReader& trajectory, const DrawOptions& o, const Common& common) {
  DrawnPage page;
  {
    ProgressBar bar(common, "draw");
    page = page_of(trajectory, o.job, o.trajectory, bar);
  }
  write_text_file(o.job.output, page.html, draw_page());
  const double megabytes = static_cast<double>(page.html.size()) / 1e6;
  nlohmann::json document = {{"output", o.job.output.string()},
                             {"frames", page.frames},
                             {"megabytes", megabytes},
                             {"colour", o.colour}};
  std::string text = fmt::format("{}, {:.3g} MB", plural(page.frames, "frame"), megabytes);
  add_range(o, page.range, document, text);
  print_result(common, document, fmt::format("{}\n{}\n", text, o.job.output.string()));
}

/// Sets the number of each bead that its colour shows.
void colour_beads(DrawOptions& o, const H5mdReader& trajectory) {
  std::function<std::vector<double>(std::size_t, const Frame&)> of;
  if (std::filesystem::path(o.colour).extension() == ".csv") {
    const auto table =
        std::make_shared<analysis::ValueTable>(o.colour, trajectory.n_frames(), trajectory.info().n_beads);
    o.colour = o.job.colours.name = table->name();
    of = [table](std::size_t index, const Frame&) { return table->of(index); };
  } else {
    const analysis::Colouring& colouring = analysis::colouring_named(o.colour, trajectory, "--colour");
    o.job.colours.name = colouring.word;
    o.job.colours.unit = colouring.unit;
    of = [&](std::size_t index, const Frame& frame) {
      return colouring.of({.source = trajectory, .index = index, .frame = frame});
    };
  }
  o.job.colours.of = [&o, of](std::size_t index, const Frame& frame) {
    const std::vector<double> numbers = of(index, frame);
    o.coloured = o.coloured || std::any_of(numbers.begin(), numbers.end(),
                                           [](double number) { return std::isfinite(number); });
    return numbers;
  };
}

void run(DrawOptions& o, const Common& common) {
  const bool page = o.job.output.extension() == ".html";
  if (o.fps_said && !o.job.film())
    throw ConfigError({.file = {}, .key = "--fps"}, "applies to a film or a page; the output is a picture.");
  require_output(o.job.output, page ? draw_page() : o.job.film() ? Product::film() : Product::picture());
  if (!o.frames.empty()) o.job.frames = imaging::read_frame_range(o.frames, "--frames");
  if (!o.range.empty()) o.job.colours.range = {o.range[0], o.range[1]};
  const H5mdReader trajectory(o.trajectory);
  const auto n = static_cast<std::int64_t>(trajectory.n_frames());
  if (o.job.frames.end > n)
    note(common, fmt::format("--frames {} reaches beyond the end of {}, which has {}.", o.frames,
                             o.trajectory, plural(trajectory.n_frames(), "frame")));
  if (o.colour != kPlain) colour_beads(o, trajectory);
  if (page) return write_page(trajectory, o, common);
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
      fmt::format("{}, {} x {} px", plural(drawn.frames, "frame"), drawn.size.width, drawn.size.height);
  add_range(o, drawn.range, document, text);
  print_result(common, document, fmt::format("{}\n{}\n", text, o.job.output.string()));
}

}  // namespace

void add_draw(CLI::App& program, Common& common) {
  auto o = std::make_shared<DrawOptions>();
  CLI::App& verb = add_verb(
      program, common, "draw",
      "Draw a trajectory as a picture, a film or a page that plays in a browser: beads "
      "coloured by a number, the cell, tracks, velocities and contact forces.",
      "twincell draw sim.h5 -o film.mp4 --colour speed\n  twincell draw sim.h5 -o page.html --colour speed");
  verb.add_option("trajectory", o->trajectory, "Trajectory file (H5MD)")->required();
  // Whether it is a picture, a film or a page depends on the name; run() checks what may be replaced.
  common.outputs.push_back({verb.add_option("-o,--output", o->job.output,
                                            "File to write. .png: the last of the frames; .mp4 or .avi: a "
                                            "film of all frames; .html: a page that plays them and needs no "
                                            "other file, at most 32 MB")
                                ->required(),
                            nullptr, Product::picture()});
  verb.add_option("--frames", o->frames,
                  "Frames that are drawn: A:B or A:B:STEP, from frame A, counted from 0, to the one before "
                  "B; default: all");
  std::string help =
      "Number that the colour of a bead shows, or FILE.csv with the columns frame, particle and value. "
      "plain: none";
  std::vector<std::string> words = {kPlain};
  for (const analysis::Colouring& colouring : analysis::colourings()) {
    help += fmt::format("; {}: {}", colouring.word, colouring.help);
    words.emplace_back(colouring.word);
  }
  verb.add_option("--colour", o->colour, help)
      ->check([words](const std::string& said) {
        const bool is_table = std::filesystem::path(said).extension() == ".csv";
        return is_table ? std::string() : CLI::IsMember(words)(said);
      })
      ->option_text(kWord)
      ->capture_default_str();
  verb.add_option("--colour-range", o->range,
                  "Numbers at the two ends of the colour map; default: the smallest and the largest of the "
                  "drawn frames")
      ->expected(2)
      ->delimiter(',');
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
      verb.add_option("--fps", o->job.frames_per_second,
                      "Frames per second of a film, and of a page when it opens; default: 25");
  verb.callback([o, fps, &common] {
    o->fps_said = fps->count() > 0;
    run(*o, common);
  });
}

}  // namespace twincell::cli
