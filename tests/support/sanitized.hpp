#pragma once
/// \file
/// Whether the tests are built with a sanitizer. The address sanitizer keeps freed memory for a while and
/// reserves terabytes of addresses, so that neither memory use nor a limit of memory can be tested.

namespace twincell {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace twincell
