// Trajectories in Python: columns as NumPy arrays without a copy, made from arrays, opened and written.

#include "python/trajectory.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/box.hpp"
#include "trajectory/ranges.hpp"
#include "trajectory/wrapped_positions.hpp"

namespace twincell::python {

namespace {

/// Device, inode, size and time of change of a file; nothing if it cannot be read.
std::optional<FileIdentity> identity(const std::filesystem::path& path) {
  struct ::stat s {};
  if (::stat(path.c_str(), &s) != 0) return {};
  return FileIdentity{path, s.st_dev, s.st_ino, static_cast<std::uintmax_t>(s.st_size),
                      static_cast<std::int64_t>(s.st_mtim.tv_sec) * 1'000'000'000 + s.st_mtim.tv_nsec};
}

}  // namespace

FileIdentity FileIdentity::of(const std::filesystem::path& file) {
  const auto found = identity(std::filesystem::absolute(file));
  if (!found) throw InputError({.file = file.string(), .key = {}}, "the file cannot be read.");
  return *found;
}

bool FileIdentity::holds() const {
  const auto now = identity(path);
  return now && now->device == device && now->inode == inode && now->bytes == bytes &&
         now->changed_ns == changed_ns;
}

std::optional<FileIdentity> Trajectory::file() const {
  return file_ && file_->holds() ? file_ : std::nullopt;
}

std::shared_ptr<const Frame> Trajectory::frame(std::size_t index) {
  if (memory_ != nullptr) return memory_->frames()[index];
  if (last_ == nullptr || last_index_ != index) {
    auto read = std::make_shared<Frame>();
    source_->read(index, *read);
    last_ = std::move(read);
    last_index_ = index;
  }
  return last_;
}

void require_no_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code none;  // a file that is not there is no input
    if (std::filesystem::equivalent(output, input, none))
      throw ConfigError({.file = output.string(), .key = {}}, "the output is an input of the same call.");
  }
}

std::shared_ptr<Trajectory> trajectory_of(const py::handle& said) {
  if (py::isinstance<Trajectory>(said)) return said.cast<std::shared_ptr<Trajectory>>();
  if (!py::isinstance<py::str>(said) && !py::hasattr(said, "__fspath__"))
    throw py::type_error(fmt::format("a Trajectory or the name of its file is needed, not {}",
                                     py::str(py::type::of(said).attr("__name__")).cast<std::string>()));
  return std::make_shared<Trajectory>(said.cast<std::filesystem::path>());
}

namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

constexpr const char* kHeader = "trajectory/trajectory.hpp";

std::size_t index_of(py::ssize_t i, std::size_t n) {
  const auto length = static_cast<py::ssize_t>(n);
  if (i < -length || i >= length)
    throw py::index_error(fmt::format("frame {} does not exist; the trajectory has {} frames.", i, n));
  return static_cast<std::size_t>(i < 0 ? i + length : i);
}

/// A per-bead vector of every frame: column[t] is an array (n_beads, 3) without a copy.
struct Column {
  std::shared_ptr<Trajectory> trajectory;
  std::vector<Vec3> Frame::*member;

  [[nodiscard]] py::array at(std::size_t t) const {
    const auto frame = trajectory->frame(t);
    const std::vector<Vec3>& values = (*frame).*member;
    return view(reinterpret_cast<const double*>(values.data()), {static_cast<py::ssize_t>(values.size()), 3},
                {sizeof(Vec3), sizeof(double)}, frame);
  }
  [[nodiscard]] py::array stack(std::size_t start, py::ssize_t step, std::size_t length) const {
    const std::size_t n = trajectory->info().n_beads;
    std::vector<double> all;
    all.reserve(length * n * 3);
    for (std::size_t k = 0; k < length; ++k) {
      const auto frame = trajectory->frame(
          static_cast<std::size_t>(static_cast<py::ssize_t>(start) + static_cast<py::ssize_t>(k) * step));
      for (const Vec3& v : (*frame).*member) all.insert(all.end(), v.data(), v.data() + 3);
    }
    return array_of(std::move(all), {static_cast<py::ssize_t>(length), static_cast<py::ssize_t>(n), 3});
  }
};

/// The type of an array over contacts; its fields are the members of ContactForce.
py::dtype contact_dtype() {
  const ContactForce c;
  py::list names, formats, offsets;
  const auto field = [&](const char* name, const char* format, const auto& member) {
    names.append(name);
    formats.append(format);
    offsets.append(reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&c));
  };
  field("i", "i4", c.i);
  field("j", "i4", c.j);
  field("overlap", "f8", c.overlap);
  field("normal", "(3,)f8", c.normal);
  field("normal_force", "f8", c.normal_force);
  field("tangential_force", "(3,)f8", c.tangential_force);
  return {names, formats, offsets, sizeof(ContactForce)};
}

