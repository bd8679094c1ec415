#pragma once
/// \file
/// Figure of the collected results of a sweep: any scalar result, or the onsets, over one or two axes.

#include <string>
#include <vector>

#include "analysis/report/figure.hpp"

namespace twincell::sweep {

/// What a figure of a sweep shows.
struct FigureOptions {
  /// Name of a scalar result; empty: the onsets if the sweep searched for some, else s_c, else the first
  /// scalar result.
  std::string result;
  /// One or two axes of the sweep with numbers: the horizontal axis, and the axis that separates the curves.
  /// Empty: the axes with the most values.
  std::vector<std::string> over;
};

/// Name of the figure: "sweep" with the options that are chosen, as "sweep-s_b-over-drive.gamma". A figure
/// of other options has another name, so that neither replaces the other.
std::string results_figure_name(const FigureOptions& options);

/// The result with its intervals against the first axis, one curve for each value of the other axes.
/// Points that differ only in the seed are shown by their pooled value. An onset with one limit only is a
/// triangle that points to where it lies.
/// \param collected text of collected_json()
/// \throws ConfigError naming the result or axis that does not exist, with those that do; InputError if no
/// point has the result
analysis::Figure results_figure(const std::string& collected, const FigureOptions& options = {});

}  // namespace twincell::sweep
