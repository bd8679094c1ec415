#include "imaging/codecs/codecs.hpp"

#include <dlfcn.h>

#include "core/error.hpp"

namespace twincell::imaging {

namespace {

constexpr const char* kModule = "libtwincell_codecs.so";

const Codecs& load() {
  // The loader looks along the run path of the program or library that this code is linked into. The module
  // stays loaded until the end.
  void* module = dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
  const auto codecs_of =
      module != nullptr ? reinterpret_cast<const Codecs* (*)()>(dlsym(module, "twincell_codecs")) : nullptr;
  if (codecs_of == nullptr) {
    const char* reason = dlerror();
    throw RunError(std::string(kModule) + ", which reads and writes pictures and films, cannot be loaded (" +
                   (reason != nullptr ? reason : "no reason given") + "); install twincell again.");
  }
  return *codecs_of();
}

}  // namespace

const Codecs& codecs() {
  static const Codecs& loaded = load();
  return loaded;
}

}  // namespace twincell::imaging
