/// \file
/// What the entry points of the fuzzers share. An input may be refused in a sentence; it must not crash,
/// hang, or ask for memory that its size cannot explain.

#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace twincell::fuzz {

/// A file in memory.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t n) : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || write(descriptor_, data, n) != static_cast<ssize_t>(n)) std::abort();
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor_); }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// Calls `read`, which may refuse its input by an Error that says something. Any other exception ends the
/// program, which the fuzzer reports.
template <class Read>
void accept_or_refuse(const Read& read) {
  try {
    read();
  } catch (const Error& e) {
    if (std::string_view(e.what()).empty()) std::abort();
  }
}

}  // namespace twincell::fuzz
