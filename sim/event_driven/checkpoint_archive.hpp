#pragma once
/// \file
/// Checkpoint archive: a state as a sequence of numbers. One function lists the members of the state in order
/// and is called with a writer or with a reader.

#include <cstddef>
#include <type_traits>
#include <vector>

#include "sim/event_driven/ballistic_paths.hpp"

namespace twincell::sim {

/// Appends numbers.
struct ArchiveWriter {
  static constexpr bool kReads = false;
  std::vector<double> numbers;
  void operator()(const Vec3& v) {
    for (Eigen::Index k = 0; k < 3; ++k) (*this)(v[k]);
  }
  void operator()(const BallisticPath& line) { (*this)(line.a), (*this)(line.b); }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void operator()(T x) { numbers.push_back(static_cast<double>(x)); }
};
/// Reads the numbers that a writer appended. Past their end it reads zeros.
struct ArchiveReader {
  static constexpr bool kReads = true;
  const std::vector<double>& numbers;
  std::size_t at = 0;
  void operator()(Vec3& v) {
    for (Eigen::Index k = 0; k < 3; ++k) (*this)(v[k]);
  }
  void operator()(BallisticPath& line) { (*this)(line.a), (*this)(line.b); }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void operator()(T& x) { x = static_cast<T>(at < numbers.size() ? numbers[at++] : 0.0); }
};
/// Writes or reads the size of a list; a list that is read is resized.
template <class List, class Archive>
void archive_size(List& list, Archive& a) {
  std::size_t n = list.size();
  a(n);
  if constexpr (Archive::kReads) list.resize(n);
}
}  // namespace twincell::sim
