// twincell._core: exceptions and helpers of the Python module; the parts are bound by the other files.

#include "python/module.hpp"

#include <fmt/format.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <new>
#include <thread>

#include "core/atomic_file.hpp"
#include "core/cancellation.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "core/hdf5.hpp"
#include "imaging/stack/opencv_errors.hpp"

namespace twincell::python {

namespace {

/// The exception classes, kept alive by the module.
PyObject *error_class = nullptr, *config_class = nullptr, *input_class = nullptr, *run_class = nullptr,
         *interrupted_class = nullptr;

PyObject* make_class(py::module_& module, const char* name, const char* doc, const py::tuple& bases,
                     ExitCode code) {
  py::dict members;
  members["exit_code"] = static_cast<int>(code);
  PyObject* made =
      PyErr_NewExceptionWithDoc(fmt::format("twincell.{}", name).c_str(), doc, bases.ptr(), members.ptr());
  if (made == nullptr) throw py::error_already_set();
  module.attr(name) = py::reinterpret_borrow<py::object>(made);
  return made;
}

void make_classes(py::module_& module) {
  const auto of = [](PyObject* a, PyObject* b) { return py::make_tuple(py::handle(a), py::handle(b)); };
  error_class =
      make_class(module, "Error", "An error with a sentence for the user; exit_code is that of the program.",
                 py::make_tuple(py::handle(PyExc_Exception)), ExitCode::failed);
  config_class = make_class(module, "ConfigError", header_text("core/error.hpp", "ConfigError"),
                            of(error_class, PyExc_ValueError), ExitCode::usage);
  input_class = make_class(module, "InputError", header_text("core/error.hpp", "InputError"),
                           of(error_class, PyExc_OSError), ExitCode::input);
  run_class = make_class(module, "RunError", header_text("core/error.hpp", "RunError"),
                         of(error_class, PyExc_RuntimeError), ExitCode::failed);
  interrupted_class = make_class(module, "Interrupted", header_text("core/error.hpp", "Interrupted"),
                                 py::make_tuple(py::handle(error_class)), ExitCode::interrupted);
}

PyObject* class_of(ExitCode code) {
  switch (code) {
    case ExitCode::usage:
      return config_class;
    case ExitCode::input:
      return input_class;
    case ExitCode::interrupted:
    case ExitCode::terminated:
      return interrupted_class;
    default:
      return run_class;
  }
}

/// A sentence with the options of the program, "--phase-lock", as the arguments of Python, "phase_lock".
std::string with_python_names(const std::string& sentence) {
  const auto in_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  };
  std::string said;
  for (std::size_t i = 0; i < sentence.size(); ++i) {
    const bool begins = sentence.compare(i, 2, "--") == 0 && (i == 0 || !in_word(sentence[i - 1])) &&
                        i + 2 < sentence.size() &&
                        std::islower(static_cast<unsigned char>(sentence[i + 2])) != 0;
    if (!begins) {
      said += sentence[i];
      continue;
    }
    for (i += 2; i < sentence.size() && in_word(sentence[i]); ++i)
      said += sentence[i] == '-' ? '_' : sentence[i];
    --i;
  }
  return said;
}

void translate(std::exception_ptr thrown) {
  if (!thrown) return;
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& e) {
    PyErr_SetString(class_of(e.exit_code()), with_python_names(in_final_names(e.what())).c_str());
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const py::error_already_set&) {
    throw;
  } catch (const std::exception& e) {
    const auto fault = imaging::opencv_error(e);
    if (!fault) throw;
    if (fault->out_of_memory)
      PyErr_NoMemory();
    else
      PyErr_SetString(run_class, ("the image processing failed: " + fault->what).c_str());
  }
}

}  // namespace

void warn(const std::string& sentence) {
  if (PyErr_WarnEx(PyExc_UserWarning, with_python_names(sentence).c_str(), 2) != 0)
    throw py::error_already_set();
}

