#pragma once
/// \file
/// What every figure must have, read from its gnuplot commands.

#include <fmt/format.h>

#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

/// The rules that the commands of a figure break, in sentences; empty if none. Every panel with tics has
/// labels and fixed ranges on both axes, unless its x axis leaves its numbers to the panel below; the axes of
/// a logarithmic pair have one format, powers of ten or plain numbers; the key lies outside of the panels;
/// several panels with titles have the letters (a), (b), …; Greek letters
/// are not written out, except in keys such as `drive.gamma`.
inline std::vector<std::string> broken_figure_rules(const std::string& commands) {
  std::vector<std::string> broken;
  std::map<std::string, std::string> label, range, format;
  std::map<std::string, bool> logarithmic;
  std::string title, key = "outside";
  bool tics = true;
  int panels = 0;
  std::vector<std::string> titles;
  const std::regex set_label("set ([xy])label '(.*?)'.*"), set_range(R"(set ([xy])range \[(.*)\])"),
      set_format("set format ([xy]) '(.*)'"), set_title("set title '(.*)'.*"),
      log("(un)?set logscale ([xy]+).*"), number(R"([-+.0-9eE]+:[-+.0-9eE]+)"),
      greek(R"((^|[^.\w])(alpha|beta|gamma|Gamma|delta|mu|phi|psi|sigma|omega)\b)"), quoted("'([^']*)'");
  const std::regex place(R"(\b(outside|inside|above|below|top|bottom|left|right|at)\b)");
  std::istringstream lines(commands);
  for (std::string line; std::getline(lines, line);) {
    while (line.ends_with("\\")) {  // a continued command
      line.pop_back();
      std::string next;
      std::getline(lines, next);
      line += next;
    }
    if (line.starts_with("set output")) continue;  // a file name
    std::smatch m;
    if (std::regex_match(line, m, set_label)) label[m[1]] = m[2];
    if (std::regex_match(line, m, set_range)) range[m[1]] = m[2];
    if (std::regex_match(line, m, set_format)) format[m[1]] = m[2];
    if (std::regex_match(line, m, set_title)) title = m[1];
    if (std::regex_match(line, m, log))
      for (const char c : m[2].str()) logarithmic[std::string(1, c)] = !m[1].matched;
    if (line == "unset title") title.clear();
    if (line == "unset tics") tics = false;
    if (line == "set tics") tics = true;
    if (line == "unset key") key = "none";
    if (line.starts_with("set key") && std::regex_search(line, place)) key = line;
    for (auto q = std::sregex_iterator(line.begin(), line.end(), quoted); q != std::sregex_iterator(); ++q)
      if (std::string text = (*q)[1]; !text.ends_with(".dat") && std::regex_search(text, greek))
        broken.push_back(fmt::format("Greek written out: '{}'", text));
    if (!line.starts_with("plot ")) continue;
    ++panels;
    if (!title.empty()) titles.push_back(title);
    if (key != "none" && key.find("outside") == std::string::npos &&
        key.find("at screen") == std::string::npos)
      broken.push_back(fmt::format("the key may lie on data: {}", key));
    if (!tics) continue;
    for (const char* a : {"x", "y"}) {
      if (*a == 'x' && format.contains("x") && format["x"].empty()) continue;
      if (label[a].empty()) broken.push_back(fmt::format("panel {} has no label on {}", panels, a));
      if (!std::regex_match(range[a], number))
        broken.push_back(fmt::format("panel {} has the range [{}] on {}", panels, range[a], a));
      if (logarithmic[a] && format[a] != "10^{%T}" && format[a] != "%g")
        broken.push_back(fmt::format("panel {} has the format '{}' on {}", panels, format[a], a));
    }
    if (logarithmic["x"] && logarithmic["y"] && !format["x"].empty() && format["x"] != format["y"])
      broken.push_back(
          fmt::format("panel {} has the format '{}' on x and '{}' on y", panels, format["x"], format["y"]));
  }
  for (std::size_t k = 0; titles.size() > 1 && k < titles.size(); ++k)
    if (titles[k].find(fmt::format("({})", static_cast<char>('a' + k))) == std::string::npos)
      broken.push_back(fmt::format("panel {} has the title '{}' without its letter", k + 1, titles[k]));
  return broken;
}
