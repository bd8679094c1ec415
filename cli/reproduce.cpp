// twincell reproduce NAME --budget 10: a figure or table of the papers, compared with its targets.
// twincell reproduce --all --budget 2: all of them, and the page about them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "cli/device_option.hpp"
#include "cli/output.hpp"
#include "cli/sweep_watch.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/cpu_clock.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/output_rules.hpp"
#include "reproduce/papers_page.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::cli {

namespace {

namespace fs = std::filesystem;
using reproduce::Reproducible;
using reproduce::Reproduction;
using reproduce::Target;

struct ReproduceOptions {
  std::string name, output, runs, data, stored, device;
  std::optional<std::pair<double, double>> window;
  std::optional<double> budget;  ///< minutes; hours with --all
  bool full = false, all = false;
};

constexpr double kDefaultMinutes = 10, kDefaultHours = 2, kMinutesPerHour = 60;

const Reproducible& named(const std::string& name) {
  const auto& all = reproduce::list();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Reproducible& r) { return r.name == name; });
  if (found != all.end()) return *found;
  std::vector<std::string> names;
  for (const Reproducible& r : all) names.push_back(r.name);
  throw ConfigError({.file = {}, .key = "reproduce"},
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
    s += fmt::format("  {:<12} {}: {}{}\n               target {}", word_of(t.verdict), t.name,
                     t.measured.empty() ? "not measured" : t.measured,
                     t.runs.empty() ? "" : fmt::format(" ({})", t.runs), t.expected);
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
  nlohmann::json j = {{"title", r.title},
                      {"complete", r.complete},
                      {"measured", nlohmann::json::parse(r.measured)},
                      {"conditions", r.conditions},
                      {"cheaper", r.cheaper},
                      {"output", folder.string()},
                      {"runs", r.runs}};
  for (const Target& t : r.targets) {
    j["targets"].push_back({{"name", t.name},
                            {"expected", t.expected},
                            {"measured", t.measured},
                            {"runs", t.runs},
                            {"verdict", word_of(t.verdict)},
                            {"reason", t.reason}});
    if (!t.not_counted.empty()) j["targets"].back()["not_counted"] = t.not_counted;
  }
  for (const analysis::Figure& figure : r.figures)
    j["figures"].push_back({{"name", figure.name}, {"caption", figure.caption}});
  return j;
}

/// The JSON document of an earlier call. \throws InputError if the file is not one
nlohmann::json stored_document(const fs::path& file) {
  const nlohmann::json document = nlohmann::json::parse(read_text_file(file), nullptr, false);
  if (document.is_discarded() || !document.contains("measured") || !document.contains("targets"))
    throw InputError({file.string(), 0, 0, ""},
                     "is not a result of `reproduce`, which has the members measured and targets.");
  return document;
}

/// What one figure of this call gets.
struct Share {
  double minutes = kDefaultMinutes;  ///< determines the extent of the study
  double seconds = 1e300;            ///< time limit
};

