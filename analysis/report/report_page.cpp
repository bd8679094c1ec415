#include "analysis/report/report_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <string_view>

#include "analysis/report/conclusion.hpp"
#include "analysis/report/page_parts.hpp"
#include "analysis/report/report_data.hpp"
#include "analysis/report/report_tables.hpp"
#include "analysis/runs/match_verdict.hpp"
#include "core/atomic_file.hpp"
#include "core/escape.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "core/provenance.hpp"

namespace twincell::analysis {

namespace embedded {  // files of analysis/report/, embedded into the program by cmake/embed.cmake
extern const std::string_view page_js, plotly_js, plotly_license;
}

namespace {

/// The svg element of a drawing, with `prefix` added to its identifiers, because several drawings share one
/// page.
std::string inline_svg(const std::string& file, const std::string& prefix, const std::string& title) {
  std::string svg = file.substr(file.find("<svg"));
  svg = std::regex_replace(svg, std::regex("(\\sid\\s*=\\s*[\"'])"), fmt::format("$1{}-", prefix));
  svg = std::regex_replace(svg, std::regex("(href\\s*=\\s*[\"']#)"), fmt::format("$1{}-", prefix));
  svg = std::regex_replace(svg, std::regex("(url[(]['\"]?#)"), fmt::format("$1{}-", prefix));
  return svg.replace(0, 4, fmt::format("<svg role=\"img\" aria-label=\"{}\"", html_text(title)));
}

/// The elements in which the script draws. Without JavaScript they are hidden, and only the figures by
/// gnuplot further down are shown.
constexpr std::string_view kOpening = R"(
<div class="opening needs-script">
<section aria-labelledby="diagram-title">
<h2 id="diagram-title">Phase diagram</h2>
<div id="phase-diagram" role="img" tabindex="0" aria-describedby="diagram-words"></div>
<p id="diagram-key"></p>
<p id="diagram-words" class="quiet"></p>
</section>
<section id="point" aria-labelledby="point-title">
<h2 id="point-title" aria-live="polite">A point</h2>
<div class="controls"><label>Point <select id="which"></select></label></div>
<div class="frames">
<figure id="panel-experiment"><svg class="beads" role="img"></svg><figcaption></figcaption></figure>
<figure id="panel-simulation"><svg class="beads" role="img"></svg><figcaption></figcaption></figure>
</div>
<div class="controls"><button id="play">Play</button><label>film <select id="film"><option value="cycle">within one cycle</option><option value="strobe">from cycle to cycle</option><option value="all">all frames</option></select></label><input id="moment" type="range" min="0" value="0" aria-label="frame"><span id="moment-label"></span></div>
<div class="controls">
<label><input type="checkbox" id="layer-raw" checked> camera frame</label>
<label><input type="checkbox" id="layer-found" checked> beads</label>
<label><input type="checkbox" id="layer-other"> other side on top</label>
<label><input type="checkbox" id="layer-tracks" checked> tracks</label>
<label>colour <select id="colour"><option value="q6">q6</option><option value="psi6">ψ6</option><option value="structure">local structure</option><option value="coordination">Voronoi neighbours (defects)</option><option value="none">none</option></select></label>
</div>
<p id="key"></p>
<p class="quiet controls-only">Wheel: zoom (Ctrl: out beyond the whole picture). Drag: move. Double-click: reset.</p>
</section>
</div>
)";
constexpr std::string_view kSeries = R"(
<div class="pair">
<div><h3>Height of the tracers above the plate, s(k)</h3><div id="series-s_k" role="img" aria-label="s(k) over the phase of the drive, both sides"></div></div>
<div><h3>Spread of the tracer line, s<sub>j</sub></h3><div id="series-s_j" role="img" aria-label="spread of the tracer line over the cycles, both sides"></div></div>
</div>
<div class="pair">
<figure id="convection-experiment" hidden><svg class="field" role="img"></svg><figcaption></figcaption></figure>
<figure id="convection-simulation" hidden><svg class="field" role="img"></svg><figcaption></figcaption></figure>
</div>
)";
constexpr std::string_view kThresholds = R"(
<div class="pair"><div id="curve-s_b" role="img" aria-label="s_b against the drive, both sides, with the threshold of bouncing"></div><div id="curve-s_c" role="img" aria-label="s_c against the drive, both sides, with the threshold of convection"></div></div>
)";

