#pragma once
/// \file
/// Beads that were located before: the table of `locate`, or that of another program.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/table.hpp"
#include "imaging/stack/chosen_frames.hpp"
#include "imaging/track/track.hpp"

namespace twincell::imaging {

/// The beads of a table, frame by frame.
struct LocatedTable {
  DetectionStore frames;   ///< of all numbers from the first to the last; those without a row have no bead
  FrameRange range;        ///< their numbers
  double diameter_px = 0;  ///< of the beads, px
  /// Size of the picture, px; if not stated, of the smallest that contains all beads.
  int width_px = 0, height_px = 0;
  bool has_picture = false;   ///< its size is stated
  bool has_errors = false;    ///< the table has sigma_x and sigma_y
  std::string spacing_doubt;  ///< a sentence: beads overlap or are listed twice; otherwise empty
  /// On standard errors that are not used, without a full stop.
  std::vector<std::string> doubts = {};
};

/// A user's statements about a table.
struct LocatedTableOptions {
  /// Column names that differ from the defaults, by quantity.
  std::map<std::string, std::string> columns = {};
  std::optional<double> diameter_px = {};  ///< of the beads; absent: the median of the table's sizes
  /// Width and height of the frames, px; required by a cell with rotation or distortion, which are about
  /// their centre.
  std::optional<std::array<int, 2>> picture = {};
};

/// Whether the name of a stack is that of a table: a file .csv.
bool is_located_table(const std::filesystem::path& name);

/// Reads one bead a row. Columns: `frame`, whole numbers from 0; `x` and `y`, px, y downwards, pixel centres
/// at whole numbers; optional `radius` or `diameter`, px; `sigma_x` and `sigma_y`, standard errors, px,
/// unknown where one of them is 0; `tracer`, 1 or 0. Others are ignored. Rows may have any order.
///
/// \param folder as link_detections
/// \throws InputError naming the row for numbers out of range, a diameter that is not twice the radius,
/// more than 10^7 frames, beads outside the picture, or a table without a size if none is given;
/// ConfigError for columns that are missing or unknown
LocatedTable read_located(const Table& table, const LocatedTableOptions& options,
                          const std::filesystem::path& folder);

/// Links the beads of a table, as track_stack links those of frames. Beads outside the cell are left out, and
/// phases are found from the beads alone.
/// \throws InputError, ConfigError as track_stack
TrackedStack track_located(LocatedTable located, LinkOptions link, const CellDescription& cell,
                           const PhaseSource& source, const std::filesystem::path& folder,
                           Progress& progress = Progress::none());

}  // namespace twincell::imaging
