#include "imaging/benchmark/locating_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core/utility.hpp>
#include <random>
#include <utility>

#include "core/cpu_clock.hpp"
#include "imaging/benchmark/centre_scores.hpp"
#include "imaging/benchmark/cramer_rao_bound.hpp"
#include "imaging/benchmark/packing.hpp"
#include "imaging/benchmark/picture.hpp"
#include "imaging/locate/locator.hpp"

namespace twincell::imaging {

namespace {

using rendered::CentreScores;
using rendered::Picture;

/// Limits OpenCV to the calling thread, because thread_cpu_seconds() does not count the time of its worker
/// threads.
class OneThread {
 public:
  OneThread() { cv::setNumThreads(1); }
  ~OneThread() { cv::setNumThreads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_ = cv::getNumThreads();
};

Picture bed(const LocateScene& scene, double diameter, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0, 1);
  Picture p;
  p.width = cvRound(scene.width * diameter);
  p.height = cvRound(scene.height * diameter);
  const double margin = 10, left = margin + part(random), floor = p.height - margin - part(random);
  p.discs = rendered::deposited(std::vector<double>(static_cast<std::size_t>(scene.beads), 0.5 * diameter),
                                {left, 0, p.width - 2 * left, floor}, random);
  return p;
}

struct Exposure {
  double diameter, snr;
  Picture picture;
  cv::Mat1b frame;
  std::vector<double> bound;
};

std::vector<cv::Point2d> found(const cv::Mat1b& frame, const LocateSetting& s) {
  std::vector<cv::Point2d> centres;
  if (s.sweeps == 0) {
    FindOptions options;
    options.radius_px = 0.5 * s.diameter_px;
    for (const Proposal& p : propose(s.finder, prepare(frame, {}, options.radius_px), options))
      centres.emplace_back(p.x, p.y);
    return centres;
  }
  LocatorOptions options;
  options.finder = s.finder;
  options.diameter_px = s.diameter_px;
  options.refine.method = s.method;
  options.refine.sweeps = s.sweeps;
  options.refine.ring_px = s.ring_px;
  for (const Detection& b : locate(frame, options).beads) centres.emplace_back(b.x, b.y);
  return centres;
}

}  // namespace

std::vector<LocatePrecision> locate_precision(const std::vector<LocateSetting>& settings,
                                              const LocateScene& scene, int rounds, Progress& progress) {
  const OneThread one_thread;
  const auto runs = static_cast<std::int64_t>(settings.size()) * rounds;
  // Exposures: rendered once for each bead size and noise level, and shared by all settings.
  std::vector<Exposure> exposures;
  for (const LocateSetting& s : settings) {
    const bool known = std::any_of(exposures.begin(), exposures.end(), [&](const Exposure& e) {
      return e.diameter == s.diameter_px && e.snr == s.snr;
    });
    for (int f = 0; f < scene.frames && !known; ++f) {
      progress.update(0, runs);
      const auto seed = static_cast<std::uint64_t>(f + 1);
      Exposure e{s.diameter_px, s.snr, bed(scene, s.diameter_px, seed), {}, {}};
      const cv::Mat1d light = rendered::expected(e.picture);
      e.frame = rendered::expose(light, e.picture, s.snr, seed);
      e.bound = rendered::cramer_rao_bound(light, e.picture, s.snr);
      exposures.push_back(std::move(e));
    }
  }
  std::vector<LocatePrecision> all;
  std::vector<CentreScores> scores(settings.size());
  for (const LocateSetting& s : settings) {
    LocatePrecision p;
    p.setting = s;
    p.seconds = std::numeric_limits<double>::infinity();
    all.push_back(p);
  }
  // Timing: rounds over all settings. The detections do not change, so only the first round is scored.
  std::int64_t done = 0;
  for (int round = 0; round < rounds; ++round)
    for (std::size_t k = 0; k < settings.size(); ++k) {
      double seconds = 0;
      for (const Exposure& e : exposures) {
        if (e.diameter != settings[k].diameter_px || e.snr != settings[k].snr) continue;
        const double before = thread_cpu_seconds();
        const auto centres = found(e.frame, settings[k]);
        seconds += thread_cpu_seconds() - before;
        if (round == 0) scores[k].add(e.picture, centres, e.bound);
      }
      all[k].seconds = std::min(all[k].seconds, seconds / scene.frames);
      progress.update(++done, runs);
    }
  for (std::size_t k = 0; k < settings.size(); ++k) {
    const CentreScores::Summary s = scores[k].summary();
    LocatePrecision& p = all[k];
    p.recall = s.recall;
    p.precision = s.precision;
    p.rms = s.rms;
    p.bound = s.bound;
    p.bias_x = s.bias_x;
    p.bias_y = s.bias_y;
    p.locking = s.locking;
    p.locking_by_chance = s.rms * std::sqrt(std::numbers::pi / (2 * std::max(1.0, double(s.found))));
  }
  return all;
}

std::vector<LocatePrecision> front(const std::vector<LocatePrecision>& all, double diameter_px, double snr) {
  std::vector<LocatePrecision> sorted, kept;
  for (const LocatePrecision& p : all)
    if (p.setting.diameter_px == diameter_px && p.setting.snr == snr && p.complete()) sorted.push_back(p);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const LocatePrecision& a, const LocatePrecision& b) { return a.seconds < b.seconds; });
  for (const LocatePrecision& p : sorted)
    if (kept.empty() || p.rms < kept.back().rms) kept.push_back(p);
  return kept;
}

std::optional<LocatePrecision> cheapest(const std::vector<LocatePrecision>& all, double diameter_px,
                                        double snr, double accuracy_px) {
  for (const LocatePrecision& p : front(all, diameter_px, snr))
    if (p.rms <= accuracy_px) return p;
  return std::nullopt;
}

double bed_displacement_noise(double relative_rms, int tracers, int cycles, int phases) {
  return relative_rms * std::sqrt((1 - 1.0 / phases) / (double(tracers) * cycles));
}

}  // namespace twincell::imaging
