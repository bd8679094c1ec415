#include "sim/event_driven/collision_with_memory.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <type_traits>
#include <variant>

#include "sim/laws/contact_laws.hpp"
#include "sim/laws/separate_integration.hpp"

namespace twincell::sim {

namespace {

/// One collision. Positions and velocities have three components; in 2D, y is unused.
template <class N>
class CollisionWithMemory {
 public:
  CollisionWithMemory(const CollisionSetting& setting, const N& normal, const SpringSlider& spring,
                      SlipReading reading)
      : set_(setting),
        c_n_(normal.constants(setting.pair)),
        k_t_(spring.k_t),
        eta_t_(spring.damping.eta(setting.pair.m_eff)),
        mu_(spring.mu),
        reading_(reading) {}

  CollisionEnd run(const RelativeMotion& start, double time, double last, double scale, int steps) {
    CollisionEnd end;
    const double longest = scale / steps, shortest = 1e-7 * longest;
    quickest_ = longest;
    State y = state(start);
    double t = time;
    mode_ = entered(t, y);
    note(y, t, end);
    // Where the force of a law is no polynomial of the overlap, steps that grow from the touch and shrink
    // towards the parting resolve it. A thousandth of a step is short enough: 1e-8 of the velocities.
    const bool root = begins_as_root(look(t, y));
    const double least_step = 1e-3 * longest;
    while (t < last) {
      double first = std::min(longest, last - t);
      if (root) first = std::min(first, graded(t - time, y, least_step));
      State whole = step(t, y, first);
      // The first event within the step. F_n = 0 is tested before the Coulomb limit, which is 0 there:
      // otherwise a force that jumps over the limit would be missed.
      Event what = Event::none;
      for (const Event e : {Event::parting, Event::turn, Event::hold, Event::limit}) {
        const double before = signal(e, t, y), after = signal(e, t + first, whole);
        if (!(after < 0)) continue;
        first = before > 0 ? crossing(e, t, y, first, before, after) : 0;
        whole = step(t, y, first);
        what = e;
      }
      y = whole;
      t += first;
      if (what == Event::parting) {
        end.parted = true;
        note(y, t, end);
        break;
      }
      // Mode after the event.
      if (what == Event::turn) mode_ = after_turn(t, y);
      if (what == Event::hold) mode_ = slide_along(-k_t_ * part(y, 3), y);
      if (what == Event::limit) mode_ = after_limit(t, y);
      if (what != Event::none && first < shortest) {
        // Leave the event with a small step in the new regime.
        y = step(t, y, shortest);
        t += shortest;
      }
      note(y, t, end);
    }
    end.time = t;
    end.motion = motion(y);
    if (const Instant m = look(t, y); mode_ == Mode::slide)
      end.xi = spring_for(m, friction(m));
    else if (mode_ != Mode::loose)
      end.xi = m.x;
    end.at_middle = motion(middle_);
    return end;
  }

  CollisionForce force(const RelativeMotion& at, const Vec3& xi) {
    State y = state(at);
    put(xi, 3, y);
    const Instant m = look(0, y);
    constexpr double kAtLimit = 1 - 1e-9;
    const bool held =
        reading_ == SlipReading::spring_limited && k_t_ * xi.norm() >= kAtLimit * limit(m) && limit(m) > 0;
    const Vec3 f_t = cut(held ? Vec3(-k_t_ * xi) : sticking_force(m), limit(m));
    return {m.f_n * m.n + f_t, m.n.cross(f_t), m.n};
  }

 private:
  /// r, u, s; then xi or, while the surfaces slide, the direction of the force.
  using State = std::array<double, 12>;
  enum class Mode {
    stick,  ///< the Coulomb limit does not bind
    slide,  ///< the limit binds and also limits the spring
    clip,   ///< the limit binds and the spring continues to stretch
    loose,  ///< the force is zero, because the law allows no tension
  };
  enum class Event {
    none,
    parting,
    turn,   ///< F_n vanishes
    hold,   ///< the spring alone reaches the limit (reading spring_limited)
    limit,  ///< the force reaches or leaves the limit
  };

  static Vec3 part(const State& y, std::size_t k) { return {y[3 * k], y[3 * k + 1], y[3 * k + 2]}; }
  static void put(const Vec3& v, std::size_t k, State& y) {
    for (std::size_t q = 0; q < 3; ++q) y[3 * k + q] = v[static_cast<Eigen::Index>(q)];
  }
  static State state(const RelativeMotion& m) {
    State y{};
    put(m.r, 0, y), put(m.u, 1, y), put(m.s, 2, y);
    return y;
  }
  static RelativeMotion motion(const State& y) { return {part(y, 0), part(y, 1), part(y, 2)}; }

