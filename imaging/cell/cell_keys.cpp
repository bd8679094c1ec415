#include "imaging/cell/cell_keys.hpp"

#include <fmt/format.h>

namespace twincell {

// One line per key. Keep the table in step with read_cell() (cell.cpp), read_drive_spec()
// (trajectory/drive.cpp) and the spellings with units (trajectory/unit_keys.cpp): the test of this file
// compares them.
const std::vector<CellKey>& cell_keys() {
  static const std::vector<CellKey> keys = {
      {"camera.pixels_per_sigma", "px", "1 … 10000", "located bead diameter", "15.0", "0.5",
       "camera pixels per bead diameter"},
      {"camera.origin_px", "px", "two numbers", "required by match", "[40.0, 560.0]", "[40.0]",
       "lower left inside corner of the cell with the plate at its mean height, column and row; in the "
       "picture without rotation and distortion"},
      {"camera.frames_per_cycle", "", "0 … 100000", "measured by match; otherwise no phases", "20", "-1",
       "camera frames per cycle of the drive; 0: not phase-locked"},
      {"camera.first_phase", "", "0 … frames_per_cycle − 1", "0", "3", "-1",
       "phase of the first frame; at phase 0 the plate passes its mean height upwards"},
      {"camera.phase_offset", "frames", "−1 … 1", "0", "0.25", "1.5",
       "delay of every frame after its nominal phase"},
      {"camera.rotation_deg", "degrees", "−180 … 180", "0", "0.4", "200",
       "rotation of the picture about its centre, counter-clockwise"},
      {"camera.distortion", "1", "−0.2 … 0.2", "0", "0.01", "0.3",
       "k1: a point at r, in half diagonals, appears at r (1 + k1 r²)"},
      {"camera.bright", "", "true, false", "false", "true", "1",
       "beads, walls and plate are brighter than the background"},
      {"camera.frame_rate_hz", "1/s", "above 0, at most 10⁹", "that of the stack", "1000.0", "0",
       "frame rate; overrides the rate that the stack states"},
      {"cell.width_mm", "mm", "above 0", "required by match", "40.0", "0",
       "distance of the side walls at the plate"},
      {"cell.width_sigma", "σ", "above 0", "", "20.0", "0", ""},
      {"cell.width", "σ", "above 0; not with scale.sigma_mm", "", "20.0", "-1", ""},
      {"cell.height_mm", "mm", "above 0", "height of the picture", "80.0", "0",
       "height of the cell; beads above it are left out"},
      {"cell.height_sigma", "σ", "above 0", "", "40.0", "0", ""},
      {"cell.height", "σ", "above 0; not with scale.sigma_mm", "", "40.0", "-1", ""},
      {"cell.sides", "", "\"walls\", \"periodic\", \"open\"", "\"walls\"", "\"periodic\"", "\"round\"",
       "kind of the sides; match refuses \"open\""},
      {"cell.side_tilt", "degrees", "two numbers, −45 … 45", "[0, 0]", "[0.2, -0.1]", "[50.0, 0.0]",
       "outward tilt of the left and the right wall"},
      {"drive.amplitude_mm", "mm", "0 or above", "measured by match", "2.0", "-1",
       "amplitude A of the plate"},
      {"drive.amplitude_sigma", "σ", "0 or above", "", "1.5", "-1", ""},
      {"drive.amplitude", "σ", "0 or above; not with scale.sigma_mm", "", "1.5", "-1", ""},
      {"drive.frequency_hz", "1/s", "above 0", "measured by match from the frame rate", "20.0", "0",
       "frequency of the shaker"},
      {"drive.frequency_per_t0", "1/t0", "above 0", "", "0.16", "0", ""},
      {"drive.frequency", "1/t0", "above 0; not with scale.sigma_mm", "", "0.16", "0", ""},
      {"drive.omega_rad_s", "rad/s", "above 0", "", "125.0", "0",
       "angular frequency ω, instead of the frequency"},
      {"drive.omega_per_t0", "1/t0", "above 0", "", "1.0", "0", ""},
      {"drive.omega", "1/t0", "above 0; not with scale.sigma_mm", "", "1.0", "0", ""},
      {"drive.gamma", "1", "0 or above", "", "2.0", "-1",
       "Γ = A ω²/g; with the amplitude it determines the frequency, and with the frequency the amplitude"},
      {"drive.peak_acceleration_g", "g", "0 or above", "", "2.0", "-1", ""},
      {"drive.peak_acceleration_m_s2", "m/s²", "0 or above", "", "19.6", "-1", ""},
      {"drive.k_m", "1", "0 or above", "", "4.0", "-1", "K_m = A²ω²/(g σ)"},
      {"drive.peak_velocity_mm_s", "mm/s", "0 or above", "", "250.0", "-1", "A ω"},
      {"drive.peak_velocity_v0", "v0", "0 or above", "", "1.8", "-1", ""},
      {"drive.peak_velocity", "v0", "0 or above; not with scale.sigma_mm", "", "1.8", "-1", ""},
      {"scale.sigma_mm", "mm", "above 0", "lengths stay in σ", "2.0", "0", "bead diameter σ"},
      {"scale.sigma_m", "m", "above 0", "", "0.002", "0", ""},
      {"scale.gravity_m_s2", "m/s²", "above 0", "needed with sigma_mm for seconds", "9.81", "0", "gravity"},
      {"calibration.from", "", "name of a file", "nothing is included", "\"cell.calibration.toml\"", "3",
       "result of calibrate, relative to this file; keys stated here take precedence"},
  };
  return keys;
}

std::string cell_keys_markdown() {
  std::string text = "| key | unit | range | default | example | meaning |\n|---|---|---|---|---|---|\n";
  for (const CellKey& k : cell_keys())
    text += fmt::format("| `{}` | {} | {} | {} | `{}` | {} |\n", k.key, k.unit, k.range,
                        k.meaning[0] == '\0'  ? "–"
                        : k.absent[0] == '\0' ? "–"
                                              : k.absent,
                        k.example, k.meaning[0] == '\0' ? "the same" : k.meaning);
  return text;
}

}  // namespace twincell
