#include "cli/locate_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "analysis/report/page_parts.hpp"
#include "cli/locating_options.hpp"
#include "cli/settings_table.hpp"
#include "core/escape.hpp"
#include "imaging/refine/picture_evidence.hpp"
#include "imaging/settings/settings_choice.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "imaging/track/encoded_frame.hpp"

namespace twincell::cli {

namespace embedded {  // embedded into the program by cmake/embed.cmake
extern const std::string_view locate_page_css, locate_page_js;
}

namespace {

using nlohmann::json;

constexpr std::size_t kMaxOthers = 3;

json rounded(double value, int decimals) {
  if (!std::isfinite(value)) return nullptr;
  const double steps = std::pow(10, decimals);
  return std::round(steps * value) / steps;
}

/// Rounded down, so that it is below a limit of as many decimals if and only if the value is.
json rounded_down(double value, int decimals) {
  if (!std::isfinite(value)) return nullptr;
  const double steps = std::pow(10, decimals);
  return std::floor(steps * value) / steps;
}

/// x, y, radius, score, darkness, interior, ring share, index of the verdict, edge or tracer.
json candidate_json(const imaging::Detection& b) {
  const auto verdict = std::find_if(imaging::kVerdicts.begin(), imaging::kVerdicts.end(),
                                    [&](const Choice<imaging::Verdict>& c) { return c.value == b.verdict; });
  return {rounded(b.x, 2),
          rounded(b.y, 2),
          rounded(b.radius, 3),
          rounded_down(b.score, 4),
          rounded(b.darkness, 3),
          rounded_down(b.interior, 4),
          rounded(b.ring_share, 3),
          std::distance(imaging::kVerdicts.begin(), verdict),
          b.tracer ? "tracer"
          : b.edge ? "edge"
                   : ""};
}

json candidates_json(const imaging::Located& located) {
  json list = json::array();
  for (const std::vector<imaging::Detection>* part : {&located.beads, &located.dropped})
    for (const imaging::Detection& b : *part) list.push_back(candidate_json(b));
  return list;
}

imaging::FoundSettings settings_of(const imaging::LocatorOptions& options) {
  return {.diameter_px = options.diameter_px,
          .bright = options.preprocess.bright,
          .explained = 0,
          .other_diameters_px = options.other_diameters_px,
          .method = options.refine.method,
          .contrast = options.preprocess.contrast};
}

/// The limits of the judge, as locate_stages applies them.
json judge_json(const imaging::LocatorOptions& o) {
  const bool profile = imaging::model_of(o.refine) == imaging::DiscModel::shared_profile;
  return {{"radius_tolerance", o.judge.radius_tolerance},
          {"min_interior", profile ? json(nullptr) : json(o.judge.min_interior)},
          {"min_score", o.judge.min_score},
          {"max_overlap", o.judge.max_overlap},
          {"drop_outliers", o.judge.drop_outliers}};
}

constexpr std::string_view kBody = R"(
<noscript><p><strong>The page needs JavaScript for pictures and histograms.</strong></p></noscript>
<main class="needs-script">
<div class="opening both needs-script">
<section aria-labelledby="frame-title">
<h2 id="frame-title">Frame</h2>
<div class="controls">
<label>frame <input type="range" id="frame" min="0" value="0" step="1"></label><output id="frame-label"></output>
<label>zoom <select id="zoom"><option value="1">fit</option><option value="2">2 ×</option><option value="4">4 ×</option><option value="8">8 ×</option></select></label>
</div>
<div class="controls">
<label><input type="checkbox" id="layer-kept" checked> beads</label>
<label><input type="checkbox" id="layer-dropped" checked> dropped candidates</label>
<label><input type="checkbox" id="layer-residual"> residual</label>
</div>
<div class="window" tabindex="0" aria-label="frame, scrolls"><svg id="picture" class="beads" role="img" aria-label="frame with beads and dropped candidates"></svg></div>
<p id="readout" class="quiet" aria-live="polite"></p>
<p id="key"></p>
</section>
<section aria-labelledby="settings-title">
<h2 id="settings-title">What other settings would keep</h2>
<div id="sizes"></div>
<div class="controls"><label>score at least <input type="range" id="score" min="0.01" max="1" step="0.01"></label><output id="score-label"></output></div>
<div class="controls"><label>beads are <select id="polarity"><option value="dark">darker</option><option value="bright">brighter</option></select> than the background</label>
<button id="reset">As in the run</button></div>
<p id="count" aria-live="polite"></p>
<p class="quiet">An estimate from the stored candidates, which is coarse
for a diameter far from theirs. This command fits the frames anew:</p>
<pre id="command"></pre>
<div class="controls"><button id="copy">Copy the command</button><span id="copied" class="quiet" aria-live="polite"></span></div>
<h3>Diameter, px</h3><svg id="histogram-diameter" class="histogram" role="img"></svg>
<h3>Score</h3><svg id="histogram-score" class="histogram" role="img"></svg>
<p class="quiet">All frames of the page. Filled: kept; outlined: dropped, on top. Lines: the limits. Candidates that were dropped
before they had a score have the score 0.</p>
</section>
</div>
</main>
)";

constexpr std::string_view kNotes = R"(
<details class="section" id="notes"><summary><h2>Reading this page</h2></summary>
<p>Each circle has its numbers and its verdict in a tooltip. With the settings of the run, the page shows the beads and
the dropped candidates of the run. If diameter or score change, the stored candidates are judged again by the rules of the
program: diameter within 20 % (more if the sizes are spread), score, overlap. The polarity and other tried settings
have stored candidates of their own.
Candidates that were never proposed, or that were dropped before they were fitted, do not return; the command finds them.</p>
<p>The residual is the frame less the picture of the beads of the run: one profile for each size, and a level for each bead.
Between the beads it is the difference to the pixels on a straight line. Grey is up to twice the noise; white and black are
a quarter of the range of the frame above and below. A bead that was missed leaves its rim, one in the wrong place or of the
wrong size leaves a white and a black crescent or ring.</p>
</details>
)";

}  // namespace

