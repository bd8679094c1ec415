// Fuzz target: a CELL.toml.

#include "imaging/cell/cell.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  const fuzz::MemoryFile file(data, size);
  fuzz::accept_or_refuse([&] { (void)imaging::read_cell(file.path()).drive(); });
  return 0;
}
