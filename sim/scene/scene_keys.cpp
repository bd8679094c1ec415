#include "sim/scene/scene_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sim/laws/law_words.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::sim {

namespace {

using Rows = std::vector<KeyRow>;

/// The rows of a length: the plain key, then its spellings with units. The other members are those of the
/// plain key.
void add_length(Rows& rows, const KeyRow& plain, const std::string& millimetres) {
  rows.push_back(plain);
  const auto spelling = [&](const std::string& key, const std::string& unit, const std::string& example,
                            const std::string& meaning) {
    std::vector<std::string> with = plain.with;
    if (unit == "mm") with.emplace_back("scale.sigma_mm=2.0");
    rows.push_back({key, unit, "", example, meaning, with});
  };
  spelling(plain.key + "_sigma", "σ", plain.example, "");
  spelling(plain.key + "_mm", "mm", millimetres, "");
}

/// The rows of a radius, also as a diameter. \param d_sigma, d_mm examples
void add_radius(Rows& rows, const KeyRow& plain, const std::string& millimetres, const std::string& d_sigma,
                const std::string& d_mm) {
  add_length(rows, plain, millimetres);
  const std::string key = plain.key.substr(0, plain.key.rfind('.')) + ".diameter";
  rows.push_back({key + "_sigma", "σ", "", d_sigma, "twice the radius", plain.with});
  std::vector<std::string> with = plain.with;
  with.emplace_back("scale.sigma_mm=2.0");
  rows.push_back({key + "_mm", "mm", "", d_mm, "twice the radius", with});
}

const std::vector<std::string> kSpace = {"cell.dimension=3", "cell.depth_sigma=5.0"};

void add_cell(Rows& rows) {
  rows.push_back({"cell.dimension", "", "2", "3", "2: the plane (x, z); 3: space", {"cell.depth_sigma=5.0"}});
  add_length(rows, {"cell.width", "σ", "20.0", "30.0", "L_x, distance or period of the sides"}, "40.0");
  add_length(rows,
             {"cell.depth",
              "σ",
              "required in 3D",
              "5.0",
              "L_y: the period, or the gap between front and back; 3D only",
              {"cell.dimension=3"}},
             "10.0");
  add_length(
      rows,
      {"cell.height", "σ", "no limit", "60.0",
       "height of the lid above the plate; without a lid, the run stops when a bead reaches it; with a "
       "periodic bottom, the period along z"},
      "120.0");
  const Rows rest = {
      {"cell.sides", "", "\"walls\"", "\"periodic\"", "left and right"},
      {"cell.plates", "", "\"walls\"", "\"periodic\"", "front and back; 3D only", kSpace},
      {"cell.bottom",
       "",
       "\"wall\"",
       "\"periodic\"",
       "\"periodic\": z has the period cell.height, and gravity presses the beads against a side wall",
       {"cell.height=20.0", "cell.gravity=[1.0, 0.0]"}},
      {"cell.lid", "", "\"absent\"", "\"wall\"", "\"wall\": a hard lid at cell.height", {"cell.height=20.0"}},
      {"cell.bottom_motion", "", "\"move\"", "\"rest\"",
       "\"move\": the wall moves with the plate, as the walls of a shaken cell do; \"rest\": the wall is at "
       "rest, which is a different experiment"},
      {"cell.side_walls", "", "\"move\"", "\"rest\"", "the same for the side walls"},
      {"cell.plates_motion", "", "\"move\"", "\"rest\"", "the same for front and back", kSpace},
      {"cell.lid_motion",
       "",
       "\"move\"",
       "\"rest\"",
       "the same for the lid",
       {"cell.lid=wall", "cell.height=20.0"}},
      {"cell.side_tilt", "degrees", "0", "[0.2, -0.1]",
       "angle by which the side walls lean outward about their lower ends; one number, or [left, right]"},
      {"cell.gravity", "g", "1", "0.5", "g, along −z; or a vector [g_x, g_z], in 3D [g_x, g_y, g_z]"},
      {"cell.tilt", "degrees", "0", "2.0", "inclination of the cell, x downhill; not with a gravity vector"},
      {"cell.plate_drag", "1/t0", "0", "0.01",
       "2D substitute for front and back plates: the rate c of a force −c m (v − v_cell)"}};
  rows.insert(rows.end(), rest.begin(), rest.end());
}

void add_beads(Rows& rows) {
  rows.push_back(
      {"beads.count", "", "required without a file of beads", "400",
       "number of beads, not counting an intruder; memory limits it as well (`explain` prints it)"});
  rows.push_back({"beads.layers", "", "", "10",
                  "instead of count: beads per diameter of width, in 3D per square diameter; "
                  "count = layers · L_x (· L_y)/d²"});
  add_radius(rows, {"beads.radius", "σ", "0.5", "0.6", "radius of every bead, or of a bead of mean size"},
             "1.2", "1.2", "2.4");
  rows.push_back({"beads.mass", "m", "1", "1.5", "mass of a bead of that radius"});
  rows.push_back({"beads.inertia", "", "\"disc\"; in 3D \"sphere\"", "\"sphere\"",
                  "\"disc\": I = mR²/2, 2D only; \"sphere\": I = 2mR²/5"});
  rows.push_back({"beads.spread",
                  "",
                  "\"none\"",
                  "\"normal\"",
                  "distribution of the radii, drawn with start.seed (not for a table); masses scale as R² "
                  "(discs) or R³ (spheres)",
                  {"beads.spread_width=0.05"}});
  rows.push_back({"beads.spread_width",
                  "radius",
                  "required with a spread",
                  "0.05",
                  "below 0.5; half width (uniform) or standard deviation (normal, truncated at three "
                  "standard deviations or 0.9)",
                  {"beads.spread=uniform"}});
  const std::string inside = "; inside the cell";
  const std::vector<std::string> height = {"beads.intruder.z_sigma=5.0"},
                                 radius = {"beads.intruder.radius_sigma=2.0", "beads.intruder.z_sigma=5.0"};
  add_radius(rows, {"beads.intruder.radius", "σ", "required with an intruder", "2.0", "its radius", height},
             "4.0", "4.0", "8.0");
  rows.push_back({"beads.intruder.mass", "m", "that of the same material", "4.0", "its mass", radius});
  const std::string middle = "middle of the cell";
  add_length(rows, {"beads.intruder.x", "σ", middle, "8.0", "position of its centre" + inside, radius},
             "16.0");
  std::vector<std::string> space = radius;
  space.insert(space.end(), kSpace.begin(), kSpace.end());
  add_length(rows, {"beads.intruder.y", "σ", middle, "2.4", "the same along y; 3D only", space}, "4.8");
  add_length(rows,
             {"beads.intruder.z",
              "σ",
              "required with an intruder",
              "5.0",
              "height of its centre at the start" + inside,
              {"beads.intruder.radius_sigma=2.0"}},
             "10.0");
}

/// "; read by linear, cohesive", for a key of the laws.
std::string law_clause(const std::string& key) {
  const std::string axis = readers_of(key).axis;
  return fmt::format("; read by {}{}", axis == "rolling" ? "rolling " : "",
                     fmt::join(readers_of(key).laws, ", "));
}

void add_contact(Rows& rows) {
  rows.push_back(
      {"contact.normal", "", "\"linear\"", "\"hertz\"", normal_help(), {"contact.youngs_modulus=1e7"}});
  rows.push_back({"contact.tangential", "", "\"spring\"", "\"dashpot\"", tangential_help()});
  rows.push_back({"contact.rolling",
                  "",
                  "\"none\"",
                  "\"spring\"",
                  rolling_help() + "; tangential \"none\" allows only rolling \"none\"",
                  {"contact.k_r=1e3", "contact.mu_r=0.1"}});
  rows.push_back({"contact.overlap_bound", "bead diameter", "0.1", "0.05",
                  "deepest overlap that does not stop the run, in diameters of the median bead"});
  const std::vector<std::string> hertz = {"contact.normal=hertz"},
                                 moduli = {"contact.normal=hertz", "contact.youngs_modulus=1e7"},
                                 rolling = {"contact.rolling=spring", "contact.k_r=1e3", "contact.mu_r=0.1"},
                                 falling = {"contact.normal=velocity-dependent-restitution"};
  const Rows laws = {
      {"contact.k_n", "m g/σ", "1e6", "2e6", "normal spring constant"},
      {"contact.gamma_n", "1/t0", "no damping", "100.0",
       "normal damping as a rate γ_n: force γ_n m_eff v_n; one of gamma_n, c_n, restitution"},
      {"contact.c_n", "m/t0", "no damping", "50.0", "normal damping as a constant: force c_n v_n"},
      {"contact.restitution", "1", "no damping", "0.9",
       "e_n, from which the damping constant of each kind of contact is computed"},
      {"contact.youngs_modulus", "m g/σ²", "required", "1e7", "Y", hertz},
      {"contact.poisson_ratio", "1", "0.3", "0.2", "ν", moduli},
      {"contact.viscous_time", "t0", "0", "1e-4", "A of the viscoelastic contact", moduli},
      {"contact.restitution_fast", "1", "0.7", "0.8", "e_0 of fast impacts", falling},
      {"contact.restitution_speed", "v0", "1", "0.5", "speed above which e_0 applies", falling},
      {"contact.pull_off_force",
       "m g",
       "required",
       "2.0",
       "attraction F_c while the surfaces touch",
       {"contact.normal=cohesive"}},
      {"contact.k_t", "m g/σ", "1e4", "2e4", "tangential spring constant; 0 disables history"},
      {"contact.gamma_t", "1/t0", "no damping", "100.0",
       "tangential damping as a rate; one of gamma_t, c_t, c_t_over_c_n"},
      {"contact.c_t", "m/t0", "no damping", "50.0", "tangential damping as a constant"},
      {"contact.c_t_over_c_n",
       "1",
       "no damping",
       "0.5",
       "tangential over normal damping constant",
       {"contact.restitution=0.9"}},
      {"contact.mu", "1", "0.6", "0.4",
       "Coulomb coefficient. The value 0 at all contacts disables friction, rotation and history; it is the "
       "only value that tangential \"none\" allows"},
      {"contact.k_r",
       "m g σ",
       "required",
       "1e3",
       "torsional spring constant",
       {"contact.rolling=spring", "contact.mu_r=0.1"}},
      {"contact.c_r", "m g σ t0", "0", "1.0", "torsional dashpot", rolling},
      {"contact.mu_r",
       "1",
       "required",
       "0.1",
       "limit of the torque: μ_r R_eff |F_n|",
       {"contact.rolling=spring", "contact.k_r=1e3"}}};
  for (KeyRow row : laws) {
    row.meaning += law_clause(row.key.substr(row.key.find('.') + 1));
    rows.push_back(std::move(row));
  }
}

void add_drive(Rows& rows) {
  const std::vector<std::string> laboratory = {"scale.sigma_mm=2.0", "scale.gravity_m_s2=9.81"};
  const std::vector<std::string> recorded = {"scale.sigma_mm=2.0", "scale.gravity_m_s2=9.81",
                                             "drive.file=trace.csv"};
  const Rows drive = {
      {"drive.amplitude", "σ", "two quantities are required", "1.5", "A"},
      {"drive.amplitude_sigma", "σ", "", "1.5", ""},
      {"drive.amplitude_mm", "mm", "", "3.0", "", laboratory},
      {"drive.omega", "1/t0", "", "1.0", "ω"},
      {"drive.omega_per_t0", "1/t0", "", "1.0", ""},
      {"drive.omega_rad_s", "rad/s", "", "70.0", "", laboratory},
      {"drive.frequency", "1/t0", "", "0.16", "f = ω/2π"},
      {"drive.frequency_per_t0", "1/t0", "", "0.16", ""},
      {"drive.frequency_hz", "1/s", "", "11.0", "", laboratory},
      {"drive.gamma", "1", "", "2.0", "Γ = Aω²/g; needs gravity; with harmonics, that of the first"},
      {"drive.peak_acceleration_g", "g", "", "2.0", ""},
      {"drive.peak_acceleration_m_s2", "m/s²", "", "19.6", "", laboratory},
      {"drive.k_m", "1", "", "4.0", "K_m = A²ω²/(gσ), also called W and S; needs gravity"},
      {"drive.peak_velocity", "v0", "", "2.0", "Aω"},
      {"drive.peak_velocity_v0", "v0", "", "2.0", ""},
      {"drive.peak_velocity_mm_s", "mm/s", "", "280.0", "", laboratory},
      {"drive.harmonics", "", "", "[[0.1, 0.25], [0.02, 0.0]]",
       "[[a_2, φ_2], [a_3, φ_3], …]: displacement A (sin ωt + Σ a_n sin(nωt + 2πφ_n)), at most 30 harmonics; "
       "a_n is relative to A, 0 to 100; φ_n in cycles of the harmonic, from 0 to below 1"},
      {"drive.file", "", "", "\"trace.csv\"",
       "CSV file of a recorded motion, which replaces the formula: columns time_s (time_ms, time_t0) and one "
       "of position_mm (_m, _sigma), velocity_mm_s (_m_s, _v0), acceleration_m_s2 (_g), positive along "
       "`axis`. A relative name is resolved from the folder of the scene file. Needs the frequency; an "
       "amplitude, Γ, K_m or peak velocity scales the record"},
      {"drive.repeat",
       "",
       "the record is not repeated",
       "true",
       "true: the record contains whole cycles, without the first sample of the next, and is repeated; of "
       "one cycle if no frequency is stated",
       {"drive.file=trace.csv"}},
      {"drive.cutoff",
       "1/t0",
       "the record is not smoothed",
       "2.0",
       "frequency above which noise of the record is removed: of the amplitude of a sine of frequency f "
       "remains 1 − (r/(1 + r))², r = (f/f_c)⁴ for frequencies far below the sampling rate; at least twice "
       "that of the drive",
       {"drive.file=trace.csv"}},
      {"drive.cutoff_per_t0", "1/t0", "", "2.0", "", {"drive.file=trace.csv"}},
      {"drive.cutoff_hz", "1/s", "", "200.0", "", recorded},
      {"drive.file_sha256",
       "",
       "that of the file",
       "\"e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855\"",
       "SHA-256 of drive.file; another file is refused. Stored and resumed scenes state it",
       {"drive.file=trace.csv"}},
      {"drive.axis", "", "\"z\"", "\"x\"", "direction; \"y\" in 3D only"},
      {"drive.start", "", "\"comoving\"", "\"abrupt\"",
       "comoving: beads start with the velocity of the plate; abrupt: beads start at rest and the plate hits "
       "them; ramp: the amplitude increases from 0"},
      {"drive.phase", "cycles", "0; of a start in motion that of the frame", "0.25",
       "below 1: initial phase of the plate, rounded to the nearest step; 0.25 is the highest point of a "
       "sine. The settled bed is moved there with the plate. The cycle in which the drive begins counts as "
       "one of time.discard and time.cycles"},
      {"drive.ramp_cycles", "cycles", "10", "20.0", "duration of the ramp", {"drive.start=ramp"}},
      {"drive.schedule", "", "", "[[0.0, 2.0], [5.0, 1.0]]",
       "[[cycle, factor], …]: factor on the amplitude, interpolated linearly, for example to fluidise a bed "
       "and then calm it; cycles increase, factors are 0 or above, the last is 1. Not with a ramp"}};
  rows.insert(rows.end(), drive.begin(), drive.end());
  const std::string ramp = "[drive.ramp]: the drive changes linearly in time during time.cycles; ";
  const Rows changing = {
      {"drive.ramp.gamma", "1", "", "3.0",
       ramp + "Γ at its end, then Γ is linear. At most one of gamma, amplitude, k_m, peak_velocity; without "
              "any, the one of [drive] stays"},
      {"drive.ramp.peak_acceleration_g", "g", "", "3.0", ""},
      {"drive.ramp.peak_acceleration_m_s2", "m/s²", "", "29.4", "", laboratory},
      {"drive.ramp.amplitude", "σ", "", "3.0", "A at the end of the ramp, then A is linear"},
      {"drive.ramp.amplitude_sigma", "σ", "", "3.0", ""},
      {"drive.ramp.amplitude_mm", "mm", "", "6.0", "", laboratory},
      {"drive.ramp.k_m", "1", "", "9.0",
       "K_m at the end of the ramp; its root, the peak velocity, is linear"},
      {"drive.ramp.peak_velocity", "v0", "", "3.0", "Aω at the end of the ramp, then Aω is linear"},
      {"drive.ramp.peak_velocity_v0", "v0", "", "3.0", ""},
      {"drive.ramp.peak_velocity_mm_s", "mm/s", "", "420.0", "", laboratory},
      {"drive.ramp.frequency", "1/t0", "that of [drive]", "0.2",
       "f at the end of the ramp, linear in time; the phase is its integral"},
      {"drive.ramp.frequency_per_t0", "1/t0", "", "0.2", ""},
      {"drive.ramp.frequency_hz", "1/s", "", "14.0", "", laboratory},
      {"drive.ramp.omega", "1/t0", "that of [drive]", "1.25", "ω at the end of the ramp"},
      {"drive.ramp.omega_per_t0", "1/t0", "", "1.25", ""},
      {"drive.ramp.omega_rad_s", "rad/s", "", "88.0", "", laboratory},
      {"drive.ramp.return",
       "",
       "false",
       "true",
       "true: half of time.cycles, which must be even, lead to the end of the ramp, the other half back",
       {"drive.ramp.gamma=3.0", "time.cycles=4"}},
      {"drive.horizontal.amplitude", "σ", "", "0.5",
       "[drive.horizontal]: the plate and the walls that ride with it also move along x, by X sin(nωt + "
       "2πφ); X; with drive.axis = \"z\""},
      {"drive.horizontal.amplitude_sigma", "σ", "", "0.5", ""},
      {"drive.horizontal.amplitude_mm", "mm", "", "1.0", "", laboratory},
      {"drive.horizontal.ratio",
       "1",
       "1",
       "2",
       "n, a whole number from 1 to 31: frequency relative to that along z",
       {"drive.horizontal.amplitude=0.5"}},
      {"drive.horizontal.phase",
       "cycles",
       "0",
       "0.25",
       "φ in cycles of this motion, from 0 to below 1; with n = 1, 0: a tilted line; 0.25 and X = A: a "
       "circle",
       {"drive.horizontal.amplitude=0.5"}}};
  rows.insert(rows.end(), changing.begin(), changing.end());
}

void add_start_and_time(Rows& rows) {
  const std::vector<std::string> file = {"start.kind=trajectory", "start.from=bed.h5"};
  const Rows all = {
      {"start.kind", "", "\"crystal_a\"", "\"random\"", help_of(kStarts)},
      {"start.seed", "", "1", "7", "seed of all random draws: positions, sizes, perturbation"},
      {"start.from",
       "",
       "required for a file of beads",
       "\"bed.h5\"",
       "file of a trajectory or table. A relative name is resolved from the folder of the scene file (in a "
       "plan's table [scene]: of the plan file), also with --set",
       {"start.kind=trajectory"}},
      {"start.frame", "", "0", "20", "frame of a trajectory", file},
      {"start.in_motion", "", "false", "true",
       "true: beads of a file keep their velocities and spins, nothing settles, and the drive continues at "
       "once",
       file},
      {"start.perturbation", "σ", "0", "1e-9",
       "largest random displacement of each coordinate of each bead; 1e-9 breaks the symmetry of a crystal "
       "and makes it possible to run ensembles of it"},
      {"start.velocity_scale",
       "v0",
       "1",
       "0.5",
       "largest initial speed along each axis, for a random start only",
       {"start.kind=random"}},
      {"start.fraction",
       "1",
       "0.4 (3D: 0.25)",
       "0.1",
       "share of the column's area (3D: volume) that the beads of a random start cover before they fall. "
       "With a "
       "smaller share the column is taller and the last beads land later. At most 0.5 (3D: 0.35)",
       {"start.kind=random"}},
      {"start.height",
       "σ",
       "that of start.fraction",
       "60.0",
       "height of the column of a random start, instead of start.fraction: the beads of a tall column land "
       "one "
       "after another, those of a low one together",
       {"start.kind=random"}},
      {"start.fall_speed",
       "v0",
       "0",
       "2.0",
       "downward speed v of every bead of a random start, added to its random velocity "
       "(start.velocity_scale). "
       "A bead lands from the height h with the speed √(v² + 2gh)",
       {"start.kind=random"}},
      {"start.rest_energy", "m g σ", "1e-12", "1e-10",
       "kinetic energy per bead below which a bed counts as at rest"},
      {"start.relax", "", "false", "true",
       "true, or `simulate --relax`: before the run, push beads apart and out of walls, by 0.01 σ per "
       "contact and sweep, however deep the overlap"},
      {"start.settle_limit", "t0", "100", "200.0",
       "longest settling time on the resting plate; the result is printed"},
      {"time.steps_per_contact", "", "20; 50 with \"verlet\" and \"predicted\"", "40",
       "n: the time step is the shortest time scale of any contact law divided by n, adjusted so that each "
       "cycle has a whole number of steps, the same in each phase. A note is printed below 20; with "
       "allow_unstable_step the lower bound is 1"},
      {"time.allow_unstable_step", "", "false", "true",
       "true: n may be as small as 1. Below 2.7 (3.1 in 3D) a bed of touching beads is unstable"},
      {"time.integrator", "", "\"split\"", "\"verlet\"",
       "verlet: dashpots use the half-step velocity; predicted: dashpots use a velocity predicted for the "
       "end of the step; split: predicted, and steps are split where contacts begin and end, so that every "
       "collision is second order"},
      {"time.stepping", "", "\"auto\"", "\"steps\"", help_of(kSteppings)},
      {"time.precision", "", "\"double\"", "\"double\"",
       "a choice of former versions; only \"double\" is left"},
      {"time.discard", "cycles", "10", "50", "cycles run before recording, after a ramp or schedule"},
      {"time.cycles", "cycles", "200", "400", "cycles recorded"},
      {"time.phases", "", "20", "40", "N_k, frames recorded per cycle"},
      {"time.springs", "", "that of time.contacts", "true",
       "true: every frame also stores the memory of its contacts and the forces, as a start in motion needs "
       "them"},
      {"time.contacts", "", "false", "true",
       "true, or simulate --contacts: every frame also stores its contacts with pair, overlap, normal and "
       "tangential force, and time.springs is true unless stated"},
      {"time.samples", "", "400; two per phase with event-driven motion", "200",
       "samples per cycle for averages over time (granular temperature, with contacts also forces), rounded "
       "to an even number in each phase; 0: none"},
      {"until.quantity", "", "", "\"T_z\"",
       "the mean that is to be determined: \"T_x\", \"T_y\", \"T_z\", \"T\", \"T_g\", \"T_bar_z\", \"T_bar\" "
       "or \"h_cm\""},
      {"until.relative_error",
       "1",
       "0.01",
       "0.05",
       "the run ends when half of the 95 % interval of the mean is at most this fraction of the mean",
       {"until.quantity=T_z"}},
      {"until.absolute_error",
       "that of the quantity",
       "0",
       "0.001",
       "the run also ends when it is at most this value. A solid bed has T_z = 0, for which no relative "
       "error can be reached",
       {"until.quantity=T_z"}},
      {"scale.sigma_mm", "mm", "", "2.0", "laboratory value of σ"},
      {"scale.sigma_m", "m", "", "0.002", ""},
      {"scale.gravity_m_s2", "m/s²", "", "9.81", "laboratory value of g"},
      {"calibration.from", "", "", "\"cell.calibration.toml\"",
       "calibration file that supplies the keys that the scene does not set"},
      {"effects.rotation",
       "",
       "true",
       "false",
       "false: rotation need not be computed. Refused while μ > 0 at any contact, where this would change "
       "the result",
       {"contact.mu=0"}},
      {"effects.history",
       "",
       "true",
       "false",
       "false: springs with history need not be kept. Refused with k_t > 0",
       {"contact.tangential=dashpot", "contact.gamma_t=100"}}};
  rows.insert(rows.end(), all.begin(), all.end());
}

Rows all_rows() {
  Rows rows = {{"preset", "", "", "\"fortini-huang-2015\"",
                "a cell of the papers (docs/scene.md), whose keys the file overrides"}};
  add_cell(rows);
  add_beads(rows);
  add_contact(rows);
  add_drive(rows);
  add_start_and_time(rows);
  return rows;
}

}  // namespace