/// The contacts of every frame: contacts[t] is a structured array without a copy.
struct Contacts {
  std::shared_ptr<Trajectory> trajectory;

  [[nodiscard]] py::array at(std::size_t t) const {
    const auto frame = trajectory->frame(t);
    const std::vector<ContactForce>& values = frame->contact_forces;
    return view(values.data(), contact_dtype(), {static_cast<py::ssize_t>(values.size())},
                {sizeof(ContactForce)}, frame);
  }
};

/// Number of every frame, from a pass over the file.
template <class Value>
py::array of_frames(Trajectory& trajectory, Value value) {
  std::vector<decltype(value(Frame{}))> values;
  values.reserve(trajectory.n_frames());
  for (std::size_t t = 0; t < trajectory.n_frames(); ++t) values.push_back(value(*trajectory.frame(t)));
  py::array array = array_of(std::move(values));
  array.attr("setflags")(py::arg("write") = false);  // it is a copy, in which a change would be lost
  return array;
}

template <class T>
py::object of_slots(const std::shared_ptr<Trajectory>& trajectory, const std::vector<T>& values) {
  if (values.empty()) return py::none();
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, {sizeof(T)}, trajectory);
}

Boundary boundary_named(const std::string& word) {
  for (const BoundaryWords& row : kBoundaries)
    if (word == row.word) return row.value;
  throw ConfigError({.file = {}, .key = "boundary"},
                    fmt::format("is '{}'; it must be open, wall or periodic.", word));
}

std::array<std::string, 3> boundary_words(const Box& box) {
  return {boundary_word(box.boundary[0]), boundary_word(box.boundary[1]), boundary_word(box.boundary[2])};
}

Box make_box(const std::array<double, 3>& lower, const std::array<double, 3>& upper,
             const std::array<std::string, 3>& boundary, int dimension) {
  Box box;
  if (dimension != 2 && dimension != 3)
    throw ConfigError({.file = {}, .key = "dimension"}, fmt::format("is {}; it must be 2 or 3.", dimension));
  box.dimension = dimension;
  for (int a = 0; a < 3; ++a) {
    const auto k = static_cast<std::size_t>(a);
    if (!(lower[k] < upper[k]))
      throw ConfigError(
          {.file = {}, .key = "upper"},
          fmt::format("is {:g} along {}; it must be above lower, {:g}.", upper[k], "xyz"[a], lower[k]));
    box.lower[a] = lower[k];
    box.upper[a] = upper[k];
    box.boundary[k] = boundary_named(boundary[k]);
  }
  return box;
}

py::tuple pickled_box(const Box& b) {
  return py::make_tuple(std::array{b.lower.x(), b.lower.y(), b.lower.z()},
                        std::array{b.upper.x(), b.upper.y(), b.upper.z()}, boundary_words(b), b.dimension,
                        b.side_tilt);
}

Box unpickled_box(const py::tuple& state) {
  Box b;
  const auto lower = state[0].cast<std::array<double, 3>>(), upper = state[1].cast<std::array<double, 3>>();
  const auto words = state[2].cast<std::array<std::string, 3>>();
  for (std::size_t k = 0; k < 3; ++k) {
    b.lower[static_cast<Eigen::Index>(k)] = lower[k];
    b.upper[static_cast<Eigen::Index>(k)] = upper[k];
    b.boundary[k] = boundary_named(words[k]);
  }
  b.dimension = state[3].cast<int>();
  b.side_tilt = state[4].cast<decltype(b.side_tilt)>();
  return b;
}

void bind_box(py::module_& module) {
  py::class_<Box>(module, "Box", header_text("trajectory/box.hpp", "Box"))
      .def(py::init(&make_box), py::arg("lower"), py::arg("upper"),
           py::arg("boundary") = std::array<std::string, 3>{"wall", "open", "wall"}, py::arg("dimension") = 2,
           "Corners (x, y, z) in sigma, and the boundary along each axis: open, wall or periodic.")
      .def_property_readonly(
          "lower",
          [](const Box& b) {
            return std::array{b.lower.x(), b.lower.y(), b.lower.z()};
          },
          header_text("trajectory/box.hpp", "Box::lower"))
      .def_property_readonly(
          "upper",
          [](const Box& b) {
            return std::array{b.upper.x(), b.upper.y(), b.upper.z()};
          },
          header_text("trajectory/box.hpp", "Box::upper"))
      .def_readonly("dimension", &Box::dimension, header_text("trajectory/box.hpp", "Box::dimension"))
      .def_readonly("side_tilt", &Box::side_tilt, header_text("trajectory/box.hpp", "Box::side_tilt"))
      .def_property_readonly(
          "boundary", [](const Box& b) { return boundary_words(b); },
          header_text("trajectory/box.hpp", "Boundary"))
      .def(py::pickle(&pickled_box, &unpickled_box))
      .def("__repr__", [](const Box& b) {
        return fmt::format("Box(({:g}, {:g}, {:g}), ({:g}, {:g}, {:g}), ({}, {}, {}), dimension={})",
                           b.lower.x(), b.lower.y(), b.lower.z(), b.upper.x(), b.upper.y(), b.upper.z(),
                           boundary_word(b.boundary[0]), boundary_word(b.boundary[1]),
                           boundary_word(b.boundary[2]), b.dimension);
      });
}

