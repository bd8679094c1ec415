#pragma once
/// \file
/// Outputs that exist whole or not at all: write beside the final name, rename at the end. A file is on the
/// disk before it gets its name, so that this holds for a machine that loses its power too. What an output
/// may replace: output_rules.hpp.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/output_kind.hpp"
#include "core/temporary_files.hpp"

namespace twincell {

/// Reserves a temporary file or folder beside an output. `commit` gives it its name, or copies it to standard
/// output where that is the output (output_rules.hpp); a destructor without a commit deletes it. A folder
/// that exists is replaced as far as its manifest lists it: other files stay.
class AtomicPath {
 public:
  /// \throws ConfigError as require_output; if another process writes the same output; if nothing can be
  /// written beside it
  AtomicPath(const std::filesystem::path& final_path, Product product);
  AtomicPath(AtomicPath&& other) noexcept;
  AtomicPath& operator=(AtomicPath&&) = delete;
  AtomicPath(const AtomicPath&) = delete;
  AtomicPath& operator=(const AtomicPath&) = delete;
  ~AtomicPath();

  /// Where to write: an empty file, with the output's extension, or an empty folder.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }
  /// What it will be called, as it was given.
  [[nodiscard]] const std::filesystem::path& final() const { return given_; }
  /// Renames part to final. \throws RunError naming the path; where something that may not be replaced has
  /// appeared meanwhile, the finished output keeps a name beside it that the sentence says
  void commit();
  /// Renames part to another name in the same folder (a run that failed keeps its frames under a name that
  /// says so). The rules for what may be replaced hold for that name too.
  void commit_as(const std::filesystem::path& other_name);

 private:
  void place_file(const std::filesystem::path& target);
  void print();
  void place_folder(const std::filesystem::path& target);
  [[noreturn]] void give_way(const std::filesystem::path& target, const std::string& obstacle);

  std::filesystem::path given_;  ///< as the user said it
  std::filesystem::path final_;  ///< absolute, links resolved
  Product product_;
  std::optional<OutputLock> lock_;
  std::filesystem::path part_;
  bool open_ = true;
};

/// Writes `text` as a whole file. A file that exists is replaced as AtomicPath says. \throws ConfigError,
/// RunError
void write_text_file(const std::filesystem::path& path, const std::string& text,
                     const Product& product = Product::part());

/// Largest text file that is read, bytes: a table of ten million beads has less.
inline constexpr std::uintmax_t kLargestText = std::uintmax_t{4} << 30;

/// Reads a whole regular file. Devices, pipes and sockets are refused, since they may never end.
/// \param most bytes that the file may have
/// \throws InputError if it is missing, no regular file, larger than `most`, or unreadable
std::string read_text_file(const std::filesystem::path& path, std::uintmax_t most = kLargestText);

}  // namespace twincell
