#pragma once
/// \file
/// Everything that is fitted to one frame by the picture fit (picture_fit.hpp), and the picture it is fitted
/// to: the candidates, the blur that they share, the priors, the darkness d, and its model T = sum_k a_k P_k.
///
/// The steps of the fit hand one FrameModel on: each reads the residual d - T and changes its own part.

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/disc/ring_normal_equations.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/refine/population_priors.hpp"
#include "imaging/refine/refiner.hpp"

namespace twincell::imaging {

/// The disc of the model that belongs to a candidate.
inline Disc disc_of(const Detection& b) {
  return {b.x, b.y, b.radius, b.darkness};
}
/// Sets position, radius and darkness of a candidate.
inline void put(Detection& b, const Disc& d) {
  b.x = d.x, b.y = d.y, b.radius = d.radius, b.darkness = d.darkness;
}

/// The state of the fit of one frame.
class FrameModel {
 public:
  /// \param image must outlive the model
  FrameModel(const Prepared& image, double radius_px, const RefineOptions& options);
  FrameModel(const FrameModel&) = delete;
  FrameModel& operator=(const FrameModel&) = delete;

  const Prepared& image;
  const RefineOptions options;
  const cv::Size size;
  const Noise noise;
  PopulationPriors priors;
  EdgeBlur blur;
  std::optional<bool> blur_has_direction;  ///< as when the bed moves during the exposure; absent: undecided
  std::vector<Detection> beads;            ///< the candidates that are fitted
  std::vector<Detection> dropped;          ///< rejected candidates, each with its verdict
  cv::Mat1f picture;                       ///< darkness d, with spare columns; kUnseen in walls
  cv::Mat1f model;                         ///< T, with spare columns
  bool stale = true;                       ///< the model does not match the beads

  /// Takes a proposal as a candidate, or drops it. A proposal that is bright inside is a void or a clear
  /// bead; one with its centre in a wall is the edge of the wall. Neither is fitted, because it would spoil
  /// the fit of its neighbours.
  void add(const Proposal& p);
  /// Moves a candidate to the dropped ones.
  void drop(const Detection& b, Verdict why);
  /// Before the first sweep: sets the darkness of all beads to the median interior of the proposals.
  void expect_as_dark_as_seen();

  /// Recomputes the model from the beads, in the rows whose index is a multiple of `row_step`.
  void render(int row_step = 1);
  /// Takes another light.
  /// \param levelled d with the new light, with spare columns
  void take_picture(const cv::Mat1f& levelled);
  /// Whether the picture is a copy, not shared with the frame.
  [[nodiscard]] bool owns_picture() const { return owned_; }

  /// The discs of the beads, in their order.
  [[nodiscard]] std::vector<Disc> discs() const;
  /// Half width of the ring, px: out to where the edge carries no more information on the position.
  [[nodiscard]] double ring() const;
  /// Number of pixels in the ring of a bead, of the size closest to its radius, if all of it is visible.
  [[nodiscard]] double full_ring(const Detection& b) const;
  /// Input of the sums over rings. It points to `picture` and `model`.
  [[nodiscard]] RingArgs ring_args() const;

 private:
  bool owned_ = false;
  std::vector<double> interiors_;  // of the proposals
};

}  // namespace twincell::imaging