std::string filmed_words(const Comparison& c) {
  std::vector<std::string> names;
  for (const Checks::Filmed& f : c.checks.filmed)
    names.push_back(fmt::format("{} ({})", c.runs[f.run].name, f.camera));
  return names.empty()
             ? "Nothing was filmed, so the effect of camera and tracking is not known."
             : fmt::format("Filmed by the synthetic camera, located, linked and analysed again: {}.",
                           fmt::join(names, "; "));
}

std::string static_figures(const std::vector<Figure>& figures, const std::filesystem::path& folder) {
  std::string html = "<div class=\"static\">\n";
  for (const Figure& figure : figures)
    html += fmt::format(
        "<h3>{}</h3>\n<figure><div class=\"picture\">{}</div><figcaption>{} <small>(figures/{}.svg, .pdf, "
        ".png, .gp, .dat)</small></figcaption></figure>\n",
        typeset(figure.title),
        inline_svg(read_text_file(folder / (figure.name + ".svg")), figure.name, figure.title),
        typeset(figure.caption), figure.name);
  return html + "</div>\n";
}

/// A folding section of the page.
struct Section {
  std::string id, title, body;
  bool open = true;
  bool needs_script = false;
};

/// The sections after the opening, in the order of the page.
std::vector<Section> sections_of(const Comparison& c, const std::vector<Figure>& figures,
                                 const std::filesystem::path& figure_folder,
                                 const std::string& provenance_json) {
  std::vector<Section> list;
  const bool beds = !c.runs.empty();
  if (beds) list.push_back({"phases", "Phases at each drive strength", verdict_table(c.runs, c.matches)});
  if (!c.differences.empty()) {
    const auto real = std::count_if(c.differences.begin(), c.differences.end(),
                                    [](const Difference& d) { return d.is_real(); });
    list.push_back(
        {"differences", "Differences",
         "<p>Experiment minus simulation. The contribution of camera and tracking is the difference between "
         "the simulation as filmed and tracked and the simulation itself; what is left is compared with its "
         "error. A difference is real if what is left exceeds two errors (more among many numbers, so that "
         "at most 5 "
         "% of the real ones are chance) and the difference between starts "
         "with other defects; an experiment between the simulation and its film is none. " +
             html_text(filmed_words(c)) +
             fmt::format("</p>\n<p class=\"needs-script\"><label><input type=\"checkbox\" id=\"only-real\" "
                         "checked> only the {} real of {} differences</label></p>\n",
                         real, c.differences.size()) +
             differences_table(c)});
  }
  if (!c.boundaries.empty())
    list.push_back(
        {"onsets", "Onsets",
         "<p>Each onset is between the strongest drive without the phase and the weakest drive with it: a "
         "bracket, not a fit. Those of a sweep are fitted, with their 95 % interval.</p>\n" +
             boundary_table(c.boundaries)});
  if (beds) {
    list.push_back(
        {"curves-of-point", "Curves and convection of the chosen point", std::string(kSeries), true, true});
    list.push_back({"curves", "s<sub>b</sub> and s<sub>c</sub> against the drive", std::string(kThresholds),
                    true, true});
    list.push_back({"runs", "Runs", runs_table(c)});
  }
  list.push_back({"figures", "Figures for print",
                  "<p>The same figures, drawn by gnuplot; the folder figures/ has them as SVG, PDF and "
                  "PNG.</p>\n" +
                      static_figures(figures, figure_folder),
                  false});
  list.push_back({"conventions", "How each number is computed", conventions(c.runs), false});
  list.push_back(
      {"provenance", "Provenance",
       "<p>" + html_text(version_line()) + "</p>\n<pre>" +
           html_text(json_text(nlohmann::json::parse(provenance_json), 2)) +
           "</pre>\n<details><summary>Licence of plotly.js, which draws the graphs</summary><pre>" +
           html_text(std::string(embedded::plotly_license)) + "</pre></details>\n",
       false});
  return list;
}

