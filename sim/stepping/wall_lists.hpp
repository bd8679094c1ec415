#pragma once
/// \file
/// Wall lists of the list solver: for each wall, the beads that may touch it soon.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/stepping/inner_list.hpp"

namespace twincell::sim {

/// Displacement and velocity of the plate, sigma and sigma/t0, and its displacement one step earlier.
struct PlateState {
  Vec3 displacement = Vec3::Zero(), velocity = Vec3::Zero(), before = Vec3::Zero();

  bool operator==(const PlateState& other) const {
    return displacement == other.displacement && velocity == other.velocity && before == other.before;
  }
};

/// Margins of the wall lists. A list contains every bead within the margin of its wall. It remains valid
/// until some bead may have approached the wall by the margin.
class WallLists {
 public:
  /// Prepares for a number of walls; all lists are stale.
  void reset(std::size_t walls);
  /// All lists become stale.
  void discard() { all_ = true; }
  /// Registers one step, in which the plate moved.
  /// \param added change of velocities by contacts and gravity since the inner list was built, sqrt(g sigma)
  void add_step(const System& s, const PlateState& plate, const VelocityRange& range, double added);
  /// Whether a list has become invalid.
  [[nodiscard]] bool any_stale() const;
  /// Marks the lists that have become invalid and sets the margins of their successors.
  /// \param skin largest margin, sigma
  void refresh(const System& s, const PlateState& plate, const VelocityRange& range, double skin);
  /// Whether list w must be built.
  [[nodiscard]] bool is_stale(std::size_t w) const { return stale_[w] != 0; }
  /// Margin of list w, sigma.
  [[nodiscard]] double margin(std::size_t w) const { return margin_[w]; }

 private:
  std::vector<double> margin_, approach_;
  std::vector<char> stale_;
  bool all_ = true;
};

/// The beads of one thread that are in a wall list.
struct WallContacts {
  std::vector<ContactPackets> walls;

  /// Begins with the contacts that are remembered.
  void restore(const ListedBeads& beads, const BeadShare& share, const RememberedContacts& remembered);
  /// Builds the stale lists.
  void build(const System& s, ListedBeads& beads, const BeadShare& share, const WallLists& lists);

 private:
  void pack(ListedBeads& beads, const BeadShare& share, std::size_t w, const ContactPackets& old,
            ContactPackets& near) const;
};

}  // namespace twincell::sim
