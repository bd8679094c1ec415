#include "analysis/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string_view>

#include "analysis/observable/results.hpp"
#include "analysis/report/boundary_figure.hpp"
#include "analysis/report/figures.hpp"
#include "analysis/report/page_parts.hpp"
#include "analysis/report/report_data.hpp"
#include "analysis/runs/onset_agreement.hpp"
#include "core/atomic_file.hpp"
#include "core/escape.hpp"
#include "core/json_text.hpp"
#include "core/provenance.hpp"

namespace twincell::analysis {

namespace embedded {  // files of analysis/report/, embedded into the program by cmake/embed.cmake
extern const std::string_view page_js, plotly_js, plotly_license;
}

namespace {

/// `text` escaped for HTML, with names such as s_b and q6 set as symbols with a subscript.
std::string typeset(const std::string& text) {
  return std::regex_replace(
      std::regex_replace(html_text(text), std::regex("\\b([sTNK])_([a-z])\\b"), "$1<sub>$2</sub>"),
      std::regex("\\bq6\\b"), "q<sub>6</sub>");
}

std::string number(double v, const char* absent = "–") {
  return std::isfinite(v) ? fmt::format("{:.4g}", v) : absent;
}

/// The value and, on a separate line, its interval; or "absent".
std::string value_and_interval(const Run& run, const std::string& name) {
  const Result& r = find_result(run.results, name);
  if (!r.present()) return "absent";
  std::string html = fmt::format("{:.3g}", r.value());
  if (r.interval)
    html += fmt::format("<br><small>[{:.3g}, {:.3g}]</small>", r.interval->low, r.interval->high);
  return html;
}

std::string phases_of(const std::vector<Run>& runs, const std::vector<std::size_t>& members) {
  if (members.empty()) return "no run";
  const BedPhase common = common_phase(runs, members);
  if (common != BedPhase::undetermined || members.size() == 1) return phase_name(common);
  std::vector<std::string> names;
  names.reserve(members.size());
  for (const std::size_t i : members) names.push_back(phase_name(runs[i].phase));
  return fmt::format("{}", fmt::join(names, " / "));
}

/// How many numbers really differ, and the first of them by name.
std::string real_differences(const Comparison& c) {
  constexpr std::size_t kMostNamed = 5;
  const bool heights = heights_of(c.matches).size() > 1;
  std::vector<std::string> names;
  std::size_t without_error = 0, without_seeds = 0;
  for (const Difference& d : c.differences) {
    if (!d.in_errors()) ++without_error;
    if (d.is_real() && !d.seeds) ++without_seeds;
    if (d.is_real())
      names.push_back(fmt::format("{} at {}", d.quantity, condition_text(c.matches[d.match], heights)));
  }
  if (c.differences.empty()) return {};
  if (names.empty())
    return fmt::format("None of the {} compared numbers really differs{}.", c.differences.size(),
                       without_error > 0 ? fmt::format("; of {} no error is known", without_error) : "");
  const std::size_t n = names.size();
  if (n > kMostNamed) names.resize(kMostNamed);
  std::string text =
      fmt::format("{} of the {} compared numbers really differ{}: {}{}.", n, c.differences.size(),
                  n == 1 ? "s" : "", fmt::join(names, heights ? "; " : ", "),
                  n > kMostNamed ? fmt::format(" and {} more", n - kMostNamed) : "");
  // Two standard errors are exceeded by chance in 4.6 % of the cases.
  constexpr double kByChance = 0.0455;
  const double by_chance = kByChance * static_cast<double>(c.differences.size() - without_error);
  if (by_chance >= 1)
    text += fmt::format(" By chance alone, about {:.0f} of the {} with known errors would.", by_chance,
                        c.differences.size() - without_error);
  if (without_seeds > 0)
    text += fmt::format(
        " The error of {} contains no scatter between seeds, as there is one simulation of each start: other "
        "seeds may differ as much.",
        without_seeds == n ? (n == 1 ? std::string("this") : "these")
                           : fmt::format("{} of these", without_seeds));
  return text;
}

std::string conclusion_of_sweep(const Comparison& c) {
  std::string text = fmt::format("The diagram shows {} points of a sweep.", c.sweep.size());
  for (const PhaseBoundary& b : c.boundaries)
    text += fmt::format(" Onset of {} ({}, N_l = {:.3g}): Gamma {}.", onset_name(b.onset), boundary_of(b),
                        b.n_l, boundary_text(b));
  return text;
}

/// Concluding sentences: where the sides agree and where they differ.
std::vector<std::string> conclusion_sentences(const Comparison& c) {
  const std::vector<Run>& runs = c.runs;
  const std::vector<Match>& matches = c.matches;
  if (runs.empty() && (!c.sweep.empty() || !c.boundaries.empty())) return {conclusion_of_sweep(c)};
  const bool heights = heights_of(matches).size() > 1;
  std::vector<std::string> differ, open;
  std::size_t paired = 0, same = 0;
  for (const Match& match : matches) {
    if (match.experiments.empty() || match.simulations.empty()) continue;
    ++paired;
    const std::string word = verdict_word(runs, match);
    if (word == "same") {
      ++same;
      continue;
    }
    (word == "differ" ? differ : open)
        .push_back(fmt::format("{} ({} in the experiment, {} in the simulation)",
                               condition_text(match, heights), phases_of(runs, match.experiments),
                               phases_of(runs, match.simulations)));
  }
  if (paired == 0)
    return {heights_of(matches).size() > 1
                ? "No drive strength was run on both sides at the same height of the bed."
                : "No drive strength was run on both sides."};
  std::vector<std::string> text = {
      fmt::format("Same phase on both sides at {} of {} {}.", same, paired,
                  heights ? "points (drive strength and height)" : "drive strengths")};
  if (!differ.empty()) text.push_back(fmt::format("They differ at {}.", fmt::join(differ, "; ")));
  if (!open.empty()) text.push_back(fmt::format("Undetermined at {}.", fmt::join(open, "; ")));
  for (std::string& onset : onset_sentences(c.boundaries)) text.push_back(std::move(onset));
  if (const std::string real = real_differences(c); !real.empty()) text.push_back(real);
  return text;
}

std::string conclusion(const Comparison& c) {
  return fmt::format("{}", fmt::join(conclusion_sentences(c), " "));
}

nlohmann::json or_null(double v) {
  return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr);
}

/// Names of the scalar results, in the order of the observables.
std::vector<std::string> scalar_names(const std::vector<Run>& runs) {
  std::vector<std::string> names;
  for (const std::string& name : result_names()) {
    const auto is_number = [&](const Run& run) {
      const Result* r = seek_result(run.results, name);
      return r != nullptr && r->present() && r->shape.empty() && r->text.empty();
    };
    if (std::any_of(runs.begin(), runs.end(), is_number)) names.push_back(name);
  }
  return names;
}

double value_of(const Result* r) {
  return r != nullptr ? r->value() : std::numeric_limits<double>::quiet_NaN();
}

std::string csv_number(double v) {
  return std::isfinite(v) ? fmt::format("{:.9g}", v) : std::string();
}

/// One line per run; an empty field is an absent value.
std::string runs_csv(const std::vector<Run>& runs) {
  const auto names = scalar_names(runs);
  std::string text = "side,run,start,gamma,k_m,n_l,n_beads,n_frames,phase";
  for (const std::string& name : names) text += fmt::format(",{0},{0}_low,{0}_high", name);
  text += "\n";
  for (const Run& run : runs) {
    text += fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{},{},{}", side_name(run.side), csv_field(run.name),
                        csv_field(run.start), run.gamma, run.k_m, run.n_l, run.n_beads, run.n_frames,
                        phase_name(run.phase));
    for (const std::string& name : names) {
      const Result* r = seek_result(run.results, name);
      text += fmt::format(",{}", csv_number(value_of(r)));
      text += r != nullptr && r->interval ? fmt::format(",{:.9g},{:.9g}", r->interval->low, r->interval->high)
                                          : ",,";
    }
    text += "\n";
  }
  return text;
}

