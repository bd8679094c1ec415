#pragma once
/// \file
/// Numbers of things in sentences.

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace twincell {

/// "1 frame", "2 frames".
/// \param one the word for one of them, whose plural ends in s
template <class Count>
std::string plural(Count n, std::string_view one) {
  return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s");
}

}  // namespace twincell
