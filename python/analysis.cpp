// analyze in Python: options of the verb's names, results as objects.

#include <fmt/format.h>

#include "analysis/observable/observable.hpp"
#include "analysis/observable/results.hpp"
#include "analysis/observable/short_periods.hpp"
#include "analysis/runs/pooling.hpp"
#include "analysis/runs/windows.hpp"
#include "core/error.hpp"
#include "core/json_view.hpp"
#include "python/trajectory.hpp"

namespace twincell::python {

namespace {

constexpr const char* kHeader = "analysis/observable/observable.hpp";

/// Results of one call, in order.
struct Results {
  std::vector<analysis::Result> all;
  std::string provenance_json;
};

/// State for pickle: the results as results_json with their order, and the provenance.
py::tuple pickled(const std::vector<analysis::Result>& all, const std::string& provenance) {
  std::vector<std::string> names;
  for (const analysis::Result& one : all) names.push_back(one.name);
  return py::make_tuple(analysis::results_json(all), names, provenance);
}
Results unpickled(const py::tuple& state) {
  const auto read =
      analysis::results_from_json(JsonView::parse(state[0].cast<std::string>(), "the pickled results"));
  Results results{{}, state[2].cast<std::string>()};
  for (const auto& name : state[1].cast<std::vector<std::string>>())
    results.all.push_back(*analysis::seek_result(read, name));
  return results;
}

py::object value_of(const analysis::Result& r) {
  if (!r.present()) return py::none();
  if (!r.text.empty()) return py::str(r.text);
  if (r.shape.empty()) return py::float_(r.value());
  return array_of(r.values, {r.shape.begin(), r.shape.end()});
}

py::object interval_of(const analysis::Result& r) {
  if (!r.interval) return py::none();
  return py::make_tuple(r.interval->low, r.interval->high);
}

/// The notes of the verb on periods too short for neighbours.
void warn_of_periods(const TrajectorySource& source, const analysis::AnalysisOptions& options) {
  for (const std::string& sentence : analysis::short_periods(source.info(), options))
    warn(fmt::format("{}: {}.", source.name(), sentence));
}

Results analyzed(const std::vector<std::shared_ptr<Trajectory>>& trajectories,
                 const analysis::AnalysisOptions& options, const py::object& callback) {
  std::vector<const TrajectorySource*> sources;
  Provenance provenance = provenance_of("twincell.analyze (Python)");
  for (const auto& t : trajectories) {
    if (t->n_frames() == 0)
      throw InputError({.file = t->source().name(), .key = {}}, "the trajectory contains no frame");
    sources.push_back(&t->source());
    if (std::filesystem::is_regular_file(t->source().name()))
      provenance.inputs.emplace_back(t->source().name());
  }
  if (sources.empty()) throw ConfigError({.file = {}, .key = "trajectory"}, "the list has no trajectory.");
  for (const std::string& doubt : analysis::require_one_condition(sources)) warn(doubt);
  for (const TrajectorySource* source : sources) warn_of_periods(*source, options);
  return unlocked(callback, [&](Progress& progress) {
    return Results{analysis::analyze_together(sources.size(), options,
                                              [&](std::size_t i, const analysis::AnalysisOptions& of_run) {
                                                return analysis::analyze(*sources[i], of_run, progress);
                                              }),
                   provenance.to_json()};
  });
}

/// A window and its results.
struct WindowOfRun {
  analysis::Window window;
  Results results;
};

std::vector<WindowOfRun> analyzed_windows(const Trajectory& trajectory,
                                          const analysis::AnalysisOptions& options, std::int64_t cycles,
                                          const py::object& callback) {
  warn_of_periods(trajectory.source(), options);
  Provenance provenance = provenance_of("twincell.analyze_windows (Python)");
  if (std::filesystem::is_regular_file(trajectory.source().name()))
    provenance.inputs.emplace_back(trajectory.source().name());
  return unlocked(callback, [&](Progress& progress) {
    std::vector<WindowOfRun> all;
    for (analysis::Window& w : analysis::analyze_windows(trajectory.source(), options, cycles, progress)) {
      Results results{std::move(w.results), provenance.to_json()};
      all.push_back({std::move(w), std::move(results)});
    }
    return all;
  });
}

/// (at its beginning, at its end) of a number of the drive, or None.
template <class Number>
py::object ends_of(const WindowOfRun& w, Number number) {
  if (!w.window.drive) return py::none();
  return py::make_tuple(number((*w.window.drive)[0]), number((*w.window.drive)[1]));
}

/// Names of results: a list, or a text with commas as of the verb.
std::vector<std::string> names_of(const py::object& only) {
  if (!py::isinstance<py::str>(only)) return only.cast<std::vector<std::string>>();
  return only.attr("split")(",").cast<std::vector<std::string>>();
}

}  // namespace

void bind_analysis(py::module_& module) {
  py::class_<analysis::Result>(module, "Result", header_text(kHeader, "Result"))
      .def_readonly("name", &analysis::Result::name, "Name of the result.")
      .def_property_readonly("value", &value_of,
                             "A number, a word, or an array; None if the result is absent (see `absent`).")
      .def_property_readonly("interval", &interval_of, "(low, high) of the confidence interval, or None.")
      .def_property_readonly(
          "level",
          [](const analysis::Result& r) {
            return r.interval ? std::optional(r.interval->level) : std::nullopt;
          },
          "Confidence level of the interval.")
      .def_property_readonly(
          "method", [](const analysis::Result& r) { return r.interval ? r.interval->method : std::string(); },
          header_text("analysis/statistics/statistics.hpp", "Interval::method"))
      .def_readonly("unit", &analysis::Result::unit, header_text(kHeader, "Result::unit"))
      .def_readonly("n", &analysis::Result::n, header_text(kHeader, "Result::n"))
      .def_readonly("n_of", &analysis::Result::n_of, header_text(kHeader, "Result::n_of"))
      .def_readonly("no_interval", &analysis::Result::no_interval,
                    header_text(kHeader, "Result::no_interval"))
      .def_readonly("convention", &analysis::Result::convention, header_text(kHeader, "Result::convention"))
      .def_readonly("source", &analysis::Result::source, header_text(kHeader, "Result::source"))
      .def_readonly("absent", &analysis::Result::absent, header_text(kHeader, "Result::absent"))
      .def_readonly("of_runs", &analysis::Result::of_runs, header_text(kHeader, "Result::of_runs"))
      .def("__float__",
           [](const analysis::Result& r) {
             if (!r.present()) throw ConfigError({.file = {}, .key = r.name}, "is absent: " + r.absent);
             if (!r.text.empty() || !r.shape.empty())
               throw ConfigError({.file = {}, .key = r.name}, "is not a single number.");
             return r.value();
           })
      .def(py::pickle([](const analysis::Result& r) { return pickled({r}, ""); },
                      [](const py::tuple& state) { return unpickled(state).all.at(0); }));
  py::class_<Results>(module, "Results",
                      "The results of one analysis: a mapping from names to Result, in order.")
      .def("__len__", [](const Results& r) { return r.all.size(); })
      .def(
          "__contains__",
          [](const Results& r, const std::string& name) {
            return analysis::seek_result(r.all, name) != nullptr;
          },
          py::arg("name"))
      .def(
          "__getitem__",
          [](const Results& r, const std::string& name) {
            const analysis::Result* found = analysis::seek_result(r.all, name);
            if (found == nullptr) throw py::key_error(name);
            return *found;
          },
          py::arg("name"))
      .def(
          "keys",
          [](const Results& r) {
            std::vector<std::string> names;
            for (const analysis::Result& one : r.all) names.push_back(one.name);
            return names;
          },
          "Names of the results, in order.")
      .def(
          "values", [](const Results& r) { return r.all; }, "The results, in order.")
      .def(
          "to_dict", [](const Results& r) { return from_json(analysis::results_json(r.all)); },
          header_text("analysis/observable/results.hpp", "results_json"))
      .def(
          "write",
          [](const Results& r, const std::filesystem::path& path) {
            analysis::write_results(path, r.all, r.provenance_json);
          },
          py::arg("path"), header_text("analysis/observable/results.hpp", "write_results"))
      .def_property_readonly(
          "provenance", [](const Results& r) { return from_json(r.provenance_json); },
          "What produced the results, as a dict.")
      .def(py::pickle([](const Results& r) { return pickled(r.all, r.provenance_json); }, &unpickled))
      .def("__str__", [](const Results& r) { return analysis::results_text(r.all); })
      .def("__repr__",
           [](const Results& r) { return fmt::format("<twincell.Results: {} results>", r.all.size()); });
  py::class_<WindowOfRun>(module, "Window", header_text("analysis/runs/windows.hpp", "Window"))
      .def_property_readonly(
          "first_cycle", [](const WindowOfRun& w) { return w.window.first_cycle; }, "Its first cycle.")
      .def_property_readonly(
          "cycles", [](const WindowOfRun& w) { return w.window.cycles; }, "Number of its cycles.")
      .def_property_readonly(
          "gamma", [](const WindowOfRun& w) { return ends_of(w, [](const Drive& d) { return d.gamma(); }); },
          "(at its beginning, at its end) of Gamma with g = 1, or None without a drive.")
      .def_property_readonly(
          "omega", [](const WindowOfRun& w) { return ends_of(w, [](const Drive& d) { return d.omega; }); },
          "(at its beginning, at its end) of omega, 1/t0, or None without a drive.")
      .def_readonly("results", &WindowOfRun::results, "Its results.")
      .def("__repr__", [](const WindowOfRun& w) {
        return fmt::format("<twincell.Window: cycles {} to {}>", w.window.first_cycle,
                           w.window.first_cycle + w.window.cycles - 1);
      });
  const std::string options_text =
      "\nonly: names of results (result_names()), a list or a text with commas; default: all. discard: "
      "cycles that are left out at the beginning. s_b: variance, about_rest or as_printed; neighbours: "
      "cutoff, delaunay or voronoi; cutoff: largest distance of neighbours, sigma; rest_height: height of "
      "the centre of mass of the bed at rest, sigma (docs/observables.md, docs/statistics.md). callback: "
      "called with (done, total).";
  module.def(
      "analyze_windows",
      [](const py::object& trajectory, std::int64_t window_cycles, const py::object& only,
         std::int64_t discard, const std::string& s_b, const std::string& neighbours,
         std::optional<double> rest_height, std::optional<double> cutoff, const py::object& callback) {
        const analysis::AnalysisOptions options = {.discard_cycles = discard,
                                                   .s_b = analysis::s_b_named(s_b),
                                                   .neighbours = analysis::neighbour_rule_named(neighbours),
                                                   .neighbour_cutoff = cutoff,
                                                   .rest_height = rest_height,
                                                   .only = names_of(only)};
        analysis::require_read(options);
        return analyzed_windows(*trajectory_of(trajectory), options, window_cycles, callback);
      },
      py::arg("trajectory"), py::arg("window_cycles"), py::arg("only") = py::list(), py::kw_only(),
      py::arg("discard") = 0, py::arg("s_b") = "variance", py::arg("neighbours") = "cutoff",
      py::arg("rest_height") = py::none(), py::arg("cutoff") = py::none(), py::arg("callback") = py::none(),
      (summary_text("analysis/runs/windows.hpp", "analyze_windows") +
       "\n\ntrajectory: a Trajectory or the name of its file. window_cycles: cycles of a window." +
       options_text)
          .c_str());
  module.def("result_names", &analysis::result_names, header_text(kHeader, "result_names"));
  module.def(
      "analyze",
      [](const py::object& trajectory, const py::object& only, std::int64_t discard, std::int64_t cycles,
         const std::vector<std::int64_t>& tracers, const std::optional<std::array<double, 2>>& tracer_band,
         const std::string& s_b, const std::string& neighbours, double cell_radius, double field_cell,
         std::optional<double> rest_height, std::optional<double> cutoff, const py::object& box, bool unwrap,
         const py::object& callback) {
        std::vector<std::shared_ptr<Trajectory>> trajectories;
        if (py::isinstance<py::array>(trajectory))
          trajectories.push_back(trajectory_of_points(trajectory, box, unwrap));
        else if (!box.is_none())
          throw ConfigError({.file = {}, .key = "box"},
                            "is that of an array of points; a trajectory has its own.");
        else if (py::isinstance<py::list>(trajectory) || py::isinstance<py::tuple>(trajectory))
          for (const py::handle one : trajectory) trajectories.push_back(trajectory_of(one));
        else
          trajectories.push_back(trajectory_of(trajectory));
        const analysis::AnalysisOptions options = {.discard_cycles = discard,
                                                   .cycles = cycles,
                                                   .tracers = tracers,
                                                   .tracer_band = tracer_band,
                                                   .s_b = analysis::s_b_named(s_b),
                                                   .neighbours = analysis::neighbour_rule_named(neighbours),
                                                   .neighbour_cutoff = cutoff,
                                                   .cell_radius = cell_radius,
                                                   .field_cell = field_cell,
                                                   .rest_height = rest_height,
                                                   .only = names_of(only)};
        analysis::require_read(options);
        return analyzed(trajectories, options, callback);
      },
      py::arg("trajectory"), py::arg("only") = py::list(), py::kw_only(), py::arg("discard") = 0,
      py::arg("cycles") = 0, py::arg("tracers") = std::vector<std::int64_t>{},
      py::arg("tracer_band") = py::none(), py::arg("s_b") = "variance", py::arg("neighbours") = "cutoff",
      py::arg("cell_radius") = analysis::AnalysisOptions{}.cell_radius,
      py::arg("field_cell") = analysis::AnalysisOptions{}.field_cell, py::arg("rest_height") = py::none(),
      py::arg("cutoff") = py::none(), py::arg("box") = py::none(), py::arg("unwrap") = true,
      py::arg("callback") = py::none(),
      (summary_text(kHeader, "analyze") +
       "\n\ntrajectory: a Trajectory or the name of its file; a list of them, which are pooled; or an array "
       "of points, (frames, beads, 2) as (x, z), (frames, beads, 3) as (x, y, z), or one frame of it, of "
       "which every frame counts as a cycle. box: of such an array, a Box or the lengths of a periodic box; "
       "None: open. unwrap: positions of such an array along a period are unwrapped, as by "
       "Trajectory.from_arrays; False: they are kept." +
       options_text +
       "\ncycles: number of cycles to use; 0: all. tracers: slots of the tracers; tracer_band: (low, high), "
       "heights of the beads that serve as tracers, sigma. field_cell: edge of the cells of fields, sigma. "
       "cell_radius: of Voronoi cells, sigma.")
          .c_str());
}

}  // namespace twincell::python
