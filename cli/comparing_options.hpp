#pragma once
/// \file
/// What `compare` and `match` share: options of the comparison, writing of the report, printing of the
/// result.

#include <filesystem>
#include <memory>
#include <string>

#include "cli/output.hpp"
#include "twin/comparison.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

struct ComparingFlags {
  std::string camera_file, s_b = "variance";
  bool no_film = false;
  ComparingOptions options;
};

/// --discard, --s-b, --cutoff, --tolerance, --camera, --no-film.
void add_comparing_flags(CLI::App& verb, ComparingFlags& flags);

/// Checks the flags and sets `flags.options` from them. \throws ConfigError, InputError
void resolve(ComparingFlags& flags, const Common& common);

/// Returns a function with which the library makes a progress bar for each stage.
ProgressOf progress_bars(const Common& common);

/// Compares the runs, writes the report into `folder` and prints the result. \param said, said_text results
/// of the verb itself, printed before those of the comparison, as JSON and as text
void compare_and_report(const Common& common, const ComparingOptions& options,
                        const std::filesystem::path& folder, nlohmann::json said,
                        const std::string& said_text);

}  // namespace twincell::cli
