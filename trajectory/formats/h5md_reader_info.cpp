// Reads from H5MD what does not change from frame to frame: cell, drive, scale, conditions of the run.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/config.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/formats/drive_motion_group.hpp"
#include "trajectory/formats/h5md_reader_impl.hpp"
#include "trajectory/formats/recorded_group.hpp"

namespace twincell {

namespace {

/// start.kind of a simulation's file by a version that did not store /twincell/conditions: from the scene in
/// its provenance, where an absent key means the default, crystal_a. Empty if unknown.
std::string start_of_earlier_file(const std::string& provenance_json) {
  const auto provenance = nlohmann::json::parse(provenance_json, nullptr, false);
  if (!provenance.is_object() || !provenance.contains("config") || !provenance.at("config").is_string())
    return {};
  try {
    const Config scene = Config::from_text(provenance.at("config").get<std::string>(), "scene");
    return scene.root().section("start").text("kind").value_or("crystal_a");
  } catch (const ConfigError&) {  // a damaged record states no start
    return {};
  }
}

Boundary boundary_of(const std::string& word) {
  for (const BoundaryWords& row : kBoundaries)
    if (word == row.word) return row.value;
  return Boundary::open;  // also the word "none" of H5MD
}

}  // namespace

bool H5mdReader::Impl::read_number(const std::string& group, const std::string& name, double& value) const {
  const std::string key = group + "/" + name;
  if (!h5::exists(file.get(), key)) return false;
  if (!h5::read_scalar(file.get(), key, value)) refuse(key, "must be a single number.");
  return true;
}

void H5mdReader::Impl::read_box(const std::string& group) {
  if (h5::exists(file.get(), "twincell/cell")) {
    const h5::Handle cell = open_object(file.get(), "twincell/cell");
    const auto dimension = h5::read_int_attribute(cell.get(), "dimension");
    const auto words = h5::read_text_attribute(cell.get(), "boundary");
    const auto lower = h5::read_dataset<double>(cell.get(), "lower"),
               upper = h5::read_dataset<double>(cell.get(), "upper");
    if (dimension.size() != 1 || words.size() != 3 || lower.size() != 3 || upper.size() != 3)
      refuse("twincell/cell", "dimension, boundary[3], lower[3] and upper[3] are needed.");
    info.box.dimension = dimension[0];
    info.box.lower = Vec3(lower.data());
    info.box.upper = Vec3(upper.data());
    for (std::size_t a = 0; a < 3; ++a) info.box.boundary[a] = boundary_of(words[a]);
    if (!h5::exists(cell.get(), "side_tilt")) return;
    const auto tilt = h5::read_dataset<double>(cell.get(), "side_tilt");
    if (tilt.size() != 2 || !std::ranges::all_of(tilt, [](double t) { return std::abs(t) < 90; }))
      refuse("twincell/cell", "side_tilt is two angles below 90 degrees.");
    info.box.side_tilt = {tilt[0], tilt[1]};
    return;
  }
  read_foreign_box(group);
}

/// The box of H5MD, from which other programs read the cell, must be that of twincell/cell.
void H5mdReader::Impl::require_box(const std::string& group) const {
  constexpr double kRounding = 1e-9;
  const std::string where = group + "/box";
  if (!h5::exists(file.get(), where)) refuse(where, "the group is missing.");
  if (!h5::exists(file.get(), where + "/edges/value")) return;
  const h5::Series series(file.get(), where + "/edges/value");
  if (series.record() != std::vector<hsize_t>{3, 3})
    refuse(where + "/edges", "an array [3][3] per frame is needed.");
  const auto edges = h5::read_dataset<double>(file.get(), where + "/edges/value");
  const Vec3 size = info.box.size();
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto row = static_cast<int>(k % 9 / 3), column = static_cast<int>(k % 3);
    const double cell = row == column ? size[row] : 0;
    if (!(std::abs(edges[k] - cell) <= kRounding * std::max(1.0, cell)))
      refuse(where + "/edges",
             fmt::format("edge [{}][{}] of frame {} is {:g}, but that of twincell/cell is {:g}.", row, column,
                         k / 9, edges[k], cell));
  }
}

/// The plate of a simulation is where its drive puts it in each phase, or at 0 while it rests.
void H5mdReader::Impl::require_plate(const std::vector<std::int32_t>& phases,
                                     const std::vector<std::int64_t>& cycles) const {
  constexpr double kRounding = 1e-6;
  if (info.source != Origin::simulation || !info.drive || info.drive->ramp || info.drive->recorded ||
      info.phases_per_cycle <= 0 || !plate_height)
    return;
  const auto heights = h5::read_dataset<double>(file.get(), "observables/plate_height/value");
  for (std::size_t f = 0; f < heights.size(); ++f) {
    if (phases[f] < 0 || std::isnan(heights[f]) || heights[f] == 0) continue;
    const double driven =
        info.drive->displacement(static_cast<double>(phases[f]) / info.phases_per_cycle, cycles[f]);
    if (!(std::abs(heights[f] - driven) <= kRounding * std::max(1.0, info.drive->amplitude)))
      refuse(fmt::format("frame {}", f),
             fmt::format("the plate is at {:g}, but the drive of the file puts it at {:g}.", heights[f],
                         driven));
  }
}