/// Runs a figure, or judges its stored runs again, and writes its files into `folder`. \returns its document
/// and text
std::pair<nlohmann::json, std::string> make(const Reproducible& what, const ReproduceOptions& options,
                                            const Workers& on_device, const Share& share,
                                            const fs::path& folder, const fs::path& from,
                                            const Common& common) {
  std::optional<nlohmann::json> stored;
  if (!from.empty()) {
    if (!what.judges_stored)
      throw ConfigError(
          {.file = {}, .key = "--stored"},
          fmt::format("does not work for {}, whose runs take seconds: run it again.", what.name));
    stored = stored_document(from);
  }
  const Workers workers = what.on_device ? on_device : workers_of("", common);
  claim_shared_folder(folder, Product::runs());
  const double begin = process_cpu_seconds();
  SweepWatch watch(common, share.seconds);
  Reproduction r;
  try {
    r = what.run({.minutes = share.minutes,
                  .full = options.full,
                  .threads = workers.count,
                  .seed = common.seed.value_or(1),
                  .folder = folder,
                  .runs = runs_of(what, options, folder),
                  .window = options.window,
                  .data = options.data,
                  .stored = stored ? (*stored)["measured"].dump() : "",
                  .watch = &watch,
                  .solver = workers.solver});
  } catch (const nlohmann::json::exception&) {
    if (!stored) throw;
    throw InputError({from.string(), 0, 0, ""}, fmt::format("does not hold the runs of {}.", what.name));
  }
  double core_minutes = watch.runs_seconds().value_or(process_cpu_seconds() - begin) / 60;
  if (stored) {
    // What was run is what the document says; its verdicts and figures alone are new.
    const auto keep = [&](const char* key, auto& member) {
      try {
        if (stored->contains(key)) member = stored->at(key).get<std::decay_t<decltype(member)>>();
      } catch (const nlohmann::json::exception&) {
        throw InputError({from.string(), 0, 0, key}, "is of another type than `reproduce` writes.");
      }
    };
    keep("conditions", r.conditions);
    keep("cheaper", r.cheaper);
    keep("complete", r.complete);
    keep("runs", r.runs);
    core_minutes = std::numeric_limits<double>::quiet_NaN();
    keep("core_minutes", core_minutes);
  }
  for (Target& t : r.targets)
    if (t.runs.empty() && t.verdict != reproduce::Verdict::absent) t.runs = r.runs;
  nlohmann::json document = as_json(r, folder);
  if (std::isfinite(core_minutes)) document["core_minutes"] = core_minutes;
  document["provenance"] = nlohmann::json::parse(common.provenance().to_json());
  const std::string text = as_text(r, folder);
  {
    AtomicPath files(folder, Product::runs());
    write_text_file(files.part() / (what.name + ".json"), json_text(document, 1) + "\n");
    write_text_file(files.part() / (what.name + ".txt"), text);
    files.commit();
  }
  if (!r.figures.empty()) {
    AtomicPath files(folder, Product::runs());
    for (const analysis::Figure& figure : r.figures)
      analysis::draw(figure,
                     files.part());  // last, so that the results are stored even if gnuplot is missing
    files.commit();
  }
  return {document, text};
}

void run_one(const ReproduceOptions& options, const Common& common) {
  const Reproducible& what = named(options.name);
  const fs::path folder = options.output.empty() ? options.name : options.output;
  if ((options.window || !options.data.empty()) && !what.takes_data)
    throw ConfigError(
        {.file = {}, .key = options.window ? "--window" : "--data"},
        fmt::format(
            "has no effect on {}; only p1-fig3, p2-fig2, p2-table1 and p2-table2 compare with your own data.",
            options.name));
  if (options.window && !(options.window->first < options.window->second))
    throw ConfigError({.file = {}, .key = "--window"},
                      fmt::format("is {:g} to {:g}; the lower limit must be below the upper limit.",
                                  options.window->first, options.window->second));
  if (!options.device.empty() && !what.on_device) {
    std::vector<std::string> names;
    for (const Reproducible& r : reproduce::list())
      if (r.on_device) names.push_back(r.name);
    throw ConfigError({.file = {}, .key = "--device"},
                      fmt::format("has no effect on {}; the beds of {} can run on one.", options.name,
                                  fmt::join(names, ", ")));
  }
  const double minutes = options.budget.value_or(kDefaultMinutes);
  const auto [document, text] =
      make(what, options, workers_of(options.device, common), {minutes, options.full ? 1e300 : 60 * minutes},
           folder, options.stored, common);
  print_result(common, document, text);
}

/// Share of every figure: its time share of the budget for those with runs of their own. A figure that uses
/// the runs of another gets the same extent, and a little time in case that one did not finish.
std::map<std::string, Share> shares_of(double minutes, bool full) {
  constexpr double kWithoutRuns = 3;  // seconds
  double all = 0;
  for (const Reproducible& r : reproduce::list())
    if (r.runs_like.empty() && r.same_as.empty()) all += r.time_share;
  std::map<std::string, Share> shares;
  for (const Reproducible& r : reproduce::list()) {
    const double own = minutes * (r.runs_like.empty() ? r : named(r.runs_like)).time_share / all;
    shares[r.name] = {own, full ? 1e300 : r.runs_like.empty() ? 60 * own : kWithoutRuns};
  }
  return shares;
}

