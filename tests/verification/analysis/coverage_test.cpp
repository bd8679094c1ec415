// Coverage of the 95 % intervals: every result that has an interval, over many short trajectories of random
// processes. The expected values are known in closed form or come from one long trajectory of the same
// process.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "analysis/observable/observable.hpp"
#include "tests/support/validation.hpp"

namespace twincell::analysis::coverage_test {
namespace {

using Random = std::mt19937_64;
using Truth = std::map<std::string, double>;
using Generator = std::function<MemoryTrajectory(int cycles, Random& random)>;

double normal(Random& random) {
  return std::normal_distribution<double>()(random);
}
double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A stationary process of mean 0 and variance 1, with autocorrelation rho_k = a^k.
class Correlated {
 public:
  Correlated(double a, Random& random) : a_(a), random_(&random), x_(normal(random)) {}
  double next() {
    const double now = x_;
    x_ = a_ * x_ + std::sqrt(1 - a_ * a_) * normal(*random_);
    return now;
  }

 private:
  double a_;
  Random* random_;
  double x_;
};

TrajectoryInfo info_of(std::size_t beads, int phases, const Vec3& upper) {
  TrajectoryInfo info;
  info.n_beads = beads;
  info.columns.phase = true;
  info.phases_per_cycle = phases;
  info.drive = Drive{.amplitude = 1, .omega = 1};
  info.box.upper = upper;
  info.box.boundary[0] = Boundary::wall;
  info.source = Origin::simulation;
  return info;
}

Frame frame_of(const TrajectoryInfo& info, int cycle, int phase) {
  Frame frame;
  frame.step = static_cast<std::int64_t>(cycle) * info.phases_per_cycle + phase;
  frame.cycle = cycle;
  frame.phase = phase;
  frame.time = (cycle + static_cast<double>(phase) / info.phases_per_cycle) * info.drive->period();
  return frame;
}

std::vector<Correlated> many_correlated(std::size_t n, double a, Random& random) {
  std::vector<Correlated> all;
  for (std::size_t i = 0; i < n; ++i) all.emplace_back(a, random);
  return all;
}

/// Counts for the rows of the table, and which results have been counted.
struct Counts {
  int of = 0, held = 0, above = 0, none = 0;
};
std::set<std::string>& plural() {
  static std::set<std::string> names;
  return names;
}

constexpr int kTrajectories = 1000;

/// Analyses trajectories of `cycles` and validates the fraction of intervals that contain `truth`: 95 %, or
/// `known` where the number of tracers or events is too small for 95 % (docs/statistics.md).
void cover(const std::string& what, const Generator& make, int cycles, const Truth& truth,
           AnalysisOptions options, std::uint64_t seed, const Truth& known = {}) {
  options.only.clear();
  for (const auto& [name, value] : truth) options.only.push_back(name);
  Random random(seed);
  std::map<std::string, Counts> counts;
  for (int k = 0; k < kTrajectories; ++k)
    for (const Result& r : analyze(make(cycles, random), options)) {
      Counts& c = counts[r.name];
      if (!r.interval) {
        ++c.none;
        continue;
      }
      const double expected = truth.at(r.name);
      ++c.of;
      c.held += r.interval->low <= expected && expected <= r.interval->high ? 1 : 0;
      c.above += r.interval->low > expected ? 1 : 0;
    }
  for (const auto& [name, c] : counts) {
    plural().insert(name);
    std::printf("COVERAGE|%s|%s|%d|%d|%.1f|%.1f|%.1f\n", name.c_str(), what.c_str(), cycles, c.of,
                100.0 * c.held / c.of, 100.0 * (c.of - c.held - c.above) / c.of, 100.0 * c.above / c.of);
    EXPECT_GT(c.of, kTrajectories / 2) << name << ", " << what;
    test::validate({"V5.12", "coverage, %, of " + name + ", " + what,
                    known.contains(name) ? known.at(name) : 95, 2, "binomial"},
                   100.0 * c.held / c.of);
  }
}

/// The elements of an array whose intervals are counted, and their expected values.
struct Elements {
  std::string name;
  std::vector<std::size_t> index;
  std::vector<double> truth;
  double known = 95;  ///< coverage, %
};

/// The same of arrays: each of these elements in each trajectory counts.
void cover_elements(const std::string& what, const Generator& make, int cycles,
                    const std::vector<Elements>& arrays, std::uint64_t seed) {
  AnalysisOptions options;
  for (const Elements& a : arrays)
    for (const char* end : {"", "_low", "_high"}) options.only.push_back(a.name + end);
  Random random(seed);
  std::map<std::string, Counts> counts;
  for (int k = 0; k < kTrajectories; ++k) {
    const std::vector<Result> results = analyze(make(cycles, random), options);
    for (const Elements& a : arrays) {
      const Result &low = find_result(results, a.name + "_low"),
                   &high = find_result(results, a.name + "_high");
      Counts& c = counts[a.name];
      for (std::size_t e = 0; e < a.index.size(); ++e) {
        if (!low.present() || !std::isfinite(low.values[a.index[e]])) {
          ++c.none;
          continue;
        }
        ++c.of;
        c.above += low.values[a.index[e]] > a.truth[e] ? 1 : 0;
        c.held += low.values[a.index[e]] <= a.truth[e] && a.truth[e] <= high.values[a.index[e]] ? 1 : 0;
      }
    }
  }
  for (const Elements& a : arrays) {
    const Counts& c = counts[a.name];
    for (const char* end : {"", "_low", "_high"}) plural().insert(a.name + end);
    std::printf("COVERAGE|%s|%s|%d|%d|%.1f|%.1f|%.1f\n", a.name.c_str(), what.c_str(), cycles, c.of,
                100.0 * c.held / c.of, 100.0 * (c.of - c.held - c.above) / c.of, 100.0 * c.above / c.of);
    EXPECT_GT(c.of, c.none) << a.name;
    test::validate(
        {"V5.12", "coverage, %, of the elements of " + a.name + ", " + what, a.known, 2, "binomial"},
        100.0 * c.held / c.of);
  }
}

/// Elements of an array with expected values from one long trajectory.
Elements elements_of_long_run(const Generator& make, int cycles, const std::string& name,
                              const std::vector<std::size_t>& index, std::uint64_t seed) {
  Random random(seed);
  const auto results = analyze(make(cycles, random), {.only = {name}});
  Elements elements{.name = name, .index = index, .truth = {}};
  for (const std::size_t e : index) elements.truth.push_back(find_result(results, name).values.at(e));
  return elements;
}

/// Expected values from one long trajectory.
Truth long_run(const Generator& make, int cycles, const std::vector<std::string>& names,
               AnalysisOptions options, std::uint64_t seed) {
  options.only = names;
  Random random(seed);
  Truth truth;
  for (const Result& r : analyze(make(cycles, random), options)) truth[r.name] = r.value();
  return truth;
}

// --- a gas whose temperature is correlated over more than one cycle ---

constexpr std::size_t kGas = 12;
constexpr double kOverTime = 0.8, kCoarse = 1.05;
const Vec3 kSpeed(1, 0.8, 1.5);

MemoryTrajectory gas(int cycles, Random& random, int dimension, bool time_means) {
  constexpr int kPhases = 4;
  constexpr double kBreath = 0.4;
  TrajectoryInfo info = info_of(kGas, kPhases, Vec3(4, 4, 12));
  info.box.dimension = dimension;
  info.columns.velocity = true;
  info.columns.time_mean = time_means;
  info.samples_per_cycle = time_means ? 400 : 0;
  MemoryTrajectory out(info);
  Correlated breath(0.4, random), height(0.7, random);
  std::vector<Correlated> v = many_correlated(3 * kGas, 0.3, random);
  std::gamma_distribution<double> gamma(20, 1.0 / 20);
  for (int j = 0; j < cycles; ++j) {
    const double heat = std::exp(kBreath * breath.next() - kBreath * kBreath / 2);
    for (int k = 0; k < kPhases; ++k) {
      Frame frame = frame_of(info, j, k);
      const double lift = 0.5 * height.next();
      for (std::size_t i = 0; i < kGas; ++i) {
        Vec3 w = Vec3::Zero();
        for (int c = 0; c < 3; ++c)
          if (c != 1 || dimension == 3) w[c] = kSpeed[c] * std::sqrt(heat) * v[3 * i + c].next();
        frame.velocity.push_back(w);
        frame.position.emplace_back(uniform(random, 0.5, 3.5), uniform(random, 0.5, 3.5),
                                    uniform(random, 2, 8) + lift);
      }
      if (time_means) {
        const Vec3 mean = kOverTime * (1 - 1.0 / kGas) * kSpeed.cwiseProduct(kSpeed) * heat * gamma(random);
        frame.time_mean.temperature = dimension == 3 ? mean : Vec3(mean.x(), 0, mean.z());
        frame.time_mean.temperature_coarse = frame.time_mean.temperature * (kCoarse + 0.03 * normal(random));
      }
      out.append(frame);
    }
  }
  return out;
}

Truth temperatures(int dimension, double factor) {
  Vec3 t = factor * (1 - 1.0 / kGas) * kSpeed.cwiseProduct(kSpeed);
  if (dimension == 2) t.y() = 0;
  Truth truth = {{"T_g", t.sum() / 2},          {"T_x", t.x()},         {"T_z", t.z()},
                 {"T", t.sum() / dimension},    {"T_z_eq5", t.z() / 2}, {"T_bar_z", t.z()},
                 {"T_bar", t.sum() / dimension}};
  if (dimension == 3) truth["T_y"] = t.y();
  // The beads' velocities are independent, and the means over time, which alone have the factor, are not
  // used.
  truth["T_z_lab"] = kSpeed.z() * kSpeed.z();
  return truth;
}

void cover_temperatures() {
  Truth over_time = temperatures(3, kOverTime);
  over_time["T_g_aliasing"] = over_time["T_z_aliasing"] = 1 / kOverTime - 1;
  over_time["T_g_sampling"] = kCoarse - 1;
  const auto with_means = [](int cycles, Random& random) { return gas(cycles, random, 3, true); };
  const auto without = [](int cycles, Random& random) { return gas(cycles, random, 2, false); };
  cover("means over time", with_means, 80, over_time, {}, 1);
  cover("means over frames", without, 80, temperatures(2, 1), {}, 2);
}

void cover_heights_and_volume_fractions() {
  const auto make = [](int cycles, Random& random) { return gas(cycles, random, 3, false); };
  AnalysisOptions options;
  options.rest_height = 4;
  Truth truth = long_run(make, 20000, {"phi_top", "phi_cm", "a2_x", "a2_z"}, options, 3);
  truth["h_cm"] = 5;
  truth["delta_h_cm"] = truth["delta_h_bar"] = 1;
  cover("heights that are correlated", make, 40, truth, options, 4);
}

// --- packings that change from state to state ---

/// A packing of one or two randomly chosen pieces, hexagonal or square, side by side, with position noise and
/// some beads removed.
std::vector<Vec3> packing(Random& random) {
  constexpr double kWidth = 9, kHeight = 7;
  const double turn[2] = {uniform(random, 2, 28), uniform(random, 2, 28)};
  const double border = uniform(random, 0, 1) < 0.9 ? uniform(random, 3, 6) : kWidth;
  const bool square = uniform(random, 0, 1) < 0.25;
  const double noise = uniform(random, 0.01, 0.035);
  std::vector<Vec3> beads;
  for (int piece = 0; piece < 2; ++piece) {
    const bool is_square = piece == 1 && square;
    const double a = is_square ? 0 : turn[piece] * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
    const double row = is_square ? 1 : std::sqrt(3.0) / 2;
    for (int r = -20; r <= 20; ++r)
      for (int q = -20; q <= 20; ++q) {
        const double u = 1.01 * (q + (is_square ? 0 : 0.5 * (r & 1))), v = 1.01 * r * row;
        const Vec3 at(4.5 + c * u - s * v, 0, 3.5 + s * u + c * v);
        if (at.x() < 0.5 || at.x() > kWidth - 0.5 || at.z() < 0.5 || at.z() > kHeight - 0.5) continue;
        if ((at.x() < border) != (piece == 0)) continue;
        if (std::any_of(beads.begin(), beads.end(), [&](const Vec3& b) { return (b - at).norm() < 0.85; }))
          continue;
        beads.push_back(at);
      }
  }
  const int out = static_cast<int>(uniform(random, 0, 5));
  for (int k = 0; k < out; ++k)
    beads.erase(beads.begin() +
                static_cast<std::ptrdiff_t>(uniform(random, 0, 0.999) * static_cast<double>(beads.size())));
  for (Vec3& b : beads) b += noise * Vec3(normal(random), 0, normal(random));
  return beads;
}

void cover_order_grains_and_defects() {
  constexpr std::size_t kStates = 200;
  constexpr double kStays = 0.3;
  Random random(5);
  std::vector<std::vector<Vec3>> states;
  std::size_t most = 0;
  for (std::size_t k = 0; k < kStates; ++k) {
    states.push_back(packing(random));
    most = std::max(most, states.back().size());
  }
  TrajectoryInfo info = info_of(most, 1, Vec3(9, 1, 7));
  info.columns.identity = true;
  const auto frame_at = [&](int cycle, std::size_t state) {
    Frame frame = frame_of(info, cycle, 0);
    frame.position = states[state];
    frame.position.resize(most, Vec3::Constant(std::nan("")));
    for (std::size_t i = 0; i < most; ++i)
      frame.id.push_back(i < states[state].size() ? static_cast<std::int64_t>(i) : -1);
    return frame;
  };
  // The mean over the states in which the value exists; all states are equally frequent.
  const std::vector<std::string> names = {"q6",
                                          "psi6",
                                          "psi4",
                                          "hexagonal_fraction",
                                          "square_fraction",
                                          "ordered_fraction",
                                          "orientation",
                                          "orientation_a",
                                          "orientation_b",
                                          "grains",
                                          "largest_grain",
                                          "grain_boundary_fraction",
                                          "grain_boundary_angle",
                                          "disclinations_5",
                                          "disclinations_7",
                                          "disclinations_other",
                                          "dislocations",
                                          "free_disclinations",
                                          "holes",
                                          "defect_fraction",
                                          "contact_number",
                                          "contact_number_inside",
                                          "voronoi_area",
                                          "voronoi_area_variance"};
  AnalysisOptions options;
  options.only = names;
  std::map<std::string, std::pair<double, double>> sums;
  for (std::size_t k = 0; k < kStates; ++k) {
    MemoryTrajectory one(info);
    one.append(frame_at(0, k));
    for (const Result& r : analyze(one, options))
      if (r.present()) sums[r.name].first += r.value(), sums[r.name].second += 1;
  }
  Truth truth;
  for (const std::string& name : names) truth[name] = sums[name].first / sums[name].second;
  // A direction is that of the sum over all states.
  MemoryTrajectory every(info);
  for (std::size_t k = 0; k < kStates; ++k) every.append(frame_at(static_cast<int>(k), k));
  options.only = {"orientation"};
  truth["orientation"] = analyze(every, options).front().value();
  const auto make = [&](int cycles, Random& chance) {
    MemoryTrajectory out(info);
    std::size_t state = chance() % kStates;
    for (int j = 0; j < cycles; ++j) {
      out.append(frame_at(j, state));
      if (uniform(chance, 0, 1) > kStays) state = chance() % kStates;
    }
    return out;
  };
  cover("packings that last 1.4 frames", make, 80, truth, {}, 6, {{"disclinations_other", 93}});
}

// --- lines of tracers ---

MemoryTrajectory line(int cycles, int phases, std::size_t tracers,
                      const std::function<double(std::size_t, int, int)>& height) {
  TrajectoryInfo info = info_of(tracers, phases, Vec3(20, 1, 20));
  info.columns.plate_height = true;
  info.tracer.assign(tracers, 1);
  MemoryTrajectory out(info);
  for (int j = 0; j < cycles; ++j)
    for (int k = 0; k < phases; ++k) {
      Frame frame = frame_of(info, j, k);
      frame.plate_height = 0;
      for (std::size_t t = 0; t < tracers; ++t)
        frame.position.emplace_back(0.5 + static_cast<double>(t), 0, height(t, j, k));
      out.append(frame);
    }
  return out;
}

void cover_the_bounce_of_tracers() {
  constexpr int kPhases = 8;
  constexpr double kBounce = 0.3, kRest = 5;
  for (const std::size_t tracers : {10, 20}) {
    // `wave` times the bounce of a tracer is added to its height at rest.
    const auto bouncing = [&](double (*wave)(double)) {
      return [&, wave](int cycles, Random& random) {
        std::vector<double> rest, bounce;
        for (std::size_t t = 0; t < tracers; ++t) {
          rest.push_back(kRest + 0.3 * normal(random));
          bounce.push_back(kBounce + 0.1 * normal(random));
        }
        return line(cycles, kPhases, tracers, [&](std::size_t t, int, int k) {
          return rest[t] + bounce[t] * wave(2 * std::numbers::pi * k / kPhases) + 0.01 * normal(random);
        });
      };
    };
    const double rms = kBounce / std::sqrt(2.0);
    cover(std::to_string(tracers) + " tracers that bounce", bouncing([](double x) { return std::sin(x); }), 8,
          {{"s_b", rms}, {"s_b_variance", rms}, {"s_b_as_printed", std::hypot(kRest, rms)}}, {}, 7);
    // No phase is below the height at rest.
    cover(std::to_string(tracers) + " tracers that bounce",
          bouncing([](double x) { return 1 - std::cos(x); }), 8,
          {{"s_b_about_rest", kBounce * std::sqrt(1.5)}}, {}, 7);
  }
}

void cover_the_spread_of_tracers() {
  constexpr double kSpread = 0.5, kStep = 0.1;
  for (const std::size_t tracers : {10, 20}) {
    const std::string n = std::to_string(tracers);
    const double share = 1 - 1.0 / static_cast<double>(tracers);
    const auto mixing = [&](int cycles, Random& random) {
      std::vector<Correlated> z = many_correlated(tracers, 0.5, random);
      return line(cycles, 1, tracers, [&](std::size_t t, int, int) { return 5 + kSpread * z[t].next(); });
    };
    cover(n + " tracers that mix", mixing, 40, {{"s_c", kSpread * std::sqrt(share)}}, {}, 8);

    const auto diffusing = [&](int cycles, Random& random) {
      std::vector<double> z(tracers, 8);
      return line(cycles, 1, tracers,
                  [&](std::size_t t, int j, int) { return j == 0 ? z[t] : z[t] += kStep * normal(random); });
    };
    constexpr int kCycles = 40;
    const double growth = kStep * kStep * share;
    cover(
        n + " tracers that diffuse", diffusing, kCycles,
        {{"s_j_growth", growth}, {"s_j_growth_late", growth}, {"s_c", std::sqrt(growth * (kCycles - 1) / 2)}},
        {}, 9, {{"s_j_growth", 94}, {"s_j_growth_late", 92}, {"s_c", 94}});
  }
}

// --- beads that slip ---

/// Independent periods, in each of which up to three deep beads of a crystal jump. The jumps of one period
/// prefer one direction.
MemoryTrajectory slipping(int cycles, Random& random) {
  constexpr int kColumns = 6, kRows = 15, kDeep = 3;
  const double row = std::sqrt(3.0) / 2;
  TrajectoryInfo info = info_of(kColumns * kRows, 1, Vec3(kColumns, 1, 40));
  info.box.boundary[0] = Boundary::periodic;
  std::vector<Vec3> rest;
  for (int r = 0; r < kRows; ++r)
    for (int i = 0; i < kColumns; ++i) rest.emplace_back(0.25 + i + 0.5 * (r % 2), 0, 0.5 + r * row);
  MemoryTrajectory out(info);
  for (int j = 0; j < cycles; ++j) {
    Frame frame = frame_of(info, 3 * j, 0);
    frame.position = rest;
    out.append(frame);
    frame = frame_of(info, 3 * j + 1, 0);
    frame.position = rest;
    const double kinds[] = {60, 90, 0, 30};
    const double preferred = kinds[random() % 4];
    const auto jumps = static_cast<int>(uniform(random, 0, 4));
    for (int k = 0; k < jumps; ++k) {
      const double degrees = uniform(random, 0, 1) < 0.4 ? preferred : uniform(random, 0, 180);
      const double a = degrees * std::numbers::pi / 180;
      frame.position[random() % (kColumns * kDeep)] += 0.35 * Vec3(std::cos(a), 0, std::sin(a));
    }
    out.append(frame);
  }
  return out;
}

void cover_slip() {
  const std::vector<std::string> names = {"p_s", "slip_oblique", "slip_vertical", "slip_horizontal"};
  cover("beads that slip", slipping, 40, long_run(slipping, 10000, names, {}, 10), {}, 11);
}

// --- rolls ---

/// Independent displacement fields, in each of which beads at random positions circulate in two rolls. The
/// strength of the rolls is correlated from cycle to cycle.
MemoryTrajectory rolling(int cycles, Random& random) {
  constexpr double kWidth = 8, kHeight = 6;
  constexpr std::size_t kBeads = 60;
  const TrajectoryInfo info = info_of(kBeads, 1, Vec3(kWidth, 1, kHeight));
  MemoryTrajectory out(info);
  Correlated strength(0.3, random);
  for (int j = 0; j < cycles; ++j) {
    const double u = 0.2 * (1 + 0.3 * strength.next());
    Frame before = frame_of(info, 3 * j, 0), after = frame_of(info, 3 * j + 1, 0);
    for (std::size_t i = 0; i < kBeads; ++i) {
      const Vec3 at(uniform(random, 0, kWidth), 0, uniform(random, 0, kHeight));
      const double p = 2 * std::numbers::pi * at.x() / kWidth, q = std::numbers::pi * at.z() / kHeight;
      const Vec3 step = u * Vec3(std::sin(p) * std::cos(q), 0, -std::cos(p) * std::sin(q)) +
                        0.1 * Vec3(normal(random), 0, normal(random));
      before.position.push_back(at - step / 2);
      after.position.push_back(at + step / 2);
    }
    out.append(before);
    out.append(after);
  }
  return out;
}

void cover_circulations() {
  cover("rolls whose strength is correlated", rolling, 40,
        long_run(rolling, 8000, {"circulation_left", "circulation_right"}, {}, 12), {}, 13);
}

// --- flights ---

/// A bed that is launched once a cycle, with a launch speed that varies and is correlated from cycle to
/// cycle.
MemoryTrajectory hopping(int cycles, Random& random) {
  constexpr int kPhases = 20;
  TrajectoryInfo info = info_of(2, kPhases, Vec3(4, 1, 40));
  info.drive->amplitude = 1e-3;
  MemoryTrajectory out(info);
  Correlated draw(0.3, random);
  for (int j = 0; j < cycles; ++j) {
    const double speed = 1.4 + 0.2 * draw.next();
    for (int k = 0; k < kPhases; ++k) {
      Frame frame = frame_of(info, j, k);
      const double s = std::max(0.0, frame.time - (j + 0.2) * info.drive->period()),
                   z = 1 + std::max(0.0, speed * s - s * s / 2);
      frame.position = {Vec3(1, 0, z), Vec3(3, 0, z)};
      out.append(frame);
    }
  }
  return out;
}

void cover_flights() {
  cover("hops of a bed", hopping, 60, long_run(hopping, 4000, {"flight_time", "flight_share"}, {}, 14), {},
        15);
}

// --- contacts whose forces are correlated from frame to frame ---

constexpr std::int32_t kColumn = 6;

/// A column of beads on a floor at rest. Their forces have a common factor that is correlated over the
/// frames.
MemoryTrajectory pressed(int cycles, Random& random) {
  TrajectoryInfo info = info_of(kColumn, 1, Vec3(1, 1, 8));
  info.drive->amplitude = 0;
  info.columns.velocity = info.columns.contact_forces = true;
  info.walls = {"bottom"};
  MemoryTrajectory out(info);
  Correlated breath(0.5, random);
  for (int j = 0; j < cycles; ++j) {
    Frame frame = frame_of(info, j, 0);
    const double common = 1 + 0.2 * breath.next();
    for (std::int32_t i = 0; i < kColumn; ++i) {
      frame.position.emplace_back(0.5, 0, i + 0.5);
      frame.velocity.emplace_back(normal(random), 0, normal(random));
      const auto force = [&](double mean) { return mean * common * (1 + 0.1 * normal(random)); };
      if (i == 0) frame.contact_forces.push_back({i, -1, 0, Vec3::UnitZ(), force(kColumn), Vec3::Zero()});
      // The last contact, and one across a bead, are there in half of the frames.
      if (i + 2 < kColumn || (i + 1 < kColumn && uniform(random, 0, 1) < 0.5))
        frame.contact_forces.push_back(
            {i, i + 1, 0, -Vec3::UnitZ(), force(kColumn - 1 - i), Vec3(force(0.1), 0, 0)});
      if (i == 1 && uniform(random, 0, 1) < 0.5)
        frame.contact_forces.push_back({i, i + 2, 0, -Vec3::UnitZ(), force(1), Vec3::Zero()});
    }
    out.append(frame);
  }
  return out;
}

/// A driven bed with time means of its forces, which are skewed and correlated over the cycles, in four
/// phases.
MemoryTrajectory landing(int cycles, Random& random) {
  constexpr int kPhases = 4;
  TrajectoryInfo info = info_of(kColumn, kPhases, Vec3(1, 1, 8));
  info.columns.velocity = info.columns.contact_forces = info.columns.force_mean = true;
  info.samples_per_cycle = 400;
  info.walls = {"bottom"};
  MemoryTrajectory out(info);
  Correlated breath(0.5, random);
  std::gamma_distribution<double> gamma(20, 1.0 / 20);
  for (int j = 0; j < cycles; ++j) {
    const double common = 1 + 0.2 * breath.next();
    for (int k = 0; k < kPhases; ++k) {
      Frame frame = frame_of(info, j, k);
      for (std::int32_t i = 0; i < kColumn; ++i) {
        frame.position.emplace_back(0.5, 0, i + 0.5);
        frame.velocity.emplace_back(normal(random), 0, normal(random));
      }
      BedForces& m = frame.force_mean = BedForces::zero(1);
      const double force = kColumn * common * (k == 1 ? 4 * gamma(random) : 0);
      m.wall_normal_force[0] = force;
      m.wall_force[0] = Vec3(0, 0, -force);
      m.stress.diagonal() = Vec3(0.2, 0, 1) * force * gamma(random);
      m.kinetic.diagonal() = Vec3(1, 0, 1.5) * gamma(random) * common;
      m.in_contact = k == 1 ? 0.5 + 0.1 * normal(random) : 0;
      m.normal_force = 0.3 * force * gamma(random);
      m.tangential_force = 0.2 * m.normal_force * gamma(random);
      out.append(frame);
    }
  }
  return out;
}

void cover_contact_forces() {
  const Truth exact = {{"wall_support", 1},
                       {"pressure", 0.6 * kColumn},
                       {"pressure_kinetic", 1.25},
                       {"contact_force", 0.3 * kColumn / 0.125},
                       {"tangential_to_normal", 0.2}};
  cover("means over time of forces", landing, 80, exact, {}, 18);
  const std::vector<std::string> names = {"contact_force", "tangential_to_normal",
                                          "mechanical_contact_number", "pressure", "pressure_kinetic"};
  cover("a pressed column", pressed, 80, long_run(pressed, 40000, names, {}, 16), {}, 17);
}

// --- points without interaction ---

constexpr std::size_t kPoints = 20;
constexpr double kPeriod = 6;

TrajectoryInfo info_of_points() {
  TrajectoryInfo info = info_of(kPoints, 1, Vec3(kPeriod, 1, kPeriod));
  info.box.dimension = 2;
  info.box.boundary = {Boundary::periodic, Boundary::open, Boundary::periodic};
  info.columns.velocity = info.columns.identity = true;
  return info;
}

/// Points whose places are drawn anew, all at once, in 7 of 10 frames.
MemoryTrajectory redrawn(int cycles, Random& random) {
  MemoryTrajectory out(info_of_points());
  std::vector<Vec3> places;
  for (int j = 0; j < cycles; ++j) {
    if (places.empty() || uniform(random, 0, 1) < 0.7) {
      places.clear();
      for (std::size_t i = 0; i < kPoints; ++i)
        places.emplace_back(uniform(random, 0, kPeriod), 0, uniform(random, 0, kPeriod));
    }
    Frame frame = frame_of(out.info(), j, 0);
    frame.position = places;
    frame.velocity.assign(kPoints, Vec3::Zero());
    for (std::size_t i = 0; i < kPoints; ++i) frame.id.push_back(static_cast<std::int64_t>(i));
    out.append(frame);
  }
  return out;
}

constexpr double kStepOfPoints = 0.1, kMemoryOfVelocities = 0.6;

/// Points that walk at random, with velocities that are correlated from frame to frame. They begin anywhere.
MemoryTrajectory walk(int cycles, Random& random, double step) {
  MemoryTrajectory out(info_of_points());
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < kPoints; ++i)
    places.emplace_back(uniform(random, 0, kPeriod), 0, uniform(random, 0, kPeriod));
  std::vector<Correlated> v = many_correlated(2 * kPoints, kMemoryOfVelocities, random);
  for (int j = 0; j < cycles; ++j) {
    Frame frame = frame_of(out.info(), j, 0);
    for (std::size_t i = 0; i < kPoints; ++i) {
      places[i] += step * Vec3(normal(random), 0, normal(random));
      frame.velocity.emplace_back(v[2 * i].next(), 0, v[2 * i + 1].next());
      frame.id.push_back(static_cast<std::int64_t>(i));
    }
    frame.position = places;
    out.append(frame);
  }
  return out;
}
MemoryTrajectory walking(int cycles, Random& random) {
  return walk(cycles, random, kStepOfPoints);
}

void cover_elements_of_arrays() {
  // r from 0.5 to 2.9 sigma, |q| from 2 to 15.8/sigma
  Elements g{.name = "g_r", .index = {}, .truth = {}}, s{.name = "S_q", .index = {}, .truth = {}};
  for (std::size_t b = 9; b < 58; b += 6) g.index.push_back(b), g.truth.push_back(1);
  for (std::size_t b = 10; b < 79; b += 6) s.index.push_back(b), s.truth.push_back(1);
  cover_elements(
      "places that last 1.4 frames", redrawn, 60,
      {g, s, elements_of_long_run(redrawn, 20000, "voronoi_area_density", {4, 10, 16, 22, 28, 34}, 18)}, 19);
  const double step = 2 * kStepOfPoints * kStepOfPoints, a = kMemoryOfVelocities;
  cover_elements("points that walk", walking, 60,
                 {{.name = "msd", .index = {0, 1, 3, 7}, .truth = {step, 2 * step, 4 * step, 8 * step}},
                  {.name = "vacf", .index = {1, 2, 4}, .truth = {a, a * a, std::pow(a, 4)}}},
                 20);
  // Neighbours stay for tens of frames: the run is a few times as long as its memory.
  const double pairs = (kPoints - 1) * std::numbers::pi * 1.05 * 1.05 / (kPeriod * kPeriod);
  cover_elements("points that walk slowly", walking, 200,
                 {{.name = "g_r", .index = {19, 39, 57}, .truth = {1, 1, 1}, .known = 87}}, 23);
  cover("points that walk slowly", walking, 200, {{"contact_number", pairs}}, {}, 24,
        {{"contact_number", 75}});
  cover_elements("a pressed column", pressed, 80,
                 {elements_of_long_run(pressed, 40000, "contact_force_density", {2, 6, 10, 14, 18}, 21)}, 22);
}

TEST(Coverage, EveryResultWithAnInterval) {
  cover_temperatures();
  cover_heights_and_volume_fractions();
  cover_order_grains_and_defects();
  cover_the_bounce_of_tracers();
  cover_the_spread_of_tracers();
  cover_slip();
  cover_circulations();
  cover_flights();
  cover_contact_forces();
  cover_elements_of_arrays();
  // Words, arrays, counts, and results that state themselves why they have no interval.
  const std::set<std::string> without = {"s_k",
                                         "half_pixel",
                                         "s_b_noise",
                                         "s_j_noise",
                                         "s_j",
                                         "cycle_of_convection",
                                         "drift",
                                         "phase",
                                         "tracers",
                                         "tracer_heights",
                                         "slips",
                                         "p_s_j",
                                         "slip_directions",
                                         "T_z_field",
                                         "T_z_tau",
                                         "q6_beads",
                                         "psi6_beads",
                                         "psi4_beads",
                                         "orientation_beads",
                                         "grain_beads",
                                         "defect_fraction_j",
                                         "coordination_beads",
                                         "displacement_field",
                                         "field_x",
                                         "field_z",
                                         "rolls",
                                         "convection_sense",
                                         "profile_z",
                                         "phi_z",
                                         "T_z_z",
                                         "T_x_z",
                                         "T_z_frames_z",
                                         "T_z_instant_z",
                                         "T_z_volume",
                                         "h_cm_k",
                                         "h_cm_j",
                                         "g_r_distance",
                                         "g_peak",
                                         "g_peak_distance",
                                         "msd_lag",
                                         "S_q_wavenumber",
                                         "S_q_peak",
                                         "S_q_peak_wavenumber",
                                         "vacf_lag",
                                         "voronoi_area_ratio",
                                         "stress",
                                         "stress_kinetic",
                                         "stress_xx_z",
                                         "stress_zz_z",
                                         "stress_z",
                                         "wall_force",
                                         "wall_force_low",
                                         "wall_force_high",
                                         "stress_field",
                                         "stress_field_x",
                                         "stress_field_z",
                                         "contact_force_ratio"};
  for (const std::string& name : result_names())
    EXPECT_NE(without.contains(name), plural().contains(name)) << name;
}

}  // namespace
}  // namespace twincell::analysis::coverage_test
