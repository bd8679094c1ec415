#pragma once
/// \file
/// One reader per file format. To add a format, add NAME.cpp to this folder, which defines NAME_reader, add a
/// test, and add NAME to the list in readers.cpp.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging::frames {

/// Start of a file, from which a reader decides whether the file has its format.
struct Head {
  std::filesystem::path file;
  std::string extension;            ///< in lower case, with its dot
  std::vector<std::uint8_t> bytes;  ///< the first bytes, up to kHeadBytes; never empty

  /// Whether the bytes from `at` on are `magic`.
  [[nodiscard]] bool starts_with(std::string_view magic, std::size_t at = 0) const;
};
inline constexpr std::size_t kHeadBytes = 4096;

/// \throws InputError if the file cannot be opened, is not a regular file, or is empty
Head head_of(const std::filesystem::path& file);

/// A file format.
struct Reader {
  std::string_view extensions;  ///< for messages: ".tif .tiff"
  /// Whether the file has this format, judged by its content if the format has a signature.
  bool (*owns)(const Head& head);
  /// Opens a file of this format.
  /// \param inside dataset within the file; empty unless the stack is "file.h5:/path"
  std::unique_ptr<FrameSource> (*open)(const std::filesystem::path& file, const std::string& inside);
};

/// All readers, in the order in which they are tried.
const std::vector<const Reader*>& readers();

/// The first reader that owns the file.
/// \throws InputError if there is none
const Reader& reader_of(const Head& head);

/// Whether open_folder() takes a file for a picture, by its extension in small or capital letters.
bool is_picture_of_folder(const std::filesystem::path& file);
/// Opens a folder of pictures as a stack.
std::unique_ptr<FrameSource> open_folder(const std::filesystem::path& folder);

}  // namespace twincell::imaging::frames
