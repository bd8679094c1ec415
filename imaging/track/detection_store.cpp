#include "imaging/track/detection_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <type_traits>

#include "core/error.hpp"
#include "core/temporary_files.hpp"

namespace twincell::imaging {

static_assert(std::is_trivially_copyable_v<TrackedBead>);

void DetectionStore::Close::operator()(int* descriptor) const {
  ::close(*descriptor);
  delete descriptor;
}

DetectionStore::DetectionStore(const std::filesystem::path& folder)
    : folder_(folder.empty() ? folder_for_temporaries() : folder) {
  std::string name = (folder_ / "twincell-beads-XXXXXX").string();
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0)
    throw RunError(
        fmt::format("{}: cannot create a temporary file here: {}.", folder_.string(), std::strerror(errno)));
  ::unlink(name.c_str());
  file_.reset(new int(descriptor));
}

void DetectionStore::append(std::span<const TrackedBead> beads) {
  const std::uint64_t before = ends_.empty() ? 0 : ends_.back();
  const char* data = reinterpret_cast<const char*>(beads.data());
  auto offset = static_cast<off_t>(before * sizeof(TrackedBead));
  for (std::size_t left = beads.size_bytes(); left > 0;) {
    const ssize_t wrote = ::pwrite(*file_, data, left, offset);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0)
      throw RunError(fmt::format(
          "{}: the temporary file of the located beads in this folder, which is that of "
          "the output, cannot be written at frame {} ({}).",
          std::filesystem::weakly_canonical(folder_).string(), ends_.size(), std::strerror(errno)));
    data += wrote;
    offset += wrote;
    left -= static_cast<std::size_t>(wrote);
  }
  ends_.push_back(before + beads.size());
}

std::vector<TrackedBead> DetectionStore::operator[](std::size_t f) const {
  const std::uint64_t begin = f == 0 ? 0 : ends_[f - 1];
  std::vector<TrackedBead> beads(ends_[f] - begin);
  char* data = reinterpret_cast<char*>(beads.data());
  auto offset = static_cast<off_t>(begin * sizeof(TrackedBead));
  for (std::size_t left = beads.size() * sizeof(TrackedBead); left > 0;) {
    const ssize_t got = ::pread(*file_, data, left, offset);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0)
      throw RunError(fmt::format("{}: the beads of frame {} cannot be read back: {}.", folder_.string(), f,
                                 got == 0 ? "the file is too short" : std::strerror(errno)));
    data += got;
    offset += got;
    left -= static_cast<std::size_t>(got);
  }
  return beads;
}

}  // namespace twincell::imaging
