#pragma once
/// \file
/// Formats of other programs in which trajectories are written and from which they are read. A format is one
/// file in this folder and one word in formats.cpp. docs/formats.md states what each of them carries.

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "trajectory/foreign/foreign_frame.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// How a file is read that does not say it itself.
struct ReadOptions {
  int dimension = 2;
  /// Names of the columns of a table: quantity -> name in the file, where they differ.
  std::map<std::string, std::string> columns;
  bool y_up = false;  ///< y of a table increases upwards; otherwise downwards
};

/// What a writer knows before the first frame.
struct WriteOptions {
  int dimension = 2;
  ForeignColumns columns;
  std::string length_unit, time_unit;  ///< "sigma", "t0" or "mm", "s"
  std::string stem;                    ///< name of the output without its extension
};

/// A format of another program.
struct ForeignFormat {
  std::string_view word;        ///< of --to and --from
  std::string_view extensions;  ///< by which a file is recognised, separated by blanks; the first is written
  std::string_view help;        ///< one line: what it is and which programs read it
  /// Null: the format is only written.
  std::unique_ptr<ForeignReader> (*open)(const std::filesystem::path& file, const ReadOptions& options);
  /// Null: the format is only read.
  std::unique_ptr<ForeignWriter> (*create)(const std::filesystem::path& part, const WriteOptions& options);
  bool folder = false;   ///< the output is a folder with a file for each frame
  bool numbers = false;  ///< it carries ForeignColumns::numbers
  /// Lines, one of which is in the first 4 KiB of every file that twincell writes in this format, and none in
  /// the files of other programs; empty: the format has no place for it.
  std::string_view mark;
  bool mark_is_first_line = false;     ///< the first line is one of them, as a whole
  Origin source = Origin::simulation;  ///< TrajectoryInfo::source of what is read
};

/// All formats, in the order of the help.
const std::vector<const ForeignFormat*>& foreign_formats();

/// The words of the formats that are written, separated by ", ".
std::string written_formats();
/// The words of the formats that are read, separated by ", ".
std::string read_formats();

/// The format with this word.
/// \throws ConfigError at `option` with all words if there is none
const ForeignFormat& foreign_format(const std::string& word, const std::string& option);

/// The format that is read from files of this extension, ".gsd", in any case; null if there is none.
const ForeignFormat* format_of_extension(std::string extension);

/// The format that is read and has this file's extension; for any other extension LAMMPS's dump, if the file
/// begins as one.
/// \throws InputError if it cannot be read, ConfigError at --format if no format follows
const ForeignFormat& format_of_file(const std::filesystem::path& file);

}  // namespace twincell
