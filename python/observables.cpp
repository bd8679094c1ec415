// Observables of one frame, on arrays of points.

#include <fmt/format.h>

#include <cmath>
#include <complex>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "analysis/neighbours/neighbours.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/observable/observable.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "python/module.hpp"

namespace twincell::python {

namespace {

/// What becomes of points with one z and different y.
enum class Layer {
  refused,  ///< the function uses the plane (x, z), in which they are a row
  allowed,  ///< in a Box of dimension 3
};

/// A frame of points; missing points are empty slots. \throws ConfigError for points in the plane (x, y)
Frame frame_of(const py::object& points, const py::object& box, Layer layer) {
  Frame frame;
  frame.position = points_of(points, "points");
  const bool spatial =
      layer == Layer::allowed && py::isinstance<Box>(box) && box.cast<const Box&>().dimension == 3;
  if (const auto z = common_height(frame.position); z && !spatial)
    throw ConfigError(
        {.file = {}, .key = "points"},
        fmt::format(
            "all points have z = {:g}: give points of shape (N, 2) (points[:, :2]) for a "
            "two-dimensional system{}.",
            *z, layer == Layer::allowed ? ", or a Box of dimension 3 for a layer in three dimensions" : ""));
  bool missing = false;
  for (const Vec3& p : frame.position) missing = missing || !p.allFinite();
  if (!missing) return frame;
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    frame.id.push_back(frame.position[i].allFinite() ? static_cast<std::int64_t>(i) : -1);
  return frame;
}

double checked_length(const char* name, double value) {
  require_range({.file = {}, .key = name}, value, 0, std::nullopt, true);
  return value;
}

/// \throws ConfigError for a period in which two images of a bead can be within the cutoff
void require_periods(const Box& box, double cutoff) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    if (const double width = box.size()[static_cast<int>(axis)];
        box.periodic(axis) && !(box.dimension == 2 && axis == Axis::y) && width <= 2 * cutoff)
      throw ConfigError(
          {.file = {}, .key = "box"},
          fmt::format("has the period {:g} along {}; neighbours within {:g} need more than {:g}.", width,
                      "xyz"[static_cast<int>(axis)], cutoff, 2 * cutoff));
}

/// The Voronoi cells of points. \throws ConfigError for a periodic box too narrow for them
analysis::VoronoiCells cells_of(const Frame& frame, const Box& box, double cell_radius) {
  checked_length("cell_radius", cell_radius);
  for (const Axis axis : {Axis::x, Axis::z})
    if (const double width = box.size()[static_cast<int>(axis)];
        box.periodic(axis) && width <= 4 * cell_radius)
      throw ConfigError({.file = {}, .key = "box"},
                        fmt::format("has the period {:g}; Voronoi cells of radius {:g} need more than {:g}.",
                                    width, cell_radius, 4 * cell_radius));
  return analysis::voronoi_cells(frame, box, cell_radius);
}

py::array indices_of(const std::vector<std::size_t>& values) {
  return array_of(std::vector<std::int64_t>(values.begin(), values.end()));
}

py::dict dict_of(const analysis::Neighbours& n) {
  std::vector<std::int64_t> from;
  std::vector<double> bonds;
  for (std::size_t i = 0; i + 1 < n.first.size(); ++i)
    from.insert(from.end(), n.count(i), static_cast<std::int64_t>(i));
  for (const Vec3& b : n.bond) bonds.insert(bonds.end(), b.data(), b.data() + 3);
  const auto entries = static_cast<py::ssize_t>(n.index.size());
  py::dict d;
  d["i"] = array_of(std::move(from));
  d["j"] = indices_of(n.index);
  d["bond"] = array_of(std::move(bonds), {entries, 3});
  return d;
}

struct Bonds {
  analysis::Neighbours neighbours;
  std::vector<double> weight;
};

/// The bonds of points; `use(bonds)` runs without the interpreter's lock too.
template <class Use>
auto with_bonds(const py::object& points, const py::object& box, const std::string& rule, double cutoff,
                double cell_radius, Layer layer, Use use) {
  const analysis::NeighbourRule named = analysis::neighbour_rule_named(rule);
  const bool near = named == analysis::NeighbourRule::cutoff;
  const Frame frame = frame_of(points, box, near ? layer : Layer::refused);
  const Box cell = box_of(box);
  if (near) require_periods(cell, checked_length("cutoff", cutoff));
  const py::gil_scoped_release release;
  if (near) return use(Bonds{analysis::find_neighbours(frame, cell, cutoff), {}});
  analysis::VoronoiCells cells = cells_of(frame, cell, cell_radius);
  return use(Bonds{std::move(cells.neighbours), named == analysis::NeighbourRule::voronoi
                                                    ? std::move(cells.edge)
                                                    : std::vector<double>{}});
}

constexpr auto kOrder = [](const Bonds& bonds) {
  return analysis::bond_order(bonds.neighbours, bonds.weight);
};

constexpr double kCutoff = 1.2;  // sigma, between touching beads and the next shell (neighbour_cutoff)

std::string points_text() {
  return "\n\npoints: (N, 2) as (x, z) or (N, 3) as (x, y, z) with z up, in bead diameters; NaN where a bead "
         "is missing. A DataFrame with the columns x and y, x and z, or x, y and z is taken by these names. "
         "Points (x, y, 0), by which other programs state a plane, are refused. box: a Box, None for open "
         "sides, or the lengths (x, z) or (x, y, z) of a periodic box, which must exceed twice the reach of "
         "a neighbour.";
}

std::string bonds_text() {
  return points_text() +
         " neighbours: cutoff, delaunay or voronoi, as in `analyze`; cutoff and cell_radius as there.";
}

void bind_neighbours(py::module_& module) {
  module.def(
      "neighbours",
      [](const py::object& points, const py::object& box, double cutoff) {
        const Frame frame = frame_of(points, box, Layer::allowed);
        const Box cell = box_of(box);
        require_periods(cell, checked_length("cutoff", cutoff));
        return dict_of(analysis::find_neighbours(frame, cell, cutoff));
      },
      py::arg("points"), py::arg("box") = py::none(), py::arg("cutoff") = kCutoff,
      (header_text("analysis/neighbours/neighbours.hpp", "find_neighbours") + points_text() +
       "\n\nReturns a dict of arrays with one entry per bond: i, j (beads) and bond (from i to j, (n, 3)).")
          .c_str());
}

void bind_number_of_neighbours(py::module_& module) {
  const auto bind = [&](const char* name, const std::string& text) {
    module.def(
        name,
        [](const py::object& points, const py::object& box, const std::string& neighbours, double cutoff,
           double cell_radius) {
          return array_of(with_bonds(
              points, box, neighbours, cutoff, cell_radius, Layer::allowed, [](const Bonds& bonds) {
                std::vector<std::int64_t> counts;
                for (std::size_t i = 0; i + 1 < bonds.neighbours.first.size(); ++i)
                  counts.push_back(static_cast<std::int64_t>(bonds.neighbours.count(i)));
                return counts;
              }));
        },
        py::arg("points"), py::arg("box") = py::none(), py::arg("neighbours") = "cutoff",
        py::arg("cutoff") = kCutoff, py::arg("cell_radius") = analysis::kCellRadius,
        (text + bonds_text()).c_str());
  };
  const std::string text =
      "Number of neighbours of every bead by the neighbour rule. Neighbours need not touch: the number of "
      "contacts per bead is the result contact_number of analyze().";
  bind("number_of_neighbours", text);
  bind("coordination", "The earlier name of number_of_neighbours(). " + text);
}

void bind_bond_order(py::module_& module) {
  module.def(
      "bond_order",
      [](const py::object& points, const py::object& box, const std::string& neighbours, double cutoff,
         double cell_radius) {
        analysis::BondOrder order =
            with_bonds(points, box, neighbours, cutoff, cell_radius, Layer::refused, kOrder);
        py::dict d;
        d["q6"] = array_of(std::move(order.q6));
        d["psi6"] = array_of(std::move(order.psi6));
        d["psi4"] = array_of(std::move(order.psi4));
        d["angle"] = array_of(std::move(order.angle));
        d["n_bonds"] = indices_of(order.n_bonds);
        return d;
      },
      py::arg("points"), py::arg("box") = py::none(), py::arg("neighbours") = "cutoff",
      py::arg("cutoff") = kCutoff, py::arg("cell_radius") = analysis::kCellRadius,
      (summary_text("analysis/neighbours/bond_orientational_order.hpp", "bond_order") + bonds_text())
          .c_str());
}

void bind_hexatic_order(py::module_& module) {
  module.def(
      "hexatic_order",
      [](const py::object& points, const py::object& box, const std::string& neighbours, double cutoff,
         double cell_radius) {
        const analysis::BondOrder order =
            with_bonds(points, box, neighbours, cutoff, cell_radius, Layer::refused, kOrder);
        std::vector<std::complex<double>> psi;
        for (std::size_t i = 0; i < order.psi6.size(); ++i)
          psi.push_back(std::isfinite(order.angle[i])
                            ? std::polar(order.psi6[i], 6 * order.angle[i] * M_PI / 180)
                            : std::complex<double>(kNaN, kNaN));
        return array_of(std::move(psi));
      },
      py::arg("points"), py::arg("box") = py::none(), py::arg("neighbours") = "cutoff",
      py::arg("cutoff") = kCutoff, py::arg("cell_radius") = analysis::kCellRadius,
      ("Complex hexatic order psi6 = <exp(6 i phi)> of every bead (`bond_order`): phi is the angle of a bond "
       "in the plane (x, z). NaN for fewer than 2 bonds." +
       bonds_text())
          .c_str());
}

void bind_voronoi(py::module_& module) {
  module.def(
      "voronoi",
      [](const py::object& points, const py::object& box, double cell_radius) {
        analysis::VoronoiCells cells =
            cells_of(frame_of(points, box, Layer::refused), box_of(box), cell_radius);
        py::dict d = dict_of(cells.neighbours);
        d["edge"] = array_of(std::move(cells.edge));
        d["enclosed"] = array_of(std::move(cells.enclosed)).attr("astype")("bool");
        return d;
      },
      py::arg("points"), py::arg("box") = py::none(), py::arg("cell_radius") = analysis::kCellRadius,
      (header_text("analysis/neighbours/voronoi.hpp", "voronoi_cells") + points_text() +
       "\n\nReturns a dict of arrays: i, j, bond and edge (length of the shared edge) with one entry per "
       "bond, enclosed with one per bead.")
          .c_str());
}

}  // namespace

void bind_observables(py::module_& module) {
  bind_neighbours(module);
  bind_number_of_neighbours(module);
  bind_bond_order(module);
  bind_hexatic_order(module);
  bind_voronoi(module);
}

}  // namespace twincell::python
