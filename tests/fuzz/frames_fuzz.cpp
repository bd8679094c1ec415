// Fuzz targets: the readers of frame stacks, on arbitrary bytes. There is one program per format;
// TWINCELL_FUZZ_READER is its name. An input may be refused with a message; it must not crash, hang, or
// request memory out of proportion to its size.

#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "imaging/stack/formats/reader.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/support/temporary_folder.hpp"

// HDF5 1.10 itself leaks some bytes when it refuses a damaged file.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

namespace twincell::imaging::frames {
extern const Reader cine_reader, seq_reader, mrf_reader, mraw_reader, tiff_reader, picture_reader,
    hdf5_reader;
}

namespace {

namespace fs = std::filesystem;
using namespace twincell;
using Source = std::unique_ptr<imaging::FrameSource>;

constexpr std::string_view kFormat = TWINCELL_FUZZ_READER;

/// The reader of a single-file format.
const imaging::frames::Reader& reader() {
  using namespace imaging::frames;
  return kFormat == "cine"      ? cine_reader
         : kFormat == "seq"     ? seq_reader
         : kFormat == "mrf"     ? mrf_reader
         : kFormat == "mraw"    ? mraw_reader
         : kFormat == "picture" ? picture_reader
         : kFormat == "hdf5"    ? hdf5_reader
                                : tiff_reader;
}

/// Writes a .cih and its .mraw, whose names must match: the input up to its first NUL, and the rest.
fs::path write_photron_pair(const fs::path& folder, std::string_view all) {
  const std::size_t cut = std::min(all.find('\0'), all.size());
  std::ofstream(folder / "a.cih", std::ios::binary) << all.substr(0, cut);
  std::ofstream(folder / "a.mraw", std::ios::binary) << all.substr(std::min(cut + 1, all.size()));
  return folder / "a.mraw";
}

/// Writes up to eight files. Each is a byte that selects its extension, two bytes for its length (low byte
/// first), and its content.
void write_folder(const fs::path& folder, std::string_view all) {
  constexpr std::string_view kExtensions[] = {".png", ".tif", ".jpg",  ".bmp",
                                              ".pgm", ".txt", ".cine", ".PNG"};
  for (int k = 0; k < 8 && all.size() >= 3; ++k) {
    const auto byte = [&](std::size_t i) {
      return static_cast<std::size_t>(static_cast<unsigned char>(all[i]));
    };
    const std::string name = "frame_" + std::to_string(k) + std::string(kExtensions[byte(0) % 8]);
    const std::size_t n = std::min(byte(1) + 256 * byte(2), all.size() - 3);
    std::ofstream(folder / name, std::ios::binary) << all.substr(3, n);
    all.remove_prefix(3 + n);
  }
}

void read_stack(const std::function<Source()>& open) {
  try {
    const Source source = open();
    if (!source) return;
    (void)source->info();
    cv::Mat frame;
    // A small file may validly contain millions of frames of one pixel.
    for (int i = 0; i < 64 && source->next(frame); ++i) {
      if (frame.empty() || frame.channels() != 1) std::abort();
      (void)source->time_s();
      (void)source->current();
    }
  } catch (const InputError& e) {
    // The message is one line that names the file.
    if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

/// Opens a file as `open_frames` does: a file of another format is left to another reader.
Source open_owned(const fs::path& file) {
  return reader().owns(imaging::frames::head_of(file)) ? reader().open(file, "") : nullptr;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  if (kFormat == "mraw" || kFormat == "folder") {
    static const TemporaryFolder folder;
    const fs::path& place = folder.path();
    for (const auto& entry : fs::directory_iterator(place)) fs::remove(entry.path());
    if (kFormat == "folder") write_folder(place, all);
    read_stack([&] {
      return kFormat == "folder" ? imaging::frames::open_folder(place)
                                 : reader().open(write_photron_pair(place, all), "");
    });
  } else if (kFormat == "hdf5") {
    static const fuzz::DiskFile file;
    const fs::path place = file.write(data, size);
    read_stack([&] { return open_owned(place); });
    if (H5Fget_obj_count(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_ALL) != 0) std::abort();
  } else if (kFormat == "picture") {
    const fuzz::MemoryFile file(data, size);
    read_stack([&] { return open_owned(file.path()); });
  } else {
    const fuzz::MemoryFile file(data, size);
    read_stack([&] { return reader().open(file.path(), ""); });
  }
  return 0;
}
