#include "cli/draw_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "analysis/report/page_parts.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/plural.hpp"
#include "imaging/camera/movie.hpp"
#include "trajectory/boundary_words.hpp"

namespace twincell::cli {

namespace embedded {  // embedded into the program by cmake/embed.cmake
extern const std::string_view draw_page_css, draw_page_js;
}

namespace {

using nlohmann::json;

constexpr std::uint16_t kAbsent = 65535;
constexpr double kLevels = 65534;

/// Numbers as unsigned 16-bit levels of their range; those that are not finite are kAbsent.
class Levels {
 public:
  void add(double value) {
    values_.push_back(static_cast<float>(value));
    if (std::isfinite(value)) low_ = std::min(low_, value), high_ = std::max(high_, value);
  }
  [[nodiscard]] double low() const { return low_ <= high_ ? low_ : 0; }
  [[nodiscard]] double high() const { return low_ <= high_ ? high_ : 1; }
  /// Bytes, the lower one first.
  [[nodiscard]] std::string bytes() const {
    std::string all;
    all.reserve(2 * values_.size());
    const double span = high() - low();
    for (const float value : values_) {
      const double share = span > 0 ? std::clamp((static_cast<double>(value) - low()) / span, 0.0, 1.0) : 0;
      const auto level =
          std::isfinite(value) ? static_cast<std::uint16_t>(std::lround(kLevels * share)) : kAbsent;
      all += static_cast<char>(level & 0xFFU);
      all += static_cast<char>(level >> 8U);
    }
    return all;
  }
  [[nodiscard]] json document() const {
    return {{"low", low()},
            {"high", high()},
            {"levels", analysis::data_uri("application/octet-stream", bytes())}};
  }

 private:
  std::vector<float> values_;
  double low_ = HUGE_VAL, high_ = -HUGE_VAL;
};

/// Whole numbers of 32 bits, the lowest byte first.
std::string bytes_of(const std::vector<std::uint32_t>& numbers) {
  std::string all;
  all.reserve(4 * numbers.size());
  for (const std::uint32_t n : numbers)
    for (unsigned shift = 0; shift < 32; shift += 8) all += static_cast<char>(n >> shift & 0xFFU);
  return all;
}

/// Components of vectors, those along y only in 3D.
class VectorLevels {
 public:
  explicit VectorLevels(bool solid) : solid_(solid) {}
  void add(const Vec3& v) {
    x_.add(v.x());
    if (solid_) y_.add(v.y());
    z_.add(v.z());
  }
  [[nodiscard]] json document() const {
    json all = {{"x", x_.document()}, {"z", z_.document()}};
    if (solid_) all["y"] = y_.document();
    return all;
  }

 private:
  bool solid_;
  Levels x_, y_, z_;
};

/// Bytes of base64 in the page for each byte of data.
constexpr double kBase64 = 4.0 / 3;

[[noreturn]] void refuse_size(const TrajectorySource& source, const std::string& what, double size,
                              std::int64_t step) {
  throw ConfigError(
      {.file = source.name(), .key = "--frames"},
      fmt::format(
          "{} make a page of {:.3g} MB, the bound is {:g} MB; choose fewer frames by a STEP of at least "
          "{}, as in A:B:STEP.",
          what, size / 1e6, kLargestPage / 1e6,
          static_cast<std::int64_t>(std::ceil(size / kLargestPage)) * step));
}

/// Bytes of the page for each bead in each frame.
double bytes_per_bead(const TrajectorySource& source, const imaging::DrawJob& job) {
  const int components = source.info().box.dimension == 3 ? 3 : 2;
  return kBase64 * 2 * (components * (job.vectors ? 2 : 1) + (job.colours.of ? 1 : 0));
}

void check(const TrajectorySource& source, const imaging::DrawJob& job, std::size_t frames) {
  if (job.pixels_per_sigma > 0)
    throw ConfigError({.file = {}, .key = "--pixels-per-sigma"},
                      "applies to a picture or a film; a page is as large as its window.");
  imaging::require_drawable(source, job);
  const std::size_t beads = source.info().n_beads;
  const double size = bytes_per_bead(source, job) * static_cast<double>(beads) * static_cast<double>(frames);
  if (size > kLargestPage)
    refuse_size(source, fmt::format("{} of {}", plural(frames, "frame"), plural(beads, "bead")), size,
                job.frames.step);
}

/// The contacts of all frames: the bead from whose centre a line begins, the line to the other centre or to
/// the wall, and the normal force.
class ContactLevels {
 public:
  explicit ContactLevels(const TrajectoryInfo& info) : info_(info), lines_(info.box.dimension == 3) {}
  void add(const Frame& frame) {
    for (const ContactForce& c : frame.contact_forces) {
      const double other = c.j >= 0 ? radius(c.j) : 0;
      bead_.push_back(static_cast<std::uint32_t>(c.i));
      lines_.add(-c.normal * (radius(c.i) + other - c.overlap));
      force_.add(std::abs(c.normal_force));
    }
    first_.push_back(bead_.size());
  }
  [[nodiscard]] std::size_t size() const { return bead_.size(); }
  [[nodiscard]] json document() const {
    return {{"first", first_},
            {"bead", analysis::data_uri("application/octet-stream", bytes_of(bead_))},
            {"line", lines_.document()},
            {"force", force_.document()},
            {"widest", imaging::kWidestLine}};
  }

