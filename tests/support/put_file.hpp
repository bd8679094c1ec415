#pragma once
/// \file
/// Writes a test file and replaces any existing one, which the program's own write_text_file refuses to do.

#include <filesystem>
#include <fstream>
#include <string>

namespace twincell {

inline void put_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
}

}  // namespace twincell
