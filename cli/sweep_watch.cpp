#include "cli/sweep_watch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "core/error.hpp"

namespace twincell::cli {

namespace {

/// A search may end before its last run.
const char* at_most_of(const sweep::Counts& counts) {
  return counts.most > counts.known ? "at most " : "";
}

}  // namespace

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

void SweepWatch::expect(const sweep::Counts& counts, double seconds) {
  if (quiet_) return;
  const char* at_most = at_most_of(counts);
  if (terminal_) std::fprintf(stderr, "\r\033[K");
  std::fprintf(stderr, "%s\n",
               fmt::format("{}{} open points, {:.3g} particle-steps: {}about {}{}", at_most,
                           counts.most - counts.done, counts.most_work, at_most, time_text(seconds),
                           seconds > time_left()
                               ? fmt::format(", of which the time limit allows {}", time_text(time_left()))
                               : "")
                   .c_str());
}

void SweepWatch::look(const sweep::Counts& counts, double seconds_left) {
  try {
    signals_.update(0, 0);
  } catch (const Interrupted& e) {
    throw Interrupted(e.exit_code(),
                      "Stopped by a signal; finished points are kept, and the same command continues.");
  }
  if (quiet_) return;
  const char* at_most = at_most_of(counts);
  std::string line =
      fmt::format("{} of {}{} points done, {} running", counts.done, at_most, counts.most, counts.here);
  if (counts.failed > 0) line += fmt::format(", {} failed", counts.failed);
  if (std::isfinite(seconds_left)) line += fmt::format(", {}about {} left", at_most, time_text(seconds_left));
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
