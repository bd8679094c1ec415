#include "analysis/report/report_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>

#include "analysis/observable/results.hpp"
#include "analysis/report/page_parts.hpp"
#include "analysis/report/report_csv.hpp"
#include "analysis/runs/match_verdict.hpp"
#include "core/escape.hpp"

namespace twincell::analysis {

namespace {

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
  /// \param printed which columns are printed; empty: all
  Table(const std::string& name, const std::vector<std::string>& heads, std::vector<bool> printed = {})
      : html_(fmt::format("<div class=\"scroll\"><table data-name=\"{}\"><thead><tr>", name)),
        printed_(std::move(printed)) {
    for (const std::string& head : heads) add("th", head);
    html_ += "</tr></thead><tbody>\n";
  }
  void row(const std::string& attributes = {}) {
    if (open_) html_ += "</tr>\n";
    html_ += "<tr" + attributes + ">";
    open_ = true;
    column_ = 0;
  }
  void cell(const std::string& html, const std::string& kind = {}) { add("td", html, kind); }
  void cell(const std::optional<double>& v) { cell(v ? number(*v) : "–"); }
  [[nodiscard]] std::string html() const {
    return html_ + (open_ ? "</tr>\n" : "") + "</tbody></table></div>\n";
  }

 private:
  void add(const char* tag, const std::string& html, std::string kind = {}) {
    if (column_ < printed_.size() && !printed_[column_]) kind += kind.empty() ? "screen" : " screen";
    ++column_;
    html_ +=
        fmt::format("<{0}{1}>{2}</{0}>", tag, kind.empty() ? "" : fmt::format(" class=\"{}\"", kind), html);
  }

  std::string html_;
  std::vector<bool> printed_;
  std::size_t column_ = 0;
  bool open_ = false;
};

std::string with_error(const Measured& m) {
  return fmt::format("{:.4g}", m.value) +
         (m.error ? fmt::format("<br><small>± {:.2g}</small>", *m.error) : std::string());
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
  add("scale ±", d.scale);
  add("drive ±", d.drive);
  add("between starts", d.defects);
  return parts.empty() ? "–" : fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

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

  // A page is as wide as about a dozen columns.
  constexpr std::size_t kMaxPrinted = 5;
  std::vector<std::string> heads = {"run", "side", "Γ"};
  std::vector<bool> printed(heads.size(), true);
  std::size_t others = 0;
  for (const Column& column : columns) {
    const bool always = column.name == "phase" || column.name == "s_b" || column.name == "s_c";
    printed.push_back(always || (column.rank == 0 && others++ < kMaxPrinted));
    heads.push_back(column.head);
  }
  Table table("runs", heads, std::move(printed));
  for (std::size_t i = 0; i < c.runs.size(); ++i) {
    table.row(fmt::format(" data-run=\"{}\"", i));
    table.cell(html_text(c.runs[i].name), "nowrap");
    table.cell(side_name(c.runs[i].side));
    table.cell(c.runs[i].gamma);
    for (const Column& column : columns) table.cell(column.cells[i]);
  }
  return "<p class=\"in-print\">Printed: the phases, s<sub>b</sub>, s<sub>c</sub> and the numbers that "
         "really differ; runs.csv has all.</p>\n" +
         table.html();
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

std::string differences_table(const Comparison& c) {
  Table table("differences", {"Γ", "N<sub>l</sub>", "number", "experiment", "simulation", "difference",
                              "what is left", "in errors", "attributed to, made of"});
  for (const Difference& d : c.differences) {
    table.row(fmt::format(" data-run=\"{}\" class=\"{}\"", c.matches[d.match].experiments.front(),
                          d.is_real() ? "real" : "agrees"));
    table.cell(c.matches[d.match].gamma);
    table.cell(c.matches[d.match].n_l);
    table.cell(fmt::format("{}<br><small>{}</small>", typeset(d.quantity), html_text(d.unit)));
    table.cell(with_error(d.experiment), "nowrap");
    table.cell(with_error(d.simulation), "nowrap");
    table.cell(d.difference());
    table.cell(with_error({d.remainder(), d.error()}), "nowrap");
    const auto t = d.in_errors();
    table.cell(t ? fmt::format("{:.1f}", *t) : "–");
    table.cell(d.attribution() + "<br><small>" + composition(d) + "</small>", "words");
  }
  return table.html();
}

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

}  // namespace twincell::analysis
