#include "analysis/motion/bed_flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "core/constants.hpp"
#include "trajectory/plate.hpp"

namespace twincell::analysis {
namespace {

constexpr NamedResult kResults[] = {{.name = "flight_time", .range = Range::not_negative, .main = true},
                                    {.name = "flight_share", .range = Range::share}};

const char* const kSource = "Mehta & Luck 1990, the completely inelastic case";
const char* const kNoCycle = "no whole cycle after the first contact with the plate";
/// Support, in weights of the bed, above which a bed is thrown off. A bed that rests on the plate is
/// supported with less than its weight before it leaves.
constexpr double kThrowingSupport = 2;
/// Take-off speed relative to the plate, in units of the plate's peak velocity, above which a bed is thrown
/// off.
constexpr double kThrownSpeed = 0.1;
/// Support, in weights of the bed, from which a single instant ends a flight.
constexpr double kLandingSupport = 0.75;
constexpr int kMinPhases = 8;
constexpr int kInstantsPerCycle = 20;  ///< instants per cycle from which second differences are taken

/// Height of the centre of mass at one instant.
struct Instant {
  std::int64_t tick = 0;  ///< cycle N_k + phase
  double time = 0, height = 0;
};

/// Least-squares parabola z = a + b s - g s^2/2 through the instants from a given time on. The time s is
/// counted from the first instant, so that the sums lose no precision.
class Parabola {
 public:
  /// \pre at least two instants with different times
  Parabola(const std::vector<Instant>& instants, double from, double gravity)
      : origin_(instants.front().time), gravity_(gravity) {
    double n = 0, t = 0, tt = 0, y = 0, ty = 0;
    for (const Instant& m : instants) {
      if (m.time < from) continue;
      const double s = m.time - origin_, v = m.height + gravity_ * s * s / 2;
      n += 1, t += s, tt += s * s, y += v, ty += s * v;
    }
    b_ = (n * ty - t * y) / (n * tt - t * t);
    a_ = (y - b_ * t) / n;
  }
  [[nodiscard]] double velocity(double time) const { return b_ - gravity_ * (time - origin_); }
  [[nodiscard]] double height(double time) const {
    const double s = time - origin_;
    return a_ + b_ * s - gravity_ * s * s / 2;
  }

 private:
  double origin_, gravity_, a_ = 0, b_ = 0;
};

/// Bisection: the point between `holds`, where the condition is true, and `not_any_more`, where it is false,
/// at which the condition becomes false.
template <class Condition>
double boundary(double holds, double not_any_more, const Condition& condition) {
  constexpr int kHalvings = 30;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (holds + not_any_more) / 2;
    (condition(middle) ? holds : not_any_more) = middle;
  }
  return not_any_more;
}

class BedFlight : public Observable {
 public:
  explicit BedFlight(const AnalysisContext& context)
      : info_(context.info),
        stride_(std::max<std::int64_t>(
            1, std::llround(static_cast<double>(context.info.phases_per_cycle) / kInstantsPerCycle))) {
    if (!info_.drive || !info_.drive->moves())
      reason_ = "the trajectory does not state its drive";
    else if (info_.drive->axis != Axis::z)
      reason_ = "the drive is not along z";
    else if (!info_.columns.phase || info_.phases_per_cycle < kMinPhases)
      reason_ = fmt::format("the detection of flights needs at least {} frames per cycle", kMinPhases);
    if (!reason_.empty()) return;
    gravity_ = info_.drive->gravity * info_.drive->downward_share;
    if (!(gravity_ > 0)) reason_ = "gravity does not pull the bed onto the plate";
  }

