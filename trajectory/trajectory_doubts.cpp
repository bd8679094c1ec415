#include "trajectory/trajectory_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.hpp"
#include "core/plural.hpp"
#include "trajectory/spacing.hpp"

namespace twincell {

namespace {
/// Distance of two centres, in diameters of the smallest bead, below which their overlap is not elastic.
constexpr double kDeepOverlap = 0.8;

/// How many beads of a frame moved by more than half a bead diameter to where another bead was in the frame
/// before, whatever all of them moved by. A bead in motion rarely meets such a place.
std::size_t exchanged_places(const Frame& before, const Frame& now) {
  constexpr double kMoved = 0.5, kThere = 0.15;  // sigma
  constexpr double kMinShare = 0.3;  // of the beads, which have to move before places are searched
  std::vector<Vec3> from, moves;
  Vec3 common = Vec3::Zero();  // an exchange leaves the mean where it is
  for (std::size_t i = 0; i < std::min(before.position.size(), now.position.size()); ++i) {
    if (!before.present(i) || !now.present(i)) continue;
    from.push_back(before.position[i]);
    moves.emplace_back(now.position[i] - before.position[i]);
    common += moves.back();
  }
  if (from.empty()) return 0;
  common /= static_cast<double>(from.size());
  std::vector<Vec3> places = from;
  for (std::size_t k = 0; k < from.size(); ++k)
    if ((moves[k] - common).norm() > kMoved) places.push_back(from[k] + moves[k] - common);
  if (static_cast<double>(places.size() - from.size()) < kMinShare * static_cast<double>(from.size()))
    return 0;
  return listed_again(places, kThere) - listed_again(from, kThere);
}

}  // namespace

void TrajectoryDoubts::watch_plate(const Frame& frame) {
  if (!info_.drive || info_.drive->axis != Axis::z) return;
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    if (!frame.present(i)) continue;
    ++all_;
    below_ += frame.position[i].z() < frame.plate_height ? 1 : 0;
  }
}

