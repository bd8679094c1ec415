#include "imaging/find/votes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "imaging/find/votes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "imaging/disc/masked_load.hpp"

#ifndef TWINCELL_VOTES_ONCE
#define TWINCELL_VOTES_ONCE
namespace twincell::imaging::votes {
inline constexpr std::size_t kSpare = 16;  // extra floats at the end of a row, for the last vector
inline constexpr std::size_t kReach = 2;   // half width of the gradient operator, px
/// Storage of the votes: row v of the vote picture is in row v & mask of a ring buffer with `stride` floats
/// per row. `first` is the row of the vote picture at the height of the voting row.
struct VoteRows {
  std::int32_t first, mask, stride;
};
}  // namespace twincell::imaging::votes
#endif

HWY_BEFORE_NAMESPACE();
namespace twincell::imaging::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using votes::kReach, votes::VoteRows;

// Smallest gradient that votes, darkness per pixel. Noise at SNR 18 gives 0.02.
constexpr float kMinGradient = 0.05F;

using Tag = hn::CappedTag<float, 8>;
using V = hn::Vec<Tag>;
HWY_INLINE V of(float a) {
  return hn::Set(Tag(), a);
}

/// The vertical parts of the Sobel operator over five rows: smoothing by 1 4 6 4 1, slope by -1 -2 0 2 1.
void across_rows(const std::array<const float*, 5>& rows, std::size_t n, float* HWY_RESTRICT smooth,
                 float* HWY_RESTRICT slope) {
  const Tag tag;
  for (std::size_t x = 0; x < n; x += hn::MaxLanes(tag)) {
    const V a = hn::LoadU(tag, rows[0] + x), b = hn::LoadU(tag, rows[1] + x), c = hn::LoadU(tag, rows[2] + x),
            d = hn::LoadU(tag, rows[3] + x), e = hn::LoadU(tag, rows[4] + x);
    const V outer = hn::Add(a, e), inner = hn::Add(b, d);
    hn::StoreU(hn::MulAdd(of(6), c, hn::MulAdd(of(4), inner, outer)), tag, smooth + x);
    hn::StoreU(hn::MulAdd(of(2), hn::Sub(d, b), hn::Sub(e, a)), tag, slope + x);
  }
}

/// Votes of one row: for each voting pixel the index of the pixel it votes for, and the weight.
/// \returns number of votes
std::size_t votes_of_row(const float* HWY_RESTRICT smooth, const float* HWY_RESTRICT slope,
                         const std::uint8_t* ignore, std::size_t n, float radius, const VoteRows& rows,
                         std::int32_t* HWY_RESTRICT place, float* HWY_RESTRICT weight) {
  const Tag tag;
  const hn::RebindToSigned<Tag> whole;
  constexpr float kUnit = 1.0F / 128;  // sums of the weights: 16 and 8
  std::size_t found = 0;
  for (std::size_t x = 0; x < n; x += hn::MaxLanes(tag)) {
    const float *s = smooth + x + kReach, *d = slope + x + kReach;
    const V gx = hn::Mul(of(kUnit), hn::MulAdd(of(2), hn::Sub(hn::LoadU(tag, s + 1), hn::LoadU(tag, s - 1)),
                                               hn::Sub(hn::LoadU(tag, s + 2), hn::LoadU(tag, s - 2))));
    const V inner = hn::Add(hn::LoadU(tag, d - 1), hn::LoadU(tag, d + 1)),
            outer = hn::Add(hn::LoadU(tag, d - 2), hn::LoadU(tag, d + 2));
    const V gy = hn::Mul(of(kUnit), hn::MulAdd(of(6), hn::LoadU(tag, d), hn::MulAdd(of(4), inner, outer)));
    const V g2 = hn::MulAdd(gx, gx, hn::Mul(gy, gy));
    auto clear = hn::Gt(g2, of(kMinGradient * kMinGradient));
    if (hn::AllFalse(tag, clear)) continue;
    clear = hn::And(clear, hn::FirstN(tag, n - x));
    if (ignore != nullptr) {
      HWY_ALIGN std::array<float, 8> passed{};
      for (std::size_t k = 0; k < std::min(hn::MaxLanes(tag), n - x); ++k)
        passed[k] = ignore[x + k] != 0 ? 1.0F : 0.0F;
      clear = hn::And(clear, hn::Eq(hn::Load(tag, passed.data()), hn::Zero(tag)));
    }
    const V g = hn::Sqrt(g2), far = hn::Div(of(radius), hn::Max(g, of(kMinGradient)));
    const V column = hn::Add(hn::Iota(tag, static_cast<float>(x)), hn::Mul(far, gx));
    const auto row = hn::And(hn::Add(hn::NearestInt(hn::Mul(far, gy)), hn::Set(whole, rows.first)),
                             hn::Set(whole, rows.mask));
    const auto at = hn::Add(hn::NearestInt(column), hn::Mul(row, hn::Set(whole, rows.stride)));
    const LaneCompaction compact(clear);
    hn::StoreU(hn::BitCast(whole, compact(hn::BitCast(tag, at))), whole, place + found);
    hn::StoreU(compact(g), tag, weight + found);
    found += compact.count();
  }
  return found;
}

