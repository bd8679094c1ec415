#include "twin/cell_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.hpp"
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

/// Whether a folder contains cell files, but is not a stack with its own CELL.toml.
bool is_folder_of_cells(const fs::path& folder) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec) || fs::exists(folder / "CELL.toml", ec)) return false;
  return std::any_of(fs::directory_iterator(folder, ec), fs::directory_iterator(),
                     [](const fs::directory_entry& e) { return e.path().extension() == ".toml"; });
}

}  // namespace

std::vector<std::string> names_of_stacks(const std::vector<fs::path>& stacks) {
  std::vector<std::string> names;
  for (const fs::path& stack : stacks) names.push_back(short_name(stack));
  const auto shared = [&] {
    std::map<std::string, int> count;
    for (const std::string& name : names) ++count[name];
    return count;
  };
  auto count = shared();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (count[names[i]] > 1) names[i] = bare(stacks[i]).parent_path().filename().string() + "-" + names[i];
  count = shared();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (count[names[i]] > 1) names[i] += fmt::format("-{}", i + 1);
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
    throw ConfigError(
        {.file = {}, .key = "match"},
        fmt::format("{} stacks and {} cell files{} are named; give one cell file for all stacks, or one "
                    "for each, in their order.",
                    n, p.cells.size(), folder.empty() ? "" : " and a folder of cell files"));
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
