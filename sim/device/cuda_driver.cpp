#include "sim/device/cuda_driver.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include "core/error.hpp"

namespace twincell::sim {

namespace {

/// Sets a function of the library. Functions whose signature once changed have a version in their name.
template <class F>
void find(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(dlsym(library, name));
  if (function == nullptr)
    throw ConfigError(
        {.file = {}, .key = "--device"},
        fmt::format("the driver of the graphics card has no function {}; install a newer driver, or "
                    "run without --device.",
                    name));
}

}  // namespace

CudaDriver CudaDriver::load() {
  void* library = dlopen("libcuda.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw ConfigError(
        {.file = {}, .key = "--device"},
        "gpu needs a graphics card by NVIDIA, and its driver (libcuda.so.1) is not on this machine; "
        "run without --device.");
  CudaDriver d{};
  find(library, "cuInit", d.init);
  find(library, "cuDeviceGetCount", d.device_count);
  find(library, "cuDeviceGet", d.device_get);
  find(library, "cuDeviceGetName", d.device_name);
  find(library, "cuDevicePrimaryCtxSetFlags_v2", d.set_flags);
  find(library, "cuDevicePrimaryCtxRetain", d.retain_context);
  find(library, "cuCtxSetCurrent", d.set_context);
  find(library, "cuModuleLoadData", d.load_module);
  find(library, "cuModuleGetFunction", d.get_function);
  find(library, "cuMemAlloc_v2", d.allocate);
  find(library, "cuMemFree_v2", d.release);
  find(library, "cuMemHostAlloc", d.allocate_host);
  find(library, "cuMemFreeHost", d.release_host);
  find(library, "cuMemcpyHtoD_v2", d.copy_to_device);
  find(library, "cuMemcpyDtoH_v2", d.copy_to_host);
  find(library, "cuMemcpyHtoDAsync_v2", d.send);
  find(library, "cuMemcpyDtoHAsync_v2", d.fetch);
  find(library, "cuLaunchKernel", d.launch);
  find(library, "cuStreamCreate", d.create_stream);
  find(library, "cuStreamSynchronize", d.synchronize);
  find(library, "cuGetErrorString", d.error_text);
  return d;
}

std::string CudaDriver::text_of(Result result) const {
  const char* text = nullptr;
  if (error_text(result, &text) != 0 || text == nullptr) return fmt::format("error {}", result);
  return fmt::format("error {}, {}", result, text);
}

}  // namespace twincell::sim