void bind_drive(py::module_& module) {
  py::class_<Drive>(module, "Drive", header_text("trajectory/drive.hpp", "Drive"))
      .def(py::init(
               [](double amplitude, double omega) { return Drive{.amplitude = amplitude, .omega = omega}; }),
           py::arg("amplitude"), py::arg("omega"),
           "Vertical drive A sin(omega t): A in sigma, omega in 1/t0.")
      .def_readonly("amplitude", &Drive::amplitude, header_text("trajectory/drive.hpp", "Drive::amplitude"))
      .def_readonly("omega", &Drive::omega, header_text("trajectory/drive.hpp", "Drive::omega"))
      .def_property_readonly(
          "gamma", [](const Drive& d) { return d.gamma(); },
          header_text("trajectory/drive.hpp", "Drive::gamma"))
      .def_property_readonly(
          "k_m", [](const Drive& d) { return d.k_m(); }, header_text("trajectory/drive.hpp", "Drive::k_m"))
      .def_property_readonly("period", &Drive::period, header_text("trajectory/drive.hpp", "Drive::period"))
      .def_property_readonly("formula", &Drive::formula,
                             header_text("trajectory/drive.hpp", "Drive::formula"))
      .def("displacement", &Drive::displacement, py::arg("fraction"), py::arg("cycle") = 0,
           header_text("trajectory/drive.hpp", "Drive::displacement"))
      .def("velocity", &Drive::velocity, py::arg("fraction"), py::arg("cycle") = 0,
           header_text("trajectory/drive.hpp", "Drive::velocity"))
      .def("acceleration", &Drive::acceleration, py::arg("fraction"), py::arg("cycle") = 0,
           header_text("trajectory/drive.hpp", "Drive::acceleration"))
      .def("at", &Drive::at, py::arg("cycles"), header_text("trajectory/drive.hpp", "Drive::at"))
      .def("__repr__", [](const Drive& d) {
        const bool sine = d.harmonics.empty() && !d.recorded && !d.ramp && !d.horizontal;
        return fmt::format("Drive(amplitude={:g}, omega={:g}{})", d.amplitude, d.omega,
                           sine ? "" : ", displacement=" + d.formula());
      });
}

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An array (T, N, 2 or 3) as vectors, one call per frame.
class VectorArray {
 public:
  VectorArray(const py::object& said, const char* name, py::ssize_t frames, py::ssize_t beads) {
    if (said.is_none()) return;
    values_ = Numbers::ensure(without_mask(said));
    if (!values_) throw ConfigError({.file = {}, .key = name}, "is no array of numbers.");
    const bool fits = values_.ndim() == 3 && (values_.shape(2) == 2 || values_.shape(2) == 3) &&
                      (frames < 0 || (values_.shape(0) == frames && values_.shape(1) == beads));
    if (fits) return;
    std::string shape;
    for (py::ssize_t k = 0; k < values_.ndim(); ++k)
      shape += fmt::format("{}{}", k > 0 ? ", " : "", values_.shape(k));
    throw ConfigError(
        {.file = {}, .key = name},
        frames < 0
            ? fmt::format("has the shape ({}); it must be (frames, beads, 2) as (x, z) or "
                          "(frames, beads, 3) as (x, y, z).",
                          shape)
            : fmt::format("has the shape ({}); positions have {} frames of {} beads.", shape, frames, beads));
  }
  [[nodiscard]] bool given() const { return static_cast<bool>(values_) && values_.ndim() == 3; }
  [[nodiscard]] py::ssize_t extent(int axis) const { return values_.shape(axis); }
  [[nodiscard]] std::vector<Vec3> of(py::ssize_t t, double missing_y) const {
    const auto v = values_.unchecked<3>();
    std::vector<Vec3> out(static_cast<std::size_t>(v.shape(1)));
    for (py::ssize_t i = 0; i < v.shape(1); ++i) {
      const bool planar = v.shape(2) == 2;
      out[static_cast<std::size_t>(i)] =
          Vec3(v(t, i, 0), planar ? missing_y : v(t, i, 1), v(t, i, planar ? 1 : 2));
    }
    return out;
  }