/// One line per match and number; an empty field is a value that was not determined.
std::string differences_csv(const Comparison& c) {
  std::string text =
      "gamma,n_l,number,unit,experiment,experiment_error,simulation,simulation_error,difference,filmed,"
      "camera,statistics,seeds,tracers,defects,remainder,error,attribution\n";
  const auto part = [](const std::optional<double>& v) {
    return csv_number(v.value_or(std::numeric_limits<double>::quiet_NaN()));
  };
  for (const Difference& d : c.differences)
    text +=
        fmt::format("{:.9g},{:.9g},{},{},{:.9g},{},{:.9g},{},{:.9g},{},{},{},{},{},{},{:.9g},{},{}\n",
                    c.matches[d.match].gamma, c.matches[d.match].n_l, d.quantity, d.unit, d.experiment.value,
                    part(d.experiment.error), d.simulation.value, part(d.simulation.error), d.difference(),
                    part(d.filmed), part(d.camera), part(d.statistics), part(d.seeds), part(d.tracers),
                    part(d.defects), d.remainder(), part(d.error()), csv_field(d.attribution()));
  return text;
}

/// A series in long form: one line per run and element.
std::string series_csv(const std::vector<Run>& runs, const std::string& name, const std::string& index) {
  std::string text = fmt::format("side,run,gamma,{},{}\n", index, name);
  for (const Run& run : runs) {
    const Result& r = find_result(run.results, name);
    for (std::size_t i = 0; i < r.values.size(); ++i)
      text += fmt::format("{},{},{:.9g},{},{}\n", side_name(run.side), csv_field(run.name), run.gamma, i,
                          std::isfinite(r.values[i]) ? fmt::format("{:.9g}", r.values[i]) : "");
  }
  return text;
}

