#pragma once
/// \file
/// What `locate` writes of each frame, and its sums over all frames.

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/atomic_file.hpp"
#include "core/output_kind.hpp"
#include "imaging/benchmark/score.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/track/motion_in_exposure.hpp"

namespace twincell::cli {

/// The kind of output of the table of beads: trackpy's columns in trackpy's order, then those of Twincell.
Product table_of_beads();
/// The kind of output of the table of candidates.
Product table_of_candidates();

/// A table that appears complete or not at all. If the name is empty, nothing is written.
class TableFile {
 public:
  TableFile(const std::string& name, const char* heading);
  TableFile& operator<<(const std::string& text);
  /// \throws RunError if the table cannot be written
  void commit();

 private:
  std::string name_;
  std::optional<AtomicPath> path_;
  std::ofstream out_;
};

/// Positions with known truth, by number of the frame.
using TruthOfFrames = std::vector<std::vector<imaging::TruthBead>>;

/// Writes the tables frame by frame, and holds the sums, the score against a truth and one record per frame.
class LocatedFrames {
 public:
  /// \param beads, candidates names of the tables; empty: not written
  /// \param truth if present, the frames are scored against it, in `rows`
  LocatedFrames(const std::string& beads, const std::string& candidates, std::optional<TruthOfFrames> truth,
                const imaging::ScoredRows& rows);

  /// Adds a frame.
  /// \param frame its number in the stack
  /// \param located in px of the whole picture
  void add(std::int64_t frame, const imaging::Located& located);
  /// Lets the tables appear.
  void commit();

  [[nodiscard]] std::size_t frames() const { return records_.size(); }
  [[nodiscard]] std::size_t beads() const { return beads_; }
  /// One line per frame: beads, edge blur, motion during the exposure, time of each stage.
  [[nodiscard]] std::string lines() const;
  /// A sentence if frames are blurred along one direction without evidence of motion; otherwise empty.
  [[nodiscard]] std::string unproven_motion() const;
  /// A sentence if discs overlap in projection; otherwise empty.
  [[nodiscard]] std::string overlaps() const;
  /// Warnings: frames without beads, and candidates that were left out if they are many. Empty if there is no
  /// reason for doubt.
  [[nodiscard]] std::string doubts() const;
  /// The score; of nothing without a truth.
  [[nodiscard]] imaging::Score score() const { return scorer_.score(); }
  /// The score in a sentence; empty without a truth.
  [[nodiscard]] std::string score_text() const;
  /// Members "frames", "left_out" and, with a truth, "truth".
  [[nodiscard]] nlohmann::json document() const;

 private:
  /// One frame, for its line and its part of the document.
  struct Record {
    std::int64_t frame;
    std::size_t beads;
    double blur_px;
    std::vector<imaging::StageReport> stages;
    std::map<imaging::Verdict, std::size_t> dropped;
  };

  TableFile table_, candidates_;
  std::optional<TruthOfFrames> truth_;
  imaging::Scorer scorer_;
  imaging::MotionInExposure motion_;
  std::vector<Record> records_;
  std::map<imaging::Verdict, std::size_t> left_out_;
  std::size_t beads_ = 0, overlapping_ = 0, bare_ = 0;  ///< bare: frames without a bead
};

}  // namespace twincell::cli
