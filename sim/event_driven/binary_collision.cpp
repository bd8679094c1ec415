#include "sim/event_driven/binary_collision.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "sim/contact/collision_forces.hpp"
#include "sim/contact/collocation.hpp"
#include "sim/contact/contact.hpp"
#include "sim/contact/stage_polynomial.hpp"
#include "sim/event_driven/collision_with_memory.hpp"
#include "sim/kernels/kernels.hpp"
#include "sim/laws/contact_laws.hpp"

namespace twincell::sim {

namespace {

// Fraction of the contact time by which a step extends beyond the nominal end, to include the parting.
constexpr double kBeyond = 0.01;
/// Longest step in contact times. Two steps cover a contact, and a bead cannot part and return within one
/// step.
constexpr double kLongestStep = 0.5 * (1 + kBeyond);
constexpr double kShortestStep = 1e-9;

template <class N, class T, int D>
class BinaryCollision {
 public:
  static constexpr int kTurn = kTurns<D>;
  static constexpr int kSlopes = D + (T::kActs ? kTurn : 0);  // time derivatives of u and s
  static constexpr int kNumbers = D + kSlopes;                // r, u, and s
  using Numbers = std::array<double, kNumbers>;
  using Forces = CollisionForces<double, N, T, D>;

  explicit BinaryCollision(const CollisionSetting& setting, const N& normal, const T& tangential)
      : set_(setting),
        c_n_(normal.constants(setting.pair)),
        c_t_(tangential.constants(setting.pair)),
        inv_mass_(1 / setting.pair.m_eff),
        wall_(setting.wall.has_value()),
        step_(widest_target().find_step(setting.laws->normal.index(), setting.laws->tangential.index(), D)) {
    if (wall_) put(*set_.wall, n_.data());
    put(set_.pull, pull_.data());
    put(set_.swing, swing_.data());
  }

  [[nodiscard]] CollisionEnd run(const RelativeMotion& start, double time, double last, double scale,
                                 double tolerance) const {
    Numbers y = numbers(start);
    const double fall = wall_ ? (set_.pull.norm() + set_.swing.norm()) * scale : 0;
    const double speed = std::max({start.u.norm(), start.s.norm(), fall, 1e-300});
    CollisionEnd end;
    double deep = overlap(y);
    Numbers middle = y;
    end.middle = time;
    end.deepest = std::max(0.0, deep);
    Step step(*this, speed, scale, tolerance);
    double longest = kLongestStep * scale, shorter = 1, t = time;
    Regime regime = step.begin(t, y);
    while (t < last) {
      // Step length: at most to the nominal end of the contact and to the predicted end of sliding.
      double h = longest;
      if (const double left = time + (1 + kBeyond) * scale - t; left > 0) h = std::min(h, left);
      // A step that extends far beyond a kink may have to be repeated, and needs more iterations.
      if (const double slides = step.sliding_time(); slides < kMaxSlidingTime * scale)
        h = std::min(h, kSlidingFactor * slides + kSlidingMargin * scale);
      h = std::min(shorter * h, last - t);
      const double error = step.take(h);
      if (!(error <= 1) && h > kShortestStep * scale) {
        // If the iteration diverges because the force has no smooth continuation so far beyond a kink, only
        // this step is shortened, not the next ones.
        (error < HUGE_VAL ? longest : shorter) *= error < HUGE_VAL ? 0.5 : step.to_first_event();
        continue;
      }
      shorter = 1;
      // The step is cut at its first event, and the regime changes there.
      const auto [x, what] = step.first_event();
      y = step.at(x);
      t += x * h;
      end.deepest = std::max(end.deepest, step.deepest());
      if (what == Event::parting) {
        end.parted = true;
        t += part(t, regime, y);
      } else if (what == Event::turn) {
        // F_n vanishes here, and with it the Coulomb limit.
        regime = {!regime.pressed, (OmitsTension<N> && regime.pressed) || step.surfaces_slide()};
      } else if (what == Event::limit) {
        regime.slides = !regime.slides;
      }
      if (error < kMaxErrorToDouble) longest = std::min(2 * longest, kLongestStep * scale);
      if (end.parted) break;
      step.begin(regime, t, y);
      if (step.overlap() > deep) deep = step.overlap(), middle = y, end.middle = t;
    }
    end.time = t;
    end.motion = motion(y, start);
    end.at_middle = motion(middle, start);
    return end;
  }

