#pragma once
/// \file
/// What all verbs share: common options, results on stdout, progress and warnings on stderr, signals.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/output_kind.hpp"
#include "core/progress.hpp"
#include "core/provenance.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace twincell::cli {

/// An option that names an output.
struct Output {
  const CLI::Option* option;
  const CLI::App* verb;
  Product product;
};

/// Options every verb has.
struct Common {
  bool json = false;                  ///< stdout is one JSON document
  bool quiet = false;                 ///< no progress, no notes
  int threads = 0;                    ///< 0: one per core
  std::optional<std::uint64_t> seed;  ///< where chance plays a part
  std::string command_line;
  bool force = false;             ///< an output file of another kind may be replaced
  bool result_on_stderr = false;  ///< standard output is taken by an output '-'
  std::vector<Output> outputs;    ///< the options that name outputs, of all verbs

  /// Threads to use: the option, or the number of cores.
  [[nodiscard]] int n_threads() const;
  /// Provenance with command line, threads and seed filled in.
  [[nodiscard]] Provenance provenance() const;
};

/// \throws ConfigError for a key that --set says twice in different words
void refuse_said_twice(const std::vector<std::string>& assignments);

/// The --set of a scene, and --seed as one of them. \throws ConfigError for a seed that no scene can have,
/// and for a key that is said twice in different words
std::vector<std::string> with_seed(std::vector<std::string> assignments, const Common& common);

/// Makes a subcommand with the common options and an example in its help.
CLI::App& add_verb(CLI::App& program, Common& common, const std::string& name, const std::string& summary,
                   const std::string& example);

/// type_name() of an option whose value is a word of this program or of a table, and no file even where a
/// file has that name: `reproduce p1-fig3` goes on in the folder p1-fig3.
inline constexpr const char* kWord = "WORD";

/// Declares that an option names an output. Before the verb begins its value is held against the rules of
/// outputs (output_rules.hpp), with all other arguments that name something on the disk as inputs, and
/// locked.
CLI::Option* writes(Common& common, CLI::App& verb, CLI::Option* option, Product product);

/// Prints the result of a verb: `document` as JSON if --json was given, else `text`. On stderr where an
/// output of the verb is standard output.
void print_result(const Common& common, const nlohmann::json& document, const std::string& text);
/// A note or warning on stderr ("note: …"), unless --quiet.
void note(const Common& common, const std::string& text);

/// Draws a bar on stderr if it is a terminal, a line per 10 % if not, nothing with --quiet. Throws
/// Interrupted after SIGINT or SIGTERM.
class ProgressBar : public Progress {
 public:
  ProgressBar(const Common& common, std::string label);
  ~ProgressBar() override;
  void update(std::int64_t done, std::int64_t total) override;

 private:
  std::string label_;
  bool quiet_;
  bool terminal_;
  int last_percent_ = -1;
  std::int64_t first_ = -1;  ///< done at the first update
  std::int64_t start_ns_;
};

/// Installs the signal handlers that ProgressBar and throw_if_cancelled (cancellation.hpp) heed. Work that
/// has not ended 0.7 s after it was asked to is ended, and its unfinished outputs are removed, unless it is
/// saving a run.
void watch_signals();

}  // namespace twincell::cli
