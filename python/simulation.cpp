// Scenes and simulations in Python.

#include "sim/run/simulation.hpp"

#include <fmt/format.h>

#include <atomic>
#include <set>

#include "core/error.hpp"
#include "core/key_assignments.hpp"
#include "python/trajectory.hpp"
#include "sim/accuracy/plan_json.hpp"
#include "sim/scene/make_plan.hpp"
#include "sim/scene/presets.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/resource_demand.hpp"

namespace twincell::python {

namespace {

constexpr const char* kHeader = "sim/run/simulation.hpp";

std::string provenance_of_run(const sim::Scene& scene, const std::vector<sim::Bead>& beads,
                              const std::string& call, int threads) {
  Provenance provenance = provenance_of(call);
  if (std::filesystem::is_regular_file(scene.file)) provenance.inputs.emplace_back(scene.file);
  return sim::scene_provenance(std::move(provenance), scene, beads, threads);
}

/// Appends frames to several sinks' worth of memory: those of this call and those of the whole run.
class Recorder : public TrajectorySink {
 public:
  Recorder(SharedFrames& call, SharedFrames& run) : call_(call), run_(run) {}
  void append(const Frame& frame) override {
    const auto shared = std::make_shared<const Frame>(frame);
    call_.append(shared);
    run_.append(shared);
  }

 private:
  SharedFrames &call_, &run_;
};

/// A run that is stepped by hand.
class Run {
 public:
  Run(const sim::Scene& scene, int threads, const py::object& callback) {
    require_range({.file = {}, .key = "threads"}, threads, 0, 4096);
    const std::string call = "twincell.Simulation (Python)";
    unlocked(callback, [&](Progress& progress) {
      sim::RunState state = sim::placed(scene, progress);
      provenance_ = provenance_of_run(scene, state.beads, call, threads);
      run_ = std::make_unique<sim::Simulation>(scene, std::move(state), sim::SolverKind::best, threads);
    });
  }

  /// Exclusive use of the run: another thread may hold the interpreter's lock while this one computes.
  class Use {
   public:
    explicit Use(std::atomic<bool>& busy) : busy_(busy) {
      if (busy_.exchange(true)) throw RunError("The simulation is running in another thread.");
    }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;
    ~Use() { busy_ = false; }

   private:
    std::atomic<bool>& busy_;
  };

  void settle(const py::object& callback) {
    const Use use(busy_);
    settle_once(callback);
  }

  std::shared_ptr<Trajectory> run(std::optional<double> cycles, const py::object& callback) {
    const Use use(busy_);
    std::int64_t most = std::numeric_limits<std::int64_t>::max();
    if (cycles) {
      require_range({.file = {}, .key = "cycles"}, *cycles, 0, 1e9, true);
      most = std::llround(*cycles * run_->scene().phases);
      if (most < 1)
        throw ConfigError({.file = {}, .key = "cycles"},
                          fmt::format("is {:g}, less than one frame; a cycle has {} frames.", *cycles,
                                      run_->scene().phases));
    }
    settle_once(callback);
    const sim::Scene& scene = run_->scene();
    const auto left = scene.cycles * scene.phases - static_cast<std::int64_t>(all_->n_frames());
    if (cycles && most > left)
      throw RunError(
          left > 0
              ? fmt::format("{:g} cycles were requested, but the run has {:g} of its {} cycles left; a scene "
                            "with a larger time.cycles runs longer.",
                            *cycles, static_cast<double>(left) / scene.phases, scene.cycles)
              : fmt::format(
                    "The run has reached its {} cycles; a scene with a larger time.cycles runs longer.",
                    scene.cycles));
    SharedFrames these(all_->info());
    Recorder recorder(these, *all_);
    unlocked(callback, [&](Progress& progress) { run_->run(recorder, progress, most); });
    return std::make_shared<Trajectory>(std::move(these));
  }

  [[nodiscard]] std::shared_ptr<Trajectory> trajectory() {
    const Use use(busy_);
    settle_once(py::none());
    return std::make_shared<Trajectory>(*all_);
  }
  [[nodiscard]] const sim::Simulation& simulation() const { return *run_; }

 private:
  void settle_once(const py::object& callback) {
    if (all_) return;
    unlocked(callback, [&](Progress& progress) { run_->settle(progress); });
    TrajectoryInfo info = run_->trajectory_info();
    info.provenance_json = provenance_;
    all_.emplace(std::move(info));
  }

