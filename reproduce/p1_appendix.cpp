// Fortini & Huang 2015, appendices: one contact of the model (A, Fig. 6) and the order parameters of the
// phases (B), both against closed forms.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "analysis/motion/bed_phase.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "core/cancellation.hpp"
#include "core/json_text.hpp"
#include "reproduce/p1_scene.hpp"
#include "reproduce/reproduction.hpp"
#include "reproduce/rigid_bed.hpp"
#include "sim/accuracy/work_precision.hpp"
#include "sim/laws/linear_collision.hpp"
#include "sim/run/make_solver.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

/// Steps per contact. The paper has 50, but a whole number would hide errors of contact entry.
constexpr double kSteps = 50.37;

Target near(const std::string& name, double expected, double tolerance, double measured, const char* digits) {
  const auto number = [&](double v) { return fmt::format(fmt::runtime(digits), v); };
  return {name, fmt::format("{} +- {:.2g}", number(expected), tolerance), number(measured),
          judge(exact(measured), expected - tolerance, expected + tolerance), ""};
}

// --- Appendix A ---

struct Contact {
  const char* name;
  double m_eff, t_c, e_n;  ///< values of MODEL for eq. A5
};
constexpr std::array<Contact, 2> kContacts = {
    {{"bead-bead", 0.5, 2.222831e-3, 0.894812}, {"bead-wall", 1.0, 3.145527e-3, 0.854468}}};

/// State at one instant of a collision.
struct CollisionState {
  double time, overlap, force;  ///< time since first touch; unit approach speed
};

sim::Scene scene_of(const std::string& more) {
  return sim::read_scene_text(
      "preset = \"fortini-huang-2015\"\nbeads.count = 1\ndrive.amplitude = 0.0\ncell.height = "
      "100.0\ncell.lid = \"wall\"\n" +
          more,
      "appendix A");
}

/// The closed form of a contact of the preset.
sim::LinearCollision closed_form(const Contact& contact) {
  const sim::Scene scene = scene_of("");
  const sim::ContactTable& table = contact.m_eff < 1 ? scene.contact.bead : scene.contact.wall.at("left");
  return {sim::read_stiffness(table),
          sim::read_normal_damping(table, sim::read_stiffness(table)).eta(contact.m_eff), contact.m_eff};
}

/// Collision of a bead with another bead or with the left wall, at unit approach speed and without gravity.
std::vector<CollisionState> collide(const Contact& contact) {
  const bool pair = contact.m_eff < 1;
  const sim::Scene scene = scene_of("cell.gravity = 0.0\ntime.integrator = \"verlet\"\n");
  const sim::Plan plan = sim::make_plan(scene);
  sim::System system = sim::make_system(scene, plan);
  system.dt = contact.t_c / kSteps;
  const double gap = 1.4 * system.dt;  // the contact starts within a step
  const auto add = [&](double x, double vx) {
    system.beads.push_back({x, 50, vx, 0, 0, scene.radius, scene.mass,
                            scene.inertia_factor * scene.mass * scene.radius * scene.radius});
  };
  if (pair) add(10, 0.5);
  add(pair ? 11 + gap : 0.5 + gap, pair ? -0.5 : -1);
  const auto kernel = sim::make_solver(plan, {});
  std::vector<CollisionState> states;
  for (int k = 1; static_cast<double>(k) < 1.15 * kSteps; ++k) {
    throw_if_cancelled();
    kernel->advance(system, 1);
    const double x = system.beads.back().x;
    const double overlap = pair ? 1 - (x - system.beads.front().x) : 0.5 - x;
    states.push_back({static_cast<double>(k) * system.dt - gap, overlap, system.forces.back().x});
  }
  return states;
}

/// Time from first touch to overlap 0, by linear interpolation between the two instants around the end.
double duration_of(const std::vector<CollisionState>& states) {
  for (std::size_t k = 2; k < states.size(); ++k) {
    const CollisionState &a = states[k - 1], &b = states[k];
    if (a.time > 0 && a.overlap > 0 && b.overlap <= 0)
      return a.time + (b.time - a.time) * a.overlap / (a.overlap - b.overlap);
  }
  return std::nan("");
}

