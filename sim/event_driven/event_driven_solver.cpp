#include "sim/event_driven/event_driven_solver.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "sim/event_driven/checkpoint_archive.hpp"
#include "sim/event_driven/event_loop.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

// Initial interval, in contact times, between attempts to start event-driven motion. It doubles when an
// attempt fails: three bodies stay together for one or two contact times, and an attempt costs as much as a
// hundred steps.
constexpr double kLookAfter = 2;
constexpr std::int64_t kLookSeldom = 1024;  // steps

class EventDrivenSolver : public Solver {
 public:
  EventDrivenSolver(const Plan& plan, const GuardLimits& limits, SteppingSolvers steps)
      : plan_(plan),
        limits_(limits),
        look_every_(std::clamp<std::int64_t>(std::llround(kLookAfter * plan.shortest().time / plan.dt), 8,
                                             kLookSeldom)),
        make_steps_(std::move(steps)),
        steps_(make_steps_.all()) {}

  void advance(System& s, std::int64_t steps) override {
    if (s.beads.empty() || steps <= 0) {
      s.step += std::max<std::int64_t>(0, steps);
      return;
    }
    if (is_event_driven() && !is_as_left(s)) {
      loop_.reset();  // the caller changed a bead, the clock or the plate
      steps_ = make_steps_.all();
    }
    if (!is_event_driven() && s.step < next_look_ - kLookSeldom)
      next_look_ = 0;  // the step count was reset to an earlier value
    const std::int64_t last = s.step + steps;
    while (s.step < last) {
      if (!is_event_driven())
        step(s, last);
      else if (!loop_->advance(s, last))
        pass_to_steps(s);
    }
    if (is_event_driven()) {
      loop_->write(s);
      check_motion(s, limits_);
      mark_as_left(s);
    }
  }
  [[nodiscard]] std::int64_t list_builds() const override {
    return list_builds_ + (steps_ ? steps_->list_builds() : 0);
  }
  void rebuild_every(std::int64_t n) override {
    if (steps_) steps_->rebuild_every(n);
  }
  [[nodiscard]] std::vector<ContactMemory> contacts() const override {
    return steps_ ? steps_->contacts() : loop_->memories();
  }
  void restore(std::vector<ContactMemory> contacts) override {
    if (steps_) steps_->restore(std::move(contacts));
  }
  [[nodiscard]] std::vector<double> memory() const override {
    ArchiveWriter out;
    out(is_event_driven() ? 1.0 : 0.0), out(next_look_), out(wait_);
    if (is_event_driven()) loop_->save(out);
    return out.numbers;
  }
  void recall(const System& s, const std::vector<double>& memory) override {
    if (memory.empty()) return;
    ArchiveReader in{memory};
    double event_driven = 0;
    in(event_driven), in(next_look_), in(wait_);
    if (event_driven == 0) return;
    loop_.emplace(plan_, limits_, s, make_steps_.few);
    steps_.reset();
    mark_as_left(s);
    loop_->load(in);
    // Contact memories follow from what was loaded; they are asked for before the next advance.
    System at = s;
    loop_->write(at);
  }
  [[nodiscard]] std::string description() const override {
    return "free flight between contacts; where three bodies meet: " + make_steps_.few()->description();
  }
  [[nodiscard]] Footprint footprint() const override {
    if (steps_) return steps_->footprint();
    return loop_->footprint();
  }
  [[nodiscard]] Counters counters() const override {
    Counters c = steps_ ? steps_->counters() : Counters{};
    c.steps += counted_.steps, c.pair_visits += counted_.pair_visits, c.wall_visits += counted_.wall_visits,
        c.near_refreshes += counted_.near_refreshes;
    c.bytes = 0;  // those of the motion between contacts are not counted
    return c;
  }