std::string chips(const std::vector<Run>& runs, const std::vector<std::size_t>& members) {
  if (members.empty()) return "no run";
  std::set<BedPhase> phases;
  for (const std::size_t i : members) phases.insert(runs[i].phase);
  std::string html;
  for (const BedPhase phase : phases)
    html += fmt::format("<span class=\"chip {0}\">{0}</span> ", phase_name(phase));
  return html;
}

std::string numbers_of(const std::vector<Run>& runs, const std::vector<std::size_t>& members,
                       const std::string& name) {
  std::vector<std::string> lines;
  lines.reserve(members.size());
  for (const std::size_t i : members) lines.push_back(value_and_interval(runs[i], name));
  return fmt::format("{}", fmt::join(lines, "<br>"));
}

/// An HTML table. The script of the page makes it sortable by its headings and downloadable.
class Table {
 public:
  Table(const std::string& name, const std::vector<std::string>& heads)
      : html_(fmt::format("<div class=\"scroll\"><table data-name=\"{}\"><thead><tr>", name)) {
    for (const std::string& head : heads) html_ += "<th>" + head + "</th>";
    html_ += "</tr></thead><tbody>\n";
  }
  void row(const std::string& attributes = {}) {
    if (open_) html_ += "</tr>\n";
    html_ += "<tr" + attributes + ">";
    open_ = true;
  }
  void cell(const std::string& html, const char* kind = "") {
    html_ += fmt::format("<td{}>{}</td>", *kind != 0 ? fmt::format(" class=\"{}\"", kind) : "", html);
  }
  void cell(const std::optional<double>& v) { cell(v ? number(*v) : "–"); }
  [[nodiscard]] std::string html() const {
    return html_ + (open_ ? "</tr>\n" : "") + "</tbody></table></div>\n";
  }

