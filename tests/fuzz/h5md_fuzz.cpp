// A trajectory: read frame by frame, and validated.

#include <hdf5.h>

#include <algorithm>
#include <fstream>

#include "tests/fuzz/input.hpp"
#include "trajectory/formats/h5md_file.hpp"

// HDF5 1.10 itself loses some bytes when it refuses a damaged file. What of it we would have to close is
// counted below.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  // HDF5 resolves links, and does not find the file behind /proc/self/fd.
  struct File {
    std::string name = "/dev/shm/twincell-fuzz-XXXXXX";
    File() {
      const int descriptor = mkstemp(name.data());
      if (descriptor < 0 || close(descriptor) != 0) std::abort();
    }
    ~File() { unlink(name.c_str()); }
  };
  static const File file;
  const std::filesystem::path path = file.name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  fuzz::accept_or_refuse([&] {
    const H5mdReader reader(path);
    Frame frame;
    for (std::size_t i = 0; i < std::min<std::size_t>(reader.n_frames(), 64); ++i) reader.read(i, frame);
  });
  fuzz::accept_or_refuse([&] { (void)validate_h5md(path); });
  if (H5Fget_obj_count(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_ALL) != 0) std::abort();
  return 0;
}
