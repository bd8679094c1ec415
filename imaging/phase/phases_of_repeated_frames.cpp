#include "imaging/phase/phases_of_repeated_frames.hpp"

#include <cstddef>
#include <vector>

#include "imaging/stack/repeated_frames.hpp"

namespace twincell::imaging {

LockEvidence without_repeats(const LockEvidence& evidence) {
  if (evidence.repeats.empty()) return evidence;
  LockEvidence each;
  for (std::size_t f = 0; f < evidence.repeats.size(); ++f) {
    if (evidence.repeats[f] != 0) continue;
    if (f < evidence.plate_px.size()) each.plate_px.push_back(evidence.plate_px[f]);
    if (f < evidence.times_s.size()) each.times_s.push_back(evidence.times_s[f]);
  }
  return each;
}

PhaseTable with_repeats(const PhaseTable& each, std::span<const std::uint8_t> repeats) {
  if (repeats.empty()) return each;
  PhaseTable all = each;
  all.frames.clear();
  std::vector<std::size_t> number;  // of each frame that repeats no other
  for (std::size_t f = 0; f < repeats.size(); ++f) {
    if (repeats[f] == 0) {
      all.frames.push_back(each.at(static_cast<std::int64_t>(number.size())));
      number.push_back(f);
      continue;
    }
    all.frames.push_back(all.frames.back());
    all.frames.back().interval = 0;
    ++all.doubled;
  }
  for (FrameStretch& s : all.out_of_lock)
    s = {number[s.first], s.last + 1 < number.size() ? number[s.last + 1] - 1 : repeats.size() - 1};
  all.warning = repeats_in_words(repeats) + "; here each instant counts once" +
                (each.warning.empty() ? "" : "; counted without the repeated frames, " + each.warning);
  return all;
}

}  // namespace twincell::imaging
