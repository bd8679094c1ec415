#pragma once
/// \file
/// Which points a sweep needs next.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sweep/onset.hpp"
#include "sweep/plan.hpp"
#include "sweep/store.hpp"

namespace twincell::sweep {

/// Part `index` of `of`, from 1: the points of a grid, or the searches, whose number in the plan leaves that
/// remainder.
struct Shard {
  int index = 1, of = 1;
};

/// A point that is to be computed, with the right to do so.
struct Task {
  Point point;
  Claim claim;
  std::size_t curve = 0, number = 0;  ///< where the result belongs
};

struct Counts {
  std::size_t known = 0;  ///< points that the plan is known to need by now; a search may need more
  std::size_t done = 0;
  std::size_t here = 0;    ///< being computed by this process
  std::size_t failed = 0;  ///< done, but the run went wrong
  double work_left = 0;    ///< particle-steps of known points that are not done
};

/// One set of the axes' values: a part of a grid, or one search.
struct Curve {
  std::vector<std::string> values;
  std::vector<Point> points;
  std::vector<std::optional<std::string>> results;  ///< text of result.json, beside the points
  std::vector<char> failed;                         ///< whether the run went wrong, beside the points
  std::optional<Onset> onset;                       ///< of a search, by the results of its whole rounds
  bool complete = false;
};

/// What is to be done, found from the plan and the results so far. A search asks in rounds: the points of a
/// round follow from the plan and the results of the rounds before, and from nothing else; that is why
/// results do not depend on who computes what when. Not safe for threads.
class Schedule {
 public:
  /// Takes up what the store holds. \throws ConfigError for a point that cannot be, InputError for a damaged
  /// result
  Schedule(const Plan& plan, const Store& store, Shard shard = {});

  /// The longest point that is open and nobody works at. Nothing if there is none now: all() says whether one
  /// may come. \param most particle-steps that the point may have \throws NotStored, InputError
  std::optional<Task> take(double most = 1e300);
  /// Files the result of a task. \throws ConfigError
  void done(const Task& task, const std::string& result);
  /// Puts a task back.
  void give_up(const Task& task);
  /// Whether every point is done.
  [[nodiscard]] bool all() const;
  [[nodiscard]] Counts counts() const;
  [[nodiscard]] const std::vector<Curve>& curves() const { return curves_; }
  /// Runs that the plan asks for and that would repeat another bit for bit, because nothing in their scene is
  /// drawn from the seed; they are left out. Of a grid; a search asks at another place instead.
  [[nodiscard]] std::size_t repeats() const { return repeats_; }
  /// repeats() as a sentence; empty without any.
  [[nodiscard]] std::string repeats_text() const;
  [[nodiscard]] const Plan& plan() const { return plan_; }

 private:
  void file(std::size_t curve, std::size_t number, const std::string& result);
  void advance(std::size_t curve, std::size_t unseen);

  const Plan& plan_;
  const Store& store_;
  std::vector<Curve> curves_;
  std::size_t repeats_ = 0;
  std::vector<std::vector<char>> here_;  ///< beside Curve::points
};

/// What a result answers; nothing if its run went wrong or had no such value.
std::optional<bool> answer_of(const std::string& result);

}  // namespace twincell::sweep
