#include "cli/command_table.hpp"

#include <CLI/CLI.hpp>

namespace twincell::cli {

namespace {

/// The words of a type name such as "TEXT:{sigma,mm}".
std::vector<std::string> choices_of(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.find('}', open);
  std::vector<std::string> words;
  if (open == std::string::npos || close == std::string::npos) return words;
  std::string word;
  for (std::size_t i = open + 1; i <= close; ++i)
    if (type[i] == ',' || i == close) {
      words.push_back(word.substr(0, word.find("->")));  // of a word that stands for a value
      word.clear();
    } else {
      word += type[i];
    }
  return words;
}

CommandOption described(const CLI::Option& option) {
  CommandOption d;
  if (option.nonpositional()) {
    for (const std::string& name : option.get_lnames()) d.names.push_back("--" + name);
    for (const std::string& name : option.get_snames()) d.names.push_back("-" + name);
  } else {
    d.names.push_back(option.get_name());
  }
  if (option.get_items_expected_max() > 0) {
    const std::string type = option.get_type_name();
    d.choices = choices_of(type);
    d.value = option.get_option_text().empty() ? type.substr(0, type.find_first_of(": "))
                                               : option.get_option_text();
    if (d.value.empty()) d.value = "VALUE";
  }
  d.help = option.get_description();
  return d;
}

void add(const CLI::App& app, const std::string& path, std::vector<Command>& table) {
  Command command;
  command.path = path;
  command.summary = app.get_description();
  command.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // a former option
    (option->nonpositional() ? command.options : command.positionals).push_back(described(*option));
  }
  const auto verbs = app.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* verb : verbs) command.below.push_back(verb->get_name());
  table.push_back(command);
  for (const CLI::App* verb : verbs) add(*verb, command.path_of(verb->get_name()), table);
}

}  // namespace

std::vector<Command> command_table(const CLI::App& program) {
  std::vector<Command> table;
  add(program, "", table);
  return table;
}

}  // namespace twincell::cli