/// A file of another program has only the H5MD box. Its corner is at the origin.
void H5mdReader::Impl::read_foreign_box(const std::string& group) {
  info.box.dimension = is_planar() ? 2 : 3;
  info.box.boundary = {Boundary::open, Boundary::open, Boundary::open};
  if (!h5::exists(file.get(), group + "/box")) return;
  const h5::Handle box = open_object(file.get(), group + "/box");
  const auto words = h5::read_text_attribute(box.get(), "boundary");
  for (std::size_t a = 0; a < std::min<std::size_t>(words.size(), 3); ++a)
    info.box.boundary[a] = boundary_of(words[a]);
  const auto set = [&](const std::vector<double>& edges) {
    if (edges.size() == 3) info.box.upper = Vec3(edges.data());
    if (edges.size() == 9) info.box.upper = Vec3(edges[0], edges[4], edges[8]);
  };
  set(h5::read_dataset<double>(box.get(), "edges"));
  if (!h5::exists(box.get(), "edges/value")) return;
  const h5::Series edges(box.get(), "edges/value");
  std::size_t each = 1;
  for (const hsize_t n : edges.record()) each *= n;
  if (!edges || (each != 3 && each != 9))
    refuse(group + "/box/edges", "a box has 3 or 9 numbers in each frame.");
  std::vector<double> first(each), now(each);
  for (std::size_t f = 0; f < edges.size(); ++f) {
    edges.read(f, h5::native<double>(), f == 0 ? first.data() : now.data());
    if (f > 0 && now != first)
      refuse(group + "/box/edges", fmt::format("the box of frame {} is not that of the first one.", f));
  }
  if (edges.size() > 0) set(first);
}

/// Whether all beads of the first frame have the same y.
bool H5mdReader::Impl::is_planar() const {
  if (position.size() == 0 || info.n_beads == 0) return false;
  std::vector<Vec3> first(info.n_beads);
  position.read(0, h5::native<double>(), first.data());
  return std::all_of(first.begin(), first.end(),
                     [&](const Vec3& r) { return r.y() == first.front().y() || !std::isfinite(r.y()); });
}

void H5mdReader::Impl::read_drive() {
  if (!h5::exists(file.get(), "parameters/drive")) return;
  const h5::Handle group = open_object(file.get(), "parameters/drive");
  if (H5Iget_type(group.get()) != H5I_GROUP)
    refuse("parameters/drive", "must be a group with the numbers amplitude and omega.");
  Drive drive;
  if (H5Aexists(group.get(), "axis") > 0) {
    const auto axis = h5::read_text_attribute(group.get(), "axis");  // empty if it is no text
    const auto k = axis.size() == 1 && axis.front().size() == 1 ? std::string("xyz").find(axis.front())
                                                                : std::string::npos;
    if (k == std::string::npos) refuse("parameters/drive@axis", "must be x, y or z.");
    drive.axis = static_cast<Axis>(k);
  }
  if (!read_number("parameters/drive", "amplitude", drive.amplitude) ||
      !read_number("parameters/drive", "omega", drive.omega))
    return;
  if (h5::exists(group.get(), "harmonics")) {
    const auto pairs = h5::read_dataset<double>(group.get(), "harmonics");
    if (pairs.empty() || pairs.size() % 2 != 0)
      refuse("parameters/drive/harmonics", "must be pairs of a relative amplitude and a phase.");
    for (std::size_t k = 0; k < pairs.size(); k += 2) drive.harmonics.push_back({pairs[k], pairs[k + 1]});
  }
  if (h5::exists(group.get(), "recorded"))
    drive.recorded = read_recorded(group.get(), {path.string(), 0, 0, "parameters/drive/recorded"});
  if (read_number("parameters/drive", "gravity", drive.gravity) &&
      !(drive.gravity > 0 && std::isfinite(drive.gravity)))
    refuse("parameters/drive/gravity", "must be a positive number.");
  if (read_number("parameters/drive", "downward_share", drive.downward_share) &&
      !(std::abs(drive.downward_share) <= 1))
    refuse("parameters/drive/downward_share", "must be a number from -1 to 1.");
  read_drive_motion(group.get(), drive, {path.string(), 0, 0, "parameters/drive"});
  info.drive = drive;
}