/// Targets, numbers and line of the table for one contact.
/// \param e error of e_n in simulated collisions \param t_c of a simulated collision, t_0
void add_contact(Reproduction& r, json& measured, const Contact& c, const sim::LinearCollision& form,
                 const sim::EntryPhaseSpread& e, double t_c) {
  const bool pair = c.m_eff < 1;
  const std::string kind = c.name;
  r.targets.push_back(
      near(kind + ", t_c by eq. A5, t_0", c.t_c, 1e-6 * c.t_c, form.contact_time(), "{:.6e}"));
  r.targets.push_back(near(kind + ", e_n by eq. A5", c.e_n, 1e-6, form.restitution(), "{:.6f}"));
  r.targets.push_back(near(kind + ", t_c of a collision run, t_0", c.t_c, c.t_c / kSteps, t_c, "{:.6e}"));
  r.targets.back().reason = fmt::format("one of {:g} steps", kSteps);
  r.targets.push_back(near(kind + ", e_n of collisions run, mean over entry phases", c.e_n,
                           pair ? 3e-4 : 6e-4, form.restitution() + e.mean, "{:.6f}"));
  const double n_own = kSteps * c.t_c / kContacts[0].t_c;
  r.targets.push_back(near(kind + ", e_n of collisions run, the worst entry phase less the exact", 0,
                           (pair ? 0.25 : 0.35) / n_own, e.largest, "{:.6f}"));
  measured.push_back({{"contact", kind},
                      {"t_c", form.contact_time()},
                      {"e_n", form.restitution()},
                      {"t_c_run", t_c},
                      {"e_n_run_mean", form.restitution() + e.mean},
                      {"e_n_run_worst_error", e.largest}});
  r.table += fmt::format(
      "  {}: t_c {:.6e} t_0, e_n {:.6f}; run: t_c {:.6e}, e_n {:.6f} in the mean, worst error {:.5f}\n", kind,
      form.contact_time(), form.restitution(), t_c, form.restitution() + e.mean, e.largest);
}

/// Data of the figure of collisions, and the clauses of its panels and its key.
struct CollisionCurves {
  std::string data, overlap, force, key;
  int index = 0;  ///< number of the data block
};

void add_curves(CollisionCurves& curves, const Contact& c, const sim::LinearCollision& form,
                const std::vector<CollisionState>& states) {
  const bool pair = c.m_eff < 1;
  const std::string kind = c.name;
  // Units of the figure: time in 10^-3 t_0, overlap in 10^-4 sigma and force in 10^2 m g, at unit approach
  // speed.
  curves.data += fmt::format("# {}, run: t, overlap, normal force\n", kind);
  for (const CollisionState& m : states)
    if (m.overlap > 0)
      curves.data += fmt::format("{:.6f} {:.6f} {:.6f}\n", 1e3 * m.time, 1e4 * m.overlap, m.force / 100);
  curves.data += "\n\n";
  const double w = std::numbers::pi / form.contact_time();
  const double eta = 2 * form.beta * c.m_eff, k = form.w0 * form.w0 * c.m_eff;
  const std::string wave = fmt::format("exp(-{0:.9g}*x)*sin({1:.9g}*x)", form.beta * 1e-3, w * 1e-3);
  const std::string slope = fmt::format("exp(-{0:.9g}*x)*({1:.9g}*cos({1:.9g}*x)-{0:.9g}*sin({1:.9g}*x))",
                                        form.beta * 1e-3, w * 1e-3);
  const std::string look =
      fmt::format("lc rgb '{}'", pair ? analysis::colours::kBlue : analysis::colours::kVermilion);
  const int symbol = analysis::figure_style::unfilled(pair ? analysis::figure_style::kCircle
                                                           : analysis::figure_style::kTriangle);
  curves.key += fmt::format("{}keyentry with points pt {} {} title '{}'", curves.key.empty() ? "" : ", ",
                            symbol, look, kind);
  const std::string range = fmt::format("[0:{:.6g}]", 1e3 * c.t_c);
  const auto clause = [&](std::string& clauses, int column, const std::string& curve) {
    clauses += fmt::format(
        "{0}'p1-appendix-a.dat' index {1} using 1:{2} with points pt {3} ps 0.7 {4} notitle, {5} {6} with "
        "lines lw {7} {4} notitle",
        clauses.empty() ? "" : ", ", curves.index, column, symbol, look, range, curve,
        analysis::figure_style::kLine);
  };
  clause(curves.overlap, 2, fmt::format("{:.9g}*{}", 1e4 / w, wave));
  clause(curves.force, 3,
         fmt::format("{:.9g}*{} + {:.9g}*{}", k / w / 100, wave, eta / w * 1e3 / 100, slope));
  ++curves.index;
}