  /// All quantities at one instant that do not depend on the mode.
  struct Instant {
    Vec3 r, u, s, x;
    Vec3 n, turning;  ///< normal and its rate
    double overlap, v_n, f_n;
    Vec3 v_t, push;
  };
  [[nodiscard]] double normal_force(double overlap, double v_n) const {
    return N::template force<double>(c_n_.data(), std::max(overlap, 0.0), v_n, nullptr);
  }
  [[nodiscard]] Instant look(double t, const State& y) const {
    Instant m;
    m.r = part(y, 0), m.u = part(y, 1), m.s = part(y, 2), m.x = part(y, 3);
    const double apart = set_.wall ? m.r.dot(*set_.wall) : m.r.norm();
    m.n = set_.wall ? *set_.wall : Vec3(m.r / apart);
    m.overlap = set_.reach - apart;
    m.v_n = m.u.dot(m.n);
    m.turning = set_.wall ? Vec3(Vec3::Zero()) : Vec3((m.u - m.v_n * m.n) / apart);
    m.f_n = normal_force(m.overlap, m.v_n);
    m.v_t = m.u - m.v_n * m.n - m.s.cross(m.n);
    m.push = set_.wall ? Vec3(set_.pull + set_.swing * std::sin(set_.omega * t)) : Vec3(Vec3::Zero());
    return m;
  }
  /// Whether the force begins at 0 and not in proportion to the overlap, as that of Hertz.
  [[nodiscard]] bool begins_as_root(const Instant& m) const {
    const double small = 1e-6 * set_.reach, once = normal_force(small, m.v_n),
                 twice = normal_force(2 * small, m.v_n);
    return m.overlap < small && normal_force(0, m.v_n) == 0 && std::abs(twice / once - 2) > 0.01;
  }
  /// Longest step where the force is a root of the overlap. \param since time since the touch
  [[nodiscard]] double graded(double since, const State& y, double least_step) const {
    constexpr double kStepShare = 0.5;
    const Instant m = look(0, y);
    const double left = m.v_n > 0 ? m.overlap / m.v_n : HUGE_VAL;
    return std::max(least_step, kStepShare * std::min(since, left));
  }
  [[nodiscard]] double limit(const Instant& m) const { return mu_ * std::abs(m.f_n); }
  /// Forces below this count as zero. Friction without a limit (mu = 1e9, for example) is then not cut at the
  /// instant at which F_n vanishes.
  [[nodiscard]] double least() const { return kZeroForceShare * mu_ * largest_; }
  [[nodiscard]] Vec3 sticking_force(const Instant& m) const { return -k_t_ * m.x - eta_t_ * m.v_t; }
  /// Bound of the rounding of the sticking force, whose parts cancel where a contact begins without a normal
  /// force. Its direction is then no direction.
  [[nodiscard]] double rounding(const Instant& m) const {
    return 1e-12 * (k_t_ * m.x.norm() + eta_t_ * m.v_t.norm());
  }
  static Vec3 cut(const Vec3& f, double most) {
    const double size = f.norm();
    return size > most ? Vec3(f * (most / size)) : f;
  }
  [[nodiscard]] Vec3 friction(const Instant& m) const {
    switch (mode_) {
      case Mode::stick:
        return sticking_force(m);
      case Mode::slide:
        return limit(m) * m.x.normalized();
      case Mode::clip:
        return sticking_force(m).normalized() * limit(m);
      case Mode::loose:
        break;
    }
    return Vec3::Zero();
  }
  struct Slopes {
    Vec3 u, s;
  };
  [[nodiscard]] Slopes slopes(const Instant& m, const Vec3& f_t) const {
    return {(m.f_n * m.n + f_t) / set_.pair.m_eff + m.push, -set_.turn * m.n.cross(f_t)};
  }
  /// Time derivative of the tangential velocity, in the tangent plane.
  [[nodiscard]] static Vec3 surface_rate(const Instant& m, const Slopes& d) {
    const Vec3 rate = d.u - m.v_n * m.turning - d.s.cross(m.n) - m.s.cross(m.turning);
    return rate - rate.dot(m.n) * m.n;
  }
  /// Rate at which the force would change if the spring only stretched.
  [[nodiscard]] Vec3 free_rate(const Instant& m, const Slopes& d) const {
    if (reading_ == SlipReading::spring_limited) return -k_t_ * m.v_t;
    return -k_t_ * m.v_t - eta_t_ * surface_rate(m, d);
  }
  /// Time derivative of F_n. The derivatives of the law are finite differences, with increments far above
  /// rounding.
  [[nodiscard]] double normal_rate(const Instant& m, const Slopes& d) const {
    const double v_dot = d.u.dot(m.n) + m.u.dot(m.turning);
    const double dx = 1e-6 * std::max(m.overlap, 1e-9), dv = 1e-6 * std::max(std::abs(m.v_n), 1e-6);
    const double by_overlap =
        (normal_force(m.overlap + dx, m.v_n) - normal_force(m.overlap - dx, m.v_n)) / (2 * dx);
    const double by_speed =
        (normal_force(m.overlap, m.v_n + dv) - normal_force(m.overlap, m.v_n - dv)) / (2 * dv);
    return -by_overlap * m.v_n + by_speed * v_dot;
  }

