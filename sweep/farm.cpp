#include "sweep/farm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "core/error.hpp"
#include "sim/run/cost.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/resource_demand.hpp"
#include "sim/scene/scene.hpp"
#include "sweep/cancellation_token.hpp"
#include "sweep/point_run.hpp"

namespace twincell::sweep {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

Counts counts_of(const std::vector<Schedule*>& schedules) {
  Counts sum;
  for (const Schedule* schedule : schedules) {
    const Counts c = schedule->counts();
    sum.known += c.known;
    sum.done += c.done;
    sum.here += c.here;
    sum.failed += c.failed;
    sum.work_left += c.work_left;
    sum.most += c.most;
    sum.most_work += c.most_work;
  }
  return sum;
}

/// Worker threads that take points from the schedules, and the calling thread that reports progress.
class Farm {
 public:
  Farm(const std::vector<Schedule*>& schedules, const Store& store, const FarmOptions& options, Watch& watch)
      : schedules_(schedules), store_(store), options_(options), watch_(watch) {}

  bool run() {
    std::vector<std::thread> workers;
    workers.reserve(static_cast<std::size_t>(options_.threads));
    for (int t = 0; t < options_.threads; ++t) workers.emplace_back([this] { work(); });
    try {
      watch_until_idle();
    } catch (...) {
      fail(std::current_exception());
    }
    for (std::thread& worker : workers) worker.join();
    if (error_) std::rethrow_exception(error_);
    return all();
  }

 private:
  [[nodiscard]] bool all() const {
    return std::all_of(schedules_.begin(), schedules_.end(), [](const Schedule* s) { return s->all(); });
  }

  void fail(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::move(error);
    closing_ = true;
    changed_.notify_all();
  }

  void watch_until_idle() {
    std::unique_lock lock(mutex_);
    while (working_ > 0 || started_ < options_.threads) {
      changed_.wait_for(lock, 200ms);
      const Counts sum = counts_of(schedules_);
      // Once a point is done, so that every call makes progress, however short its time.
      if (!std::isnan(rate()) && watch_.time_left() < -overrun()) {
        late_ = true;  // before closing_, which ends the points
        closing_ = true;
      }
      const double left = sum.most_work / (rate() * options_.threads);
      lock.unlock();
      watch_.look(sum, left);
      lock.lock();
    }
  }

  /// By how many seconds the running points may exceed the time limit: a point that was expected to fit may
  /// be a little slower than the others.
  [[nodiscard]] double overrun() const {
    return std::max(5.0, 0.05 * std::chrono::duration<double>(Clock::now() - begin_).count());
  }

  /// Particle-steps per second of one worker, analysis included; NaN until a point is done.
  [[nodiscard]] double rate() const { return seconds_ > 0 ? work_ / seconds_ : kUnknown; }

  /// Largest work, in particle-steps, that fits into the time left. Absent without a limit, and while the
  /// speed is unknown.
  [[nodiscard]] std::optional<double> most_work() const {
    const double left = watch_.time_left();
    if (std::isnan(rate()) || left >= Watch::kNoTimeLimit) return std::nullopt;
    return left * rate();
  }

  void work() try {
    {
      const std::lock_guard lock(mutex_);
      ++started_;
      ++working_;
    }
    CancellationToken progress(closing_);
    StageTimes own;
    StageTimes* const times = options_.times != nullptr ? &own : nullptr;
    std::unique_lock lock(mutex_);
    while (!closing_ && watch_.time_left() > 0) {
      std::optional<Task> task;
      Schedule* schedule = nullptr;
      const std::optional<double> most = most_work();
      for (Schedule* s : in_turn())
        if (!task) {
          task = s->take(most);
          schedule = s;
        }
      if (!task) {
        if (all() || nothing_will_come()) break;
        const Stage waiting(times, "waiting for points");
        changed_.wait_for(lock, 100ms);
        continue;
      }
      ++busy_;
      lock.unlock();
      const auto begin = Clock::now();
      const std::string result = run_point(
          schedule->plan(), task->point,
          options_.keep_trajectories ? store_.of(task->point) / "trajectory.h5" : std::filesystem::path(),
          progress, times, options_.solver);
      {
        Stage storing(times, "storing", "points");
        store_.keep(task->point, result);
        storing.count(1);
      }
      lock.lock();
      --busy_;
      seconds_ += std::chrono::duration<double>(Clock::now() - begin).count();
      work_ += task->point.work;
      schedule->done(*task, result);
      changed_.notify_all();
    }
    if (times != nullptr) StageTimes::add(own.rows(), *options_.times);
    --working_;
    changed_.notify_all();
  } catch (const Interrupted&) {
    // A point that was ended because it is late stays open: the same command computes it.
    if (!late_) fail(std::current_exception());
    leave();
  } catch (...) {
    fail(std::current_exception());
    leave();
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    --working_;
    changed_.notify_all();
  }