  [[nodiscard]] CollisionForce force(const RelativeMotion& m) const {
    Forces f = approach(numbers(m));
    const Regime regime = regime_of(f);
    f.friction(c_t_.data(), regime.pressed, regime.slides);
    const Vec3 n = vector(f.n), f_n = f.released ? Vec3(Vec3::Zero()) : Vec3(f.f_n * n);
    if constexpr (T::kActs) {
      const Vec3 f_t = vector(f.f_t);
      return {f_n + f_t, n.cross(f_t), n};
    } else {
      return {f_n, Vec3::Zero(), n};
    }
  }

 private:
  /// Regime of the force between two kinks.
  struct Regime {
    bool pressed, slides;  ///< F_n > 0; the Coulomb limit binds
  };
  enum class Event { none, turn, limit, parting };   ///< turn: F_n changes sign
  static constexpr double kMaxErrorToDouble = 1e-4;  ///< error below which the step is doubled
  // In contact times. If sliding is predicted to end within kMaxSlidingTime, the step ends after
  // kSlidingFactor times that time plus kSlidingMargin.
  static constexpr double kMaxSlidingTime = 0.25, kSlidingFactor = 1.15, kSlidingMargin = 0.01;

  static void put(const Vec3& v, double* to) {
    if constexpr (D == 2) {
      to[0] = v.x(), to[1] = v.z();
    } else {
      for (int k = 0; k < 3; ++k) to[k] = v[k];
    }
  }
  static Vec3 vector(const double* c) { return D == 2 ? Vec3(c[0], 0, c[1]) : Vec3(c[0], c[1], c[D - 1]); }
  static Numbers numbers(const RelativeMotion& m) {
    Numbers y{};
    put(m.r, y.data());
    put(m.u, y.data() + D);
    if constexpr (T::kActs) {
      if constexpr (D == 2)
        y[4] = -m.s.y();  // counter-clockwise
      else
        put(m.s, y.data() + 6);
    }
    return y;
  }
  static RelativeMotion motion(const Numbers& y, const RelativeMotion& start) {
    RelativeMotion m{vector(y.data()), vector(y.data() + D), start.s};
    if constexpr (T::kActs)
      m.s = D == 2 ? Vec3(start.s.x(), -y[2 * D], start.s.z()) : vector(y.data() + 2 * D);
    return m;
  }
  [[nodiscard]] double distance(const Numbers& y) const {
    return wall_ ? Forces::dot(n_.data(), y.data()) : std::sqrt(Forces::dot(y.data(), y.data()));
  }
  [[nodiscard]] double overlap(const Numbers& y) const { return set_.reach - distance(y); }

  [[nodiscard]] [[gnu::always_inline]] Forces approach(const Numbers& y) const {
    Forces f;
    f.look(set_.reach, wall_ ? n_.data() : nullptr, y.data());
    f.approach(c_n_.data(), y.data() + D, y.data() + 2 * D);
    return f;
  }
  [[nodiscard]] Regime regime_of(const Forces& f) const {
    Regime regime{f.f_n > 0, false};
    if constexpr (T::kActs) regime.slides = f.slack(c_t_.data(), regime.pressed) < 0;
    return regime;
  }
  /// Accelerations other than that of the contact.
  void push_at(double t, std::array<double, D>& push) const {
    const double swing = set_.omega > 0 ? std::sin(set_.omega * t) : 0;
    for (int k = 0; k < D; ++k) push[k] = pull_[k] + swing_[k] * swing;
  }
  [[gnu::always_inline]] std::array<double, kSlopes> slopes(const Forces& f, double t) const {
    std::array<double, kSlopes> to;
    std::array<double, D> push{};
    if (wall_) push_at(t, push);
    f.slopes(inv_mass_, set_.turn, push.data(), to.data());
    return to;
  }

