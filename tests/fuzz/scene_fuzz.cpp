// Fuzz target: a scene, as text.

#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace twincell;
  fuzz::accept_or_refuse([&] {
    (void)sim::read_scene_text(std::string(reinterpret_cast<const char*>(data), size), "scene.toml");
  });
  return 0;
}
