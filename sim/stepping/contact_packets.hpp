#pragma once
/// \file
/// Lists of contacts in the memory layout of the kernels: packets of as many contacts as a SIMD vector has
/// lanes, numbers as [packet][number][lane].

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/kernels/kernels.hpp"

namespace twincell::sim {

/// Bytes that the vectors have allocated.
template <class... T>
std::size_t bytes_of(const std::vector<T>&... vectors) {
  return ((vectors.capacity() * sizeof(T)) + ... + 0);
}

/// Resizes a vector that is refilled many times. Its spare capacity is at most a sixteenth of its size; a
/// vector that grows by itself may allocate twice its size.
template <class T>
void resize_closely(std::vector<T>& v, std::size_t n) {
  if (n > v.capacity()) {
    v = {};  // frees the old memory before the new is allocated
    v.reserve(n + n / 16);
  }
  v.resize(n);
}

/// Resizes a vector as resize_closely() does and sets all n elements to `value`.
template <class T>
void assign_closely(std::vector<T>& v, std::size_t n, T value) {
  v.clear();
  resize_closely(v, n);
  if (value != T{}) v.assign(n, value);
}

/// Contacts in packets: the input of a kernel.
struct ContactPackets {
  std::vector<std::int32_t> i, j, force_i, force_j;
  std::vector<double> memory, constants, shift;
  std::vector<std::int32_t> source;  ///< [packet][lane] pair of the outer list, or bead; -1: padding
  std::int64_t count = 0;            ///< packets

  /// Bytes in use.
  [[nodiscard]] std::size_t bytes() const {
    return bytes_of(i, j, force_i, force_j, memory, constants, shift, source);
  }
};

/// Bytes per contact, padding included, that an evaluation of packets reads and writes: the remembered
/// numbers twice, indices and constants once.
inline double bytes_per_contact(const ContactPackets& p) {
  const double bytes = static_cast<double>(
      sizeof(std::int32_t) * (p.i.size() + p.j.size() + p.force_i.size() + p.force_j.size()) +
      sizeof(double) * (2 * p.memory.size() + p.constants.size() + p.shift.size()));
  return p.source.empty() ? 0 : bytes / static_cast<double>(p.source.size());
}

/// Sizes that the layout of packets depends on.
struct PacketLayout {
  std::size_t width;      ///< lanes
  std::size_t dimension;  ///< 2 or 3
  std::size_t memory;     ///< numbers that a contact remembers

  /// Packets that n contacts fill.
  [[nodiscard]] std::size_t packets(std::size_t n) const { return (n + width - 1) / width; }
  /// Index of number m of `of` numbers of contact `at`, counted over packets and lanes.
  [[nodiscard]] std::size_t index(std::size_t at, std::size_t of, std::size_t m) const {
    return (at / width * of + m) * width + at % width;
  }
  /// Index of the first number of the record of a bead.
  [[nodiscard]] std::int32_t record(std::int32_t place) const {
    return place * (dimension == 2 ? kRecord<2> : kRecord<3>);
  }
  /// The place of a bead from the index of the first number of its record.
  [[nodiscard]] std::int32_t place(std::int32_t record) const {
    return record / (dimension == 2 ? kRecord<2> : kRecord<3>);
  }
  /// A set of constants, each in all lanes.
  [[nodiscard]] std::vector<double> broadcast(const std::vector<double>& set) const {
    std::vector<double> lanes;
    lanes.reserve(set.size() * width);
    for (const double number : set) lanes.insert(lanes.end(), width, number);
    return lanes;
  }
  /// Whether any of a contact's remembered numbers, `stride` apart, is nonzero.
  [[nodiscard]] bool remembers(const double* numbers, std::size_t stride) const {
    for (std::size_t m = 0; m < memory; ++m)
      if (numbers[m * stride] != 0) return true;
    return false;
  }
};

}  // namespace twincell::sim
