#pragma once
/// \file
/// Functions and options that all verbs share: common options, results on stdout, progress and notes on
/// stderr, signal handling.

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

/// An option whose value names an output file or folder.
struct Output {
  const CLI::Option* option;
  const CLI::App* verb;
  Product product;
};

/// Options that every verb has.
struct Common {
  bool json = false;                  ///< print the result as one JSON document
  bool quiet = false;                 ///< print only errors, and the document of --json
  bool verbose = false;               ///< print every detail of the result
  int threads = 0;                    ///< number of threads; 0: automatic, at most one per core
  std::optional<std::uint64_t> seed;  ///< of the random numbers; absent: the default of the verb
  std::string command_line;
  bool force = false;              ///< replace an existing output file of another kind
  bool result_on_stderr = false;   ///< an output is '-', which occupies standard output
  std::vector<Output> outputs;     ///< output options of all verbs
  const CLI::App* verb = nullptr;  ///< the verb that runs, once its options are read

  /// Number of threads: the option, or the number of cores if the option is 0.
  [[nodiscard]] int n_threads() const;
  /// Provenance with the command line, the number of threads and the seed.
  [[nodiscard]] Provenance provenance() const;
};

/// The --set assignments of a scene, with --seed appended as start.seed.
/// \throws ConfigError for a seed that is larger than a scene allows, and for a key that is given two
/// different values
std::vector<std::string> with_seed(std::vector<std::string> assignments, const Common& common);

/// Adds a subcommand with the common options. Its help ends with the example.
CLI::App& add_verb(CLI::App& program, Common& common, const std::string& name, const std::string& summary,
                   const std::string& example);

/// Adds --seed to a verb that draws random numbers by it; no other verb has the option.
void takes_seed(CLI::App& verb, Common& common);

/// The options that are added to a verb during its lifetime stand under this heading in the help.
class OptionHeading {
 public:
  OptionHeading(CLI::App& verb, std::string heading);
  OptionHeading(const OptionHeading&) = delete;
  OptionHeading& operator=(const OptionHeading&) = delete;
  ~OptionHeading();

 private:
  CLI::App& verb_;
  std::string heading_;
  std::size_t before_;  ///< options
};

/// States what --verbose adds to the result of a verb, as a clause; a verb without this call prints all
/// details in any case.
void has_details(CLI::App& verb, const std::string& what);

/// Declares a former spelling of an option, without a line in the help.
/// \param former as for CLI11: "--omega", "-o,--output"
/// \param present what to write instead; a command that uses the former spelling ends with a ConfigError that
/// names it
void former_option(CLI::App& verb, const std::string& former, const std::string& present);

/// type_name() of an option whose value is a word of this program or a column of a table. Such a value is
/// never an input file, even if a file of that name exists: `reproduce p1-fig3` resumes in the folder
/// p1-fig3.
inline constexpr const char* kWord = "WORD";

/// Declares that an option names an output. Before the verb runs, the output is checked against the output
/// rules (output_rules.hpp), with all other arguments that name existing files as inputs, and is locked.
CLI::Option* writes(Common& common, CLI::App& verb, CLI::Option* option, Product product);

/// Prints the result of a verb: `document` as JSON with --json, otherwise `text`, in lines of at most
/// kColumns columns on a terminal, or nothing with --quiet. The result goes to stderr if an output of the
/// verb is standard output. A reader that has stopped reading, such as head, is not an error.
void print_result(const Common& common, const nlohmann::json& document, const std::string& text);
/// Registers the files that an input names, such as the start of a scene, as inputs too, and refuses an
/// output of the verb that is one of them. Call it before the work. Empty paths are ignored.
/// \throws ConfigError as require_output
void protect_named_inputs(const Common& common, const std::vector<std::filesystem::path>& files);
/// Prints a note or warning on stderr ("note: …"), unless --quiet is set.
void note(const Common& common, const std::string& text);

/// Width of what is printed for people.
inline constexpr std::size_t kColumns = 100;

/// A time in a suitable unit: "40 s", "12 min", "3.5 h".
std::string time_text(double seconds);

/// Whether a minute has passed since the last line of progress, or since the beginning; with the environment
/// variable TWINCELL_PROGRESS_S, whether as many seconds have passed.
class EveryMinute {
 public:
  EveryMinute();
  bool operator()();

 private:
  std::int64_t interval_ns_, last_ns_;
};

/// Shows progress on stderr: a bar with the time left on a terminal, otherwise one line a minute, and nothing
/// with --quiet.
/// Throws Interrupted after SIGINT or SIGTERM.
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
  std::int64_t first_ = -1;  ///< value of `done` at the first update
  std::int64_t start_ns_;
  EveryMinute due_;
};

/// Makes a progress bar for each stage of a function of the library.
ProgressOf progress_bars(const Common& common);

/// Installs the signal handlers. ProgressBar and throw_if_cancelled (cancellation.hpp) react to the signals.
/// A program that has not stopped 0.7 s after a signal is terminated and its unfinished outputs are removed,
/// unless it is saving a run.
void watch_signals();

}  // namespace twincell::cli
