#include "imaging/cell/cell_keys.hpp"

#include "imaging/cell/cell.hpp"

namespace twincell::imaging {

namespace {

std::vector<KeyRow> rows() {
  const std::vector<std::string> laboratory = {"scale.sigma_mm=2.0", "scale.gravity_m_s2=9.81"};
  return {
      {"camera.pixels_per_sigma", "px", "located bead diameter", "15.0", "camera pixels per bead diameter"},
      {"camera.scale_error_px",
       "px",
       "none",
       "0.002",
       "standard error of pixels_per_sigma, which compare adds to the error of every length",
       {"camera.pixels_per_sigma=15.0"}},
      {"camera.disc_width_px", "px", "that of pixels_per_sigma", "15.2",
       "width in the picture of a bead of one sigma, where glare, exposure or a grey level of its own moves "
       "its rim; radii are measured in it"},
      {"camera.origin_px", "px", "required by match", "[40.0, 560.0]",
       "lower left inside corner of the cell with the plate at its mean height, column and row; in the "
       "picture without rotation and distortion"},
      {"camera.frames_per_cycle", "", "measured by match; otherwise no phases", "20",
       "camera frames per cycle of the drive; 0: not phase-locked"},
      {"camera.first_phase",
       "",
       "0",
       "3",
       "phase of the first frame, below frames_per_cycle; at phase 0 the plate passes its mean height "
       "upwards",
       {"camera.frames_per_cycle=20"}},
      {"camera.phase_offset", "frames", "0", "0.25", "delay of every frame after its nominal phase"},
      {"camera.rotation_deg", "degrees", "0", "0.4",
       "rotation of the picture about its centre, counter-clockwise"},
      {"camera.distortion", "1", "0", "0.01",
       "k1: a point at r, in half diagonals, appears at r (1 + k1 r²)"},
      {"camera.bright", "", "false", "true", "beads, walls and plate are brighter than the background"},
      {"camera.refine", "", "\"exact\"", "\"profile\"",
       "method that finds the position of each bead, as --refine of track"},
      {"camera.frame_rate_hz", "1/s", "that of the stack", "1000.0",
       "frame rate; overrides the rate that the stack states"},
      {"cell.width_mm", "mm", "required by match", "40.0", "distance of the side walls at the plate",
       laboratory},
      {"cell.width_sigma", "σ", "", "20.0", ""},
      {"cell.width", "σ", "", "20.0", "the same, in a file without scale.sigma_mm"},
      {"cell.height_mm", "mm", "height of the picture", "80.0",
       "height of the cell; beads above it are left out", laboratory},
      {"cell.height_sigma", "σ", "", "40.0", ""},
      {"cell.height", "σ", "", "40.0", "the same, in a file without scale.sigma_mm"},
      {"cell.sides", "", "\"walls\"", "\"periodic\"", "kind of the sides; match refuses \"open\""},
      {"cell.side_tilt", "degrees", "[0, 0]", "[0.2, -0.1]", "outward tilt of the left and the right wall"},
      {"drive.amplitude_mm", "mm", "measured by match", "2.0", "amplitude A of the plate", laboratory},
      {"drive.amplitude_sigma", "σ", "", "1.5", ""},
      {"drive.amplitude", "σ", "", "1.5", "the same, in a file without scale.sigma_mm"},
      {"drive.frequency_hz", "1/s", "measured by match from the frame rate", "20.0",
       "frequency of the shaker", laboratory},
      {"drive.frequency_per_t0", "1/t0", "", "0.16", ""},
      {"drive.frequency", "1/t0", "", "0.16", "the same, in a file without scale.sigma_mm"},
      {"drive.omega_rad_s", "rad/s", "", "125.0", "angular frequency ω, instead of the frequency",
       laboratory},
      {"drive.omega_per_t0", "1/t0", "", "1.0", ""},
      {"drive.omega", "1/t0", "", "1.0", "the same, in a file without scale.sigma_mm"},
      {"drive.gamma", "1", "", "2.0",
       "Γ = A ω²/g; with the amplitude it determines the frequency, and with the frequency the amplitude"},
      {"drive.peak_acceleration_g", "g", "", "2.0", ""},
      {"drive.peak_acceleration_m_s2", "m/s²", "", "19.6", "", laboratory},
      {"drive.k_m", "1", "", "4.0", "K_m = A²ω²/(g σ)"},
      {"drive.peak_velocity_mm_s", "mm/s", "", "250.0", "A ω", laboratory},
      {"drive.peak_velocity_v0", "v0", "", "1.8", ""},
      {"drive.peak_velocity", "v0", "", "1.8", "the same, in a file without scale.sigma_mm"},
      {"drive.harmonics", "", "", "[[0.1, 0.25], [0.02, 0.0]]",
       "[[a_2, φ_2], [a_3, φ_3], …]: displacement A (sin ωt + Σ a_n sin(nωt + 2πφ_n)), as in a scene"},
      {"scale.sigma_mm", "mm", "lengths stay in σ", "2.0", "bead diameter σ"},
      {"scale.sigma_m", "m", "", "0.002", ""},
      {"scale.gravity_m_s2", "m/s²", "needed with sigma_mm for seconds", "9.81", "gravity"},
      {"calibration.from", "", "nothing is included", "\"cell.calibration.toml\"",
       "result of calibrate, relative to this file; keys stated here take precedence"},
  };
}

}  // namespace

const KeyTable& cell_keys() {
  static const KeyTable table{
      .name = "cell",
      .title = "CELL.toml",
      .intro =
          "The description of a filmed cell, written by `new` and read by `track --cell`, `match` and "
          "`calibrate --cell` (docs/cell.md). Every key may be absent. σ is the bead diameter, "
          "t0 = √(σ/g), v0 = √(σ g).",
      .notes = {{"drive", "Two quantities determine A and ω; a third must agree."},
                {"scale",
                 "If σ is stated here, a length, time or velocity without a unit in its name is refused as "
                 "ambiguous; beside gravity alone, a time or velocity."}},
      .rows = rows(),
      .read = [](const std::vector<std::string>& assignments) { (void)read_cell("", assignments); }};
  return table;
}

}  // namespace twincell::imaging
