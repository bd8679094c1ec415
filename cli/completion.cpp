// twincell completion bash|zsh|fish: prints the completion of verbs, options and their words for a shell.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/command_table.hpp"
#include "cli/verb.hpp"

namespace twincell::cli {

namespace {

std::string words_of(const Command& command) {
  std::string words = fmt::format("{}", fmt::join(command.below, " "));
  for (const CommandOption& option : command.options)
    for (const std::string& name : option.names)
      if (name.starts_with("--")) words += (words.empty() ? "" : " ") + name;
  for (const CommandOption& positional : command.positionals)
    for (const std::string& choice : positional.choices) words += " " + choice;
  return words;
}

/// Assigns `path` and `words`, in the syntax that bash and zsh share: the verb so far, and what may follow.
/// `current` and `previous` are the word that is completed and the one before it; `typed` are all words
/// before it.
std::string shared_lookup(const std::vector<Command>& table) {
  std::string verbs, words, choices;
  for (const Command& command : table) {
    for (const std::string& name : command.below)
      verbs += fmt::format("      '{}:{}') path='{}';;\n", command.path, name, command.path_of(name));
    words += fmt::format("    '{}') words='{}';;\n", command.path, words_of(command));
    for (const CommandOption& option : command.options)
      if (!option.choices.empty())
        for (const std::string& name : option.names)
          choices +=
              fmt::format("    '{}:{}') words='{}';;\n", command.path, name, fmt::join(option.choices, " "));
  }
  return fmt::format(
      "  local path='' words='' word\n"
      "  for word in \"${{typed[@]}}\"; do\n    case \"$path:$word\" in\n{}    esac\n  done\n"
      "  case \"$path\" in\n{}  esac\n"
      "  case \"$path:$previous\" in\n{}  esac\n",
      verbs, words, choices);
}

std::string bash(const std::vector<Command>& table) {
  return "# Completion of twincell for bash. Load it with: source <(twincell completion bash)\n"
         "_twincell() {\n"
         "  local current=\"${COMP_WORDS[COMP_CWORD]}\" previous=\"${COMP_WORDS[COMP_CWORD-1]}\"\n"
         "  local typed=(\"${COMP_WORDS[@]:1:COMP_CWORD-1}\")\n" +
         shared_lookup(table) +
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "}\n"
         "complete -o bashdefault -o default -F _twincell twincell\n";
}

std::string zsh(const std::vector<Command>& table) {
  return "#compdef twincell\n"
         "# Completion of twincell for zsh. Install it as _twincell in a folder of $fpath.\n"
         "_twincell() {\n"
         "  local current=\"${words[CURRENT]}\" previous=\"${words[CURRENT-1]}\"\n"
         "  local -a typed=(\"${(@)words[2,CURRENT-1]}\")\n"
         "  __twincell_complete\n"
         "}\n"
         "__twincell_complete() {\n" +
         shared_lookup(table) +
         "  compadd -- ${=words}\n"
         "  [[ $current == -* ]] || _files\n"
         "}\n"
         "if [ \"$funcstack[1]\" = \"_twincell\" ]; then _twincell \"$@\"; else compdef _twincell twincell; "
         "fi\n";
}

std::string fish(const std::vector<Command>& table) {
  const auto quoted = [](const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return out + "'";
  };
  std::string s = "# Completion of twincell for fish. Load it with: twincell completion fish | source\n";
  for (const Command& command : table) {
    std::string when = command.path.empty() ? "__fish_use_subcommand" : "";
    std::string word;
    for (const char c : command.path + " ")
      if (c != ' ') {
        word += c;
      } else if (!word.empty()) {
        when += fmt::format("{}__fish_seen_subcommand_from {}", when.empty() ? "" : "; and ", word);
        word.clear();
      }
    for (const std::string& name : command.below) {
      const std::string path = command.path_of(name);
      std::string summary;
      for (const Command& c : table)
        if (c.path == path) summary = c.summary.substr(0, c.summary.find(". "));
      s += fmt::format("complete -c twincell -n {} -a {} -d {}\n", quoted(when), name, quoted(summary));
    }
    for (const CommandOption& positional : command.positionals)
      for (const std::string& choice : positional.choices)
        s += fmt::format("complete -c twincell -f -n {} -a {}\n", quoted(when), choice);
    for (const CommandOption& option : command.options) {
      s += fmt::format("complete -c twincell -n {}", quoted(when));
      for (const std::string& name : option.names)
        s += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!option.choices.empty())
        s += fmt::format(" -x -a {}", quoted(fmt::format("{}", fmt::join(option.choices, " "))));
      else if (!option.value.empty())
        s += " -r";
      s += fmt::format(" -d {}\n", quoted(option.help.substr(0, option.help.find_first_of(";.("))));
    }
  }
  return s;
}

}  // namespace

void add_completion(CLI::App& program, Common&) {
  CLI::App& verb = *program.add_subcommand("completion",
                                           "Print the completion of verbs, options and their words for a "
                                           "shell. Installing the program does this.");
  verb.footer("Example:\n  source <(twincell completion bash)");
  auto shell = std::make_shared<std::string>();
  verb.add_option("shell", *shell, "Shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  verb.callback([shell, &program] {
    const std::vector<Command> table = command_table(program);
    const std::string script = *shell == "bash" ? bash(table) : *shell == "zsh" ? zsh(table) : fish(table);
    std::fputs(script.c_str(), stdout);
  });
}

}  // namespace twincell::cli