  /// One step in one regime of the force.
  class Step {
   public:
    Step(const BinaryCollision& law, double speed, double scale, double tolerance)
        : law_(law),
          numbers_(Collocation::numbers()),
          tolerance_(tolerance),
          speed_(speed),
          near_(0.1 * std::sqrt(tolerance)) {
      // Spring and dashpot that approximate the normal force.
      const double deep = speed * scale / 3;
      const auto f_n = [&](double overlap, double v_n) {
        return smooth_force<N>(law.c_n_.data(), overlap, v_n);
      };
      start_.damping = -f_n(0, speed) / speed * law.inv_mass_;
      start_.frequency = std::sqrt(std::max(0.0, f_n(deep, 0) / deep * law.inv_mass_));
      start_.normal_law = law.c_n_.data(), start_.tangential_law = law.c_t_.data();
      start_.reach = law.set_.reach, start_.inv_mass = law.inv_mass_, start_.turn = law.set_.turn;
      start_.wall = law.wall_ ? law.n_.data() : nullptr;
      start_.push = law.wall_ ? push_[0].data() : nullptr;
      start_.method = &numbers_;
      start_.enough = 0.5 * tolerance * speed;
    }
    /// Sets the start of the next step. \returns the regime of the force
    Regime begin(double t, const Numbers& y) {
      forces_ = law_.approach(y);
      return begin_in(law_.regime_of(forces_), t, y);
    }
    void begin(const Regime& regime, double t, const Numbers& y) {
      forces_ = law_.approach(y);
      begin_in(regime, t, y);
    }
    [[nodiscard]] double overlap() const { return forces_.overlap; }
    /// Surfaces at rest relative to each other remain so as long as no other force acts along them.
    [[nodiscard]] bool surfaces_slide() const {
      if constexpr (T::kActs) return norm(forces_.v_t) > 0;
      return false;
    }
    /// Estimated time until sliding ends, from the growth of the Coulomb limit with F_n and the deceleration
    /// by friction. Infinite if the surfaces stick, F_n < 0, or the estimate gives no end.
    [[nodiscard]] double sliding_time() const {
      if constexpr (T::kActs) {
        if (!regime_.slides || !regime_.pressed) return HUGE_VAL;
        const double moment = 1e-3 / std::max(start_.frequency, 1e-300);
        const double speed = norm(forces_.v_t) - moment * norm(forces_.turning) * turning_mass();
        const double force =
            forces_.f_n - moment * forces_.v_n * start_.frequency * start_.frequency / law_.inv_mass_;
        const double gained = T::slack(law_.c_t_.data(), speed, force) - slack_;
        return slack_ < 0 && gained > 0 ? -slack_ / gained * moment : HUGE_VAL;
      }
      return HUGE_VAL;
    }
    /// Takes a step. \returns the error relative to the tolerance; infinite if the iteration does not
    /// converge
    double take(double h) {
      if (law_.wall_)
        for (std::size_t k = 0; k < kStages; ++k) {
          std::array<double, D> push;
          law_.push_at(t_ + numbers_.moment[k] * h, push);
          for (std::size_t q = 0; q < D; ++q) push_[q][k] = push[q];
        }
      start_.h = h;
      const double width = start_.frequency * h * (Collocation::kWidths / Collocation::kWidest);
      start_.response =
          &numbers_.response[static_cast<std::size_t>(std::min(width + 0.5, Collocation::kWidths + 0.0))];
      if (width < kNarrow) start_.response = nullptr;
      law_.step_(start_, motion_);
      if (!(motion_.change <= start_.enough)) return HUGE_VAL;
      double most = 0;
      for (std::size_t q = 0; q < D; ++q)
        for (const auto& last : numbers_.last)
          most = std::max(most, std::abs(sum_of_products(last, motion_.slopes[q])));
      return kOfLast * h * most / (tolerance_ * speed_);
    }
    [[nodiscard]] double deepest() const { return motion_.deepest; }
    /// The first event, and the fraction of the step at which it happens.
    [[nodiscard]] std::pair<double, Event> first_event() const {
      std::pair<double, Event> first{1, Event::none};
      const auto look = [&](Event what, double begins, const double* values, bool positive) {
        unsigned others = 0;  // bits of the stages at which the sign differs
        for (unsigned k = 0; k < kStages; ++k) others |= ((values[k] > 0) != positive ? 1U : 0U) << k;
        if (others == 0) return;
        const double x = vanishing(begins, values, static_cast<std::size_t>(std::countr_zero(others)), near_);
        if (x < first.first || first.second == Event::none) first = {x, what};
      };
      if constexpr (T::kActs) look(Event::limit, slack_, motion_.slack, !regime_.slides);
      if constexpr (T::kActs || OmitsTension<N>) look(Event::turn, forces_.f_n, motion_.f_n, regime_.pressed);
      look(Event::parting, forces_.overlap, motion_.overlap, true);
      return first;
    }
    /// Fraction to which a failed step is shortened, so that it ends not far beyond the first kink, as far as
    /// the stages show it.
    [[nodiscard]] double to_first_event() const {
      for (std::size_t k = 0; k + 2 < kStages; ++k)
        if ((motion_.slack[k] > 0) != !regime_.slides || (motion_.f_n[k] > 0) != regime_.pressed)
          return std::min(0.7, numbers_.moment[k + 1]);
      return 0.5;
    }
    /// The motion at a fraction x of the step.
    [[nodiscard]] Numbers at(double x) const {
      Numbers y;
      if (x >= 1) {
        for (std::size_t q = 0; q < kNumbers; ++q) y[q] = motion_.numbers[q][kStages - 1];
        return y;
      }
      const StagePolynomials motion(numbers_, x);
      for (std::size_t q = 0; q < kNumbers; ++q) y[q] = motion.value(y_[q], motion_.numbers[q]);
      return y;
    }

