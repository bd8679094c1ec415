#pragma once
/// \file
/// What `compare` and `match` share: options of the comparison, writing of the report, printing of the
/// result.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/output.hpp"
#include "twin/comparison.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

/// The flags as the command line gives them.
struct ComparingFlags {
  std::string camera_file, s_b = "variance";
  bool no_film = false;
  std::optional<double> neighbour_cutoff;
  std::int64_t discard_cycles = analysis::AnalysisOptions{}.discard_cycles;
  double tolerance = twin::ComparingOptions{}.tolerance;
};

/// --discard, --s-b, --cutoff, --tolerance, --camera, --no-film.
void add_comparing_flags(CLI::App& verb, ComparingFlags& flags);

/// The options of a comparison that the flags state; the files of both sides are still to be added.
/// \throws ConfigError, InputError
twin::ComparingOptions comparing_options(const ComparingFlags& flags, const Common& common);

/// Compares the runs and prints the notes.
/// \throws as compare_runs
analysis::Comparison compare_sides(const Common& common, const twin::ComparingOptions& options);

/// Writes the report of a comparison into `folder` and prints the result.
/// \param result, result_text results of the verb itself, printed after those of the comparison, as JSON and
/// as text
void report_comparison(const Common& common, const twin::ComparingOptions& options,
                       const analysis::Comparison& comparison, const std::filesystem::path& folder,
                       nlohmann::json result, const std::string& result_text);

}  // namespace twincell::cli
