#include "sim/encounter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "sim/contact.hpp"

namespace twincell::sim {

namespace {

template <class N>
concept SmoothNormal = N::kMemory == 0 && requires {
  N::kSmooth;
};

/// No history, and a Coulomb limit that says where it binds.
template <class T>
concept PresentTangential = !T::kActs || (!T::kHistory && requires(const double* c, double x) {
  { T::slack(c, x, x) } -> std::same_as<double>;
});

constexpr int kMostColumns = 7;        // of the extrapolation: midpoint rules of 2, 4 .. 14 substeps
constexpr double kLongestStep = 0.35;  // of the contact time: a bead is not to part and come back in one

template <class N, class T, int D>
class Encounter {
 public:
  static constexpr int kTurn = kTurns<D>;
  static constexpr int kNumbers = 2 * D + (T::kActs ? kTurn : 0);  // r, u, and s
  using Numbers = std::array<double, kNumbers>;
  /// Whose changes of sign are kinks of the force: F_n, and how far the Coulomb limit is.
  using Kinks = std::array<double, T::kActs ? 2 : 0>;

  explicit Encounter(const EncounterSetting& setting, const N& normal, const T& tangential)
      : set_(setting),
        c_n_(normal.constants(setting.pair)),
        c_t_(tangential.constants(setting.pair)),
        inv_mass_(1 / setting.pair.m_eff),
        wall_(setting.wall.has_value()) {
    if (wall_) put(*set_.wall, n_.data());
    put(set_.pull, pull_.data());
    put(set_.swing, swing_.data());
  }

  [[nodiscard]] EncounterEnd run(const RelativeMotion& start, double time, double last, double scale,
                                 double tolerance) const {
    Numbers y = numbers(start);
    const double fall = (set_.pull.norm() + set_.swing.norm()) * scale;
    const double speed = std::max({start.u.norm(), start.s.norm(), fall, 1e-300});
    const Scales scales{tolerance * speed * scale, tolerance * speed};
    EncounterEnd end;
    end.deepest = std::max(0.0, overlap(y));
    double h = kLongestStep * scale, t = time;
    while (t < last) {
      h = std::min(h, last - t);
      const Kinks regime = kinks(y);
      const Step step(*this, regime, t, y, scales);
      Numbers next;
      if (!step.take(h, next) && h > 1e-9 * scale) {
        h /= 2;
        continue;
      }
      double done = h;
      const bool kinked = before_kink(step, regime, next, done);
      const bool parted = overlap(next) <= 0 && normal_speed(next) > 0;
      if (parted) to_parting(step, next, done);
      t += done;
      y = next;
      end.deepest = std::max(end.deepest, overlap(y));
      if (parted) {
        end.parted = true;
        break;
      }
      h = std::min(kLongestStep * scale, kinked ? h : 1.5 * h);
    }
    end.time = t;
    end.motion = motion(y, start);
    return end;
  }

  [[nodiscard]] EncounterForce force(const RelativeMotion& m) const {
    const Numbers y = numbers(m);
    const Forces f = forces(y, kinks(y));
    const Vec3 n = vector(f.n), f_t = vector(f.f_t);
    return {f.f_n * n + f_t, n.cross(f_t), n};
  }

 private:
  struct Scales {
    double length, speed;  ///< errors that a step may make
  };
  struct Forces {
    double n[D], f_t[D] = {};          // as vectors
    Tangent<double, kTurn> turning{};  // n x F_t; in the plane F_t
    double overlap, v_n, f_n;
  };

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
  static double dot(const double* a, const double* b) {
    double sum = a[D - 1] * b[D - 1];
    for (int k = D - 2; k >= 0; --k) sum += a[k] * b[k];
    return sum;
  }
  [[nodiscard]] double distance(const Numbers& y) const {
    return wall_ ? dot(n_.data(), y.data()) : std::sqrt(dot(y.data(), y.data()));
  }
  [[nodiscard]] double overlap(const Numbers& y) const { return set_.reach - distance(y); }
  [[nodiscard]] double normal_speed(const Numbers& y) const {
    return wall_ ? dot(n_.data(), y.data() + D) : dot(y.data(), y.data() + D) / distance(y);
  }

