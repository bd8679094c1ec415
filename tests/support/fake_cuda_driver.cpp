// A stand-in for NVIDIA's driver, libcuda.so.1, whose card is the processor: it runs the kernel that is
// compiled for the processor. Tests find it through LD_LIBRARY_PATH. It refuses what the driver would refuse:
// an unknown kernel, code that is no PTX, calls before a context is set. FAKE_CUDA states a fault: "none" (no
// card), "memory" (no memory), "launch" (launches fail).

#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

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
  static const auto executor = twincell::sim::make_host_executor();
  return *executor;
}

thread_local bool has_context = false;

/// A queue of the card. Its work is done when somebody waits for it, no sooner, as may happen on a card.
class Queue {
 public:
  void add(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    work_.push_back(std::move(work));
  }
  void finish() {
    const std::lock_guard lock(mutex_);
    for (const auto& work : work_) work();
    work_.clear();
  }

 private:
  std::mutex mutex_;
  std::vector<std::function<void()>> work_;
};
Queue& queue_of(void* stream) {
  static Queue common;  // of calls without a stream
  return stream == nullptr ? common : *static_cast<Queue*>(stream);
}

std::byte* on_card(unsigned long long address) {
  return reinterpret_cast<std::byte*>(address);
}

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
int cuDevicePrimaryCtxSetFlags_v2(int, unsigned) {
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
int cuMemHostAlloc(void** memory, std::size_t bytes, unsigned) {
  if (!has_context) return no_context;
  *memory = card().allocate(bytes);
  return success;
}
int cuMemFreeHost(void* memory) {
  if (!has_context) return no_context;
  card().release(static_cast<std::byte*>(memory));
  return success;
}
int cuStreamCreate(void** stream, unsigned flags) {
  if (!has_context) return no_context;
  if (flags != 1) return failed;  // others wait for copies
  *stream = new Queue;            // lives as long as the program
  return success;
}
int cuMemcpyHtoD_v2(unsigned long long to, const void* from, std::size_t bytes) {
  if (!has_context) return no_context;
  // As the driver does with ordinary memory: `from` is read now, the card's memory is written later.
  const auto* begin = static_cast<const std::byte*>(from);
  queue_of(nullptr).add([to, kept = std::vector<std::byte>(begin, begin + bytes)] {
    std::memcpy(on_card(to), kept.data(), kept.size());
  });
  return success;
}
int cuMemcpyDtoH_v2(void* to, unsigned long long from, std::size_t bytes) {
  if (!has_context) return no_context;
  queue_of(nullptr).finish();
  std::memcpy(to, on_card(from), bytes);
  return success;
}
int cuMemcpyHtoDAsync_v2(unsigned long long to, const void* from, std::size_t bytes, void* stream) {
  if (!has_context) return no_context;
  if (stream == nullptr) return failed;  // it would wait for all others
  queue_of(stream).add([=] { std::memcpy(on_card(to), from, bytes); });
  return success;
}
int cuMemcpyDtoHAsync_v2(void* to, unsigned long long from, std::size_t bytes, void* stream) {
  if (!has_context) return no_context;
  if (stream == nullptr) return failed;
  queue_of(stream).add([=] { std::memcpy(to, on_card(from), bytes); });
  return success;
}
int cuLaunchKernel(void* function, unsigned grid_x, unsigned grid_y, unsigned grid_z, unsigned block_x,
                   unsigned block_y, unsigned block_z, unsigned, void* stream, void** arguments, void**) {
  if (!has_context) return no_context;
  if (stream == nullptr) return failed;  // it would wait for all others
  if (grid_y * grid_z * block_y * block_z != 1 || block_x > twincell::sim::kMaxThreads) return failed;
  const auto* beds = reinterpret_cast<const DeviceBed*>(*static_cast<unsigned long long*>(arguments[0]));
  const auto* kernel = static_cast<const DeviceKernel*>(function);
  queue_of(stream).add([=] {
    for (unsigned k = 0; k < grid_x; ++k)
      twincell::sim::run_on_host(*kernel, beds[k], {.count = static_cast<int>(block_x), .backwards = true});
  });
  return success;
}
int cuStreamSynchronize(void* stream) {  // reports faults of the launches before
  if (!has_context) return no_context;
  if (stream != nullptr && has_fault("launch")) return failed;
  queue_of(stream).finish();
  return success;
}
int cuGetErrorString(int result, const char** text) {
  *text = result == out_of_memory ? "out of memory"
          : result == failed      ? "unspecified launch failure"
                                  : "fault";
  return success;
}

}  // extern "C"
