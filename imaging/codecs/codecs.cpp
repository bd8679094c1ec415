#include "imaging/codecs/codecs.hpp"

#include <dlfcn.h>
#include <sys/resource.h>

#include <string>

#include "core/error.hpp"

namespace twincell::imaging {

namespace {

constexpr const char* kModule = "libtwincell_codecs.so";

/// What helps where the loader gives this reason.
std::string remedy_of(const std::string& reason) {
  rlimit space{};
  const bool limited = ::getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY;
  const auto says = [&](const char* words) { return reason.find(words) != std::string::npos; };
  if (says("llocate memory") || (limited && says("failed to map segment")))
    return limited ? "the address space of the process is limited to " +
                         std::to_string(space.rlim_cur >> 20U) + " MiB: raise the limit (ulimit -v)."
                   : "the memory is exhausted: end other programs.";
  return "install twincell again.";
}

const Codecs& load() {
  // The loader looks along the run path of the program or library that this code is linked into. The module
  // stays loaded until the end.
  void* module = dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
  const auto codecs_of =
      module != nullptr ? reinterpret_cast<const Codecs* (*)()>(dlsym(module, "twincell_codecs")) : nullptr;
  if (codecs_of == nullptr) {
    const char* said = dlerror();
    const std::string reason = said != nullptr ? said : "no reason given";
    throw RunError(std::string(kModule) + ", which reads and writes pictures and films, cannot be loaded (" +
                   reason + "); " + remedy_of(reason));
  }
  return *codecs_of();
}

}  // namespace

const Codecs& codecs() {
  static const Codecs& loaded = load();
  return loaded;
}

}  // namespace twincell::imaging