  /// Normal motion and force, and the tangential velocity.
  void approach(const Numbers& y, Forces& f, Tangent<double, kTurn>& v_t) const {
    const double apart = distance(y);
    const double inverse = 1 / apart;
    for (int k = 0; k < D; ++k) f.n[k] = wall_ ? n_[k] : y[k] * inverse;
    f.overlap = set_.reach - apart;
    f.v_n = dot(f.n, y.data() + D);
    f.f_n = N::template force<double>(c_n_.data(), f.overlap, f.v_n, nullptr);
    if constexpr (T::kActs && D == 2) {
      v_t.c[0] = f.n[0] * y[3] - f.n[1] * y[2] - y[4];
    } else if constexpr (T::kActs) {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        v_t.c[k] = y[3 + k] - f.v_n * f.n[k] - (y[6 + l] * f.n[m] - y[6 + m] * f.n[l]);
      }
    }
  }
  [[nodiscard]] Kinks kinks(const Numbers& y) const {
    if constexpr (T::kActs) {
      Forces f;
      Tangent<double, kTurn> v_t{};
      approach(y, f, v_t);
      return {f.f_n, T::slack(c_t_.data(), norm(v_t), f.f_n)};
    } else {
      return {};
    }
  }
  [[nodiscard]] Forces forces(const Numbers& y, const Kinks& regime) const {
    Forces f;
    Tangent<double, kTurn> v_t{};
    approach(y, f, v_t);
    if constexpr (T::kActs) {
      // |F_n| is continued beyond its kink as +F_n or -F_n.
      const double pressed = regime[0] > 0 ? f.f_n : -f.f_n;
      Tangent<double, kTurn> f_t;
      if (regime[1] >= 0)
        f_t = T::sticking(c_t_.data(), v_t);
      else if (pressed >= 0)
        f_t = T::sliding(c_t_.data(), v_t, pressed);
      else
        f_t = -1.0 * T::sliding(c_t_.data(), v_t, pressed);
      if constexpr (D == 2) {
        f.f_t[0] = -f_t.c[0] * f.n[1], f.f_t[1] = f_t.c[0] * f.n[0];
        f.turning = f_t;
      } else {
        for (int k = 0; k < 3; ++k) {
          const int l = (k + 1) % 3, m = (k + 2) % 3;
          f.f_t[k] = f_t.c[k];
          f.turning.c[k] = f.n[l] * f_t.c[m] - f.n[m] * f_t.c[l];
        }
      }
    }
    return f;
  }
  void rate(double t, const Numbers& y, const Kinks& regime, Numbers& dy) const {
    const Forces f = forces(y, regime);
    const double swing = wall_ && set_.omega > 0 ? std::sin(set_.omega * t) : 0;
    for (int k = 0; k < D; ++k) {
      dy[k] = y[D + k];
      dy[D + k] = (f.f_n * f.n[k] + f.f_t[k]) * inv_mass_;
      if (wall_) dy[D + k] += pull_[k] + swing_[k] * swing;
    }
    if constexpr (T::kActs)
      for (int k = 0; k < kTurn; ++k) dy[2 * D + k] = -set_.turn * f.turning.c[k];
  }

