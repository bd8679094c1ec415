#include "cli/mpi_farm.hpp"

#include "core/error.hpp"
#include "core/json_text.hpp"

#ifdef TWINCELL_MPI

#define OMPI_SKIP_MPICXX  // only the C interface: the C++ one was removed from the standard and is not
                          // linked
#include <mpi.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sweep/cancellation_token.hpp"
#include "sweep/point_run.hpp"

namespace twincell::cli {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr int kWork = 1, kResult = 2, kEnd = 3;

std::string receive(const MPI_Status& status) {
  int size = 0;
  MPI_Get_count(&status, MPI_CHAR, &size);
  std::string text(static_cast<std::size_t>(size), '\0');
  MPI_Recv(text.data(), size, MPI_CHAR, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return text;
}

void send(const std::string& text, int rank, int tag) {
  MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, rank, tag, MPI_COMM_WORLD);
}

/// Checks for a message. If there is none, the rank sleeps, which leaves its core to the ranks that compute.
bool waits(MPI_Status& status) {
  int there = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
  if (there == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return there != 0;
}

/// Progress that only checks for a signal.
class Signals : public Progress {
 public:
  explicit Signals(sweep::Watch& watch) : watch_(watch) {}
  void update(std::int64_t, std::int64_t) override { watch_.look({}, kUnknown); }

 private:
  sweep::Watch& watch_;
};

std::string computed(const sweep::Plan& plan, const sweep::Store& store, const sweep::Point& point,
                     bool keep_trajectories, Progress& progress) {
  return run_point(plan, point,
                   keep_trajectories ? store.of(point) / "trajectory.h5" : std::filesystem::path(), progress);
}

void serve(const sweep::Plan& plan, const sweep::Store& store, bool keep_trajectories) {
  Common silent;
  silent.quiet = true;
  SweepWatch watch(silent);
  Signals progress(watch);
  for (;;) {
    MPI_Status status;
    watch.look({}, kUnknown);
    if (!waits(status)) continue;
    const int tag = status.MPI_TAG;
    const std::string message = receive(status);
    if (tag == kEnd) return;
    const auto j = nlohmann::json::parse(message);
    sweep::Point point;
    point.id = j.at("id");
    point.seed = j.at("seed");
    point.scene = j.at("scene");
    send(computed(plan, store, point, keep_trajectories, progress), 0, kResult);
  }
}

/// Number of ranks on this machine, which share its memory.
int ranks_here() {
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  int n = 1;
  MPI_Comm_size(here, &n);
  MPI_Comm_free(&here);
  return n;
}

void lead(sweep::Schedule& schedule, const sweep::Plan& plan, const sweep::Store& store,
          bool keep_trajectories, SweepWatch& watch) {
  using Clock = std::chrono::steady_clock;
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  std::vector<std::optional<sweep::Task>> at(static_cast<std::size_t>(ranks));
  std::future<std::string> own;
  std::atomic<bool> closing = false;
  sweep::CancellationToken progress(closing);
  double work = 0;
  const auto begin = Clock::now();
  const auto keep = [&](std::size_t rank, const std::string& result) {
    store.keep(at[rank]->point, result);
    work += at[rank]->point.work;
    schedule.done(*at[rank], result);
    at[rank].reset();
  };
  try {
    while (!schedule.all()) {
      for (std::size_t rank = at.size(); rank-- > 0;) {  // rank 0 last, because it also handles the messages
        if (at[rank] || !(at[rank] = schedule.take())) continue;
        const sweep::Point& point = at[rank]->point;
        if (rank > 0)
          send(json_text({{"id", point.id}, {"seed", point.seed}, {"scene", point.scene}}),
               static_cast<int>(rank), kWork);
        else
          own = std::async(std::launch::async,
                           [&, point] { return computed(plan, store, point, keep_trajectories, progress); });
      }
      MPI_Status status;
      if (waits(status)) keep(static_cast<std::size_t>(status.MPI_SOURCE), receive(status));
      if (at[0] && own.wait_for(std::chrono::seconds(0)) == std::future_status::ready) keep(0, own.get());
      const sweep::Counts counts = schedule.counts();
      const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      watch.look(counts, work > 0 ? counts.most_work * seconds / work : kUnknown);
    }
  } catch (...) {
    closing = true;
    throw;
  }
  for (int rank = 1; rank < ranks; ++rank) send("", rank, kEnd);
}

}  // namespace

MpiJob::MpiJob() {
  int level = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  watch_signals();  // MPI_Init may have replaced the signal handlers
}

MpiJob::~MpiJob() {
  MPI_Finalize();
}

void run_on_ranks(sweep::Schedule* schedule, const sweep::Plan& plan, const sweep::Store& store,
                  bool keep_trajectories, SweepWatch& watch) {
  try {
    const int together = ranks_here();  // a collective call: every rank must make it
    if (schedule != nullptr) require_memory_together(*schedule, together, "mpirun -n");
    if (schedule != nullptr)
      lead(*schedule, plan, store, keep_trajectories, watch);
    else
      serve(plan, store, keep_trajectories);
  } catch (const Error& e) {
    std::fprintf(stderr, "twincell: %s\n", e.what());
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(e.exit_code()));
  }
}

}  // namespace twincell::cli

#else

namespace twincell::cli {

MpiJob::MpiJob() {
  throw ConfigError(
      {"", 0, 0, "--mpi"},
      "this program was built without MPI; install libopenmpi-dev and openmpi-bin and build it again.");
}
MpiJob::~MpiJob() = default;

void run_on_ranks(sweep::Schedule*, const sweep::Plan&, const sweep::Store&, bool, SweepWatch&) {}

}  // namespace twincell::cli

#endif
