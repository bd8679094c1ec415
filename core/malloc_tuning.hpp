#pragma once
/// \file
/// Memory that is used again.

#include <malloc.h>

namespace twincell {

/// Has the allocator keep what is freed instead of handing it back. Frames come and go by megabytes: asked
/// for anew each time, pages that the kernel must clear took a quarter of the time of locating. To be called
/// once, at the start of a program.
inline void tune_malloc() {
  constexpr int kNever = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, kNever);
  mallopt(M_TRIM_THRESHOLD, kNever);
}

}  // namespace twincell
