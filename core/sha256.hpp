#pragma once
/// \file
/// SHA-256 (FIPS 180-4), computed incrementally.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace twincell {

/// Digest of data that are added in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  /// Adds `size` bytes at `data`.
  /// \pre hex() was not called
  void add(const void* data, std::size_t size);
  /// Digest of all data added so far, as 64 hex digits. Call once.
  [[nodiscard]] std::string hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// SHA-256 as 64 hex digits: for a file, of its content; for a folder, of the names and digests of its files,
/// sorted by name and without subfolders.
/// \throws InputError if a file cannot be read
std::string sha256_of(const std::filesystem::path& path);

/// SHA-256 of a text, as 64 hex digits.
std::string sha256_of_text(const std::string& text);

}  // namespace twincell
