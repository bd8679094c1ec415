// twincell calibrate contacts bounce|collisions|numbers: restitution and friction from measured motion. The
// kind infer is in calibrate_infer.cpp.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "calibration/contact/bounce.hpp"
#include "calibration/contact/collisions.hpp"
#include "calibration/contact/contact_figures.hpp"
#include "calibration/contact/contact_numbers.hpp"
#include "calibration/contact/walton.hpp"
#include "cli/calibrate.hpp"
#include "cli/number_checks.hpp"
#include "cli/stack_info.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "core/table.hpp"
#include "sim/laws/linear_collision.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::cli {
namespace {

// ---- bounce

struct BounceFlags {
  CalibrateFlags out;
  std::string source;
  std::optional<std::size_t> bead;  ///< default: 0
  std::optional<double> gravity, amplitude, omega, phase;
  bool no_drag = false;
};

/// Heights of a bouncing bead, and what a trajectory says of its plate and its gravity.
struct BounceHeights {
  std::vector<calibration::BounceSample> samples;
  std::optional<Drive> drive;     ///< absent: a table, or a trajectory without a drive
  std::optional<double> gravity;  ///< sigma/t0^2; absent: a table
};

BounceHeights bounce_heights(const BounceFlags& o) {
  BounceHeights heights;
  std::vector<calibration::BounceSample>& samples = heights.samples;
  if (is_trajectory(o.source)) {
    const H5mdReader trajectory(o.source);
    const std::size_t bead = o.bead.value_or(0), n = trajectory.info().n_beads;
    if (n == 0) throw InputError({.file = o.source, .key = {}}, "has no beads.");
    if (bead >= n)
      throw ConfigError({.file = {}, .key = "--bead"},
                        fmt::format("is {}; {} has beads 0 to {}.", bead, o.source, n - 1));
    heights.drive = trajectory.info().drive;
    heights.gravity = gravity_of(trajectory.info());
    Frame frame;
    for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
      trajectory.read(f, frame);
      if (frame.present(bead)) samples.push_back({frame.time, frame.position[bead].z()});
    }
  } else {
    if (o.bead)
      throw ConfigError(
          {.file = {}, .key = "--bead"},
          fmt::format("is {}, but {} is no trajectory (H5MD) and has only one bead.", *o.bead, o.source));
    const Table table = read_table(o.source);
    const auto &t = table.column("time"), &z = table.column("height");
    double before = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < t.size(); ++i) {
      samples.push_back({t[i], z[i]});
      if (t[i] <= before)
        throw InputError(
            {.file = o.source, .key = "time"},
            fmt::format("row {} contains {:g} after {:g}; times must increase.", i + 1, t[i], before));
      if (std::isfinite(t[i])) before = t[i];
    }
  }
  return heights;
}

/// The fitted gravity against that of the trajectory. \returns a note if the flights show another one,
/// otherwise nothing \throws InputError if it is far off
std::string check_gravity(const std::string& source, double stated, const calibration::BounceFit& fit) {
  constexpr double kErrors = 5, kNotedShare = 0.01, kMaxShare = 0.05;  // standard errors; of g
  const double off = std::abs(fit.gravity / stated - 1);
  if (off < kNotedShare || off * stated < kErrors * fit.gravity_error) return {};
  const std::string why = fmt::format(
      "the best gravity is {:.4g} +- {:.1g}, where it is {:g} in the trajectory: the bead may touch others "
      "between its impacts (--bead selects one), or the scale or the frame rate is wrong",
      fit.gravity, fit.gravity_error, stated);
  if (off > kMaxShare) throw InputError({.file = source, .key = {}}, why + ".");
  return why;
}