 private:
  std::string html_;
  bool open_ = false;
};

std::string verdict_table(const std::vector<Run>& runs, const std::vector<Match>& matches) {
  Table table("phases", {"Γ", "K<sub>m</sub>", "N<sub>l</sub>σ", "experiment", "simulation", "verdict",
                         "s<sub>b</sub>/σ experiment", "s<sub>b</sub>/σ simulation",
                         "s<sub>c</sub>/σ experiment", "s<sub>c</sub>/σ simulation"});
  for (const Match& match : matches) {
    const std::size_t first =
        match.experiments.empty() ? match.simulations.front() : match.experiments.front();
    const std::string word = verdict_word(runs, match);
    table.row(fmt::format(" data-run=\"{}\"{}", first, word == "differ" ? " class=\"differ\"" : ""));
    table.cell(match.gamma);
    table.cell(runs[first].k_m);
    table.cell(match.n_l);
    table.cell(chips(runs, match.experiments));
    table.cell(chips(runs, match.simulations));
    table.cell(word == "differ" ? "<strong>differ</strong>" : word);
    for (const char* name : {"s_b", "s_c"})
      for (const auto& members : {match.experiments, match.simulations})
        table.cell(numbers_of(runs, members, name), "nowrap");
  }
  return table.html();
}

/// The runs with all their numbers. After name and side come the columns of the numbers that differ really
/// between the sides, then those that differ between the runs, then those that are the same in all.
std::string runs_table(const Comparison& c) {
  struct Column {
    std::string name, head;
    std::vector<std::string> cells;
    int rank = 1;
  };
  std::vector<Column> columns;
  const auto add = [&](const std::string& name, const std::string& head, const auto& cell_of) {
    Column column{.name = name, .head = head, .cells = {}};
    for (const Run& run : c.runs) column.cells.push_back(cell_of(run));
    const auto& cells = column.cells;
    if (std::all_of(cells.begin(), cells.end(), [&](const std::string& s) { return s == cells.front(); }))
      column.rank = 2;
    const bool real = std::any_of(c.differences.begin(), c.differences.end(),
                                  [&](const Difference& d) { return d.is_real() && d.quantity == name; });
    if (real) column.rank = 0;
    columns.push_back(std::move(column));
  };
  add("phase", "phase", [](const Run& run) { return std::string(phase_name(run.phase)); });
  add("start", "start", [](const Run& run) { return run.start.empty() ? "–" : html_text(run.start); });
  add("beads", "beads", [](const Run& run) { return fmt::format("{}", run.n_beads); });
  add("frames", "frames", [](const Run& run) { return fmt::format("{}", run.n_frames); });
  for (const std::string& name : scalar_names(c.runs))
    add(name, typeset(name),
        [&](const Run& run) { return number(value_of(seek_result(run.results, name)), "absent"); });
  std::stable_sort(columns.begin(), columns.end(),
                   [](const Column& a, const Column& b) { return a.rank < b.rank; });

  std::vector<std::string> heads = {"run", "side", "Γ"};
  for (const Column& column : columns) heads.push_back(column.head);
  Table table("runs", heads);
  for (std::size_t i = 0; i < c.runs.size(); ++i) {
    table.row(fmt::format(" data-run=\"{}\"", i));
    table.cell(html_text(c.runs[i].name), "nowrap");
    table.cell(side_name(c.runs[i].side));
    table.cell(c.runs[i].gamma);
    for (const Column& column : columns) table.cell(column.cells[i]);
  }
  return table.html();
}