  std::unique_ptr<sim::Simulation> run_;
  std::string provenance_;
  std::optional<SharedFrames> all_;  ///< after settling
  std::atomic<bool> busy_{false};
};

std::shared_ptr<Trajectory> simulate(sim::Scene scene, const std::optional<std::filesystem::path>& output,
                                     int threads, const py::object& callback) {
  require_range({.file = {}, .key = "threads"}, threads, 0, 4096);
  if (output) {
    std::vector<std::filesystem::path> inputs = scene.named_files();
    inputs.emplace_back(scene.file);
    require_no_input(*output, inputs);
  }
  std::vector<std::string> warnings;
  std::optional<SharedFrames> memory;
  unlocked(callback, [&](Progress& progress) {
    if (output && scene.n_beads) sim::require_disk(scene, sim::make_plan(scene), *scene.n_beads, *output);
    sim::RunState state = sim::placed(scene, progress);
    const std::string provenance =
        provenance_of_run(scene, state.beads, "twincell.simulate (Python)", threads);
    sim::Simulation run(std::move(scene), std::move(state), sim::SolverKind::best, threads);
    run.settle(progress);
    warnings = run.warnings();
    TrajectoryInfo info = run.trajectory_info();
    info.provenance_json = provenance;
    if (output) {
      H5mdWriter writer(*output, std::move(info));
      run.run(writer, progress);
      writer.finish();
    } else {
      memory.emplace(std::move(info));
      run.run(*memory, progress);
    }
  });
  for (const std::string& warning : warnings) warn(warning);
  return output ? std::make_shared<Trajectory>(*output) : std::make_shared<Trajectory>(std::move(*memory));
}

std::vector<std::string> checked(const std::vector<std::string>& assignments) {
  refuse_contradictory_assignments(assignments);
  return assignments;
}

void bind_scene(py::module_& module) {
  py::class_<sim::Scene>(module, "Scene", header_text("sim/scene/scene.hpp", "Scene"))
      .def_static(
          "from_toml",
          [](const std::filesystem::path& path, const std::vector<std::string>& set) {
            return sim::read_scene(path, checked(set));
          },
          py::arg("path"), py::arg("set") = std::vector<std::string>{},
          header_text("sim/scene/read_scene.hpp", "read_scene"))
      .def_static(
          "from_text",
          [](const std::string& text, const std::string& name, const std::vector<std::string>& set) {
            return sim::read_scene_text(text, name, checked(set));
          },
          py::arg("text"), py::arg("name") = "scene", py::arg("set") = std::vector<std::string>{},
          header_text("sim/scene/read_scene.hpp", "read_scene_text"))
      .def_readonly("text", &sim::Scene::resolved, header_text("sim/scene/scene.hpp", "Scene::resolved"))
      .def_readonly("drive", &sim::Scene::drive, header_text("trajectory/drive.hpp", "Drive"))
      .def_readonly("n_beads", &sim::Scene::n_beads, header_text("sim/scene/scene.hpp", "Scene::n_beads"))
      .def_readonly("width", &sim::Scene::width, header_text("sim/scene/scene.hpp", "Scene::width"))
      .def_readonly("seed", &sim::Scene::seed, "Seed of the random numbers of the start.")
      .def_readonly("discard", &sim::Scene::discard, "Number of cycles that run before the first frame.")
      .def_readonly("cycles", &sim::Scene::cycles, "Number of recorded cycles.")
      .def_readonly("phases", &sim::Scene::phases, "Number of frames per cycle.")
      .def_property_readonly(
          "void_keys",
          [](const sim::Scene& s) {
            std::vector<std::string> texts;
            for (const sim::VoidKey& key : s.void_keys) texts.push_back(key.text());
            return texts;
          },
          header_text("sim/scene/scene.hpp", "VoidKey"))
      .def(
          "explain",
          [](const sim::Scene& scene, double seconds, int threads, const py::object& callback) {
            require_range({.file = {}, .key = "seconds"}, seconds, 0, 3600, true);
            return from_json(unlocked(callback, [&](Progress& progress) {
              return sim::cost_json(scene, sim::measure_cost(scene, seconds, threads, progress));
            }));
          },
          py::arg("seconds") = 0.3, py::arg("threads") = 0, py::arg("callback") = py::none(),
          header_text("sim/accuracy/plan_json.hpp", "cost_json"))
      .def(py::pickle([](const sim::Scene& s) { return py::make_tuple(s.resolved, s.file); },
                      [](const py::tuple& state) {
                        return sim::read_scene_text(state[0].cast<std::string>(),
                                                    state[1].cast<std::string>());
                      }))
      .def(
          "__eq__", [](const sim::Scene& a, const sim::Scene& b) { return a.resolved == b.resolved; },
          py::is_operator())
      .def("__hash__", [](const sim::Scene& s) { return py::hash(py::str(s.resolved)); })
      .def("__repr__", [](const sim::Scene& s) {
        return fmt::format("<twincell.Scene {}: Gamma = {:.6g}, {} cycles after {}>", s.file,
                           s.g() > 0 ? s.drive.gamma() : 0, s.cycles, s.discard);
      });
  module.def("preset_names", &sim::preset_names, "Names of the presets, for Scene.preset.");
}

}  // namespace

void bind_simulation(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(sim::Bead, x, z, vx, vz, spin, radius, mass, inertia, y, vy, spin_x, spin_z);
  bind_scene(module);
  py::class_<Run, std::shared_ptr<Run>>(module, "Simulation", header_text(kHeader, "Simulation"))
      .def(py::init<const sim::Scene&, int, const py::object&>(), py::arg("scene"), py::kw_only(),
           py::arg("threads") = 0, py::arg("callback") = py::none(),
           "Places the beads; no step is done yet.\n\nthreads: 0: chosen from the number of beads; the bits "
           "do not depend on it. callback: function of (done, total).")
      .def("settle", &Run::settle, py::arg("callback") = py::none(),
           header_text(kHeader, "Simulation::settle"))
      .def("run", &Run::run, py::arg("cycles") = py::none(), py::arg("callback") = py::none(),
           "Goes on by this number of recorded cycles, or to the end of the scene, and returns their frames. "
           "Settles and runs the discarded cycles first if that is not done. At the end of the scene the "
           "result has no frame, and a number of cycles is refused (RunError).")
      .def_property_readonly("trajectory", &Run::trajectory, "All frames so far, without a copy.")
      .def_property_readonly(
          "state",
          [](const std::shared_ptr<Run>& run) {
            const std::vector<sim::Bead>& beads = run->simulation().system().beads;
            return view(beads.data(), {static_cast<py::ssize_t>(beads.size())}, {sizeof(sim::Bead)}, run);
          },
          "The beads now: a read-only structured array over the memory of the simulation, which changes as "
          "it runs. Fields x, y, z, vx, vy, vz, spin, spin_x, spin_z, radius, mass, inertia.")
      .def_property_readonly(
          "time", [](const Run& r) { return r.simulation().system().time(); },
          "Time since the start of settling or, under drive, since phase 0, t0.")
      .def_property_readonly(
          "plate_height", [](const Run& r) { return r.simulation().system().plate_height(); },
          "Displacement of the plate along the axis of the drive, sigma.")
      .def_property_readonly(
          "steps_done", [](const Run& r) { return r.simulation().steps_done(); },
          header_text(kHeader, "Simulation::steps_done"))
      .def_property_readonly(
          "warnings", [](const Run& r) { return r.simulation().warnings(); },
          header_text(kHeader, "Simulation::warnings"))
      .def_property_readonly(
          "plan", [](const Run& r) { return from_json(sim::plan_json(r.simulation().plan())); },
          header_text("sim/accuracy/plan_json.hpp", "plan_json"))
      .def_property_readonly(
          "settled",
          [](const Run& r) {
            const sim::RelaxationResult& s = r.simulation().settled();
            py::dict d;
            d["time"] = s.time;
            d["energy_per_bead"] = s.energy_per_bead;
            d["reached"] = s.reached;
            return d;
          },
          header_text(kHeader, "RelaxationResult"))
      .def_property_readonly(
          "contact_fraction", [](const Run& r) { return r.simulation().contact_fraction(); },
          header_text(kHeader, "Simulation::contact_fraction"));
  module.def(
      "simulate", &simulate, py::arg("scene"), py::arg("output") = py::none(), py::kw_only(),
      py::arg("threads") = 0, py::arg("callback") = py::none(),
      "Runs a scene and returns its trajectory, in memory or, with `output`, in a file (H5MD).\n\n"
      "threads: 0: chosen from the number of beads; the bits do not depend on it. callback: function of "
      "(done, total), called at most ten times a second. Ctrl-C stops the run; an unfinished file is "
      "removed.");
}

}  // namespace twincell::python
