#include "trajectory/foreign/picture_beads.hpp"

#include <algorithm>

namespace twincell {

bool PictureBeadsReader::next(ForeignFrame& s) {
  if (next_ == beads_.size()) return false;
  s = ForeignFrame{};
  s.step = beads_[next_].frame;
  s.line = beads_[next_].bead.line;
  s.time = beads_[next_].time;
  for (; next_ < beads_.size() && beads_[next_].frame == s.step; ++next_)
    s.beads.push_back(beads_[next_].bead);
  enclose(s, options_.dimension);
  return true;
}

void PictureBeadsReader::sort_by_frame() {
  std::stable_sort(beads_.begin(), beads_.end(),
                   [](const BeadOfFrame& a, const BeadOfFrame& b) { return a.frame < b.frame; });
}

}  // namespace twincell