void run_bounce(const BounceFlags& o, const Common& common) {
  const BounceHeights heights = bounce_heights(o);
  const std::vector<calibration::BounceSample>& samples = heights.samples;
  std::optional<Drive> drive = heights.drive;
  if (o.amplitude || o.omega) {
    if (!o.amplitude || !o.omega)
      throw ConfigError({.file = {}, .key = "--drive-amplitude"},
                        "and --drive-omega must be given together.");
    drive = Drive{.axis = Axis::z, .amplitude = *o.amplitude, .omega = *o.omega};
  }
  if (o.phase && !(drive && drive->amplitude > 0))
    throw ConfigError(
        {.file = {}, .key = "--drive-phase"},
        fmt::format("is {:g}, but the plate does not vibrate; give --drive-amplitude and --drive-omega too.",
                    *o.phase));
  calibration::BounceOptions options{.gravity = o.gravity, .drag = !o.no_drag, .plate = {}};
  if (drive && drive->amplitude > 0) {
    const double phase = o.phase.value_or(0);
    options.plate = [d = *drive, phase](double t) {
      const double theta = d.omega * t + phase;
      return calibration::PlateState{d.amplitude * std::sin(theta), d.amplitude * d.omega * std::cos(theta)};
    };
  }
  calibration::BounceFit fit;
  try {
    fit = calibration::fit_bounces(samples, options);
  } catch (const InputError& e) {
    throw InputError({.file = o.source, .key = {}}, e.what());
  }
  if (const auto empty = std::ranges::count_if(
          samples, [](const auto& s) { return !std::isfinite(s.time) || !std::isfinite(s.height); });
      empty > 0)
    fit.notes.push_back(
        fmt::format("{} without a number {} left out", plural(empty, "row"), empty == 1 ? "was" : "were"));
  if (heights.gravity && !o.gravity)
    if (const std::string why = check_gravity(o.source, *heights.gravity, fit); !why.empty())
      fit.notes.push_back(why);
  CalibrationResult out;
  out.notes = fit.notes;
  out.measured.push_back({.name = "contact.wall.restitution",
                          .value = {fit.restitution},
                          .standard_error = {fit.restitution_error},
                          .method = plural(fit.impacts.size(), "impact") + " of a bouncing bead",
                          .data = data_hash(o.source)});
  nlohmann::json& d = out.document;
  d["source"] = o.source;
  d["flights"] = fit.flights;
  d["samples"] = fit.samples;
  d["outliers"] = fit.outliers;
  d["rms_residual"] = fit.rms;
  d["gravity"] = {
      {"value", fit.gravity}, {"standard_error", number_or_null(fit.gravity_error)}, {"fitted", !o.gravity}};
  d["drag"] = {
      {"value", fit.drag}, {"standard_error", number_or_null(fit.drag_error)}, {"fitted", !o.no_drag}};
  out.text = fmt::format("{} in {}, {}, rms {:.3g}\n", plural(fit.samples, "sample"),
                         plural(fit.flights, "flight"), plural(fit.outliers, "outlier"), fit.rms);
  out.text += o.gravity ? fmt::format("gravity: {:g}, as given\n", fit.gravity)
                        : fmt::format("gravity: {:.6g} +- {:.2g}\n", fit.gravity, fit.gravity_error);
  if (!o.no_drag)
    out.text +=
        fmt::format("drag: {:.3g} +- {:.1g} of the velocity per unit time\n", fit.drag, fit.drag_error);
  out.text += "  time        impact speed  e_n\n";
  for (const calibration::BounceImpact& i : fit.impacts) {
    d["impacts"].push_back({{"time", i.time},
                            {"speed", i.speed},
                            {"restitution", i.restitution},
                            {"standard_error", number_or_null(i.error)}});
    out.text +=
        fmt::format("  {:<10.5g}  {:<12.5g}  {:.5f} +- {:.5f}\n", i.time, i.speed, i.restitution, i.error);
  }
  out.figures = {calibration::bounce_figure(fit)};
  finish_calibration(o.out, common, std::move(out));
}

// ---- collisions

struct CollisionFlags {
  CalibrateFlags out;
  std::string trajectory;
  calibration::CollisionOptions options;
  std::string shape = "disc";
};

