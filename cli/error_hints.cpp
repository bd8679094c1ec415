#include "cli/error_hints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "core/escape.hpp"
#include "core/nearest_word.hpp"
#include "trajectory/foreign/format.hpp"

namespace twincell::cli {
namespace {

namespace fs = std::filesystem;

template <std::size_t n>
bool is_one_of(const std::string& verb, const std::array<std::string_view, n>& verbs) {
  return std::find(verbs.begin(), verbs.end(), verb) != verbs.end();
}

constexpr std::array<std::string_view, 6> kReadTrajectories = {"analyze", "compare",  "draw",
                                                               "render",  "validate", "export"};
constexpr std::array<std::string_view, 3> kReadScenes = {"simulate", "explain", "measure"};
constexpr std::array<std::string_view, 3> kReadCells = {"track", "match", "calibrate"};

/// A name in the folder of a missing file that differs from it by at most three letters.
std::string near_name(const fs::path& missing) {
  constexpr std::size_t kShortest = 4;
  std::error_code error;
  const fs::path folder = missing.has_parent_path() ? missing.parent_path() : ".";
  const std::string name = missing.filename().string();
  if (missing.stem().string().size() < kShortest) return {};
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string other = entry->path().filename().string();
    if (other.size() + 2 >= name.size() && other.size() <= name.size() + 2) names.push_back(other);
  }
  std::sort(names.begin(), names.end());
  const std::string near = nearest_word(name, names);
  // Frames and runs are numbered: another number is no misspelling.
  const auto letters = [](std::string s) {
    std::erase_if(s, [](char c) { return c >= '0' && c <= '9'; });
    return s;
  };
  return near.empty() || letters(near) == letters(name) ? "" : (missing.parent_path() / near).string();
}

std::string advice_on_missing(const std::string& verb, const std::string& word) {
  if (word.starts_with('~'))
    return "the shell expands ~ only at the beginning of a word and outside of quotes";
  if (const std::string near = near_name(word); !near.empty())
    return fmt::format("did you mean '{}'?", one_line(near));
  const std::string extension = fs::path(word).extension().string();
  if (extension == ".toml" && is_one_of(verb, kReadCells))
    return fmt::format("twincell new STACK -o {} writes a cell file of this name", shell_word(word));
  if (extension == ".h5" && is_one_of(verb, kReadTrajectories))
    return "twincell track and twincell simulate write trajectories";
  return {};
}

std::string advice_on_kind(const std::string& verb, const std::string& word) {
  std::error_code error;
  const std::string extension = fs::path(word).extension().string();
  if (verb == "compare" && (extension == ".toml" || extension == ".sweep"))
    return "twincell simulate makes a trajectory of a scene, and twincell sweep collect the results of a "
           "sweep";
  if (is_one_of(verb, kReadTrajectories)) {
    if (fs::is_directory(word, error))
      return fmt::format("twincell track {} -o {} makes a trajectory of a stack of frames", shell_word(word),
                         shell_word(fs::path(word).filename().string() + ".h5"));
    if (extension == ".toml")
      return fmt::format("twincell simulate {} -o {} makes a trajectory of a scene", shell_word(word),
                         shell_word(fs::path(word).stem().string() + ".h5"));
    if (format_of_extension(extension) != nullptr)
      return fmt::format("twincell import {} -o {} makes a trajectory of a file of another program",
                         shell_word(word), shell_word(fs::path(word).stem().string() + ".h5"));
  }
  if (is_one_of(verb, kReadScenes)) {
    if (fs::is_directory(word, error))
      return fmt::format("{} reads a scene file (TOML); for a stack of frames see twincell new", verb);
    if (extension == ".h5") return fmt::format("{} reads a scene file (TOML)", verb);
  }
  return {};
}

/// What a TOML file is, judged by its tables, and the verb that reads it.
struct TomlKind {
  std::string_view name, reader;
};
constexpr TomlKind kPlan{"a plan of a sweep", "sweep run"}, kCell{"a cell file", "track and match"},
    kScene{"a scene", "simulate"};

std::optional<TomlKind> kind_of_toml(const fs::path& file) {
  constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 20;  // bytes
  std::error_code error;
  if (!fs::is_regular_file(file, error) || fs::file_size(file, error) > kLargest) return std::nullopt;
  std::ifstream stream(file);
  std::optional<TomlKind> kind;
  for (std::string line; std::getline(stream, line);) {
    const auto begins = [&](std::string_view word) { return line.starts_with(word); };
    if (begins("[axes") || begins("results")) return kPlan;
    if (begins("[camera")) return kCell;
    if (begins("preset") || begins("[beads") || begins("[contact") || begins("[start") || begins("[time"))
      kind = kScene;
  }
  return kind;
}

/// A TOML file of another kind than the verb reads has keys that it does not know, or lacks those it needs.
std::string advice_on_toml(const std::string& verb, const std::string& word, const std::string& complaint) {
  constexpr std::array<std::string_view, 3> kOfKeys = {"there is no such key", "is missing",
                                                       "is a key of a scene"};
  if (fs::path(word).extension() != ".toml" ||
      std::none_of(kOfKeys.begin(), kOfKeys.end(),
                   [&](std::string_view said) { return complaint.find(said) != std::string::npos; }))
    return {};
  const auto kind = kind_of_toml(word);
  if (!kind) return {};
  const std::string_view reads = is_one_of(verb, kReadScenes)  ? kScene.name
                                 : is_one_of(verb, kReadCells) ? kCell.name
                                 : verb == "sweep"             ? kPlan.name
                                                               : kind->name;
  if (reads == kind->name) return {};
  return fmt::format("this file looks like {}, which twincell {} read{}{}", kind->name, kind->reader,
                     kind->name == kCell.name ? "" : "s",
                     verb == "match" && kind->name == kScene.name ? "; match takes one with --scene" : "");
}

}  // namespace

