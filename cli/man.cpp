// twincell man -o FOLDER: writes the manual pages, one for each verb, from the tables that --help prints.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "cli/command_table.hpp"
#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/atomic_file.hpp"
#include "core/provenance.hpp"

namespace twincell::cli {

namespace {

/// `text` for roff: backslashes and hyphens are escaped, and no line begins with a control character.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if ((out.empty() || out.back() == '\n') && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

/// "twincell-sweep-run", the name of the page.
std::string page_of(const std::string& path) {
  std::string name = path.empty() ? "twincell" : "twincell-" + path;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string options_section(const std::string& heading, const std::vector<CommandOption>& options) {
  if (options.empty()) return {};
  std::string s = ".SH " + heading + "\n";
  for (const CommandOption& option : options) {
    std::string names;
    for (const std::string& name : option.names)
      names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", roff(name));
    s += ".TP\n" + names;
    if (!option.value.empty() && option.names.front().starts_with('-'))
      s += fmt::format(" \\fI{}\\fR", roff(option.value));
    s += "\n" + roff(option.help);
    if (!option.choices.empty())
      s += fmt::format("; one of {}", roff(fmt::format("{}", fmt::join(option.choices, ", "))));
    s += ".\n";
  }
  return s;
}

std::string page(const Command& command, const std::vector<Command>& table) {
  const std::string call = command.path.empty() ? "twincell" : "twincell " + command.path;
  const std::string first = command.summary.substr(0, command.summary.find(". "));
  std::string upper = page_of(command.path);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const std::string version = version_line();
  std::string s =
      fmt::format(".TH {} 1 \"\" \"{}\" \"Twincell\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n",
                  roff(upper), roff(version.substr(0, version.find(" ("))), roff(page_of(command.path)),
                  roff(first.ends_with('.') ? first.substr(0, first.size() - 1) : first), roff(call));
  if (!command.below.empty()) s += "\\fIVERB\\fR\n";
  s += "[\\fIOPTIONS\\fR]\n";
  for (const CommandOption& positional : command.positionals)
    s += fmt::format("\\fI{}\\fR\n", roff(positional.names.front()));
  s += ".SH DESCRIPTION\n" + roff(command.summary) + "\n";
  if (!command.below.empty()) {
    s += ".SH VERBS\n";
    for (const std::string& name : command.below) {
      const std::string path = command.path_of(name);
      const auto verb =
          std::find_if(table.begin(), table.end(), [&](const Command& c) { return c.path == path; });
      s += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(name), roff(verb->summary));
    }
  }
  s += options_section("ARGUMENTS", command.positionals) + options_section("OPTIONS", command.options);
  if (!command.footer.empty()) s += ".SH NOTES\n.nf\n" + roff(command.footer) + "\n.fi\n";
  s += ".SH SEE ALSO\n";
  s += command.path.empty() ? std::string(".BR twincell\\-help (1)\n") : std::string(".BR twincell (1)\n");
  return s;
}

}  // namespace

void add_man(CLI::App& program, Common& common) {
  auto folder = std::make_shared<std::string>();
  CLI::App& verb =
      add_verb(program, common, "man",
               "Write the manual pages of the program and of all verbs. Installing the program does "
               "this; man twincell-track shows a page.",
               "twincell man -o man1/");
  common.outputs.push_back({verb.add_option("-o,--output", *folder, "Folder for the pages")->required(),
                            nullptr, Product::whole_folder("a folder of manual pages")});
  verb.callback([folder, &program, &common] {
    const std::vector<Command> table = command_table(program);
    AtomicPath out(*folder, Product::whole_folder("a folder of manual pages"));
    for (const Command& command : table)
      write_text_file(out.part() / (page_of(command.path) + ".1"), page(command, table));
    out.commit();
    print_result(common, {{"output", *folder}, {"pages", table.size()}},
                 fmt::format("{} pages\n{}\n", table.size(), *folder));
  });
}

}  // namespace twincell::cli
