// Trajectory.from_arrays of the Python module.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "python/trajectory.hpp"
#include "trajectory/box.hpp"
#include "trajectory/ranges.hpp"
#include "trajectory/wrapped_positions.hpp"

namespace twincell::python {

namespace {

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

/// Checks and marks the missing beads of a frame, and extends the corners. \param planar as is_missing
void take_positions(GivenFrames& given, Frame& frame, std::size_t t, bool planar) {
  for (std::size_t i = 0; i < frame.position.size(); ++i) {
    Vec3& p = frame.position[i];
    if (is_missing(p, planar, "positions", i, t)) {
      p.setConstant(std::nan(""));
      given.missing = true;
      continue;
    }
    given.low = given.low.cwiseMin(p);
    given.high = given.high.cwiseMax(p);
  }
}

/// \throws ConfigError if the beads of all frames have one z, as in the convention (x, y, 0) for a plane
void refuse_flat(const GivenFrames& given) {
  if (given.low.z() != given.high.z()) return;
  for (const Frame& frame : given.frames)
    if (common_height(frame.position))
      throw ConfigError(
          {.file = {}, .key = "positions"},
          fmt::format("all beads have z = {:g}: give positions of shape (frames, beads, 2) (positions[..., "
                      ":2]) for a two-dimensional system, or a Box of dimension 3 for a layer in three "
                      "dimensions.",
                      given.low.z()));
}

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
    take_positions(given, frame, k, r.extent(2) == 2);
  }
  return given;
}

/// The box that is stated; without one, a box open on all sides around the beads.
/// \param components of the positions: 2 or 3
Box cell_around(const GivenFrames& given, const py::object& said_box, py::ssize_t components) {
  Box box;
  if (!said_box.is_none()) {
    box = box_of(said_box);
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
                                        const std::string& source, bool unwrapped) {
  const VectorArray r(positions, "positions", -1, -1);
  if (!r.given()) throw ConfigError({.file = {}, .key = "positions"}, "is missing.");
  const py::ssize_t frames = r.extent(0), beads = r.extent(1);
  const VectorArray v(velocities, "velocities", frames, beads),
      s(position_sigma, "position_sigma", frames, beads);
  TrajectoryInfo info;
  info.n_beads = static_cast<std::size_t>(beads);
  info.drive = drive;
  info.source = row_named(kOrigins, source, "source", "source").value;
  info.radius = numbers_of<double>(radii, "radii", beads, "beads");
  info.mass = numbers_of<double>(masses, "masses", beads, "beads");
  info.tracer = numbers_of<std::uint8_t>(tracers, "tracers", beads, "beads", 0, 1);
  info.provenance_json = provenance_of("twincell.Trajectory.from_arrays (Python)").to_json();
  const FrameNumbers numbers = frame_numbers(phase, cycle, time, step, plate_height, frames);
  info.phases_per_cycle = phases_per_cycle;
  if (phases_per_cycle == 0 && !numbers.phases.empty()) {
    const std::int32_t last = *std::max_element(numbers.phases.begin(), numbers.phases.end());
    info.phases_per_cycle = std::min(last, std::numeric_limits<std::int32_t>::max() - 1) + 1;
  }
  GivenFrames given = make_frames(r, v, s, numbers);
  info.columns = {.velocity = v.given(),
                  .identity = given.missing,
                  .phase = !numbers.phases.empty(),
                  .plate_height = !numbers.heights.empty(),
                  .position_sigma = s.given()};
  const bool spatial = py::isinstance<Box>(said_box) && said_box.cast<const Box&>().dimension == 3;
  if (!spatial) refuse_flat(given);
  info.box = cell_around(given, said_box, r.extent(2));
  if (unwrapped && !said_box.is_none()) unwrap(given.frames, info.box);
  const char* const name = "from_arrays";
  try {
    require_ranges(info, name);
    require_order(numbers.phases, numbers.cycles, name);
    return std::make_shared<Trajectory>(in_memory(std::move(info), given, name));
  } catch (const InputError& e) {  // arguments are no file
    throw ConfigError({}, e.what());
  }
}

}  // namespace

std::shared_ptr<Trajectory> trajectory_of_points(const py::object& points, const py::object& box,
                                                 bool unwrapped) {
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
                     none, none, none, box, {}, 1, "unknown", unwrapped);
}

void bind_trajectory_from_arrays(py::module_& module) {
  py::object type = module.attr("Trajectory");
  const char* const name = "from_arrays";
  // As class_::def_static does, for a class that is bound elsewhere.
  type.attr(name) = py::staticmethod(py::cpp_function(
      &from_arrays, py::name(name), py::scope(type), py::sibling(py::getattr(type, name, py::none())),
      py::arg("positions"), py::kw_only(), py::arg("velocities") = py::none(),
      py::arg("position_sigma") = py::none(), py::arg("radii") = py::none(), py::arg("masses") = py::none(),
      py::arg("tracers") = py::none(), py::arg("phase") = py::none(), py::arg("cycle") = py::none(),
      py::arg("time") = py::none(), py::arg("step") = py::none(), py::arg("plate_height") = py::none(),
      py::arg("box") = py::none(), py::arg("drive") = py::none(), py::arg("phases_per_cycle") = 0,
      py::arg("source") = "unknown", py::arg("unwrap") = true,
      "A trajectory in memory, so that data of any origin can be analysed.\n\n"
      "positions: (frames, beads, 2) as (x, z) or (frames, beads, 3) as (x, y, z) with z up, sigma; NaN "
      "where a bead is missing. The other arguments are the columns of the same names: vectors have the "
      "shape of positions, numbers of beads (beads,), numbers of frames (frames,). phases_per_cycle: 0: one "
      "more than the largest phase. box: a Box, or the lengths (x, z) or (x, y, z) of a periodic one; "
      "without it the cell is open on all sides. unwrap: positions along a period are unwrapped by the "
      "shortest displacement from frame to frame, unless they extend beyond the period by more than two "
      "bead diameters, as unwrapped positions do; False keeps them as they are given. Arrays are copied."));
}

}  // namespace twincell::python