 private:
  Numbers values_;
};

/// One number per frame or per bead.
template <class T>
std::vector<T> numbers_of(const py::object& said, const char* name, py::ssize_t length, const char* of,
                          double least = 0, double most = HUGE_VAL) {
  if (said.is_none()) return {};
  const auto values = Numbers::ensure(without_mask(said));
  if (!values) throw ConfigError({.file = {}, .key = name}, "is no list of numbers.");
  if (values.ndim() != 1 || values.shape(0) != length)
    throw ConfigError({.file = {}, .key = name},
                      fmt::format("has {} values; there are {} {}.", values.size(), length, of));
  if constexpr (std::is_integral_v<T>)
    for (py::ssize_t k = 0; k < length; ++k)
      if (const double v = values.data()[k];
          !(v == std::floor(v) && v >= least && v <= std::min<double>(most, std::numeric_limits<T>::max())))
        throw ConfigError(
            {.file = {}, .key = name},
            fmt::format("value {} is {:g}; whole numbers from {:g} on are needed.", k, v, least));
  std::vector<T> all;
  for (py::ssize_t k = 0; k < length; ++k) all.push_back(static_cast<T>(values.data()[k]));
  return all;
}

/// \throws ConfigError for times that do not increase
void require_increasing(const std::vector<double>& times) {
  for (std::size_t t = 0; t < times.size(); ++t)
    if (!std::isfinite(times[t]) || (t > 0 && times[t] <= times[t - 1]))
      throw ConfigError({.file = {}, .key = "time"},
                        fmt::format("is {:g} in frame {}; times must be finite and increase.", times[t], t));
}

/// Unwraps positions along the periodic axes of a box by the rule of wrapped_positions.hpp.
void unwrap(std::vector<Frame>& frames, const Box& box) {
  if (frames.empty()) return;
  PositionExtent extent;
  for (const Frame& frame : frames)
    for (const Vec3& r : frame.position) extent.add(r);
  Vec3 period = Vec3::Zero();
  for (const int axis : {0, 1, 2})
    if (const double length = box.size()[axis];
        box.periodic(static_cast<Axis>(axis)) && extent.is_wrapped(axis, length))
      period[axis] = length;
  PeriodCounter periods(period, frames.front().position.size());
  for (Frame& frame : frames)
    for (std::size_t i = 0; i < frame.position.size(); ++i)
      frame.position[i] = periods.unwrapped(i, frame.position[i]);
}

/// The numbers of every frame; empty where they are not given.
struct FrameNumbers {
  std::vector<std::int32_t> phases;
  std::vector<std::int64_t> cycles;
  std::vector<double> times;
  std::vector<std::int64_t> steps;
  std::vector<double> heights;
};

FrameNumbers frame_numbers(const py::object& phase, const py::object& cycle, const py::object& time,
                           const py::object& step, const py::object& plate_height, py::ssize_t frames) {
  FrameNumbers n{.phases = numbers_of<std::int32_t>(phase, "phase", frames, "frames", -1),
                 .cycles = numbers_of<std::int64_t>(cycle, "cycle", frames, "frames", -1),
                 .times = numbers_of<double>(time, "time", frames, "frames"),
                 .steps = numbers_of<std::int64_t>(step, "step", frames, "frames", -9e15),
                 .heights = numbers_of<double>(plate_height, "plate_height", frames, "frames")};
  require_increasing(n.times);
  if (n.phases.empty() != n.cycles.empty())
    throw ConfigError({.file = {}, .key = n.phases.empty() ? "phase" : "cycle"},
                      "is missing; phase and cycle of the frames are given together.");
  for (std::size_t t = 1; t < n.steps.size(); ++t)
    if (n.steps[t] <= n.steps[t - 1])
      throw ConfigError(
          {.file = {}, .key = "step"},
          fmt::format("is {} in frame {} and {} before; it must increase.", n.steps[t], t, n.steps[t - 1]));
  return n;
}

/// Frames from arrays, and what their positions say.
struct GivenFrames {
  std::vector<Frame> frames;
  bool missing = false;                                                   ///< a bead is missing from a frame
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);  ///< corners around all positions
};

