#pragma once
/// \file
/// Random access to a file. Offsets and sizes are validated against the file size before memory is allocated.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace twincell::imaging::frames {

/// \throws InputError always: "FILE: complaint"
/// \throws InputError always, naming the file
[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& complaint);

/// Text from a file in quotes, for a message: its first 120 characters, with '?' for characters that are not
/// printable ASCII.
std::string in_quotes(std::string_view text);

/// Unsigned integer in the `n` <= 8 bytes at `b`.
std::uint64_t number_at(const std::uint8_t* b, std::size_t n, bool big_first);

/// Random-access reader, little-endian by default. Every read names the item that it reads, so that the error
/// for a truncated file is "is truncated: WHAT ends at byte A, the file at byte B."
class ByteFile {
 public:
  /// \throws InputError if it cannot be opened or is not a regular file
  explicit ByteFile(std::filesystem::path file);

  [[nodiscard]] const std::filesystem::path& path() const { return file_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// \throws InputError if [at, at + n) is not inside the file
  void require(std::uint64_t at, std::uint64_t n, const std::string& what) const;
  /// Reads n bytes from byte `at` on.
  /// \param what name of the part of the file, for messages
  /// \throws InputError as require()
  void read(std::uint64_t at, std::uint64_t n, void* to, const std::string& what) const;
  /// The same as a vector.
  [[nodiscard]] std::vector<std::uint8_t> bytes(std::uint64_t at, std::uint64_t n,
                                                const std::string& what) const;
  /// Unsigned integer in n <= 8 bytes.
  [[nodiscard]] std::uint64_t number(std::uint64_t at, std::size_t n, const std::string& what,
                                     bool big_first = false) const;
  /// Unsigned integer of 4 bytes, lowest first.
  [[nodiscard]] std::uint32_t u32(std::uint64_t at, const std::string& what) const {
    return static_cast<std::uint32_t>(number(at, 4, what));
  }
  /// Signed integer of 4 bytes, lowest first.
  [[nodiscard]] std::int32_t i32(std::uint64_t at, const std::string& what) const {
    return static_cast<std::int32_t>(u32(at, what));
  }
  /// IEEE number of 8 bytes, lowest first.
  [[nodiscard]] double f64(std::uint64_t at, const std::string& what) const;
  [[noreturn]] void refuse(const std::string& complaint) const { frames::refuse(file_, complaint); }

 private:
  std::filesystem::path file_;
  mutable std::ifstream in_;
  std::uint64_t size_ = 0;
};

/// Rejects a frame size that no camera produces, or whose memory is out of proportion to the file. Accepted
/// are sides of 1 .. 2^20 pixels, at most 2^28 pixels, and at most 64 MiB or 2000 times the file size (the
/// ratio to which a uniform picture compresses).
/// \param bytes_per_pixel of the decoded frame
/// \throws InputError
void require_plausible_size(const std::filesystem::path& file, std::uint64_t width, std::uint64_t height,
                            std::uint64_t bytes_per_pixel, std::uint64_t file_size);

}  // namespace twincell::imaging::frames
