#pragma once
/// \file
/// The kinds of files and folders that this program writes, and how an existing file is recognised as one of
/// them. Without --force, a file is replaced only if it is a product of the same kind.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace twincell {

/// A kind of output.
struct Product {
  /// How a file of this kind is recognised.
  enum class Sign {
    none,             ///< it is not: an existing file never counts as a product
    h5md_creator,     ///< HDF5, /h5md/creator@name = "twincell"; /twincell@source = `mark` if both are stated
    imported,         ///< as h5md_creator, and neither from a scene nor from frames
    failed_run,       ///< as h5md_creator, and /twincell@failed
    results_group,    ///< HDF5 with /results and /provenance
    checkpoint,       ///< HDF5 with the root attribute "sha256"
    first_line,       ///< the first line is `mark`
    headings,         ///< the first line is one of the lines of `mark`
    beginning,        ///< the text begins with `mark`
    ending,           ///< the bytes end with `mark`
    head,             ///< the first 4 KiB hold one of the lines of `mark`
    json_member,      ///< a JSON object with the member `mark`
    picture_software  ///< PNG whose text chunk "Software" is "twincell"
  };
  std::string name;  ///< with its article, for messages: "a trajectory"
  Sign sign = Sign::none;
  std::string mark;
  bool folder = false;
  /// For a folder: several runs write into it, and the files of earlier runs stay.
  bool shared = false;
  /// For a folder: names of files that are certainly written. Others of these names are refused before the
  /// work.
  std::vector<std::string> files = {};

  [[nodiscard]] bool is_trajectory() const { return sign == Sign::h5md_creator || sign == Sign::imported; }
  /// Whether the product is a single text file, which can go to standard output.
  [[nodiscard]] bool is_text() const {
    return !folder && (sign == Sign::first_line || sign == Sign::beginning || sign == Sign::json_member);
  }

  /// \param source "simulation" or "experiment": one never replaces the other; empty: of any source
  static Product trajectory(const std::string& source = {});
  /// A trajectory of another program; it does not replace one of `simulate` or `track`.
  static Product imported_trajectory() {
    return {.name = "an imported trajectory", .sign = Sign::imported, .mark = {}};
  }
  /// The frames of a run that failed; no other trajectory counts as one.
  static Product failed_run() {
    return {.name = "the frames of a failed run", .sign = Sign::failed_run, .mark = {}};
  }
  static Product results() { return {.name = "a results file", .sign = Sign::results_group, .mark = {}}; }
  static Product checkpoint() { return {.name = "a checkpoint", .sign = Sign::checkpoint, .mark = {}}; }
  /// A CSV table with this header line.
  static Product table(const std::string& heading);
  /// A text that begins with `beginning`.
  static Product text(std::string name, std::string beginning) {
    return {.name = std::move(name), .sign = Sign::beginning, .mark = std::move(beginning)};
  }
  /// A JSON object with the member `member`.
  static Product json(std::string name, std::string member) {
    return {.name = std::move(name), .sign = Sign::json_member, .mark = std::move(member)};
  }
  static Product picture() { return {.name = "a picture", .sign = Sign::picture_software, .mark = {}}; }
  /// A film whose last bytes are kFilmMark, in a box that players skip.
  static Product film() { return {.name = "a film", .sign = Sign::ending, .mark = kFilmMark}; }
  static constexpr const char* kFilmMark = "film by twincell";
  /// A file in a folder that the program owns, such as a folder that is being written.
  static Product part() { return {.name = "a part", .sign = Sign::none, .mark = {}}; }
  /// The folder of a sweep or a reproduction: many runs, written by any number of processes.
  static Product runs() { return shared_folder("a folder of runs"); }
  /// A folder that one run writes as a whole.
  static Product whole_folder(std::string name, std::vector<std::string> files = {}) {
    return {
        .name = std::move(name), .sign = Sign::none, .mark = {}, .folder = true, .files = std::move(files)};
  }
  /// A folder into which several runs write.
  static Product shared_folder(std::string name, std::vector<std::string> files = {}) {
    return {.name = std::move(name),
            .sign = Sign::none,
            .mark = {},
            .folder = true,
            .shared = true,
            .files = std::move(files)};
  }
};

/// Whether an existing regular file is of this kind. False for an unreadable file.
bool is_product(const std::filesystem::path& file, const Product& product);

}  // namespace twincell
