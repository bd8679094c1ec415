#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "core/error.hpp"
#include "trajectory/foreign/format.hpp"
#include "trajectory/foreign/text_file.hpp"

namespace twincell {

extern const ForeignFormat extended_xyz_format, lammps_dump_format, vtk_format, gsd_format, bead_table_format,
    track_mate_format, isbi_format, mat_format;

const std::vector<const ForeignFormat*>& foreign_formats() {
  static const std::vector<const ForeignFormat*> all = {
      &extended_xyz_format, &lammps_dump_format, &vtk_format,  &gsd_format,
      &bead_table_format,   &track_mate_format,  &isbi_format, &mat_format};
  return all;
}

namespace {

template <class Has>
std::string words_where(Has has) {
  std::string words;
  for (const ForeignFormat* format : foreign_formats())
    if (has(*format)) words += fmt::format("{}{}", words.empty() ? "" : ", ", format->word);
  return words;
}

/// Whether the first line is that of a text dump of LAMMPS. \throws InputError as open_input
bool begins_as_dump(const std::filesystem::path& file) {
  constexpr std::string_view kBegin = "ITEM:";
  std::string begin(kBegin.size(), '\0');
  open_input(file).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == kBegin;
}

}  // namespace

std::string written_formats() {
  return words_where([](const ForeignFormat& f) { return f.create != nullptr; });
}
std::string read_formats() {
  return words_where([](const ForeignFormat& f) { return f.open != nullptr; });
}

const ForeignFormat& foreign_format(const std::string& word, const std::string& option) {
  for (const ForeignFormat* format : foreign_formats())
    if (format->word == word) return *format;
  throw ConfigError({"", 0, 0, option}, fmt::format("there is no format '{}'; there are: {}.", word,
                                                    words_where([](const ForeignFormat&) { return true; })));
}

const ForeignFormat* format_of_extension(std::string extension) {
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension.empty()) return nullptr;
  for (const ForeignFormat* format : foreign_formats())
    if (format->open != nullptr &&
        fmt::format("{} ", format->extensions).find(extension + " ") != std::string::npos)
      return format;
  return nullptr;
}

const ForeignFormat& format_of_file(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (const ForeignFormat* format = format_of_extension(extension)) return *format;
  if (begins_as_dump(file)) return lammps_dump_format;
  constexpr std::array<std::string_view, 5> kCompressed = {".gz", ".bz2", ".xz", ".zst", ".zip"};
  if (std::find(kCompressed.begin(), kCompressed.end(), extension) != kCompressed.end())
    throw InputError({file.string(), 0, 0, ""}, "the file is compressed; unpack it first.");
  throw ConfigError({file.string(), 0, 0, "--format"},
                    fmt::format("is needed, as no format has the ending of this file, and it does not begin "
                                "with 'ITEM:' as a dump of LAMMPS does; give one of {}.",
                                read_formats()));
}

}  // namespace twincell