/// Symmetric weighted sums of nine numbers.
void blur_line(const std::array<const float*, 9>& from, const std::array<float, 5>& weights, std::size_t n,
               float* HWY_RESTRICT to) {
  const Tag tag;
  // Named one by one, so that they stay in registers.
  const auto [a, b, c, d, e, f, g, h, i] = from;
  const V middle = of(weights[0]), first = of(weights[1]), second = of(weights[2]), third = of(weights[3]),
          last = of(weights[4]);
  const auto both = [&](const float* left, const float* right, std::size_t x)
                        HWY_ATTR { return hn::Add(hn::LoadU(tag, left + x), hn::LoadU(tag, right + x)); };
  for (std::size_t x = 0; x < n; x += hn::MaxLanes(tag)) {
    V sum = hn::Mul(middle, hn::LoadU(tag, e + x));
    sum = hn::MulAdd(first, both(d, f, x), sum);
    sum = hn::MulAdd(second, both(c, g, x), sum);
    sum = hn::MulAdd(third, both(b, h, x), sum);
    sum = hn::MulAdd(last, both(a, i, x), sum);
    hn::StoreU(sum, tag, to + x);
  }
}

/// Columns of the local maxima of a row, within 1 .. n - 2.
/// \returns number of maxima
std::size_t tops_of_row(const std::array<const float*, 3>& rows, std::size_t n, float least,
                        std::int32_t* HWY_RESTRICT columns) {
  const Tag tag;
  const hn::RebindToSigned<Tag> whole;
  const auto [above, middle, below] = rows;
  std::size_t found = 0;
  for (std::size_t x = 1; x + 1 < n; x += hn::MaxLanes(tag)) {
    const V v = hn::LoadU(tag, middle + x);
    auto top = hn::Ge(v, of(least));
    if (hn::AllFalse(tag, top)) continue;
    top = hn::And(top, hn::FirstN(tag, n - 1 - x));
    // Larger than the neighbours read before, and not smaller than the neighbours read after: of equal ones
    // the first counts.
    for (const float* before : {above + x - 1, above + x, above + x + 1, middle + x - 1})
      top = hn::And(top, hn::Gt(v, hn::LoadU(tag, before)));
    for (const float* after : {middle + x + 1, below + x - 1, below + x, below + x + 1})
      top = hn::And(top, hn::Ge(v, hn::LoadU(tag, after)));
    const LaneCompaction compact(top);
    const auto at = hn::Iota(whole, static_cast<std::int32_t>(x));
    hn::StoreU(hn::BitCast(whole, compact(hn::BitCast(tag, at))), whole, columns + found);
    found += compact.count();
  }
  return found;
}

}  // namespace twincell::imaging::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace twincell::imaging {

HWY_EXPORT(across_rows);
HWY_EXPORT(votes_of_row);
HWY_EXPORT(blur_line);
HWY_EXPORT(tops_of_row);

namespace {

using votes::kReach, votes::kSpare;

/// Calls use(y, five rows around y) for each row of the frame. Pixels of the border are repeated beyond it.
template <class Use>
void with_neighbour_rows(const cv::Mat1f& frame, Use&& use) {
  constexpr int kRows = 5, kMiddle = 2;
  const auto n = static_cast<std::size_t>(frame.cols), width = n + 2 * kReach + kSpare;
  std::array<std::vector<float>, kRows> kept;
  for (auto& row : kept) row.assign(width, 0.0F);
  const auto read = [&](int y) {
    std::vector<float>& row = kept[static_cast<std::size_t>((y + kRows) % kRows)];
    const float* from = frame[std::clamp(y, 0, frame.rows - 1)];
    std::copy_n(from, n, row.data() + kReach);
    std::fill_n(row.data(), kReach, from[0]);
    std::fill_n(row.data() + kReach + n, kReach, from[n - 1]);
  };
  for (int y = -kMiddle; y < kMiddle; ++y) read(y);
  for (int y = 0; y < frame.rows; ++y) {
    read(y + kMiddle);
    std::array<const float*, kRows> rows{};
    for (int k = 0; k < kRows; ++k)
      rows[static_cast<std::size_t>(k)] =
          kept[static_cast<std::size_t>((y - kMiddle + k + kRows) % kRows)].data();
    use(y, rows);
  }
}

}  // namespace

