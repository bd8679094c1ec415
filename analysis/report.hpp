#pragma once
/// \file
/// The report of a comparison: a folder with figures, tables and one page that opens offline.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/phase_diagram.hpp"
#include "analysis/trajectory/progress.hpp"

namespace twincell {

/// Phases of both sides at each drive strength and where they differ, as text for a terminal.
std::string comparison_text(const std::vector<Run>& runs, const std::vector<Match>& matches);

/// The same for machines: {"runs": […], "matches": […]}. Text of one JSON object.
std::string comparison_json(const std::vector<Run>& runs, const std::vector<Match>& matches);

/// Writes `folder` whole or not at all: report.html (figures inline, no outside request, no script), figures/
/// (SVG, PNG, .gp, .dat), runs.csv, series_s_k.csv, series_s_j.csv, phases.txt, results.json,
/// provenance.json. \throws ConfigError if the folder cannot be written; RunError if gnuplot is missing
void write_report(const std::filesystem::path& folder, const std::vector<Run>& runs,
                  const std::vector<Match>& matches, const std::string& provenance_json,
                  Progress& progress = Progress::none());

}  // namespace twincell
