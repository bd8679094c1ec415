#include "reproduce/papers_page.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "reproduce/verdict.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

/// A text as a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string s;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '<' || c == '[' || c == ']') s += '\\';
    s += c == '\n' ? ' ' : c;
  }
  return s;
}

/// Processor time in core-minutes; "–" if it was not recorded.
std::string cost_of(const json& document) {
  if (!document.contains("core_minutes")) return "–";
  return fmt::format("{:.2g}", document["core_minutes"].get<double>());
}

struct Paper {
  const char *prefix, *title;
};
constexpr std::array<Paper, 2> kPapers = {
    {{"p1-", "Fortini & Huang 2015"}, {"p2-", "Bhateja, Sharma & Singh 2016"}}};

/// Number of targets with each verdict.
std::map<std::string, int> counts_of(const json& document) {
  std::map<std::string, int> counts;
  for (const json& t : document.at("targets"))
    if (t.value("not_counted", "").empty()) ++counts[t.at("verdict").get<std::string>()];
  return counts;
}

std::string row_of_counts(const std::string& name, std::map<std::string, int> counts,
                          const std::string& cost) {
  std::string s = fmt::format("| {} |", name);
  for (const auto& verdict : kVerdicts) s += fmt::format(" {} |", counts[std::string(verdict.word)]);
  return s + fmt::format(" {} |\n", cost);
}

/// The figures of an entry with their captions, then the conditions and simplifications.
std::string below_the_table(const std::string& entry, const json& document) {
  std::string s;
  for (const json& f : document.value("figures", json::array())) {
    const std::string name = f.at("name").get<std::string>();
    s += fmt::format("\n![{0}]({1}/{0}.svg)\n\n*{0}*: {2}\n", name, entry, cell(f.value("caption", "")));
  }
  for (const auto& [key, title] : {std::pair{"conditions", "Conditions"}, {"cheaper", "Simplifications"}}) {
    std::string all;
    for (const json& one : document.value(key, json::array()))
      all += fmt::format("{}{}", all.empty() ? "" : "; ", cell(one.get<std::string>()));
    if (!all.empty()) s += fmt::format("\n{}: {}.\n", title, all);
  }
  return s;
}

}  // namespace

std::string papers_page(const std::vector<Document>& documents, const std::string& command) {
  std::vector<json> parsed;
  for (const Document& d : documents) parsed.push_back(json::parse(d.text));
  std::string s =
      "# The papers, figure by figure\n\n"
      "`" +
      command +
      "` wrote this page. It compares every number and statement of the two papers with the "
      "result of this\nprogram. [Reproducing the papers](reproduce.md) explains the commands and the "
      "findings.\n\n"
      "One rule gives every verdict. It compares the 95 % interval of the measured value with the target:\n\n"
      "| verdict | meaning |\n|---|---|\n";
  for (const auto& verdict : kVerdicts) s += fmt::format("| {} | {} |\n", verdict.word, verdict.help);
  s +=
      "\nStatements about an order use the interval of the difference. A statement about a count or about "
      "bits has no interval.\nThe sum counts each statement of the papers about a result once. It leaves "
      "out entries that check the program (tables of\nparameters, closed forms), entries that judge the "
      "targets of other figures under other assumptions, and single targets whose\nverdict says why.\n"
      "The cost is the processor time of the runs that a figure uses. Figures that share runs each state the "
      "whole cost. \"–\" means that\nit was not recorded: the runs are of a version that did not store their "
      "time. As runs end early, their number and their\nlargest length do not give it.\n\n## Summary\n\n| |";
  for (const auto& verdict : kVerdicts) s += fmt::format(" {} |", verdict.word);
  s += " core-minutes |\n|---|";
  for (std::size_t k = 0; k <= kVerdicts.size(); ++k) s += "---|";
  s += "\n";
  std::map<std::string, int> sum;
  for (std::size_t k = 0; k < parsed.size(); ++k) {
    const auto counts = counts_of(parsed[k]);
    const bool counts_here = !documents[k].judges_again;
    for (const auto& [word, n] : counts) sum[word] += counts_here ? n : 0;
    s += row_of_counts(fmt::format("`{}`{}", documents[k].name, counts_here ? "" : ", not in the sum"),
                       counts, cost_of(parsed[k]));
  }
  s += row_of_counts("all", sum, "");
  for (const Paper& paper : kPapers) {
    s += fmt::format("\n## {}\n", paper.title);
    for (std::size_t k = 0; k < parsed.size(); ++k) {
      const json& document = parsed[k];
      if (!documents[k].name.starts_with(paper.prefix)) continue;
      s += fmt::format("\n### {}\n\n{}.{}\n\n", documents[k].name,
                       cell(document.at("title").get<std::string>()),
                       document.value("complete", true) ? "" : " Not all runs fitted into the time limit.");
      s += "| statement | target | measured, 95 % interval | runs | verdict | what decides it |\n"
           "|---|---|---|---|---|---|\n";
      for (const json& t : document.at("targets")) {
        const auto text = [&](const char* key) { return cell(t.value(key, "")); };
        const std::string not_counted = t.value("not_counted", "");
        s += fmt::format("| {} | {} | {} | {} | {}{} | {} |\n", text("name"), text("expected"),
                         text("measured").empty() ? "–" : text("measured"), text("runs"), text("verdict"),
                         not_counted.empty() ? "" : "; not in the sum: " + not_counted, text("reason"));
      }
      s += below_the_table(documents[k].name, document);
    }
  }
  return s;
}

}  // namespace twincell::reproduce