GivenFrames make_frames(const VectorArray& r, const VectorArray& v, const VectorArray& position_sigma,
                        const FrameNumbers& n) {
  GivenFrames given;
  given.frames.resize(static_cast<std::size_t>(r.extent(0)));
  for (py::ssize_t t = 0; t < r.extent(0); ++t) {
    const auto k = static_cast<std::size_t>(t);
    Frame& frame = given.frames[k];
    frame.step = n.steps.empty() ? t : n.steps[k];
    frame.time = n.times.empty() ? static_cast<double>(frame.step) : n.times[k];
    if (!n.phases.empty()) frame.phase = n.phases[k], frame.cycle = n.cycles[k];
    if (!n.heights.empty()) frame.plate_height = n.heights[k];
    frame.position = r.of(t, 0);
    if (v.given()) frame.velocity = v.of(t, 0);
    if (position_sigma.given()) frame.position_sigma = position_sigma.of(t, std::nan(""));
    for (Vec3& p : frame.position) {
      if (!p.allFinite()) {
        p.setConstant(std::nan(""));
        given.missing = true;
        continue;
      }
      given.low = given.low.cwiseMin(p);
      given.high = given.high.cwiseMax(p);
    }
  }
  return given;
}

/// The box that is stated; without one, a box open on all sides around the beads.
/// \param components of the positions: 2 or 3
Box cell_around(const GivenFrames& given, const py::object& said_box, py::ssize_t components) {
  Box box;
  if (!said_box.is_none()) {
    box = box_of(said_box);
    if (!py::isinstance<Box>(said_box)) box.dimension = box.periodic(Axis::y) ? 3 : 2;
    if (box.dimension == 2 && components == 3 && given.low.y() < given.high.y())
      throw ConfigError({.file = {}, .key = "box"},
                        "is planar, but the positions are not; three-dimensional ones need Box(dimension=3) "
                        "or three lengths.");
    return box;
  }
  Vec3 low = given.low, high = given.high;
  box.dimension = static_cast<int>(components);
  box.boundary = {Boundary::open, Boundary::open, Boundary::open};
  if (!(low.array() <= high.array()).all()) low.setZero(), high.setOnes();
  box.lower = low - Vec3::Constant(0.5);
  box.upper = high + Vec3::Constant(0.5);
  return box;
}

/// Checks the frames and copies them. Slots without a bead are marked as empty.
SharedFrames in_memory(TrajectoryInfo info, GivenFrames& given, const char* name) {
  SharedFrames memory(std::move(info));
  for (std::size_t t = 0; t < given.frames.size(); ++t) {
    Frame& frame = given.frames[t];
    if (given.missing) {
      frame.id.resize(memory.info().n_beads, -1);
      for (std::size_t i = 0; i < memory.info().n_beads; ++i)
        if (frame.position[i].allFinite()) frame.id[i] = static_cast<std::int64_t>(i);
    }
    require_ranges(frame, t, memory.info(), name);
    require_filled_slots(frame, t, name);
    memory.append(frame);
  }
  return memory;
}

std::shared_ptr<Trajectory> from_arrays(const py::object& positions, const py::object& velocities,
                                        const py::object& position_sigma, const py::object& radii,
                                        const py::object& masses, const py::object& tracers,
                                        const py::object& phase, const py::object& cycle,
                                        const py::object& time, const py::object& step,
                                        const py::object& plate_height, const py::object& said_box,
                                        const std::optional<Drive>& drive, int phases_per_cycle,
                                        const std::string& source) {
  const VectorArray r(positions, "positions", -1, -1);
  if (!r.given()) throw ConfigError({.file = {}, .key = "positions"}, "is missing.");
  const py::ssize_t frames = r.extent(0), beads = r.extent(1);
  const VectorArray v(velocities, "velocities", frames, beads),
      s(position_sigma, "position_sigma", frames, beads);
  TrajectoryInfo info;
  info.n_beads = static_cast<std::size_t>(beads);
  info.drive = drive;
  info.phases_per_cycle = phases_per_cycle;
  if (source != "simulation" && source != "experiment" && source != "unknown")
    throw ConfigError({.file = {}, .key = "source"},
                      fmt::format("is '{}'; it must be simulation, experiment or unknown.", source));
  info.source = source;
  info.radius = numbers_of<double>(radii, "radii", beads, "beads");
  info.mass = numbers_of<double>(masses, "masses", beads, "beads");
  info.tracer = numbers_of<std::uint8_t>(tracers, "tracers", beads, "beads", 0, 1);
  info.provenance_json = provenance_of("twincell.Trajectory.from_arrays (Python)").to_json();
  const FrameNumbers numbers = frame_numbers(phase, cycle, time, step, plate_height, frames);
  GivenFrames given = make_frames(r, v, s, numbers);
  info.columns = {.velocity = v.given(),
                  .identity = given.missing,
                  .phase = !numbers.phases.empty(),
                  .plate_height = !numbers.heights.empty(),
                  .position_sigma = s.given()};
  info.box = cell_around(given, said_box, r.extent(2));
  if (!said_box.is_none()) unwrap(given.frames, info.box);
  const char* const name = "from_arrays";
  require_ranges(info, name);
  require_order(numbers.phases, numbers.cycles, name);
  return std::make_shared<Trajectory>(in_memory(std::move(info), given, name));
}

}  // namespace

