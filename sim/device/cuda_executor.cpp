#include "sim/device/cuda_executor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>

#include "core/error.hpp"
#include "sim/device/cuda_driver.hpp"
#include "sim/device/device_code.hpp"

namespace twincell::sim {

namespace {

/// Threads of a block: about as many as beads, a power of two up to kMostThreads. A step of one bed of 400 took
/// 24, 17 and 14 us with 128, 256 and 512 threads on an H200, a step of 1056 of them 234, 178 and 173 us.
constexpr unsigned kLeastThreads = 64;

/// Launches in progress at once. The beds of one launch come back together, so with few launches beds wait
/// for each other; each launch costs the driver some ten microseconds.
constexpr int kLaunches = 32;
/// Beds of a launch at most. The thread that waits for a launch wakes those of the other beds one after the
/// other: with many beds in one launch, most of them wait for that.
constexpr std::size_t kBedsPerLaunch = 16;

class CudaExecutor : public Executor {
 public:
  CudaExecutor() : driver_(CudaDriver::load()) {
    // As many queues to the card as launches at once, instead of 8: launches in one queue wait for each
    // other.
    (void)::setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0);
    int cards = 0;
    if (driver_.init(0) != 0 || driver_.device_count(&cards) != 0 || cards == 0)
      throw ConfigError({.file = {}, .key = "--device"},
                        "gpu needs a graphics card, and the driver finds none; run without --device.");
    CudaDriver::Device card = 0;
    char name[256] = {};
    require("the driver does not open the graphics card", driver_.device_get(&card, 0));
    require("the graphics card has no name", driver_.device_name(name, sizeof(name) - 1, card));
    // Without it, threads that wait would take the processors from those that analyse.
    require("the driver does not open the graphics card", driver_.set_flags(card, CudaDriver::kBlockingWait));
    require("the driver does not open the graphics card", driver_.retain_context(&context_, card));
    name_ = name;
  }

  [[nodiscard]] std::byte* allocate(std::size_t bytes) override {
    use();
    CudaDriver::Pointer memory = 0;
    require(fmt::format("{} has no memory for a bed of {} bytes; use fewer --threads", name_, bytes),
            driver_.allocate(&memory, bytes));
    return std::bit_cast<std::byte*>(static_cast<std::uintptr_t>(memory));
  }
  void release(std::byte* memory) override {
    // Called by destructors: an error shows in the next call.
    (void)driver_.set_context(context_);
    (void)driver_.release(address(memory));
  }
  void write(std::byte* to, const void* from, std::size_t bytes) override {
    use();
    require(name_ + " cannot be written", driver_.copy_to_device(address(to), from, bytes));
    // The copy returns when it has read `from`, and launches do not wait for its end by themselves.
    require(name_ + " cannot be written", driver_.synchronize(nullptr));
  }
  void read(void* to, const std::byte* from, std::size_t bytes) override {
    use();
    require(name_ + " cannot be read", driver_.copy_to_host(to, address(from), bytes));
  }
  [[nodiscard]] std::byte* allocate_host(std::size_t bytes) override {
    use();
    void* memory = nullptr;
    require(fmt::format("the driver has no memory for {} bytes that {} can access; use fewer --threads",
                        bytes, name_),
            driver_.allocate_host(&memory, bytes, CudaDriver::kPortable));
    return static_cast<std::byte*>(memory);
  }
  void release_host(std::byte* memory) override {
    (void)driver_.set_context(context_);
    (void)driver_.release_host(memory);
  }
  [[nodiscard]] int launches_at_once() const override { return kLaunches; }
  [[nodiscard]] std::size_t beds_per_launch() const override { return kBedsPerLaunch; }
  void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) override {
    use();
    const std::size_t bytes = beds.size() * sizeof(DeviceBed);
    const Queue queue(*this, bytes);
    const auto send = [&](const Transfer& t) {
      require(name_ + " cannot be written", driver_.send(address(t.to), t.from, t.bytes, queue->stream));
    };
    std::memcpy(queue->host_arguments, beds.data(), bytes);
    send({queue->arguments, queue->host_arguments, bytes});
    std::int32_t most = 0;
    for (const DeviceBed& bed : beds) {
      send(inputs_of(bed));
      most = std::max(most, bed.beads);
    }
    std::byte* arguments = queue->arguments;
    void* values[] = {&arguments};
    const unsigned threads =
        std::clamp(std::bit_ceil(static_cast<unsigned>(most)), kLeastThreads, unsigned{kMostThreads});
    require(fmt::format("{} does not start {}", name_, kernel.name),
            driver_.launch(function_of(kernel), static_cast<unsigned>(beds.size()), 1, 1, threads, 1, 1, 0,
                           queue->stream, values, nullptr));
    // Copies by the card. Tried and dropped: kernels that write to memory of the processor, at 1 GB/s on an
    // H200.
    for (const DeviceBed& bed : beds) {
      const Transfer t = states_of(bed);
      require(name_ + " cannot be read", driver_.fetch(t.to, address(t.from), t.bytes, queue->stream));
    }
    require(fmt::format("{} failed in {}", name_, kernel.name), driver_.synchronize(queue->stream));
  }
  [[nodiscard]] std::string description() const override { return name_; }