  void add(const FrameView& view) override {
    const Frame& frame = view.frame();
    if (!reason_.empty() || frame.phase < 0 || frame.cycle < 0) return;
    if (plate_rests(info_, frame)) {
      reason_ = "the plate rests";
      return;
    }
    if (!rise(frame)) return;
    const Instant now{frame.cycle * info_.phases_per_cycle + frame.phase, frame.time, height_};
    // Gap in the film: a flight in progress before the gap is discarded.
    if (!last_.empty() && now.tick != last_.back().tick + 1) {
      last_.clear();
      since_.reset();
      in_cycle_ = 0;
      flight_.clear();
      doubtful_.reset();
    }
    last_.push_back(now);
    if (last_.size() < static_cast<std::size_t>(2 * stride_ + 1)) return;
    const Instant &before = last_.front(), &middle = last_[static_cast<std::size_t>(stride_)];
    const double step = (now.time - before.time) / 2;
    judge(middle, 1 + (before.height - 2 * middle.height + now.height) / (step * step * gravity_));
    last_.pop_front();
  }

  [[nodiscard]] std::vector<Result> results() const override {
    if (!reason_.empty())
      return {absent_result("flight_time", reason_, kSource),
              absent_result("flight_share", reason_, kSource)};
    const std::string rule = fmt::format(
        "from the parabola of the centre of mass while the plate carries less than {:g} of the bed's weight",
        kFlyingSupport);
    return {
        mean_of(durations_,
                {.name = "flight_time",
                 .unit = "t0",
                 .n_of = "flights",
                 .convention = "mean duration of a flight, " + rule,
                 .source = kSource},
                share_.n() == 0 ? kNoCycle : "the bed did not leave the plate"),
        mean_of(share_,
                {.name = "flight_share",
                 .unit = "1",
                 .n_of = "cycles",
                 .convention = "share of the time in flight, each flight counted in the cycle in which it "
                               "ends; " +
                               rule,
                 .source = kSource},
                kNoCycle)};
  }

 private:
  /// Adds to the height the mean rise of the beads that are present in this frame and in the previous one.
  /// The centre of mass of all detected beads would jump whenever a bead appears or disappears. \returns true
  /// if there is such a bead, or if this is the first frame
  bool rise(const Frame& frame) {
    double moved = 0, mass = 0;
    const bool first = before_.empty();
    before_.resize(frame.position.size(), kNaN);
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      const double z = frame.present(i) ? frame.position[i].z() : kNaN;
      const double m = mass_of(info_.mass, i);
      if (std::isfinite(z - before_[i])) moved += m * (z - before_[i]), mass += m;
      before_[i] = z;
    }
    if (mass > 0) height_ += moved / mass;
    return first || mass > 0;
  }

  /// Processes one instant, with the support in units of the bed's weight. A single instant with a small
  /// support in the midst of a flight belongs to it: the second difference of few beads is that uncertain,
  /// and a landing is a blow.
  void judge(const Instant& m, double support) {
    if (doubtful_) {
      const auto [instant, of_it] = *doubtful_;
      doubtful_.reset();
      if (support < kFlyingSupport)
        flight_.push_back(instant);
      else
        settle(instant, of_it);
    } else if (flight_.size() >= 2 && support >= kFlyingSupport && support < kLandingSupport) {
      doubtful_ = {m, support};
      return;
    }
    settle(m, support);
  }

  void settle(const Instant& m, double support) {
    if (support < kFlyingSupport) {
      if (flight_.empty()) thrown_ = std::max(carried_[0], carried_[1]) > kThrowingSupport;
      flight_.push_back(m);
    } else {
      if (since_ && flight_.size() >= 2) land(m.time);
      // Cycles are counted from the first instant on the plate, so that a flight cut off by the beginning of
      // the film adds neither a flight nor time.
      if (!since_) since_ = m.tick;
      carried_ = {carried_[1], support};
      flight_.clear();
    }
    while (since_ && m.tick - *since_ >= info_.phases_per_cycle) {
      share_.add(in_cycle_ / period_at(m.time));
      in_cycle_ = 0;
      *since_ += info_.phases_per_cycle;
    }
  }

  /// Length of a cycle at `time`, t0.
  [[nodiscard]] double period_at(double time) const {
    return info_.drive->at(info_.drive->cycles_at(time)).period();
  }

  /// Calls a function of Drive at `time`.
  [[nodiscard]] double plate(double (Drive::*function)(double, std::int64_t) const, double time) const {
    const double turns = info_.drive->cycles_at(time), whole = std::floor(turns);
    return (*info_.drive.*function)(turns - whole, static_cast<std::int64_t>(whole));
  }

