#pragma once
/// \file
/// How a point that is being computed is told that its farm closes.

#include <atomic>
#include <cstdint>

#include "core/error.hpp"
#include "core/progress.hpp"

namespace twincell::sweep {

/// Ends a point when the farm closes.
class Until : public Progress {
 public:
  explicit Until(const std::atomic<bool>& closing) : closing_(closing) {}
  void update(std::int64_t, std::int64_t) override {
    if (closing_) throw Interrupted(ExitCode::interrupted);
  }

 private:
  const std::atomic<bool>& closing_;
};

}  // namespace twincell::sweep
