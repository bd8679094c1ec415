// twincell new STACK...: measures what a stack shows of its cell and writes CELL.toml with a picture of it.

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/number_checks.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/output_rules.hpp"
#include "core/plural.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/overlay.hpp"
#include "twin/cell_draft.hpp"
#include "twin/cell_names.hpp"
#include "twin/cell_picture.hpp"
#include "twin/stated_strengths.hpp"

namespace twincell::cli {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::vector<std::string> stacks;
  std::optional<std::string> output;
  double diameter_px = 0;
  twin::CellAnswers answers;
  std::vector<double> gammas;  ///< stated, in the order of the stacks
};

constexpr const char* kHead = "# Cell description, written by: ";

/// A cell file is edited by hand, so an existing one is replaced only with --force.
Product cell_file() {
  return {.name = "a cell file", .sign = Product::Sign::none, .mark = {}};
}

/// \throws ConfigError if the output is an earlier cell file, which --force does not yet give up
void keep_earlier(const fs::path& cell, const Common& common) {
  if (!common.force && is_product(cell, Product::text("a cell file", kHead)))
    throw ConfigError(
        {.file = cell.string(), .key = {}},
        "is an earlier cell file, which may have been edited since; replace it with --force, or "
        "name another one with -o.");
}

/// Asks one question on the terminal. An empty line, or the end of the input, leaves the value unknown. The
/// answer may have a decimal comma.
std::optional<double> ask(const std::string& question, const std::string& otherwise) {
  for (;;) {
    std::cerr << question << " [" << otherwise << "]: " << std::flush;
    std::string line;
    if (!std::getline(std::cin, line)) return std::nullopt;
    const std::size_t from = line.find_first_not_of(" \t\r"), to = line.find_last_not_of(" \t\r");
    if (from == std::string::npos) return std::nullopt;
    if (const std::size_t comma = line.find(',');
        comma != std::string::npos && line.find('.') == std::string::npos)
      line[comma] = '.';
    double value = 0;
    const char *begin = line.data() + from, *end = line.data() + to + 1;
    if (const auto [last, error] = std::from_chars(begin, end, value);
        error == std::errc() && last == end && std::isfinite(value) && value > 0)
      return value;
    std::cerr << "A number above 0 is needed, or an empty line.\n";
  }
}

/// Asks for what no stack shows, unless options have answered it.
/// \param several whether the answers also hold for other stacks, which differ in Gamma
void ask_for_the_rest(twin::CellAnswers& a, const twin::CellSurvey& s, bool several) {
  if (!a.sigma_mm) a.sigma_mm = ask("Diameter of a bead in mm", "unknown");
  if (a.sigma_mm && !a.width_mm && !s.has_walls())
    a.width_mm = ask("Distance of the side walls in mm", "unknown");
  const bool rate = s.drive && (a.frame_rate_hz || s.frame_rate_hz);
  if (a.sigma_mm && !a.frequency_hz && !a.gamma && !rate)
    a.frequency_hz = ask("Frequency of the shaker in Hz", "unknown");
  if (!several && !a.gamma && (!s.drive || !a.sigma_mm || (!a.frequency_hz && !rate)))
    a.gamma = ask("Peak acceleration of the plate over g (Gamma)", "unknown");
}

/// \param details also how each value was found, or can be found
std::string table_of(const twin::CellDraft& draft, bool details) {
  std::string text;
  for (const twin::DraftKey& k : draft.keys) {
    const std::size_t colon = k.comment.find(':');
    const std::string error = k.measured.empty() ? "" : k.comment.substr(0, colon);
    text += fmt::format("  {:<26} {:<24} {}\n", k.key, k.open ? "still needed" : k.value,
                        details ? k.comment : error);
  }
  if (draft.gamma && draft.gamma->error > 0)
    text += fmt::format("  {:<26} {:<24} +- {}\n", "Gamma = A omega^2/g", twin::value_text(*draft.gamma),
                        twin::error_text(draft.gamma->error));
  return text;
}

