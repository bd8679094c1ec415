#pragma once
/// \file
/// What happens next to each bead that flies (event_driven_solver.hpp), and which of it comes first.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace twincell::sim {

/// What happens next to a bead.
struct Event {
  enum class Kind { touch, wall, look_again, none };
  double time = HUGE_VAL;
  Kind kind = Kind::none;
  std::int32_t partner = -1;  ///< bead that is touched, or -1 - w for wall w
};

/// The next event of each bead: times and partners lie together, since all of them are looked through.
class EventQueue {
 public:
  /// Nothing happens to any of `beads`.
  void clear(std::size_t beads) {
    times_.assign(beads, HUGE_VAL), kinds_.assign(beads, Event::Kind::none), partners_.assign(beads, -1);
  }
  [[nodiscard]] std::size_t size() const { return times_.size(); }
  [[nodiscard]] Event operator[](std::size_t i) const { return {times_[i], kinds_[i], partners_[i]}; }
  void put(std::size_t i, const Event& e) {
    times_[i] = e.time, kinds_[i] = e.kind, partners_[i] = e.partner;
  }
  /// The bead whose event comes first; of several the first.
  [[nodiscard]] std::size_t soonest() const {
    const double first =
        Eigen::Map<const Eigen::ArrayXd>(times_.data(), static_cast<Eigen::Index>(times_.size())).minCoeff();
    return static_cast<std::size_t>(std::find(times_.begin(), times_.end(), first) - times_.begin());
  }
  /// Bead `changed` has a new line: those that were to touch it on the old one look again when they would
  /// have; until then nothing happens to them that is not foreseen from the other side.
  void put_off(std::size_t changed) {
    const auto bead = static_cast<std::int32_t>(changed);
    for (std::size_t k = 0; k < partners_.size(); ++k) {
      if (partners_[k] != bead ||
          (partners_[changed] == static_cast<std::int32_t>(k) && times_[changed] == times_[k]))
        continue;
      kinds_[k] = Event::Kind::look_again, partners_[k] = -1;
    }
  }
  /// The clock shows `by` less.
  void set_back(double by) {
    for (double& t : times_) t -= by;
  }

 private:
  std::vector<double> times_;
  std::vector<Event::Kind> kinds_;
  std::vector<std::int32_t> partners_;
};

}  // namespace twincell::sim