  void derive(const State& y, State& dy, double t) const {
    const Instant m = look(t, y);
    const Vec3 f_t = friction(m);
    const Slopes d = slopes(m, f_t);
    put(m.u, 0, dy), put(d.u, 1, dy), put(d.s, 2, dy);
    Vec3 x = Vec3::Zero();
    if (mode_ == Mode::slide) {
      // The spring follows the limit; the component of the rate across the force rotates the force. In 2D
      // nothing rotates. The component along the normal is dropped: it is rounding, and would be amplified
      // where F_n, and with it the limit, is small. There the direction relaxes to that of the rate within
      // one step, because the steps cannot resolve a faster rotation.
      const Vec3 direction = m.x.normalized(), rate = free_rate(m, d), across = m.n.cross(direction);
      const double size = std::max(limit(m), quickest_ * rate.norm());
      if (set_.dimension == 3 && size > 0) x = rate.dot(across) / size * across;
    } else if (mode_ != Mode::loose) {
      x = m.v_t;
    }
    put(x - m.turning.dot(m.x) * m.n, 3, dy);  // a tangential vector remains tangential and keeps its length
  }
  State step(double t, const State& y, double h) const {
    State to{};
    if (h <= 0) return y;
    boost::numeric::odeint::runge_kutta_fehlberg78<State> method;
    method.do_step([this](const State& a, State& b, double s) { derive(a, b, s); }, y, t, to, h);
    return to;
  }

  /// Becomes negative when the event happens.
  [[nodiscard]] double signal(Event e, double t, const State& y) const {
    const Instant m = look(t, y);
    switch (e) {
      case Event::parting:
        return m.v_n > 0 ? m.overlap : std::abs(m.overlap) + 1e-300;
      case Event::turn:
        if (mode_ == Mode::loose) return m.f_n > 0 ? -m.f_n : 1;
        return (pressed_ == (m.f_n > 0) ? 1 : -1) * std::max(std::abs(m.f_n), 1e-300);
      case Event::hold:
        if (reading_ != SlipReading::spring_limited || mode_ == Mode::slide || mode_ == Mode::loose) return 1;
        return std::max({limit(m), least(), rounding(m)}) - k_t_ * m.x.norm();
      case Event::limit:
        break;
      case Event::none:
        return 1;
    }
    switch (mode_) {
      case Mode::stick:
        return std::max({limit(m), least(), rounding(m)}) - sticking_force(m).norm();
      case Mode::clip:
        return sticking_force(m).norm() - limit(m);
      case Mode::slide: {
        const Slopes d = slopes(m, friction(m));
        return m.x.normalized().dot(free_rate(m, d)) - mu_ * (m.f_n > 0 ? 1 : -1) * normal_rate(m, d);
      }
      case Mode::loose:
        break;
    }
    return 1;
  }
  double crossing(Event e, double t, const State& y, double h, double g0, double g1) const {
    std::uintmax_t most = 100;
    const auto at = [&](double x) { return signal(e, t + x, step(t, y, x)); };
    const auto near = boost::math::tools::toms748_solve(
        at, 0.0, h, g0, g1, [h](double a, double b) { return b - a <= 4e-16 * h; }, most);
    return near.second;
  }

  // --- the mode after an event; the last three components of y are set for that mode ---