std::string boundary_table(const std::vector<PhaseBoundary>& boundaries) {
  Table table("boundaries", {"onset of", "of", "N<sub>l</sub>σ", "Γ", "half width", "runs"});
  for (const PhaseBoundary& b : boundaries) {
    table.row();
    table.cell(onset_name(b.onset));
    table.cell(html_text(boundary_of(b)));
    table.cell(b.n_l);
    if (b.half_width()) {
      table.cell(b.gamma());
      table.cell(b.half_width());
    } else {
      table.cell(boundary_text(b));
      table.cell("–");
    }
    table.cell(fmt::format("{}{}", b.n_runs, b.overlap ? ", which overlap" : ""));
  }
  return table.html();
}

std::string with_error(const Measured& m) {
  return m.error ? fmt::format("{:.4g} ± {:.2g}", m.value, *m.error) : fmt::format("{:.4g}", m.value);
}

/// What a difference is made of: the effect of camera and tracking, and the parts of its error.
std::string composition(const Difference& d) {
  std::vector<std::string> parts;
  const auto add = [&](const char* name, const std::optional<double>& v) {
    if (v) parts.push_back(fmt::format("{} {:.2g}", name, *v));
  };
  if (d.camera) parts.push_back(fmt::format("camera and tracking {:+.2g}", *d.camera));
  add("statistics ±", d.statistics);
  add("seeds ±", d.seed_error());
  add("tracers ±", d.tracers);
  add("between starts", d.defects);
  return parts.empty() ? "–" : fmt::format("{}", fmt::join(parts, "; "));
}

std::string differences_table(const Comparison& c) {
  Table table("differences",
              {"Γ", "N<sub>l</sub>", "number", "unit", "experiment", "simulation", "difference",
               "what is left", "error", "in errors", "made of", "attributed to"});
  for (const Difference& d : c.differences) {
    table.row(fmt::format(" data-run=\"{}\" class=\"{}\"", c.matches[d.match].experiments.front(),
                          d.is_real() ? "real" : "agrees"));
    table.cell(c.matches[d.match].gamma);
    table.cell(c.matches[d.match].n_l);
    table.cell(typeset(d.quantity));
    table.cell(html_text(d.unit));
    table.cell(with_error(d.experiment), "nowrap");
    table.cell(with_error(d.simulation), "nowrap");
    table.cell(d.difference());
    table.cell(d.remainder());
    table.cell(d.error());
    const auto t = d.in_errors();
    table.cell(t ? fmt::format("{:.1f}", *t) : "–");
    table.cell(composition(d), "words");
    table.cell(d.attribution(), "words");
  }
  return table.html();
}

/// The conventions of each result. Each distinct sentence appears once, with the runs to which it applies.
std::string conventions(const std::vector<Run>& runs) {
  std::string html = "<ul>\n";
  for (const std::string& name : result_names()) {
    std::vector<std::pair<std::string, std::vector<std::string>>> sentences;
    for (const Run& run : runs) {
      const auto found = std::find_if(run.results.begin(), run.results.end(),
                                      [&](const Result& r) { return r.name == name; });
      if (found == run.results.end()) continue;
      std::string sentence = found->present() ? found->convention : "absent: " + found->absent;
      if (found->interval) sentence += "; interval: " + found->interval->method;
      const auto same = std::find_if(sentences.begin(), sentences.end(),
                                     [&](const auto& s) { return s.first == sentence; });
      if (same == sentences.end())
        sentences.push_back({sentence, {run.name}});
      else
        same->second.push_back(run.name);
    }
    if (sentences.empty()) continue;
    const std::string source = find_result(runs.front().results, name).source;
    html += fmt::format("<li><strong>{}</strong> ({})", name, html_text(source));
    for (const auto& [sentence, of] : sentences)
      html += of.size() == runs.size() ? fmt::format(" {}.", html_text(sentence))
                                       : fmt::format("<br>{} <small>[{}]</small>", html_text(sentence),
                                                     html_text(fmt::format("{}", fmt::join(of, ", "))));
    html += "</li>\n";
  }
  return html + "</ul>\n";
}

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
         "error. A difference is real if what is left exceeds two errors and the difference between starts "
         "with other defects. " +
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

