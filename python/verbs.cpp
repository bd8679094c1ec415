// fit and sweep in Python.

#include <fmt/format.h>

#include "calibration/fit/table_fit.hpp"
#include "core/error.hpp"
#include "python/module.hpp"
#include "sweep/collect.hpp"
#include "sweep/farm.hpp"
#include "sweep/plan.hpp"
#include "sweep/point_warnings.hpp"

namespace twincell::python {

Table table_of(const py::object& said) {
  if (!py::hasattr(said, "keys")) return read_table(said.cast<std::filesystem::path>());
  Table table;
  table.file = "table";
  for (const py::handle name : said.attr("keys")()) {
    const auto column = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(
        said.attr("__getitem__")(name));
    table.names.push_back(py::str(name).cast<std::string>());
    if (!column) {  // text, which may stand beside the numbers
      const py::object words = said.attr("__getitem__")(name);
      const std::size_t rows = py::len(words);
      table.columns.emplace_back(rows, std::nan(""));
      std::string first;
      long row = 0;
      for (const py::handle word : py::iter(words)) {
        ++row;
        if (PyFloat_Check(word.ptr()) || PyLong_Check(word.ptr())) continue;
        first = py::str(word).cast<std::string>();
        break;
      }
      table.texts[table.names.size() - 1] = {.line = row, .word = first};
      continue;
    }
    table.columns.emplace_back(column.data(), column.data() + column.size());
    if (py::array::ensure(said.attr("__getitem__")(name)).dtype().kind() == 'b') {
      const std::size_t c = table.names.size() - 1;
      table.texts[c] = {.line = 1,
                        .word = table.columns[c].empty() || table.columns[c][0] == 0 ? "False" : "True"};
      table.marks.insert(c);
    }
    if (column.ndim() != 1 || table.columns.back().size() != table.n_rows())
      throw InputError({.file = table.file, .key = table.names.back()},
                       fmt::format("has {} values; the first column has {}.", column.size(), table.n_rows()));
  }
  if (table.n_rows() == 0) throw InputError({.file = table.file, .key = {}}, "has no rows.");
  return table;
}

namespace {

/// Forwards the progress of a sweep as numbers of points.
class ProgressWatch : public sweep::Watch {
 public:
  explicit ProgressWatch(Progress& progress) : progress_(progress) {}
  void look(const sweep::Counts& counts, double) override {
    progress_.update(static_cast<std::int64_t>(counts.done), static_cast<std::int64_t>(counts.most));
  }

 private:
  Progress& progress_;
};

std::string swept(const std::filesystem::path& plan_file, const std::optional<std::filesystem::path>& folder,
                  std::optional<std::uint64_t> seed, bool keep_trajectories, int threads,
                  const py::object& callback) {
  const int n_threads = threads_of(threads);
  std::vector<std::string> warnings;
  std::string collected = unlocked(callback, [&](Progress& progress) {
    sweep::Plan plan = sweep::read_plan(plan_file);
    warnings = plan.doubts;
    if (seed) plan.seed = *seed;
    const sweep::Store store(folder ? *folder : std::filesystem::path(plan_file).replace_extension(".sweep"));
    sweep::Schedule schedule(plan, store);
    sweep::require_memory_together(schedule, n_threads, "threads");
    ProgressWatch watch(progress);
    sweep::run_here({&schedule}, store, {n_threads, keep_trajectories}, watch);
    for (const sweep::PointWarning& w : sweep::warnings_of(schedule)) warnings.push_back(w.sentence());
    return sweep::collected_json(schedule);
  });
  for (const std::string& warning : warnings) warn(warning);
  return collected;
}

}  // namespace

void bind_verbs(py::module_& module) {
  module.def(
      "fit",
      [](const py::object& table, const std::string& law, const std::string& x, const std::string& y,
         const std::string& sigma, const std::string& trials,
         const std::optional<std::array<double, 2>>& window) {
        calibration::check_fit(law, window);
        return from_json(calibration::fit_json(
            calibration::fit_table(table_of(table), law, {x, y, sigma, trials}, window)));
      },
      py::arg("table"), py::arg("law"), py::kw_only(), py::arg("x") = "", py::arg("y") = "",
      py::arg("sigma") = "", py::arg("trials") = "", py::arg("window") = py::none(),
      (std::string(header_text("calibration/fit/curve_fit.hpp", "fit_curve")) +
       "\n\ntable: a CSV file, a DataFrame, or a mapping from names to columns. Returns a dict "
       "(docs/fitting.md).")
          .c_str());
  module.def(
      "laws",
      [] {
        py::dict d;
        for (const calibration::Law* law : calibration::laws()) d[py::str(law->name)] = law->formula;
        return d;
      },
      "Names and formulas of the laws of `fit`.");
  module.def(
      "sweep",
      [](const std::filesystem::path& plan, const std::optional<std::filesystem::path>& folder,
         std::optional<std::uint64_t> seed, bool keep_trajectories, int threads, const py::object& callback) {
        return from_json(swept(plan, folder, seed, keep_trajectories, threads, callback));
      },
      py::arg("plan"), py::arg("folder") = py::none(), py::kw_only(), py::arg("seed") = py::none(),
      py::arg("keep_trajectories") = false, py::arg("threads") = 0, py::arg("callback") = py::none(),
      (std::string(
           "Computes the points of a plan, one on each core, stores them in `folder` (default: PLAN.sweep), "
           "and returns the collected results as a dict. Finished points are not repeated, so an interrupted "
           "sweep goes on when it is called again.\n\n") +
       header_text("sweep/collect.hpp", "collected_json"))
          .c_str());
}

}  // namespace twincell::python
