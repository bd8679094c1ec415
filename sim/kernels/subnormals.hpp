#pragma once
/// \file
/// Flushing of subnormal numbers to 0.

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <cstdint>

namespace twincell::sim {

/// While an object of this class exists, its thread treats subnormal numbers as 0. A velocity that decays by
/// drag or a dashpot passes through the subnormal range, where many processors are slow. Every solver creates
/// such an object in each of its threads, so all of them give the same bits.
class FlushSubnormals {
 public:
  FlushSubnormals() : before_(get()) { set(before_ | kFlush); }
  ~FlushSubnormals() { set(before_); }
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

 private:
#if defined(__SSE2__)
  using Control = unsigned;
  static constexpr Control kFlush = 0x8040;  // results (FTZ) and operands (DAZ)
  static Control get() {
    return _mm_getcsr();
  }
  static void set(Control c) {
    _mm_setcsr(c);
  }
#elif defined(__aarch64__)
  using Control = std::uint64_t;
  static constexpr Control kFlush = std::uint64_t{1} << 24;  // FPCR.FZ
  static Control get() {
    Control c = 0;
    asm volatile("mrs %0, fpcr" : "=r"(c));
    return c;
  }
  static void set(Control c) {
    asm volatile("msr fpcr, %0" : : "r"(c));
  }
#else
  using Control = unsigned;
  static constexpr Control kFlush = 0;
  static Control get() {
    return 0;
  }
  static void set(Control) {}
#endif
  Control before_;
};

}  // namespace twincell::sim
