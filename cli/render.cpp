// twincell render TRAJ.h5: frames as the experiment's camera would see them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "analysis/trajectory/h5md_file.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "imaging/synthetic_camera.hpp"

namespace twincell::cli {

namespace {

struct RenderOptions {
  std::string trajectory, output;
  CameraOptions camera;
};

void run(RenderOptions& o, const Common& common) {
  if (common.seed) o.camera.seed = *common.seed;
  const H5mdReader trajectory(o.trajectory);
  std::size_t n = 0;
  {
    ProgressBar bar(common, "render");
    n = render(trajectory, o.camera, o.output, bar);
  }
  print_result(common, {{"frames", n}, {"output", o.output}, {"seed", o.camera.seed}},
               fmt::format("{} frames, truth.csv and CELL.toml in {}\n", n, o.output));
}

}  // namespace

void add_render(CLI::App& program, Common& common) {
  auto o = std::make_shared<RenderOptions>();
  CLI::App& verb = add_verb(program, common, "render", "Synthetic camera: frames with known truth",
                            "twincell render sim.h5 -o frames/");
  verb.add_option("trajectory", o->trajectory, "Trajectory (H5MD)")->required();
  verb.add_option("-o,--output", o->output, "Folder for frames, truth.csv and CELL.toml")->required();
  CameraOptions& c = o->camera;
  verb.add_option("--pixels-per-sigma", c.pixels_per_sigma, "Camera pixels per bead diameter");
  verb.add_option("--margin", c.margin_px, "Wall shown around the cell, px");
  verb.add_option("--blur", c.blur_px, "Blur of the optics, standard deviation, px");
  verb.add_option("--backlight", c.backlight, "Grey levels of the light");
  verb.add_option("--vignetting", c.vignetting, "Relative loss of light in the corners");
  verb.add_option("--electrons-per-level", c.electrons_per_level, "Shot noise: variance = I / this; 0: none");
  verb.add_option("--read-noise", c.read_noise, "Grey levels");
  verb.add_option("--tracer-darkness", c.tracer_darkness, "Darkness of tracers, 0.4 .. 1");
  verb.add_option("--exposure", c.exposure, "Motion blur: exposure in t0 (needs velocities)");
  verb.add_option("--max-height", c.max_height, "Height shown, sigma; 0: as high as beads get");
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
