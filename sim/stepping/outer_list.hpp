#pragma once
/// \file
/// Outer list of the list solver: every pair whose surfaces are closer than a skin. It remains valid until
/// beads may have crossed the skin. Displacements are measured relative to the mean motion, so a bed that
/// rides on its plate keeps its list for thousands of steps.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/stepping/listed_beads.hpp"
#include "sim/stepping/remembered_contacts.hpp"

namespace twincell::sim {

/// A pair within the skin.
struct NearPair {
  std::int32_t i, j;                   ///< places
  std::array<std::int32_t, 3> images;  ///< periods that are added to r_i - r_j
};

/// The pairs of the outer list that contain a bead of one thread. Arrays are padded to whole packets.
struct OuterPairs {
  std::vector<std::int32_t> i, j;  ///< first numbers of the records of the beads
  std::vector<double> shift, reach;
  std::vector<double> constants, memory;  ///< [pair][number]
  std::vector<std::size_t> chunk_end;     ///< [chunk] end of its pairs
  std::vector<std::uint16_t> near,
      touching;                           ///< [packet] one bit per lane, from the last search of near pairs
  std::vector<std::int32_t> remembering;  ///< pairs with memory, since the last inner list
  std::size_t pairs = 0;

  /// Takes the pairs of a thread's beads.
  void assign(const ListedBeads& beads, const BeadShare& share, const std::vector<NearPair>& found,
              const RememberedContacts& remembered, const std::array<double, 3>& period);
  [[nodiscard]] std::size_t bytes() const {
    return bytes_of(i, j, shift, reach, constants, memory, near, touching, remembering, chunk_end);
  }

 private:
  void divide_into_chunks(const BeadShare& share, const std::vector<NearPair>& found);
};

/// Beads are processed in chunks of whole groups, each with at least kChunkPackets packets of pairs (if there
/// are so many). The lanes of a packet are then far enough apart in space that a packet seldom contains a
/// bead twice. The data of a chunk are still in a near cache when its contact forces are complete and its
/// next step begins. With 32 packets, the cost of the calls exceeds the gain.
inline constexpr std::size_t kChunkBeads = 8 * kGroup, kChunkPackets = 128;

/// Listed pairs per bead beyond which the skin is not widened, and a wide one is narrowed. A dense packing
/// has 3 neighbours per bead in 2D and 6 in 3D, each pair counted once.
inline constexpr std::size_t most_listed_pairs(int dimension) {
  return dimension == 2 ? 6 : 10;
}

/// Skin and validity of the outer list.
class OuterList {
 public:
  /// Sets the bounds of the skin, and the skin itself if there is none yet, for the radii and periods of a
  /// system.
  void set_limits(const System& s);
  [[nodiscard]] double skin() const { return skin_; }
  /// Median radius, sigma.
  [[nodiscard]] double usual_radius() const { return usual_radius_; }
  [[nodiscard]] std::int64_t builds() const { return builds_; }

  /// The next check measures the displacements, because the caller may have moved beads.
  void distrust();
  /// The next check finds the list stale.
  void discard();
  /// Registers a new inner list with its margin: pairs of the outer list that may come as close as this may
  /// touch while the inner list is valid.
  /// \param margin sigma
  /// \returns whether the outer list must be built first
  bool is_stale(const PackedBeads& beads, double margin);
  /// Registers that an inner list was built.
  void count_inner_list() { ++inner_lists_; }

  /// Adapts the skin to the number of listed pairs and of inner lists since the last build.
  void adapt_skin(int dimension, std::size_t beads, std::size_t listed);
  /// All pairs within the skin, sorted by place. Narrows the skin until at most most_listed_pairs() per bead
  /// are within it; a narrow skin may contain more.
  [[nodiscard]] std::vector<NearPair> search(const System& s, const BeadOrder& order);
  /// Registers a build: present positions are the reference for displacements.
  void set_reference(const PackedBeads& beads);
  [[nodiscard]] std::size_t bytes() const { return bytes_of(built_); }

 private:
  [[nodiscard]] std::vector<NearPair> pairs_within_skin(const System& s, const BeadOrder& order);
  [[nodiscard]] bool have_crossed(const PackedBeads& beads, double margin);

  double skin_ = 0, widest_skin_ = 0, usual_radius_ = 0;
  std::size_t found_ = 0;                      ///< pairs of the last search
  std::int64_t builds_ = 0, inner_lists_ = 0;  ///< the latter since the last build
  double approach_ = 0;      ///< bound on the approach of two beads since the build; HUGE_VAL: unknown
  double last_margin_ = 0;   ///< of the last inner list
  std::vector<Vec3> built_;  ///< positions at the build
};

}  // namespace twincell::sim
