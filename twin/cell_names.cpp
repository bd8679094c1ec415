#include "twin/cell_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "core/error.hpp"
#include "core/plural.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::twin {
namespace {

namespace fs = std::filesystem;

/// The path of a stack without a trailing separator; "file.h5:/path" becomes "file.h5".
fs::path bare(const fs::path& stack) {
  const fs::path file = fs::absolute(imaging::file_of_stack(stack)).lexically_normal();
  return file.has_filename() ? file : file.parent_path();
}

std::string short_name(const fs::path& stack) {
  const fs::path file = bare(stack);
  // Names of folders contain dots that are no extensions: gamma-1.6.
  return fs::is_directory(file) ? file.filename().string() : file.stem().string();
}

/// The name of the folder or file, with the dataset in it: "f.avi", "f.h5-day-2".
std::string full_name(const fs::path& stack) {
  std::string name = bare(stack).filename().string();
  std::string inside = stack.string().substr(imaging::file_of_stack(stack).string().size());
  if (inside.starts_with(':')) {
    std::replace(inside.begin(), inside.end(), '/', '-');
    name += inside[1] == '-' ? inside.substr(1) : "-" + inside.substr(1);
  }
  return name;
}

/// \throws ConfigError if two of the stacks are the same
void refuse_repeated(const std::vector<fs::path>& stacks) {
  const auto place = [](const fs::path& stack) {
    std::error_code ec;
    const fs::path file = imaging::file_of_stack(stack);
    const fs::path real = fs::canonical(file, ec);
    return (ec ? bare(stack) : real).string() + stack.string().substr(file.string().size());
  };
  std::map<std::string, fs::path> seen;
  for (const fs::path& stack : stacks)
    if (const auto [before, is_new] = seen.emplace(place(stack), stack); !is_new)
      throw ConfigError({.file = stack.string()},
                        fmt::format("is the same stack as {}; name it only once.", before->second.string()));
}

/// Of `match`, the folder of the comparison beside those of the stacks.
constexpr const char* kTaken = "report";

/// Whether a folder contains cell files and no picture but that of each, as `new` writes it. A stack may
/// contain its own CELL.toml and notes.
bool is_folder_of_cells(const fs::path& folder) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec) || fs::exists(folder / "CELL.toml", ec)) return false;
  bool cells = false;
  for (const auto& entry : fs::directory_iterator(folder, ec)) {
    fs::path file = entry.path();
    cells = cells || file.extension() == ".toml";
    if (imaging::has_picture_name(file) && !fs::exists(file.replace_extension(".toml"), ec)) return false;
  }
  return cells;
}

}  // namespace

std::vector<std::string> names_of_stacks(const std::vector<fs::path>& stacks) {
  refuse_repeated(stacks);
  std::vector<std::string> names;
  for (const fs::path& stack : stacks) names.push_back(short_name(stack));
  const auto rename = [&](auto longer) {
    std::map<std::string, int> count{{kTaken, 1}};
    for (const std::string& name : names) ++count[name];
    for (std::size_t i = 0; i < names.size(); ++i)
      if (count[names[i]] > 1) names[i] = longer(stacks[i], names[i]);
  };
  // None of these names depends on the order of the stacks, in which `new` and `match` may differ.
  rename([](const fs::path& stack, const std::string&) { return full_name(stack); });
  std::ptrdiff_t most = 0;
  for (const fs::path& stack : stacks) {
    const fs::path file = bare(stack);
    most = std::max(most, std::distance(file.begin(), file.end()));
  }
  for (std::ptrdiff_t level = 1; level < most; ++level)
    rename([&](const fs::path& stack, const std::string& name) {
      fs::path folder = bare(stack);
      for (std::ptrdiff_t up = 0; up < level; ++up) folder = folder.parent_path();
      return folder.has_filename() ? folder.filename().string() + "-" + name : name;
    });
  return names;
}

StacksAndCells pair_stacks(const std::vector<fs::path>& arguments) {
  StacksAndCells p;
  fs::path folder;
  for (const fs::path& argument : arguments) {
    if (argument.extension() == ".toml")
      p.cells.push_back(argument);
    else if (is_folder_of_cells(argument))
      folder = argument;
    else
      p.stacks.push_back(argument);
  }
  if (p.stacks.empty())
    throw ConfigError({.file = {}, .key = "match"}, "no stack is named; give at least one stack of frames.");
  const std::size_t n = p.stacks.size();
  if (p.cells.size() == n && folder.empty()) return p;
  if (p.cells.size() == 1 && folder.empty()) {
    p.cells.assign(n, p.cells.front());
    return p;
  }
  if (!p.cells.empty())
    throw ConfigError({.file = {}, .key = "match"},
                      fmt::format("{} and {}{} are named; give one cell file for all stacks, or one "
                                  "for each, in their order.",
                                  plural(n, "stack"), plural(p.cells.size(), "cell file"),
                                  folder.empty() ? "" : " and a folder of cell files"));
  const std::vector<std::string> names = names_of_stacks(p.stacks);
  for (std::size_t i = 0; i < n; ++i) {
    const fs::path cell = folder.empty() ? p.stacks[i] / "CELL.toml" : folder / (names[i] + ".toml");
    if (!fs::is_regular_file(cell))
      throw ConfigError(
          {.file = cell.string()},
          fmt::format("does not exist, so the cell of {} is unknown; twincell new {} writes a cell "
                      "file.",
                      p.stacks[i].string(), p.stacks[i].string()));
    p.cells.push_back(cell);
  }
  return p;
}

}  // namespace twincell::twin
