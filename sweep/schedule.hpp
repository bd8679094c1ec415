#pragma once
/// \file
/// Schedule of a sweep: which points are done and which are needed next.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sweep/onset.hpp"
#include "sweep/plan.hpp"
#include "sweep/store.hpp"

namespace twincell::sweep {

/// Part `index` of `of` of a sweep, from 1: every `of`-th point of a grid, or every `of`-th search, in the
/// order of the plan.
struct Shard {
  int index = 1, of = 1;
};

/// A point to compute, with the exclusive right to do so.
struct Task {
  Point point;
  Claim claim;
  std::size_t curve = 0, number = 0;  ///< indices of the result's place in the curves
};

/// Progress of a schedule in points.
struct Counts {
  std::size_t known = 0;  ///< points known to be needed so far; a search may need more
  std::size_t done = 0;
  std::size_t here = 0;    ///< being computed by this process
  std::size_t failed = 0;  ///< done, but the run failed
  double work_left = 0;    ///< particle-steps of the known points that are not done
  std::size_t most = 0;    ///< largest number of points, with all runs that searches may still need
  /// Particle-steps of those that are not done; a run that is not known yet counts as the mean of the known.
  double most_work = 0;
};

/// Points at one set of axis values: part of a grid, or one search.
struct Curve {
  std::vector<std::string> values;
  std::vector<Point> points;
  std::vector<std::optional<std::string>> results;  ///< [points] text of result.json
  std::vector<char> failed;                         ///< [points] whether the run failed
  std::optional<Onset> onset;                       ///< of a search, from its completed rounds
  bool complete = false;
};

/// Determines the open points from the plan and the results so far. A search proceeds in rounds: the points
/// of a round depend only on the plan and the results of the earlier rounds, so the results do not depend on
/// which process computes which point, or when. Not thread-safe.
class Schedule {
 public:
  /// Reads the results that are in the store.
  /// \throws ConfigError for a point with an invalid scene, InputError for a damaged result
  Schedule(const Plan& plan, const Store& store, Shard shard = {});

  /// Claims the longest open point that no process computes. Empty if there is none at present;
  /// more can follow unless all() is true.
  /// \param most largest work of the point, particle-steps; absent: no limit
  /// \throws NotStored, InputError
  std::optional<Task> take(std::optional<double> most = std::nullopt);
  /// Enters the result of a task, which is then done.
  /// \throws ConfigError for a point of the next round with an invalid scene
  void done(const Task& task, const std::string& result);
  /// Whether every point is done.
  [[nodiscard]] bool all() const;
  [[nodiscard]] Counts counts() const;
  /// The open point with the largest work; null: none is open.
  [[nodiscard]] const Point* longest_open() const;
  [[nodiscard]] const std::vector<Curve>& curves() const { return curves_; }
  /// Number of runs of a grid that are left out because they would repeat another run bit for bit: nothing in
  /// their scene depends on the seed. A search moves such a run to another position instead.
  [[nodiscard]] std::size_t repeats() const { return repeats_; }
  /// repeats() as a sentence; empty without any.
  [[nodiscard]] std::string repeats_text() const;
  [[nodiscard]] const Plan& plan() const { return plan_; }

 private:
  void enter_result(std::size_t curve, std::size_t number, const std::string& result);
  void advance(std::size_t curve, std::size_t unseen);

  const Plan& plan_;
  const Store& store_;
  std::vector<Curve> curves_;
  std::size_t repeats_ = 0;
  std::vector<std::vector<char>> here_;  ///< [curves][points] whether this process computes the point
};

/// Answer of a result; empty if the run failed or has no value of the quantity of the criterion.
std::optional<bool> answer_of(const std::string& result);

}  // namespace twincell::sweep