/// "cell 10 σ wide, N_l = 6 and 10": the width of the first run, all heights; "sweep" without runs.
std::string cell_words(const Comparison& c) {
  if (c.runs.empty()) return "sweep";
  return fmt::format("cell {:.3g} σ wide, N_l = {:.3g}", c.runs.front().box.size().x(),
                     fmt::join(heights_of(c.matches), " and "));
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

std::string page(const Comparison& c, const std::vector<Figure>& figures,
                 const std::filesystem::path& figure_folder, const std::string& provenance_json) {
  const nlohmann::json provenance = nlohmann::json::parse(provenance_json);
  const std::string date = provenance.value("utc", std::string()).substr(0, 10);
  const std::string title = fmt::format("Experiment and simulation: {}", cell_words(c));
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n"
      "<title>{} ({})</title><style>{}</style></head><body>\n<header><h1>{}</h1><span>{} <button "
      "id=\"theme\" hidden>Dark</button></span></header>\n{}",
      html_text(title), date, page_style(), typeset(title), date, verdict_box(c));
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

nlohmann::json differences_json(const std::vector<Difference>& differences,
                                const std::vector<Match>& matches) {
  nlohmann::json list = nlohmann::json::array();
  const auto part = [](const std::optional<double>& v) {
    return or_null(v.value_or(std::numeric_limits<double>::quiet_NaN()));
  };
  const auto measured = [&](const Measured& m) {
    return nlohmann::json{{"value", m.value}, {"error", part(m.error)}};
  };
  for (const Difference& d : differences)
    list.push_back({{"gamma", matches[d.match].gamma},
                    {"n_l", matches[d.match].n_l},
                    {"number", d.quantity},
                    {"unit", d.unit},
                    {"experiment", measured(d.experiment)},
                    {"simulation", measured(d.simulation)},
                    {"difference", d.difference()},
                    {"filmed", part(d.filmed)},
                    {"camera", part(d.camera)},
                    {"statistics", part(d.statistics)},
                    {"seeds", part(d.seeds)},
                    {"tracers", part(d.tracers)},
                    {"defects", part(d.defects)},
                    {"remainder", d.remainder()},
                    {"error", part(d.error())},
                    {"attribution", d.attribution()}});
  return list;
}

nlohmann::json boundaries_json(const std::vector<PhaseBoundary>& boundaries) {
  nlohmann::json list = nlohmann::json::array();
  const auto part = [](const std::optional<double>& v) {
    return or_null(v.value_or(std::numeric_limits<double>::quiet_NaN()));
  };
  for (const PhaseBoundary& b : boundaries)
    list.push_back({{"onset", phase_name(b.onset)},
                    {"of", boundary_of(b)},
                    {"n_l", b.n_l},
                    {"gamma", part(b.gamma())},
                    {"half_width", part(b.half_width())},
                    {"below", part(b.below)},
                    {"above", part(b.above)},
                    {"runs", b.n_runs},
                    {"overlap", b.overlap}});
  return list;
}

}  // namespace

namespace {

/// Phases of both sides at each drive strength, and the onsets.
std::string phases_text(const Comparison& c) {
  std::string text;
  if (!c.matches.empty())
    text = fmt::format("{:>7}  {:>7}  {:>6}  {:<22}  {:<22}  {}\n", "Gamma", "K_m", "N_l", "experiment",
                       "simulation", "verdict");
  for (const Match& match : c.matches) {
    const Run& any =
        c.runs[match.experiments.empty() ? match.simulations.front() : match.experiments.front()];
    text += fmt::format("{:>7.3f}  {:>7.3f}  {:>6.2f}  {:<22}  {:<22}  {}\n", match.gamma, any.k_m, match.n_l,
                        phases_of(c.runs, match.experiments), phases_of(c.runs, match.simulations),
                        verdict_word(c.runs, match));
  }
  for (const PhaseBoundary& b : c.boundaries)
    text += fmt::format("onset of {}, {}, N_l = {:.3g}: Gamma {}\n", onset_name(b.onset), boundary_of(b),
                        b.n_l, boundary_text(b));
  return text;
}

}  // namespace

