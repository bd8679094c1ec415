// twincell render TRAJ.h5: frames of a trajectory as the camera of the experiment would record them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"
#include "imaging/camera/synthetic_camera.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {

namespace {

struct RenderOptions {
  std::string trajectory, camera_file;
  imaging::RenderJob job;
  imaging::CameraOptions flags;  ///< values given on the command line
  std::vector<std::pair<const CLI::Option*, std::size_t>>
      given;  ///< options and their indices in camera_option_list()
};

// The camera of the file, with the options of the command line taking precedence. If an option sets a
// quantity that can be given in several units, its unit replaces that of the file.
imaging::CameraOptions camera_of(RenderOptions& o, const Common& common) {
  imaging::CameraOptions camera =
      o.camera_file.empty() ? imaging::CameraOptions{} : imaging::read_camera(o.camera_file);
  const auto said = imaging::camera_option_list(o.flags), kept = imaging::camera_option_list(camera);
  std::map<const imaging::CameraUnit*, std::string> spelt;
  for (const auto& [option, i] : o.given) {
    if (option->count() == 0) continue;
    std::visit([&said, place = i](auto* value) { *value = *std::get<decltype(value)>(said[place].value); },
               kept[i].value);
    if (kept[i].stated_in == nullptr) continue;
    if (const auto [other, fresh] = spelt.emplace(kept[i].stated_in, kept[i].key); !fresh)
      throw ConfigError(
          Where{.file = {}, .key = kept[i].key},
          fmt::format("and {} set the same quantity; give only one of the two.", other->second));
    *kept[i].stated_in = kept[i].unit;
  }
  if (common.seed) camera.seed = *common.seed;
  return camera;
}

void run(RenderOptions& o, const Common& common) {
  if (o.job.folder.empty() && o.job.movie.empty())
    throw ConfigError(Where{.file = {}, .key = "--output"},
                      "and --movie are both missing; give at least one of them.");
  const imaging::CameraOptions camera = camera_of(o, common);
  o.job.threads = common.n_threads();
  const H5mdReader trajectory(o.trajectory);
  imaging::Rendered done;
  {
    ProgressBar bar(common, "render");
    done = imaging::render(trajectory, camera, o.job, bar);
  }
  nlohmann::json document = {
      {"frames", done.frames}, {"dropped", done.dropped}, {"doubled", done.doubled}, {"seed", camera.seed}};
  std::string text = plural(done.frames, "frame");
  if (!o.job.folder.empty()) {
    document["output"] = o.job.folder.string();
    text += fmt::format(", truth.csv, frames.csv, CELL.toml and CAMERA.toml in {}", o.job.folder.string());
  }
  if (!o.job.movie.empty()) {
    document["movie"] = o.job.movie.string();
    text += fmt::format("{}film in {}", o.job.folder.empty() ? ", " : "; ", o.job.movie.string());
  }
  if (done.dropped + done.doubled > 0)
    text += fmt::format("; {} dropped, {} doubled", done.dropped, done.doubled);
  print_result(common, document, text + "\n");
}

}  // namespace

void add_render(CLI::App& program, Common& common) {
  auto o = std::make_shared<RenderOptions>();
  CLI::App& verb = add_verb(program, common, "render",
                            "Render a trajectory with the synthetic camera. Writes frames with their ground "
                            "truth into a folder, or a film, or both.",
                            "twincell render sim.h5 -o filmed/ --exposure-t0 0.05 --movie film.mp4");
  takes_seed(verb, common);
  verb.add_option("trajectory", o->trajectory, "Trajectory file (H5MD)")->required();
  writes(common, verb,
         verb.add_option("-o,--output", o->job.folder,
                         "Folder for the frames, truth.csv, frames.csv, CELL.toml and CAMERA.toml"),
         imaging::rendered_stack());
  CLI::Option* const movie =
      writes(common, verb, verb.add_option("--movie", o->job.movie, "Film to write (.mp4 or .avi), 8 bit"),
             Product::film());
  verb.add_option("--fps", o->job.frames_per_second, "Frames per second of the film; default: 25")
      ->needs(movie);
  verb.add_option("--camera", o->camera_file,
                  "CAMERA.toml with any of the options below; options on the command line take precedence");
  const auto list = imaging::camera_option_list(o->flags);
  for (std::size_t i = 0; i < list.size(); ++i)
    std::visit(
        [&](auto* value) {
          const std::string name = "--" + list[i].key;
          if constexpr (std::is_same_v<decltype(value), bool*>)
            o->given.emplace_back(verb.add_flag(name, *value, list[i].help_with_unit()), i);
          else
            o->given.emplace_back(
                verb.add_option(name, *value, list[i].help_with_unit())->capture_default_str(), i);
        },
        list[i].value);
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
