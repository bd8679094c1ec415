#include "sim/encounter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "sim/collocation.hpp"
#include "sim/contact.hpp"
#include "sim/encounter_forces.hpp"
#include "sim/moment_polynomial.hpp"
#include "sim/passes.hpp"

namespace twincell::sim {

namespace {

constexpr double kBeyond = 0.01;  // of the contact time: it ends a little after that, but for the spring
/// Of the contact time: two steps are a contact, and a bead is not to part and come back in one.
constexpr double kLongestStep = 0.5 * (1 + kBeyond);
constexpr double kShortestStep = 1e-9;

template <class N, class T, int D>
class Encounter {
 public:
  static constexpr int kTurn = kTurns<D>;
  static constexpr int kSlopes = D + (T::kActs ? kTurn : 0);  // of u, and of s
  static constexpr int kNumbers = D + kSlopes;                // r, u, and s
  using Numbers = std::array<double, kNumbers>;
  using Forces = EncounterForces<double, N, T, D>;

  explicit Encounter(const EncounterSetting& setting, const N& normal, const T& tangential)
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

  [[nodiscard]] EncounterEnd run(const RelativeMotion& start, double time, double last, double scale,
                                 double tolerance) const {
    Numbers y = numbers(start);
    const double fall = wall_ ? (set_.pull.norm() + set_.swing.norm()) * scale : 0;
    const double speed = std::max({start.u.norm(), start.s.norm(), fall, 1e-300});
    EncounterEnd end;
    double deep = overlap(y);
    Numbers middle = y;
    end.middle = time;
    end.deepest = std::max(0.0, deep);
    Step step(*this, speed, scale, tolerance);
    Regime regime = regime_at(y);
    double longest = kLongestStep * scale, shorter = 1, t = time;
    while (t < last && !end.parted) {
      double h = longest;
      if (const double left = time + (1 + kBeyond) * scale - t; left > 0) h = std::min(h, left);
      h = std::min(shorter * h, last - t);
      const double error = step.take(regime, t, h, y);
      if (!(error <= 1) && h > kShortestStep * scale) {
        // Where the force has no smooth continuation so far beyond a kink the next step need not be short.
        (error < HUGE_VAL ? longest : shorter) *= error < HUGE_VAL ? 0.5 : step.to_first_event(regime);
        continue;
      }
      shorter = 1;
      const auto [x, what] = step.first_event(regime);
      y = step.at(x);
      t += x * h;
      end.deepest = std::max(end.deepest, step.deepest());
      if (const double now = overlap(y); now > deep) deep = now, middle = y, end.middle = t;
      if (what == Event::parting) {
        end.parted = true;
        t += part(t, regime, y);
      } else if (what == Event::turn) {
        // There F_n vanishes, and so does the Coulomb limit.
        regime = {!regime.pressed, T::kActs && tangential_speed(y) > 0};
      } else if (what == Event::limit) {
        regime.slides = !regime.slides;
      }
      if (error < kEasy) longest = std::min(2 * longest, kLongestStep * scale);
    }
    end.time = t;
    end.motion = motion(y, start);
    end.at_middle = motion(middle, start);
    return end;
  }

  [[nodiscard]] EncounterForce force(const RelativeMotion& m) const {
    const Numbers y = numbers(m);
    const Forces f = forces(y, regime_at(y));
    const Vec3 n = vector(f.n);
    if constexpr (T::kActs) {
      const Vec3 f_t = vector(f.f_t);
      return {f.f_n * n + f_t, n.cross(f_t), n};
    } else {
      return {f.f_n * n, Vec3::Zero(), n};
    }
  }

 private:
  /// Of the force, between its kinks.
  struct Regime {
    bool pressed, slides;  ///< F_n > 0; the Coulomb limit binds
  };
  enum class Event { none, turn, limit, parting };  ///< turn: F_n changes its sign
  static constexpr double kEasy = 1e-4;             ///< error of a step that could have been twice as long

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

  [[nodiscard]] Forces approach(const Numbers& y) const {
    Forces f;
    f.look(set_.reach, wall_ ? n_.data() : nullptr, y.data());
    f.approach(c_n_.data(), y.data() + D, y.data() + 2 * D);
    return f;
  }
  [[nodiscard]] Forces forces(const Numbers& y, const Regime& regime) const {
    Forces f = approach(y);
    f.rub(c_t_.data(), regime.pressed, regime.slides);
    return f;
  }
  [[nodiscard]] Regime regime_at(const Numbers& y) const {
    const Forces f = approach(y);
    Regime regime{f.f_n > 0, false};
    if constexpr (T::kActs) regime.slides = f.slack(c_t_.data(), regime.pressed) < 0;
    return regime;
  }
  [[nodiscard]] double tangential_speed(const Numbers& y) const {
    if constexpr (T::kActs) return norm(approach(y).v_t);
    return 0;
  }
  /// Accelerations other than the contact's.
  void push_at(double t, std::array<double, D>& push) const {
    const double swing = set_.omega > 0 ? std::sin(set_.omega * t) : 0;
    for (int k = 0; k < D; ++k) push[k] = pull_[k] + swing_[k] * swing;
  }
  std::array<double, kSlopes> slopes(const Forces& f, double t) const {
    std::array<double, kSlopes> to;
    std::array<double, D> push{};
    if (wall_) push_at(t, push);
    f.slopes(inv_mass_, set_.turn, push.data(), to.data());
    return to;
  }