std::string comparison_text(const Comparison& c) {
  return conclusion(c) + "\n" + phases_text(c) + differences_text(c.differences, c.matches);
}

std::string comparison_summary(const Comparison& c) {
  return fmt::format("{}\n", fmt::join(conclusion_sentences(c), "\n")) + phases_text(c) +
         real_differences_text(c.differences, c.matches);
}

std::string comparison_json(const Comparison& c) {
  nlohmann::json document;
  document["conclusion"] = conclusion(c);
  document["runs"] = nlohmann::json::array();
  for (const Run& run : c.runs)
    document["runs"].push_back({{"side", side_name(run.side)},
                                {"run", run.name},
                                {"start", run.start},
                                {"gamma", or_null(run.gamma)},
                                {"k_m", or_null(run.k_m)},
                                {"n_l", or_null(run.n_l)},
                                {"n_beads", run.n_beads},
                                {"n_frames", run.n_frames},
                                {"phase", phase_name(run.phase)},
                                {"results", nlohmann::json::parse(results_json(run.results))}});
  document["matches"] = nlohmann::json::array();
  const auto names = [&](const std::vector<std::size_t>& members) {
    nlohmann::json list = nlohmann::json::array();
    for (const std::size_t i : members)
      list.push_back({{"run", c.runs[i].name}, {"phase", phase_name(c.runs[i].phase)}});
    return list;
  };
  for (const Match& match : c.matches)
    document["matches"].push_back({{"gamma", match.gamma},
                                   {"experiments", names(match.experiments)},
                                   {"simulations", names(match.simulations)},
                                   {"verdict", verdict_word(c.runs, match)}});
  document["boundaries"] = boundaries_json(c.boundaries);
  document["differences"] = differences_json(c.differences, c.matches);
  return json_text(document);
}

void write_report(const std::filesystem::path& folder, const Comparison& c,
                  const std::string& provenance_json, Progress& progress) {
  AtomicPath output(folder, report_folder());
  const std::filesystem::path figure_folder = output.part() / "figures";
  std::filesystem::create_directories(figure_folder);

  std::vector<Figure> figures;
  if (!c.runs.empty())
    figures = {phase_strip_figure(c.runs), phase_diagram_figure(c.runs), thresholds_figure(c.runs),
               s_k_figure(c.runs), s_j_figure(c.runs)};
  if (!c.boundaries.empty() || !c.sweep.empty()) figures.push_back(boundary_figure(c));
  for (std::size_t m = 0; m < c.matches.size(); ++m)
    figures.push_back(snapshots_figure(c.runs, c.matches[m], fmt::format("snapshots_{}", m + 1)));
  for (std::size_t i = 0; i < figures.size(); ++i) {
    draw(figures[i], figure_folder);
    progress.update(static_cast<std::int64_t>(i) + 1, static_cast<std::int64_t>(figures.size()));
  }
  write_text_file(output.part() / "runs.csv", runs_csv(c.runs));
  write_text_file(output.part() / "differences.csv", differences_csv(c));
  write_text_file(output.part() / "series_s_k.csv", series_csv(c.runs, "s_k", "k"));
  write_text_file(output.part() / "series_s_j.csv", series_csv(c.runs, "s_j", "j"));
  write_text_file(output.part() / "phases.txt", comparison_text(c));
  write_text_file(output.part() / "results.json", comparison_json(c) + "\n");
  write_text_file(output.part() / "provenance.json", provenance_json + "\n");
  write_text_file(output.part() / "report.html", page(c, figures, figure_folder, provenance_json));
  output.commit();
}

}  // namespace twincell::analysis
