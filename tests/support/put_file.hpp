#pragma once
/// \file
/// Writes a file of a test, over whatever is there. The program's own write_text_file refuses that.

#include <filesystem>
#include <fstream>
#include <string>

namespace twincell {

inline void put_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
}

}  // namespace twincell
