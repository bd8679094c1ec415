#pragma once
/// \file
/// The page on both papers: for every figure and table the statements, the measured values, the verdicts.

#include <string>
#include <vector>

namespace twincell::reproduce {

/// The result of one figure or table, as `reproduce NAME` writes it to NAME.json.
struct Document {
  std::string name;           ///< "p1-fig3"
  std::string text;           ///< JSON with title, targets, runs and core_minutes
  bool judges_again = false;  ///< Reproducible::judges_again: shown, but not in the sum
};

/// The page as Markdown: a table of the verdicts per figure, and for each figure a table with the paper's
/// statement, the measured value with its 95 % interval, the runs behind it, the verdict, and what decides
/// it. The cost of a figure is the processor time of its runs; figures without a recorded
/// cost have none. \param command the command that made the page, for its first paragraph \throws
/// nlohmann::json::exception for a text that is not such a document
std::string papers_page(const std::vector<Document>& documents, const std::string& command);

}  // namespace twincell::reproduce
