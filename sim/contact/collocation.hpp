#pragma once
/// \file
/// One step of an collision (binary_collision.hpp), from one kink of the force to the next at most: the
/// motion is a polynomial of degree 8 that obeys its equation at eight moments, the Radau points (order 15 at
/// the end of the step: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer
/// 1996, section IV.5). The eight are computed at once, in the lanes of vectors, and again and again until
/// nothing changes; what the normal spring makes of a change is put in beforehand, so that each time the
/// change is small against the one before. Runge-Kutta steps of order 8 (Dormand and Prince) were here
/// before: one force after the other, and as many for the short way between two kinks as for the long ones.

#include <array>
#include <cstddef>

namespace twincell::sim {

inline constexpr std::size_t kMoments = 8;

/// A linear map of the values at the moments, by columns.
struct alignas(64) MomentMap {
  double column[kMoments][kMoments];
};

/// What an oscillator of frequency omega makes of what its force lacks, for one omega h: with A the integral,
/// R = (1 + (omega h)^2 A^2)^-1 leads to its acceleration, and
struct OscillatorResponse {
  double width;                   ///< omega h
  MomentMap once, twice, thrice;  ///< R A, R A^2, R A^3
};

/// Numbers of the method, for a step from 0 to 1.
struct Collocation {
  alignas(64) double moment[kMoments];
  MomentMap once;                          ///< values to integrals from 0 to the moments
  MomentMap twice;                         ///< and again
  double last[2][kMoments];                ///< values to the last two of their eight Legendre coefficients
  double place[1 + kMoments];              ///< the start and the moments ...
  double weight[1 + kMoments];             ///< ... and what each weighs in the barycentric formula
  static constexpr double kWidest = 1.75;  ///< omega h, of an oscillator that is put in
  static constexpr std::size_t kWidths = 16;
  OscillatorResponse response[kWidths + 1];  ///< for omega h = kWidest k/kWidths

  static const Collocation& numbers();
};

/// What a step starts from. Lists have as many numbers as there are dimensions, of spin three, or one in the
/// plane.
struct CollocationStart {
  const double *normal_law, *tangential_law;  ///< their constants
  double reach, inv_mass, turn, h;
  double frequency, damping;  ///< of the oscillator that the normal force is like; over the mass
  double relaxation;          ///< rate at which friction slows the surfaces, for a first guess
  const double* wall;         ///< its normal; null between beads
  const double* push;         ///< other accelerations at the moments, a row of them per direction; null: none
  bool pressed, slides;       ///< the regime of the force, which is continued beyond where it holds
  const double* numbers;      ///< r, u, s
  const double* slopes;       ///< of u and s
  const double* normal;
  double enough;  ///< what velocities may be off by
  const Collocation* method;
  const OscillatorResponse* response;  ///< of an oscillator like the normal force; null: none
};

/// The motion at the eight moments.
struct CollocationMotion {
  alignas(64) double numbers[9][kMoments];  ///< r, u, s
  alignas(64) double slopes[6][kMoments];   ///< of u and s
  alignas(64) double overlap[kMoments], f_n[kMoments], slack[kMoments];
  double deepest;  ///< overlap
  double change;   ///< of a further pass, about
};

using CollocationStep = void (*)(const CollocationStart&, CollocationMotion&);

}  // namespace twincell::sim
