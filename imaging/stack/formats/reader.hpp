#pragma once
/// \file
/// One reader per file format. A new one is NAME.cpp in this folder, which defines NAME_reader, its test, and
/// its word in the list of readers.cpp.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/stack/frame_source.hpp"

namespace twincell::frames {

/// What a reader sees before it says "mine".
struct Head {
  std::filesystem::path file;
  std::string extension;            ///< in lower case, with its dot
  std::vector<std::uint8_t> bytes;  ///< the first ones, up to kHeadBytes; never none

  [[nodiscard]] bool starts_with(std::string_view magic, std::size_t at = 0) const;
};
inline constexpr std::size_t kHeadBytes = 4096;

/// \throws InputError if the file cannot be opened, is no regular file, or is empty
Head head_of(const std::filesystem::path& file);

/// A file format.
struct Reader {
  std::string_view extensions;  ///< for messages: ".tif .tiff"
  /// Whether the file is of this format: by its content where the format has a mark of its own.
  bool (*owns)(const Head& head);
  /// Opens a file of this format. \param inside dataset within the file; empty but for "file.h5:/path"
  std::unique_ptr<FrameSource> (*open)(const std::filesystem::path& file, const std::string& inside);
};

/// All readers, in the order in which they are asked.
const std::vector<const Reader*>& readers();

/// The first reader that owns the file. \throws InputError if there is none
const Reader& reader_of(const Head& head);

/// A folder of pictures.
std::unique_ptr<FrameSource> open_folder(const std::filesystem::path& folder);

}  // namespace twincell::frames
