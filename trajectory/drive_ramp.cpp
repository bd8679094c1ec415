#include "trajectory/drive_ramp.hpp"

#include <algorithm>
#include <cmath>

#include "core/constants.hpp"

namespace twincell {

namespace {

/// A ramp without its way back: lengths and changes.
struct Leg {
  double cycles, duration;   ///< n, D
  double omega, more_omega;  ///< omega_0, omega_1 - omega_0
  double linear, more;       ///< A_0 omega_0^power, and its change

  explicit Leg(const DriveRamp& r)
      : cycles(r.returns ? r.cycles / 2 : r.cycles),
        duration(2 * kTurn * cycles / (r.from.omega + r.to.omega)),
        omega(r.from.omega),
        more_omega(r.to.omega - r.from.omega),
        linear(r.from.amplitude * std::pow(r.from.omega, r.power)),
        more(r.to.amplitude * std::pow(r.to.omega, r.power) - linear) {}

  /// u at which c cycles of the leg are over: the root of omega_0 u + (omega_1 - omega_0) u^2/2 = 2 pi c/D,
  /// in the form that has no cancellation and holds for a constant frequency.
  [[nodiscard]] double part_at(double c) const {
    const double turns = kTurn * c / duration;
    return 2 * turns / (omega + std::sqrt(omega * omega + 2 * more_omega * turns));
  }
  [[nodiscard]] double cycles_at(double u) const {
    return duration * u * (omega + more_omega * u / 2) / kTurn;
  }
};

}  // namespace

DriveRamp::State DriveRamp::state(double at) const {
  const double c = at - first;
  const auto constant = [](const DriveLevel& level) { return State{level.amplitude, 0, 0, level.omega, 0}; };
  if (!(c > 0)) return constant(from);
  if (c >= cycles) return constant(end());
  const Leg leg(*this);
  const bool back = returns && c > leg.cycles;
  const double u = leg.part_at(back ? cycles - c : c), per = (back ? -1 : 1) / leg.duration;
  const double q = power, omega = leg.omega + leg.more_omega * u, linear = leg.linear + leg.more * u;
  const double omega_rate = leg.more_omega * per, linear_rate = leg.more * per;
  // A = L omega^-q, with L and omega linear in time.
  const double scale = std::pow(omega, -power);
  return {linear * scale, scale * (linear_rate - q * linear * omega_rate / omega),
          scale * omega_rate / omega * (-2 * q * linear_rate + q * (q + 1) * linear * omega_rate / omega),
          omega, omega_rate};
}

DriveLevel DriveRamp::level(double at) const {
  const State s = state(at);
  return {s.amplitude, s.omega};
}

double DriveRamp::time_at(double at) const {
  const double before = kTurn * first / from.omega, c = at - first;
  if (!(c > 0)) return kTurn * at / from.omega;
  const Leg leg(*this);
  const double whole = returns ? 2 * leg.duration : leg.duration;
  if (c >= cycles) return before + whole + kTurn * (c - cycles) / end().omega;
  if (returns && c > leg.cycles) return before + whole - leg.duration * leg.part_at(cycles - c);
  return before + leg.duration * leg.part_at(c);
}

double DriveRamp::cycles_at(double time) const {
  const double t = time - kTurn * first / from.omega;
  if (!(t > 0)) return time * from.omega / kTurn;
  const Leg leg(*this);
  const double whole = returns ? 2 * leg.duration : leg.duration;
  if (t >= whole) return first + cycles + (t - whole) * end().omega / kTurn;
  if (returns && t > leg.duration) return first + cycles - leg.cycles_at((whole - t) / leg.duration);
  return first + leg.cycles_at(t / leg.duration);
}

double DriveRamp::largest(int exponent) const {
  // A omega^exponent = L omega^m, m = exponent - power, with L and omega linear in u; its derivative is zero
  // where L' omega + m L omega' = 0.
  const Leg leg(*this);
  const double m = exponent - power;
  const auto value = [&](double u) {
    return (leg.linear + leg.more * u) * std::pow(leg.omega + leg.more_omega * u, m);
  };
  double most = std::max(value(0), value(1));
  const double bend = (1 + m) * leg.more * leg.more_omega;
  if (bend == 0) return most;
  const double u = -(leg.more * leg.omega + m * leg.linear * leg.more_omega) / bend;
  return u > 0 && u < 1 ? std::max(most, value(u)) : most;
}

double DriveRamp::rate_bound() const {
  const Leg leg(*this);
  const double slowest = std::min(from.omega, to.omega), scale = std::pow(slowest, -power);
  const double linear = std::max(leg.linear, leg.linear + leg.more);
  return scale * (std::abs(leg.more) + power * linear * std::abs(leg.more_omega) / slowest) / leg.duration;
}

const char* DriveRamp::linear_quantity() const {
  return power == 0 ? "the amplitude" : power == 1 ? "the peak velocity" : "Gamma";
}

}  // namespace twincell
