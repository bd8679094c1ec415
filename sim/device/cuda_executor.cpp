#include "sim/device/cuda_executor.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <map>

#include "core/error.hpp"
#include "sim/device/cuda_driver.hpp"
#include "sim/device/device_code.hpp"

namespace twincell::sim {

namespace {

/// Threads of a block. A bed of 100 to 400 beads gives each thread one to four.
constexpr unsigned kThreads = 128;

class CudaExecutor : public Executor {
 public:
  CudaExecutor() : driver_(CudaDriver::load()) {
    int cards = 0;
    if (driver_.init(0) != 0 || driver_.device_count(&cards) != 0 || cards == 0)
      throw ConfigError({.file = {}, .key = "--device"},
                        "gpu needs a graphics card, and the driver finds none; run without --device.");
    CudaDriver::Device card = 0;
    char name[256] = {};
    require("the driver does not open the graphics card", driver_.device_get(&card, 0));
    require("the graphics card has no name", driver_.device_name(name, sizeof(name) - 1, card));
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
  }
  void read(void* to, const std::byte* from, std::size_t bytes) override {
    use();
    require(name_ + " cannot be read", driver_.copy_to_host(to, address(from), bytes));
  }
  void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) override {
    use();
    const CudaDriver::Function function = function_of(kernel);
    const std::size_t bytes = beds.size() * sizeof(DeviceBed);
    if (bytes > capacity_) {
      if (arguments_ != nullptr) release(arguments_);
      arguments_ = nullptr;
      arguments_ = allocate(bytes);
      capacity_ = bytes;
    }
    write(arguments_, beds.data(), bytes);
    CudaDriver::Pointer argument = address(arguments_);
    void* values[] = {&argument};
    const auto blocks = static_cast<unsigned>(beds.size());
    require(fmt::format("{} does not start {}", name_, kernel.name),
            driver_.launch(function, blocks, 1, 1, kThreads, 1, 1, 0, nullptr, values, nullptr));
    require(fmt::format("{} failed in {}", name_, kernel.name), driver_.synchronize());
  }
  [[nodiscard]] std::string description() const override {
    return fmt::format("{}, {} threads a bed", name_, kThreads);
  }

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
  /// Compiles the code of a kernel for the card when it is first used.
  CudaDriver::Function function_of(const DeviceKernel& kernel) {
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
  std::map<int, CudaDriver::Module> modules_;
  std::map<int, CudaDriver::Function> functions_;
  std::byte* arguments_ = nullptr;
  std::size_t capacity_ = 0;
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
