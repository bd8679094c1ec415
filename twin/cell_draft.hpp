#pragma once
/// \file
/// Draft of a CELL.toml from the survey of a stack and the answers of its user. Quantities that neither gives
/// are placeholders, which every reader refuses by name.

#include <optional>
#include <string>
#include <vector>

#include "twin/cell_survey.hpp"

namespace twincell::twin {

/// What no camera says of a cell. Absent values are unknown.
struct CellAnswers {
  std::optional<double> sigma_mm;       ///< bead diameter, > 0
  std::optional<double> width_mm;       ///< distance of the side walls, > 0
  std::optional<double> frequency_hz;   ///< of the shaker, > 0
  std::optional<double> gamma;          ///< A omega^2/g, > 0
  std::optional<double> frame_rate_hz;  ///< of the camera, > 0
  double gravity_m_s2 = 9.81;
};

/// One key of the draft.
struct DraftKey {
  std::string key;      ///< "camera.pixels_per_sigma"
  std::string value;    ///< TOML
  std::string comment;  ///< error and method; for a placeholder how to find the value
  /// One per number of a measured value; empty: stated or a placeholder.
  std::vector<calibration::Estimate> measured;
  bool open = false;  ///< a placeholder
};

/// A cell description in preparation.
struct CellDraft {
  std::vector<DraftKey> keys;                  ///< grouped by table
  std::vector<std::string> notes;              ///< sentences: contradictions between answers and stack
  std::optional<calibration::Estimate> gamma;  ///< A omega^2/g, if drive and scale are known
  std::optional<double> pixels_per_sigma;

  /// The key called `key`, with its table; null if the draft has none.
  [[nodiscard]] const DraftKey* find(const std::string& key) const;
};

/// Drafts the cell.
///
/// - sigma: the bead diameter. With `sigma_mm` and `width_mm` and both walls, the scale is
///   W_px sigma_mm / width_mm; otherwise it is d_px, the mean diameter of the beads in px. Of beads that are
///   no plain discs, it is the distance of touching ones, if that is known to 0.2 %: where such a disc ends
///   depends on the light. With `width_mm` alone, sigma_mm = width_mm d_px / W_px.
/// - drive: A is the amplitude of the plate. omega follows from `frequency_hz`, otherwise from the frame rate
///   over the period; without either, from `gamma`, which alone needs no laboratory scale.
///   Gamma = A omega^2 / g.
/// Standard errors are propagated to first order.
CellDraft draft_cell(const CellSurvey& survey, const CellAnswers& answers);

/// The draft as the text of a CELL.toml.
/// \param head first line of the comment: what wrote it
std::string cell_text(const CellDraft& draft, const CellSurvey& survey, const std::string& head);

/// The value in as many decimals as its error has with two significant digits: {12.34567, 0.0021} is
/// "12.3457".
std::string value_text(const calibration::Estimate& e);
/// The error with two significant digits: "0.0021"; "unknown" if it is not finite.
std::string error_text(double error);

}  // namespace twincell::twin