void run_all(const ReproduceOptions& options, const Common& common) {
  const fs::path folder = options.output.empty() ? "papers" : options.output;
  if (options.window || !options.data.empty())
    throw ConfigError({.file = {}, .key = options.window ? "--window" : "--data"},
                      "has no effect with --all.");
  if (!options.stored.empty() && !fs::is_directory(options.stored))
    throw ConfigError(
        {.file = {}, .key = "--stored"},
        fmt::format("is {}; with --all it must be a folder of NAME.json files.", options.stored));
  const Workers on_device = workers_of(options.device, common);  // before the folder is made
  claim_shared_folder(folder, Product::runs());
  const double hours = options.budget.value_or(kDefaultHours);
  std::string command = "twincell reproduce --all";
  command += !options.stored.empty() ? " --stored " + options.stored
             : options.full          ? " --full"
                                     : fmt::format(" --budget {:g}", hours);
  const auto shares = shares_of(kMinutesPerHour * hours, options.full);
  std::vector<reproduce::Document> documents;
  const auto write_page = [&] {
    AtomicPath files(folder, Product::runs());
    write_text_file(files.part() / "papers.md", reproduce::papers_page(documents, command));
    files.commit();
  };
  nlohmann::json summary = {{"output", folder.string()}};
  for (const Reproducible& what : reproduce::list()) {
    if (!what.same_as.empty()) continue;
    fs::path from;
    if (!options.stored.empty()) {
      for (const fs::path& file : {fs::path(options.stored) / (what.name + ".json"),
                                   fs::path(options.stored) / what.name / (what.name + ".json")})
        if (from.empty() && fs::exists(file)) from = file;
      if (from.empty()) continue;
    }
    nlohmann::json document;
    if (!from.empty() && !what.judges_stored)
      document = stored_document(from);
    else
      document = make(what, options, on_device, shares.at(what.name), folder / what.name, from, common).first;
    nlohmann::json& counts = summary["figures"][what.name];
    for (const auto& verdict : reproduce::kVerdicts) counts[std::string(verdict.word)] = 0;
    try {
      for (const auto& t : document.at("targets")) {
        if (!t.value("not_counted", "").empty()) continue;
        nlohmann::json& n = counts[t.at("verdict").get<std::string>()];
        n = n.is_null() ? 1 : n.get<int>() + 1;
      }
      documents.push_back({what.name, json_text(document), what.judges_again});
      write_page();  // after every figure, so that an interrupted call leaves a page
    } catch (const nlohmann::json::exception&) {
      if (from.empty()) throw;
      throw InputError({from.string(), 0, 0, "targets"}, "is not as `reproduce` writes it.");
    }
  }
  std::string text;
  for (const auto& [name, counts] : summary["figures"].items()) {
    text += fmt::format("  {:<12}", name);
    for (const auto& verdict : reproduce::kVerdicts)
      text += fmt::format(" {} {:<3}", verdict.word, counts[std::string(verdict.word)].get<int>());
    text += "\n";
  }
  print_result(common, summary, text + (folder / "papers.md").string() + "\n");
}

void run(const ReproduceOptions& options, const Common& common) {
  if (options.all == !options.name.empty())
    throw ConfigError(
        {.file = {}, .key = "reproduce"},
        options.all ? "takes a name or --all, not both." : "needs the name of a figure or table, or --all.");
  options.all ? run_all(options, common) : run_one(options, common);
}

}  // namespace

void add_reproduce(CLI::App& program, Common& common) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App& verb =
      add_verb(program, common, "reproduce",
               "Reproduce a figure or table of the papers: run its simulations and compare the results with "
               "their targets. Writes runs, figure, NAME.json and NAME.txt into a folder.",
               "twincell reproduce p1-fig3 --budget 10");
  takes_seed(verb, common);
  std::string list = "Figure or table to reproduce, one of:";
  for (const Reproducible& r : reproduce::list()) list += fmt::format("\n{}: {}", r.name, r.what);
  verb.add_option("name", options->name, list)->type_name(kWord);
  writes(common, verb,
         verb.add_option("-o,--output", options->output,
                         "Folder for runs, figures and results; default: NAME, with --all papers"),
         Product::runs());
  const auto budget =
      verb.add_option("--budget", options->budget,
                      fmt::format("Time limit, min; with --all h; a smaller budget computes fewer runs; "
                                  "default: {:g} min, with --all {:g} h",
                                  kDefaultMinutes, kDefaultHours))
          ->check(CLI::Range(0.001, 1e6));
  verb.add_flag("--all", options->all,
                "Reproduce all figures and tables within the budget, which is divided among them by fixed "
                "weights, and write papers.md, the page about them; the same command continues");
  verb.add_option("--stored", options->stored,
                  "NAME.json of an earlier call (with --all: a folder of them): nothing is simulated; only "
                  "targets, verdicts and figures are made again from its runs");
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
  add_device_option(verb, options->device);
  verb.add_flag("--full", options->full, "Run everything that the paper shows, without a time limit")
      ->excludes(budget);
  verb.callback([options, &common] { run(*options, common); });
}

}  // namespace twincell::cli
