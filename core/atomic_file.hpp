#pragma once
/// \file
/// Atomic output: write to a temporary name in the output's folder and rename at the end, so that an output
/// is complete or absent. A file, or every file and folder of a folder output, is synced to disk before the
/// rename, so that this also applies after a power failure. output_rules.hpp states what an output may
/// replace.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/output_kind.hpp"
#include "core/temporary_files.hpp"

namespace twincell {

/// A temporary file or folder in the folder of an output. `commit` renames it to its final name, or copies it
/// to standard output if that is the output (output_rules.hpp). Without a commit, the destructor deletes it.
/// In an existing output folder, only the files that its manifest lists are replaced; other files stay.
class AtomicPath {
 public:
  /// \throws ConfigError as require_output; if another process writes the same output; if no temporary file
  /// can be created in the output's folder
  AtomicPath(const std::filesystem::path& final_path, Product product);
  AtomicPath(AtomicPath&& other) noexcept;
  AtomicPath& operator=(AtomicPath&&) = delete;
  AtomicPath(const AtomicPath&) = delete;
  AtomicPath& operator=(const AtomicPath&) = delete;
  ~AtomicPath();

  /// Path to write to: an empty file with the output's extension, or an empty folder.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }
  /// Final path of the output, as the caller gave it.
  [[nodiscard]] const std::filesystem::path& final() const { return given_; }
  /// Renames `part()` to `final()`.
  /// \throws RunError naming the path. If something that must not be replaced has appeared there during the
  /// run, or the system refuses the name, the finished output stays in the same folder as NAME.twincell-K,
  /// which the message states.
  void commit();
  /// Renames `part()` to another name in the same folder, for example to keep the frames of a failed run
  /// under a name that marks them as such. Only a file of the kind `product` is replaced there; if another
  /// one is in the way, the output gets the name NAME.twincell-K. \returns the name that it has now
  std::filesystem::path commit_as(const std::filesystem::path& other_name, const Product& product);

 private:
  void place_file(const std::filesystem::path& target);
  void print();
  void place_folder(const std::filesystem::path& target);
  [[noreturn]] void give_way(const std::filesystem::path& target, const std::string& obstacle);
  /// Renames `part()` to NAME.twincell-K, the first name that is free. \returns it; empty if there is none
  std::filesystem::path keep_beside(const std::filesystem::path& target);
  /// Keeps the output so. \throws RunError with `why` and the name
  [[noreturn]] void fail_and_keep(const std::filesystem::path& target, const std::string& why);

  std::filesystem::path given_;  ///< as the user wrote it
  std::filesystem::path final_;  ///< absolute, links resolved
  Product product_;
  std::optional<OutputLock> lock_;
  std::filesystem::path part_;
  bool open_ = true;
};

/// A message in which outputs that were not finished have their final names, as the caller gave them, in
/// place of the temporary ones.
std::string in_final_names(std::string message);

/// Writes `text` to a file atomically. An existing file is replaced under the rules of AtomicPath.
/// \throws ConfigError, RunError as AtomicPath
void write_text_file(const std::filesystem::path& path, const std::string& text,
                     const Product& product = Product::part());

/// Largest text file that is read, bytes. A table of ten million beads is smaller.
inline constexpr std::uintmax_t kLargestText = std::uintmax_t{4} << 30;

/// Reads a whole regular file. Devices, pipes and sockets are rejected, since reading them may never end.
/// \param most maximum size of the file, bytes
/// \throws InputError if it is missing, not a regular file, larger than `most`, or unreadable
std::string read_text_file(const std::filesystem::path& path, std::uintmax_t most = kLargestText);

}  // namespace twincell
