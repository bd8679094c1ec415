#pragma once
/// \file
/// The contacts whose memory passes from old neighbour lists to new ones.

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace twincell::sim {

/// Contacts with memory in two flat arrays, grouped by bead i. A ContactMemory for each contact would take
/// twice the memory, at the instant at which that of a run is largest.
class RememberedContacts {
 public:
  /// \param numbers that each contact remembers
  /// \param each each(visit) calls visit(i, j, number) for every contact, with j as in ContactMemory and
  ///     number(m) the m-th number; it is called twice
  template <class Each>
  RememberedContacts(std::size_t beads, std::size_t numbers, const Each& each)
      : numbers_(numbers), end_(beads + 1, 0) {
    each([&](std::int32_t i, std::int32_t /*j*/, const auto& /*number*/) {
      ++end_[static_cast<std::size_t>(i) + 1];
    });
    std::partial_sum(end_.begin(), end_.end(), end_.begin());
    other_.resize(end_.back());
    values_.resize(end_.back() * numbers);
    each([&](std::int32_t i, std::int32_t j, const auto& number) {
      const std::size_t at = end_[static_cast<std::size_t>(i)]++;
      other_[at] = j;
      for (std::size_t m = 0; m < numbers; ++m) values_[at * numbers + m] = number(m);
    });
  }

  [[nodiscard]] bool empty() const { return other_.empty(); }
  /// The numbers of the contact of beads i < j; null if it has none.
  [[nodiscard]] const double* find(std::int32_t i, std::int32_t j) const {
    for (std::size_t at = begin(i); at < end_[static_cast<std::size_t>(i)]; ++at)
      if (other_[at] == j) return values_.data() + at * numbers_;
    return nullptr;
  }
  /// Calls visit(bead, numbers) for every contact with wall w.
  template <class Visit>
  void at_wall(std::size_t w, Visit visit) const {
    const std::int32_t wall = -1 - static_cast<std::int32_t>(w);
    for (std::int32_t i = 0; static_cast<std::size_t>(i) + 1 < end_.size(); ++i)
      if (const double* numbers = find(i, wall)) visit(i, numbers);
  }

 private:
  [[nodiscard]] std::size_t begin(std::int32_t i) const {
    return i == 0 ? 0 : end_[static_cast<std::size_t>(i) - 1];
  }

  std::size_t numbers_;
  std::vector<std::size_t> end_;     ///< [bead] end of its contacts in the arrays below
  std::vector<std::int32_t> other_;  ///< [contact] j
  std::vector<double> values_;       ///< [contact][number]
};

}  // namespace twincell::sim
