#pragma once
/// \file
/// The few functions of the CUDA driver that the program calls, loaded from libcuda.so.1. The declarations
/// are those of NVIDIA's CUDA Driver API, reference manual 12.

#include <string>

namespace twincell::sim {

struct CudaDriver {
  using Result = int;  ///< 0: success
  using Device = int;
  using Context = void*;
  using Module = void*;
  using Function = void*;
  using Stream = void*;
  using Pointer = unsigned long long;  ///< address in memory of the card

  Result (*init)(unsigned flags);
  Result (*device_count)(int* count);
  Result (*device_get)(Device* device, int ordinal);
  Result (*device_name)(char* name, int length, Device device);
  Result (*set_flags)(Device device, unsigned flags);  ///< of the context to be retained
  Result (*retain_context)(Context* context, Device device);
  Result (*set_context)(Context context);
  Result (*load_module)(Module* module, const void* image);
  Result (*get_function)(Function* function, Module module, const char* name);
  Result (*allocate)(Pointer* memory, std::size_t bytes);
  Result (*release)(Pointer memory);
  Result (*allocate_host)(void** memory, std::size_t bytes, unsigned flags);
  Result (*release_host)(void* memory);
  Result (*copy_to_device)(Pointer to, const void* from, std::size_t bytes);
  Result (*copy_to_host)(void* to, Pointer from, std::size_t bytes);
  Result (*send)(Pointer to, const void* from, std::size_t bytes, Stream stream);
  Result (*fetch)(void* to, Pointer from, std::size_t bytes, Stream stream);
  Result (*launch)(Function function, unsigned grid_x, unsigned grid_y, unsigned grid_z, unsigned block_x,
                   unsigned block_y, unsigned block_z, unsigned shared_bytes, Stream stream, void** arguments,
                   void** extra);
  Result (*create_stream)(Stream* stream, unsigned flags);
  Result (*synchronize)(Stream stream);
  Result (*error_text)(Result result, const char** text);

  // Flags.
  static constexpr unsigned kBlockingWait = 4;  ///< of a context: a thread that waits for the card sleeps
  static constexpr unsigned kPortable = 1;      ///< of host memory: for all threads
  static constexpr unsigned kIndependent = 1;   ///< of a stream: it does not wait for copies of others

  /// Loads the driver.
  /// \throws ConfigError if it is not on this machine, or too old
  static CudaDriver load();
  /// The driver's words for a result.
  [[nodiscard]] std::string text_of(Result result) const;
};

}  // namespace twincell::sim
