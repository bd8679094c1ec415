#include "sim/device/bed_memory.hpp"

#include "sim/kernels/kernels.hpp"

namespace twincell::sim {

namespace {

/// Hands out consecutive arrays, each from a new cache line on. Without memory it only adds up their sizes.
class Arrays {
 public:
  explicit Arrays(std::byte* base) : base_(base) {}

  template <class T>
  void next(T*& array, std::size_t count) {
    array = base_ == nullptr ? nullptr : reinterpret_cast<T*>(base_ + used_);
    constexpr std::size_t kLine = 64;
    used_ = (used_ + count * sizeof(T) + kLine - 1) / kLine * kLine;
  }
  [[nodiscard]] std::size_t used() const { return used_; }

 private:
  std::byte* base_;
  std::size_t used_ = 0;
};

}  // namespace

BedParts place_bed(DeviceBed& bed, const BedSizes& sizes, std::byte* base) {
  const std::size_t n = sizes.beads, axes = static_cast<std::size_t>(sizes.dimension);
  const bool flat = sizes.dimension == 2;
  bed.beads = static_cast<std::int32_t>(n);
  bed.walls = static_cast<std::int32_t>(sizes.walls);
  bed.kinds = static_cast<std::int32_t>(sizes.kinds);
  BedParts parts{};
  Arrays arrays(base);
  arrays.next(bed.records, n * (flat ? kRecord<2> : kRecord<3>));
  arrays.next(bed.spins, n * (flat ? kSpinRecord<2> : kSpinRecord<3>));
  arrays.next(bed.forces, n * (flat ? kForceRecord<2> : kForceRecord<3>));
  arrays.next(bed.report, 1);
  parts.state = arrays.used();
  for (int list = 0; list < 2; ++list) {
    arrays.next(bed.neighbours[list], n);
    arrays.next(bed.partner[list], sizes.slots);
    arrays.next(bed.memory[list], sizes.slots * sizes.memory);
  }
  arrays.next(bed.wall_memory, n * sizes.walls * sizes.memory);
  arrays.next(bed.listed_at, n * axes);
  parts.contacts = arrays.used();
  arrays.next(bed.first, n + 1);
  arrays.next(bed.kind, n);
  arrays.next(bed.pair_constants, sizes.kinds * sizes.kinds * sizes.constants);
  arrays.next(bed.wall_constants, sizes.walls * sizes.kinds * sizes.constants);
  arrays.next(bed.inv_mass, n * 4);
  arrays.next(bed.turn, n);
  parts.constants = arrays.used();
  arrays.next(bed.normals, sizes.walls * 3);
  arrays.next(bed.moves, sizes.walls);
  arrays.next(bed.drag, n);
  parts.surroundings = arrays.used();
  arrays.next(bed.plate, static_cast<std::size_t>((kStepsPerLaunch + 1) * plate_row(bed.walls)));
  parts.all = arrays.used();
  return parts;
}

}  // namespace twincell::sim
