#pragma once
/// \file
/// What `compare` and `match` have in common: options of the comparison, the report, the words at the end.

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

/// What the flags say, resolved. \throws ConfigError, InputError
void resolve(ComparingFlags& flags, const Common& common);

/// Makes progress bars for the library.
ProgressOf progress_bars(const Common& common);

/// Compares, writes the report into `folder`, prints what was found after `said`.
void compare_and_report(const Common& common, const ComparingOptions& options,
                        const std::filesystem::path& folder, nlohmann::json said,
                        const std::string& said_text);

}  // namespace twincell::cli
