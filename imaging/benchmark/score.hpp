#pragma once
/// \file
/// Located beads against known truth.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace twincell {

/// A bead whose place is known.
struct TruthBead {
  std::int64_t id = -1;  ///< the same in all frames; -1: not known, links are not scored
  double x = 0, y = 0;   ///< px
  double r = 0;          ///< px
  double u = 0;          ///< standard uncertainty of x and y, px; 0 if exact
  bool counts = true;    ///< false: it may be found or not (another kind of bead)
};

/// A band of rows in which finds are not scored (a water line, a glued base).
struct ScoredRows {
  double first = -1e9;  ///< px; finds and truths above are ignored
  double last = 1e9;    ///< px; likewise below
};

/// A found bead as far as scoring is concerned.
struct FoundBead {
  double x = 0, y = 0;      ///< px
  std::int64_t track = -1;  ///< identity given by the linker; -1: none
};

/// Score of one or several frames.
struct Score {
  std::size_t truths = 0;         ///< beads that count
  std::size_t found = 0;          ///< of them, those with a find within a radius
  std::size_t false_finds = 0;    ///< finds that answer to no bead
  double rms = 0;                 ///< per coordinate, px: sqrt(mean(dx^2 + dy^2)/2)
  std::size_t sure = 0;           ///< of the found, those whose truth is as certain as that of any
  double rms_sure = 0;            ///< of these
  double bias_x = 0, bias_y = 0;  ///< mean error, px
  std::size_t links = 0;          ///< pairs of consecutive frames in which a bead was found in both
  std::size_t wrong_links = 0;    ///< of them, those with two identities

  [[nodiscard]] double recall() const { return truths > 0 ? double(found) / double(truths) : 1; }
  [[nodiscard]] double precision() const {
    return found + false_finds > 0 ? double(found) / double(found + false_finds) : 1;
  }
};

/// Accumulates a score over the frames of a stack, in order. Finds are given to the nearest truths, closest
/// pair first, within one radius.
class Scorer {
 public:
  explicit Scorer(ScoredRows rows = {}) : rows_(rows) {}
  void add(const std::vector<TruthBead>& truth, const std::vector<FoundBead>& found);
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

/// Reads the truth of a stack: a file truth.csv, its rows of frame 0 if it has no column `frame`, or a folder
/// with one truth_NN.csv per frame (natural order). Columns by name: x_px, y_px, r_px; id, u_px and kind if
/// there (a kind other than "black" does not count). \throws InputError naming file and line
std::vector<std::vector<TruthBead>> read_truth(const std::filesystem::path& path);

}  // namespace twincell
