#pragma once
/// \file
/// Names of several stacks and their cell files: `new` writes them, `match` finds them.

#include <filesystem>
#include <string>
#include <vector>

#include "core/output_kind.hpp"

namespace twincell::twin {

/// Output kind of a folder of cell files.
inline Product cells_folder() {
  return Product::shared_folder("a folder of cell files");
}

/// A short name for each stack: the name of its folder or file without extension; for equal names, and for
/// "report", with the extension and the dataset, then with the folders above ("day_1-gamma_2"). A name does
/// not depend on the order of the stacks.
/// \throws ConfigError if two of the stacks are the same
std::vector<std::string> names_of_stacks(const std::vector<std::filesystem::path>& stacks);

/// Stacks with their cell files, as the arguments of `match` name them.
struct StacksAndCells {
  std::vector<std::filesystem::path> stacks, cells;  ///< as many cells as stacks
};

/// Pairs the arguments. Files that end in .toml are cells; a folder with cell files and no CELL.toml (as
/// `new` writes it) provides NAME.toml for each stack; all other arguments are stacks. One cell file serves
/// all stacks; several are paired in order. Without any, each stack that is a folder uses its own CELL.toml.
/// \throws ConfigError if no stack is named, or a stack has no cell file
StacksAndCells pair_stacks(const std::vector<std::filesystem::path>& arguments);

}  // namespace twincell::twin
