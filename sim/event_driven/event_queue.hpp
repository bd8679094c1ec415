#pragma once
/// \file
/// Event queue of the event-driven solver (event_driven_solver.hpp): the next event of each bead, and the
/// earliest of all.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace twincell::sim {

/// Next event of a bead: touch of another bead or a wall, a repeated search, or no event.
struct Event {
  enum class Kind { touch, wall, look_again, none };
  double time = HUGE_VAL;  ///< t0
  Kind kind = Kind::none;
  std::int32_t partner = -1;  ///< the other bead of a touch, or -1 - w for wall w
};

/// The next event of each bead. Times and partners have arrays of their own, because each search scans all of
/// them.
class EventQueue {
 public:
  /// Sets the number of beads; no bead has an event.
  void clear(std::size_t beads) {
    times_.assign(beads, HUGE_VAL), kinds_.assign(beads, Event::Kind::none), partners_.assign(beads, -1);
  }
  [[nodiscard]] std::size_t size() const { return times_.size(); }
  [[nodiscard]] Event operator[](std::size_t i) const { return {times_[i], kinds_[i], partners_[i]}; }
  /// Replaces the event of bead i.
  void put(std::size_t i, const Event& e) {
    times_[i] = e.time, kinds_[i] = e.kind, partners_[i] = e.partner;
  }
  /// The bead with the earliest event; of several simultaneous events, the bead with the lowest index.
  [[nodiscard]] std::size_t soonest() const {
    const double first =
        Eigen::Map<const Eigen::ArrayXd>(times_.data(), static_cast<Eigen::Index>(times_.size())).minCoeff();
    return static_cast<std::size_t>(std::find(times_.begin(), times_.end(), first) - times_.begin());
  }
  /// To be called when bead `changed` has a new path. Beads that were due to touch it on the old path search
  /// again at the time of that touch. Until then, any other touch they may have is an event of the other
  /// bead.
  void put_off(std::size_t changed) {
    const auto bead = static_cast<std::int32_t>(changed);
    for (std::size_t k = 0; k < partners_.size(); ++k) {
      if (partners_[k] != bead ||
          (partners_[changed] == static_cast<std::int32_t>(k) && times_[changed] == times_[k]))
        continue;
      kinds_[k] = Event::Kind::look_again, partners_[k] = -1;
    }
  }
  /// Moves the origin of time to t = `by`, t0.
  void set_back(double by) {
    for (double& t : times_) t -= by;
  }

 private:
  std::vector<double> times_;
  std::vector<Event::Kind> kinds_;
  std::vector<std::int32_t> partners_;
};

}  // namespace twincell::sim