void TrajectoryDoubts::watch_steps(const Frame& frame) {
  constexpr double kFarthest = 10, kOfMedian = 50;  // sigma; median step of the frame
  constexpr double kExchanged = 0.5;                // of the beads
  if (const std::size_t exchanged = exchanged_places(before_, frame);
      static_cast<double>(exchanged) > kExchanged * static_cast<double>(frame.n_present())) {
    if (exchanges_++ == 0) exchanged_ = exchanged, exchange_ = {before_.step, frame.step};
    return;
  }
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

void TrajectoryDoubts::watch_spacing(const Frame& frame) {
  double smallest = info_.radius.empty() ? kUsualRadius : HUGE_VAL;
  for (const double radius : info_.radius)
    if (radius > 0) smallest = std::min(smallest, radius);
  if (!std::isfinite(smallest)) return;
  const std::size_t here = listed_again(frame.position, kSameBead * 2 * smallest);
  if (doubled_ == 0) doubled_step_ = frame.step;
  doubled_ += here;
  spaced_ += frame.n_present();
  deep_ += listed_again(frame.position, kDeepOverlap * 2 * smallest);
}

void TrajectoryDoubts::watch(const Frame& frame) {
  watch_plate(frame);
  watch_spacing(frame);
  if (frames_++ > 0) watch_steps(frame);
  before_ = frame;
}

std::string TrajectoryDoubts::turned_velocities() const {
  constexpr double kClearly = 0.7;  // correlation of moves and velocities
  const auto correlation = [&](int move, int path) {
    const double size = std::sqrt(moves_(move, move) * paths_(path, path));
    return size > 0 ? both_(move, path) / size : 0.0;
  };
  for (const int axis : {0, 1, 2})
    if (correlation(axis, axis) < -kClearly)
      return fmt::format(
          "along {} the beads move against their velocities: the velocities have another sign than the "
          "positions",
          "xyz"[axis]);
  for (const int axis : {0, 1, 2})
    for (const int other : {0, 1, 2})
      if (other < axis && std::abs(correlation(axis, other)) > kClearly &&
          std::abs(correlation(other, axis)) > kClearly && correlation(axis, axis) < kClearly &&
          correlation(other, other) < kClearly)
        return fmt::format(
            "the beads move along {0} as their velocities along {1} say: {0} and {1} of the "
            "velocities are exchanged",
            "xyz"[other], "xyz"[axis]);
  return {};
}

std::vector<std::string> TrajectoryDoubts::doubts_of_velocities() const {
  std::vector<std::string> doubts;
  if (by_velocity_ == 0 && moved_ > 0) doubts.emplace_back("all velocities are 0, and the beads move");
  const double ratio = by_velocity_ > 0 ? std::sqrt(moved_ / by_velocity_) : 1;
  // With N_k frames per cycle a bead on the plate moves tan(x)/x times its mean velocity, x = pi/N_k: 1.65 at
  // N_k = 3, and without bound at 2.
  constexpr double kTooFar = 1.5, kTooNear = 0.5;
  constexpr int kSome = 5, kDense = 8;  // frames per cycle
  const int phases = info_.phases_per_cycle;
  if ((ratio > kTooFar && (phases == 0 || phases >= kSome)) || (ratio < kTooNear && phases >= kDense))
    doubts.push_back(fmt::format(
        "from frame to frame the beads move {:.3g} times as far as their velocities say: the unit of the "
        "velocities, or the time between frames (import --timestep), is wrong",
        ratio));
  if (const std::string turned = turned_velocities(); !turned.empty()) doubts.push_back(turned);
  return doubts;
}

std::vector<std::string> TrajectoryDoubts::sentences() const {
  std::vector<std::string> doubts;
  constexpr double kMaxShareBelow = 0.002;
  if (static_cast<double>(below_) > kMaxShareBelow * static_cast<double>(all_))
    doubts.push_back(fmt::format(
        "{:.3g} % of the beads lie beneath the plate: the direction of y (import --y-up), the origin, or "
        "amplitude, frequency or phase of the drive is wrong",
        100 * static_cast<double>(below_) / static_cast<double>(all_)));
  std::ranges::move(doubts_of_velocities(), std::back_inserter(doubts));
  constexpr double kMaxShareDeep = 0.2;
  if (static_cast<double>(deep_) > kMaxShareDeep * static_cast<double>(spaced_))
    doubts.push_back(fmt::format(
        "{:.3g} % of the beads overlap an earlier one by more than {:g} diameters: the radii may be "
        "diameters, or the unit of length is wrong",
        100 * static_cast<double>(deep_) / static_cast<double>(spaced_), 1 - kDeepOverlap));
  if (doubled_ > 0)
    doubts.push_back(
        fmt::format("{}, the first in the frame of step {}, {} closer than {:g} diameters to another bead: "
                    "beads may be listed twice",
                    plural(doubled_, "bead"), doubled_step_, doubled_ == 1 ? "lies" : "lie", kSameBead));
  if (exchanges_ > 0)
    doubts.push_back(fmt::format(
        "between the frames of the steps {} and {}, {} take the places of others{}: the numbers count "
        "the rows of a frame instead of beads, or the links are wrong",
        exchange_[0], exchange_[1], plural(exchanged_, "bead"),
        exchanges_ > 1 ? fmt::format(", and so between {} pairs of frames", exchanges_) : ""));
  if (jumps_ > 0)
    doubts.push_back(fmt::format(
        "bead {} moves by {:.4g} bead diameters between the frames of the steps {} and {}{}, and the others "
        "hardly move",
        jumped_, jump_length_, jump_[0], jump_[1],
        jumps_ > 1 ? fmt::format("; {} jumps of this kind", jumps_) : ""));
  return doubts;
}

std::vector<std::string> doubts_of(const TrajectorySource& trajectory, std::size_t frames) {
  TrajectoryDoubts doubts(trajectory.info());
  Frame frame;
  for (std::size_t f = 0; f < std::min(frames, trajectory.n_frames()); ++f) {
    trajectory.read(f, frame);
    doubts.watch(frame);
  }
  return doubts.sentences();
}

}  // namespace twincell
