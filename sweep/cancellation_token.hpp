#pragma once
/// \file
/// Cancellation of a running point.

#include <atomic>
#include <cstdint>

#include "core/error.hpp"
#include "core/progress.hpp"

namespace twincell::sweep {

/// Progress that throws Interrupted once `closing` is set, which ends the running point.
class CancellationToken : public Progress {
 public:
  explicit CancellationToken(const std::atomic<bool>& closing) : closing_(closing) {}
  void update(std::int64_t, std::int64_t) override {
    if (closing_) throw Interrupted(ExitCode::interrupted);
  }

 private:
  const std::atomic<bool>& closing_;
};

}  // namespace twincell::sweep
