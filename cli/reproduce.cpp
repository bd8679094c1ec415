// twincell reproduce NAME --budget 10: a figure or table of the papers, compared with its targets.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "cli/output.hpp"
#include "cli/sweep_watch.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/output_rules.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::cli {

namespace {

namespace fs = std::filesystem;
using reproduce::Reproducible;
using reproduce::Reproduction;
using reproduce::Target;

struct ReproduceOptions {
  std::string name, output, runs, data;
  std::optional<std::pair<double, double>> window;
  double budget = 10;
  bool full = false;
};

const Reproducible& named(const std::string& name) {
  const auto& all = reproduce::list();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Reproducible& r) { return r.name == name; });
  if (found != all.end()) return *found;
  std::vector<std::string> names;
  for (const Reproducible& r : all) names.push_back(r.name);
  throw ConfigError({"", 0, 0, "reproduce"},
                    fmt::format("'{}' is not one of {}.", name, fmt::join(names, ", ")));
}

/// Folder of the runs that several figures share: next to the folder of the figure, unless --runs names
/// another one.
fs::path runs_of(const Reproducible& what, const ReproduceOptions& options, const fs::path& folder) {
  if (!options.runs.empty()) return options.runs;
  return what.shared_runs.empty() ? folder
                                  : fs::absolute(folder).lexically_normal().parent_path() / what.shared_runs;
}

std::string as_text(const Reproduction& r, const fs::path& folder) {
  std::string s = r.title + "\n\n";
  for (const Target& t : r.targets) {
    s += fmt::format("  {:<12} {}: {}\n               target {}", word_of(t.verdict), t.name,
                     t.measured.empty() ? "not measured" : t.measured, t.expected);
    s += (t.reason.empty() ? "" : " (" + t.reason + ")") + "\n";
  }
  s += "\nMeasured\n" + r.table;
  const auto list = [&s](const char* head, const std::vector<std::string>& sentences) {
    if (!sentences.empty()) s += fmt::format("\n{}\n", head);
    for (const std::string& one : sentences) s += "  - " + one + "\n";
  };
  list("Conditions", r.conditions);
  list("Simplifications compared with the paper", r.cheaper);
  if (!r.complete)
    s += "\nThe time limit is reached; the same command, with the same or a larger budget, continues from "
         "here.\n";
  return s + folder.string() + "\n";
}

nlohmann::json as_json(const Reproduction& r, const fs::path& folder) {
  nlohmann::json j = {
      {"title", r.title},           {"complete", r.complete}, {"measured", nlohmann::json::parse(r.measured)},
      {"conditions", r.conditions}, {"cheaper", r.cheaper},   {"output", folder.string()}};
  for (const Target& t : r.targets)
    j["targets"].push_back({{"name", t.name},
                            {"expected", t.expected},
                            {"measured", t.measured},
                            {"verdict", word_of(t.verdict)},
                            {"reason", t.reason}});
  return j;
}

void run(const ReproduceOptions& options, const Common& common) {
  const Reproducible& what = named(options.name);
  const fs::path folder = options.output.empty() ? options.name : options.output;
  if ((options.window || !options.data.empty()) && !what.takes_data)
    throw ConfigError(
        {"", 0, 0, options.window ? "window" : "data"},
        fmt::format(
            "has no effect on {}; only p1-fig3, p2-fig2, p2-table1 and p2-table2 compare with your own data.",
            options.name));
  if (options.window && !(options.window->first < options.window->second))
    throw ConfigError({"", 0, 0, "window"},
                      fmt::format("is {:g} to {:g}; the lower limit must be below the upper limit.",
                                  options.window->first, options.window->second));
  claim_shared_folder(folder, Product::runs());
  SweepWatch watch(common, options.full ? 1e300 : 60 * options.budget);
  const Reproduction r = what.run({.minutes = options.budget,
                                   .full = options.full,
                                   .threads = common.n_threads(),
                                   .seed = common.seed.value_or(1),
                                   .folder = folder,
                                   .runs = runs_of(what, options, folder),
                                   .window = options.window,
                                   .data = options.data,
                                   .watch = &watch});
  nlohmann::json document = as_json(r, folder);
  document["provenance"] = nlohmann::json::parse(common.provenance().to_json());
  {
    AtomicPath files(folder, Product::runs());
    write_text_file(files.part() / (options.name + ".json"), json_text(document, 1) + "\n");
    write_text_file(files.part() / (options.name + ".txt"), as_text(r, folder));
    files.commit();
  }
  if (!r.figures.empty()) {
    AtomicPath files(folder, Product::runs());
    for (const Figure& figure : r.figures)
      draw(figure, files.part());  // last, so that the results are stored even if gnuplot is missing
    files.commit();
  }
  print_result(common, document, as_text(r, folder));
}

}  // namespace

void add_reproduce(CLI::App& program, Common& common) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App& verb =
      add_verb(program, common, "reproduce",
               "Reproduce a figure or table of the papers: run its simulations and compare the results with "
               "their targets. Writes runs, figure, NAME.json and NAME.txt into a folder.",
               "twincell reproduce p1-fig3 --budget 10");
  std::string list = "Figure or table to reproduce, one of:";
  for (const Reproducible& r : reproduce::list()) list += fmt::format("\n{}: {}", r.name, r.what);
  verb.add_option("name", options->name, list)->required()->type_name(kWord);
  writes(
      common, verb,
      verb.add_option("-o,--output", options->output, "Folder for runs, figures and results; default: NAME"),
      Product::runs());
  const auto budget =
      verb.add_option("--budget", options->budget, "Time limit, min; a smaller budget computes fewer runs")
          ->check(CLI::Range(0.01, 1e6))
          ->capture_default_str();
  verb.add_option("--runs", options->runs,
                  "Folder of the runs that several figures share; default: next to the folder of the figure");
  verb.add_option(
          "--window", options->window,
          "For p2-fig2, p2-table1 and p2-table2: your own window of W in which the exponents are fitted")
      ->delimiter(',')
      ->type_name("LOW,HIGH");
  verb.add_option("--data", options->data,
                  "Your own points (CSV), with the columns N_l, bouncing, convection (onsets in Gamma) for "
                  "p1-fig3, or W and T_bar_z (p2-table2: delta_h_bar) for p2-fig2, p2-table1 and p2-table2");
  verb.add_flag("--full", options->full, "Run everything that the paper shows, without a time limit")
      ->excludes(budget);
  verb.callback([options, &common] { run(*options, common); });
}

}  // namespace twincell::cli
