#pragma once
/// \file
/// SHA-256 (FIPS 180-4), piece by piece.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace twincell {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  void add(const void* data, std::size_t size);
  /// 64 hex digits of all that was added. Call once.
  [[nodiscard]] std::string hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// SHA-256 of a file's content as 64 hex digits; of a folder: of the names and digests of its files in order.
/// \throws InputError if it cannot be read
std::string sha256_of(const std::filesystem::path& path);

}  // namespace twincell
