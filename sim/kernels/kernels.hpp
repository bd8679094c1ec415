#pragma once
/// \file
/// Kernels: the inner loops of a run, as plain functions over plain arrays. They compute the contacts of a
/// pair list, the contacts with a wall, the integration of all beads, and the search for pairs near contact.
/// The same source (simd_kernels.hpp) is compiled once per instruction set; Target::find() returns the
/// kernels of a set of laws.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/contact/collocation.hpp"
#include "sim/contact/contact_constants.hpp"
#include "sim/contact/velocity.hpp"

namespace twincell::sim {

/// Memory layout of a bead in kernels, with as few cache lines as possible.
///
/// Record, 2D: x z vx vz; 3D: x y z 0 | vx vy vz 0. During a run velocities and spins are those in the middle
/// of the step. Contact forces, 2D: fx fz q 0; 3D: fx fy fz 0 | qx qy qz 0. Spins R w, 2D: one number; 3D: x
/// y z 0.
template <int D>
inline constexpr int kRecord = D == 2 ? 4 : 8;
template <int D>
inline constexpr int kForceRecord = kRecord<D>;
template <int D>
inline constexpr int kSpinRecord = D == 2 ? 1 : 4;

/// Index of the spin of the bead whose record begins at number i.
template <int D>
constexpr std::int32_t spin_place(std::int32_t i) {
  return i / (kRecord<D> / kSpinRecord<D>);
}

/// Arguments of the pair kernel: contacts of listed pairs. An index is that of the first number of a bead's
/// record, kRecord times the place of the bead. Indices are grouped in packets of the width of the SIMD
/// vectors. `memory`, `shift` and per-pair constants are [packet][number][lane].
struct PairArgs {
  const double* records;
  const double* spins;
  double* forces;
  const std::int32_t* i;
  const std::int32_t* j;
  const std::int32_t* force_i;  ///< where the force on i is added; a dummy if another thread owns the bead
  const std::int32_t* force_j;
  double* memory;
  const double* constants;
  std::ptrdiff_t constants_step;  ///< numbers per packet; 0: one set for all
  const double* shift;            ///< added to r_i - r_j (periodic images), or null
  std::int64_t packets;
  double dt;
  bool locate;     ///< see contact.hpp act()
  double quantum;  ///< rounding constant of force sums, contact.hpp rounded()
};

/// Arguments of the wall kernel: contacts of listed beads with one wall.
struct WallArgs {
  const double* records;
  const double* spins;
  double* forces;
  const std::int32_t* bead;
  double* memory;
  const double* constants;
  std::ptrdiff_t constants_step;
  std::int64_t packets;
  double n[3];         ///< inward normal; 2D: (n_x, n_z)
  double offset;       ///< n . w at present
  double velocity[3];  ///< of the wall: at present, or with Velocity::full_step the mean over the step
  double dt;
  bool locate;
  double quantum;
};

/// Largest |v - reference| of any bead, by component: the deviation from free flight since the reference was
/// taken.
struct Deviation {
  double most[3];
};

/// Beads begin .. end - 1. In 2D both bounds are whole multiples of kGroup from the first bead of a thread,
/// except at the last bead of the thread: beads that are moved together also store their reference together.
struct BeadRange {
  std::int64_t begin, end;
};
inline constexpr int kGroup = 8;

/// Arguments of the integration: half kicks, then optionally a drift. With a drift the forces are set to zero
/// after they are read.
struct IntegrateArgs {
  double* records;
  double* spins;
  double* forces;
  const double* inv_mass;       ///< [bead][4] 1/m in the places of the velocities, else 0; or one row
  const double* turn;           ///< [bead] R^2/I; or one number
  std::ptrdiff_t inertia_step;  ///< 1; or 0 if all beads are equal
  const BeadRange* runs;        ///< beads to be moved
  std::int64_t n_runs;
  const double* reference;  ///< velocities when the list was built, as stored by the range kernel
  double fallen[3];         ///< velocity that gravity has added since
  int kicks;                ///< 1 or 2 half kicks
  bool drift;
  bool spin;
  double dt;
  double gravity[3];  ///< 2D: (g_x, g_z)
};

/// Arguments of free flight: several steps at once for beads without contacts. The result is that of the
/// integration kernel.
struct FreeFlightArgs {
  double* records;
  const BeadRange* runs;
  std::int64_t n_runs;
  std::int64_t steps;
  double dt;
  double gravity[3];
};

/// Arguments of the velocity range: copies the velocities, which are the reference for free flight, and finds
/// their range.
struct VelocityRangeArgs {
  const double* records;
  double* reference;  ///< 2D: two numbers per bead, in an order internal to the kernels; 3D: four
  BeadRange beads;    ///< all beads of a thread
};

/// Range of each velocity component.
struct VelocityRange {
  double least[3], most[3];
};

/// Arguments of the near-pair search: listed pairs whose gap may fall below `margin` within the time
/// `horizon` if both beads fly freely. The bound is |d + w t| >= |d| + t (d . w)/|d|.
struct NearPairArgs {
  const double* records;
  const std::int32_t* i;
  const std::int32_t* j;
  const double* reach;
  std::ptrdiff_t reach_step;
  const double* shift;
  std::int64_t packets;
  double margin;
  double horizon;
  std::uint16_t* touching;  ///< [packet] one bit per lane: in contact at present
  std::uint16_t* near;      ///< [packet] one bit per lane: near in the above sense
};

using PairKernel = double (*)(const PairArgs&);  ///< returns the largest overlap
using WallKernel = double (*)(const WallArgs&);  ///< returns the largest overlap
using IntegrateKernel = Deviation (*)(const IntegrateArgs&);
using FreeFlightKernel = void (*)(const FreeFlightArgs&);
using VelocityRangeKernel = VelocityRange (*)(const VelocityRangeArgs&);
using NearPairKernel = void (*)(const NearPairArgs&);

/// The kernels of one set of laws.
struct Kernels {
  PairKernel pairs;
  WallKernel walls;
  IntegrateKernel integrate;
  FreeFlightKernel fly;
  VelocityRangeKernel range;
  NearPairKernel scan;
  int remembered;  ///< numbers that each contact remembers
};

/// Selects the kernels. Laws are given by their indices in the lists of laws/axes.hpp.
struct KernelKey {
  int dimension;
  std::size_t normal, tangential, rolling;
  Velocity velocity;
};

/// One instruction set.
struct Target {
  std::string_view name;
  int width;  ///< contacts per packet
  bool (*available)();
  Kernels (*find)(const KernelKey&);
  /// Collocation step of binary collisions (collocation.hpp).
  /// \param normal, tangential indices of laws; null for laws that cannot be integrated separately
  CollocationStep (*find_step)(std::size_t normal, std::size_t tangential, int dimension);
};

extern const Target kScalar;
extern const Target kAvx2;
extern const Target kAvx512;
/// The widest instruction set that this processor supports.
const Target& widest_target();

}  // namespace twincell::sim