nlohmann::json json_of(const twin::CellSurvey& s, const twin::CellDraft& draft) {
  nlohmann::json d = {
      {"stack", s.stack.string()}, {"frames", s.n_frames}, {"measured", nlohmann::json::object()}};
  d["open"] = nlohmann::json::array();
  d["not_measured"] = nlohmann::json::array();
  for (const twin::DraftKey& k : draft.keys) {
    if (k.open) d["open"].push_back(k.key);
    for (const calibration::Estimate& e : k.measured)
      d["measured"][k.key].push_back(
          {{"value", e.value},
           {"standard_error", std::isfinite(e.error) ? nlohmann::json(e.error) : nlohmann::json()}});
  }
  for (const twin::NotMeasured& m : s.missing)
    d["not_measured"].push_back({{"what", m.what}, {"why", m.why}, {"remedy", m.remedy}});
  if (!s.unreadable.empty()) d["unreadable"] = s.unreadable;
  if (s.aspect) d["aspect"] = {{"value", s.aspect->ratio}, {"standard_error", s.aspect->error}};
  if (s.drive && s.drive->frames_per_cycle > 0) {
    d["frames_per_cycle"] = s.drive->frames_per_cycle;
    d["first_phase"] = s.drive->first_phase;
  }
  return d;
}

/// Surveys one stack and writes its cell file and picture.
nlohmann::json write_one(const Common& common, NewOptions& o, std::size_t index, const fs::path& cell,
                         std::string& said) {
  const fs::path stack = o.stacks[index];
  const bool first = index == 0, several = o.stacks.size() > 1;
  if (!o.gammas.empty()) o.answers.gamma = o.gammas[index];
  const fs::path picture = fs::path(cell).replace_extension(".png");
  keep_earlier(cell, common);
  require_output(cell, cell_file());
  require_output(picture, Product::picture());
  const twin::CellSurvey survey = twin::survey_cell(
      stack, {.diameter_px = o.diameter_px, .gamma = o.answers.gamma, .threads = common.n_threads()},
      progress_bars(common));
  if (first && ::isatty(STDIN_FILENO) != 0 && ::isatty(STDERR_FILENO) != 0 && !common.quiet && !common.json)
    ask_for_the_rest(o.answers, survey, several);
  const twin::CellDraft draft = twin::draft_cell(survey, o.answers);
  for (const auto* sentences : {&survey.notes, &draft.notes})
    for (const std::string& sentence : *sentences) note(common, stack.string() + ": " + sentence);
  // The larger file first: on a full disk neither is left.
  imaging::write_png(picture, twin::draw_cell(survey, draft));
  write_text_file(cell, twin::cell_text(draft, survey, kHead + one_line(common.command_line)), cell_file());
  said += stack.string() + "\n" + table_of(draft, common.verbose);
  for (const twin::NotMeasured& m : survey.missing)
    said += fmt::format("  not measured: {}, because {}; {}\n", m.what, m.why, m.remedy);
  said += fmt::format("{}\npicture: {}\n", cell.string(), picture.string());
  nlohmann::json document = json_of(survey, draft);
  document["cell"] = cell.string();
  document["picture"] = picture.string();
  return document;
}

/// The stacks as words of a shell, or "STACKS..." for many.
std::string stacks_in_words(const std::vector<std::string>& stacks) {
  constexpr std::size_t kMostNamed = 6;
  if (stacks.size() > kMostNamed) return "STACKS...";
  std::string words;
  for (const std::string& stack : stacks) words += (words.empty() ? "" : " ") + shell_word(stack);
  return words;
}

/// The option that chooses the readable frames of a single stack: a later verb stops at the first unreadable
/// one. Empty if all are readable, or for several stacks.
std::string readable_part(const nlohmann::json& cells) {
  if (cells.size() != 1 || !cells[0].contains("unreadable")) return {};
  return fmt::format(" --frames 0:{}", cells[0]["frames"].get<std::size_t>());
}