  /// Sliding along a force; along -v_t if it is 0.
  Mode slide_along(const Vec3& force, State& y) {
    const Vec3 along = force.norm() > 0 ? force : Vec3(-look(0, y).v_t);
    put(along.normalized(), 3, y);
    return Mode::slide;
  }
  /// Mode after the force has reached the limit: sliding, or sticking if the limit grows faster than the
  /// force.
  Mode settle(double t, const Vec3& force, const Vec3& spring, State& y) {
    const Instant m = look(t, y);
    const Slopes d = slopes(m, force);
    const Vec3 rate = free_rate(m, d);
    const double limit_rate = mu_ * (pressed_ ? 1 : -1) * normal_rate(m, d);
    const Vec3 along = force.norm() > 0 ? force : rate;
    if (along.norm() > 0 && along.normalized().dot(rate) > limit_rate) return slide_along(along, y);
    put(spring, 3, y);
    return Mode::stick;
  }
  /// The spring that gives a total tangential force `force`.
  [[nodiscard]] Vec3 spring_for(const Instant& m, const Vec3& force) const {
    if (k_t_ == 0) return Vec3::Zero();
    return -(force + (reading_ == SlipReading::spring_limited ? 0.0 : eta_t_) * m.v_t) / k_t_;
  }
  Mode entered(double t, State& y) {
    put(Vec3::Zero(), 3, y);
    const Instant m = look(t, y);
    pressed_ = m.f_n > 0 || (m.f_n == 0 && m.v_n < 0);
    const Vec3 force = sticking_force(m);
    const bool beyond = force.norm() > limit(m);
    if (reading_ == SlipReading::clip) return beyond ? Mode::clip : Mode::stick;
    if (!beyond) return Mode::stick;
    if (reading_ == SlipReading::spring_limited) return Mode::clip;
    const Vec3 cut_to = cut(force, limit(m));
    return settle(t, cut_to, spring_for(m, cut_to), y);
  }
  Mode after_limit(double t, State& y) {
    Instant m = look(t, y);
    if (mode_ == Mode::stick)
      return reading_ == SlipReading::rescale ? slide_along(sticking_force(m), y) : Mode::clip;
    if (mode_ == Mode::slide) {
      put(spring_for(m, friction(m)), 3, y);
      m = look(t, y);
      if (reading_ == SlipReading::spring_limited && sticking_force(m).norm() > limit(m)) return Mode::clip;
    }
    return Mode::stick;
  }
  /// Mode after F_n vanishes, and with it the Coulomb limit.
  Mode after_turn(double t, State& y) {
    pressed_ = !pressed_;
    const Instant m = look(t, y);
    if (mode_ == Mode::loose || reading_ == SlipReading::clip) return mode_;
    if (mode_ == Mode::stick && sticking_force(m).norm() < least()) return mode_;
    const bool pulls = normal_force(m.overlap, m.v_n + 1e-3 * std::abs(m.v_n) + 1e-12) < 0;
    if (!pressed_ && !pulls) {
      put(Vec3::Zero(), 3, y);
      return Mode::loose;
    }
    const Mode mode = settle(t, Vec3::Zero(), spring_for(m, Vec3::Zero()), y);
    return mode == Mode::stick && reading_ == SlipReading::spring_limited ? Mode::clip : mode;
  }

  void note(const State& y, double t, CollisionEnd& end) {
    const Instant m = look(t, y);
    largest_ = std::max(largest_, std::abs(m.f_n));
    if (m.overlap < end.deepest) return;
    end.deepest = m.overlap, end.middle = t, middle_ = y;
  }

  const CollisionSetting& set_;
  std::array<double, N::kConstants> c_n_;
  double k_t_, eta_t_, mu_;
  SlipReading reading_;
  static constexpr double kZeroForceShare = 1e-8;
  Mode mode_ = Mode::stick;
  bool pressed_ = true;
  double largest_ = 0;   ///< |F_n| so far
  double quickest_ = 0;  ///< t0, shortest time in which a sliding force rotates
  State middle_{};
};

template <class Visit>
bool visit_history(const ContactLaws& laws, Visit visit) {
  if (resists_rolling(laws)) return false;
  return std::visit(
      [&](const auto& normal, const auto& tangential) {
        using N = std::decay_t<decltype(normal)>;
        using T = std::decay_t<decltype(tangential)>;
        if constexpr (kRemembers<N, T>) {
          visit(normal, tangential);
          return true;
        } else {
          return false;
        }
      },
      laws.normal, laws.tangential);
}

}  // namespace

SlipReading reading_of(const ContactLaws& laws) {
  return std::visit(
      []<class Law>(const Law&) {
        if constexpr (requires { Law::kReading; })
          return Law::kReading;
        else
          return SlipReading::rescale;  // a law without a spring of constant stiffness: remembers() is false
      },
      laws.tangential);
}

CollisionEnd integrate_collision_with_memory(const CollisionSetting& setting, const RelativeMotion& motion,
                                             double time, double last, SlipReading reading, int steps) {
  CollisionEnd end;
  const double scale = collision_time(setting, motion.u.norm());
  visit_history(*setting.laws, [&](const auto& normal, const auto& spring) {
    end = CollisionWithMemory<std::decay_t<decltype(normal)>>(setting, normal, spring, reading)
              .run(motion, time, last, scale, steps);
  });
  return end;
}

CollisionForce force_with_memory(const CollisionSetting& setting, const RelativeMotion& motion,
                                 const Vec3& xi, SlipReading reading) {
  CollisionForce force{};
  visit_history(*setting.laws, [&](const auto& normal, const auto& spring) {
    force = CollisionWithMemory<std::decay_t<decltype(normal)>>(setting, normal, spring, reading)
                .force(motion, xi);
  });
  return force;
}

}  // namespace twincell::sim
