#pragma once
/// \file
/// Picture of everything that the survey of a stack measured.

#include "twin/cell_draft.hpp"

namespace twincell::twin {

/// The surveyed frame, enlarged, with the located beads (green; orange if the frame cuts them), the side
/// walls (blue), the plate at its mean height (red) and at its extremes (red, dashed), the origin with the
/// axes x and z (two diameters long), and a scale bar. Next to it a panel with the numbers and a plot of the
/// plate's heights over the first three cycles with the fitted motion. Quantities that were not measured are
/// named in the panel. Lines follow the distortion of the picture.
cv::Mat3b draw_cell(const CellSurvey& survey, const CellDraft& draft);

}  // namespace twincell::twin