/// Notes stacks that differ in what is usually the same for all: the camera, the beads and the cell.
void note_different_cells(const Common& common, const nlohmann::json& cells) {
  struct Same {
    const char *key, *what, *unit, *remedy;
  };
  constexpr double kSame = 0.01;
  for (const Same& same : {Same{"camera.pixels_per_sigma", "scales", "px per bead",
                                "if camera and beads are the same, look at the circles in the pictures and "
                                "state the bead diameter "
                                "with --diameter"},
                           Same{"cell.width_sigma", "distances of the side walls", "sigma",
                                "if the cell is the same, look at the walls in the pictures"}}) {
    const auto value = [&](const nlohmann::json& cell) {
      const nlohmann::json& measured = cell["measured"];
      return measured.contains(same.key) ? measured[same.key][0]["value"].get<double>() : 0.0;
    };
    const nlohmann::json *least = nullptr, *most = nullptr;
    for (const nlohmann::json& cell : cells) {
      if (value(cell) <= 0) continue;
      if (least == nullptr || value(cell) < value(*least)) least = &cell;
      if (most == nullptr || value(cell) > value(*most)) most = &cell;
    }
    if (least == nullptr || value(*most) <= (1 + kSame) * value(*least)) continue;
    note(common, fmt::format("the {} differ: {:.2f} {} in {}, {:.2f} in {}; {}.", same.what, value(*least),
                             same.unit, (*least)["stack"].get<std::string>(), value(*most),
                             (*most)["stack"].get<std::string>(), same.remedy));
  }
}

/// Notes strengths that do not belong to the amplitudes of their stacks, as in a wrong order.
void note_strengths(const Common& common, const nlohmann::json& cells, const std::vector<double>& gammas) {
  std::vector<twin::StackDrive> drives;
  for (std::size_t i = 0; i < gammas.size(); ++i) {
    const nlohmann::json& measured = cells[i]["measured"];
    if (measured.contains("drive.amplitude_sigma"))
      drives.push_back({.name = cells[i]["stack"].get<std::string>(),
                        .gamma = gammas[i],
                        .amplitude = measured["drive.amplitude_sigma"][0]["value"].get<double>(),
                        .frames_per_cycle = cells[i].value("frames_per_cycle", 0)});
  }
  if (const std::string doubt = twin::strengths_doubt(drives); !doubt.empty())
    note(common, "--drive-gamma: " + doubt);
}