void run_collisions(const CollisionFlags& o, const Common& common) {
  const H5mdReader trajectory(o.trajectory);
  const calibration::FoundCollisions found = calibration::find_collisions(trajectory, o.options);
  calibration::WaltonFit fit;
  try {
    fit = calibration::fit_walton(found.impacts, o.shape == "disc" ? 0.5 : 0.4);
  } catch (const InputError& e) {
    throw InputError({.file = o.trajectory, .key = {}},
                     fmt::format("{} ({} pairs collided between frames, {} of them with a third body)",
                                 without_full_stop(e.what()), found.pairs, found.crowded));
  }
  CalibrationResult out;
  out.notes = fit.notes;
  const std::string data = data_hash(o.trajectory),
                    method = fmt::format("{} collisions of two beads", fit.impacts);
  out.measured.push_back({.name = "contact.restitution",
                          .value = {fit.restitution},
                          .standard_error = {fit.restitution_error},
                          .method = method,
                          .data = data});
  nlohmann::json& d = out.document;
  const auto open = [&](const std::string& name) {
    const auto& u = fit.tangential.undetermined;
    return !fit.has_tangential || fit.tangential.standard_errors.empty() ||
           std::find(u.begin(), u.end(), name) != u.end();
  };
  d["undetermined"] = nlohmann::json::array();
  for (const auto& [name, quantity] :
       {std::pair{"mu", "contact.mu"}, std::pair{"beta_0", "contact.beta_0"}}) {
    if (open(name))
      d["undetermined"].push_back(name);
    else
      out.measured.push_back({.name = quantity,
                              .value = {fit.tangential.value(name)},
                              .standard_error = {fit.tangential.standard_error(name)},
                              .method = method + ", Walton's two branches",
                              .data = data});
  }
  d["source"] = o.trajectory;
  d["pairs"] = found.pairs;
  d["crowded"] = found.crowded;
  d["impacts"] = fit.impacts;
  d["outliers"] = fit.outliers;
  d["scatter"] = fit.scatter;
  d["speed_slope"] = {{"value", number_or_null(fit.slope)},
                      {"standard_error", number_or_null(fit.slope_error)}};
  d["sticking"] = fit.sticking;
  d["sliding"] = fit.sliding;
  d["spins"] = found.spins;
  d["stride"] = found.stride;
  if (!found.spins) out.notes.emplace_back("the trajectory has no spins, so friction cannot be measured");
  out.text = fmt::format("{} collided between two frames, {} with a third body left out, {}\n",
                         plural(found.pairs, "pair"), found.crowded, plural(fit.outliers, "outlier"));
  if (found.stride > 1)
    out.text += fmt::format(
        "every {}th frame is used: collisions last longer than the interval between frames\n", found.stride);
  out.text += fmt::format("e_n scatters by {:.2g} from impact to impact", fit.scatter);
  if (std::isfinite(fit.slope))
    out.text += fmt::format("; de_n/d ln(speed) = {:.2g} +- {:.1g}", fit.slope, fit.slope_error);
  out.text += "\n";
  if (fit.has_tangential) out.text += fmt::format("{} impacts stick, {} slide\n", fit.sticking, fit.sliding);
  if (!d["undetermined"].empty()) out.text += "undetermined: " + json_text(d["undetermined"]) + "\n";
  out.figures = {calibration::collisions_figure(found, fit, o.shape == "disc" ? 0.5 : 0.4)};
  finish_calibration(o.out, common, std::move(out));
}

// ---- numbers

struct NumberFlags {
  std::optional<double> restitution, contact_time, k_n, gamma_n;
  double m_eff = 0.5;
};

void run_numbers(const NumberFlags& o, const Common& common) {
  const bool forward = o.k_n && o.gamma_n, back = o.restitution && o.contact_time;
  const int stated =
      (o.k_n ? 1 : 0) + (o.gamma_n ? 1 : 0) + (o.restitution ? 1 : 0) + (o.contact_time ? 1 : 0);
  if (forward == back || stated != 2)
    throw ConfigError({.file = {}, .key = "--restitution"},
                      "and --contact-time give k_n and gamma_n, --k-n and --gamma-n give the reverse; give "
                      "exactly one of the two pairs.");
  double e = 0, t_c = 0;
  calibration::SpringDashpot s;
  if (back) {
    e = *o.restitution;
    t_c = *o.contact_time;
    s = calibration::spring_of(e, t_c, o.m_eff);
    if (!std::isfinite(s.k_n) || !(s.k_n > 0) || !std::isfinite(s.c_n))
      throw ConfigError(
          {.file = {}, .key = "--contact-time"},
          fmt::format("is {:g}; with --restitution {:g} no stiffness that can be computed follows.", t_c, e));
  } else {
    const sim::LinearCollision c(*o.k_n, *o.gamma_n * o.m_eff, o.m_eff);
    e = c.restitution();
    t_c = c.contact_time();
    s = {.k_n = *o.k_n, .gamma_n = *o.gamma_n, .c_n = *o.gamma_n * o.m_eff};
  }
  constexpr double kSoft = 100;  // m g/sigma
  if (s.k_n < kSoft)
    note(
        common,
        fmt::format("by its own weight a bead sinks {:.3g} sigma into a plate of this stiffness; the contact "
                    "time is in t0 = sqrt(sigma/g), which is 14 ms for beads of 2 mm, not in s or ms.",
                    1 / s.k_n));
  const nlohmann::json d = {{"m_eff", o.m_eff}, {"restitution", e},     {"contact_time", number_or_null(t_c)},
                            {"k_n", s.k_n},     {"gamma_n", s.gamma_n}, {"c_n", s.c_n}};
  std::string text;
  if (!std::isfinite(t_c))
    text = fmt::format(
        "The contact is overdamped, because gamma_n is at least 2 sqrt(k_n/m_eff) = {:.8g}/t0: beads that "
        "touch never separate, so there is no t_c.\n",
        2 * std::sqrt(s.k_n / o.m_eff));
  print_result(
      common, d,
      text +
          fmt::format(
              "e_n = {:.8g}, t_c = {:.8g} t0  <->  k_n = {:.8g} m g/sigma, gamma_n = {:.8g}/t0, c_n = {:.8g} "
              "m/t0  (m_eff = {:g})\n",
              e, t_c, s.k_n, s.gamma_n, s.c_n, o.m_eff));
}

}  // namespace

