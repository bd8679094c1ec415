#pragma once
/// \file
/// Active set of the list solver: the beads that may have a contact. Inactive beads fly freely as long as the
/// lists are valid; they are advanced only when their positions are needed.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/stepping/inner_list.hpp"
#include "sim/stepping/wall_lists.hpp"

namespace twincell::sim {

/// The active and inactive beads of one thread. Groups of kGroup beads (3D: single beads) are active
/// together.
class ActiveSet {
 public:
  /// Finds the active beads: the groups with a bead in an inner or wall list.
  /// \param all every bead is active whatever the lists contain
  void find(const PacketLayout& layout, const BeadShare& share, const OuterPairs& outer,
            const InnerPairs& inner, const WallContacts& walls, bool all);
  /// The active beads of a chunk of the inner list.
  struct Runs {
    const BeadRange* first;
    std::size_t count;
  };
  /// The active beads of chunk `chunk` of the inner list, as ranges of places.
  [[nodiscard]] Runs in_chunk(std::size_t chunk) const {
    const std::size_t begin = chunk == 0 ? 0 : chunk_end_[chunk - 1];
    return {active_.data() + begin, chunk_end_[chunk] - begin};
  }
  /// Registers a step of the active beads.
  void add_step() { ++behind_; }
  /// Advances the inactive beads to the present step.
  /// \param dt t0
  /// \param gravity components, g
  void advance_inactive(const Kernels& kernels, double* records, double dt, const double* gravity);
  /// Number of active beads.
  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_of(chunk_end_); }

 private:
  std::vector<BeadRange> active_, inactive_;
  std::vector<std::size_t> chunk_end_;  ///< [chunk] end of its active beads in active_
  std::vector<char> is_active_;         ///< [group]
  std::int64_t size_ = 0;
  std::int64_t behind_ = 0;  ///< steps by which the inactive beads lag
};

}  // namespace twincell::sim
