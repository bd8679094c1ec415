#pragma once
/// \file
/// Progress reports of long computations, and their check for cancellation.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace twincell {

class Progress;

/// Calls Progress::update once every kPieces units of work, for loops whose units take microseconds.
class CancellationCheck {
 public:
  explicit CancellationCheck(Progress& progress) : progress_(progress) {}
  /// Call after each unit of work.
  /// \throws as Progress::update
  void operator()();

 private:
  static constexpr unsigned kPieces = 1 << 14;
  Progress& progress_;
  unsigned done_ = 0;
};

/// Passed to every long-running function. The base class does nothing; the program's implementation draws a
/// bar and checks for signals.
class Progress {
 public:
  virtual ~Progress() = default;
  /// Called by the worker between units of work. May throw Interrupted: the stack of the worker then unwinds,
  /// which deletes every unfinished output (atomic_file.hpp).
  virtual void update(std::int64_t /*done*/, std::int64_t /*total*/) {}

  /// A shared do-nothing instance.
  static Progress& none();
};

/// Makes the progress of one stage, named for the user.
using ProgressOf = std::function<std::unique_ptr<Progress>(const std::string& stage)>;

inline void CancellationCheck::operator()() {
  if (++done_ % kPieces == 0) progress_.update(0, 0);  // total 0: there is no bar to draw
}

}  // namespace twincell