const KeyTable& scene_keys() {
  static const KeyTable table{
      .name = "scene",
      .title = "Scene",
      .intro =
          "What `simulate`, `explain` and `measure` run, and the keys of a sweep's axes (docs/scene.md). "
          "Lengths are in bead diameters σ, times in t0 = √(σ/g), masses in bead masses m; v0 = √(σ g). "
          "A length, time or velocity without a unit in its name is refused if [scale] states σ, and a "
          "time or velocity if it states gravity, since it does not say which unit is meant.",
      .notes =
          {{"beads.intruder", "One large bead; it occupies the last slot."},
           {"contact",
            "For all contacts. [contact.wall] overrides the numbers of the laws for all walls; "
            "[contact.bottom], [contact.sides], [contact.plates] and [contact.lid] override them for one "
            "kind of wall. The laws are the same for all contacts."},
           {"drive",
            "A sin(ωt) along `axis`. Any combination of these keys that fixes A and ω; redundant keys "
            "must agree to 1e-12."},
           {"until",
            "Used by `measure` and by sweeps, which analyse during the run; time.cycles is then "
            "the largest number of cycles."}},
      .rows = all_rows(),
      .read = [](const std::vector<std::string>& assignments) {
        (void)read_scene_text("beads.count = 10\ndrive.omega_per_t0 = 1.0\ndrive.gamma = 1.5\n", "an example",
                              assignments);
      }};
  return table;
}

}  // namespace twincell::sim
