// Box and Drive in Python.

#include "python/box.hpp"

#include <fmt/format.h>

#include <array>

#include "core/error.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/box.hpp"
#include "trajectory/drive.hpp"

namespace twincell::python {

namespace {

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

bool same_box(const Box& a, const Box& b) {
  return a.dimension == b.dimension && a.lower == b.lower && a.upper == b.upper && a.boundary == b.boundary &&
         a.side_tilt == b.side_tilt;
}

/// State for pickle. \throws ConfigError for a recorded motion, which has too many numbers to repeat here
py::tuple pickled_drive(const Drive& d) {
  if (d.recorded)
    throw ConfigError({.file = {}, .key = "drive"},
                      "is a recorded motion, which is pickled with its trajectory or scene only.");
  py::list harmonics;
  for (const Harmonic& h : d.harmonics) harmonics.append(py::make_tuple(h.amplitude, h.phase));
  py::object ramp = py::none(), horizontal = py::none();
  if (d.ramp)
    ramp = py::make_tuple(d.ramp->from.amplitude, d.ramp->from.omega, d.ramp->to.amplitude, d.ramp->to.omega,
                          d.ramp->power, d.ramp->first, d.ramp->cycles, d.ramp->returns);
  if (d.horizontal)
    horizontal = py::make_tuple(d.horizontal->amplitude, d.horizontal->ratio, d.horizontal->phase);
  return py::make_tuple(static_cast<int>(d.axis), d.amplitude, d.omega, harmonics, ramp, horizontal,
                        d.gravity, d.downward_share);
}

Drive unpickled_drive(const py::tuple& state) {
  Drive d;
  d.axis = static_cast<Axis>(state[0].cast<int>());
  d.amplitude = state[1].cast<double>();
  d.omega = state[2].cast<double>();
  for (const auto& [amplitude, phase] : state[3].cast<std::vector<std::pair<double, double>>>())
    d.harmonics.push_back({.amplitude = amplitude, .phase = phase});
  if (!state[4].is_none()) {
    const auto r = state[4].cast<py::tuple>();
    d.ramp = DriveRamp{.from = {.amplitude = r[0].cast<double>(), .omega = r[1].cast<double>()},
                       .to = {.amplitude = r[2].cast<double>(), .omega = r[3].cast<double>()},
                       .power = r[4].cast<int>(),
                       .first = r[5].cast<double>(),
                       .cycles = r[6].cast<double>(),
                       .returns = r[7].cast<bool>()};
  }
  if (!state[5].is_none()) {
    const auto h = state[5].cast<py::tuple>();
    d.horizontal = HorizontalMotion{
        .amplitude = h[0].cast<double>(), .ratio = h[1].cast<int>(), .phase = h[2].cast<double>()};
  }
  d.gravity = state[6].cast<double>();
  d.downward_share = state[7].cast<double>();
  return d;
}

}  // namespace

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
      .def("__eq__", &same_box, py::is_operator())
      .def("__hash__",
           [](const Box& b) {
             return py::hash(py::make_tuple(b.dimension, b.lower.x(), b.lower.y(), b.lower.z(), b.upper.x(),
                                            b.upper.y(), b.upper.z()));
           })
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
      .def(py::pickle(&pickled_drive, &unpickled_drive))
      .def("at", &Drive::at, py::arg("cycles"), header_text("trajectory/drive.hpp", "Drive::at"))
      .def("__repr__", [](const Drive& d) {
        const bool sine = d.harmonics.empty() && !d.recorded && !d.ramp && !d.horizontal;
        return fmt::format("Drive(amplitude={:g}, omega={:g}{})", d.amplitude, d.omega,
                           sine ? "" : ", displacement=" + d.formula());
      });
}

}  // namespace twincell::python
