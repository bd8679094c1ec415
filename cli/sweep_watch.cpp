#include "cli/sweep_watch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "core/error.hpp"

namespace twincell::cli {

SweepWatch::SweepWatch(const Common& common, double seconds)
    : quiet_(common.quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      signals_(common, "sweep"),
      seconds_(seconds) {}

SweepWatch::~SweepWatch() {
  if (!quiet_ && terminal_ && !last_.empty()) std::fprintf(stderr, "\r\033[K");
}

double SweepWatch::time_left() const {
  return seconds_ - std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void SweepWatch::look(const sweep::Counts& counts, double seconds_left) {
  try {
    signals_.update(0, 0);
  } catch (const Interrupted& e) {
    throw Interrupted(e.exit_code(),
                      "Stopped by a signal; finished points are kept, and the same command continues.");
  }
  if (quiet_) return;
  std::string line = fmt::format("{} of {} points done, {} running", counts.done, counts.known, counts.here);
  if (counts.failed > 0) line += fmt::format(", {} failed", counts.failed);
  if (std::isfinite(seconds_left)) line += fmt::format(", about {} left", time_text(seconds_left));
  if (line == last_) return;
  last_ = line;
  if (terminal_) {
    std::fprintf(stderr, "\r%s\033[K", line.c_str());
    std::fflush(stderr);
    return;
  }
  if (!due_()) return;
  std::fprintf(stderr, "%s\n", line.c_str());
}

}  // namespace twincell::cli