std::shared_ptr<Trajectory> trajectory_of_points(const py::object& points, const py::object& box) {
  const py::module_ numpy = py::module_::import("numpy");
  py::object frames = numpy.attr("asarray")(without_mask(points));
  if (frames.attr("ndim").cast<int>() == 2) frames = numpy.attr("expand_dims")(frames, 0);
  if (frames.attr("ndim").cast<int>() != 3)
    throw ConfigError(
        {.file = {}, .key = "trajectory"},
        fmt::format("must have the shape (frames, beads, 2 or 3) or (beads, 2 or 3); it has {}.",
                    py::str(frames.attr("shape")).cast<std::string>()));
  const py::ssize_t n = py::len(frames);
  const py::object none = py::none();
  return from_arrays(frames, none, none, none, none, none, numpy.attr("zeros")(n), numpy.attr("arange")(n),
                     none, none, none, box, {}, 1, "unknown");
}

namespace {

/// A folder for temporary files; the caller calls its cleanup().
py::object temporary_folder() {
  return py::module_::import("tempfile").attr("TemporaryDirectory")();
}
std::filesystem::path file_in(const py::object& folder) {
  return std::filesystem::path(folder.attr("name").cast<std::string>()) / "trajectory.h5";
}

void write(Trajectory& trajectory, const std::filesystem::path& path) {
  require_no_input(path, {trajectory.source().name()});
  H5mdWriter writer(path, trajectory.info());
  for (std::size_t t = 0; t < trajectory.n_frames(); ++t) writer.append(*trajectory.frame(t));
  writer.finish();
}

/// State for pickle: of a file its absolute path, its size and the time of its last change; in memory the
/// bytes of its H5MD file.
py::tuple pickled(Trajectory& trajectory) {
  if (const auto file = trajectory.file())
    return py::make_tuple(file->path.string(), file->bytes, file->changed_ns);
  const py::object folder = temporary_folder();
  write(trajectory, file_in(folder));
  const py::object bytes =
      py::module_::import("pathlib").attr("Path")(file_in(folder).string()).attr("read_bytes")();
  folder.attr("cleanup")();
  return py::make_tuple(bytes);
}
std::shared_ptr<Trajectory> unpickled(const py::tuple& state) {
  if (py::isinstance<py::str>(state[0])) {
    const std::filesystem::path path(state[0].cast<std::string>());
    if (state.size() > 2)
      if (const FileIdentity id = FileIdentity::of(path);
          id.bytes != state[1].cast<std::uintmax_t>() || id.changed_ns != state[2].cast<std::int64_t>())
        throw InputError({.file = path.string(), .key = {}},
                         "the file was replaced or changed since the trajectory was pickled.");
    return std::make_shared<Trajectory>(path);
  }
  const py::object folder = temporary_folder();
  py::module_::import("pathlib").attr("Path")(file_in(folder).string()).attr("write_bytes")(state[0]);
  std::optional<SharedFrames> frames;
  {
    const H5mdReader file(file_in(folder));
    frames.emplace(file.info());
    Frame frame;
    for (std::size_t k = 0; k < file.n_frames(); ++k) file.read(k, frame), frames->append(frame);
  }
  folder.attr("cleanup")();
  return std::make_shared<Trajectory>(std::move(*frames));
}

/// \param of_bead text of the column of one frame
std::string of_frame_text(const std::string& what, const std::string& of_bead) {
  return "Column of frames, `column[t]`: an array (n_beads, 3) with " + what +
         " of every slot in frame t; None if the trajectory has no such column. In C++: " + of_bead;
}

void bind_column(py::module_& module) {
  py::class_<Column>(
      module, "Column",
      "A vector per bead in every frame: column[t] is a read-only array (n_beads, 3) over the memory of the "
      "frame, column[a:b], column[a:b, i] and numpy.asarray(column) are copies of (frames, n_beads, 3).")
      .def("__len__", [](const Column& c) { return c.trajectory->n_frames(); })
      .def(
          "__getitem__",
          [](const Column& c, py::ssize_t t) { return c.at(index_of(t, c.trajectory->n_frames())); },
          py::arg("frame"))
      .def(
          "__getitem__",
          [](const Column& c, const py::slice& slice) {
            std::size_t start = 0, stop = 0, step = 0, length = 0;
            if (!slice.compute(c.trajectory->n_frames(), &start, &stop, &step, &length))
              throw py::error_already_set();
            return c.stack(start, static_cast<py::ssize_t>(step), length);
          },
          py::arg("frames"))
      .def(
          "__getitem__",
          [](const Column& c, const py::tuple& key) -> py::object {
            return c.stack(0, 1, c.trajectory->n_frames())[key];
          },
          py::arg("key"))
      .def(
          "__array__",
          [](const Column& c, const py::object& dtype) -> py::object {
            const py::array all = c.stack(0, 1, c.trajectory->n_frames());
            return dtype.is_none() ? py::object(all) : all.attr("astype")(dtype);
          },
          py::arg("dtype") = py::none());
}

void bind_contacts(py::module_& module) {
  py::class_<Contacts>(
      module, "Contacts",
      "The contacts of every frame: contacts[t] is a read-only structured array over the memory of the "
      "frame, sorted by (i, j), with the fields i, j, overlap, normal (3), normal_force and tangential_force "
      "(3).")
      .def("__len__", [](const Contacts& c) { return c.trajectory->n_frames(); })
      .def(
          "__getitem__",
          [](const Contacts& c, py::ssize_t t) { return c.at(index_of(t, c.trajectory->n_frames())); },
          py::arg("frame"), header_text(kHeader, "ContactForce"));
}

using TrajectoryClass = py::class_<Trajectory, std::shared_ptr<Trajectory>>;

void bind_making(TrajectoryClass& bound) {
  bound
      .def_static(
          "open", [](const std::filesystem::path& path) { return std::make_shared<Trajectory>(path); },
          py::arg("path"), header_text("trajectory/formats/h5md_file.hpp", "H5mdReader"))
      .def_static(
          "from_arrays", &from_arrays, py::arg("positions"), py::kw_only(),
          py::arg("velocities") = py::none(), py::arg("position_sigma") = py::none(),
          py::arg("radii") = py::none(), py::arg("masses") = py::none(), py::arg("tracers") = py::none(),
          py::arg("phase") = py::none(), py::arg("cycle") = py::none(), py::arg("time") = py::none(),
          py::arg("step") = py::none(), py::arg("plate_height") = py::none(), py::arg("box") = py::none(),
          py::arg("drive") = py::none(), py::arg("phases_per_cycle") = 0, py::arg("source") = "unknown",
          "A trajectory in memory, so that data of any origin can be analysed.\n\n"
          "positions: (frames, beads, 2) as (x, z) or (frames, beads, 3) as (x, y, z), sigma; NaN where a "
          "bead is missing. The other arguments are the columns of the same names: vectors have the shape of "
          "positions, numbers of beads (beads,), numbers of frames (frames,). box: a Box, or the lengths (x, "
          "z) "
          "or (x, y, z) of a periodic one; without it the cell is open on all sides. Arrays are copied.")
      .def("write", &write, py::arg("path"), header_text("trajectory/formats/h5md_file.hpp", "H5mdWriter"));
}

/// The columns of the beads.
void bind_bead_columns(TrajectoryClass& bound) {
  const auto column = [](bool Columns::*has, std::vector<Vec3> Frame::*member) {
    return [has, member](const std::shared_ptr<Trajectory>& t) -> py::object {
      if (has != nullptr && !(t->info().columns.*has)) return py::none();
      return py::cast(Column{t, member});
    };
  };
  bound
      .def_property_readonly("positions", column(nullptr, &Frame::position),
                             of_frame_text("x, y, z", header_text(kHeader, "Frame::position")).c_str())
      .def_property_readonly("velocities", column(&Columns::velocity, &Frame::velocity),
                             of_frame_text("the velocity", header_text(kHeader, "Frame::velocity")).c_str())
      .def_property_readonly("spins", column(&Columns::spin, &Frame::spin),
                             of_frame_text("the spin", header_text(kHeader, "Frame::spin")).c_str())
      .def_property_readonly(
          "position_sigma", column(&Columns::position_sigma, &Frame::position_sigma),
          of_frame_text("the uncertainty of x, y, z", header_text(kHeader, "Frame::position_sigma")).c_str())
      .def_property_readonly(
          "contacts",
          [](const std::shared_ptr<Trajectory>& t) -> py::object {
            if (!t->info().columns.contact_forces) return py::none();
            return py::cast(Contacts{t});
          },
          "Contacts: contacts[t] has those of frame t with their forces. None if the trajectory does not "
          "store them (simulate --contacts, the key time.contacts).");
}

/// The walls, and the numbers of each bead that are the same in all frames.
void bind_bead_numbers(TrajectoryClass& bound) {
  bound
      .def_property_readonly(
          "walls", [](const Trajectory& t) { return t.info().walls; },
          header_text(kHeader, "TrajectoryInfo::walls"))
      .def_property_readonly(
          "radii", [](const std::shared_ptr<Trajectory>& t) { return of_slots(t, t->info().radius); },
          header_text(kHeader, "TrajectoryInfo::radius"))
      .def_property_readonly(
          "masses", [](const std::shared_ptr<Trajectory>& t) { return of_slots(t, t->info().mass); },
          header_text(kHeader, "TrajectoryInfo::mass"))
      .def_property_readonly(
          "tracers", [](const std::shared_ptr<Trajectory>& t) { return of_slots(t, t->info().tracer); },
          header_text(kHeader, "TrajectoryInfo::tracer"));
}

/// The numbers of each frame.
void bind_frame_columns(TrajectoryClass& bound) {
  bound
      .def_property_readonly(
          "step", [](Trajectory& t) { return of_frames(t, [](const Frame& f) { return f.step; }); },
          header_text(kHeader, "Frame::step"))
      .def_property_readonly(
          "time", [](Trajectory& t) { return of_frames(t, [](const Frame& f) { return f.time; }); },
          header_text(kHeader, "Frame::time"))
      .def_property_readonly(
          "phase",
          [](Trajectory& t) -> py::object {
            if (!t.info().columns.phase) return py::none();
            return of_frames(t, [](const Frame& f) { return f.phase; });
          },
          header_text(kHeader, "Frame::phase"))
      .def_property_readonly(
          "cycle",
          [](Trajectory& t) -> py::object {
            if (!t.info().columns.phase) return py::none();
            return of_frames(t, [](const Frame& f) { return f.cycle; });
          },
          header_text(kHeader, "Frame::cycle"))
      .def_property_readonly(
          "plate_height",
          [](Trajectory& t) -> py::object {
            if (!t.info().columns.plate_height) return py::none();
            return of_frames(t, [](const Frame& f) { return f.plate_height; });
          },
          header_text(kHeader, "Frame::plate_height"));
}

/// What the trajectory states of its cell, drive and origin.
void bind_info(TrajectoryClass& bound) {
  bound
      .def_property_readonly(
          "box", [](const Trajectory& t) { return t.info().box; }, header_text("trajectory/box.hpp", "Box"))
      .def_property_readonly(
          "drive", [](const Trajectory& t) { return t.info().drive; },
          header_text("trajectory/drive.hpp", "Drive"))
      .def_property_readonly(
          "phases_per_cycle", [](const Trajectory& t) { return t.info().phases_per_cycle; },
          header_text(kHeader, "TrajectoryInfo::phases_per_cycle"))
      .def_property_readonly(
          "source", [](const Trajectory& t) { return t.info().source; },
          header_text(kHeader, "TrajectoryInfo::source"))
      .def_property_readonly(
          "scale",
          [](const Trajectory& t) {
            py::dict d;
            d["sigma_m"] = t.info().scale.sigma_m;
            d["gravity_m_s2"] = t.info().scale.gravity_m_s2;
            d["pixels_per_sigma"] = t.info().scale.pixels_per_sigma;
            d["t0_s"] = t.info().scale.t0_s();
            return d;
          },
          header_text("trajectory/units.hpp", "Scale"))
      .def_property_readonly(
          "provenance",
          [](const Trajectory& t) {
            return t.info().provenance_json.empty() ? py::object(py::none())
                                                    : from_json(t.info().provenance_json);
          },
          "What produced the trajectory, as a dict; None if the file does not say.")
      .def_property_readonly(
          "tracking",
          [](const Trajectory& t) {
            return t.info().tracking_json.empty() ? py::object(py::none())
                                                  : from_json(t.info().tracking_json);
          },
          header_text(kHeader, "TrajectoryInfo::tracking_json"));
}

}  // namespace

