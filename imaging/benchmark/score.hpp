#pragma once
/// \file
/// Scores of located beads and links against known truth.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace twincell::imaging {

/// A bead with known position.
struct TruthBead {
  std::int64_t id = -1;  ///< the same in all frames; -1: unknown, links are not scored
  double x = 0, y = 0;   ///< px
  double r = 0;          ///< px
  double u = 0;          ///< standard uncertainty of x and y, px; 0 if exact
  bool counts = true;    ///< false: not scored, whether found or not (another kind of bead)
};

/// The rows that are scored. They exclude, for example, a water line or a glued base.
struct ScoredRows {
  double first = -1e9;  ///< px; detections and truths above are ignored
  double last = 1e9;    ///< px; detections and truths below are ignored
};

/// The data of a detected bead that scoring needs.
struct FoundBead {
  double x = 0, y = 0;      ///< px
  std::int64_t track = -1;  ///< identity given by the linker; -1: no identity
};

/// Score of one or several frames.
struct Score {
  std::size_t truths = 0;         ///< beads that are scored
  std::size_t found = 0;          ///< of these, beads with a detection within one radius
  std::size_t false_finds = 0;    ///< detections that match no bead
  double rms = 0;                 ///< per coordinate, px: sqrt(mean(dx^2 + dy^2)/2)
  std::size_t sure = 0;           ///< of the found beads, those with the smallest uncertainty u (within 1 %)
  double rms_sure = 0;            ///< rms of these beads
  double bias_x = 0, bias_y = 0;  ///< mean error, px
  std::size_t links = 0;        ///< pairs of consecutive frames in which a bead is found and has an identity
  std::size_t wrong_links = 0;  ///< of these, pairs with two different identities

  /// Share of the beads that are found; 1 without beads.
  [[nodiscard]] double recall() const { return truths > 0 ? double(found) / double(truths) : 1; }
  /// Share of the detections that match a bead; 1 without detections.
  [[nodiscard]] double precision() const {
    return found + false_finds > 0 ? double(found) / double(found + false_finds) : 1;
  }
};

/// Accumulates a score over the frames of a stack, in order. Detections are matched to the nearest truths,
/// closest pair first, within one radius.
class Scorer {
 public:
  /// \throws ConfigError if the first row lies below the last
  explicit Scorer(ScoredRows rows = {});
  /// Adds the next frame.
  void add(const std::vector<TruthBead>& truth, const std::vector<FoundBead>& found);
  /// The score of the frames so far.
  [[nodiscard]] Score score() const;

 private:
  struct Link {
    std::int64_t id, track;
  };
  ScoredRows rows_;
  Score sums_;
  double squares_ = 0, sum_x_ = 0, sum_y_ = 0;
  double least_u_ = HUGE_VAL, squares_sure_ = 0;
  std::vector<Link> previous_;
};

/// \throws InputError naming the file of the truth if no bead of it was scored: a score of nothing is perfect
void require_scored(const Score& score, const std::filesystem::path& truth);

/// Reads the truth of a stack: a file truth.csv, or a folder that contains truth.csv or one truth_NN.csv per
/// frame (natural order). In a file without a column `frame`, all rows belong to frame 0. Columns by name:
/// x_px, y_px, r_px; id, u_px and kind if present (a bead of a kind other than "black" is not scored).
/// \throws InputError naming file and line
std::vector<std::vector<TruthBead>> read_truth(const std::filesystem::path& path);

}  // namespace twincell::imaging
