#pragma once
/// \file
/// Event loop of the event-driven solver: finds and handles the events of beads on ballistic paths in order
/// of time, with the contacts and clusters in progress.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/event_driven/ballistic_state.hpp"
#include "sim/event_driven/checkpoint_archive.hpp"
#include "sim/event_driven/event_queue.hpp"
#include "sim/stepping/guard.hpp"

namespace twincell::sim {

/// A contact longer than this, in contact times, is a resting one and is left to time steps.
inline constexpr double kLongestContact = 20;

/// Event-driven motion of a system: free flight from contact to contact. A contact of two bodies is
/// integrated when it begins (binary_collision.hpp). Beads that meet while in contact form a cluster, which
/// is advanced by time steps until they have parted (cluster.hpp).
class EventLoop {
 public:
  using MakeSolver = std::function<std::unique_ptr<Solver>()>;

  /// The beads of a system at its present step, without events yet.
  /// \param plan must outlive the loop
  /// \param few factory of the solver that advances a cluster
  EventLoop(const Plan& plan, const GuardLimits& limits, const System& s, MakeSolver few);

  /// Begins the contacts in progress and finds the first events.
  /// \returns false if three bodies meet
  bool begin(const std::vector<std::pair<std::int32_t, std::int32_t>>& touching);
  /// Advances the beads to step `last` at most, or to the end of the period.
  /// \returns false if three bodies meet at the present step of the system and time steps are needed
  bool advance(System& s, std::int64_t last);
  /// Writes beads and contact forces at the present step of the system.
  void write(System& s);
  /// Contact memories at the last write().
  [[nodiscard]] const std::vector<ContactMemory>& memories() const { return memories_; }
  /// Bytes in use for beads and for contacts.
  [[nodiscard]] Solver::Footprint footprint() const;
  /// Everything, beyond the beads, that the continuation of event-driven motion depends on.
  void save(ArchiveWriter& out) const;
  /// Restores what save() stored.
  void load(ArchiveReader& in);

 private:
  static constexpr double kTolerance = 1e-7;  ///< of a collision
  template <class Self, class Archive>
  static void archive(Self& k, Archive& a);
  template <class Self, class Run, class Archive>
  static void archive_cluster(Self& k, Run& c, Archive& a);
  void begin_period();
  bool handle(std::size_t i, Event event);
  bool find_next_events(std::size_t i, std::size_t j);
  bool find_next_event(std::size_t i);
  template <class Visit>
  static void visit_members(const BinaryContact& c, Visit visit);
  template <class Visit>
  static void visit_members(const ClusterRun& c, Visit visit);
  template <class Visit>
  void visit_intervals(const BinaryContact& c, const std::array<BallisticPath, 2>& after, Visit visit) const;
  template <class Visit>
  void visit_intervals(const BinaryContact& c, Visit visit) const;
  template <class Visit>
  void visit_intervals(const ClusterRun& c, Visit visit) const;
  template <class Visit>
  void visit_interactions(Visit visit) const;
  [[nodiscard]] bool in_cluster(std::int32_t bead) const;
  static PathInterval whole(const BinaryContact& c);
  static PathInterval whole(const ClusterRun& c);
  bool add_near_interactions(const PathInterval& all, std::span<const PathInterval> intervals);
  bool add_near(std::span<const PathInterval> intervals);
  void add_near_one(std::span<const PathInterval> intervals);
  bool begin_contact(std::int32_t i, std::int32_t j);
  bool resolve_cluster(System& s);
  void add_partners(double from);
  bool end_cluster(ClusterRun run, const System& end);
  [[nodiscard]] std::int64_t step_before(double t) const;
  void write_contact(System& s, const BinaryContact& c, const RelativeMotion& m, const Vec3& xi, double t);

  const Plan& plan_;
  GuardLimits limits_;
  MakeSolver make_few_;
  BallisticState beads_;
  EventQueue events_;
  std::vector<BinaryContact> contacts_;  ///< in progress or just ended
  std::vector<ClusterRun> clusters_;
  std::vector<std::int32_t> cluster_;    ///< beads just found to form a cluster
  std::vector<std::int32_t> near_;       ///< buffer of add_near_one()
  std::vector<PathInterval> intervals_;  ///< buffer: those of the contact or cluster being added
  System frame_;                         ///< without beads: walls, drive, period
  double dt_, now_;                      ///< times count from the start of the period
  std::int64_t per_period_, base_;       ///< base_: step at which the period began
  std::vector<ContactMemory> memories_;
};

}  // namespace twincell::sim
