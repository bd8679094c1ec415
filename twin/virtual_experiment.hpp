#pragma once
/// \file
/// Virtual experiment: a simulation is filmed by the synthetic camera, then located and tracked as an
/// experiment.

#include <algorithm>
#include <filesystem>

#include "analysis/runs/phase_diagram.hpp"
#include "core/progress.hpp"
#include "imaging/camera/options.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::twin {

/// The first `n` frames of a trajectory, as a trajectory.
class Beginning : public TrajectorySource {
 public:
  Beginning(const TrajectorySource& whole, std::size_t n)
      : whole_(whole), n_(std::min(n, whole.n_frames())) {}
  [[nodiscard]] const TrajectoryInfo& info() const override { return whole_.info(); }
  [[nodiscard]] std::size_t n_frames() const override { return n_; }
  void read(std::size_t index, Frame& frame) const override { whole_.read(index, frame); }
  [[nodiscard]] std::string name() const override { return whole_.name(); }

 private:
  const TrajectorySource& whole_;
  std::size_t n_;
};

/// Films a simulation and tracks the film as `track` does, with the cell description that the camera writes.
/// No frame is dropped or doubled, whatever `camera` states. The tracked trajectory is written to `tracked`
/// (H5MD). The frames are in a temporary folder next to it, which is removed at the end.
/// \param show its snapshots that are in the film receive their pictures and the camera (frame.step
/// identifies the frames)
/// \throws ConfigError, RunError as render(), InputError as track_stack()
void film_and_track(const TrajectorySource& simulation, const imaging::CameraOptions& camera,
                    const std::filesystem::path& tracked, int threads, analysis::Show& show,
                    Progress& progress = Progress::none());

}  // namespace twincell::twin