/// "Experiment and simulation: cell 10 σ wide, N_l = 6 and 10": the sides that there are, the width of the
/// first run, all heights.
std::string title_of(const Comparison& c) {
  if (c.runs.empty()) return "Simulated phase diagram";
  bool experiment = false, simulation = false;
  for (const Match& match : c.matches) {
    experiment = experiment || !match.experiments.empty();
    simulation = simulation || !match.simulations.empty();
  }
  return fmt::format("{}: cell {:.3g} σ wide, N_l = {:.3g}",
                     experiment && simulation ? "Experiment and simulation"
                     : experiment             ? "Experiment"
                                              : "Simulation",
                     c.runs.front().box.size().x(), fmt::join(heights_of(c.matches), " and "));
}

/// The conclusion as the box that opens the page. Its class says by colour whether the sides agree.
std::string verdict_box(const Comparison& c) {
  bool differ = false, same = !c.matches.empty();
  for (const Match& match : c.matches) {
    const std::string word = verdict_word(c.runs, match);
    differ = differ || word == "differ";
    same = same && (word == "same" || match.experiments.empty() || match.simulations.empty());
  }
  std::string html = fmt::format("<div class=\"verdict {}\" id=\"verdict\">\n", differ ? "differ"
                                                                                : same ? "same"
                                                                                       : "open");
  for (const std::string& sentence : conclusion_sentences(c)) html += "<p>" + typeset(sentence) + "</p>\n";
  return html + "</div>\n";
}

/// The notes that the program printed, folded if there are many.
std::string notes_list(const Comparison& c) {
  constexpr std::size_t kFew = 6;
  if (c.notes.empty()) return {};
  std::string html = fmt::format("<details class=\"notes\" id=\"notes\"{}><summary>{}</summary>\n<ul>\n",
                                 c.notes.size() <= kFew ? " open" : "", plural(c.notes.size(), "note"));
  for (const std::string& note : c.notes) html += "<li>" + typeset(note) + "</li>\n";
  return html + "</ul></details>\n";
}

}  // namespace

std::string report_page(const Comparison& c, const std::vector<Figure>& figures,
                        const std::filesystem::path& figure_folder, const std::string& provenance_json) {
  const nlohmann::json provenance = nlohmann::json::parse(provenance_json);
  const std::string date = provenance.value("utc", std::string()).substr(0, 10);
  const std::string title = title_of(c);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n"
      "<title>{} ({})</title><style>{}</style></head><body>\n<header><h1>{}</h1><span>{} <button "
      "id=\"theme\" hidden>Dark</button></span></header>\n{}",
      html_text(title), date, page_style(), typeset(title), date, verdict_box(c) + notes_list(c));
  html += kOpening;
  html +=
      "<p class=\"quiet\">Both sides went through the same analysis. A bed <em>bounces</em> if s<sub>b</sub> "
      "&gt; σ/30 and <em>convects</em> if also s<sub>c</sub> &gt; σ (Fortini &amp; Huang 2015, app. B). In "
      "brackets: 95 % intervals.</p>\n";
  const std::vector<Section> sections = sections_of(c, figures, figure_folder, provenance_json);
  html += "<nav aria-label=\"Contents\"><ol>\n";
  for (const Section& s : sections)
    html += fmt::format("<li{}><a href=\"#{}\">{}</a></li>\n", s.needs_script ? " class=\"of-script\"" : "",
                        s.id, s.title);
  html += "</ol></nav>\n<main>\n";
  for (const Section& s : sections)
    html +=
        fmt::format("<details class=\"section{}\" id=\"{}\"{}><summary><h2>{}</h2></summary>\n{}</details>\n",
                    s.needs_script ? " needs-script" : "", s.id, s.open ? " open" : "", s.title, s.body);
  html += "</main>\n";
  html += "<script type=\"application/json\" id=\"data\">" + report_data(c) + "</script>\n";
  html += "<script>" + script_text(embedded::plotly_js) + "</script>\n<script>" +
          script_text(embedded::page_js) + "</script>\n</body></html>\n";
  return html;
}

}  // namespace twincell::analysis
