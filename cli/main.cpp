// Entry point of the program: the table of verbs, and the error messages and exit codes of exceptions.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "cli/error_hints.hpp"
#include "cli/number_checks.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "cli/version.hpp"
#include "cli/wrapped_help.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/hdf5.hpp"
#include "core/malloc_tuning.hpp"
#include "core/nearest_word.hpp"
#include "imaging/stack/opencv_errors.hpp"

// The list: a verb is NAME.cpp in this folder, which defines add_NAME. Order of --help: the verbs that a new
// user needs come first.
#define TWINCELL_VERBS(EACH) \
  EACH(example)              \
  EACH(new)                  \
  EACH(locate)               \
  EACH(track)                \
  EACH(explain)              \
  EACH(simulate)             \
  EACH(render)               \
  EACH(draw)                 \
  EACH(analyze)              \
  EACH(measure)              \
  EACH(sweep)                \
  EACH(reproduce)            \
  EACH(calibrate)            \
  EACH(match)                \
  EACH(compare)              \
  EACH(fit)                  \
  EACH(info)                 \
  EACH(validate)             \
  EACH(export)               \
  EACH(import)               \
  EACH(cost)                 \
  EACH(keys)                 \
  EACH(help)                 \
  EACH(man)                  \
  EACH(completion)

namespace twincell::cli {
#define TWINCELL_DECLARE(name) void add_##name(CLI::App& program, Common& common);
TWINCELL_VERBS(TWINCELL_DECLARE)
#undef TWINCELL_DECLARE
}  // namespace twincell::cli

