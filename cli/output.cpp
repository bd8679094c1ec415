#include "cli/output.hpp"

#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

#include "core/cancellation.hpp"
#include "core/error.hpp"
#include "core/escape.hpp"
#include "core/json_text.hpp"
#include "core/key_assignments.hpp"
#include "core/output_rules.hpp"
#include "core/temporary_files.hpp"
#include "core/terminal_text.hpp"

namespace twincell::cli {

namespace {

/// Time that the program has to stop by itself after a signal.
constexpr itimerval kPatience{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_usec = 700'000}};

extern "C" void remember_signal(int signal) {
  if (request_cancellation(signal)) {
    setitimer(ITIMER_REAL, &kPatience, nullptr);
    return;
  }
  remove_temporaries();  // second signal: stop at once
  std::_Exit(128 + signal);
}

/// Runs if the program has not stopped in time: it is inside a library that cannot be interrupted, or in one
/// long operation.
extern "C" void end_without_waiting(int /*alarm*/) {
  if (finishing_first()) {  // a run is being saved
    setitimer(ITIMER_REAL, &kPatience, nullptr);
    return;
  }
  remove_temporaries();
  static constexpr char kSaid[] = "twincell: Stopped by a signal; no unfinished file was left behind.\n";
  const auto written = ::write(STDERR_FILENO, kSaid, sizeof kSaid - 1);
  static_cast<void>(written);
  std::_Exit(128 + cancellation_requested());
}

/// Removes unfinished outputs after a fault (such as SIGSEGV), then lets the signal end the program as usual.
extern "C" void clean_up_and_die(int signal) {
  remove_temporaries();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

constexpr int kBarWidth = 30;

/// Refuses the ending of another format for a trajectory, which would be taken for a file of that format.
void refuse_other_format(const std::filesystem::path& name, const Product& product) {
  constexpr std::array kOthers = {".csv", ".xyz", ".json", ".toml", ".png", ".tif", ".mp4", ".avi", ".mat"};
  const std::string extension = name.extension().string();
  if (product.is_trajectory() && std::find(kOthers.begin(), kOthers.end(), extension) != kOthers.end())
    throw ConfigError(
        {.file = name.string(), .key = {}},
        fmt::format("the output is a trajectory (HDF5) and cannot end in {}; name a .h5 file, from "
                    "which twincell export makes other formats.",
                    extension));
}

/// Registers the inputs of the verb, then checks its outputs against the output rules and locks them.
void guard_outputs(const CLI::App& verb, Common& common) {
  common.verb = &verb;
  replace_by_force(common.force);
  const auto is_output = [&](const CLI::Option* option) {
    return std::any_of(common.outputs.begin(), common.outputs.end(),
                       [&](const Output& o) { return o.option == option; });
  };
  // As of an unset variable of a shell, which must not count as an option that was left out.
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& word : option->results())
      if (word.empty())
        throw ConfigError({.file = {}, .key = option->get_name()},
                          "is empty; give a value, or leave it out.");
  for (const CLI::Option* option : verb.get_options()) {
    if (is_output(option) || option->get_type_name() == kWord) continue;
    for (const std::string& word : option->results()) {
      protect_input(word);
      if (const auto inside = word.rfind(":/"); inside != std::string::npos)
        protect_input(word.substr(0, inside));  // FILE.h5:/dataset
      if (const auto equals = word.find('='); equals != std::string::npos)
        protect_input(word.substr(equals + 1));  // --set start.from=FILE
    }
  }
  std::vector<std::filesystem::path> taken;
  for (const Output& output : common.outputs) {
    if (output.verb != &verb || output.option->count() == 0) continue;
    const std::string name = output.option->as<std::string>();
    const std::filesystem::path final = require_output(name, output.product);
    refuse_other_format(name, output.product);
    if (std::find(taken.begin(), taken.end(), final) != taken.end())
      throw ConfigError({.file = name, .key = {}}, "two outputs of one command have this name.");
    taken.push_back(final);
    if (final == kStandardOutput) {
      if (common.json)
        throw ConfigError({.file = {}, .key = "--json"},
                          "standard output cannot receive both the result and the output '-'; name a file.");
      common.result_on_stderr = true;
      continue;
    }
    if (!output.product.shared) hold_until_exit(final);
  }
}

}  // namespace

void protect_named_inputs(const Common& common, const std::vector<std::filesystem::path>& files) {
  for (const std::filesystem::path& file : files)
    if (!file.empty()) protect_input(file);
  for (const Output& output : common.outputs)
    if (output.verb == common.verb && output.option->count() > 0)
      (void)require_output(output.option->as<std::string>(), output.product);
}

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
  refuse_contradictory_assignments(assignments);
  for (const std::string& assignment : assignments)
    if (common.seed && assigned_key(assignment) == "start.seed" &&
        assignment != fmt::format("start.seed={}", *common.seed))
      throw ConfigError({"--set", 0, 0, "start.seed"},
                        fmt::format("contradicts --seed {}; give only one of the two.", *common.seed));
  if (common.seed) assignments.push_back(fmt::format("start.seed={}", *common.seed));
  return assignments;
}

CLI::App& add_verb(CLI::App& program, Common& common, const std::string& name, const std::string& summary,
                   const std::string& example) {
  CLI::App& verb = *program.add_subcommand(name, summary);
  verb.footer("Example:\n  " + example);
  verb.add_flag("--json", common.json, "Print the result as one JSON document instead of text");
  verb.add_flag("-q,--quiet", common.quiet, "Print only errors (with --json also the document)");
  verb.add_flag("-v,--verbose", common.verbose, "Print every detail; this verb always does");
  verb.add_option("--threads", common.threads,
                  "Number of threads; 0 (default): automatic, at most one per core")
      ->check(CLI::Range(0, 4096))
      ->envname("TWINCELL_THREADS");
  verb.add_flag(
      "--force", common.force,
      "Replace an existing output file even if it is of another kind; inputs and folders are never replaced");
  verb.parse_complete_callback([&verb, &common] { guard_outputs(verb, common); });
  return verb;
}

void takes_seed(CLI::App& verb, Common& common) {
  verb.add_option("--seed", common.seed,
                  "Seed of the random numbers, a whole number of at least 0 (for a scene or a sweep at most "
                  "2^53); default: the seed in the input file, otherwise 1");
}

OptionHeading::OptionHeading(CLI::App& verb, std::string heading)
    : verb_(verb), heading_(std::move(heading)), before_(verb.get_options().size()) {}

OptionHeading::~OptionHeading() {
  const std::string default_heading = "Options";  // of CLI11; an inner heading stays, and an empty one hides
  const std::vector<CLI::Option*> all = verb_.get_options();
  for (std::size_t k = before_; k < all.size(); ++k)
    if (all[k]->get_group() == default_heading) all[k]->group(heading_);
}

void has_details(CLI::App& verb, const std::string& what) {
  verb.get_option("--verbose")->description("Print every detail: " + what);
}

void former_option(CLI::App& verb, const std::string& former, const std::string& present) {
  const std::string name = former.substr(former.rfind(',') + 1);
  verb.add_option_function<std::vector<std::string>>(
          former,
          [name, present](const std::vector<std::string>&) {
            throw ConfigError({.file = {}, .key = name},
                              fmt::format("is a former option; write {}.", present));
          })
      ->group("");
}

CLI::Option* writes(Common& common, CLI::App& verb, CLI::Option* option, Product product) {
  common.outputs.push_back({option, &verb, std::move(product)});
  return option;
}

void print_result(const Common& common, const nlohmann::json& document, const std::string& text) {
  if (common.quiet && !common.json) return;
  std::FILE* const stream = common.result_on_stderr ? stderr : stdout;
  std::string out = common.json ? json_text(document, 2) + "\n" : text;
  if (!common.json && ::isatty(::fileno(stream)) == 1) out = fit_columns(out, kColumns);
  const bool written =
      std::fwrite(out.data(), 1, out.size(), stream) == out.size() && std::fflush(stream) == 0;
  if (!written && errno != EPIPE && !common.result_on_stderr)
    throw RunError("The result cannot be written to standard output.");
}

void note(const Common& common, const std::string& text) {
  if (!common.quiet) std::fprintf(stderr, "note: %s\n", one_line(text).c_str());
}

std::string time_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

EveryMinute::EveryMinute() : interval_ns_(60'000'000'000), last_ns_(now_ns()) {
  const char* const stated = std::getenv("TWINCELL_PROGRESS_S");
  double seconds = 0;
  if (stated == nullptr || std::sscanf(stated, "%lf", &seconds) != 1) return;
  if (seconds >= 0 && seconds < 1e6) interval_ns_ = static_cast<std::int64_t>(1e9 * seconds);
}

bool EveryMinute::operator()() {
  const std::int64_t now = now_ns();
  if (now - last_ns_ < interval_ns_) return false;
  last_ns_ = now;
  return true;
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
  if (const int signal = cancellation_requested()) throw Interrupted(static_cast<ExitCode>(128 + signal));
  if (quiet_ || total <= 0) return;
  if (first_ < 0) first_ = done;  // a resumed run does not start at 0
  const int percent = static_cast<int>(100 * done / total);
  if (percent == last_percent_ || (!terminal_ && !due_())) return;
  last_percent_ = percent;
  const double elapsed = 1e-9 * static_cast<double>(now_ns() - start_ns_);
  const double left =
      done > first_ ? elapsed * static_cast<double>(total - done) / static_cast<double>(done - first_) : 0;
  if (!terminal_) {
    std::fprintf(stderr, "%s: %d %%, about %s left\n", label_.c_str(), percent, time_text(left).c_str());
    return;
  }
  const int filled = kBarWidth * percent / 100;
  std::fprintf(stderr, "\r%s [%s%s] %3d %%, %s left \033[K", label_.c_str(),
               std::string(static_cast<std::size_t>(filled), '#').c_str(),
               std::string(static_cast<std::size_t>(kBarWidth - filled), '.').c_str(), percent,
               time_text(left).c_str());
  std::fflush(stderr);
}

void watch_signals() {
  struct sigaction action = {};
  action.sa_handler = remember_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);
  sigaction(SIGQUIT, &action, nullptr);
  std::signal(SIGALRM, end_without_waiting);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(fault, clean_up_and_die);
#endif
  // With these signals ignored, writing to a closed pipe or beyond the file size limit fails and is reported.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

ProgressOf progress_bars(const Common& common) {
  return [&common](const std::string& stage) -> std::unique_ptr<Progress> {
    return std::make_unique<ProgressBar>(common, stage);
  };
}

}  // namespace twincell::cli
