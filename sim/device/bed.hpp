#pragma once
/// \file
/// One bed as the device kernel sees it: plain numbers and pointers into memory of the device.

#include <cstddef>
#include <cstdint>

namespace twincell::sim {

/// Largest number of threads of a block. It bounds the registers of a thread.
inline constexpr int kMaxThreads = 512;

/// Threads of a card that take one way through a program together.
inline constexpr std::int32_t kWarp = 32;

/// Largest number of stops of a launch.
inline constexpr int kMaxStops = 20;

/// What a launch leaves to the next one and to the host.
struct BedReport {
  std::int64_t steps;   ///< done in this launch
  std::int64_t failed;  ///< 1: at the last one an overlap exceeded its bound, or a bead had too few slots
  std::int64_t builds;  ///< of the neighbour list, over all launches
  std::int64_t list;    ///< which of the two lists is in use
  std::int64_t pairs;   ///< in that list
  double carried[3];    ///< common displacement of the beads since the build, when it was last computed
};

/// Bead records have the layout of kernels.hpp. Each bead has slots for its neighbours, sorted by their
/// number. Two beads that are neighbours are a pair, and name it in their slots. There are two lists, because
/// a build carries the contact memory from the old one to the new one. Where each thread reads its own
/// element, the elements are next to each other, so that a card fetches them together.
struct DeviceBed {
  std::int32_t beads, walls, kinds;
  std::int32_t slots;                ///< of a bead
  std::int32_t most_pairs;           ///< places for pairs
  double *records, *spins, *forces;  ///< as in kernels.hpp
  BedReport* report;

  std::int32_t* neighbours[2];  ///< [bead] number of slots in use
  std::int32_t* partner[2];     ///< [slot][bead]
  std::int32_t* pair[2];        ///< [slot][bead]
  double* memory[2];            ///< [number][pair]
  std::int32_t* pair_beads;     ///< [pair][2] the lower number first
  double* pair_forces;          ///< [pair][number], see storing_lanes.hpp
  std::int32_t* first_pair;     ///< [bead] of its pairs with beads of higher numbers
  std::int32_t* part_pairs;     ///< [kParts] numbers of pairs of parts of the beads
  std::int32_t* touching;       ///< [pairs + beads] the contacts of a step, see BedKernel::contacts()
  std::int8_t* was_touched;     ///< [pair] 0: it has no force, and its memory is 0
  double* wall_memory;          ///< [wall][number][bead]
  double* listed_at;            ///< [bead][axis] positions at the last build

  // The kernel only reads the following.
  std::int32_t* kind;      ///< [bead] beads of one kind have the same size and mass
  double* pair_constants;  ///< [kind][kind][constant], the kind of the bead with the lower number first
  double* wall_constants;  ///< [wall][kind][constant]
  double* inv_mass;        ///< [bead][4], as in kernels.hpp
  double* turn;            ///< [bead]

  /// What goes to the machine with every launch: the arrays that follow, in this order.
  std::byte* inputs;
  double* normals;      ///< [wall][axis]
  std::int32_t* moves;  ///< [wall] 1: the wall moves with the plate
  double* drag;         ///< [bead] plate drag times mass
  /// Motion of the plate, one row for each step from the present one on: velocity of the moving walls (3
  /// numbers, in the order of a record), velocity of the cell for the drag (3), then the offset of each wall.
  double* plate;

  std::byte* state;   ///< of the bed: records to report
  std::byte* states;  ///< [stop] copies of it that the kernel makes, and that come back with every launch
  std::int64_t input_words, state_words;  ///< of 8 bytes; those of one state

  double period[3], gravity[3];  ///< in the order of a record
  double dt, quantum;
  double overlap_bound;  ///< sigma
  double skin;           ///< sigma; pairs with gaps below are listed
  bool periodic, spin, locate, has_drag;

  std::int64_t step;              ///< present step of the system
  std::int64_t stops[kMaxStops];  ///< steps from the present one on at which the state is transferred, rising
  std::int64_t last_stop;         ///< index of the last one, with which the launch ends
  std::int64_t rebuild_every;     ///< for tests: also build the list at every n-th step; 0: no
  bool known;                     ///< the forces are those at the present positions
  bool fresh;  ///< positions may have changed since the last launch: the list is built first
};

/// Bytes of a word of what is transferred.
inline constexpr std::int64_t kWord = 8;

/// Bytes of the inputs of a bed.
inline std::size_t input_bytes(const DeviceBed& bed) {
  return static_cast<std::size_t>(kWord * bed.input_words);
}
/// Bytes of the states of a bed at all stops.
inline std::size_t state_bytes(const DeviceBed& bed) {
  return static_cast<std::size_t>(kWord * bed.state_words * (bed.last_stop + 1));
}
/// Names another place for the inputs. They are not copied.
inline void place_inputs(DeviceBed& bed, std::byte* to) {
  const auto moved = [&](auto* array) {
    return reinterpret_cast<decltype(array)>(to + (reinterpret_cast<std::byte*>(array) - bed.inputs));
  };
  bed.normals = moved(bed.normals);
  bed.moves = moved(bed.moves);
  bed.drag = moved(bed.drag);
  bed.plate = moved(bed.plate);
  bed.inputs = to;
}

/// Parts of the beads for running sums.
inline constexpr std::int32_t kParts = 32;

/// Place of slot k of bead b.
constexpr std::int32_t slot_place(std::int32_t beads, std::int32_t b, std::int32_t k) {
  return beads * k + b;
}
/// Place of number m of the memory of a pair.
constexpr std::int32_t pair_place(std::int32_t most_pairs, std::int32_t pair, std::int32_t m) {
  return most_pairs * m + pair;
}
/// Place of number m of the memory of bead b at wall w.
constexpr std::int32_t wall_place(std::int32_t beads, std::int32_t memory, std::int32_t b, std::int32_t w,
                                  std::int32_t m) {
  return beads * (memory * w + m) + b;
}

/// Numbers in a row of DeviceBed::plate.
constexpr std::int32_t plate_row(std::int32_t walls) {
  return 6 + walls;
}

}  // namespace twincell::sim