 private:
  [[nodiscard]] double radius(std::int32_t bead) const {
    return radius_of(info_.radius, static_cast<std::size_t>(bead));
  }
  const TrajectoryInfo& info_;
  std::vector<std::size_t> first_ = {0};  // of each frame, and behind the last
  std::vector<std::uint32_t> bead_;
  VectorLevels lines_;
  Levels force_;
};

json box_json(const Box& box) {
  json boundary = json::array();
  for (const Boundary b : box.boundary) boundary.push_back(boundary_word(b));
  return {{"dimension", box.dimension},
          {"lower", {box.lower.x(), box.lower.y(), box.lower.z()}},
          {"upper", {box.upper.x(), box.upper.y(), box.upper.z()}},
          {"boundary", boundary},
          {"tilt", box.side_tilt}};
}

/// The map of colours from its low to its high end, and the colour of a bead without a number, last.
json map_json() {
  json all = json::array();
  const auto hex = [](const cv::Vec3b& c) { return fmt::format("#{:02x}{:02x}{:02x}", c[2], c[1], c[0]); };
  for (int k = 0; k < 256; ++k) all.push_back(hex(imaging::map_colour(k, {0, 255})));
  all.push_back(hex(imaging::map_colour(std::nan(""), {0, 1})));
  return all;
}

constexpr std::string_view kBody = R"(
<noscript><p><strong>The page needs JavaScript.</strong></p></noscript>
<main class="needs-script">
<div class="controls" id="controls-frame">
<button id="play">Play</button>
<label>frame <input type="range" id="frame" min="0" value="0" step="1"></label><output id="frame-label"></output>
</div>
<div class="controls">
<label>speed <select id="speed"></select></label>
<label>zoom <select id="zoom"><option value="1">fit</option><option value="2">2 ×</option><option value="4">4 ×</option><option value="8">8 ×</option></select></label>
<label>tracks <select id="tracks"></select></label>
<label id="with-vectors" hidden><input type="checkbox" id="vectors" checked> velocities</label>
<label id="with-contacts" hidden><input type="checkbox" id="contacts" checked> contacts</label>
</div>
<div id="window" tabindex="0"><canvas id="cell" role="img" aria-label="beads and cell"></canvas></div>
<p id="key"></p>
<p id="readout" class="quiet" aria-live="polite"></p>
<p class="quiet" id="hint"></p>
</main>
)";

}  // namespace

