/// \file
/// Moves selected lanes of vectors of eight floats to the front (stream compaction). Compiled once for each
/// SIMD target of the including file.

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

// This include guard lets the file be read again for each SIMD target.
#if defined(TWINCELL_LANE_COMPACTION) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCELL_LANE_COMPACTION
#undef TWINCELL_LANE_COMPACTION
#else
#define TWINCELL_LANE_COMPACTION
#endif

HWY_BEFORE_NAMESPACE();
namespace twincell::imaging::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The permutation that brings the lanes of a mask to the front, computed once for several vectors.
class LaneCompaction {
 public:
  using Tag = hn::CappedTag<float, 8>;
  using Vector = hn::Vec<Tag>;
  using Mask = hn::Mask<Tag>;

#if HWY_TARGET == HWY_AVX2
  // hn::Compress is not used here: Highway 1.0 copies its own table of a kilobyte onto the stack in each
  // function that needs it, which took an eighth of the time to locate a frame.
  HWY_INLINE explicit LaneCompaction(Mask mask) {
    std::uint8_t bits[8];
    hn::StoreMaskBits(Tag(), mask, bits);
    const hn::Rebind<std::int32_t, Tag> whole;
    const hn::Rebind<std::uint8_t, Tag> small;
    order_ = hn::IndicesFromVec(Tag(), hn::PromoteTo(whole, hn::Load(small, kOrders[bits[0]].data())));
    count_ = hn::CountTrue(Tag(), mask);
  }
  [[nodiscard]] HWY_INLINE Vector operator()(Vector v) const {
    return hn::TableLookupLanes(v, order_);
  }
#else
  HWY_INLINE explicit LaneCompaction(Mask mask) : mask_(mask), count_(hn::CountTrue(Tag(), mask)) {}
  [[nodiscard]] HWY_INLINE Vector operator()(Vector v) const {
    return hn::Compress(v, mask_);
  }
#endif
  /// Number of selected lanes.
  [[nodiscard]] HWY_INLINE std::size_t count() const {
    return count_;
  }

 private:
#if HWY_TARGET == HWY_AVX2
  static constexpr std::size_t kLanes = 8;
  using Order = std::array<std::uint8_t, kLanes>;
  /// For each bit pattern: the lanes whose bit is set, in order, then the other lanes.
  static constexpr std::array<Order, 256> orders() {
    std::array<Order, 256> all{};
    for (std::size_t pattern = 0; pattern < all.size(); ++pattern) {
      std::size_t at = 0;
      for (const std::size_t wanted : {std::size_t{1}, std::size_t{0}})
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          if ((pattern >> lane & 1) == wanted) all[pattern][at++] = static_cast<std::uint8_t>(lane);
    }
    return all;
  }
  alignas(64) static const std::array<Order, 256> kOrders;
  decltype(hn::IndicesFromVec(Tag(), hn::Zero(hn::Rebind<std::int32_t, Tag>()))) order_;
#else
  Mask mask_;
#endif
  std::size_t count_;
};

#if HWY_TARGET == HWY_AVX2
inline constexpr std::array<LaneCompaction::Order, 256> LaneCompaction::kOrders = LaneCompaction::orders();
#endif

}  // namespace twincell::imaging::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