   private:
    const Regime& begin_in(const Regime& regime, double t, const Numbers& y) {
      y_ = y, t_ = t, regime_ = regime;
      forces_.friction(law_.c_t_.data(), regime.pressed, regime.slides);
      slopes_ = law_.slopes(forces_, t);
      start_.pressed = regime.pressed, start_.slides = regime.slides;
      start_.numbers = y_.data(), start_.slopes = slopes_.data(), start_.normal = forces_.n;
      if constexpr (T::kActs) {
        slack_ = forces_.slack(law_.c_t_.data(), regime.pressed);
        start_.relaxation = regime.slides ? 0 : -T::sticking(law_.c_t_.data(), 1.0) * turning_mass();
      }
      return regime_;
    }
    /// Inverse effective mass for a tangential force.
    [[nodiscard]] double turning_mass() const { return law_.inv_mass_ + law_.set_.turn; }

    static constexpr double kOfLast = 3e-3;  ///< error relative to the contribution of the last coefficients
    static constexpr double kNarrow = 4;     ///< below this width the response of the spring is negligible

    /// Position of a root of the polynomial between stage k, the first at which the sign differs, and the
    /// node before it: Newton's method, or bisection if a Newton step would leave the interval.
    /// \param near tolerance relative to the larger of the two values. The force does not jump at an event,
    /// so the error of the subsequent motion is of second order in it.
    [[nodiscard]] double vanishing(double begins, const double* values, std::size_t k, double near) const {
      double low = numbers_.place[k], high = numbers_.place[k + 1];
      const double g_low = k == 0 ? begins : values[k - 1], g_high = values[k];
      const bool sign = g_high > 0;
      // Caused by rounding or by the finite accuracy of the preceding kink.
      if ((g_low > 0) == sign) return std::min(high, kShortestStep);
      const double large = std::max(std::abs(g_low), std::abs(g_high));
      const double enough = near * large, nearly = 0.5 * std::sqrt(near) * large;
      double x = low + (high - low) * g_low / (g_low - g_high);
      for (int n = 0; n < 60; ++n) {
        const StagePolynomials at_x(numbers_, x);
        const double g = at_x.value(begins, values);
        if (std::abs(g) <= enough || high - low < 1e-15) break;
        ((g > 0) == sign ? high : low) = x;
        const double next = x - g / at_x.slope(begins, values, g);
        const bool within = next > low && next < high;
        x = within ? next : 0.5 * (low + high);
        // Newton's method: the next error is of second order in this one.
        if (within && std::abs(g) <= nearly) break;
      }
      return x;
    }

    const BinaryCollision& law_;
    const Collocation& numbers_;
    double tolerance_, speed_, near_;
    // State at the start of the step.
    Numbers y_;
    Forces forces_;
    std::array<double, kSlopes> slopes_;
    Regime regime_;
    double t_, slack_ = 0;
    CollocationStart start_{};
    CollocationMotion motion_;
    alignas(64) std::array<std::array<double, kStages>, D> push_;
  };

  /// From close to parting to the instant of parting, by tiny straight steps. \returns their duration
  double part(double t, const Regime& regime, Numbers& y) const {
    Forces f = approach(y);
    f.friction(c_t_.data(), regime.pressed, regime.slides);
    const auto change = slopes(f, t);
    double passed = 0, deep = f.overlap;
    for (int k = 0; k < 6 && std::abs(deep) > 4e-15 * set_.reach; ++k) {
      const double more = deep / f.v_n;
      for (std::size_t q = 0; q < D; ++q) y[q] += more * y[D + q];
      for (std::size_t q = 0; q < kSlopes; ++q) y[D + q] += more * change[q];
      passed += more;
      deep = overlap(y);
    }
    return passed;
  }

