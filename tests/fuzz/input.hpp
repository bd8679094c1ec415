/// \file
/// Common code of the fuzz targets. An input may be refused with a message; it must not crash, hang, or
/// request memory out of proportion to its size.

#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
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

/// A file on disk, overwritten by each input. HDF5 needs it because it resolves links and does not find the
/// file behind /proc/self/fd.
class DiskFile {
 public:
  DiskFile() {
    const int descriptor = mkstemp(name_.data());
    if (descriptor < 0 || close(descriptor) != 0) std::abort();
  }
  DiskFile(const DiskFile&) = delete;
  DiskFile& operator=(const DiskFile&) = delete;
  ~DiskFile() { unlink(name_.c_str()); }
  [[nodiscard]] std::filesystem::path write(const std::uint8_t* data, std::size_t n) const {
    std::ofstream(name_, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(n));
    return name_;
  }

 private:
  std::string name_ = "/dev/shm/twincell-fuzz-XXXXXX";
};

/// Calls `read`, which may refuse its input by an Error with a message. Any other exception ends the program,
/// which the fuzzer reports.
template <class Read>
void accept_or_refuse(const Read& read) {
  try {
    read();
  } catch (const Error& e) {
    if (std::string_view(e.what()).empty()) std::abort();
  }
}

}  // namespace twincell::fuzz
