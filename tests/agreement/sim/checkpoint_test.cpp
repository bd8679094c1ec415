// A run that is saved and resumed in another process, with another vector width and another thread count,
// gives the same bits as the uninterrupted run.

#include "sim/run/checkpoint.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "sim/run/make_solver.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::sim::checkpoint_test {
namespace {

template <class Row>
bool same_bits(const std::vector<Row>& a, const std::vector<Row>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(static_cast<const void*>(a.data()), b.data(),
                                                           a.size() * sizeof(Row)) == 0);
}

bool same_bits(const BedForces& a, const BedForces& b) {
  if (!a.known() || !b.known()) return a.known() == b.known();
  return a.wall_force == b.wall_force && a.wall_normal_force == b.wall_normal_force && a.stress == b.stress &&
         a.kinetic == b.kinetic && a.in_contact == b.in_contact && a.normal_force == b.normal_force &&
         a.tangential_force == b.tangential_force;
}

bool same_bits(const RunState& a, const RunState& b) {
  bool same = a.driven == b.driven && a.step == b.step && a.quiet == b.quiet &&
              a.settled.time == b.settled.time && a.settled.energy_per_bead == b.settled.energy_per_bead &&
              a.settled.reached == b.settled.reached && a.height == b.height && same_bits(a.beads, b.beads) &&
              same_bits(a.forces, b.forces) && same_bits(a.rim_speeds, b.rim_speeds) &&
              same_bits(a.tracer, b.tracer) && a.temperature.all == b.temperature.all &&
              a.temperature.coarse == b.temperature.coarse && a.temperature.steps == b.temperature.steps &&
              same_bits(a.forces_sum, b.forces_sum) && a.contacts.size() == b.contacts.size();
  for (std::size_t k = 0; same && k < a.contacts.size(); ++k)
    same = a.contacts[k].i == b.contacts[k].i && a.contacts[k].j == b.contacts[k].j &&
           same_bits(a.contacts[k].values, b.contacts[k].values);
  return same;
}

/// Stores the state of the run at every `every`-th progress update.
class Keeping : public Progress {
 public:
  Keeping(const Simulation& run, int every) : run_(run), every_(every) {}
  void update(std::int64_t /*done*/, std::int64_t /*total*/) override {
    if (++updates_ % every_ == 0) states.push_back(run_.state());
  }
  std::vector<RunState> states;

 private:
  const Simulation& run_;
  int every_, updates_ = 0;
};

class Nowhere : public TrajectorySink {
 public:
  void append(const Frame& frame) override { means.push_back(frame.time_mean.temperature); }
  std::vector<Vec3> means;
};

const std::string kScene =
    "[beads]\ncount = 40\nspread = \"uniform\"\nspread_width = 0.1\n[drive]\nomega = 6.0\ngamma = 3.0\n"
    "schedule = [[0.0, 0.5], [0.7, 1.0]]\n[start]\nkind = \"random\"\nseed = 5\nsettle_limit = 3.0\n"
    "[time]\nsteps_per_contact = 10\ndiscard = 0\ncycles = 2\nphases = 10\n";
const std::string kPlane = "[cell]\nwidth = 8.0\n";
const std::string kSpace = "[cell]\ndimension = 3\nwidth = 4.0\ndepth = 4.0\nplates = \"periodic\"\n";

/// \param turn  selects the solver of each restart: over the integrators and the two cells every law meets
/// every solver, from both states. That all solvers give the same bits is held by kernels_test and
/// list_and_oracle_test.
void expect_resumable(const std::string& laws, const std::string& integrator, std::size_t turn) {
  const TemporaryFolder folder;
  const std::string text = laws + integrator;
  const Scene scene = read_scene_text(kScene + laws, "s", {"time.integrator=" + integrator});
  Simulation whole(scene, placed(scene));
  Keeping settling(whole, 3), driving(whole, 7);
  whole.settle(settling);
  Nowhere sink;
  whole.run(sink, driving);
  ASSERT_GE(settling.states.size(), 2U) << text;
  ASSERT_GE(driving.states.size(), 2U) << text;
  const RunState end = whole.state();
  std::vector<RunState> states{settling.states.back(), driving.states[driving.states.size() / 2]};
  std::size_t remembered = 0;
  constexpr std::array kSolvers = {SolverKind::scalar, SolverKind::best, SolverKind::all_pairs};
  for (const RunState& state : states) {
    const SolverKind kind = kSolvers[turn++ % kSolvers.size()];
    remembered += state.contacts.size();
    write_checkpoint(folder / "state.h5", {scene.resolved, "{}", "p", {{3, "abc"}}, state});
    const Checkpoint read = read_checkpoint(folder / "state.h5");
    ASSERT_TRUE(same_bits(read.state, state)) << text;
    ASSERT_EQ(read.segments.size(), 1U);
    EXPECT_EQ(read.segments[0].frames, 3);
    EXPECT_EQ(read.segments[0].sha256, "abc");
    Simulation rest(scene, read.state, kind, 2);
    Nowhere others;
    rest.run(others);
    EXPECT_TRUE(same_bits(rest.state(), end)) << text << " from step " << state.step;
    // The frames after the restart, with their time averages; the first frame of a run has no time average.
    ASSERT_GE(sink.means.size(), others.means.size());
    for (std::size_t k = 1; k <= others.means.size(); ++k) {
      const Vec3 &mean = others.means[others.means.size() - k], &truth = sink.means[sink.means.size() - k];
      EXPECT_TRUE(mean == truth || (k == sink.means.size() && mean.hasNaN() && truth.hasNaN())) << text;
    }
  }
  EXPECT_TRUE(remembered > 0 || !whole.plan().history) << text;
}

