// Fuzz target: a plan of a sweep over the existing scene "scene.toml". An input that contains a NUL supplies
// its own scene after it.

#include <algorithm>
#include <fstream>

#include "sweep/plan.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/support/temporary_folder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  static const TemporaryFolder folder;
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = std::min(all.find('\0'), size);
  std::ofstream(folder.path() / "scene.toml", std::ios::binary)
      << (cut < size ? all.substr(cut + 1) : "preset = \"fortini-huang-2015\"\n[beads]\ncount = 20\n");
  fuzz::accept_or_refuse(
      [&] { (void)sweep::read_plan_text(std::string(all.substr(0, cut)), "plan.toml", folder.path()); });
  return 0;
}
