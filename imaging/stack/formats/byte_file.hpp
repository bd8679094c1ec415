#pragma once
/// \file
/// A file of which no byte beyond its end is believed.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace twincell::frames {

/// \throws InputError "FILE: complaint"
[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& complaint);

/// Text out of a file as a sentence may quote it: its first 120 characters, whatever is no plain one as '?'.
std::string in_quotes(std::string_view text);

/// Number in the first `n` <= 8 bytes at b.
std::uint64_t number_at(const std::uint8_t* b, std::size_t n, bool big_first);

/// Random access for reading. Little-endian unless said otherwise. Every read names what it reads, so that a
/// truncated file is refused in words: "is truncated: WHAT ends at byte A, the file at byte B."
class ByteFile {
 public:
  /// \throws InputError if it cannot be opened or is no regular file
  explicit ByteFile(std::filesystem::path file);

  [[nodiscard]] const std::filesystem::path& path() const { return file_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// \throws InputError if [at, at + n) is not inside the file
  void require(std::uint64_t at, std::uint64_t n, const std::string& what) const;
  void read(std::uint64_t at, std::uint64_t n, void* to, const std::string& what) const;
  [[nodiscard]] std::vector<std::uint8_t> bytes(std::uint64_t at, std::uint64_t n,
                                                const std::string& what) const;
  /// Number in n <= 8 bytes.
  [[nodiscard]] std::uint64_t number(std::uint64_t at, std::size_t n, const std::string& what,
                                     bool big_first = false) const;
  [[nodiscard]] std::uint32_t u32(std::uint64_t at, const std::string& what) const {
    return static_cast<std::uint32_t>(number(at, 4, what));
  }
  [[nodiscard]] std::int32_t i32(std::uint64_t at, const std::string& what) const {
    return static_cast<std::int32_t>(u32(at, what));
  }
  [[nodiscard]] double f64(std::uint64_t at, const std::string& what) const;
  [[noreturn]] void refuse(const std::string& complaint) const { frames::refuse(file_, complaint); }

 private:
  std::filesystem::path file_;
  mutable std::ifstream in_;
  std::uint64_t size_ = 0;
};

/// Refuses a picture that no camera takes, or that needs more memory than its file can explain: sides
/// 1 .. 2^20, at most 2^28 pixels, and at most 64 MiB or 2000 times the file (what a flat picture compresses
/// to). \param bytes_per_pixel of the decoded frame
void require_plausible_size(const std::filesystem::path& file, std::uint64_t width, std::uint64_t height,
                            std::uint64_t bytes_per_pixel, std::uint64_t file_size);

}  // namespace twincell::frames
