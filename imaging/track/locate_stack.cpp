#include "imaging/track/locate_stack.hpp"

#include <algorithm>
#include <vector>

#include "core/error.hpp"
#include "core/in_parallel.hpp"

namespace twincell::imaging {

namespace {

// Each frame is an independent unit of work, so the results do not depend on the thread that computes them.
std::vector<Located> locate_batch(const std::vector<cv::Mat>& batch, const LocatorOptions& options,
                                  int threads) {
  std::vector<Located> results(batch.size());
  in_parallel(batch.size(), threads, [&](std::size_t i) { results[i] = locate(batch[i], options); });
  return results;
}

}  // namespace

std::int64_t locate_stack(FramesAhead& frames, const LocatorOptions& options, int threads,
                          const LocatedSink& sink, Progress& progress) {
  cv::setNumThreads(1);  // the only thread pool is that of this program
  const FrameSource& source = frames.source();
  std::int64_t count = 0;
  const std::size_t batch_size = 2 * static_cast<std::size_t>(std::max(threads, 1));
  for (bool more = true; more;) {
    std::vector<cv::Mat> batch;
    for (cv::Mat frame; batch.size() < batch_size && (more = frames.next(frame)); frame = cv::Mat())
      batch.push_back(frame);
    if (batch.empty()) break;
    const std::vector<Located> results = locate_batch(batch, options, threads);
    for (std::size_t i = 0; i < batch.size(); ++i) sink(count++, batch[i], results[i]);
    progress.update(count, static_cast<std::int64_t>(source.announced()));
  }
  if (count == 0) throw InputError(Where{.file = source.current(), .key = {}}, "holds no frame.");
  return count;
}

}  // namespace twincell::imaging