  /// Evaluates a flight that has ended before `carried`, the first instant at which the plate supports the
  /// bed again.
  void land(double carried) {
    const double frame = carried - flight_.back().time, reach = static_cast<double>(stride_) * frame,
                 fine = frame / 32;
    Parabola path(flight_, -HUGE_VAL, gravity_);
    auto take_off = taken_off(path, reach, frame);
    if (!take_off) return;
    // At the first instants the plate may still have supported part of the weight. The second fit leaves them
    // out.
    if (flight_.end()[-2].time > *take_off) {
      path = Parabola(flight_, *take_off, gravity_);
      take_off = taken_off(path, reach, frame);
      if (!take_off) return;
    }
    // Landing: the first later instant at which the parabola is at its take-off height above the plate.
    const double least = above(path, *take_off), latest = carried + reach;
    double landing = std::max(*take_off + 2 * fine, flight_.back().time - reach);
    while (landing < latest && above(path, landing) > least) landing += fine;
    if (landing < latest)
      landing = boundary(landing - fine, landing, [&](double t) { return above(path, t) > least; });
    durations_.add(landing - *take_off);
    in_cycle_ += landing - *take_off;
    landed_ = landing;
  }

  /// Height of the parabola above the plate.
  [[nodiscard]] double above(const Parabola& path, double t) const {
    return path.height(t) - plate(&Drive::displacement, t);
  }

  /// Take-off time of the flight. Absent if the bed cannot have left the plate.
  [[nodiscard]] std::optional<double> taken_off(const Parabola& path, double reach, double frame) const {
    const double first = flight_.front().time, fine = frame / 32;
    // A bed that rested on the plate has h' = h'' = 0 at take-off. Noise separates the two zeros, or keeps h'
    // positive so that it has no zero. The later of the two zeros is then the best estimate.
    const auto rises = [&](double t) { return path.velocity(t) - plate(&Drive::velocity, t); };
    const auto leaves = [&](double t) { return rises(t) > 0 && plate(&Drive::acceleration, t) < -gravity_; };
    const double earliest = std::max(first - 2 * reach, landed_);
    double inside = first + reach;
    if (!thrown_)
      while (inside < flight_.back().time && !leaves(inside)) inside += fine;
    double take_off = inside;
    while (take_off > earliest && leaves(take_off)) take_off -= fine;
    if (take_off < inside) take_off = boundary(take_off + fine, take_off, leaves);
    const bool fast = thrown_ && rises(take_off) > kThrownSpeed * info_.drive->velocity_bound();
    if (take_off < inside && take_off > earliest && !fast) return take_off;
    // A resting bed does not leave a plate whose downward acceleration is below g. A thrown bed may leave at
    // any phase; the second differences contain the throw up to this time.
    if (!thrown_) return std::nullopt;
    return std::max(first - reach - frame / 2, landed_);
  }

  const TrajectoryInfo& info_;
  std::int64_t stride_;
  std::string reason_;
  double gravity_ = 1;          ///< component along -z, which brings the bed back to the plate
  double height_ = 0;           ///< of the centre of mass, relative to the first frame
  std::vector<double> before_;  ///< height of each bead in the last frame; NaN if it was not detected
  std::deque<Instant> last_;
  std::optional<std::int64_t> since_;  ///< first tick of the current cycle
  double in_cycle_ = 0;                ///< total duration of the flights that ended in the current cycle
  std::vector<Instant> flight_;        ///< instants of the current flight
  std::optional<std::pair<Instant, double>> doubtful_;  ///< after flight_: an instant and its small support
  double landed_ = -HUGE_VAL;                           ///< end of the previous flight
  std::array<double, 2> carried_{};                     ///< support at the last two instants on the plate
  bool thrown_ = false;                                 ///< the current flight began with a throw
  SeriesAverage durations_, share_;
};

}  // namespace

constinit const ObservableEntry bed_flight_observable = {kResults, &make_observable<BedFlight>};

}  // namespace twincell::analysis
