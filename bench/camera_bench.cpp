// The synthetic camera on the first paper's cell of 1600 beads: one exposure (one thread, processor time),
// and complete runs as `twincell render` makes them, with PNGs and true positions written (all cores, wall
// time). Goal: 1000 frames per minute.

#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <thread>

#include "imaging/camera/synthetic_camera.hpp"

namespace twincell {
namespace {

constexpr int kWidth = 20, kLayers = 80;

/// A crystal that rides on the plate; every second layer moves sideways at the plate's peak speed.
MemoryTrajectory riding(int frames) {
  TrajectoryInfo info;
  info.n_beads = kWidth * kLayers;
  info.columns.velocity = true;
  info.box.upper = Vec3(kWidth, 0.5, 80);
  MemoryTrajectory film(info);
  for (int f = 0; f < frames; ++f) {
    Frame frame;
    frame.step = f;
    frame.time = 0.05 * f;
    frame.plate_height = 2 * std::sin(frame.time);
    for (int k = 0; k < kWidth * kLayers; ++k) {
      const int layer = k / kWidth;
      frame.position.emplace_back(0.5 + k % kWidth * 0.95 + 0.25 * (layer % 2), 0,
                                  2 + 0.9 * layer + frame.plate_height);
      frame.velocity.emplace_back(layer % 2 == 0 ? 2 : 0, 0, 2 * std::cos(frame.time));
    }
    film.append(frame);
  }
  return film;
}

imaging::CameraOptions camera_with(const std::string& what) {
  imaging::CameraOptions o;
  if (what == "motion") o.exposure = 0.05;
  if (what == "lens") o.distortion = -0.03, o.rotation_deg = 2;
  if (what == "glare") o.glare = 0.6;
  return o;
}

void expose(benchmark::State& state, const char* what) {
  const MemoryTrajectory film = riding(3);
  const imaging::SyntheticCamera camera(camera_with(what), film.info());
  const imaging::Exposure exposure{&film.frames()[0], &film.frames()[1], &film.frames()[2]};
  for (auto _ : state) benchmark::DoNotOptimize(camera.expose(exposure));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(expose, still, "still")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(expose, motion, "motion")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(expose, lens, "lens")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(expose, glare, "glare")->Unit(benchmark::kMillisecond);

void render_frames(benchmark::State& state, const char* what) {
  constexpr int kFrames = 100;
  const MemoryTrajectory film = riding(kFrames);
  const auto folder = std::filesystem::temp_directory_path() / "twincell-camera-bench";
  for (auto _ : state)
    imaging::render(
        film, camera_with(what),
        imaging::RenderJob{.folder = folder,
                           .threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))});
  std::filesystem::remove_all(folder);
  state.counters["frames"] =
      benchmark::Counter(kFrames * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(render_frames, still, "still")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(render_frames, motion, "motion")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace twincell

BENCHMARK_MAIN();
