#pragma once
/// \file
/// The loops that take the time, as plain functions over plain arrays: contacts of a pair list, contacts with
/// a wall, the integration of all beads, and the search for pairs near contact. Each is compiled once per
/// instruction set from the same text (simd_kernels.hpp), and found here by the laws it is for.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/contact/collocation.hpp"
#include "sim/contact/contact.hpp"

namespace twincell::sim {

/// A bead as kernels hold it, in as few cache lines as it takes. Record, 2D: x z vx vz; 3D: x y z 0 | vx vy
/// vz 0. During a run velocities and spins are those of the middle of the step. Contact forces, 2D: fx fz q
/// 0; 3D: fx fy fz 0 | qx qy qz 0. Spins R w, 2D: one number; 3D: x y z 0.
template <int D>
inline constexpr int kRecord = D == 2 ? 4 : 8;
template <int D>
inline constexpr int kForceRecord = kRecord<D>;
template <int D>
inline constexpr int kSpinRecord = D == 2 ? 1 : 4;

/// Where the spin of the bead stands whose record begins at number i.
template <int D>
constexpr std::int32_t spin_place(std::int32_t i) {
  return i / (kRecord<D> / kSpinRecord<D>);
}

/// Contacts of listed pairs. Indices are those of the first number of a bead's record, kRecord times its
/// place; they come in packets as wide as the vectors. `memory`, `shift` and per-pair constants are
/// [packet][number][lane].
struct PairArgs {
  const double* records;
  const double* spins;
  double* forces;
  const std::int32_t* i;
  const std::int32_t* j;
  const std::int32_t* force_i;  ///< where the force on i is added; a dummy where another thread owns the bead
  const std::int32_t* force_j;
  double* memory;
  const double* constants;
  std::ptrdiff_t constants_step;  ///< numbers per packet; 0: one set for all
  const double* shift;            ///< added to r_i - r_j (periodic images), or null
  std::int64_t packets;
  double dt;
  bool locate;   ///< contact.hpp act()
  double magic;  ///< grain of the sums, contact.hpp rounded()
};

/// Contacts of listed beads with one wall.
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
  double offset;       ///< n . w now
  double velocity[3];  ///< of the wall: now, or with Velocity::full_step its mean over the step
  double dt;
  bool locate;
  double magic;
};

/// Largest |v - reference| of any bead, by component: how far beads are from flying freely since the
/// reference was taken.
struct Deviation {
  double most[3];
};

/// Beads from begin to before end. In 2D both are whole multiples of kGroup from where the beads of a thread
/// begin, except its very end: what is moved together also keeps its reference together.
struct BeadRange {
  std::int64_t begin, end;
};
inline constexpr int kGroup = 8;

/// Half kicks, then (optionally) a drift; forces are read and set to zero if drifting.
struct IntegrateArgs {
  double* records;
  double* spins;
  double* forces;
  const double* inv_mass;       ///< [bead][4] 1/m where a row has velocities, 0 elsewhere; or one row
  const double* turn;           ///< [bead] R^2/I; or one
  std::ptrdiff_t inertia_step;  ///< 1; or 0 if all beads are alike
  const BeadRange* runs;        ///< beads to be moved
  std::int64_t n_runs;
  const double* reference;  ///< velocities at the time the list was made, as the range pass left them
  double fallen[3];         ///< what gravity has added to all of them since
  int kicks;                ///< 1 or 2 half kicks
  bool drift;
  bool spin;
  double dt;
  double gravity[3];  ///< 2D: (g_x, g_z)
};

/// Beads that nothing touches, several steps at once: what the integrate pass would do to them.
struct FreeFlightArgs {
  double* records;
  const BeadRange* runs;
  std::int64_t n_runs;
  std::int64_t steps;
  double dt;
  double gravity[3];
};

/// Velocities from which free flight is computed: copied, and their range found.
struct VelocityRangeArgs {
  const double* records;
  double* reference;  ///< 2D: two numbers a bead, in an order of the pass's own; 3D: four
  BeadRange beads;    ///< all of a thread's
};

/// Of the components of velocities.
struct VelocityRange {
  double least[3], most[3];
};

/// Which listed pairs may have a gap below `margin` within the time `horizon` if both beads fly freely:
/// |d + w t| >= |d| + t (d . w)/|d|.
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
  std::uint16_t* touching;  ///< [packet] a bit per lane: in contact now
  std::uint16_t* near;      ///< [packet] a bit per lane
};

using PairKernel = double (*)(const PairArgs&);  ///< returns the largest overlap
using WallKernel = double (*)(const WallArgs&);  ///< the same
using IntegrateKernel = Deviation (*)(const IntegrateArgs&);
using FreeFlightKernel = void (*)(const FreeFlightArgs&);
using VelocityRangeKernel = VelocityRange (*)(const VelocityRangeArgs&);
using NearPairKernel = void (*)(const NearPairArgs&);

/// The passes of one set of laws.
struct Kernels {
  PairKernel pairs;
  WallKernel walls;
  IntegrateKernel integrate;
  FreeFlightKernel fly;
  VelocityRangeKernel range;
  NearPairKernel scan;
  int remembered;  ///< numbers per contact
};

/// Which passes: positions in the lists of laws/axes.hpp.
struct KernelKey {
  int dimension;
  std::size_t normal, tangential, rolling;
  Velocity velocity;
};

/// One instruction set.
struct Target {
  std::string_view name;
  int width;  ///< contacts to a packet
  bool (*available)();
  Kernels (*find)(const KernelKey&);
  /// Of collisions (collocation.hpp). \param normal, tangential places of laws that can meet alone
  CollocationStep (*find_step)(std::size_t normal, std::size_t tangential, int dimension);
};

extern const Target kScalar;
extern const Target kAvx2;
extern const Target kAvx512;
/// The widest that this processor has.
const Target& widest_target();

}  // namespace twincell::sim
