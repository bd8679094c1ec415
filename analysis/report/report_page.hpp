#pragma once
/// \file
/// The page of a report: one file that opens offline, with interactive figures, tables and the figures for
/// print.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/report/figure.hpp"
#include "analysis/runs/comparison.hpp"

namespace twincell::analysis {

/// The page as HTML, without external requests.
/// \param figures which were drawn into `figure_folder` as SVG
std::string report_page(const Comparison& comparison, const std::vector<Figure>& figures,
                        const std::filesystem::path& figure_folder, const std::string& provenance_json);

}  // namespace twincell::analysis