void over_smoothed_votes(const cv::Mat1f& darkness, const cv::Mat1b& ignore, const VoteOptions& options,
                         const std::function<void(int, const VoteLines&)>& use) {
  constexpr int kTail = 4;  // half width of the smoothing kernel, px
  const auto n = static_cast<std::size_t>(darkness.cols);
  const int border = options.pad + kTail, reach = static_cast<int>(std::ceil(options.radius_px)) + 1;
  // Ring buffer: the rows that can still receive votes and the rows that the smoothing needs. Each row is
  // reused for one further down, so that the buffer stays in the cache.
  int kept = 1;
  while (kept < 2 * (reach + kTail + 1)) kept *= 2;
  cv::Mat1f votes = cv::Mat1f::zeros(kept, darkness.cols + 2 * border + int{kSpare});
  const auto votes_row = [&](int v) { return votes[v & (kept - 1)]; };

  // Smoothing kernel: a normalised Gaussian.
  std::array<float, kTail + 1> weights{};
  double sum = 0;
  for (int k = 0; k <= kTail; ++k) {
    const double w = std::exp(-0.5 * k * k / (options.smoothing * options.smoothing));
    weights[static_cast<std::size_t>(k)] = static_cast<float>(w);
    sum += k == 0 ? w : 2 * w;
  }
  for (float& w : weights) w /= static_cast<float>(sum);
  // Smoothing: as soon as a row can receive no more votes, it is smoothed, reported and cleared.
  const auto columns = n + 2 * static_cast<std::size_t>(options.pad), wide = columns + std::size_t{2 * kTail};
  std::vector<float> column_sums(wide + kSpare);
  std::array<std::vector<float>, 3> smoothed;
  for (auto& row : smoothed) row.assign(columns + kSpare, 0.0F);
  int done = 0;
  const auto smooth_up_to = [&](int rows) {
    for (; done < rows; ++done) {
      std::array<const float*, 2 * kTail + 1> from{};
      for (int k = 0; k <= 2 * kTail; ++k) from[static_cast<std::size_t>(k)] = votes_row(done + k);
      HWY_DYNAMIC_DISPATCH(blur_line)(from, weights, wide, column_sums.data());
      for (int k = 0; k <= 2 * kTail; ++k) from[static_cast<std::size_t>(k)] = column_sums.data() + k;
      const auto line = [&](int y) { return smoothed[static_cast<std::size_t>((y + 3) % 3)].data(); };
      HWY_DYNAMIC_DISPATCH(blur_line)(from, weights, columns, line(done));
      std::fill_n(votes_row(done), votes.cols, 0.0F);
      use(done, {line(done - 2), line(done - 1), line(done)});
    }
  };

  // Voting: row by row of the frame.
  std::vector<float> smooth(n + 2 * kReach + kSpare), slope(smooth), weight(n + kSpare);
  std::vector<std::int32_t> place(n + kSpare);
  with_neighbour_rows(darkness, [&](int y, const std::array<const float*, 5>& rows) {
    HWY_DYNAMIC_DISPATCH(across_rows)(rows, n + 2 * kReach, smooth.data(), slope.data());
    const std::size_t found = HWY_DYNAMIC_DISPATCH(votes_of_row)(
        smooth.data(), slope.data(), ignore.empty() ? nullptr : ignore[y], n,
        static_cast<float>(options.radius_px), {y + border, kept - 1, static_cast<int>(votes.step1())},
        place.data(), weight.data());
    float* from = votes[0] + border;
    for (std::size_t k = 0; k < found; ++k) from[place[k]] += weight[k];
    smooth_up_to(y + 1 + border - reach - 2 * kTail);
  });
  smooth_up_to(darkness.rows + 2 * options.pad);
}

std::span<const std::int32_t> tops_of_votes(const VoteLines& lines, std::size_t n, float least,
                                            std::vector<std::int32_t>& room) {
  room.resize(std::max(room.size(), n + kSpare));
  return {room.data(), HWY_DYNAMIC_DISPATCH(tops_of_row)(lines, n, least, room.data())};
}

}  // namespace twincell::imaging
#endif
