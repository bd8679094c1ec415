#pragma once
/// \file
/// The endings of names by which a file in a folder counts as a frame of a stack.

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>

namespace twincell {

/// Endings in lower case, separated by blanks.
inline constexpr const char* kPictureEndings = ".png .jpg .jpeg .bmp .pgm";
inline constexpr const char* kTiffEndings = ".tif .tiff";

/// Whether a reader of a folder of pictures would take the file for one of the frames.
inline bool is_named_as_picture(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const std::string_view all : {kPictureEndings, kTiffEndings})
    for (std::size_t at = 0; at < all.size();) {
      const std::size_t end = std::min(all.find(' ', at), all.size());
      if (all.substr(at, end - at) == ending) return true;
      at = end + 1;
    }
  return false;
}

}  // namespace twincell
