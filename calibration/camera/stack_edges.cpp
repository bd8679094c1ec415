#include "calibration/camera/stack_edges.hpp"

#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "core/in_parallel.hpp"
#include "core/median.hpp"
#include "imaging/settings/size_hypotheses.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/stack/repeated_frames.hpp"

namespace twincell::calibration {

double diameter_for_edges(const std::filesystem::path& stack, bool bright, double known_px) {
  constexpr double kUsual_px = 15;
  if (known_px > 0) return known_px;
  cv::Mat first;
  const double found =
      imaging::open_frames(stack)->next(first) ? imaging::estimate_diameter(first, {.bright = bright}) : 0;
  return found > 0 ? found : kUsual_px;
}

std::optional<double> frame_rate_of(std::optional<double> stated, const StackEdges& edges,
                                    const std::filesystem::path& stack, const imaging::FrameRange& range) {
  const auto step = static_cast<double>(range.step);
  if (stated) return *stated / step;
  const auto& t = edges.time_s;
  if (t.size() > 1 && t.back() > t.front()) return static_cast<double>(t.size() - 1) / (t.back() - t.front());
  const imaging::StackInfo info = imaging::open_frames(stack)->info();
  if (info.playback || !info.frame_rate_hz) return {};
  return *info.frame_rate_hz / step;
}

StackEdges read_stack_edges(imaging::FrameSource& frames, const imaging::BeadsAtEdges& beads, int threads,
                            Progress& progress) {
  constexpr std::size_t kWallFrames = 40;  // frames in which the walls are searched
  StackEdges out;
  const std::size_t stride = std::max<std::size_t>(1, frames.announced() / kWallFrames);
  out.stride = stride;
  out.diameter_px = beads.diameter_px;
  const auto batch_size = static_cast<std::size_t>(std::max(1, threads)) * 2;
  std::vector<double> blurs;
  bool stamped = true;
  std::size_t done = 0;
  imaging::RepeatedFrames repeated;
  for (bool more = true; more;) {
    std::vector<cv::Mat> batch;
    for (cv::Mat frame; batch.size() < batch_size && (more = frames.next(frame)); frame = cv::Mat()) {
      batch.push_back(frame);
      repeated.add(frame);
      if (const auto t = frames.time_s(); t && stamped)
        out.time_s.push_back(*t);
      else
        stamped = false;
    }
    std::vector<imaging::CellEdges> found(batch.size());
    in_parallel(batch.size(), threads,
                [&](std::size_t i) { found[i] = imaging::find_cell_edges(batch[i], beads); });
    for (std::size_t i = 0; i < batch.size(); ++i, ++done) {
      out.size = batch[i].size();
      if (done % stride == 0) {
        out.left.push_back(std::move(found[i].left));
        out.right.push_back(std::move(found[i].right));
      }
      out.plate.push_back(std::move(found[i].plate));
      if (found[i].blur_px > 0) blurs.push_back(found[i].blur_px);
    }
    progress.update(static_cast<std::int64_t>(done), static_cast<std::int64_t>(frames.announced()));
  }
  if (done == 0) throw InputError(Where{.file = frames.current(), .key = {}}, "holds no frame.");
  out.repeats = repeated.repeats();
  if (!stamped) out.time_s.clear();
  if (!blurs.empty()) out.blur_px = upper_median(blurs);
  return out;
}

}  // namespace twincell::calibration
