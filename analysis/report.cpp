#include "analysis/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "analysis/figures.hpp"
#include "analysis/results.hpp"
#include "analysis/trajectory/atomic_file.hpp"
#include "analysis/trajectory/provenance.hpp"

namespace twincell {
namespace {

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// Escaped, with s_b, q6 and the like set as symbols with an index.
std::string typeset(const std::string& text) {
  return std::regex_replace(
      std::regex_replace(escape(text), std::regex("\\b([sTNK])_([a-z])\\b"), "$1<sub>$2</sub>"),
      std::regex("\\bq6\\b"), "q<sub>6</sub>");
}

std::string number(double v, const char* absent = "–") {
  return std::isfinite(v) ? fmt::format("{:.4g}", v) : absent;
}

/// Value and, on a line of its own, its interval; or "absent".
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

/// What the end of the text says: where the sides differ.
std::string conclusion(const std::vector<Run>& runs, const std::vector<Match>& matches) {
  std::vector<std::string> differ;
  std::size_t paired = 0, same = 0;
  for (const Match& match : matches) {
    const std::string word = verdict(runs, match);
    if (!match.experiments.empty() && !match.simulations.empty()) ++paired;
    if (word == "same") ++same;
    if (word == "differ")
      differ.push_back(fmt::format("Gamma {:.3g} ({} in the experiment, {} in the simulation)", match.gamma,
                                   phases_of(runs, match.experiments), phases_of(runs, match.simulations)));
  }
  if (paired == 0) return "No drive strength was run on both sides.";
  std::string text = fmt::format("Same phase on both sides at {} of {} drive strengths.", same, paired);
  if (!differ.empty()) text += fmt::format(" They differ at {}.", fmt::join(differ, "; "));
  if (const std::size_t open = paired - same - differ.size(); open > 0)
    text += fmt::format(" Undetermined at {}.", open);
  return text;
}

nlohmann::json or_null(double v) {
  return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(nullptr);
}

constexpr std::array<const char*, 6> kScalars = {"s_b", "s_c", "T_g", "q6", "psi6", "hexagonal_fraction"};

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// One line per run; an empty field is an absent value.
std::string runs_csv(const std::vector<Run>& runs) {
  std::string text = "side,run,gamma,k_m,n_l,n_beads,n_frames,phase,cycle_of_convection";
  for (const char* name : kScalars) text += fmt::format(",{0},{0}_low,{0}_high", name);
  text += "\n";
  const auto field = [](double v) { return std::isfinite(v) ? fmt::format("{:.9g}", v) : std::string(); };
  for (const Run& run : runs) {
    text += fmt::format("{},{},{:.9g},{:.9g},{:.9g},{},{},{},{}", side_name(run.side), csv_field(run.name),
                        run.gamma, run.k_m, run.n_l, run.n_beads, run.n_frames, phase_name(run.phase),
                        field(find_result(run.results, "cycle_of_convection").value()));
    for (const char* name : kScalars) {
      const Result& r = find_result(run.results, name);
      text += fmt::format(",{}", field(r.value()));
      text += r.interval ? fmt::format(",{:.9g},{:.9g}", r.interval->low, r.interval->high) : ",,";
    }
    text += "\n";
  }
  return text;
}

/// Long form: one line per run and element.
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

const char* kCss = R"(
:root{color-scheme:light}
body{font:16px/1.5 system-ui,"Segoe UI",Helvetica,Arial,sans-serif;color:#1c1c1c;background:#fff;margin:0 auto;max-width:60rem;padding:1rem}
h1{font-size:1.6rem;line-height:1.2;margin:.5rem 0}h2{font-size:1.25rem;margin:2rem 0 .5rem;border-bottom:1px solid #ccc}
p.lead{font-size:1.1rem}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}
th,td{padding:.3rem .6rem;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}th{background:#f3f3f3}
td.nowrap{white-space:nowrap}tr.differ td{background:#fff1e6}
figure{margin:1rem 0 2rem}figure>.picture{overflow-x:auto;max-width:38rem}figure svg{display:block;width:100%;min-width:21rem;height:auto}
figcaption{font-size:.92rem;color:#444;max-width:38rem}
.chip{display:inline-block;padding:0 .5rem;border-radius:.7rem;color:#fff;white-space:nowrap}
.co-moving{background:#0072B2}.bouncing{background:#E69F00;color:#000}.convecting{background:#B64E00}.undetermined{background:#6b6b6b}
pre{overflow-x:auto;background:#f6f6f6;padding:.6rem;font-size:.85rem}summary{cursor:pointer}
@media print{details{display:block}}
)";

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

std::string verdict_table(const std::vector<Run>& runs, const std::vector<Match>& matches) {
  std::string html =
      "<div "
      "class=\"scroll\"><table><thead><tr><th>Γ</th><th>K<sub>m</sub></th><th>N<sub>l</sub>σ</"
      "th><th>experiment</th><th>simulation</th><th></th>"
      "<th>s<sub>b</sub>/σ experiment</th><th>s<sub>b</sub>/σ simulation</th><th>s<sub>c</sub>/σ "
      "experiment</th><th>s<sub>c</sub>/σ simulation</th></tr></thead><tbody>\n";
  for (const Match& match : matches) {
    const Run& any = runs[match.experiments.empty() ? match.simulations.front() : match.experiments.front()];
    const std::string word = verdict(runs, match);
    html += fmt::format(
        "<tr{}><td>{:.3g}</td><td>{:.3g}</td><td>{:.3g}</td><td>{}</td><td>{}</td><td>{}</td><td "
        "class=\"nowrap\">{}</td><td class=\"nowrap\">{}</td>"
        "<td class=\"nowrap\">{}</td><td class=\"nowrap\">{}</td></tr>\n",
        word == "differ" ? " class=\"differ\"" : "", match.gamma, any.k_m, any.n_l,
        chips(runs, match.experiments), chips(runs, match.simulations),
        word == "differ" ? "<strong>differ</strong>" : word, numbers_of(runs, match.experiments, "s_b"),
        numbers_of(runs, match.simulations, "s_b"), numbers_of(runs, match.experiments, "s_c"),
        numbers_of(runs, match.simulations, "s_c"));
  }
  return html + "</tbody></table></div>\n";
}

std::string runs_table(const std::vector<Run>& runs) {
  std::string html =
      "<div "
      "class=\"scroll\"><table><thead><tr><th>run</th><th>side</th><th>Γ</th><th>beads</th><th>frames</"
      "th><th>phase</th><th>T<sub>g</sub>/mgσ</th>"
      "<th>q<sub>6</sub></th><th>ψ<sub>6</sub></th><th>hexagonal</th></tr></thead><tbody>\n";
  for (const Run& run : runs) {
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.4g}</td><td>{}</td><td>{}</td><td>{}</td>",
                        escape(run.name), side_name(run.side), run.gamma, run.n_beads, run.n_frames,
                        phase_name(run.phase));
    for (const char* name : {"T_g", "q6", "psi6", "hexagonal_fraction"})
      html += fmt::format("<td>{}</td>", number(find_result(run.results, name).value(), "absent"));
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

/// How each number was made, once per distinct sentence and with the runs it holds for.
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
    html += fmt::format("<li><strong>{}</strong> ({})", name, escape(source));
    for (const auto& [sentence, of] : sentences)
      html += of.size() == runs.size() ? fmt::format(" {}.", escape(sentence))
                                       : fmt::format("<br>{} <small>[{}]</small>", escape(sentence),
                                                     escape(fmt::format("{}", fmt::join(of, ", "))));
    html += "</li>\n";
  }
  return html + "</ul>\n";
}

/// The drawing alone, its identifiers made its own: several drawings share one page.
std::string inline_svg(const std::string& file, const std::string& prefix, const std::string& title) {
  std::string svg = file.substr(file.find("<svg"));
  svg = std::regex_replace(svg, std::regex("(\\sid\\s*=\\s*[\"'])"), fmt::format("$1{}-", prefix));
  svg = std::regex_replace(svg, std::regex("(href\\s*=\\s*[\"']#)"), fmt::format("$1{}-", prefix));
  svg = std::regex_replace(svg, std::regex("(url[(]['\"]?#)"), fmt::format("$1{}-", prefix));
  return std::regex_replace(svg, std::regex("<svg"),
                            fmt::format("<svg role=\"img\" aria-label=\"{}\"", escape(title)),
                            std::regex_constants::format_first_only);
}

std::string page(const std::vector<Run>& runs, const std::vector<Match>& matches,
                 const std::vector<Figure>& figures, const std::filesystem::path& figure_folder,
                 const std::string& provenance_json) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n"
      "<title>Experiment and simulation</title><style>{}</style></head><body>\n<h1>Experiment and "
      "simulation, side by side</h1>\n<p class=\"lead\">{}</p>\n",
      kCss, escape(conclusion(runs, matches)));
  html +=
      "<p>Both sides went through the same analysis. A bed <em>bounces</em> if s<sub>b</sub> &gt; σ/30 and "
      "<em>convects</em> if also s<sub>c</sub> &gt; σ "
      "(Fortini &amp; Huang 2015, app. B). In brackets: 95 % intervals.</p>\n";
  html += "<h2>Phases</h2>\n" + verdict_table(runs, matches);
  for (const Figure& figure : figures)
    html += fmt::format(
        "<h2>{}</h2>\n<figure><div class=\"picture\">{}</div><figcaption>{} <small>(figures/{}.svg, .png, "
        ".gp, .dat)</small></figcaption></figure>\n",
        typeset(figure.title),
        inline_svg(read_text_file(figure_folder / (figure.name + ".svg")), figure.name, figure.title),
        typeset(figure.caption), figure.name);
  html += "<h2>Runs</h2>\n" + runs_table(runs);
  html += "<h2>How each number was made</h2>\n" + conventions(runs);
  html += "<h2>Provenance</h2>\n<p>" + escape(version_line()) +
          "</p>\n<details><summary>Command, inputs and their digests</summary><pre>" +
          escape(nlohmann::json::parse(provenance_json).dump(2)) + "</pre></details>\n</body></html>\n";
  return html;
}

}  // namespace

std::string comparison_text(const std::vector<Run>& runs, const std::vector<Match>& matches) {
  std::string text = fmt::format("{:>7}  {:>7}  {:>6}  {:<22}  {:<22}  {}\n", "Gamma", "K_m", "N_l",
                                 "experiment", "simulation", "verdict");
  for (const Match& match : matches) {
    const Run& any = runs[match.experiments.empty() ? match.simulations.front() : match.experiments.front()];
    text += fmt::format("{:>7.3f}  {:>7.3f}  {:>6.2f}  {:<22}  {:<22}  {}\n", match.gamma, any.k_m, any.n_l,
                        phases_of(runs, match.experiments), phases_of(runs, match.simulations),
                        verdict(runs, match));
  }
  return text + conclusion(runs, matches) + "\n";
}

std::string comparison_json(const std::vector<Run>& runs, const std::vector<Match>& matches) {
  nlohmann::json document;
  document["conclusion"] = conclusion(runs, matches);
  document["runs"] = nlohmann::json::array();
  for (const Run& run : runs)
    document["runs"].push_back({{"side", side_name(run.side)},
                                {"run", run.name},
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
      list.push_back({{"run", runs[i].name}, {"phase", phase_name(runs[i].phase)}});
    return list;
  };
  for (const Match& match : matches)
    document["matches"].push_back({{"gamma", match.gamma},
                                   {"experiments", names(match.experiments)},
                                   {"simulations", names(match.simulations)},
                                   {"verdict", verdict(runs, match)}});
  return document.dump();
}

void write_report(const std::filesystem::path& folder, const std::vector<Run>& runs,
                  const std::vector<Match>& matches, const std::string& provenance_json, Progress& progress) {
  AtomicPath output(folder, AtomicPath::Kind::folder);
  const std::filesystem::path figure_folder = output.part() / "figures";
  std::filesystem::create_directories(figure_folder);

  std::vector<Figure> figures = {phase_strip_figure(runs), phase_diagram_figure(runs),
                                 thresholds_figure(runs), s_k_figure(runs), s_j_figure(runs)};
  for (std::size_t m = 0; m < matches.size(); ++m)
    figures.push_back(snapshots_figure(runs, matches[m], fmt::format("snapshots_{}", m + 1)));
  for (std::size_t i = 0; i < figures.size(); ++i) {
    draw(figures[i], figure_folder);
    progress.update(static_cast<std::int64_t>(i) + 1, static_cast<std::int64_t>(figures.size()));
  }
  write_text_file(output.part() / "runs.csv", runs_csv(runs));
  write_text_file(output.part() / "series_s_k.csv", series_csv(runs, "s_k", "k"));
  write_text_file(output.part() / "series_s_j.csv", series_csv(runs, "s_j", "j"));
  write_text_file(output.part() / "phases.txt", comparison_text(runs, matches));
  write_text_file(output.part() / "results.json", comparison_json(runs, matches) + "\n");
  write_text_file(output.part() / "provenance.json", provenance_json + "\n");
  write_text_file(output.part() / "report.html",
                  page(runs, matches, figures, figure_folder, provenance_json));
  output.commit();
}

}  // namespace twincell