namespace {

/// The handler of Python, which the watch replaces.
struct sigaction python_handler {};

extern "C" void on_interrupt(int signal) {
  request_cancellation(signal);
  python_handler.sa_handler(signal);
}

bool is_main_thread() {
  return ::syscall(SYS_gettid) == ::getpid();
}

}  // namespace

InterruptWatch::InterruptWatch() {
  struct sigaction now {};
  if (!is_main_thread() || ::sigaction(SIGINT, nullptr, &now) != 0) return;
  // A handler of the user's need not raise; it is asked at the next progress report.
  const py::module_ signals = py::module_::import("signal");
  if (!signals.attr("getsignal")(SIGINT).is(signals.attr("default_int_handler"))) return;
  const bool callable =
      (now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler != SIG_DFL && now.sa_handler != SIG_IGN;
  if (!callable || now.sa_handler == &on_interrupt) return;  // an outer call watches
  python_handler = now;
  struct sigaction ours = now;
  ours.sa_handler = &on_interrupt;
  installed_ = ::sigaction(SIGINT, &ours, nullptr) == 0;
}

InterruptWatch::~InterruptWatch() {
  if (!installed_) return;
  struct sigaction now {};
  // A handler that a callback has set stays.
  if (::sigaction(SIGINT, nullptr, &now) == 0 && now.sa_handler == &on_interrupt)
    ::sigaction(SIGINT, &python_handler, nullptr);
  withdraw_cancellation();
}

void PythonProgress::update(std::int64_t done, std::int64_t total) {
  constexpr std::chrono::milliseconds kPause{100};
  // A callback is called at the beginning and at the end in any case.
  const bool must = (!called_ || (total > 0 && done >= total)) && !callback_.is_none();
  if (const auto now = Clock::now(); now - last_ < kPause && !must) return;
  last_ = Clock::now();
  called_ = called_ || total > 0;
  const py::gil_scoped_acquire lock;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!callback_.is_none() && total > 0) callback_(done, total);  // total 0: only a look for signals
  } catch (py::error_already_set&) {
    raised_ = std::current_exception();
    throw Interrupted(ExitCode::interrupted);
  }
}