DrawnPage page_of(const TrajectorySource& source, const imaging::DrawJob& job, const std::string& trajectory,
                  Progress& progress) {
  const TrajectoryInfo& info = source.info();
  const std::vector<std::size_t> indices = imaging::indices_of(source, job.frames);
  check(source, job, indices.size());
  imaging::require_frame_rate(job.frames_per_second);
  const bool solid = info.box.dimension == 3;
  const Vec3 nowhere = Vec3::Constant(std::nan(""));
  VectorLevels positions(solid), velocities(solid);
  Levels numbers;
  ContactLevels contacts(info);
  double fastest = 0;
  json titles = json::array(), cells = json::array(), numbers_of_frames = json::array();
  Frame frame;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    source.read(indices[k], frame);
    titles.push_back(imaging::frame_title(frame, info));
    const Vec3 cell = imaging::cell_displacement(frame, info);
    cells.push_back({cell.x(), cell.y(), cell.z()});
    numbers_of_frames.push_back(indices[k]);
    const std::vector<double> values =
        job.colours.of ? job.colours.of(indices[k], frame) : std::vector<double>();
    for (std::size_t i = 0; i < info.n_beads; ++i) {
      const bool seen = frame.present(i) && frame.position[i].allFinite();
      positions.add(seen ? info.box.wrap(frame.position[i]) : nowhere);
      if (job.colours.of) numbers.add(seen ? values[i] : std::nan(""));
      if (!job.vectors) continue;
      const bool moves = seen && frame.velocity[i].allFinite();
      velocities.add(moves ? frame.velocity[i] : nowhere);
      if (moves) fastest = std::max(fastest, frame.velocity[i].norm());
    }
    if (job.contacts) contacts.add(frame);
    progress.update(static_cast<std::int64_t>(k) + 1, static_cast<std::int64_t>(indices.size()));
  }
  // The number of contacts is known only now.
  const double of_contact = kBase64 * (4 + 2 * ((solid ? 3 : 2) + 1));
  const double size = bytes_per_bead(source, job) * static_cast<double>(info.n_beads * indices.size()) +
                      of_contact * static_cast<double>(contacts.size());
  if (size > kLargestPage)
    refuse_size(source,
                fmt::format("{} of {} with {}", plural(indices.size(), "frame"), plural(info.n_beads, "bead"),
                            plural(contacts.size(), "contact")),
                size, job.frames.step);
  DrawnPage page{.html = {}, .frames = indices.size(), .range = {numbers.low(), numbers.high()}};
  if (job.colours.range) page.range = *job.colours.range;
  json data = {{"box", box_json(info.box)},
               {"beads", info.n_beads},
               {"radius", info.radius.empty() ? json(kUsualRadius) : json(info.radius)},
               {"numbers", numbers_of_frames},
               {"titles", titles},
               {"cells", cells},
               {"position", positions.document()},
               {"map", map_json()},
               {"speed", job.frames_per_second},
               {"tracks", job.tracks}};
  if (job.vectors)
    data["velocity"] = {
        {"value", velocities.document()}, {"fastest", fastest}, {"longest", imaging::kLongestArrow}};
  if (job.contacts) data["contacts"] = contacts.document();
  if (info.scale.sigma_m) data["sigma_mm"] = *info.scale.sigma_m * 1000;
  if (job.colours.of) {
    data["colour"] = numbers.document();
    data["colour"]["name"] = job.colours.name;
    data["colour"]["unit"] = job.colours.unit;
    data["colour"]["range"] = page.range;
  }
  const std::string title = html_text(one_line(std::filesystem::path(trajectory).filename().string()));
  page.html = draw_page().mark;
  page.html += fmt::format(
      "<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<title>{}</title><style>{}{}</style></head><body>\n<header><h1>{}</h1></header>\n",
      title, analysis::page_style(), embedded::draw_page_css, title);
  page.html += fmt::format("<p id=\"summary\">{}, {}.</p>\n", plural(indices.size(), "frame"),
                           plural(info.n_beads, "bead"));
  page.html += kBody;
  page.html += "<script type=\"application/json\" id=\"data\">" + analysis::json_script_text(data) +
               "</script>\n<script>" + analysis::script_text(embedded::draw_page_js) +
               "</script>\n</body></html>\n";
  return page;
}

}  // namespace twincell::cli
