#pragma once
/// \file
/// What the parts of the Python module share: exceptions, progress with Ctrl-C, arrays without a copy,
/// docstrings.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/progress.hpp"
#include "core/provenance.hpp"
#include "core/table.hpp"
#include "trajectory/box.hpp"

namespace twincell::python {

namespace py = pybind11;

/// The comment of a symbol in a header of the source tree, which header_docs.py collects at build time.
const char* header_text(std::string_view header, std::string_view symbol);
/// The same without the parameters, for a function whose parameters are others in Python.
std::string summary_text(std::string_view header, std::string_view symbol);

/// Forwards the progress of work that runs without the interpreter's lock: at most ten times a second it
/// takes the lock, lets Python handle signals, and calls `callback(done, total)` if there is one. If either
/// raises, the work is interrupted; `rethrow` then raises the same exception in the caller.
class PythonProgress : public Progress {
 public:
  explicit PythonProgress(py::object callback) : callback_(std::move(callback)) {}
  void update(std::int64_t done, std::int64_t total) override;
  /// Whether Python raised an exception.
  [[nodiscard]] bool raised() const { return raised_ != nullptr; }
  [[noreturn]] void rethrow() const { std::rethrow_exception(raised_); }

 private:
  using Clock = std::chrono::steady_clock;
  py::object callback_;
  std::exception_ptr raised_;
  Clock::time_point last_ = Clock::now();
  bool called_ = false;
};

/// During its lifetime in the main thread, Ctrl-C also requests cancellation (core/cancellation.hpp), so that
/// work between two progress reports stops. Python's own handler is called too.
class InterruptWatch {
 public:
  InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;
  ~InterruptWatch();

 private:
  bool installed_ = false;
};

/// Calls work(progress) without the interpreter's lock.
/// \param callback None, or a function of (done, total)
template <class Work>
auto unlocked(const py::object& callback, const Work& work) {
  PythonProgress progress(callback);
  const InterruptWatch watch;
  try {
    const py::gil_scoped_release release;
    return work(static_cast<Progress&>(progress));
  } catch (...) {
    if (progress.raised()) progress.rethrow();
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // KeyboardInterrupt
    throw;
  }
}

/// The table of an argument: a file, or a mapping from names to columns, such as a DataFrame.
Table table_of(const py::object& said);

/// An array of a type over memory that `owner` keeps alive; read-only unless `writable`.
template <class Owner>
py::array view(const void* data, const py::dtype& type, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides, std::shared_ptr<Owner> owner, bool writable = false) {
  const py::capsule base(new std::shared_ptr<const void>(std::move(owner)),
                         [](void* p) { delete static_cast<std::shared_ptr<const void>*>(p); });
  py::array array(type, std::move(shape), std::move(strides), data, base);
  if (!writable) array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// The same for numbers, and structures that NumPy knows.
template <class T, class Owner>
py::array view(const T* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               std::shared_ptr<Owner> owner, bool writable = false) {
  return view(data, py::dtype::of<T>(), std::move(shape), std::move(strides), std::move(owner), writable);
}

/// An array that takes over the numbers of a vector.
template <class T>
py::array array_of(std::vector<T> values, std::vector<py::ssize_t> shape = {}) {
  auto owner = std::make_shared<std::vector<T>>(std::move(values));
  if (shape.empty()) shape = {static_cast<py::ssize_t>(owner->size())};
  std::vector<py::ssize_t> strides(shape.size());
  py::ssize_t step = sizeof(T);
  for (std::size_t k = shape.size(); k-- > 0; step *= shape[k]) strides[k] = step;
  const T* data = owner->data();
  return view(data, std::move(shape), std::move(strides), std::move(owner), true);
}

/// JSON text as Python values.
py::object from_json(const std::string& text);

/// Provenance of what Python computes.
/// \param call for example "twincell.simulate (Python)"
Provenance provenance_of(const std::string& call, int threads = 1);

/// Number of threads: `threads`, or the number of cores if it is 0.
/// \throws ConfigError below 0, above 4096
int threads_of(int threads);

/// Numbers without a mask: those that a NumPy mask hides are NaN. Anything else as it is.
py::object without_mask(const py::handle& said);

/// Points (N, 2) as (x, z), or (N, 3) as (x, y, z). The columns of a DataFrame are taken by name if these are
/// x and y, x and z, or x, y and z.
/// \throws ConfigError for another shape, and as is_missing
/// \param name of the argument, for the message
std::vector<Vec3> points_of(const py::handle& points, const std::string& name);

/// Whether a bead is missing: all components of its position are NaN.
/// \param planar y is not one of them
/// \throws ConfigError if one is infinite, or only some are NaN
/// \param name of the argument, for the message
bool is_missing(const Vec3& position, bool planar, const std::string& name, std::size_t bead,
                std::optional<std::size_t> frame = {});

/// The z that three points or more have in common while their y differs, as in the convention (x, y, 0) for a
/// plane; nothing for others. Missing points do not count.
std::optional<double> common_height(const std::vector<Vec3>& points);

/// The box of an argument: a Box; None (open); or the two or three lengths of a periodic box of that
/// dimension.
/// \throws ConfigError for anything else
Box box_of(const py::object& said);

void bind_trajectory(py::module_& module);
void bind_trajectory_from_arrays(py::module_& module);  ///< after bind_trajectory
void bind_frames(py::module_& module);
void bind_locating(py::module_& module);
void bind_analysis(py::module_& module);
void bind_observables(py::module_& module);
void bind_simulation(py::module_& module);
void bind_verbs(py::module_& module);

/// Issues a UserWarning.
/// \throws py::error_already_set if warnings are errors
void warn(const std::string& sentence);

}  // namespace twincell::python
