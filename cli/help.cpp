// twincell help [VERB]: prints the help of a verb, as VERB --help does.

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/verb.hpp"

namespace twincell::cli {

void add_help(CLI::App& program, Common&) {
  CLI::App& verb = *program.add_subcommand("help", "Print the help of the program or of a verb.");
  verb.footer("Example:\n  twincell help track");
  auto words = std::make_shared<std::vector<std::string>>();
  verb.add_option("verb", *words, "Verb, or a group and its verb; default: the list of all verbs");
  verb.callback([words, &program] {
    const CLI::App* app = &program;
    for (const std::string& word : *words)
      app = app->get_subcommand(word);  // throws if there is no such verb
    std::string name = program.get_name();
    for (const std::string& word : *words) name += " " + word;
    // App::help() would print the help of the verb that was parsed, which is this one.
    std::fputs(app->get_formatter()->make_help(app, name, CLI::AppFormatMode::Normal).c_str(), stdout);
  });
}

}  // namespace twincell::cli