  /// Schedules in the order of the points started, fewest first, so that all have progressed equally when a
  /// run stops.
  [[nodiscard]] std::vector<Schedule*> in_turn() const {
    std::vector<std::pair<std::size_t, Schedule*>> begun;
    for (Schedule* s : schedules_) {
      const Counts c = s->counts();
      begun.emplace_back(c.done + c.here, s);
    }
    std::stable_sort(begun.begin(), begun.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Schedule*> order;
    order.reserve(begun.size());
    for (const auto& [n, s] : begun) order.push_back(s);
    return order;
  }

  /// Whether no point runs here and the time is limited, so that no open point fits into the time left.
  [[nodiscard]] bool nothing_will_come() const {
    return busy_ == 0 && watch_.time_left() < Watch::kNoTimeLimit;
  }

  const std::vector<Schedule*>& schedules_;
  const Store& store_;
  const FarmOptions& options_;
  Watch& watch_;
  std::mutex mutex_;  ///< guards the schedules and the members below
  std::condition_variable changed_;
  std::atomic<bool> closing_ = false, late_ = false;
  const Clock::time_point begin_ = Clock::now();
  int started_ = 0, working_ = 0, busy_ = 0;
  double seconds_ = 0, work_ = 0;
  std::exception_ptr error_;
};

/// Lets a watch end the measurement of the speed.
class WatchedProgress : public Progress {
 public:
  WatchedProgress(Watch& watch, const Counts& counts) : watch_(watch), counts_(counts) {}
  void update(std::int64_t, std::int64_t) override { watch_.look(counts_, kUnknown); }

 private:
  Watch& watch_;
  const Counts& counts_;
};

/// Processor time of the results of schedules, s; NaN if one does not state it.
double processor_seconds_of(const std::vector<Schedule*>& schedules) {
  double sum = 0;
  for (const Schedule* schedule : schedules)
    for (const Curve& curve : schedule->curves())
      for (const auto& result : curve.results)
        if (result) sum += nlohmann::json::parse(*result)["computed"].value("processor_seconds", kUnknown);
  return sum;
}

}  // namespace

void require_memory_together(const Schedule& schedule, int together, const std::string& way,
                             double available) {
  const Plan& plan = schedule.plan();
  std::vector<std::pair<double, const Point*>> open;
  std::vector<std::unique_ptr<const Point>> ends;
  for (const Curve& curve : schedule.curves()) {
    if (curve.complete) continue;
    const Point* end = nullptr;
    // Most searches vary the strength of the drive, which does not change the memory demand.
    if (plan.search && !plan.search->key.starts_with("drive."))
      for (const double at : {plan.search->low, plan.search->high}) {
        ends.push_back(std::make_unique<const Point>(make_point(plan, curve.values, at, 0)));
        if (end == nullptr || ends.back()->memory > end->memory) end = ends.back().get();
      }
    for (std::size_t i = 0; i < curve.points.size(); ++i)
      if (!curve.results[i]) {
        const Point* point = end != nullptr ? end : &curve.points[i];
        open.emplace_back(point->memory, point);
      }
  }
  std::sort(open.begin(), open.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  open.resize(std::min(open.size(), static_cast<std::size_t>(std::max(together, 1))));
  double sum = 0;
  std::size_t fit = 0;
  for (const auto& [memory, point] : open) {
    sum += memory;
    if (sum <= available) ++fit;
  }
  if (fit == open.size()) return;
  const Point& largest = *open.front().second;
  const sim::Scene scene = sim::read_scene_text(largest.scene, plan.scene_name, {}, plan.scene_folder);
  const char* key = scene.source && scene.source->has("beads.layers") ? "beads.layers" : "beads.count";
  if (fit == 0)
    throw ConfigError(
        {.file = plan.file, .key = key},
        fmt::format("requires {} beads in one point, which take about {} of memory; the machine "
                    "has {} available.",
                    scene.n_beads.value_or(0), sim::bytes_text(largest.memory), sim::bytes_text(available)));
  throw ConfigError(
      {.file = plan.file, .key = key},
      fmt::format(
          "with up to {} beads in a point, {} points that run at once take about {} of memory, and the "
          "machine has {} available; with {} {} they fit.",
          scene.n_beads.value_or(0), open.size(), sim::bytes_text(sum), sim::bytes_text(available), way,
          fit));
}

void announce(const std::vector<Schedule*>& schedules, const FarmOptions& options, Watch& watch) {
  constexpr double kLong = 1e10;     // particle-steps
  constexpr double kMeasured = 0.1;  // s
  const Counts counts = counts_of(schedules);
  // The speed of a device is not measured here.
  if (counts.most_work < kLong || options.solver != sim::SolverKind::best) return;
  const Point* longest = nullptr;
  const Plan* plan = nullptr;
  for (const Schedule* schedule : schedules)
    if (const Point* open = schedule->longest_open())
      if (longest == nullptr || open->work > longest->work) longest = open, plan = &schedule->plan();
  if (longest == nullptr) return;
  WatchedProgress progress(watch, counts);
  const sim::Cost cost = sim::measure_cost(
      sim::read_scene_text(longest->scene, plan->scene_name, {}, plan->scene_folder), kMeasured, 1, progress);
  if (!cost.stopped.empty() || cost.beads == 0) return;
  watch.expect(
      counts, counts.most_work * cost.seconds_per_step / (static_cast<double>(cost.beads) * options.threads));
}

bool run_here(const std::vector<Schedule*>& schedules, const Store& store, const FarmOptions& options,
              Watch& watch) {
  const bool all = Farm(schedules, store, options, watch).run();
  watch.cost(processor_seconds_of(schedules));
  return all;
}

}  // namespace twincell::sweep
