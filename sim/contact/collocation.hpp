#pragma once
/// \file
/// One step of a binary collision (binary_collision.hpp), which extends at most from one kink of the force to
/// the next. The motion is a degree-8 polynomial that satisfies the equation of motion at eight stages, the
/// Radau points (order 15 at the end of the step: E. Hairer, G. Wanner, Solving Ordinary Differential
/// Equations II, 2nd ed., Springer 1996, section IV.5). The eight stages are evaluated together in SIMD and
/// iterated until they no longer change. Each iteration includes the response of the normal spring to the
/// change, so each change is small against the one before. These steps replaced Runge-Kutta steps of order 8
/// (Dormand and Prince), which evaluate one force after another and need as many forces for a short interval
/// between two kinks as for a long one.

#include <array>
#include <cstddef>

namespace twincell::sim {

inline constexpr std::size_t kStages = 8;

/// A linear map of the values at the stages, stored by columns.
struct alignas(64) StageMap {
  double column[kStages][kStages];
};

/// Response of an oscillator of frequency omega to an applied acceleration, for one value of omega h. With
/// the integration matrix A (Collocation::once), R = (1 + (omega h)^2 A^2)^-1 maps the applied acceleration
/// at the stages to the acceleration of the oscillator. The products of R with powers of A give its velocity
/// and position.
struct OscillatorResponse {
  double width;                  ///< omega h
  StageMap once, twice, thrice;  ///< R A, R A^2, R A^3
};

/// Coefficients of the method, for a step from 0 to 1.
struct Collocation {
  alignas(64) double moment[kStages];
  StageMap once;                           ///< A: values to integrals from 0 to the stages
  StageMap twice;                          ///< A^2: values to double integrals
  double last[2][kStages];                 ///< values to the last two of the eight Legendre coefficients
  double place[1 + kStages];               ///< the start and the stages ...
  double weight[1 + kStages];              ///< ... and their weights in the barycentric formula
  static constexpr double kWidest = 1.75;  ///< largest omega h for which a response is stored
  static constexpr std::size_t kWidths = 16;
  OscillatorResponse response[kWidths + 1];  ///< for omega h = kWidest k/kWidths

  /// The coefficients, computed at the first call.
  static const Collocation& numbers();
};

/// Initial data of a step. Vectors have one component per dimension; spins have three in 3D and one in the
/// plane.
struct CollocationStart {
  const double *normal_law, *tangential_law;  ///< constants of the two laws
  double reach, inv_mass;                     ///< R_i + R_j; 1/m_eff
  double turn, h;                             ///< R^2/I summed over the beads; length of the step, t0
  double frequency, damping;  ///< of the oscillator that approximates the normal force, per mass
  double relaxation;          ///< rate at which friction slows the surfaces, for the initial guess
  const double* wall;         ///< normal of the wall; null between beads
  const double* push;         ///< other accelerations at the stages, one row per direction; null if none
  bool pressed, slides;       ///< the regime of the force, whose formula is also used outside its range
  const double* numbers;      ///< r, u, s at the start
  const double* slopes;       ///< time derivatives of u and s at the start
  const double* normal;
  double enough;  ///< tolerance on velocities
  const Collocation* method;
  const OscillatorResponse* response;  ///< of the oscillator that approximates the normal force; null if none
};

/// The motion at the eight stages.
struct CollocationMotion {
  alignas(64) double numbers[9][kStages];  ///< r, u, s
  alignas(64) double slopes[6][kStages];   ///< time derivatives of u and s
  alignas(64) double overlap[kStages], f_n[kStages], slack[kStages];
  double deepest;  ///< largest overlap at a stage
  double change;   ///< estimated change of the velocities in a further iteration
};

using CollocationStep = void (*)(const CollocationStart&, CollocationMotion&);

}  // namespace twincell::sim