  /// A step in one regime of the force.
  class Step {
   public:
    Step(const Encounter& law, double speed, double scale, double tolerance)
        : law_(law),
          numbers_(Collocation::numbers()),
          tolerance_(tolerance),
          speed_(speed),
          near_(0.1 * std::sqrt(tolerance)) {
      // The spring and the dashpot that the normal force is like.
      const double deep = speed * scale / 3;
      const auto f_n = [&](double overlap, double v_n) {
        return N::template force<double>(law.c_n_.data(), overlap, v_n, nullptr);
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
    /// \returns the error over what is allowed
    double take(const Regime& regime, double t, double h, const Numbers& y) {
      y_ = y;
      const Forces f = law_.forces(y, regime);
      const auto slopes = law_.slopes(f, t);
      if (law_.wall_)
        for (std::size_t k = 0; k < kMoments; ++k) {
          std::array<double, D> push;
          law_.push_at(t + numbers_.moment[k] * h, push);
          for (std::size_t q = 0; q < D; ++q) push_[q][k] = push[q];
        }
      start_.h = h;
      if constexpr (T::kActs)
        start_.relaxation =
            regime.slides ? 0 : -T::sticking(law_.c_t_.data(), 1.0) * (law_.inv_mass_ + law_.set_.turn);
      start_.pressed = regime.pressed, start_.slides = regime.slides;
      start_.numbers = y_.data(), start_.slopes = slopes.data(), start_.normal = f.n;
      const double width = start_.frequency * h * (Collocation::kWidths / Collocation::kWidest);
      start_.response =
          &numbers_.response[static_cast<std::size_t>(std::min(width + 0.5, Collocation::kWidths + 0.0))];
      if (width < kNarrow) start_.response = nullptr;
      overlap_ = f.overlap, f_n_ = f.f_n;
      if constexpr (T::kActs) slack_ = f.slack(law_.c_t_.data(), regime.pressed);
      law_.step_(start_, motion_);
      if (!(motion_.change <= start_.enough)) return HUGE_VAL;
      double most = 0;
      for (std::size_t q = 0; q < D; ++q)
        for (const auto& last : numbers_.last)
          most = std::max(most, std::abs(sum_of_products(last, motion_.slopes[q])));
      return kOfLast * h * most / (tolerance_ * speed_);
    }
    [[nodiscard]] double deepest() const { return motion_.deepest; }
    /// What happens first, and at which fraction of the step.
    [[nodiscard]] std::pair<double, Event> first_event(const Regime& regime) const {
      std::pair<double, Event> first{1, Event::none};
      const auto look = [&](Event what, double begins, const double* values, bool positive) {
        unsigned others = 0;  // moments where the sign is another
        for (unsigned k = 0; k < kMoments; ++k) others |= ((values[k] > 0) != positive ? 1U : 0U) << k;
        if (others == 0) return;
        const double x = vanishing(begins, values, static_cast<std::size_t>(std::countr_zero(others)), near_);
        if (x < first.first || first.second == Event::none) first = {x, what};
      };
      if constexpr (T::kActs) {
        look(Event::limit, slack_, motion_.slack, !regime.slides);
        look(Event::turn, f_n_, motion_.f_n, regime.pressed);
      }
      look(Event::parting, overlap_, motion_.overlap, true);
      return first;
    }
    /// Which part of a step that failed goes not far beyond the first kink, as far as it is seen.
    [[nodiscard]] double to_first_event(const Regime& regime) const {
      for (std::size_t k = 0; k + 2 < kMoments; ++k)
        if ((motion_.slack[k] > 0) != !regime.slides || (motion_.f_n[k] > 0) != regime.pressed)
          return std::min(0.7, numbers_.moment[k + 1]);
      return 0.5;
    }
    /// The motion at a fraction x of the step.
    [[nodiscard]] Numbers at(double x) const {
      Numbers y;
      if (x >= 1) {
        for (std::size_t q = 0; q < kNumbers; ++q) y[q] = motion_.numbers[q][kMoments - 1];
        return y;
      }
      const MomentPolynomials motion(numbers_, x);
      for (std::size_t q = 0; q < kNumbers; ++q) y[q] = motion.value(y_[q], motion_.numbers[q]);
      return y;
    }

   private:
    static constexpr double kOfLast = 3e-3;  ///< error over the change that the last coefficient makes
    static constexpr double kNarrow = 4;     ///< the spring hardly counts

    /// Where the polynomial vanishes between moment k, where its sign is another, and the one before: by
    /// Newton's method, or halves where it would leave. \param near how near, of the larger of the two
    /// values: the force has no jump there, so that the error of what follows is of second order in it
    [[nodiscard]] double vanishing(double begins, const double* values, std::size_t k, double near) const {
      double low = numbers_.place[k], high = numbers_.place[k + 1];
      const double g_low = k == 0 ? begins : values[k - 1], g_high = values[k];
      const bool sign = g_high > 0;
      // Rounding, or how near the kink before was found.
      if ((g_low > 0) == sign) return std::min(high, kShortestStep);
      const double large = std::max(std::abs(g_low), std::abs(g_high));
      const double enough = near * large, nearly = 0.5 * std::sqrt(near) * large;
      double x = low + (high - low) * g_low / (g_low - g_high);
      for (int n = 0; n < 60; ++n) {
        const MomentPolynomials at_x(numbers_, x);
        const double g = at_x.value(begins, values);
        if (std::abs(g) <= enough || high - low < 1e-15) break;
        ((g > 0) == sign ? high : low) = x;
        const double next = x - g / at_x.slope(begins, values, g);
        const bool within = next > low && next < high;
        x = within ? next : 0.5 * (low + high);
        // The next error is of second order in this one.
        if (within && std::abs(g) <= nearly) break;
      }
      return x;
    }

    const Encounter& law_;
    const Collocation& numbers_;
    double tolerance_, speed_, near_;
    double overlap_ = 0, f_n_ = 0, slack_ = 0;  ///< at the start
    Numbers y_;
    CollocationStart start_{};
    CollocationMotion motion_;
    alignas(64) std::array<std::array<double, kMoments>, D> push_;
  };

  /// From close to the moment of parting to it, by tiny straight steps. \returns how long they took
  double part(double t, const Regime& regime, Numbers& y) const {
    const Forces f = forces(y, regime);
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

  const EncounterSetting& set_;
  std::array<double, N::kConstants> c_n_;
  std::array<double, T::kConstants> c_t_;
  double inv_mass_;
  bool wall_;
  CollocationStep step_;
  std::array<double, D> n_{}, pull_{}, swing_{};
};

/// The plane of r and u, in which two beads stay between which only F_n acts: two numbers for each instead of
/// three.
class OrbitPlane {
 public:
  explicit OrbitPlane(const RelativeMotion& m) : along_(m.r.normalized()) {
    const Vec3 rest = m.u - m.u.dot(along_) * along_;
    // Head on, any direction will do.
    across_ = rest.norm() > 1e-300 ? Vec3(rest.normalized()) : along_.unitOrthogonal();
  }
  [[nodiscard]] RelativeMotion into(const RelativeMotion& m) const { return {flat(m.r), flat(m.u), m.s}; }
  [[nodiscard]] EncounterEnd back(EncounterEnd end, const RelativeMotion& start) const {
    for (RelativeMotion* m : {&end.motion, &end.at_middle}) *m = {space(m->r), space(m->u), start.s};
    return end;
  }

 private:
  [[nodiscard]] Vec3 flat(const Vec3& v) const { return {v.dot(along_), 0, v.dot(across_)}; }
  [[nodiscard]] Vec3 space(const Vec3& v) const { return v.x() * along_ + v.z() * across_; }
  Vec3 along_, across_;
};

/// Calls visit(normal, tangential) if both can meet alone.
template <class Visit>
bool visit_laws(const ContactLaws& laws, Visit visit) {
  if (laws.rolling.index() != 0) return false;
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

}  // namespace

bool can_meet_alone(const ContactLaws& laws) {
  return visit_laws(laws, [](const auto&, const auto&) {});
}

double encounter_time(const EncounterSetting& setting, double speed) {
  return std::visit([&](const auto& law) { return law.shortest_time(setting.pair, speed); },
                    setting.laws->normal);
}

EncounterEnd meet(const EncounterSetting& setting, const RelativeMotion& motion, double time, double last,
                  double tolerance) {
  EncounterEnd end;
  const double scale = encounter_time(setting, motion.u.norm());
  visit_laws(*setting.laws, [&]<class N, class T>(const N& normal, const T& tangential) {
    const auto in = [&]<int D>(const RelativeMotion& start) {
      return Encounter<N, T, D>(setting, normal, tangential).run(start, time, last, scale, tolerance);
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

EncounterForce force_of(const EncounterSetting& setting, const RelativeMotion& motion) {
  EncounterForce force{};
  visit_laws(*setting.laws, [&]<class N, class T>(const N& normal, const T& tangential) {
    force = setting.dimension == 2 ? Encounter<N, T, 2>(setting, normal, tangential).force(motion)
                                   : Encounter<N, T, 3>(setting, normal, tangential).force(motion);
  });
  return force;
}

}  // namespace twincell::sim
