// Fuzz target: a calibration file.

#include "tests/fuzz/input.hpp"
#include "trajectory/calibration_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  const fuzz::MemoryFile file(data, size);
  // An accepted calibration must be writable.
  fuzz::accept_or_refuse([&] { (void)calibration_text(read_calibration(file.path()), "fuzz"); });
  return 0;
}