py::object from_json(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

Provenance provenance_of(const std::string& call, int threads) {
  Provenance p;
  p.command_line = call;
  p.threads = threads;
  return p;
}

int threads_of(int threads) {
  require_range({.file = {}, .key = "threads"}, threads, 0, 4096);
  return threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

Box box_of(const py::object& said) {
  if (py::isinstance<Box>(said)) return said.cast<Box>();
  Box box;
  box.boundary = {Boundary::open, Boundary::open, Boundary::open};
  if (said.is_none()) return box;
  std::vector<double> lengths;
  try {
    lengths = said.cast<std::vector<double>>();
  } catch (const py::cast_error&) {
    throw ConfigError({.file = {}, .key = "box"},
                      "must be a Box, None, or the lengths of a periodic box, 2 (x, z) or 3 (x, y, z).");
  }
  if (lengths.size() != 2 && lengths.size() != 3)
    throw ConfigError(
        {.file = {}, .key = "box"},
        fmt::format("has {} lengths; a periodic box has 2 (x, z) or 3 (x, y, z).", lengths.size()));
  box.dimension = lengths.size() == 2 ? 2 : 3;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    require_range({.file = {}, .key = "box"}, lengths[k], 0, std::nullopt, true);
    const std::size_t axis = lengths.size() == 2 ? 2 * k : k;
    box.boundary[axis] = Boundary::periodic;
    box.upper[static_cast<Eigen::Index>(axis)] = lengths[k];
  }
  return box;
}

py::object without_mask(const py::handle& said) {
  return py::hasattr(said, "filled") ? said.attr("astype")("float64").attr("filled")(kNaN)
                                     : py::reinterpret_borrow<py::object>(said);
}

bool is_missing(const Vec3& position, bool planar, const std::string& name, std::size_t bead,
                std::optional<std::size_t> frame) {
  int components = 0, absent = 0;
  bool infinite = false;
  for (int k = 0; k < 3; ++k) {
    if (planar && k == 1) continue;
    ++components;
    absent += std::isnan(position[k]) ? 1 : 0;
    infinite = infinite || std::isinf(position[k]);
  }
  if (!infinite && (absent == 0 || absent == components)) return absent > 0;
  const std::string where = frame ? fmt::format(" of frame {}", *frame) : "";
  throw ConfigError({.file = {}, .key = name},
                    fmt::format("bead {}{} is {}; a position is finite, or NaN in all components if the bead "
                                "is missing.",
                                bead, where, infinite ? "at infinity" : "NaN in some components only"));
}

std::optional<double> common_height(const std::vector<Vec3>& points) {
  constexpr std::size_t kMinBeads = 3;
  const Vec3* first = nullptr;
  std::size_t n = 0;
  bool in_row = true;
  for (const Vec3& p : points) {
    if (!p.allFinite()) continue;
    if (first == nullptr) first = &p;
    if (p.z() != first->z()) return {};
    in_row = in_row && p.y() == first->y();
    ++n;
  }
  return n >= kMinBeads && !in_row ? std::optional(first->z()) : std::nullopt;
}

namespace {

/// The columns of a DataFrame in the order of coordinates, if they have their names; anything else as it is.
py::object with_ordered_columns(const py::handle& said) {
  const auto same = py::reinterpret_borrow<py::object>(said);
  if (!py::hasattr(said, "columns") || !py::hasattr(said, "loc")) return same;
  std::vector<std::string> names;
  for (const py::handle column : said.attr("columns")) names.push_back(py::str(column).cast<std::string>());
  std::sort(names.begin(), names.end());
  using Names = std::vector<std::string>;
  if (names != Names{"x", "y"} && names != Names{"x", "z"} && names != Names{"x", "y", "z"}) return same;
  return said[py::cast(names)];
}

}  // namespace

std::vector<Vec3> points_of(const py::handle& said, const std::string& name) {
  const py::object points = without_mask(with_ordered_columns(said));
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(points);
  if (!array) throw ConfigError({.file = {}, .key = name}, "is no array of numbers.");
  if (array.ndim() != 2 || (array.shape(1) != 2 && array.shape(1) != 3)) {
    std::string shape;
    for (py::ssize_t k = 0; k < array.ndim(); ++k)
      shape += fmt::format("{}{}", k > 0 ? ", " : "", array.shape(k));
    throw ConfigError(
        {.file = {}, .key = name},
        fmt::format("has the shape ({}); points are (N, 2) as (x, z) or (N, 3) as (x, y, z).", shape));
  }
  const auto p = array.unchecked<2>();
  const bool planar = p.shape(1) == 2;
  std::vector<Vec3> out;
  out.reserve(static_cast<std::size_t>(p.shape(0)));
  for (py::ssize_t i = 0; i < p.shape(0); ++i) {
    out.push_back(planar ? Vec3(p(i, 0), 0, p(i, 1)) : Vec3(p(i, 0), p(i, 1), p(i, 2)));
    (void)is_missing(out.back(), planar, name, static_cast<std::size_t>(i));
  }
  return out;
}

}  // namespace twincell::python

PYBIND11_MODULE(_core, module) {
  using namespace twincell;
  using namespace twincell::python;
  h5::quiet();
  imaging::quiet_opencv();
  module.doc() = "The C++ side of twincell.";
  make_classes(module);
  py::register_exception_translator(&translate);
  module.def("_with_python_names", &with_python_names);
  module.attr("__version__") = from_json(version_json())["version"];
  module.def(
      "version", [] { return from_json(version_json()); },
      header_text("core/provenance.hpp", "version_json"));
  bind_trajectory(module);
  bind_trajectory_from_arrays(module);
  bind_frames(module);
  bind_locating(module);
  bind_analysis(module);
  bind_observables(module);
  bind_simulation(module);
  bind_verbs(module);
}
