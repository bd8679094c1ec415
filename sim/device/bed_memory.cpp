#include "sim/device/bed_memory.hpp"

#include "sim/device/storing_lanes.hpp"

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
  const std::size_t slots = n * sizes.slots;
  const std::size_t pairs = (slots + 1) / 2;  // each has two slots
  const bool flat = sizes.dimension == 2;
  bed.beads = static_cast<std::int32_t>(n);
  bed.walls = static_cast<std::int32_t>(sizes.walls);
  bed.kinds = static_cast<std::int32_t>(sizes.kinds);
  bed.slots = static_cast<std::int32_t>(sizes.slots);
  bed.most_pairs = static_cast<std::int32_t>(pairs);
  BedParts parts{};
  Arrays arrays(base);
  arrays.next(bed.records, n * (flat ? kRecord<2> : kRecord<3>));
  arrays.next(bed.spins, n * (flat ? kSpinRecord<2> : kSpinRecord<3>));
  arrays.next(bed.forces, n * (flat ? kForceRecord<2> : kForceRecord<3>));
  arrays.next(bed.report, 1);
  parts.state = arrays.used();
  for (int list = 0; list < 2; ++list) {
    arrays.next(bed.neighbours[list], n);
    arrays.next(bed.partner[list], slots);
    arrays.next(bed.pair[list], slots);
    arrays.next(bed.memory[list], pairs * sizes.memory);
  }
  arrays.next(bed.pair_beads, pairs * 2);
  arrays.next(bed.wall_memory, n * sizes.walls * sizes.memory);
  parts.contacts = arrays.used();
  arrays.next(bed.listed_at, n * axes);
  arrays.next(bed.pair_forces, pairs * (flat ? kContactForce<2> : kContactForce<3>));
  arrays.next(bed.touching, pairs + n);
  arrays.next(bed.was_touched, pairs);
  arrays.next(bed.first_pair, n);
  arrays.next(bed.part_pairs, kParts);
  arrays.next(bed.kind, n);
  arrays.next(bed.pair_constants, sizes.kinds * sizes.kinds * sizes.constants);
  arrays.next(bed.wall_constants, sizes.walls * sizes.kinds * sizes.constants);
  arrays.next(bed.inv_mass, n * 4);
  arrays.next(bed.turn, n);
  parts.constants = arrays.used();
  arrays.next(bed.normals, sizes.walls * 3);
  arrays.next(bed.moves, sizes.walls);
  arrays.next(bed.drag, n);
  arrays.next(bed.plate, static_cast<std::size_t>((kStepsPerLaunch + 1) * plate_row(bed.walls)));
  parts.all = arrays.used();
  bed.state_words = static_cast<std::int64_t>(parts.state) / kWord;
  if (base != nullptr) {
    bed.state = base;
    bed.inputs = base + parts.constants;
  }
  return parts;
}

}  // namespace twincell::sim