void run(const Common& common, NewOptions& o) {
  if (o.stacks.empty())
    throw ConfigError({.file = {}, .key = "new"}, "no stack is named; give at least one stack of frames.");
  const bool several = o.stacks.size() > 1;
  const std::string output = o.output.value_or(several ? "cells" : "CELL.toml");
  if (output.empty() || output == kStandardOutput) require_output(output, cell_file());  // refuses them
  if (several && fs::path(output).extension() == ".toml")
    throw ConfigError(
        {.file = output, .key = "-o"},
        fmt::format("is one file, but {} stacks need a cell file each; name a folder.", o.stacks.size()));
  if (!several && fs::path(output).extension() != ".toml")
    throw ConfigError({.file = output, .key = "-o"},
                      "must end in .toml; the picture next to it ends in .png.");
  if (!o.gammas.empty() && o.gammas.size() != o.stacks.size())
    throw ConfigError(
        {.file = {}, .key = "--drive-gamma"},
        fmt::format(
            "states {}, but there {}; state one for each stack, in the order of the stacks "
            "(--drive-gamma 0.9,1.6), or --drive-hz and --sigma-mm, which give the Gamma of each stack.",
            plural(o.gammas.size(), "strength"),
            o.stacks.size() == 1 ? "is 1 stack" : fmt::format("are {} stacks", o.stacks.size())));
  for (const std::string& stack : o.stacks) protect_input(imaging::file_of_stack(stack));
  const std::vector<std::string> names = twin::names_of_stacks({o.stacks.begin(), o.stacks.end()});
  if (several) claim_shared_folder(output, twin::cells_folder());
  nlohmann::json cells = nlohmann::json::array();
  std::string said;
  std::size_t open = 0;
  for (std::size_t i = 0; i < o.stacks.size(); ++i) {
    const fs::path cell = several ? fs::path(output) / (names[i] + ".toml") : fs::path(output);
    cells.push_back(write_one(common, o, i, cell, said));
    open += cells.back()["open"].size();
  }
  // A period that is not a whole number of frames has phases of its own in every stack, which the plate
  // shows.
  const bool whole_periods = std::none_of(cells.begin(), cells.end(), [](const nlohmann::json& cell) {
    return std::any_of(cell["not_measured"].begin(), cell["not_measured"].end(),
                       [](const nlohmann::json& m) { return m["what"] == twin::kFramesPerCycle; });
  });
  note_different_cells(common, cells);
  note_strengths(common, cells, o.gammas);
  if (open > 0)
    said += fmt::format("{} value{} still needed: look for \"FILL IN\" in the file{}.\n", open,
                        open == 1 ? " is" : "s are", several ? "s" : "");
  else
    said += "next: twincell match " + stacks_in_words(o.stacks) + " " + shell_word(output) +
            (whole_periods ? "" : " --phase-lock found") + readable_part(cells) + " -o twin/\n";
  nlohmann::json document = {{"cells", cells},
                             {"provenance", nlohmann::json::parse(common.provenance().to_json())}};
  print_result(common, document, said);
}

}  // namespace

void add_new(CLI::App& program, Common& common) {
  CLI::App& verb =
      add_verb(program, common, "new",
               "Measure what a stack shows of its cell (beads, walls, plate, scale, origin, drive, "
               "phases), ask for the rest, and write CELL.toml with a picture of what was measured.",
               "twincell new frames/ -o CELL.toml --sigma-mm 2 --drive-hz 11.15");
  has_details(verb, "how each value was found, or can be found");
  auto o = std::make_shared<NewOptions>();
  verb.add_option(
      "stacks", o->stacks,
      "Stack: folder of pictures, TIFF, camera file, HDF5 stack or video (docs/frames.md); several "
      "stacks: one for each drive strength");
  // One file, or a folder for several stacks: write_one() checks the outputs.
  common.outputs.push_back(
      {verb.add_option(
           "-o,--output", o->output,
           "Cell file to write; the picture is written next to it, with the ending .png. For several "
           "stacks: folder of the cell files. Default: CELL.toml, for several stacks cells"),
       nullptr, cell_file()});
  verb.add_option("--diameter", o->diameter_px, "Bead diameter, px; default: found in the first frames")
      ->check(CLI::Range(3.0, 400.0));
  const auto answer = [&](const char* name, std::optional<double>& value, const char* what) {
    verb.add_option(name, value, what)->check(above_zero());
  };
  answer("--sigma-mm", o->answers.sigma_mm, "Bead diameter, mm");
  answer("--cell-width-mm", o->answers.width_mm, "Distance of the side walls, mm");
  answer("--drive-hz", o->answers.frequency_hz,
         "Frequency of the shaker, Hz; default: frame rate over the period of the plate");
  verb.add_option(
          "--drive-gamma", o->gammas,
          "Peak acceleration of the plate over g; needs no bead diameter in mm. For several stacks one "
          "each, in their order: 0.9,1.6")
      ->type_name("FLOAT,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(above_zero());
  answer("--frame-rate-hz", o->answers.frame_rate_hz,
         "Frame rate of the camera, 1/s; default: that of the stack");
  verb.add_option("--gravity-m-s2", o->answers.gravity_m_s2, "Gravity, m/s^2")
      ->check(above_zero())
      ->capture_default_str();
  verb.callback([&common, o] { run(common, *o); });
}

}  // namespace twincell::cli
