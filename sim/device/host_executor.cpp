#include <cstring>
#include <iterator>
#include <new>

#include "sim/device/advance_bed.hpp"
#include "sim/device/device_laws.hpp"
#include "sim/device/executor.hpp"

namespace twincell::sim {

namespace {

/// Execution space on one thread of the processor, which does the work of all threads of a block in turn.
class HostSpace {
 public:
  explicit HostSpace(const HostThreads& threads) : threads_(threads) {}

  template <class F>
  void for_each(std::int32_t count, F f) const {
    for (std::int32_t k = 0; k < threads_.count; ++k)
      for (std::int32_t i = threads_.backwards ? threads_.count - 1 - k : k; i < count; i += threads_.count)
        f(i);
  }
  template <class F>
  bool any(std::int32_t count, F f) const {
    bool found = false;
    for_each(count, [&](std::int32_t i) {
      if (f(i)) found = true;
    });
    return found;
  }
  template <class F>
  SortedCounts sort(std::int32_t count, std::int32_t* list, F f) const {
    SortedCounts n{};
    for_each(count, [&](std::int32_t i) {
      const Sorted to = f(i);
      if (to == Sorted::front) list[n.front++] = i;
      if (to == Sorted::back) list[count - 1 - n.back++] = i;
    });
    return n;
  }
  template <class F>
  void once(F f) const {
    f();
  }

 private:
  HostThreads threads_;
};

using BedFunction = void (*)(const HostSpace&, const DeviceBed&);

/// By the index of device_kernel.hpp.
constexpr BedFunction kFunctions[] = {
#define TWINCELL_FUNCTIONS(name, normal, tangential)                                          \
  &advance_bed<HostSpace, LawSet<normal, tangential, NoRolling>, 2, Velocity::half_step>,     \
      &advance_bed<HostSpace, LawSet<normal, tangential, NoRolling>, 2, Velocity::full_step>, \
      &advance_bed<HostSpace, LawSet<normal, tangential, NoRolling>, 3, Velocity::half_step>, \
      &advance_bed<HostSpace, LawSet<normal, tangential, NoRolling>, 3, Velocity::full_step>,
    TWINCELL_DEVICE_LAWS(TWINCELL_FUNCTIONS)
#undef TWINCELL_FUNCTIONS
};

static_assert(std::size(kFunctions) == 4 * DeviceLawSet::kCount);

constexpr std::align_val_t kAlignment{64};

class HostExecutor : public Executor {
 public:
  explicit HostExecutor(const HostThreads& threads) : threads_(threads) {}

  [[nodiscard]] std::byte* allocate(std::size_t bytes) override {
    return static_cast<std::byte*>(::operator new(bytes, kAlignment));
  }
  void release(std::byte* memory) override { ::operator delete(memory, kAlignment); }
  [[nodiscard]] int launches_at_once() const override { return 1 << 20; }  // kernels share nothing
  void write(std::byte* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
  void read(void* to, const std::byte* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
  void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) override {
    for (const DeviceBed& bed : beds) run_on_host(kernel, bed, threads_);
  }
  [[nodiscard]] std::string description() const override { return "device kernel on the processor"; }

 private:
  HostThreads threads_;
};

}  // namespace

void run_on_host(const DeviceKernel& kernel, const DeviceBed& bed, const HostThreads& threads) {
  kFunctions[kernel.index](HostSpace(threads), bed);
}

std::unique_ptr<Executor> make_host_executor(const HostThreads& threads) {
  return std::make_unique<HostExecutor>(threads);
}

}  // namespace twincell::sim
