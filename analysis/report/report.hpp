#pragma once
/// \file
/// The report of a comparison: a folder with figures, tables and one page that opens offline.

#include <filesystem>
#include <string>

#include "analysis/runs/comparison.hpp"
#include "core/output_kind.hpp"
#include "core/progress.hpp"

namespace twincell {

/// Phases of both sides at each drive strength, where they differ, the boundaries, and the differences with
/// what they are attributed to; as text for a terminal.
std::string comparison_text(const Comparison& comparison);

/// The same for machines: {"runs": […], "matches": […], "boundaries": […], "differences": […]}. Text of one
/// JSON object.
std::string comparison_json(const Comparison& comparison);

/// The kind of output that the folder of a report is.
inline Product report_folder() {
  return Product::whole_folder("a report");
}

/// Writes `folder` whole or not at all: report.html (one file, no outside request), figures/ (SVG, PDF, PNG,
/// .gp, .dat), runs.csv, differences.csv, series_s_k.csv, series_s_j.csv, phases.txt, results.json,
/// provenance.json. \throws ConfigError if the folder cannot be written; RunError if gnuplot is missing
void write_report(const std::filesystem::path& folder, const Comparison& comparison,
                  const std::string& provenance_json, Progress& progress = Progress::none());

}  // namespace twincell
