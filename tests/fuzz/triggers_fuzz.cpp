// Fuzz target: a list of triggers, with the number of frames per cycle detected and stated.

#include "imaging/phase/trigger_list.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  const fuzz::MemoryFile file(data, size);
  fuzz::accept_or_refuse([&] { (void)imaging::read_triggers(file.path(), 8.0); });
  fuzz::accept_or_refuse([&] { (void)imaging::read_triggers(file.path(), std::nullopt, 20); });
  return 0;
}
