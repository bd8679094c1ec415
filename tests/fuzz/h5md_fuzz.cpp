// A trajectory: read frame by frame, and validated.

#include <algorithm>

#include "analysis/trajectory/h5md_file.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  const fuzz::MemoryFile file(data, size);
  fuzz::accept_or_refuse([&] {
    const H5mdReader reader(file.path());
    Frame frame;
    for (std::size_t i = 0; i < std::min<std::size_t>(reader.n_frames(), 64); ++i) reader.read(i, frame);
  });
  fuzz::accept_or_refuse([&] { (void)validate_h5md(file.path()); });
  return 0;
}