 private:
  [[nodiscard]] bool is_event_driven() const { return loop_.has_value(); }
  void mark_as_left(const System& s) {
    left_ = s.beads;
    left_step_ = s.step;
    left_amplitude_ = s.drive.amplitude;
  }
  [[nodiscard]] bool is_as_left(const System& s) const {
    return s.step == left_step_ && s.drive.amplitude == left_amplitude_ && s.beads.size() == left_.size() &&
           std::memcmp(s.beads.data(), left_.data(), left_.size() * sizeof(Bead)) == 0;
  }

  // --- time steps, and the change to event-driven motion ---

  void step(System& s, std::int64_t last) {
    if (next_look_ <= s.step) {
      if (begin_event_driven(s)) {
        wait_ = look_every_;
        return;
      }
      // At multiples of the wait, so that the steps are the same however the run is divided into calls.
      wait_ = next_look_ == 0 ? look_every_ : std::min(kLookSeldom, 2 * wait_);
      next_look_ = (s.step / wait_ + 1) * wait_;
    }
    const std::int64_t n = std::min(last, next_look_) - s.step;
    steps_->advance(s, n);
  }

  /// Changes from time steps to event-driven motion. \returns false, with nothing changed, if three bodies
  /// meet
  bool begin_event_driven(const System& s) {
    const std::size_t n = s.beads.size();
    std::vector<std::int32_t> touching(n, 0);
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    const Vec3 plate = s.plate_displacement();
    for (std::size_t w = 0; w < s.walls.size(); ++w) {
      const Wall& wall = s.walls[w];
      const double offset = wall.offset + (wall.moves ? wall.n.dot(plate) : 0);
      for (std::size_t i = 0; i < n; ++i)
        if (wall.n.dot(centre_of(s.beads[i])) - offset < s.beads[i].radius) {
          if (++touching[i] > 1) return false;
          pairs.emplace_back(static_cast<std::int32_t>(i), -1 - static_cast<std::int32_t>(w));
        }
    }
    bool crowded = false;
    const auto touch = [&](std::int32_t i, std::int32_t j) {
      crowded = crowded || ++touching[static_cast<std::size_t>(i)] > 1 ||
                ++touching[static_cast<std::size_t>(j)] > 1;
      pairs.emplace_back(i, j);
    };
    for_each_near_pair(s.beads, s.dimension, s.period, 0,
                       [&](std::int32_t i, std::int32_t j, double, const Vec3&) { touch(i, j); });
    // A contact in progress has a stretched spring, but collisions are integrated from an unstretched one.
    if (crowded || (plan_.history && !pairs.empty())) return false;
    loop_.emplace(plan_, limits_, s, make_steps_.few);
    if (!loop_->begin(pairs)) {
      loop_.reset();
      return false;
    }
    counted_ = counters();
    list_builds_ = list_builds();
    steps_.reset();
    return true;
  }
  /// Changes from event-driven motion to time steps.
  void pass_to_steps(System& s) {
    loop_->write(s);
    steps_ = make_steps_.all();
    steps_->restore(loop_->memories());
    loop_.reset();
    wait_ = look_every_;
    next_look_ = (s.step / wait_ + 1) * wait_;
  }

  Plan plan_;
  GuardLimits limits_;
  std::int64_t look_every_;
  SteppingSolvers make_steps_;
  // One of them exists: time steps or event-driven motion.
  std::unique_ptr<Solver> steps_;
  std::optional<EventLoop> loop_;
  std::int64_t next_look_ = 0, wait_ = 1;
  Counters counted_;
  std::int64_t list_builds_ = 0;
  // The system at the end of the last call.
  std::vector<Bead> left_;
  std::int64_t left_step_ = -1;
  double left_amplitude_ = 0;
};

}  // namespace

std::unique_ptr<Solver> make_event_driven_solver(const Plan& plan, const GuardLimits& limits,
                                                 SteppingSolvers steps) {
  return std::make_unique<EventDrivenSolver>(plan, limits, std::move(steps));
}

}  // namespace twincell::sim
