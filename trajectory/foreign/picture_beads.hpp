#pragma once
/// \file
/// Files that list beads one by one, each with the number of its frame, in the axes of a picture.

#include <optional>
#include <vector>

#include "trajectory/foreign/format.hpp"

namespace twincell {

/// A reader that has all beads of a file in memory and hands them out frame by frame. The constructor of a
/// format fills `beads_` and `has_`, then calls sort_by_frame().
class PictureBeadsReader : public ForeignReader {
 public:
  /// The beads of the next frame that has any.
  /// \returns false after the last one
  bool next(ForeignFrame& s) final;
  [[nodiscard]] const ForeignColumns& columns() const final { return has_; }
  [[nodiscard]] Vec3 upright(const Vec3& v) const final {
    return from_picture(v, options_.dimension, options_.y_up);
  }
  [[nodiscard]] std::int64_t size() const final { return static_cast<std::int64_t>(beads_.size()); }
  [[nodiscard]] std::int64_t done() const final { return static_cast<std::int64_t>(next_); }

 protected:
  struct BeadOfFrame {
    std::int64_t frame = 0;
    std::optional<double> time;
    ForeignBead bead;
  };

  PictureBeadsReader(const std::filesystem::path& file, const ReadOptions& options)
      : ForeignReader(file), options_(options) {}
  /// Sorts by frame; the order within a frame remains.
  void sort_by_frame();

  ReadOptions options_;
  ForeignColumns has_;
  std::vector<BeadOfFrame> beads_;

 private:
  std::size_t next_ = 0;
};

}  // namespace twincell
