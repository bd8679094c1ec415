#pragma once
/// \file
/// One bed as the device kernel sees it: plain numbers and pointers into memory of the device.

#include <cstdint>

namespace twincell::sim {

/// What a launch leaves to the next one and to the host.
struct BedReport {
  std::int64_t steps;     ///< done in this launch
  std::int64_t failed;    ///< step of this launch at which an overlap exceeded its bound; -1: none
  std::int64_t overfull;  ///< step at which a bead had more neighbours than slots; -1: none
  std::int64_t outside;  ///< last step at which a bead left the bound around the last known mean displacement
  std::int64_t far;      ///< last step at which a bead left the bound around the mean displacement
  std::int64_t builds;   ///< of the neighbour list, over all launches
  std::int64_t list;     ///< which of the two lists is in use
  double carried[3];     ///< mean displacement of the beads since the build, when it was last computed
};

/// Bead records have the layout of kernels.hpp. Contact memory is [slot][number]: each bead has slots for its
/// neighbours, sorted by their number, and both beads of a pair remember the same numbers. There are two
/// lists, because a build carries the memory from the old one to the new one.
struct DeviceBed {
  std::int32_t beads, walls, kinds;
  double *records, *spins, *forces;  ///< as in kernels.hpp
  BedReport* report;

  std::int32_t* neighbours[2];  ///< [bead] number of slots in use
  std::int32_t* partner[2];     ///< [slot]
  double* memory[2];            ///< [slot][number]
  double* wall_memory;          ///< [bead][wall][number]
  double* listed_at;            ///< [bead][axis] positions at the last build

  // The kernel only reads the following.
  std::int32_t* first;     ///< [beads + 1] first slot of a bead
  std::int32_t* kind;      ///< [bead] beads of one kind have the same size and mass
  double* pair_constants;  ///< [kind][kind][constant], the kind of the bead with the lower number first
  double* wall_constants;  ///< [wall][kind][constant]
  double* inv_mass;        ///< [bead][4], as in kernels.hpp
  double* turn;            ///< [bead]
  double* normals;         ///< [wall][axis]
  std::int32_t* moves;     ///< [wall] 1: the wall moves with the plate
  double* drag;            ///< [bead] plate drag times mass
  /// Motion of the plate, one row for each step from the present one on: velocity of the moving walls (3
  /// numbers, in the order of a record), velocity of the cell for the drag (3), then the offset of each wall.
  double* plate;

  double period[3], gravity[3];  ///< in the order of a record
  double dt, quantum;
  double overlap_bound;  ///< sigma
  double skin;           ///< sigma; pairs with gaps below are listed
  bool periodic, spin, locate, has_drag;

  std::int64_t step;           ///< present step of the system
  std::int64_t steps;          ///< to be done
  std::int64_t rebuild_every;  ///< for tests: also build the list at every n-th step; 0: no
  bool known;                  ///< the forces are those at the present positions
  bool fresh;                  ///< positions may have changed since the last launch: the list is built first
};

/// Numbers in a row of DeviceBed::plate.
constexpr std::int32_t plate_row(std::int32_t walls) {
  return 6 + walls;
}

}  // namespace twincell::sim
