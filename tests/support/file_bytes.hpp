#pragma once
/// \file
/// The contents of a file that a test compares.

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace twincell {

/// All bytes of a file; empty if it cannot be read.
inline std::string bytes_of(const std::filesystem::path& file) {
  std::ostringstream all;
  all << std::ifstream(file, std::ios::binary).rdbuf();
  return all.str();
}

}  // namespace twincell