 private:
  static CudaDriver::Pointer address(const std::byte* memory) {
    return reinterpret_cast<std::uintptr_t>(memory);
  }
  /// Makes the card that of the calling thread.
  void use() { require("the driver does not open " + name_, driver_.set_context(context_)); }
  void require(const std::string& complaint, CudaDriver::Result result) const {
    if (result != 0)
      throw Error(ExitCode::failed, fmt::format("{} ({}).", complaint, driver_.text_of(result)));
  }
  /// A stream of its own for each launch in progress, and memory for its arguments.
  struct Line {
    CudaDriver::Stream stream = nullptr;
    std::byte *arguments = nullptr, *host_arguments = nullptr;
    std::size_t capacity = 0;
  };
  class Queue {
   public:
    Queue(CudaExecutor& of, std::size_t bytes) : of_(of) {
      {
        const std::lock_guard lock(of.mutex_);
        if (!of.lines_.empty()) line_ = of.lines_.back(), of.lines_.pop_back();
      }
      if (line_.stream == nullptr)
        of.require(of.name_ + " opens no stream",
                   of.driver_.create_stream(&line_.stream, CudaDriver::kIndependent));
      if (bytes <= line_.capacity) return;
      if (line_.arguments != nullptr) {
        of.release(line_.arguments);
        of.release_host(line_.host_arguments);
      }
      line_.arguments = of.allocate(bytes);
      line_.host_arguments = of.allocate_host(bytes);
      line_.capacity = bytes;
    }
    ~Queue() {
      const std::lock_guard lock(of_.mutex_);
      of_.lines_.push_back(line_);
    }
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;
    const Line* operator->() const { return &line_; }

   private:
    CudaExecutor& of_;
    Line line_;
  };

  /// Compiles the code of a kernel for the card when it is first used.
  CudaDriver::Function function_of(const DeviceKernel& kernel) {
    const std::lock_guard lock(mutex_);
    const auto known = functions_.find(kernel.index);
    if (known != functions_.end()) return known->second;
    constexpr int kPerModule = 4;  // the kernels of a combination of laws
    const int set = kernel.index / kPerModule;
    CudaDriver::Module& module = modules_[set];
    if (module == nullptr)
      require(fmt::format("the driver does not accept the device code of {}", kernel.name),
              driver_.load_module(&module, device_code()[static_cast<std::size_t>(set)]));
    CudaDriver::Function function = nullptr;
    require(fmt::format("the device code has no kernel {}", kernel.name),
            driver_.get_function(&function, module, kernel.name.c_str()));
    return functions_[kernel.index] = function;
  }

  CudaDriver driver_;
  CudaDriver::Context context_ = nullptr;
  std::string name_;
  std::mutex mutex_;  ///< guards the members below
  std::map<int, CudaDriver::Module> modules_;
  std::map<int, CudaDriver::Function> functions_;
  std::vector<Line> lines_;  ///< not in use
};

}  // namespace

std::unique_ptr<Executor> make_cuda_executor() {
  if (device_code().empty())
    throw ConfigError(
        {.file = {}, .key = "--device"},
        "gpu is not in this program: no clang++ for NVPTX was found when it was built; install clang "
        "and build again, or run without --device.");
  return std::make_unique<CudaExecutor>();
}

}  // namespace twincell::sim