namespace {

using namespace twincell;
using namespace twincell::cli;

constexpr AddVerb kVerbs[] = {
#define TWINCELL_ADDRESS(name) add_##name,
    TWINCELL_VERBS(TWINCELL_ADDRESS)
#undef TWINCELL_ADDRESS
};

int complain(const std::string& sentence, ExitCode code) {
  // File names can contain newlines and terminal control sequences. The message is therefore escaped to one
  // line.
  std::fprintf(stderr, "twincell: %s\n", one_line(sentence).c_str());
  return static_cast<int>(code);
}

std::string joined(int argc, char** argv) {
  std::string line = "twincell";
  for (int i = 1; i < argc; ++i) {
    line += " " + shell_word(argv[i]);
  }
  return line;
}

std::vector<const CLI::App*> verbs_of(const CLI::App& group) {
  return group.get_subcommands([](const CLI::App*) { return true; });
}

/// "Did you mean": the command below `group` whose last word is `word`, otherwise the verb of the group with
/// the smallest edit distance, if it is at most 3. Without the name of the program.
std::string nearest_command(const CLI::App& group, const std::string& word) {
  for (const CLI::App* verb : verbs_of(group))
    for (const CLI::App* below : verbs_of(*verb))
      if (below->get_name() == word) return verb->get_name() + " " + word;
  std::vector<std::string> names;
  for (const CLI::App* verb : verbs_of(group)) names.push_back(verb->get_name());
  return nearest_word(word, names);
}

/// Complaint about the first word of the command line that should be a verb but is none; empty if every group
/// is followed by one of its verbs. CLI11 would ignore such a word before --help.
std::string unknown_verb(const CLI::App& program, int argc, char** argv) {
  const CLI::App* group = &program;
  std::string path;
  for (int i = 1; i < argc && argv[i][0] != '-' && !verbs_of(*group).empty(); ++i) {
    const auto verbs = verbs_of(*group);
    const auto verb = std::find_if(verbs.begin(), verbs.end(),
                                   [&](const CLI::App* known) { return known->get_name() == argv[i]; });
    if (verb == verbs.end()) {
      const std::string near = nearest_command(*group, argv[i]);
      const std::string complaint = "there is no verb '" + path + argv[i] + "'; ";
      if (!near.empty()) return complaint + "did you mean '" + path + near + "'?";
      if (group == &program) return complaint + "--help lists them.";
      std::vector<std::string> names;
      for (const CLI::App* known : verbs) names.push_back(known->get_name());
      return complaint + path + "has " + listed(names) + ".";
    }
    group = *verb;
    path += group->get_name() + " ";
  }
  return {};
}

/// Whether two options begin with the same word of four letters or more: --drive-freq and --drive-hz.
bool begin_alike(const std::string& a, const std::string& b) {
  constexpr std::size_t kMinLetters = 4, kDashes = 2;
  const std::string first = a.substr(kDashes, a.find('-', kDashes) - kDashes);
  return first.size() >= kMinLetters && b.substr(kDashes).starts_with(first);
}

/// What to say after an unknown option: the nearest one of the verb, those that begin alike, or the
/// verbs that have an option of that name. \param options those of the verb
std::string advice_on_option(const CLI::App& program, const std::string& name,
                             const std::vector<std::string>& options) {
  constexpr std::size_t kMostNamed = 4;
  if (const std::string near = nearest_word(name, options); !near.empty())
    return "; did you mean '" + near + "'?";
  std::vector<std::string> verbs;
  for (const CLI::App* verb : verbs_of(program))
    if (verb->get_option_no_throw(name) != nullptr) verbs.push_back(verb->get_name());
  if (!verbs.empty()) {
    const bool many = verbs.size() > kMostNamed;
    verbs.resize(std::min(verbs.size(), kMostNamed));
    return fmt::format("; it is an option of {}{}.", fmt::join(verbs, ", "), many ? ", …" : "");
  }
  std::vector<std::string> alike;
  for (const std::string& option : options)
    if (begin_alike(name, option)) alike.push_back(option);
  if (alike.empty() || alike.size() > kMostNamed) return "; --help shows the options.";
  return fmt::format("; similar options: {}.", fmt::join(alike, ", "));
}

/// Complaint about an option that no verb of the command line has, with the nearest one it has; empty if
/// there is none.
std::string unknown_option(const CLI::App& program, int argc, char** argv) {
  const CLI::App* verb = &program;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto verbs = verbs_of(*verb);
    const auto below = std::find_if(verbs.begin(), verbs.end(),
                                    [&](const CLI::App* known) { return known->get_name() == word; });
    if (below != verbs.end()) verb = *below;
    if (word == "--") break;
    if (!word.starts_with("--")) continue;
    const std::string name = word.substr(0, word.find('='));
    if (verb->get_option_no_throw(name) != nullptr) continue;
    std::vector<std::string> names;
    for (const CLI::Option* option : verb->get_options())
      for (const std::string& other : option->get_lnames())
        if (!option->get_group().empty()) names.push_back("--" + other);
    return "there is no option '" + name + "'" + advice_on_option(program, name, names);
  }
  return {};
}

/// The verb and the existing files of a command line, for example "locate a.png". Used by error messages that
/// do not know which file they are about.
std::string subject(int argc, char** argv) {
  std::string said;
  for (int i = 1; i < argc; ++i) {
    std::error_code ec;
    const std::string word = argv[i];
    if (i == 1 || (!word.starts_with('-') && std::filesystem::exists(word, ec)))
      said += (i > 1 ? " " : "") + word;
  }
  return said;
}

int complain_of_memory(int argc, char** argv) {
  return complain(subject(argc, argv) + ": the command needs more memory than is available.",
                  ExitCode::failed);
}

/// Reports an internal error. The text of the exception helps only developers, so it is printed only if
/// TWINCELL_DEBUG is set.
int complain_of_fault(int argc, char** argv, const std::string& kind, const char* what) {
  const char* debug = std::getenv("TWINCELL_DEBUG");
  const bool shown = debug != nullptr && *debug != '\0';
  return complain(subject(argc, argv) + ": " + kind +
                      " failed with an unexpected internal error; this is a bug in twincell, please report "
                      "it with the input files" +
                      (shown ? std::string(" (") + what + ")." : "."),
                  ExitCode::failed);
}

/// The verb that was selected last.
const CLI::App& selected(const CLI::App& program) {
  const CLI::App* verb = &program;
  while (!verb->get_subcommands().empty()) verb = verb->get_subcommands().front();
  return *verb;
}

