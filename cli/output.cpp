#include "cli/output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "analysis/trajectory/error.hpp"

namespace twincell::cli {

namespace {

std::atomic<int> caught_signal{0};

extern "C" void remember_signal(int signal) {
  if (caught_signal.exchange(signal) != 0) std::_Exit(128 + signal);  // asked twice: at once
}

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

constexpr int kBarWidth = 30;

}  // namespace

int Common::n_threads() const {
  return threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

Provenance Common::provenance() const {
  Provenance p;
  p.command_line = command_line;
  p.seed = seed;
  p.threads = n_threads();
  return p;
}

std::vector<std::string> with_seed(std::vector<std::string> assignments, const Common& common) {
  constexpr std::uint64_t kLargestSeed = std::uint64_t{1} << 53;  // docs/scene.md, start.seed
  if (common.seed && *common.seed > kLargestSeed)
    throw ConfigError({"", 0, 0, "--seed"},
                      fmt::format("{} is out of range; the seed of a scene must be at most {}.", *common.seed,
                                  kLargestSeed));
  if (common.seed) assignments.push_back(fmt::format("start.seed={}", *common.seed));
  return assignments;
}

CLI::App& add_verb(CLI::App& program, Common& common, const std::string& name, const std::string& summary,
                   const std::string& example) {
  CLI::App& verb = *program.add_subcommand(name, summary);
  verb.footer("Example:\n  " + example);
  verb.add_flag("--json", common.json, "Print one JSON document instead of text");
  verb.add_flag("-q,--quiet", common.quiet, "No progress, no notes");
  verb.add_option("--threads", common.threads, "Threads; 0: one per core")
      ->check(CLI::Range(0, 4096))
      ->envname("TWINCELL_THREADS");
  verb.add_option("--seed", common.seed, "Seed, where chance plays a part");
  return verb;
}

void print_result(const Common& common, const nlohmann::json& document, const std::string& text) {
  const std::string out = common.json ? document.dump(2) + "\n" : text;
  if (std::fwrite(out.data(), 1, out.size(), stdout) != out.size() || std::fflush(stdout) != 0)
    throw RunError("The result cannot be written to standard output.");
}

void note(const Common& common, const std::string& text) {
  if (!common.quiet) std::fprintf(stderr, "note: %s\n", text.c_str());
}

ProgressBar::ProgressBar(const Common& common, std::string label)
    : label_(std::move(label)),
      quiet_(common.quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_ns_(now_ns()) {}

ProgressBar::~ProgressBar() {
  if (!quiet_ && terminal_ && last_percent_ >= 0) std::fprintf(stderr, "\r\033[K");
}

void ProgressBar::update(std::int64_t done, std::int64_t total) {
  if (const int signal = caught_signal.load()) throw Interrupted(static_cast<ExitCode>(128 + signal));
  if (quiet_ || total <= 0) return;
  if (first_ < 0) first_ = done;  // a run that is taken up begins in the middle
  const int percent = static_cast<int>(100 * done / total);
  const int step = terminal_ ? 1 : 10;
  if (last_percent_ >= 0 && percent / step == last_percent_ / step) return;
  last_percent_ = percent;
  const double elapsed = 1e-9 * static_cast<double>(now_ns() - start_ns_);
  const double left =
      done > first_ ? elapsed * static_cast<double>(total - done) / static_cast<double>(done - first_) : 0;
  if (!terminal_) {
    if (percent > 0) std::fprintf(stderr, "%s: %d %%\n", label_.c_str(), percent);
    return;
  }
  const int filled = kBarWidth * percent / 100;
  std::fprintf(stderr, "\r%s [%s%s] %3d %%, %.0f s left \033[K", label_.c_str(),
               std::string(static_cast<std::size_t>(filled), '#').c_str(),
               std::string(static_cast<std::size_t>(kBarWidth - filled), '.').c_str(), percent, left);
  std::fflush(stderr);
}

void watch_signals() {
  struct sigaction action = {};
  action.sa_handler = remember_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A closed pipe, or a file beyond its limit, becomes a failed write, which is reported.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace twincell::cli
