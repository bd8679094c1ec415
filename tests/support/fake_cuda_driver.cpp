// A stand-in for NVIDIA's driver, libcuda.so.1, whose card is the processor: it runs the kernel that is
// compiled for the processor. Tests find it through LD_LIBRARY_PATH. It refuses what the driver would refuse:
// an unknown kernel, code that is no PTX, calls before a context is set. FAKE_CUDA states a fault: "none" (no
// card), "memory" (no memory), "launch" (launches fail).

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "sim/device/device_laws.hpp"
#include "sim/device/executor.hpp"

namespace {

using twincell::sim::DeviceBed;
using twincell::sim::DeviceKernel;

enum Result { success = 0, out_of_memory = 2, no_context = 201, no_ptx = 218, not_found = 500, failed = 719 };

bool has_fault(std::string_view fault) {
  const char* stated = std::getenv("FAKE_CUDA");
  return stated != nullptr && stated == fault;
}

twincell::sim::Executor& card() {
  static const auto executor = twincell::sim::make_host_executor({.count = 128, .backwards = true});
  return *executor;
}

thread_local bool has_context = false;

/// The kernel of this name; null if there is none.
std::unique_ptr<DeviceKernel> kernel_named(const std::string& name) {
  using namespace twincell::sim;
  for (std::size_t normal = 0; normal < std::variant_size_v<NormalAxis>; ++normal)
    for (std::size_t tangential = 0; tangential < std::variant_size_v<TangentialAxis>; ++tangential)
      for (const int dimension : {2, 3})
        for (const Velocity velocity : {Velocity::half_step, Velocity::full_step}) {
          const auto kernel = find_device_kernel({dimension, normal, tangential, 0, velocity});
          if (kernel && kernel->name == name) return std::make_unique<DeviceKernel>(*kernel);
        }
  return nullptr;
}

}  // namespace

extern "C" {

int cuInit(unsigned) {
  return success;
}
int cuDeviceGetCount(int* count) {
  *count = has_fault("none") ? 0 : 1;
  return success;
}
int cuDeviceGet(int* device, int) {
  *device = 0;
  return success;
}
int cuDeviceGetName(char* name, int length, int) {
  std::strncpy(name, "a card that is the processor", static_cast<std::size_t>(length));
  return success;
}
int cuDevicePrimaryCtxRetain(void** context, int) {
  *context = &has_context;
  return success;
}
int cuCtxSetCurrent(void* context) {
  has_context = context != nullptr;
  return success;
}
int cuModuleLoadData(void** module, const void* image) {
  if (!has_context) return no_context;
  if (std::string_view(static_cast<const char*>(image)).find(".target sm_") == std::string_view::npos)
    return no_ptx;
  *module = const_cast<void*>(image);
  return success;
}
int cuModuleGetFunction(void** function, void* module, const char* name) {
  if (!has_context) return no_context;
  const std::string entry = std::string(".visible .entry ") + name + "(";
  auto kernel = kernel_named(name);
  if (!kernel || std::string_view(static_cast<const char*>(module)).find(entry) == std::string_view::npos)
    return not_found;
  *function = kernel.release();  // functions live as long as the program
  return success;
}
int cuMemAlloc_v2(unsigned long long* memory, std::size_t bytes) {
  if (!has_context) return no_context;
  if (has_fault("memory")) return out_of_memory;
  *memory = reinterpret_cast<std::uintptr_t>(card().allocate(bytes));
  return success;
}
int cuMemFree_v2(unsigned long long memory) {
  if (!has_context) return no_context;
  card().release(reinterpret_cast<std::byte*>(memory));
  return success;
}
int cuMemcpyHtoD_v2(unsigned long long to, const void* from, std::size_t bytes) {
  if (!has_context) return no_context;
  card().write(reinterpret_cast<std::byte*>(to), from, bytes);
  return success;
}
int cuMemcpyDtoH_v2(void* to, unsigned long long from, std::size_t bytes) {
  if (!has_context) return no_context;
  card().read(to, reinterpret_cast<const std::byte*>(from), bytes);
  return success;
}
int cuLaunchKernel(void* function, unsigned grid_x, unsigned grid_y, unsigned grid_z, unsigned block_x,
                   unsigned block_y, unsigned block_z, unsigned, void*, void** arguments, void**) {
  if (!has_context) return no_context;
  if (grid_y * grid_z * block_y * block_z != 1 || block_x != 128) return failed;
  const auto* beds = reinterpret_cast<const DeviceBed*>(*static_cast<unsigned long long*>(arguments[0]));
  card().advance(*static_cast<const DeviceKernel*>(function), {beds, beds + grid_x});
  return success;
}
int cuCtxSynchronize() {  // reports faults of the launches before
  if (!has_context) return no_context;
  return has_fault("launch") ? failed : success;
}
int cuGetErrorString(int result, const char** text) {
  *text = result == out_of_memory ? "out of memory"
          : result == failed      ? "unspecified launch failure"
                                  : "fault";
  return success;
}

}  // extern "C"
