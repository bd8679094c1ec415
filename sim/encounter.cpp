#include "sim/encounter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "sim/contact.hpp"
#include "sim/dormand_prince.hpp"

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

constexpr double kBeyond = 0.01;
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
    // The first step is about as long as the tolerance allows: the contact begins like any other.
    double h = kLongestStep * scale * std::min(1.0, std::sqrt(std::sqrt(std::sqrt(tolerance / 1e-6)))),
           t = time;
    while (t < last && !end.parted) {
      // A step that would go far beyond the parting is refused there, where the force of the law changes its
      // sign, and says less well where they part: it ends a little after a contact time.
      if (const double left = time + scale - t; left > 0) h = std::min(h, left + kBeyond * scale);
      h = std::min(h, last - t);
      const Kinks regime = kinks(y);
      Step step(*this, regime, t, y);
      const double error = step.take(h, scales);
      const double better = std::clamp(0.9 / std::sqrt(std::sqrt(std::sqrt(error))), 0.2, 2.0);
      if (!(error <= 1) && h > 1e-9 * scale) {
        h *= better;
        continue;
      }
      double x = to_kink(step, regime, 0.1 * std::sqrt(tolerance));
      for (const double by : {step.parts(x), x})
        if (!end.parted && overlap(by < 1 ? step.at(by) : step.end()) <= 0) {
          end.parted = true;
          x = to_parting(step, by);
        }
      Numbers next = x < 1 ? step.at(x) : step.end();
      t += x * h;
      if (end.parted) t += part(t, regime, next);
      y = next;
      end.deepest = std::max(end.deepest, overlap(y));
      h = std::min(kLongestStep * scale, better * h);
    }
    end.time = t;
    end.motion = motion(y, start);
    return end;
  }

  [[nodiscard]] EncounterForce force(const RelativeMotion& m) const {
    const Numbers y = numbers(m);
    Kinks far;
    const Forces f = forces(y, kinks(y), far);
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
  /// In a regime of the force; \param far how far its kinks are
  Forces forces(const Numbers& y, const Kinks& regime, Kinks& far) const {
    Forces f;
    Tangent<double, kTurn> v_t{};
    approach(y, f, v_t);
    if constexpr (T::kActs) {
      far = {f.f_n, T::slack(c_t_.data(), norm(v_t), f.f_n)};
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
  /// \returns the overlap, and how far the kinks are
  std::pair<double, Kinks> rate(double t, const Numbers& y, const Kinks& regime, Numbers& dy) const {
    Kinks far;
    const Forces f = forces(y, regime, far);
    const double swing = wall_ && set_.omega > 0 ? std::sin(set_.omega * t) : 0;
    for (int k = 0; k < D; ++k) {
      dy[k] = y[D + k];
      dy[D + k] = (f.f_n * f.n[k] + f.f_t[k]) * inv_mass_;
      if (wall_) dy[D + k] += pull_[k] + swing_[k] * swing;
    }
    if constexpr (T::kActs)
      for (int k = 0; k < kTurn; ++k) dy[2 * D + k] = -set_.turn * f.turning.c[k];
    return {f.overlap, far};
  }

  /// A step from one place in one regime of the force, and the motion between its ends.
  class Step {
   public:
    Step(const Encounter& law, const Kinks& regime, double t, const Numbers& y)
        : law_(law), regime_(regime), t_(t), y_(y) {
      std::tie(overlaps_[0], far_[0]) = law_.rate(t, y, regime, slopes_[0]);
    }
    /// \returns the error over what is allowed
    double take(double h, const Scales& scales) {
      h_ = h;
      slope_at<1>(), slope_at<2>(), slope_at<3>(), slope_at<4>(), slope_at<5>(), slope_at<6>();
      slope_at<7>(), slope_at<8>(), slope_at<9>(), slope_at<10>(), slope_at<11>();
      end_ = moved<dormand_prince::kStages>();
      continued_ = false;
      const Numbers off_5 = weighted<dormand_prince::kError, 0>(),
                    off_3 = weighted<dormand_prince::kError, 1>();
      double fifth = 0, third = 0;
      for (std::size_t q = 0; q < kNumbers; ++q) {
        const double allowed = q < D ? scales.length : scales.speed;
        fifth += off_5[q] * off_5[q] / (allowed * allowed),
            third += off_3[q] * off_3[q] / (allowed * allowed);
      }
      if (!(fifth > 0)) return fifth;
      return std::abs(h) * fifth / std::sqrt((fifth + 0.01 * third) * kNumbers);
    }
    [[nodiscard]] const Numbers& from() const { return y_; }
    [[nodiscard]] const Numbers& end() const { return end_; }
    /// The earliest fraction of the step, of those where slopes were taken, at which a kink has been passed;
    /// 1 if none is. What begins and ends between two of them is missed, and is as small as it is short.
    [[nodiscard]] double passes(std::size_t which) const {
      double first = 1;
      for (std::size_t k = 1; k < dormand_prince::kStages; ++k)
        if ((far_[k][which] > 0) != (far_[0][which] > 0)) first = std::min(first, dormand_prince::kNode[k]);
      return first;
    }
    /// The earliest of them before x at which the surfaces have parted; x if they have not.
    [[nodiscard]] double parts(double x) const {
      for (std::size_t k = 1; k < dormand_prince::kStages; ++k)
        if (overlaps_[k] <= 0) x = std::min(x, dormand_prince::kNode[k]);
      return x;
    }
    /// The motion at a fraction x of the step.
    [[nodiscard]] Numbers at(double x) {
      if (!continued_) go_on();
      Numbers y{};
      for (std::size_t k = terms_.size(); k-- > 0;)
        for (std::size_t q = 0; q < kNumbers; ++q) y[q] = (y[q] + terms_[k][q]) * (k % 2 == 0 ? x : 1 - x);
      for (std::size_t q = 0; q < kNumbers; ++q) y[q] += y_[q];
      return y;
    }

   private:
    template <const auto& Table, std::size_t Row>
    [[nodiscard]] Numbers weighted() const {
      Numbers sum{};
      [&]<std::size_t... J>(std::index_sequence<J...>) {
        const auto add = [&]<std::size_t K>() {
          if constexpr (Table[Row][K] != 0)
            for (std::size_t q = 0; q < kNumbers; ++q) sum[q] += Table[Row][K] * slopes_[K][q];
        };
        (add.template operator()<J>(), ...);
      }
      (std::make_index_sequence<std::tuple_size_v<std::decay_t<decltype(Table[Row])>>>());
      return sum;
    }
    template <std::size_t Row>
    [[nodiscard]] Numbers moved() const {
      Numbers y = weighted<dormand_prince::kWeight, Row>();
      for (std::size_t q = 0; q < kNumbers; ++q) y[q] = y_[q] + h_ * y[q];
      return y;
    }
    template <std::size_t Row>
    void slope_at() {
      std::tie(overlaps_[Row], far_[Row]) =
          law_.rate(t_ + dormand_prince::kNode[Row] * h_, moved<Row>(), regime_, slopes_[Row]);
    }
    void go_on() {
      slope_at<12>(), slope_at<13>(), slope_at<14>(), slope_at<15>();
      const Numbers high[] = {
          weighted<dormand_prince::kBetween, 0>(), weighted<dormand_prince::kBetween, 1>(),
          weighted<dormand_prince::kBetween, 2>(), weighted<dormand_prince::kBetween, 3>()};
      for (std::size_t q = 0; q < kNumbers; ++q) {
        const double way = end_[q] - y_[q], first = h_ * slopes_[0][q], last = h_ * slopes_[12][q];
        terms_[0][q] = way;
        terms_[1][q] = first - way;
        terms_[2][q] = 2 * way - (first + last);
        for (std::size_t k = 0; k < 4; ++k) terms_[3 + k][q] = h_ * high[k][q];
      }
      continued_ = true;
    }

    const Encounter& law_;
    const Kinks& regime_;
    double t_, h_ = 0;
    const Numbers& y_;
    Numbers end_{};
    std::array<Numbers, dormand_prince::kSlopes> slopes_;
    std::array<Kinks, dormand_prince::kSlopes> far_;
    std::array<double, dormand_prince::kSlopes> overlaps_;
    std::array<Numbers, 7> terms_;
    bool continued_ = false;
  };

  /// The fraction of a step up to x = `last` at which g(y) has just changed its sign: regula falsi, an end
  /// that stays getting half its value (the Illinois rule). \param near what |g| may be there
  template <class G>
  static double vanishing(Step& step, double last, double g_low, double g_high, const G& g, double near) {
    double low = 0, high = last;
    const bool sign = g_high > 0;
    double found = g_high;
    int kept = 0;
    for (int k = 0; k < 60 && high - low > 1e-15 && std::abs(found) > near; ++k) {
      const double x = std::clamp(low + (high - low) * g_low / (g_low - g_high), low + 0.01 * (high - low),
                                  high - 0.01 * (high - low));
      const double value = g(step.at(x));
      if ((value > 0) != sign) {
        low = x, g_low = value;
        if (kept == 1) g_high /= 2;
        kept = 1;
      } else {
        high = x, g_high = found = value;
        if (kept == -1) g_low /= 2;
        kept = -1;
      }
    }
    return high;
  }

  /// The fraction of a step at which the force has just passed its first kink; 1 if it passes none.
  /// \param near how near, of what F_n and the limit are at the step's ends: the force has no jump there, so
  /// that the error of what follows is of second order in it
  double to_kink(Step& step, const Kinks& at_start, double near) const {
    double x = 1;
    for (std::size_t which = 0; which < at_start.size(); ++which) {
      const double begins = at_start[which];
      // A slope was taken at a rougher place than the motion there.
      for (const double end : {std::min(step.passes(which), x), x}) {
        const double ends = kinks(end < 1 ? step.at(end) : step.end())[which];
        if ((begins > 0) == (ends > 0)) continue;
        x = vanishing(
            step, end, begins, ends, [&](const Numbers& y) { return kinks(y)[which]; },
            near * std::max(std::abs(begins), std::abs(ends)));
        break;
      }
    }
    return x;
  }
  /// The fraction of a step that ends beyond contact at which the surfaces part.
  double to_parting(Step& step, double last) const {
    return vanishing(
        step, last, std::max(overlap(step.from()), 1e-300), overlap(last < 1 ? step.at(last) : step.end()),
        [&](const Numbers& y) { return overlap(y); }, 1e-12 * set_.reach);
  }
  /// From close to the moment of parting to it, by tiny straight steps. \returns how long they took
  double part(double t, const Kinks& regime, Numbers& y) const {
    double passed = 0;
    for (int k = 0; k < 6 && std::abs(overlap(y)) > 4e-15 * set_.reach; ++k) {
      const double more = overlap(y) / normal_speed(y);
      Numbers change;
      rate(t + passed, y, regime, change);
      for (std::size_t q = 0; q < kNumbers; ++q) y[q] += more * change[q];
      passed += more;
    }
    return passed;
  }

  const EncounterSetting& set_;
  std::array<double, N::kConstants> c_n_;
  std::array<double, T::kConstants> c_t_;
  double inv_mass_;
  bool wall_;
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
    end.motion = {space(end.motion.r), space(end.motion.u), start.s};
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