  /// Steps of any length from one place, in one regime of the force.
  class Step {
   public:
    Step(const Encounter& law, const Kinks& regime, double t, const Numbers& y, const Scales& scales)
        : law_(law), regime_(regime), t_(t), y_(y), scales_(scales) {
      law_.rate(t, y, regime, first_);
    }
    /// By rational numbers of midpoint substeps, extrapolated to infinitely many. \returns whether exact
    [[nodiscard]] const Numbers& from() const { return y_; }
    [[nodiscard]] Numbers rate_at(double at, const Numbers& y) const {
      Numbers change;
      law_.rate(t_ + at, y, regime_, change);
      return change;
    }
    /// From a place along a step, in the same regime.
    [[nodiscard]] Step going_on(double at, const Numbers& y) const {
      return {law_, regime_, t_ + at, y, scales_};
    }
    bool take(double h, Numbers& out) const {
      std::array<Numbers, kMostColumns> row;  // of the triangle
      double before = HUGE_VAL;
      for (int k = 0; k < kMostColumns; ++k) {
        const int n = 2 * (k + 1);
        Numbers now = midpoint(h, n);
        // Aitken and Neville, in (h/n)^2.
        for (int j = 0; j < k; ++j) {
          const double ratio = static_cast<double>(n) / (2 * (k - j));
          const double factor = 1 / (ratio * ratio - 1);
          const Numbers coarser = row[static_cast<std::size_t>(j)];
          row[static_cast<std::size_t>(j)] = now;
          for (std::size_t q = 0; q < now.size(); ++q) now[q] += (now[q] - coarser[q]) * factor;
        }
        row[static_cast<std::size_t>(k)] = now;
        if (k < 1) continue;
        double error = 0;  // against the column before
        for (std::size_t q = 0; q < now.size(); ++q)
          error = std::max(error, std::abs(now[q] - row[static_cast<std::size_t>(k) - 1][q]) /
                                      (q < D ? scales_.length : scales_.speed));
        // What is kept is as much better again as this column is than the one before.
        if (error <= 1 || (k >= 3 && before < HUGE_VAL && error < 1e3 && error * error <= 0.1 * before)) {
          out = now;
          return true;
        }
        before = error;
      }
      out = row[kMostColumns - 1];
      return false;
    }

   private:
    [[nodiscard]] Numbers midpoint(double h, int n) const {
      const double part = h / n;
      Numbers before = y_, now, change;
      for (std::size_t q = 0; q < now.size(); ++q) now[q] = y_[q] + part * first_[q];
      for (int m = 1; m < n; ++m) {
        law_.rate(t_ + m * part, now, regime_, change);
        for (std::size_t q = 0; q < now.size(); ++q) {
          const double next = before[q] + 2 * part * change[q];
          before[q] = now[q];
          now[q] = next;
        }
      }
      law_.rate(t_ + h, now, regime_, change);
      for (std::size_t q = 0; q < now.size(); ++q) now[q] = 0.5 * (before[q] + now[q] + part * change[q]);
      return now;
    }

    const Encounter& law_;
    const Kinks& regime_;
    double t_;
    const Numbers& y_;
    Scales scales_;
    Numbers first_{};
  };