LocateView::LocateView(const imaging::LocatingRequest& request, const imaging::Region& region,
                       const imaging::LocatorOptions& locator, const imaging::SettingsChoice& choice)
    : request_(request), region_(region), choice_(choice), stored_{{.options = locator}} {
  const imaging::LocatorOptions given = imaging::locator_of(request);
  const bool bright = locator.preprocess.bright;
  const auto store = [&](const imaging::FoundSettings& settings) {
    stored_.push_back({.options = imaging::completed(settings, given)});
    stored_.back().options.judge.drop_outliers = false;  // their command line states the diameter
    return stored_.size() - 1;
  };
  const std::size_t none = choice.tried.size() + kMaxOthers + 1;
  index_of_.assign(choice.tried.size(), none);
  if (!index_of_.empty()) index_of_[0] = 0;
  // The sliders need the other polarity, so the best settings with it come first.
  const auto flipped =
      std::find_if(choice.tried.begin(), choice.tried.end(),
                   [&](const imaging::TriedSettings& t) { return t.settings.bright != bright; });
  if (flipped != choice.tried.end()) {
    index_of_[static_cast<std::size_t>(flipped - choice.tried.begin())] = store(flipped->settings);
  } else {
    imaging::FoundSettings other = settings_of(locator);
    other.bright = !bright;
    store(other);
  }
  for (std::size_t k = 1; k < choice.tried.size() && stored_.size() <= kMaxOthers; ++k)
    if (index_of_[k] == none) index_of_[k] = store(choice.tried[k].settings);
}

void LocateView::add(std::int64_t number, const cv::Mat& grey, const imaging::Located& located) {
  if (pictures_.size() >= kMaxFrames) return;
  const imaging::EncodedFrame picture = imaging::encoded_frame(grey);
  pictures_.push_back({{"number", number},
                       {"x", region_.corner().x},
                       {"y", region_.corner().y},
                       {"width", grey.cols},
                       {"height", grey.rows},
                       {"picture", analysis::data_uri(picture.type, picture.bytes)},
                       {"residual", residual_of(grey, located)}});
  beads_ += located.beads.size();
  dropped_ += located.dropped.size();
  stored_.front().frames.push_back(candidates_json(located));
  for (std::size_t k = 1; k < stored_.size(); ++k)
    stored_[k].frames.push_back(
        candidates_json(imaging::in_whole_picture(imaging::locate(grey, stored_[k].options), region_)));
}

