#pragma once
/// \file
/// Inner list of the list solver: the pairs of the outer list that free flight at their present velocities
/// brings closer than twice a slack within a horizon. It remains valid until contacts have deflected some
/// bead from free flight by the slack, or until the horizon is reached.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/stepping/outer_list.hpp"

namespace twincell::sim {

/// Pairs and beads that are processed together, up to the given packet of pairs and place of a bead.
struct Chunk {
  std::size_t packet_end, bead_end;
};

/// The pairs of the inner list that contain a bead of one thread.
struct InnerPairs {
  ContactPackets packets;
  std::size_t pairs = 0;      ///< without padding
  std::vector<Chunk> chunks;  ///< every pair of a bead is in its chunk or an earlier one

  /// Finds the pairs that touch or may come closer than `margin` within `horizon`, and moves the contact
  /// memory of the previous list to the new one.
  /// \param split the beads are shared by several threads
  void build(ListedBeads& beads, const BeadShare& share, OuterPairs& outer, double margin, double horizon,
             bool split);
  [[nodiscard]] std::size_t bytes() const { return bytes_of(chunks) + packets.bytes(); }

 private:
  void return_memory(const PacketLayout& layout, OuterPairs& outer) const;
  void distribute(const PacketLayout& layout, const BeadShare& share, const OuterPairs& outer);
  void pack(const PacketLayout& layout, const BeadShare& share, const OuterPairs& outer, bool split);

  std::vector<std::int32_t> touching_, near_;  ///< buffers of distribute()
};

/// Slack, horizon and validity of the inner list.
class InnerList {
 public:
  /// Prepares for `beads` beads; the velocities at the next build are the reference for free flight.
  void reset(const PacketLayout& layout, std::size_t beads);
  /// Stores the velocities of the beads as the reference for free flight, and finds their range.
  void measure_velocities(ListedBeads& beads, const std::vector<BeadShare>& shares);
  /// Adapts slack and horizon for the next list.
  /// \param dt t0
  /// \param skin of the outer list, sigma
  /// \param airborne few of the listed pairs are near
  void set_horizon(double dt, double skin, bool airborne);
  /// Limits slack and horizon so that no bead can arrive from outside an outer list with this skin, sigma.
  void limit_to(double skin);
  /// Begins the validity of a new list.
  void begin();
  /// Registers one step.
  /// \param dt t0
  /// \param strayed largest deviation of a velocity from free flight, sqrt(g sigma)
  void add_step(double dt, double strayed);
  /// Whether the list is still valid after a further step of length dt, t0.
  [[nodiscard]] bool is_valid(double dt) const;

  /// Bound on the approach of two beads while the list is valid, sigma.
  [[nodiscard]] double margin() const { return margin_; }
  /// Largest deviation of a bead from free flight while the list is valid, sigma.
  [[nodiscard]] double slack() const { return slack_; }
  /// Longest time for which the list is valid, t0.
  [[nodiscard]] double horizon() const { return horizon_; }
  /// Steps since the list was built.
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  /// Largest magnitude of a velocity component when the list was built, sqrt(g sigma).
  [[nodiscard]] double fastest() const;
  /// Range of the velocities when the list was built.
  [[nodiscard]] const VelocityRange& range() const { return range_; }
  /// The velocities when the list was built, which are the reference for free flight.
  [[nodiscard]] const double* reference() const { return reference_.data(); }
  [[nodiscard]] std::size_t bytes() const { return reference_.bytes(); }

 private:
  double slack_ = 1e-3, horizon_ = 0, margin_ = 0;
  double deviated_ = 0;  ///< bound on the deviation of a bead from free flight since the build
  std::int64_t steps_ = 0;
  VelocityRange range_{};
  Lines reference_;
};

}  // namespace twincell::sim
