#pragma once
/// \file
/// Whether the tests are built with a sanitizer. The address sanitizer delays the release of freed memory and
/// reserves terabytes of address space, so neither memory use nor a memory limit can be tested.

namespace twincell {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace twincell
