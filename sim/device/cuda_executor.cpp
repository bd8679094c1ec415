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

/// Threads of a block: about as many as beads, a power of two up to kMaxThreads. A step of one bed of 400
/// took 24, 17 and 14 us with 128, 256 and 512 threads on an H200, a step of 1056 of them 234, 178 and 173
/// us.
constexpr unsigned kMinThreads = 64;

/// Launches in progress at once. With 32 of them on an H100 the calls that begin a launch did not return
/// before fewer than some 13 were in progress, however threads waited for the end of theirs. 126 beds then
/// made launches of one bed, of which 13 worked at a time. (Tried and dropped on an H200: one launch at a
/// time.)
constexpr int kLaunches = 8;
/// Beds of a launch at most. The thread that waits for a launch wakes those of the other beds one after the
/// other.
constexpr std::size_t kBedsPerLaunch = 32;

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
  [[nodiscard]] int launches_at_once() const override { return kLaunches; }
  [[nodiscard]] std::size_t beds_per_launch() const override { return kBedsPerLaunch; }
  void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) override {
    use();
    // All beds of a launch share one transfer to the card and one back: a call of the driver takes some 20
    // us, and calls of many threads follow one another. (Measured with transfers for each bed, on an H100: 15
    // beds waited 71 ms for their calls and 25 ms for the kernel.)
    std::size_t there = whole_lines(beds.size() * sizeof(DeviceBed)), back = 0;
    const std::size_t first = there;
    std::int32_t most = 0;
    for (const DeviceBed& bed : beds) {
      there += whole_lines(input_bytes(bed));
      back += whole_lines(state_bytes(bed));
      most = std::max(most, bed.beads);
    }
    const Queue queue(*this, there + back);
    std::vector<DeviceBed> placed = beds;
    std::size_t input = first, states = there;
    for (DeviceBed& bed : placed) {
      std::memcpy(queue->host + input, bed.inputs, input_bytes(bed));
      place_inputs(bed, queue->card + input);
      bed.states = queue->card + states;
      input += whole_lines(input_bytes(bed)), states += whole_lines(state_bytes(bed));
    }
    std::memcpy(queue->host, placed.data(), beds.size() * sizeof(DeviceBed));
    require(name_ + " cannot be written",
            driver_.send(address(queue->card), queue->host, there, queue->stream));
    std::byte* arguments = queue->card;
    void* values[] = {&arguments};
    const unsigned threads =
        std::clamp(std::bit_ceil(static_cast<unsigned>(most)), kMinThreads, unsigned{kMaxThreads});
    require(fmt::format("{} does not start {}", name_, kernel.name),
            driver_.launch(function_of(kernel), static_cast<unsigned>(beds.size()), 1, 1, threads, 1, 1, 0,
                           queue->stream, values, nullptr));
    // A copy by the card. Tried and dropped: kernels that write to memory of the processor, at 1 GB/s on an
    // H200.
    require(name_ + " cannot be read",
            driver_.fetch(queue->host + there, address(queue->card + there), back, queue->stream));
    require(fmt::format("{} failed in {}", name_, kernel.name), driver_.synchronize(queue->stream));
    states = there;
    for (const DeviceBed& bed : beds) {
      std::memcpy(bed.states, queue->host + states, state_bytes(bed));
      states += whole_lines(state_bytes(bed));
    }
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
  static std::size_t whole_lines(std::size_t bytes) {
    constexpr std::size_t kLine = 64;  // arrays in memory of the card begin with a cache line
    return (bytes + kLine - 1) / kLine * kLine;
  }
  /// A stream of its own for each launch in progress, and memory for what it transfers.
  struct Line {
    CudaDriver::Stream stream = nullptr;
    std::byte *card = nullptr, *host = nullptr;
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
      if (line_.card != nullptr) {
        of.release(line_.card);
        (void)of.driver_.release_host(line_.host);
      }
      line_.capacity = std::bit_ceil(bytes);  // so that it seldom grows: the card stands still meanwhile
      line_.card = of.allocate(line_.capacity);
      void* host = nullptr;
      of.require(fmt::format("the driver has no memory for {} bytes that {} can access; use fewer --threads",
                             line_.capacity, of.name_),
                 of.driver_.allocate_host(&host, line_.capacity, CudaDriver::kPortable));
      line_.host = static_cast<std::byte*>(host);
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