void bind_trajectory(py::module_& module) {
  bind_box(module);
  bind_drive(module);
  bind_column(module);
  bind_contacts(module);
  TrajectoryClass bound(module, "Trajectory", header_text(kHeader, "TrajectorySource"));
  bind_making(bound);
  bound.def("__len__", &Trajectory::n_frames)
      .def_property_readonly("n_frames", &Trajectory::n_frames, "Number of frames.")
      .def_property_readonly(
          "n_beads", [](const Trajectory& t) { return t.info().n_beads; },
          "Number of slots: slot i is the same bead in every frame.")
      .def_property_readonly(
          "name", [](const Trajectory& t) { return t.source().name(); }, "The file, or \"memory\".")
      .def_property_readonly("_file", [](const Trajectory& t) {
        const auto file = t.file();
        return file ? std::optional(file->path) : std::nullopt;
      });
  bind_bead_columns(bound);
  bind_bead_numbers(bound);
  bind_frame_columns(bound);
  bind_info(bound);
  bound.def(py::pickle(&pickled, &unpickled)).def("__repr__", [](const Trajectory& t) {
    return fmt::format("<twincell.Trajectory of {}: {} frames of {} beads, {}>", t.source().name(),
                       t.n_frames(), t.info().n_beads, t.info().source);
  });
}

}  // namespace twincell::python
