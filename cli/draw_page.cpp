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
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"

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

void check(const TrajectorySource& source, const imaging::DrawJob& job, std::size_t frames) {
  const auto refuse = [](const char* option, const char* why) {
    throw ConfigError({.file = {}, .key = option}, why);
  };
  if (job.vectors) refuse("--vectors", "applies to a picture or a film; the output is a page.");
  if (job.contacts) refuse("--contacts", "applies to a picture or a film; the output is a page.");
  if (job.pixels_per_sigma > 0)
    refuse("--pixels-per-sigma", "applies to a picture or a film; a page is as large as its window.");
  imaging::check_colours(job.colours);
  const double per_bead = (source.info().box.dimension == 3 ? 6 : 4) + (job.colours.of ? 2 : 0);
  const double size =
      4.0 / 3 * per_bead * static_cast<double>(source.info().n_beads) * static_cast<double>(frames);
  if (size > kLargestPage)
    throw ConfigError(
        {.file = source.name(), .key = "--frames"},
        fmt::format(
            "{} of {} make a page of {:.3g} MB, the bound is {:g} MB; choose fewer by a STEP of at least "
            "{}, as in A:B:STEP.",
            counted(frames, "frame"), counted(source.info().n_beads, "bead"), size / 1e6, kLargestPage / 1e6,
            static_cast<std::int64_t>(std::ceil(size / kLargestPage)) * job.frames.step));
}

const char* boundary_word(Boundary b) {
  return b == Boundary::periodic ? "periodic" : b == Boundary::wall ? "wall" : "open";
}

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
  const bool solid = info.box.dimension == 3;
  Levels x, y, z, numbers;
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
      const Vec3 r = seen ? info.box.wrap(frame.position[i]) : Vec3(Vec3::Constant(std::nan("")));
      x.add(r.x());
      if (solid) y.add(r.y());
      z.add(r.z());
      if (job.colours.of) numbers.add(seen ? values[i] : std::nan(""));
    }
    progress.update(static_cast<std::int64_t>(k) + 1, static_cast<std::int64_t>(indices.size()));
  }
  DrawnPage page{.html = {}, .frames = indices.size(), .range = {numbers.low(), numbers.high()}};
  if (job.colours.range) page.range = *job.colours.range;
  json data = {{"box", box_json(info.box)},
               {"beads", info.n_beads},
               {"radius", info.radius.empty() ? json(0.5) : json(info.radius)},
               {"numbers", numbers_of_frames},
               {"titles", titles},
               {"cells", cells},
               {"x", x.document()},
               {"z", z.document()},
               {"map", map_json()},
               {"speed", job.frames_per_second},
               {"tracks", job.tracks}};
  if (solid) data["y"] = y.document();
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
  page.html += fmt::format("<p id=\"summary\">{}, {}.</p>\n", counted(indices.size(), "frame"),
                           counted(info.n_beads, "bead"));
  page.html += kBody;
  page.html += "<script type=\"application/json\" id=\"data\">" + analysis::json_script_text(data) +
               "</script>\n<script>" + analysis::script_text(embedded::draw_page_js) +
               "</script>\n</body></html>\n";
  return page;
}

}  // namespace twincell::cli