/// The complaint with the next step that the command line suggests.
std::string with_advice(const std::string& complaint, int argc, char** argv) {
  const std::string advice = file_hint({argv + 1, argv + argc}, complaint);
  if (advice.empty()) return complaint;
  return complaint.substr(0, complaint.find_last_not_of('.') + 1) + "; " + advice +
         (advice.ends_with('?') ? "" : ".");
}

/// The complaint with the dashes of the option that it begins with: the libraries name an option by its key.
/// A word of the command line is a file, whose name may be that of an option, such as the folder "frames".
std::string with_dashes(const CLI::App& program, const std::string& complaint, int argc, char** argv) {
  const std::string key = complaint.substr(0, complaint.find(": "));
  const bool is_file = std::any_of(argv + 1, argv + argc, [&](const std::string& word) {
    return word == key || word.ends_with("=" + key);
  });
  const bool is_option = !key.empty() && key.size() < complaint.size() && !is_file &&
                         selected(program).get_option_no_throw("--" + key) != nullptr;
  return is_option ? "--" + complaint : complaint;
}

/// Writes out what is still buffered. A reader that went away is not an error.
int finish_output() {
  std::cout.flush();
  const bool failed = std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout;
  struct pollfd output = {.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
  const bool reader_gone = ::poll(&output, 1, 0) == 1 && (output.revents & (POLLERR | POLLHUP)) != 0;
  if (!failed || reader_gone) return 0;
  return complain("The result cannot be written to standard output.", ExitCode::failed);
}

int run(int argc, char** argv) {
  Common common;
  common.command_line = joined(argc, argv);
  CLI::App program(
      "Twincell analyses camera frames of shaken beads and simulations of the same cell in the same way, and "
      "compares the two.",
      "twincell");
  program.set_version_flag("--version", [] { return version_text(); });
  program.require_subcommand(0, 1);
  program.formatter(wrapped_help());  // before the verbs, which inherit it
  program.footer(
      "Exit codes: 0 done, 1 failed while running, 2 error in usage or configuration, 3 input unreadable\n"
      "or malformed, 5 partial result that can be resumed, 130/143 stopped by a signal.");
  for (const AddVerb add : kVerbs) add(program, common);
  check_numbers(program);

  if (argc == 3 && std::string(argv[1]) == "--version" && std::string(argv[2]) == "--json") {
    std::printf("%s\n", version_json().c_str());
    return 0;
  }
  const int skipped = argc > 1 && std::string(argv[1]) == "help" ? 1 : 0;  // its words are verbs too
  if (const std::string complaint = unknown_verb(program, argc - skipped, argv + skipped); !complaint.empty())
    return complain(complaint, ExitCode::usage);
  try {
    program.parse(argc, argv);
    if (program.get_subcommands().empty()) std::printf("%s", program.help().c_str());
    return finish_output();
  } catch (const CLI::Success& wanted) {  // --help, --version
    program.exit(wanted);
    return finish_output();
  } catch (const Error& e) {
    return complain(with_advice(with_dashes(program, in_final_names(e.what()), argc, argv), argc, argv),
                    e.exit_code());
  } catch (const CLI::ParseError& e) {
    // An option that is misspelled is the cause, also where CLI11 misses the right one first.
    if (const std::string complaint = unknown_option(program, argc, argv); !complaint.empty())
      return complain(complaint, ExitCode::usage);
    return complain(with_hint(selected(program), e.what()), ExitCode::usage);
  }
}

}  // namespace

int main(int argc, char** argv) {
  tune_malloc();
  watch_signals();
  h5::quiet();
  try {
    return run(argc, argv);
  } catch (const Error& e) {
    return complain(in_final_names(e.what()), e.exit_code());
  } catch (const std::bad_alloc&) {
    return complain_of_memory(argc, argv);
  } catch (const std::exception& e) {
    const auto fault = imaging::opencv_error(e);
    if (fault && fault->out_of_memory) return complain_of_memory(argc, argv);
    if (fault) return complain_of_fault(argc, argv, "the image processing", fault->what.c_str());
    return complain_of_fault(argc, argv, "the program", e.what());
  }
}
