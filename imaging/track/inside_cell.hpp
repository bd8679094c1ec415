#pragma once
/// \file
/// Which located beads are inside the cell.

#include <cstddef>
#include <opencv2/core/types.hpp>
#include <optional>

#include "imaging/cell/cell.hpp"

namespace twincell::imaging {

/// Whether a bead is inside the cell: not beyond the side walls, not more than half a bead above the top, and
/// not below the lowest height of the plate. What the cell does not state excludes nothing.
class InsideCell {
 public:
  /// \param picture size of the frames
  InsideCell(const CellDescription& cell, cv::Size picture);
  bool operator()(PixelPoint centre) const;

 private:
  const CellDescription& cell_;
  std::optional<PixelFrame> frame_;
  std::optional<double> lowest_;
};

/// \throws InputError if there is no bead at all; ConfigError if most beads are outside the cell
/// \param of_table the beads come from a table, not from frames
void require_some_inside(const CellDescription& cell, std::size_t inside, std::size_t outside,
                         bool of_table = false);

}  // namespace twincell::imaging
