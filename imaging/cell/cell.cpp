#include "imaging/cell/cell.hpp"

#include <algorithm>
#include <optional>

#include "core/bounded_list.hpp"
#include "core/config.hpp"
#include "imaging/refine/refiner.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/unit_keys.hpp"

namespace twincell::imaging {

std::optional<Drive> CellDescription::drive() const {
  const DriveSpec& s = drive_spec;
  if (!s.amplitude && !s.omega && !s.frequency && !s.gamma && !s.k_m && !s.peak_velocity) return std::nullopt;
  Drive solved = solve_drive(s, 1, Where{.file = {}, .key = "drive"});
  solved.harmonics = harmonics;
  return solved;
}

ShakenCell CellDescription::shaken_cell() const {
  ShakenCell numbers;
  if (scale.sigma_m) numbers.sigma_mm = *scale.sigma_m * 1e3;
  numbers.gamma = drive_spec.gamma;
  numbers.gravity_m_s2 = scale.gravity_m_s2;
  if (!is_whole(drive_spec)) return numbers;  // the film gives the rest
  const std::optional<Drive> stated = drive();
  if (!stated) return numbers;
  numbers.gamma = stated->gamma();
  if (const auto t0 = scale.t0_s()) numbers.frequency_hz = stated->omega / (2 * std::numbers::pi * *t0);
  return numbers;
}

PixelFrame CellDescription::pixel_frame(cv::Size picture, double scale_px, PixelPoint zero) const {
  PixelFrame frame{scale_px, zero};
  if (rotation_deg != 0 || distortion != 0) frame.lens = Lens(picture, rotation_deg, distortion);
  return frame;
}

namespace {

std::optional<Boundary> sides_in(const ConfigSection& box) {
  std::vector<std::string> words;
  for (const BoundaryWords& row : kBoundaries) words.emplace_back(row.sides);
  const auto word = box.word("sides", words);
  if (!word) return std::nullopt;
  return std::find_if(kBoundaries.begin(), kBoundaries.end(),
                      [&](const BoundaryWords& row) { return *word == row.sides; })
      ->value;
}

/// The standard error of the scale: the stated one, otherwise that of the calibration that gave the scale.
std::optional<double> scale_error_in(const ConfigSection& camera, const CellDescription& cell) {
  constexpr const char* kScale = "camera.pixels_per_sigma";
  const std::vector<std::string>& taken = cell.included.taken;
  if (const auto stated = camera.number_in("scale_error_px", 0, 1e4)) {
    if (!cell.pixels_per_sigma)
      throw ConfigError(camera.where("scale_error_px"),
                        fmt::format("is the error of {}, which is not stated.", kScale));
    return stated;
  }
  if (std::find(taken.begin(), taken.end(), kScale) == taken.end()) return std::nullopt;
  const double error = read_calibration(cell.included.file).find(kScale)->standard_error.front();
  return std::isfinite(error) ? std::optional(error) : std::nullopt;
}

/// Discs as wide as two beads, or half as wide, are no discs of beads of one sigma.
void refuse_far_disc_width(const CellDescription& cell, const ConfigSection& camera) {
  constexpr double kFar = 2;
  if (!cell.disc_width_px || !cell.pixels_per_sigma) return;
  const double ratio = *cell.disc_width_px / *cell.pixels_per_sigma;
  if (ratio > kFar || ratio < 1 / kFar)
    throw ConfigError(
        camera.where("disc_width_px"),
        fmt::format("is {:g}, but must be between half and twice camera.pixels_per_sigma ({:g}).",
                    *cell.disc_width_px, *cell.pixels_per_sigma));
}

}  // namespace

CellDescription read_cell(const std::filesystem::path& path, const std::vector<std::string>& assignments) {
  constexpr std::int64_t kMaxPhases = 100000;
  constexpr double kLongest = 1e6;  // sigma, as in a scene; a trajectory file holds no longer cells
  Config config = path.empty() ? Config::from_text("", "the command line") : Config::from_file(path);
  // Assignments are applied before units are converted, so that an assigned spelling replaces another
  // spelling of the same quantity in the file.
  for (const std::string& assignment : assignments) {
    displace_spellings(config, assignment);
    // The stated error is that of the stated scale.
    if (assignment.starts_with("camera.pixels_per_sigma=")) config.erase("camera.scale_error_px");
  }
  displace_third_quantity(config, assignments);
  for (const std::string& assignment : assignments) config.assign(assignment);
  CellDescription cell;
  reduce_units(config);
  cell.included = include_calibration(config, path, Includer::cell);
  const ConfigSection root = config.root();
  cell.text = resolved_text(config);

  const ConfigSection camera = root.section("camera");
  cell.pixels_per_sigma = camera.number_in("pixels_per_sigma", 1, 1e4);
  cell.scale_error_px = scale_error_in(camera, cell);
  cell.disc_width_px = camera.number_in("disc_width_px", 1, 1e4);
  refuse_far_disc_width(cell, camera);
  constexpr double kFarthest_px = 1e6;
  if (const auto origin = numbers_in(camera, "origin_px", 2, -kFarthest_px, kFarthest_px))
    cell.origin = PixelPoint{(*origin)[0], (*origin)[1]};
  cell.phase_lock.frames_per_cycle =
      static_cast<int>(camera.integer_in("frames_per_cycle", 0, kMaxPhases).value_or(0));
  cell.phase_lock.first_phase = static_cast<int>(camera.integer_in("first_phase", 0, kMaxPhases).value_or(0));
  cell.phase_lock.check(camera.where("first_phase"));
  cell.phase_lock.offset = camera.number_in("phase_offset", -1, 1).value_or(0);
  cell.rotation_deg = camera.number_in("rotation_deg", -180, 180).value_or(0);
  cell.distortion = camera.number_in("distortion", -0.2, 0.2).value_or(0);
  cell.bright = camera.boolean("bright").value_or(false);
  cell.refine = camera.word("refine", refiner_names());
  cell.frame_rate_hz = camera.number_in("frame_rate_hz", 0, 1e9, true);

  const ConfigSection box = root.section("cell");
  // The conversion of units also knows keys of scenes, so that refuse_unknown_keys() does not see these.
  for (const auto& [section, key] :
       {std::pair{box, "depth"}, std::pair{root, "beads"}, std::pair{root.section("drive"), "cutoff"}})
    if (section.has(key))
      throw ConfigError(section.where(key), "is a key of a scene; a cell description does not have it.");
  cell.width = box.number_in("width", 0, kLongest, true);
  cell.height = box.number_in("height", 0, kLongest, true);
  cell.sides = sides_in(box).value_or(cell.sides);
  if (const auto tilt = numbers_in(box, "side_tilt", 2, -45, 45)) cell.side_tilt = {(*tilt)[0], (*tilt)[1]};

  const ConfigSection drive = root.section("drive");
  cell.drive_spec = read_drive_spec(drive);
  cell.harmonics = read_harmonics(drive);
  constexpr double kLargest = 1e8;
  for (const char* key : {"amplitude", "gamma", "k_m", "peak_velocity"})
    (void)drive.number_in(key, 0, kLargest);
  for (const char* key : {"omega", "frequency"}) (void)drive.number_in(key, 0, kLargest, true);
  const ConfigSection scale = root.section("scale");
  cell.scale.sigma_m = scale.number_in("sigma_m", 0, std::nullopt, true);
  cell.scale.gravity_m_s2 = scale.number_in("gravity_m_s2", 0, std::nullopt, true);
  config.refuse_unknown_keys();
  return cell;
}

}  // namespace twincell::imaging
