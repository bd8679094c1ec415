#pragma once
/// \file
/// How long work reports where it is and learns that it should stop.

#include <cstdint>

namespace twincell {

class Progress;

/// Asks a Progress once in so many small pieces of work, for loops whose pieces take microseconds.
class Heed {
 public:
  explicit Heed(Progress& progress) : progress_(progress) {}
  /// After each piece of work. \throws as Progress::update
  void operator()();

 private:
  static constexpr unsigned kPieces = 1 << 14;
  Progress& progress_;
  unsigned done_ = 0;
};

/// Handed to every long function. The default does nothing; the program's own draws a bar and watches for
/// signals.
class Progress {
 public:
  virtual ~Progress() = default;
  /// Called by the worker between units of work. May throw Interrupted: the worker then unwinds, and every
  /// unfinished output disappears with it (atomic_file.hpp).
  virtual void update(std::int64_t /*done*/, std::int64_t /*total*/) {}

  /// A shared do-nothing instance.
  static Progress& none();
};

inline void Heed::operator()() {
  if (++done_ % kPieces == 0) progress_.update(0, 0);  // nothing to draw
}

}  // namespace twincell
