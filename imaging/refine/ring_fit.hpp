#pragma once
/// \file
/// Gauss-Newton sweeps of the picture fit: the normal equations of all discs on their rings
/// (ring_normal_equations.hpp), their bounded steps, and the uncertainties that follow from them.

#include <optional>
#include <vector>

#include "imaging/refine/frame_model.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

/// The first sweep reads every so many rows: half the pixels suffice while the positions are rough.
inline constexpr int kFirstRows = 2;
/// After so many sweeps the 2 % of the discs that move most are ignored: they are not beads.
inline constexpr int kSweepsBeforeTrimming = 12;

/// Result of a sweep.
struct SweepResult {
  double most = 0;      ///< largest step of a bead, px
  double rms = 0;       ///< rms step per coordinate, px
  double sigma = 0;     ///< uncertainty of a typical bead's position, px
  bool damped = false;  ///< so the lengths do not measure convergence
  bool pruned = false;  ///< beads were dropped before this step
  double blur = 0;      ///< change of s^2, as returned by `fit_blur`
};

/// Sweeps over the discs of one frame.
class RingFit {
 public:
  /// \param frame must outlive the fit
  explicit RingFit(FrameModel& frame) : frame_(frame) {}

  /// One Gauss-Newton step of all discs and of the blur. The order of the beads does not matter. If the
  /// previous step made the fit worse, it is undone and repeated with more damping.
  SweepResult sweep(BlurFit fit);
  /// To be called after a change of the picture: the misfits before and after it cannot be compared.
  void picture_changed() { before_.reset(); }
  /// To be called after a change of the set of beads.
  void beads_changed();
  /// Ends the fit, although another step would move each bead by this fraction of its last step.
  void leave(double share);
  /// The beads with their uncertainties and measures. Call it once, at the end.
  Refined result();

 private:
  struct State {
    std::vector<Disc> discs;
    EdgeBlur blur;
    double misfit;  // mean square of the residuals, darkness^2
  };
  /// Normal equations of each disc by itself.
  struct Equations {
    std::vector<Normal> blocks;
    std::vector<Step> right;
  };

  void evaluate(const RingArgs& args, BlurFit fit);
  [[nodiscard]] double misfit() const;
  void undo_step();
  void accept_step(double misfit);
  bool prune();
  [[nodiscard]] std::optional<Verdict> objection_to(std::size_t bead) const;
  void begin_couplings(const RingArgs& args, const std::vector<Disc>& discs);
  [[nodiscard]] Equations equations() const;
  SweepResult step(const RingArgs& args, BlurFit fit);
  double move(Detection& b, const Step& step) const;
  void summarise(std::vector<double> far, std::vector<double> sigma, SweepResult& moved) const;
  [[nodiscard]] double correlation() const;
  [[nodiscard]] std::vector<Normal> covariances() const;
  void measure(Detection& b, const RingSums& s, const Normal& by_noise, double rho, double unsettled) const;

  // Relative addition to the diagonal; it is increased only while steps make the fit worse.
  static constexpr double kDamping = 0.002;

  FrameModel& frame_;
  std::vector<RingSums> sums_;         // of the last sweep
  std::vector<RingSums> sums_before_;  // of the sweep before that
  std::optional<State> before_;        // before the last step; empty after a change of picture or beads
  double damping_ = kDamping;
  int sweeps_ = 0;
  std::vector<double> unsettled_;    // error of each bead from incomplete convergence, px
  std::vector<Coupling> couplings_;  // empty after a change of the set of beads
  std::vector<double>
      moved_since_coupling_;  // of each bead since its couplings were computed, px and darkness
};

}  // namespace twincell::imaging
