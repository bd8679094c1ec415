#include "cli/import_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.hpp"
#include "core/plural.hpp"
#include "trajectory/spacing.hpp"

namespace twincell::cli {

void WatchedImport::watch_plate(const Frame& frame) {
  if (!info_.drive || info_.drive->axis != Axis::z) return;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i)) continue;
    ++all_;
    below_ += frame.position[i].z() < frame.plate_height ? 1 : 0;
  }
}

void WatchedImport::watch_steps(const Frame& frame) {
  constexpr double kFarthest = 10, kOfMedian = 50;  // sigma; median step of the frame
  const double time = frame.time - before_.time;
  std::vector<double> steps;
  std::vector<std::size_t> beads;
  for (std::size_t i = 0; i < std::min(frame.position.size(), before_.position.size()); ++i) {
    if (!frame.present(i) || !before_.present(i)) continue;
    const double step = (frame.position[i] - before_.position[i]).norm();
    if (!std::isfinite(step)) continue;
    steps.push_back(step);
    beads.push_back(i);
    if (i >= frame.velocity.size() || i >= before_.velocity.size()) continue;
    const Vec3 move = frame.position[i] - before_.position[i],
               path = 0.5 * time * (frame.velocity[i] + before_.velocity[i]);
    if (!path.allFinite()) continue;
    moved_ += step * step;
    by_velocity_ += path.squaredNorm();
    moves_.noalias() += move * move.transpose();
    paths_.noalias() += path * path.transpose();
    both_.noalias() += move * path.transpose();
  }
  if (steps.empty()) return;
  const double typical = upper_median(steps);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!(steps[k] > kFarthest && steps[k] > kOfMedian * typical)) continue;
    if (jumps_++ > 0) continue;
    jumped_ = beads[k];
    jump_ = {before_.step, frame.step};
    jump_length_ = steps[k];
  }
}

void WatchedImport::watch_doubles(const Frame& frame) {
  const double smallest =
      info_.radius.empty() ? kUsualRadius : *std::min_element(info_.radius.begin(), info_.radius.end());
  if (!(smallest > 0)) return;
  const std::size_t here = listed_again(frame.position, kSameBead * 2 * smallest);
  if (doubled_ == 0) doubled_step_ = frame.step;
  doubled_ += here;
}

void WatchedImport::append(const Frame& frame) {
  watch_plate(frame);
  watch_doubles(frame);
  if (frames_++ > 0) watch_steps(frame);
  before_ = frame;
  writer_.append(frame);
}

std::string WatchedImport::turned_velocities() const {
  constexpr double kClearly = 0.7;  // correlation of moves and velocities
  const auto correlation = [&](int move, int path) {
    const double size = std::sqrt(moves_(move, move) * paths_(path, path));
    return size > 0 ? both_(move, path) / size : 0.0;
  };
  for (const int axis : {0, 1, 2})
    if (correlation(axis, axis) < -kClearly)
      return fmt::format(
          "along {} the beads move against their velocities: the velocities have another sign than the "
          "positions.",
          "xyz"[axis]);
  for (const int axis : {0, 1, 2})
    for (const int other : {0, 1, 2})
      if (other < axis && std::abs(correlation(axis, other)) > kClearly &&
          std::abs(correlation(other, axis)) > kClearly && correlation(axis, axis) < kClearly &&
          correlation(other, other) < kClearly)
        return fmt::format(
            "the beads move along {0} as their velocities along {1} say: {0} and {1} of the "
            "velocities are exchanged.",
            "xyz"[other], "xyz"[axis]);
  return {};
}

std::vector<std::string> WatchedImport::doubts() const {
  std::vector<std::string> doubts;
  constexpr double kMaxShareBelow = 0.002;
  if (static_cast<double>(below_) > kMaxShareBelow * static_cast<double>(all_))
    doubts.push_back(fmt::format(
        "{:.3g} % of the beads lie beneath the plate: the direction of y (--y-up), the origin, or amplitude, "
        "frequency or phase of the drive is wrong.",
        100 * static_cast<double>(below_) / static_cast<double>(all_)));
  // A bead cannot move further than along its path. With several frames in a cycle it moves nearly as far.
  constexpr double kTooFar = 1.5, kTooNear = 0.5;
  constexpr int kDense = 8;  // frames per cycle
  const double ratio = by_velocity_ > 0 ? std::sqrt(moved_ / by_velocity_) : 1;
  if (by_velocity_ == 0 && moved_ > 0) doubts.emplace_back("all velocities are 0, and the beads move.");
  if (ratio > kTooFar || (ratio < kTooNear && info_.phases_per_cycle >= kDense))
    doubts.push_back(fmt::format(
        "from frame to frame the beads move {:.3g} times as far as their velocities say: the unit of the "
        "velocities, or the time between frames (--timestep), is wrong.",
        ratio));
  if (const std::string turned = turned_velocities(); !turned.empty()) doubts.push_back(turned);
  if (doubled_ > 0)
    doubts.push_back(
        fmt::format("{}, the first in the frame of step {}, {} closer than {:g} diameters to another bead: "
                    "are beads listed twice?",
                    plural(doubled_, "bead"), doubled_step_, doubled_ == 1 ? "lies" : "lie", kSameBead));
  if (jumps_ > 0)
    doubts.push_back(fmt::format(
        "bead {} moves by {:.4g} bead diameters between the frames of the steps {} and {}{}, and the others "
        "hardly move.",
        jumped_, jump_length_, jump_[0], jump_[1],
        jumps_ > 1 ? fmt::format("; {} jumps of this kind", jumps_) : ""));
  return doubts;
}

}  // namespace twincell::cli
