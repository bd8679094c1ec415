#pragma once
/// \file
/// The report of a comparison: a folder with figures, tables and a page that opens offline.

#include <filesystem>
#include <string>

#include "analysis/runs/comparison.hpp"
#include "core/output_kind.hpp"
#include "core/progress.hpp"

namespace twincell::analysis {

/// The comparison as text: the conclusion, the phases of both sides at each drive strength, the phase
/// boundaries, and all differences with their attribution.
std::string comparison_text(const Comparison& comparison);

/// As comparison_text for a terminal: one sentence a line, and of the differences only the real ones.
std::string comparison_summary(const Comparison& comparison);

/// The comparison as the text of one JSON object: {"conclusion": "…", "runs": […], "matches": […],
/// "boundaries": […], "differences": […], "notes": […]}.
std::string comparison_json(const Comparison& comparison);

/// The kind of output to which a report folder belongs.
inline Product report_folder() {
  return Product::whole_folder("a report", {"runs.csv", "differences.csv", "series_s_k.csv", "series_s_j.csv",
                                            "phases.txt", "results.json", "provenance.json", "report.html"});
}

/// Writes `folder`, which appears only when it is complete: report.html (one file without external requests),
/// figures/ (SVG, PDF, PNG, .gp, .dat), runs.csv, differences.csv, series_s_k.csv, series_s_j.csv,
/// phases.txt, results.json, provenance.json.
/// \throws ConfigError if the folder cannot be written; RunError if gnuplot is missing
void write_report(const std::filesystem::path& folder, const Comparison& comparison,
                  const std::string& provenance_json, Progress& progress = Progress::none());

}  // namespace twincell::analysis