/// Figure of overlap and force against time.
analysis::Figure collision_figure(const CollisionCurves& curves) {
  analysis::Figure f{.name = "p1-appendix-a", .title = "One collision", .width = 720, .height = 400};
  f.data = curves.data;
  const analysis::figure_style::Panels panels(1, 2, f.width, f.height, 1);
  analysis::figure_style::PlotAxis time{.label = "t / 10^{-3} t_0", .low = 0},
      overlap{.label = "overlap δ / 10^{-4} σ", .low = 0},
      force{.label = "normal force F_n / 10^2 m g", .low = -1};
  time.show(1e3 * kContacts[1].t_c);
  overlap.show(10);
  force.show(10);
  f.plot =
      analysis::figure_style::Panels::begin() + panels.panel(0) +
      analysis::figure_style::axes(time, overlap) + analysis::figure_style::panel_title('a', "overlap") +
      "plot " + curves.overlap + "\n" + panels.panel(1) + analysis::figure_style::axes(time, force) +
      analysis::figure_style::panel_title('b', "force") + "set xzeroaxis lw 1 lc rgb '#444444'\nplot " +
      curves.force + "\n" +
      panels.end({curves.key, fmt::format("keyentry with lines lw {} lc rgb '#333333' title 'closed form'",
                                          analysis::figure_style::kCurve)});
  f.caption = fmt::format(
      "A bead meets another, and a wall, with unit speed. Points: run with Verlet steps, n = {:g}; lines: "
      "closed forms that belong to eq. A5. The force is negative at the end: tension is allowed.",
      kSteps);
  return f;
}

void add_contacts(Reproduction& r, json& measured) {
  const sim::CollisionErrors errors =
      sim::collision_errors({.integrator = "verlet", .n = kSteps, .k_n = 1e6});
  CollisionCurves curves;
  for (const Contact& c : kContacts) {
    const sim::LinearCollision form = closed_form(c);
    const std::vector<CollisionState> states = collide(c);
    add_contact(r, measured, c, form, c.m_eff < 1 ? errors.restitution_pair : errors.restitution_wall,
                duration_of(states));
    add_curves(curves, c, form, states);
  }
  // One phase per period, because more phases round the number of steps up to a multiple of the phases.
  const sim::Scene paper = scene_of("time.steps_per_contact = 50\ntime.phases = 1\n");
  const auto steps = static_cast<double>(sim::make_plan(paper).steps_per_period);
  r.targets.push_back(near("steps a period at n = 50", 141333, 0, steps, "{:.0f}"));
  measured.push_back({{"steps_per_period", steps}});
  r.figures.push_back(collision_figure(curves));
}

/// Fig. 6: sketch of the symbols of a contact.
analysis::Figure contact_sketch() {
  analysis::Figure f{.name = "p1-fig6", .title = "Contact of two beads", .width = 540, .height = 360};
  f.data = "# centres and radii\n-0.84 -0.24 1\n0.84 0.24 1\n";
  f.plot =
      "set size ratio -1\nunset tics\nunset border\nunset grid\nunset key\nset xrange [-2.1:2.1]\nset yrange "
      "[-1.5:1.5]\n"
      "set style arrow 1 head filled size 0.1,18 lw 2 lc rgb '#222222'\n"
      "set style arrow 2 head filled size 0.1,18 lw 2 lc rgb blue\n"
      "set style arrow 3 heads size 0.05,90 lw 1.5 lc rgb vermilion\n"
      "set arrow 1 from 0.84,0.24 to 1.513,0.432 arrowstyle 1 front\nset label 1 'n_{ij}' at 1.5,0.56\n"
      "set arrow 2 from 0,0 to -0.192,0.673 arrowstyle 1 front\nset label 2 't_{ij}' at -0.52,0.86 front\n"
      "set arrow 3 from 0.84,0.24 to 0.45,0.95 arrowstyle 2 front\nset label 3 'v_{ij}' at 0.55,1.02 front "
      "tc rgb blue\n"
      "set arrow 4 from -0.122,-0.035 to 0.122,0.035 arrowstyle 3 front\n"
      "set label 4 'δ_{n}' at 0.14,-0.12 tc rgb vermilion front\n"
      "set label 5 'j' at -0.9,-0.24 front\nset label 6 'i' at 0.8,0.05 front\n"
      "plot 'p1-fig6.dat' using 1:2:3 with circles fs transparent solid 0.35 border lc rgb '#555555' fc rgb "
      "sky\n";
  f.caption =
      "Two beads that overlap by δ_n: unit vectors n_ij from j to i and t_ij along the tangential part of "
      "the relative velocity v_ij. Form of Fortini & Huang 2015, Fig. 6.";
  return f;
}