  const CollisionSetting& set_;
  std::array<double, N::kConstants> c_n_;
  std::array<double, T::kConstants> c_t_;
  double inv_mass_;
  bool wall_;
  CollocationStep step_;
  std::array<double, D> n_{}, pull_{}, swing_{};
};

/// The plane of r and u. If only F_n acts, two beads stay in it, so r and u need two components each instead
/// of three.
class OrbitPlane {
 public:
  explicit OrbitPlane(const RelativeMotion& m) : along_(m.r.normalized()) {
    const Vec3 rest = m.u - m.u.dot(along_) * along_;
    // For a head-on collision any direction is suitable.
    across_ = rest.norm() > 1e-300 ? Vec3(rest.normalized()) : along_.unitOrthogonal();
  }
  [[nodiscard]] RelativeMotion into(const RelativeMotion& m) const { return {flat(m.r), flat(m.u), m.s}; }
  [[nodiscard]] CollisionEnd back(CollisionEnd end, const RelativeMotion& start) const {
    for (RelativeMotion* m : {&end.motion, &end.at_middle}) *m = {space(m->r), space(m->u), start.s};
    return end;
  }

 private:
  [[nodiscard]] Vec3 flat(const Vec3& v) const { return {v.dot(along_), 0, v.dot(across_)}; }
  [[nodiscard]] Vec3 space(const Vec3& v) const { return v.x() * along_ + v.z() * across_; }
  Vec3 along_, across_;
};

/// Calls visit(normal, tangential) if a contact with these laws can be integrated separately.
template <class Visit>
bool visit_laws(const ContactLaws& laws, Visit visit) {
  if (resists_rolling(laws)) return false;
  return std::visit(
      [&](const auto& normal, const auto& tangential) {
        using N = std::decay_t<decltype(normal)>;
        using T = std::decay_t<decltype(tangential)>;
        if constexpr (SmoothNormal<N> && PresentTangential<T>) {
          visit(normal, tangential);
          return true;
        } else {
          return false;
        }
      },
      laws.normal, laws.tangential);
}

// Steps per contact time for laws with history. The error is below 1e-11 with the fine number, and below 1e-8
// with the coarse number, which event-driven motion uses.
constexpr double kFineTolerance = 1e-9;
constexpr int kFineSteps = 200, kCoarseSteps = 24;

}  // namespace

CollisionEnd integrate_collision(const CollisionSetting& setting, const RelativeMotion& motion, double time,
                                 double last, double tolerance) {
  if (remembers(*setting.laws))
    return integrate_collision_with_memory(setting, motion, time, last, reading_of(*setting.laws),
                                           tolerance < kFineTolerance ? kFineSteps : kCoarseSteps);
  CollisionEnd end;
  const double scale = collision_time(setting, motion.u.norm());
  visit_laws(*setting.laws, [&]<class N, class T>(const N& normal, const T& tangential) {
    const auto in = [&]<int D>(const RelativeMotion& start) {
      return BinaryCollision<N, T, D>(setting, normal, tangential).run(start, time, last, scale, tolerance);
    };
    if (setting.dimension == 2) {
      end = in.template operator()<2>(motion);
    } else if (T::kActs || setting.wall) {
      end = in.template operator()<3>(motion);
    } else {
      const OrbitPlane plane(motion);
      end = plane.back(in.template operator()<2>(plane.into(motion)), motion);
    }
  });
  return end;
}

CollisionForce force_of(const CollisionSetting& setting, const RelativeMotion& motion, const Vec3& xi) {
  if (remembers(*setting.laws)) return force_with_memory(setting, motion, xi, reading_of(*setting.laws));
  CollisionForce force{};
  visit_laws(*setting.laws, [&]<class N, class T>(const N& normal, const T& tangential) {
    force = setting.dimension == 2 ? BinaryCollision<N, T, 2>(setting, normal, tangential).force(motion)
                                   : BinaryCollision<N, T, 3>(setting, normal, tangential).force(motion);
  });
  return force;
}

}  // namespace twincell::sim
