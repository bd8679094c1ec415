#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>

#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/reader.hpp"

// The list of readers. Formats with a signature come first, then the format that only its name identifies
// (mraw), and last the reader that tries any content (video).
#define TWINCELL_READERS(EACH) \
  EACH(tiff) EACH(picture) EACH(cine) EACH(seq) EACH(mrf) EACH(hdf5) EACH(mraw) EACH(video)

namespace twincell::imaging::frames {

#define TWINCELL_DECLARE(name) extern const Reader name##_reader;
TWINCELL_READERS(TWINCELL_DECLARE)
#undef TWINCELL_DECLARE

const std::vector<const Reader*>& readers() {
#define TWINCELL_ADDRESS(name) &name##_reader,
  static const std::vector<const Reader*> list = {TWINCELL_READERS(TWINCELL_ADDRESS)};
#undef TWINCELL_ADDRESS
  return list;
}

bool Head::starts_with(std::string_view magic, std::size_t at) const {
  return bytes.size() >= at + magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

Head head_of(const std::filesystem::path& file) {
  const ByteFile in(file);
  if (in.size() == 0) in.refuse("is empty.");
  Head head{.file = file, .extension = file.extension().string(), .bytes = {}};
  std::transform(head.extension.begin(), head.extension.end(), head.extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  head.bytes = in.bytes(0, std::min<std::uint64_t>(kHeadBytes, in.size()), "its head");
  return head;
}

namespace {

/// Name of a format of pictures that is not read; empty for other files. The video reader would take them for
/// videos.
std::string_view unread_picture(const Head& head) {
  if (head.starts_with("RIFF") && head.starts_with("WEBP", 8)) return "WebP";
  if (head.starts_with("GIF8")) return "GIF";
  if (head.starts_with({"\0\0\0\x0cjP  ", 8}) || head.starts_with({"\xff\x4f\xff\x51", 4}))
    return "JPEG 2000";
  if (head.starts_with("avif", 8)) return "AVIF";
  if (head.starts_with("heic", 8) || head.starts_with("mif1", 8)) return "HEIC";
  for (const std::string_view colour : {"P1", "P3", "P4", "P6"})
    if (head.starts_with(colour) && head.bytes.size() > 2 && std::isspace(head.bytes[2]) != 0)
      return colour == "P1" || colour == "P4" ? "PBM" : "PPM";
  return {};
}

}  // namespace

const Reader& reader_of(const Head& head) {
  if (const std::string_view name = unread_picture(head); !name.empty())
    refuse(head.file, fmt::format("is a {} picture, a format that is not read; save the frames as PNG, TIFF, "
                                  "JPEG, BMP or PGM.",
                                  name));
  std::string known;
  for (const Reader* reader : readers()) {
    if (reader->owns(head)) return *reader;
    known += fmt::format("{}{}", known.empty() ? "" : " ", reader->extensions);
  }
  const bool named_so =
      !head.extension.empty() && (known + " ").find(head.extension + " ") != std::string::npos;
  if (named_so)
    refuse(head.file, fmt::format("is not what its name says: its content is neither that of a {} file nor "
                                  "that of any other readable stack.",
                                  head.extension));
  refuse(head.file,
         fmt::format(
             "is not a stack of frames: a folder of pictures is expected, or a file of one of the kinds {}.",
             known));
}

}  // namespace twincell::imaging::frames