  /// Where along a step g(y) first vanishes, g having different signs at its ends: the root of the cubic
  /// through values and slopes there, and from that place Newton's steps, tiny ones that cost little; where
  /// those do not converge, regula falsi over the whole step. \param next the end of the step, then the place
  /// found, with the sign that g has at the end, or 0 \returns the length of the step to there
  template <class G>
  double vanishing(const Step& step, double h, const G& g, double near, Numbers& next) const {
    const double g_0 = g(step.from()), g_1 = g(next);
    double at =
        cubic_root(g_0, h * slope(step, 0, step.from(), h, g), g_1, h * slope(step, h, next, h, g)) * h;
    Numbers there;
    static_cast<void>(step.take(at, there));
    for (int k = 0; k < 4; ++k) {
      const double value = g(there);
      if (std::abs(value) <= near && (value > 0) != (g_0 > 0)) {
        next = there;
        return at;
      }
      const double rise = slope(step, at, there, h, g);
      // Half of what is allowed beyond the root, so as to be on its far side.
      const double more = ((g_0 > 0 ? -0.5 : 0.5) * near - value) / rise;
      if (!(at + more > 0) || !(at + more < h)) break;
      Numbers moved;
      static_cast<void>(step.going_on(at, there).take(more, moved));
      there = moved;
      at += more;
    }
    // An end that stays gets half its value (the Illinois rule).
    double low = 0, g_low = g_0, high = h, g_high = g_1;
    int kept = 0;
    for (int k = 0; k < 60 && high - low > 1e-15 * h && std::abs(g(next)) > near; ++k) {
      at = std::clamp(low + (high - low) * g_low / (g_low - g_high), low + 0.01 * (high - low),
                      high - 0.01 * (high - low));
      static_cast<void>(step.take(at, there));
      const double value = g(there);
      if ((value > 0) == (g_0 > 0)) {
        low = at, g_low = value;
        if (kept == 1) g_high /= 2;
        kept = 1;
      } else {
        high = at, g_high = value, next = there;
        if (kept == -1) g_low /= 2;
        kept = -1;
      }
    }
    return high;
  }
  /// dg/dt along the motion.
  template <class G>
  double slope(const Step& step, double at, const Numbers& y, double h, const G& g) const {
    const Numbers change = step.rate_at(at, y);
    const double little = 1e-4 * h;
    Numbers before = y, after = y;
    for (std::size_t q = 0; q < y.size(); ++q)
      before[q] -= little * change[q], after[q] += little * change[q];
    return (g(after) - g(before)) / (2 * little);
  }
  /// The root in 0 .. 1 of the cubic with given ends and slopes, whose ends differ in sign: Newton's steps,
  /// halves where they leave the bracket.
  static double cubic_root(double g_0, double d_0, double g_1, double d_1) {
    const double c_3 = 2 * (g_0 - g_1) + d_0 + d_1, c_2 = 3 * (g_1 - g_0) - 2 * d_0 - d_1;
    double low = 0, high = 1, x = g_0 / (g_0 - g_1);
    for (int k = 0; k < 12; ++k) {
      const double value = g_0 + x * (d_0 + x * (c_2 + x * c_3)), rise = d_0 + x * (2 * c_2 + 3 * x * c_3);
      ((value > 0) == (g_0 > 0) ? low : high) = x;
      double next = x - value / rise;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (std::abs(next - x) < 1e-8) return next;
      x = next;
    }
    return x;
  }

  /// Shortens a step that would cross a kink to one that ends just beyond it. \returns whether it did
  bool before_kink(const Step& step, const Kinks& regime, Numbers& next, double& h) const {
    constexpr double kNear = 1e-6;  // of what F_n and the limit were
    const Kinks at_start = kinks(step.from());
    bool any = false;
    for (std::size_t which = 0; which < regime.size(); ++which) {
      const Kinks at_end = kinks(next);
      if ((at_start[which] > 0) == (at_end[which] > 0)) continue;
      const double near = kNear * std::max(std::abs(at_start[which]), std::abs(at_end[which]));
      h = vanishing(
          step, h, [&](const Numbers& y) { return kinks(y)[which]; }, near, next);
      any = true;
    }
    return any;
  }
  /// Shortens a step that ends beyond contact to one that ends where the surfaces part.
  void to_parting(const Step& step, Numbers& next, double& h) const {
    if (overlap(step.from()) <= 0) return;
    h = vanishing(
        step, h, [&](const Numbers& y) { return overlap(y); }, 4e-15 * set_.reach, next);
  }

  const EncounterSetting& set_;
  std::array<double, N::kConstants> c_n_;
  std::array<double, T::kConstants> c_t_;
  double inv_mass_;
  bool wall_;
  std::array<double, D> n_{}, pull_{}, swing_{};
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
    end = setting.dimension == 2
              ? Encounter<N, T, 2>(setting, normal, tangential).run(motion, time, last, scale, tolerance)
              : Encounter<N, T, 3>(setting, normal, tangential).run(motion, time, last, scale, tolerance);
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