void H5mdReader::Impl::read_parameters() {
  if (h5::exists(file.get(), "twincell")) {
    const h5::Handle ours = open_object(file.get(), "twincell");
    const auto schema = h5::read_int_attribute(ours.get(), "schema_version");
    if (schema.size() == 1 && schema[0] > kSchemaVersion)
      refuse("twincell@schema_version",
             fmt::format("{} is newer than this program's {}.", schema[0], kSchemaVersion));
    const auto source = h5::read_text_attribute(ours.get(), "source");
    if (!source.empty()) {
      const auto row = std::ranges::find(kOrigins, source.front(), &Choice<Origin>::word);
      if (row == kOrigins.end())
        refuse("twincell@source",
               fmt::format("is '{}'; there are: {}.", source.front(), fmt::join(words_of(kOrigins), ", ")));
      info.source = row->value;
    }
    h5::read_text(ours.get(), "tracking", info.tracking_json);
  }
  read_drive();
  double value = 0;
  if (read_number("parameters", "phases_per_cycle", value))
    info.phases_per_cycle =
        value >= 0 && value <= 2e9 && value == std::floor(value) ? static_cast<int>(value) : -1;
  else if (info.columns.phase) {
    // If the file does not state N_k, derive it from the largest phase.
    for (std::size_t f = 0; f < position.size(); ++f) {
      int k = -1;
      phase.read(f, h5::native<int>(), &k);
      info.phases_per_cycle = std::max(info.phases_per_cycle, std::min(k, 2'000'000'000) + 1);
    }
  }
  if (read_number("parameters", "samples_per_cycle", value)) {
    constexpr double kMostSamples = 2e9;
    if (!(value >= 0 && value <= kMostSamples && value == std::floor(value)))
      refuse("parameters/samples_per_cycle",
             fmt::format("is {:g}; it must be a whole number between 0 and {:g}.", value, kMostSamples));
    info.samples_per_cycle = static_cast<int>(value);
  }
  auto scale = [&](const char* name, std::optional<double>& out) {
    if (read_number("parameters/scale", name, value)) out = value;
  };
  scale("sigma_m", info.scale.sigma_m);
  scale("gravity_m_s2", info.scale.gravity_m_s2);
  scale("pixels_per_sigma", info.scale.pixels_per_sigma);
  if (h5::exists(file.get(), "parameters/provenance"))
    h5::read_text(file.get(), "parameters/provenance", info.provenance_json);
  read_conditions();
}

void H5mdReader::Impl::read_conditions() {
  if (!h5::exists(file.get(), "twincell/conditions")) {
    if (info.source == Origin::simulation)
      info.conditions.start = start_of_earlier_file(info.provenance_json);
    return;
  }
  const h5::Handle group = open_object(file.get(), "twincell/conditions");
  const auto number = [&](const char* name, std::optional<double>& out) {
    double value = 0;
    if (!read_number("twincell/conditions", name, value)) return;
    if (!std::isfinite(value) || value < 0)
      refuse(std::string("twincell/conditions/") + name,
             fmt::format("is {:g}; it must be finite and not negative.", value));
    out = value;
  };
  number("n_l", info.conditions.n_l);
  number("gamma", info.conditions.gamma);
  check_gamma();
  check_layers();
  h5::read_text(group.get(), "start", info.conditions.start);
}

void H5mdReader::Impl::check_gamma() {
  if (!info.drive || info.conditions.gamma.value_or(0) <= 0) return;
  constexpr double kRounding = 1e-9;
  const double of_drive = info.drive->gamma(), stated = *info.conditions.gamma;
  if (!(of_drive > 0) || std::abs(of_drive / stated - 1) <= kRounding) return;
  // Files of earlier versions lack drive/gravity if it is 1, and the first ones always.
  if (!h5::exists(file.get(), "parameters/drive/gravity")) {
    info.drive->gravity = of_drive / stated;
    return;
  }
  const bool sine = info.drive->harmonics.empty() && !info.drive->recorded && !info.drive->ramp;
  if (sine)
    refuse("twincell/conditions/gamma",
           fmt::format("is {:g}, but parameters/drive states Gamma = {:g}.", stated, of_drive));
}

void H5mdReader::Impl::check_layers() {
  constexpr double kRounding = 1e-9;
  const double width = info.box.size().x();
  if (info.source != Origin::simulation || !info.conditions.n_l || !(width > 0)) return;
  const double stated = *info.conditions.n_l, of_beads = static_cast<double>(info.n_beads) / width;
  if (std::abs(stated - of_beads) > kRounding * std::max(1.0, of_beads))
    refuse("twincell/conditions/n_l",
           fmt::format("is {:g}, but {} beads in a cell {:g} wide are {:g} layers.", stated, info.n_beads,
                       width, of_beads));
}

/// Refuses frames whose steps do not rise, or whose times fall.
void H5mdReader::Impl::require_rising_time(const std::string& particles) const {
  const std::string group = particles + "/position/";
  const auto steps = h5::read_dataset<std::int64_t>(file.get(), group + "step");
  for (std::size_t f = 1; f < steps.size(); ++f)
    if (steps[f] <= steps[f - 1])
      refuse(group + "step", fmt::format("{} of frame {} does not come after {} of the frame before.",
                                         steps[f], f, steps[f - 1]));
  const auto times = h5::read_dataset<double>(file.get(), group + "time");
  for (std::size_t f = 0; f < times.size(); ++f)
    if (!std::isfinite(times[f]) || (f > 0 && times[f] < times[f - 1]))
      refuse(group + "time",
             fmt::format("{:g} of frame {} is not finite, or before the time of the frame before.", times[f],
                         f));
}

}  // namespace twincell
