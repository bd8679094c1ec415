#pragma once
/// \file
/// Outputs that exist whole or not at all: write beside the final name, rename at the end. A file is on the
/// disk before it gets its name, so that this holds for a machine that loses its power too.

#include <cstdint>
#include <filesystem>
#include <string>

namespace twincell {

/// Reserves `NAME.part` for an output that will be called NAME. `commit` renames; a destructor without a
/// commit deletes. Works for a file and for a folder (a folder of that name is replaced as a whole by
/// `commit`).
class AtomicPath {
 public:
  enum class Kind { file, folder };

  /// \throws ConfigError if the parent folder is missing or cannot be written to, or if NAME is of the other
  /// kind.
  explicit AtomicPath(std::filesystem::path final_path, Kind kind = Kind::file);
  AtomicPath(AtomicPath&& other) noexcept;
  AtomicPath& operator=(AtomicPath&&) = delete;
  AtomicPath(const AtomicPath&) = delete;
  AtomicPath& operator=(const AtomicPath&) = delete;
  ~AtomicPath();

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }
  /// What it will be called.
  [[nodiscard]] const std::filesystem::path& final() const { return final_; }
  /// Renames part to final. \throws RunError naming the path.
  void commit();
  /// Renames part to another name in the same folder (a run that failed keeps its frames under a name that
  /// says so).
  void commit_as(const std::filesystem::path& other_name);

 private:
  std::filesystem::path final_;
  std::filesystem::path part_;
  bool open_ = true;
};

/// Writes `text` as a whole file. \throws ConfigError, RunError
void write_text_file(const std::filesystem::path& path, const std::string& text);

/// Largest text file that is read, bytes: a table of ten million beads has less.
inline constexpr std::uintmax_t kLargestText = std::uintmax_t{4} << 30;

/// Reads a whole regular file. Devices, pipes and sockets are refused, since they may never end.
/// \param most bytes that the file may have
/// \throws InputError if it is missing, no regular file, larger than `most`, or unreadable
std::string read_text_file(const std::filesystem::path& path, std::uintmax_t most = kLargestText);

}  // namespace twincell
