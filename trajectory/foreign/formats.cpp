#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "core/error.hpp"
#include "trajectory/foreign/format.hpp"

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
std::string words_of(Has has) {
  std::string words;
  for (const ForeignFormat* format : foreign_formats())
    if (has(*format)) words += fmt::format("{}{}", words.empty() ? "" : ", ", format->word);
  return words;
}

}  // namespace

std::string written_formats() {
  return words_of([](const ForeignFormat& f) { return f.create != nullptr; });
}
std::string read_formats() {
  return words_of([](const ForeignFormat& f) { return f.open != nullptr; });
}

const ForeignFormat& foreign_format(const std::string& word, const std::string& option) {
  for (const ForeignFormat* format : foreign_formats())
    if (format->word == word) return *format;
  throw ConfigError({"", 0, 0, option}, fmt::format("there is no format '{}'; there are: {}.", word,
                                                    words_of([](const ForeignFormat&) { return true; })));
}

const ForeignFormat& format_of_file(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!extension.empty())
    for (const ForeignFormat* format : foreign_formats())
      if (format->open != nullptr &&
          fmt::format("{} ", format->extensions).find(extension + " ") != std::string::npos)
        return *format;
  return lammps_dump_format;
}

}  // namespace twincell