// The contact forces of a frame follow from the contact memories. After a restart the first frame may come
// before the first step.
TEST(Checkpoint, EventDrivenMotionRemembersItsContacts) {
  const TemporaryFolder folder;
  const Scene scene = read_scene_text(
      "[cell]\nwidth = 10.0\nsides = \"periodic\"\n[beads]\ncount = 40\n[contact]\nk_n = 2e4\ngamma_n = "
      "60\nmu = 0.4\nk_t = 3e4\ngamma_t = 20\n[drive]\nomega = 1.0\nk_m = 30.0\n[start]\nkind = "
      "\"random\"\nseed = 3\n[time]\nstepping = \"event-driven\"\ndiscard = 2\ncycles = 3\nphases = "
      "100\ncontacts = true\nsprings = true\n",
      "s");
  Simulation whole(scene, placed(scene));
  Keeping driving(whole, 1);
  MemoryTrajectory frames;
  whole.run(frames, driving);
  std::size_t remembered = 0, compared = 0;
  for (const RunState& state : driving.states) {
    if (state.contacts.empty() || !state.driven || compared > 20) continue;
    write_checkpoint(folder / "state.h5", {scene.resolved, "{}", "p", {{3, "abc"}}, state});
    const RunState read = read_checkpoint(folder / "state.h5").state;
    Simulation rest(scene, read);
    EXPECT_TRUE(same_bits(rest.state(), state)) << "before a step, step " << state.step;
    remembered += state.contacts.size();
    ++compared;
  }
  EXPECT_GT(remembered, 10U);
  EXPECT_EQ(frames.frames().size(), 300U);
}

// A run that is resumed between two frames continues the sums over samples of its contact forces.
TEST(Checkpoint, MeanForcesGoOnToTheBit) {
  const TemporaryFolder folder;
  const Scene scene = read_scene_text(kScene + kPlane + "[contact]\nk_n = 1e4\ngamma_n = 10.0\nk_t = 2e3\n",
                                      "s", {"time.contacts=true", "time.phases=4", "beads.count=300"});
  Simulation whole(scene, placed(scene));
  Keeping driving(whole, 1);
  MemoryTrajectory frames(whole.trajectory_info());
  whole.settle();
  whole.run(frames, driving);
  std::size_t between = 0, compared = 0;
  for (const RunState& state : driving.states) {
    if (!state.forces_sum.known() || state.forces_sum.stress.norm() == 0 || between >= 6) continue;
    ++between;
    write_checkpoint(folder / "state.h5", {scene.resolved, "{}", "p", {{3, "abc"}}, state});
    const RunState read = read_checkpoint(folder / "state.h5").state;
    ASSERT_TRUE(same_bits(read, state));
    for (const SolverKind kind : {SolverKind::scalar, SolverKind::best}) {
      Simulation rest(scene, read, kind, 2);
      MemoryTrajectory others(rest.trajectory_info());
      rest.run(others);
      for (std::size_t k = 1; k <= others.n_frames() && k < frames.n_frames(); ++k, ++compared) {
        const BedForces &mean = others.frames()[others.n_frames() - k].force_mean,
                        &truth = frames.frames()[frames.n_frames() - k].force_mean;
        EXPECT_TRUE(truth.known());
        EXPECT_TRUE(same_bits(mean, truth))
            << "from step " << state.step << ", frame " << k << " from the end";
      }
    }
  }
  EXPECT_GE(between, 3U);
  EXPECT_GE(compared, 12U);
}

TEST(Checkpoint, EveryLawGoesOnToTheBit) {
  const std::vector<std::string> laws = {
      "k_n = 1e4\ngamma_n = 10.0\ngamma_t = 10.0\nk_t = 2e3\n",
      "k_n = 1e4\ngamma_n = 10.0\ngamma_t = 10.0\nk_t = 2e3\ntangential = \"spring-limited\"\nnormal = "
      "\"linear-no-tension\"\n",
      "k_n = 1e4\nrestitution = 0.9\ntangential = \"dashpot\"\nc_t_over_c_n = 1.0\nmu = 0.4\n",
      "k_n = 1e4\nrestitution = 0.9\ntangential = \"none\"\n",
      "normal = \"hertz\"\nyoungs_modulus = 1e5\nviscous_time = 1e-4\nk_t = 2e3\n",
      "normal = \"velocity-dependent-restitution\"\nk_n = 1e4\nrestitution_fast = 0.8\nk_t = 2e3\nrolling = "
      "\"spring\"\nk_r = 100.0\nmu_r = 0.1\n"};
  for (const std::string& law : laws) {
    std::size_t turn = 0;
    for (const std::string& cell : {kPlane, kSpace})
      for (const char* integrator : {"verlet", "predicted", "split"})
        expect_resumable(cell + "[contact]\n" + law, integrator, turn++);
  }
}

}  // namespace
}  // namespace twincell::sim::checkpoint_test
