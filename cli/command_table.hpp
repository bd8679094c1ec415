#pragma once
/// \file
/// The commands of the program as a table, from which help, manual pages and shell completion are made.

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace twincell::cli {

/// An option or a positional argument.
struct CommandOption {
  std::vector<std::string> names;    ///< "--output", "-o"; of a positional argument its name
  std::string value;                 ///< name of its value; empty: a flag
  std::vector<std::string> choices;  ///< the words that the value may be; empty: anything
  std::string help;
};

/// A verb, or a verb of a group: "sweep run".
struct Command {
  std::string path;  ///< without the name of the program
  std::string summary, footer;
  std::vector<CommandOption> positionals, options;
  std::vector<std::string> below;  ///< verbs of a group

  /// Path of a verb of the group.
  [[nodiscard]] std::string path_of(const std::string& verb) const {
    return path.empty() ? verb : path + " " + verb;
  }
};

/// All commands in the order of --help, a group before its verbs. The first is the program itself, with an
/// empty path.
std::vector<Command> command_table(const CLI::App& program);

}  // namespace twincell::cli
