#pragma once
/// \file
/// The words for the boundaries of a cell in files, pages and messages.

#include <array>
#include <string>
#include <string_view>

#include "core/choice.hpp"
#include "trajectory/box.hpp"

namespace twincell {

/// A boundary with its word for one axis, and its word for the two sides of the cell along that axis.
struct BoundaryWords {
  Boundary value;
  std::string_view word;
  std::string_view sides;
};
inline constexpr std::array kBoundaries = {BoundaryWords{Boundary::wall, "wall", "walls"},
                                           BoundaryWords{Boundary::periodic, "periodic", "periodic"},
                                           BoundaryWords{Boundary::open, "open", "open"}};

/// "wall", "periodic" or "open".
inline std::string boundary_word(Boundary boundary) {
  return std::string(row_of(kBoundaries, boundary).word);
}
/// "walls", "periodic" or "open".
inline std::string sides_word(Boundary boundary) {
  return std::string(row_of(kBoundaries, boundary).sides);
}

}  // namespace twincell