void add_calibrate_contacts(CLI::App& calibrate, Common& common) {
  CLI::App& verb = add_verb(calibrate, common, "contacts",
                            "Measure restitution and friction from collisions. Prints the values; -o also "
                            "writes them to a calibration file.",
                            "twincell calibrate contacts bounce bounce.csv -o cell.calibration.toml");
  verb.require_subcommand(1);
  {
    auto o = std::make_shared<BounceFlags>();
    CLI::App& kind = add_verb(verb, common, "bounce",
                              "Measure the restitution e_n between bead and plate from a bouncing bead. "
                              "Prints every impact; -o also writes e_n to a calibration file.",
                              "twincell calibrate contacts bounce bounce.csv --gravity 9.81");
    kind.add_option("source", o->source, "CSV with columns time and height, or a trajectory (H5MD)")
        ->required();
    kind.add_option("--bead", o->bead, "Index of the bead in the trajectory, from 0; default: 0");
    kind.add_option("--gravity", o->gravity,
                    "Fixed acceleration of gravity, in the units of heights and times; default: fitted")
        ->check(above_zero());
    kind.add_flag("--no-drag", o->no_drag, "Do not fit the drag of the air");
    kind.add_option("--drive-amplitude", o->amplitude,
                    "Amplitude A of the vibrating plate, in the unit of the heights; default: the drive of "
                    "the trajectory, for CSV a plate at rest")
        ->check(zero_or_above());
    kind.add_option(
            "--drive-omega", o->omega,
            "Angular frequency omega of the vibrating plate, in rad per unit of time; with --drive-amplitude")
        ->check(above_zero());
    former_option(kind, "--amplitude", "--drive-amplitude");
    former_option(kind, "--omega", "--drive-omega");
    former_option(kind, "--phase", "--drive-phase");
    kind.add_option("--drive-phase", o->phase, "Phase of the plate at time 0, rad; default: 0");
    add_output_flags(kind, common, o->out, "bounce");
    kind.callback([o, &common] { run_bounce(*o, common); });
  }
  {
    auto o = std::make_shared<CollisionFlags>();
    CLI::App& kind = add_verb(verb, common, "collisions",
                              "Measure e_n, mu and beta_0 from collisions of two beads. Prints the values; "
                              "-o also writes them to a calibration file.",
                              "twincell calibrate contacts collisions sim.h5 -o cell.calibration.toml");
    kind.add_option("trajectory", o->trajectory,
                    "Trajectory (H5MD) with closely spaced frames: several per mean free flight")
        ->required();
    kind.add_option("--gravity", o->options.gravity,
                    "Acceleration of gravity along -z, reduced units; default: that of the trajectory");
    kind.add_option("--least-speed", o->options.least_speed,
                    "Smallest speed of approach, sigma/t0; slower impacts are left out")
        ->check(zero_or_above())
        ->capture_default_str();
    kind.add_option("--shape", o->shape,
                    "Shape of the beads, which sets their moment of inertia: disc (default) or sphere")
        ->check(CLI::IsMember({"disc", "sphere"}));
    add_output_flags(kind, common, o->out, "collisions");
    kind.callback([o, &common] { run_collisions(*o, common); });
  }
  add_calibrate_infer(verb, common);
  {
    auto o = std::make_shared<NumberFlags>();
    CLI::App& kind = add_verb(verb, common, "numbers",
                              "Convert e_n and t_c to k_n and gamma_n, or the reverse. Prints the values.",
                              "twincell calibrate contacts numbers --restitution 0.9 --contact-time 2.2e-3");
    kind.add_option("--restitution", o->restitution,
                    "Coefficient of restitution e_n, above 0, at most 1; with --contact-time");
    kind.add_option("--contact-time", o->contact_time, "Contact time t_c, t0; with --restitution");
    kind.add_option("--k-n", o->k_n, "Stiffness k_n, m g/sigma; with --gamma-n")->check(above_zero());
    kind.add_option("--gamma-n", o->gamma_n, "Damping rate gamma_n, 1/t0; with --k-n")
        ->check(zero_or_above());
    kind.add_option("--m-eff", o->m_eff, "Effective mass, m; 0.5: two beads; 1: bead and wall")
        ->check(above_zero())
        ->capture_default_str();
    kind.callback([o, &common] { run_numbers(*o, common); });
  }
}

}  // namespace twincell::cli
