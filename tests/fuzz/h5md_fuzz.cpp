// Fuzz target: a trajectory, read frame by frame and validated.

#include <hdf5.h>

#include <algorithm>

#include "tests/fuzz/input.hpp"
#include "trajectory/formats/h5md_file.hpp"

// HDF5 1.10 itself leaks some bytes when it refuses a damaged file. HDF5 objects that the program failed to
// close are counted below.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  static const fuzz::DiskFile file;
  const std::filesystem::path path = file.write(data, size);
  fuzz::accept_or_refuse([&] {
    const H5mdReader reader(path);
    Frame frame;
    for (std::size_t i = 0; i < std::min<std::size_t>(reader.n_frames(), 64); ++i) reader.read(i, frame);
  });
  fuzz::accept_or_refuse([&] { (void)validate_h5md(path); });
  if (H5Fget_obj_count(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_ALL) != 0) std::abort();
  return 0;
}
