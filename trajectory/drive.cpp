#include "trajectory/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "core/constants.hpp"
#include "trajectory/recorded_motion.hpp"

namespace twincell {

double Drive::period() const {
  return 2 * std::numbers::pi / omega;
}

namespace {

/// Phase of the harmonic of order n at `fraction` of a period, radians.
double angle_of(const Harmonic& harmonic, double n, double fraction) {
  return kTurn * (n * fraction + harmonic.phase);
}

/// first + sum_n a_n term(n, harmonic). `first` is returned to the bit if there are no harmonics.
template <class Term>
double sum_over(const std::vector<Harmonic>& harmonics, double first, const Term& term) {
  double n = 1;
  for (const Harmonic& harmonic : harmonics) {
    n += 1;
    first += harmonic.amplitude * term(n, harmonic);
  }
  return first;
}

}  // namespace

namespace {

/// The bracket w of the drive and its derivatives by the phase angle omega t.
struct Waveform {
  double w, slope, bend;
};
Waveform waveform(const std::vector<Harmonic>& harmonics, double fraction) {
  return {sum_over(harmonics, std::sin(kTurn * fraction),
                   [&](double n, const Harmonic& h) { return std::sin(angle_of(h, n, fraction)); }),
          sum_over(harmonics, std::cos(kTurn * fraction),
                   [&](double n, const Harmonic& h) { return n * std::cos(angle_of(h, n, fraction)); }),
          -sum_over(harmonics, std::sin(kTurn * fraction),
                    [&](double n, const Harmonic& h) { return n * n * std::sin(angle_of(h, n, fraction)); })};
}

/// Upper bound of |w|.
double waves_bound(const std::vector<Harmonic>& harmonics) {
  return sum_over(harmonics, 1, [](double, const Harmonic&) { return 1.0; });
}

/// z = A w(theta) - (A - A_0) w(0) and its time derivatives.
struct RampedPlate {
  double z, v, a;
};
RampedPlate ramped(const Drive& drive, double fraction, std::int64_t cycle) {
  const DriveRamp::State s = drive.ramp->state(static_cast<double>(cycle) + fraction);
  const Waveform w = waveform(drive.harmonics, fraction), start = waveform(drive.harmonics, 0);
  return {s.amplitude * w.w - (s.amplitude - drive.amplitude) * start.w,
          s.amplitude * s.omega * w.slope + s.rate * (w.w - start.w),
          s.amplitude * (s.omega * s.omega * w.bend + s.omega_rate * w.slope) +
              2 * s.rate * s.omega * w.slope + s.curvature * (w.w - start.w)};
}

}  // namespace

double Drive::displacement(double fraction, std::int64_t cycle) const {
  if (recorded) return recorded->at(cycle, fraction, period()).z;
  if (ramp) return ramped(*this, fraction, cycle).z;
  return amplitude * sum_over(harmonics, std::sin(kTurn * fraction), [&](double n, const Harmonic& h) {
           return std::sin(angle_of(h, n, fraction));
         });
}

double Drive::velocity(double fraction, std::int64_t cycle) const {
  if (recorded) return recorded->at(cycle, fraction, period()).v;
  if (ramp) return ramped(*this, fraction, cycle).v;
  return amplitude * omega *
         sum_over(harmonics, std::cos(kTurn * fraction),
                  [&](double n, const Harmonic& h) { return n * std::cos(angle_of(h, n, fraction)); });
}

double Drive::acceleration(double fraction, std::int64_t cycle) const {
  if (recorded) return recorded->at(cycle, fraction, period()).a;
  if (ramp) return ramped(*this, fraction, cycle).a;
  return -omega * omega * amplitude *
         sum_over(harmonics, std::sin(kTurn * fraction),
                  [&](double n, const Harmonic& h) { return n * n * std::sin(angle_of(h, n, fraction)); });
}

double Drive::horizontal_displacement(double fraction) const {
  return horizontal
             ? horizontal->amplitude * std::sin(kTurn * (horizontal->ratio * fraction + horizontal->phase))
             : 0;
}

double Drive::horizontal_velocity(double fraction) const {
  return horizontal ? horizontal->amplitude * horizontal->ratio * omega *
                          std::cos(kTurn * (horizontal->ratio * fraction + horizontal->phase))
                    : 0;
}

Vec3 Drive::displacement_in_space(double fraction, std::int64_t cycle) const {
  Vec3 r = displacement(fraction, cycle) * Vec3::Unit(static_cast<int>(axis));
  if (horizontal) r.x() += horizontal_displacement(fraction);
  return r;
}

Vec3 Drive::velocity_in_space(double fraction, std::int64_t cycle) const {
  Vec3 v = velocity(fraction, cycle) * Vec3::Unit(static_cast<int>(axis));
  if (horizontal) v.x() += horizontal_velocity(fraction);
  return v;
}

Drive Drive::at(double cycles) const {
  Drive now = *this;
  if (!ramp) return now;
  const DriveLevel level = ramp->level(cycles);
  now.amplitude = level.amplitude;
  now.omega = level.omega;
  now.ramp.reset();
  return now;
}

double Drive::cycles_at(double time) const {
  return ramp ? ramp->cycles_at(time) : time / period();
}

double Drive::time_at(double cycles) const {
  return ramp ? ramp->time_at(cycles) : cycles * period();
}

std::int64_t Drive::cycle_at(double time, double fraction) const {
  constexpr double kMaxWholeCycles = 1e15;  // beyond which a double has no fraction
  const double cycles = cycles_at(time) - fraction;
  return (recorded || ramp) && std::abs(cycles) < kMaxWholeCycles ? std::llround(cycles) : 0;
}

double Drive::displacement_bound() const {
  if (recorded) return std::max(recorded->range().highest, -recorded->range().lowest);
  const double waves = waves_bound(harmonics);
  double bound = amplitude * waves;
  if (ramp) {
    const double most = std::max(amplitude, ramp->largest(0));
    bound = most * waves + std::abs(waveform(harmonics, 0).w) * most;
  }
  return horizontal ? std::hypot(bound, horizontal->amplitude) : bound;
}

double Drive::velocity_bound() const {
  if (recorded) return recorded->range().speed;
  const double slopes = sum_over(harmonics, 1, [](double n, const Harmonic&) { return n; });
  double bound = amplitude * omega * slopes;
  if (ramp) {
    // v = A omega w' + A' (w - w(0)); of a sine the two terms are a quarter of a cycle apart.
    const double by_phase = std::max(amplitude * omega, ramp->largest(1)) * slopes,
                 by_ramp = ramp->rate_bound();
    bound = harmonics.empty()
                ? std::hypot(by_phase, by_ramp)
                : by_phase + by_ramp * (waves_bound(harmonics) + std::abs(waveform(harmonics, 0).w));
  }
  return horizontal ? std::hypot(bound, horizontal->amplitude * horizontal->ratio * omega) : bound;
}

namespace {

std::string formula_along_axis(const Drive& drive);

}  // namespace

std::string Drive::formula() const {
  std::string text = formula_along_axis(*this);
  if (horizontal) {
    fmt::format_to(std::back_inserter(text), ", x = {:.6g} sin({}omega t", horizontal->amplitude,
                   horizontal->ratio == 1 ? "" : fmt::format("{} ", horizontal->ratio));
    if (horizontal->phase != 0) fmt::format_to(std::back_inserter(text), " + 2 pi {:.4g}", horizontal->phase);
    text += ')';
  }
  if (ramp) {
    const auto change = [&](const char* name, double from, double to) {
      if (from != to) fmt::format_to(std::back_inserter(text), ", {} from {:.6g} to {:.6g}", name, from, to);
    };
    change("A", ramp->from.amplitude, ramp->to.amplitude);
    change("omega", ramp->from.omega, ramp->to.omega);
    fmt::format_to(std::back_inserter(text), " {}in {:g} cycles", ramp->returns ? "and back " : "",
                   ramp->cycles);
  }
  return text;
}

namespace {

std::string formula_along_axis(const Drive& drive) {
  const std::vector<Harmonic>& harmonics = drive.harmonics;
  if (drive.recorded) {
    const RecordInfo& info = drive.recorded->info();
    return fmt::format("recorded in {} (SHA-256 {}...){}", info.file, info.sha256.substr(0, 8),
                       info.cycles > 0 ? fmt::format(", {} cycles repeated", info.cycles) : "");
  }
  if (harmonics.empty()) return "A sin(omega t)";
  std::string text = "A (sin(omega t)";
  for (std::size_t k = 0; k < harmonics.size(); ++k) {
    const Harmonic& h = harmonics[k];
    if (h.amplitude == 0) continue;
    fmt::format_to(std::back_inserter(text), " + {:.4g} sin({} omega t", h.amplitude, k + 2);
    if (h.phase != 0) fmt::format_to(std::back_inserter(text), " + 2 pi {:.4g}", h.phase);
    text += ')';
  }
  return text + ')';
}

}  // namespace

double Drive::peak_fall() const {
  if (recorded) return recorded->range().fall;
  if (ramp) return at(0).peak_fall();
  if (harmonics.empty()) return amplitude * omega * omega;
  // Over a hundred samples per cycle of the highest harmonic; a parabola through the lowest and its
  // neighbours gives the minimum between them.
  constexpr int kSamples = 4096;
  const auto fall_at = [&](int k) { return acceleration(static_cast<double>(k) / kSamples); };
  int lowest = 0;
  for (int k = 1; k < kSamples; ++k)
    if (fall_at(k) < fall_at(lowest)) lowest = k;
  const double before = fall_at(lowest - 1), here = fall_at(lowest), after = fall_at(lowest + 1);
  const double bend = before - 2 * here + after, slope = after - before;
  return -(bend > 0 ? here - slope * slope / (8 * bend) : here);
}

namespace {

/// A given number without its constant factor: value = A^p omega^q.
struct Term {
  const char* name;
  double value;   ///< A^p omega^q
  double factor;  ///< of the stated number in it: g of Gamma, 2 pi of a frequency
  int p, q;
};

std::vector<Term> terms_of(const DriveSpec& s, double gravity, const Where& where) {
  std::vector<Term> terms;
  auto add = [&](const char* name, const std::optional<double>& v, double factor, int p, int q) {
    if (!v) return;
    const Where here{where.file, where.line, where.column, where.key.empty() ? name : where.key + "." + name};
    require_range(here, *v, 0.0, std::nullopt, p == 0);
    if (factor == 0)
      throw ConfigError(here, "has no meaning without gravity; give the amplitude or the peak velocity.");
    terms.push_back({name, *v * factor, factor, p, q});
  };
  add("amplitude", s.amplitude, 1, 1, 0);
  add("omega", s.omega, 1, 0, 1);
  add("frequency", s.frequency, 2 * std::numbers::pi, 0, 1);
  add("gamma", s.gamma, gravity, 1, 2);
  add("k_m", s.k_m, gravity, 2, 2);
  add("peak_velocity", s.peak_velocity, 1, 1, 1);
  return terms;
}

}  // namespace

std::string harmonics_text(const std::vector<Harmonic>& harmonics) {
  std::string text;
  for (const Harmonic& h : harmonics)
    text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", h.amplitude, h.phase);
  return "[" + text + "]";
}

std::vector<Harmonic> read_harmonics(const ConfigSection& drive) {
  std::vector<Harmonic> harmonics;
  const auto pairs = drive.pairs("harmonics");
  if (!pairs) return harmonics;
  const Where where = drive.where("harmonics");
  if (pairs->size() > kMaxHarmonics)
    throw ConfigError(where, fmt::format("has {} harmonics, the bound is {}.", pairs->size(), kMaxHarmonics));
  for (const auto& [amplitude, phase] : *pairs) {
    const std::size_t order = harmonics.size() + 2;
    if (!(amplitude >= 0 && amplitude <= kLargestHarmonic))
      throw ConfigError(where, fmt::format("the amplitude {} of harmonic {}, relative to the first, must be "
                                           "between 0 and {}.",
                                           amplitude, order, kLargestHarmonic));
    if (!(phase >= 0 && phase < 1))
      throw ConfigError(
          where, fmt::format("the phase {} of harmonic {} must be at least 0 and less than 1 cycle of it.",
                             phase, order));
    harmonics.push_back({amplitude, phase});
  }
  return harmonics;
}

DriveSpec read_drive_spec(const ConfigSection& drive) {
  const auto positive = [&](const char* key) { return drive.number_in(key, 0, std::nullopt, true); };
  return {drive.number_in("amplitude", 0), positive("omega"),         positive("frequency"),
          drive.number_in("gamma", 0),     drive.number_in("k_m", 0), drive.number_in("peak_velocity", 0)};
}

bool is_whole(const DriveSpec& spec) {
  int independent = 0;
  for (const bool stated : {spec.amplitude.has_value(), spec.omega || spec.frequency, spec.gamma.has_value(),
                            spec.k_m || spec.peak_velocity})
    independent += stated ? 1 : 0;
  return independent >= 2;
}

Drive solve_drive(const DriveSpec& spec, double gravity, const Where& where, Axis axis) {
  const auto terms = terms_of(spec, gravity, where);
  // The exponents of two independent numbers form an invertible 2 x 2 matrix in (ln A, ln omega).
  for (std::size_t a = 0; a < terms.size(); ++a) {
    for (std::size_t b = a + 1; b < terms.size(); ++b) {
      const Term &s = terms[a], &t = terms[b];
      const int det = s.p * t.q - t.p * s.q;
      if (det == 0) continue;
      Drive drive{axis, 0, 1};
      auto power = [](double x, double e) { return e == 0 ? 1.0 : std::pow(x, e); };
      const double d = det;
      drive.amplitude = power(s.value, t.q / d) * power(t.value, -s.q / d);
      drive.omega = power(t.value, s.p / d) * power(s.value, -t.p / d);
      // A plate at rest (A = 0) leaves omega undetermined unless omega itself is given.
      if (s.value == 0 || t.value == 0) {
        const Term* stated = s.p == 0 ? &s : t.p == 0 ? &t : nullptr;
        if (stated == nullptr)
          throw ConfigError(where,
                            "a plate at rest needs omega or frequency, which set the length of a cycle.");
        drive.amplitude = 0;
        drive.omega = stated->value;
      }
      // A given A or omega is kept to the bit; only a derived one comes from the powers.
      for (const Term& u : terms) {
        if (u.p == 1 && u.q == 0) drive.amplitude = u.value;
        if (u.p == 0 && u.q == 1) drive.omega = u.value;
      }
      for (const Term& u : terms) {
        const double implied = power(drive.amplitude, u.p) * power(drive.omega, u.q);
        if (std::abs(implied - u.value) > 1e-12 * std::max(std::abs(implied), std::abs(u.value)))
          throw ConfigError(where, fmt::format("{} = {} contradicts the other numbers, from which it would "
                                               "be {} (they must agree to 1e-12).",
                                               u.name, u.value / u.factor, implied / u.factor));
      }
      return drive;
    }
  }
  if (terms.size() < 2)
    throw ConfigError(
        where, fmt::format("two of amplitude, omega, frequency, gamma, k_m, peak_velocity are needed, {}.",
                           terms.empty() ? "none is given" : fmt::format("only {} is given", terms[0].name)));
  throw ConfigError(where,
                    "the numbers given fix only one of amplitude and omega; give an independent second one.");
}

}  // namespace twincell
