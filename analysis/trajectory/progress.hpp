#pragma once
/// \file
/// How long work reports where it is and learns that it should stop.

#include <cstdint>

namespace twincell {

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

}  // namespace twincell