std::string file_hint(const std::vector<std::string>& words, const std::string& complaint) {
  if (words.empty()) return {};
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word.empty() || word.starts_with('-') || !complaint.starts_with(word + ":")) continue;
    if (std::string advice = advice_on_toml(words[0], word, complaint); !advice.empty()) return advice;
    if (is_one_of(words[0], kReadCells) && complaint.starts_with(word + ": drive: two of "))
      return "twincell new STACK -o CELL.toml measures the drive";
    if (!complaint.starts_with(word + ": ")) continue;
    // Complaints about an output say themselves what to name instead.
    for (const char* of_output : {": the output", ": the file exists and", ": the folder is ",
                                  ": the file is write-protected", ": the file is a mount point",
                                  ": the file belongs to", ": a file of that name", ": a folder or file of"})
      if (complaint.starts_with(word + of_output)) return {};
    std::error_code error;
    return fs::exists(fs::symlink_status(word, error)) ? advice_on_kind(words[0], word)
                                                       : advice_on_missing(words[0], word);
  }
  return {};
}

std::string listed(std::vector<std::string> words) {
  if (words.empty()) return {};
  const std::string last = words.back();
  words.pop_back();
  return words.empty() ? last : fmt::format("{} or {}", fmt::join(words, ", "), last);
}

std::string with_hint(const CLI::App& verb, const std::string& complaint) {
  // "--to: lamps not in {lammps,xyz}"
  constexpr std::string_view kNotIn = " not in {";
  if (const std::size_t at = complaint.find(kNotIn); at != std::string::npos) {
    const std::size_t colon = complaint.find(": ");
    const std::size_t from = colon == std::string::npos ? 0 : colon + 2, end = complaint.rfind('}');
    const std::string word = complaint.substr(from, at - from);
    std::vector<std::string> known;
    std::string list = complaint.substr(at + kNotIn.size(), end - at - kNotIn.size());
    for (std::size_t comma = 0; comma != std::string::npos; list.erase(0, comma + 1)) {
      comma = list.find(',');
      known.push_back(list.substr(0, comma));
      if (comma == std::string::npos) break;
    }
    const std::string near = nearest_word(word, known);
    return fmt::format("{}'{}' is not {}{}", complaint.substr(0, from), word, listed(known),
                       near.empty() ? "." : fmt::format("; did you mean '{}'?", near));
  }
  if (complaint == "A subcommand is required") {
    std::vector<std::string> names;
    for (const CLI::App* below : verb.get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(below->get_name());
    return fmt::format("{} needs a word that says what: {}.", verb.get_name(), listed(names));
  }
  constexpr std::string_view kRequired = " is required";
  if (complaint.ends_with(kRequired)) {
    std::string example = verb.get_footer();
    example.erase(0, std::min(example.size(), example.find("twincell")));
    example.erase(std::min(example.size(), example.find('\n')));
    if (!example.empty())
      return fmt::format("{}; example: {} (--help shows the options.)", complaint, example);
  }
  return complaint + (complaint.ends_with('.') ? "" : ".") + " (--help shows the options.)";
}

}  // namespace twincell::cli