// --- Appendix B ---

double s_b_of_rigid_bed(double gamma, analysis::SbForm form) {
  analysis::AnalysisOptions options;
  options.s_b = form;
  options.only = {"s_b"};
  return analysis::find_result(
             analysis::analyze(
                 rigid_bed({.gamma = gamma, .columns = 6, .rows = 5, .phases = 240, .cycles = 2}), options),
             "s_b")
      .value();
}

double threshold_gamma(analysis::SbForm form) {
  double low = 1.1, high = 1.25;
  for (int i = 0; i < 14; ++i) {
    const double middle = (low + high) / 2;
    (s_b_of_rigid_bed(middle, form) < analysis::kBouncingThreshold ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Gamma, and s_b of a completely inelastic rigid bed as variance and about rest, computed independently of
/// the analysis.
constexpr std::array<std::array<double, 3>, 9> kRigidBed = {{{1.05, 0.0027, 0.0029},
                                                             {1.10, 0.0119, 0.0131},
                                                             {1.15, 0.0279, 0.0314},
                                                             {1.20, 0.0502, 0.0577},
                                                             {1.30, 0.1122, 0.1333},
                                                             {1.40, 0.1945, 0.2376},
                                                             {1.50, 0.2935, 0.3677},
                                                             {1.80, 0.6663, 0.8898},
                                                             {2.00, 0.9586, 1.3282}}};

struct RigidBedPoints {
  std::string data;    ///< of the figure
  double gamma = 0.0;  ///< of the threshold, for the variance
};

/// s_b of the rigid bed against its closed form, and the Gamma of the threshold.
RigidBedPoints add_rigid_bed(Reproduction& r, json& measured) {
  RigidBedPoints points;
  double worst = 0, worst_rest = 0;
  for (const auto& [at, variance, rest] : kRigidBed) {
    const double v = s_b_of_rigid_bed(at, analysis::SbForm::variance),
                 a = s_b_of_rigid_bed(at, analysis::SbForm::about_rest);
    worst = std::max(worst, std::abs(v - variance));
    worst_rest = std::max(worst_rest, std::abs(a - rest));
    points.data += fmt::format("{} {:.6f} {:.6f} {} {}\n", at, v, a, variance, rest);
    measured.push_back({{"rigid_bed_gamma", at}, {"s_b_variance", v}, {"s_b_about_rest", a}});
  }
  r.targets.push_back(
      near("B3, B4: s_b of the rigid bed at nine Gamma, variance, largest error", 0, 1e-3, worst, "{:.5f}"));
  r.targets.push_back(near("B3, B4: the same about rest", 0, 1e-3, worst_rest, "{:.5f}"));
  const double gamma = threshold_gamma(analysis::SbForm::variance),
               rest = threshold_gamma(analysis::SbForm::about_rest);
  points.gamma = gamma;
  r.targets.push_back(
      near("B4: Gamma at which s_b of the rigid bed is sigma/30, variance", 1.1636, 2e-4, gamma, "{:.4f}"));
  r.targets.push_back(near("B4: the same about rest", 1.1542, 2e-4, rest, "{:.4f}"));
  measured.push_back({{"threshold_gamma_variance", gamma}, {"threshold_gamma_about_rest", rest}});
  r.table += fmt::format("  rigid bed: s_b = sigma/30 at Gamma {:.4f} (variance), {:.4f} (about rest)\n",
                         gamma, rest);
  return points;
}

/// s_c of a sheared line of tracers against its closed form.
void add_sheared_line(Reproduction& r, json& measured) {
  // B1, B2: a line of tracers at unit distances, sheared by a x j: var(x) = (n^2 - 1)/12.
  constexpr double kShear = 0.03;
  constexpr int kCycles = 12;
  const auto results =
      analysis::analyze(rigid_bed({.gamma = 1.5, .cycles = kCycles, .shear_per_cycle = kShear}));
  const analysis::Result& tracers = analysis::find_result(results, "tracers");
  const auto n = static_cast<double>(tracers.values.size());
  double mean_j2 = 0;
  for (int j = 0; j < kCycles; ++j) mean_j2 += static_cast<double>(j) * j / kCycles;
  const double s_c = kShear * std::sqrt((n * n - 1) / 12 * mean_j2);
  const double found = analysis::find_result(results, "s_c").value();
  r.targets.push_back(
      near("B1, B2: s_c of a line sheared by 0.03 a cycle, 12 cycles, sigma", s_c, 1e-9, found, "{:.9f}"));
  r.table += fmt::format("  sheared line of {:g} tracers: s_c {:.9f}, closed form {:.9f}\n", n, found, s_c);
  measured.push_back({{"sheared_line_s_c", found}, {"closed_form", s_c}});
}

/// Figure of s_b against Gamma.
analysis::Figure rigid_bed_figure(const RigidBedPoints& points) {
  analysis::Figure f{
      .name = "p1-appendix-b", .title = "s_b of a rigid inelastic bed", .width = 640, .height = 480};
  analysis::figure_style::PlotAxis strength{.label = "Γ = A ω^2/g"},
      s_b{.label = "s_b/σ", .logarithmic = true};
  for (const auto& [at, variance, rest_form] : kRigidBed) {
    strength.show(at);
    s_b.show(variance);
    s_b.show(rest_form);
  }
  f.data = "# Gamma, s_b found by the analysis: variance, about rest; closed form: variance, about rest\n" +
           points.data;
  f.plot = fmt::format(
      "{3}set arrow 1 from first {0:.5f},graph 0 to first {0:.5f},first {1:.6f} nohead dt 2 lc rgb blue\n"
      "set label 1 'Γ = {0:.4f}' at first {0:.5f},graph 0.05 offset 0.7,0\n"
      "plot {1:.6f} with lines {4} title 'σ/30', '{2}.dat' using 1:4 with lines lw 1.3 lc rgb blue notitle, "
      "'' using 1:2 with points pt 7 ps 0.9 lc rgb blue title 'variance over phases', '' using 1:5 with "
      "lines lw 1.3 lc rgb vermilion notitle, '' using 1:3 with points pt 6 ps 0.9 lc rgb vermilion title "
      "'about the height at rest'\n",
      points.gamma, analysis::kBouncingThreshold, f.name, analysis::figure_style::axes(strength, s_b),
      analysis::figure_style::kStated);
  f.caption =
      "s_b (eq. B4) of a completely inelastic rigid bed, found by the analysis of a synthetic trajectory "
      "(points) and in closed form (lines through the table). The threshold σ/30 lies on displacement, not "
      "on contact: it is passed at Γ above 1.";
  return f;
}

void add_measures(Reproduction& r, json& measured) {
  const RigidBedPoints points = add_rigid_bed(r, measured);
  add_sheared_line(r, measured);
  r.figures.push_back(rigid_bed_figure(points));
}

Reproduction run(const Request&) {
  Reproduction r;
  r.title = "Fortini & Huang 2015, appendices: the contact (A) and the measures of the phases (B)";
  r.complete = true;
  json measured = json::array();
  add_contacts(r, measured);
  r.figures.push_back(contact_sketch());
  add_measures(r, measured);
  r.measured = json_text(measured);
  r.runs = "no seeds";
  r.conditions = p1_contact_conditions();
  r.conditions.push_back(
      fmt::format("collisions: integrator verlet, n = {:g} steps per contact, without gravity", kSteps));
  r.conditions.emplace_back("no seeds: nothing here is drawn");
  return r;
}

}  // namespace

Reproducible p1_appendix() {
  return {.name = "p1-appendix",
          .what = "single contact (app. A) and phase thresholds (app. B) against closed forms",
          .run = run,
          .time_share = 0.1,
          .judges_again = true};
}

}  // namespace twincell::reproduce