std::string LocateView::residual_of(const cv::Mat& grey, const imaging::Located& located) const {
  std::vector<imaging::Detection> beads = located.beads;
  for (imaging::Detection& b : beads) b.x -= region_.corner().x, b.y -= region_.corner().y;
  const imaging::EncodedFrame picture = imaging::encoded_residual(
      grey, imaging::residual_picture(grey, beads, stored_.front().options.radii_px()));
  return analysis::data_uri(picture.type, picture.bytes);
}

json LocateView::data(const std::string& command) const {
  json document = {{"command", command},
                   {"given", command_words_of_discs(request_)},
                   {"usual_score", imaging::LocatorOptions().judge.min_score},
                   {"frames", pictures_},
                   {"verdicts", json::array()},
                   {"sets", json::array()}};
  for (const Choice<imaging::Verdict>& c : imaging::kVerdicts)
    document["verdicts"].push_back({{"word", std::string(c.word)}, {"meaning", std::string(c.help)}});
  for (const Stored& s : stored_) {
    json diameters = {rounded(s.options.diameter_px, 2)};
    for (const double d : s.options.other_diameters_px) diameters.push_back(rounded(d, 2));
    document["sets"].push_back({{"diameters", diameters},
                                {"bright", s.options.preprocess.bright},
                                {"refine", s.options.refine.method},
                                {"judge", judge_json(s.options)},
                                {"frames", s.frames}});
  }
  return document;
}

std::string LocateView::page(const std::string& stack, const std::string& output, std::int64_t frames) const {
  const std::string refine = request_.locator.refine.method;
  const std::string command = fmt::format("twincell locate {} -o {}", shell_word(stack), shell_word(output)) +
                              command_words(request_);
  const std::string title = "Beads located in " + html_text(one_line(stack));
  std::string html = locate_page().mark;
  html += fmt::format(
      "<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<title>{}</title><style>{}{}</style></head><body>\n<header><h1>{}</h1></header>\n",
      title, analysis::page_style(), embedded::locate_page_css, title);
  html += fmt::format("<p id=\"summary\">{} of {} frames: {} beads, {} dropped candidates.</p>\n",
                      pictures_.size(), frames, beads_, dropped_);
  html += kBody;
  html +=
      "<details class=\"section\" id=\"tried\" open><summary><h2>Settings that were tried</h2></summary>\n";
  if (choice_.tried.empty()) {
    html += "<p>None: diameter and polarity were given.</p>\n";
  } else {
    double most = 0;
    for (const imaging::TriedSettings& t : choice_.tried) most = std::max(most, t.evidence);
    html +=
        "<div class=\"scroll\"><table><thead><tr><th>evidence, nats</th><th>share</th><th>beads</th>"
        "<th>settings</th></tr></thead><tbody>\n";
    for (std::size_t k = 0; k < choice_.tried.size(); ++k) {
      const imaging::TriedSettings& t = choice_.tried[k];
      html += fmt::format(
          "<tr{}><td>{:.0f}</td><td>{:.3f}</td><td>{}</td><td><code>{}</code>{}</td></tr>\n",
          index_of_[k] < stored_.size() ? fmt::format(" data-set=\"{}\"", index_of_[k]) : std::string(),
          t.evidence, t.evidence / most, t.beads, html_text(imaging::options_text(t.settings, refine)),
          k == 0                 ? " (chosen)"
          : t.not_chosen.empty() ? ""
                                 : " (" + html_text(t.not_chosen) + ")");
    }
    html +=
        "</tbody></table></div>\n<p class=\"quiet needs-script\">A click on a row shows its candidates, "
        "if they are stored; others are not choosable. Beads: in the examined part of one frame.</p>\n";
    html += "<p>" + html_text(settings_lead(choice_, refine)) + "</p>\n";
  }
  html += "</details>\n";
  html += kNotes;
  html += "<script type=\"application/json\" id=\"data\">" + analysis::json_script_text(data(command)) +
          "</script>\n";
  return html + "<script>" + analysis::script_text(embedded::locate_page_js) + "</script>\n</body></html>\n";
}

}  // namespace twincell::cli
