// Contacts per bead and areas of Voronoi cells of lattices, in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>

#include "analysis/order/contact_number.hpp"
#include "analysis/order/voronoi_area.hpp"
#include "tests/support/known_beds.hpp"
#include "tests/support/validation.hpp"

namespace twincell::test::contacts_and_cells_test {
namespace {

constexpr int kColumns = 12, kRows = 14;

/// A triangular lattice with random displacements of each bead.
MemoryTrajectory lattice(double spacing, double noise) {
  MemoryTrajectory t = empty(2, period_of_lattice(kColumns, kRows, spacing), true);
  std::mt19937_64 random(3);
  std::normal_distribution<double> shift(0, 1);
  for (int f = 0; f < 20; ++f) {
    std::vector<Vec3> beads = triangular_lattice(kColumns, kRows, spacing);
    for (Vec3& r : beads) r += noise * Vec3(shift(random), 0, shift(random));
    add(t, beads);
  }
  return t;
}

}  // namespace

TEST(ContactNumber, IsThatOfTheLattice) {
  for (const auto& [spacing, contacts] : {std::pair{1.0, 6.0}, std::pair{1.05, 6.0}, std::pair{1.051, 0.0}}) {
    const MemoryTrajectory t = lattice(spacing, 0);
    for (const char* name : {"contact_number", "contact_number_inside"})
      validate({"V5.21", std::string(name) + " of a triangular lattice", contacts, 1e-12, "closed form"},
               values_of(t, name)[0]);
  }
  MemoryTrajectory square = empty(2, Vec3(8, 1, 20), false);
  std::vector<Vec3> beads;
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 6; ++k) beads.emplace_back(i + 0.5, 0, k + 0.5);
  add(square, beads);
  validate({"V5.21", "contacts inside a square lattice", 4, 1e-12, "closed form"},
           values_of(square, "contact_number_inside")[0]);
  // 2 (2 n m - n - m) contacts of n x m beads
  validate({"V5.21", "contacts of a square of beads", 2.0 * (2 * 48 - 14) / 48, 1e-12, "closed form"},
           values_of(square, "contact_number")[0]);
}

TEST(ContactNumber, UsesTheRadii) {
  MemoryTrajectory t = empty(2, Vec3(10, 1, 10), false);
  t.info().radius = {0.5, 0.25, 0.25, 0.5};
  // 1.05 times 0.75 is 0.7875: the first pair touches, the second, with the same distance, is too far.
  add(t, {Vec3(1, 0, 1), Vec3(1.78, 0, 1), Vec3(5, 0, 1), Vec3(5.79, 0, 1)});
  validate({"V5.21", "contacts of beads of two sizes", 0.5, 1e-12, "closed form"},
           values_of(t, "contact_number")[0]);
}

TEST(VoronoiArea, OfAHexagonalLatticeDoesNotVary) {
  for (const double spacing : {1.0, 1.2}) {
    const MemoryTrajectory t = lattice(spacing, 0);
    validate({"V5.22", "area of a cell of a triangular lattice", std::sqrt(3.0) / 2 * spacing * spacing,
              1e-12, "sqrt(3)/2 a^2"},
             values_of(t, "voronoi_area")[0]);
    validate({"V5.22", "variance of these areas", 0, 1e-24, "closed form"},
             values_of(t, "voronoi_area_variance")[0]);
  }
}

TEST(VoronoiArea, FillsTheBox) {
  const MemoryTrajectory t = lattice(1.05, 0.06);
  const Vec3 size = t.info().box.size();
  validate({"V5.22", "mean area of the cells of a disordered lattice",
            size.x() * size.z() / (kColumns * kRows), 1e-9, "box over number of beads"},
           values_of(t, "voronoi_area")[0]);
  EXPECT_GT(values_of(t, "voronoi_area_variance")[0], 1e-4);
  const auto density = values_of(t, "voronoi_area_density"), ratio = values_of(t, "voronoi_area_ratio");
  double all = 0, mean = 0;
  for (std::size_t b = 0; b < density.size(); ++b) {
    all += density[b] * analysis::kVoronoiAreaWidth;
    mean += density[b] * ratio[b] * analysis::kVoronoiAreaWidth;
  }
  validate({"V5.22", "integral of the density of areas", 1, 1e-12, "closed form"}, all);
  validate({"V5.22", "mean of the density of areas", 1, 0.01, "closed form"}, mean);
}

TEST(VoronoiArea, OfADiluteGasFillsThePeriodicBox) {
  // Most of these cells reach farther than the default radius of 0.9.
  MemoryTrajectory t = empty(2, Vec3(60, 1, 60), true);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> place(0, 60);
  for (int f = 0; f < 4; ++f) {
    std::vector<Vec3> beads;
    for (int i = 0; i < 300; ++i) beads.emplace_back(place(random), 0, place(random));
    add(t, beads);
  }
  validate({"V5.22", "mean area of the cells of a dilute gas", 12, 1e-9, "box over number of beads"},
           values_of(t, "voronoi_area")[0]);
  // Poisson cells: variance 0.2802 of the square of the mean (Brakke 1987).
  validate({"V5.22", "variance of these areas over the square of the mean", 0.2802, 0.06, "Brakke 1987"},
           values_of(t, "voronoi_area_variance")[0] / 144);
  const auto results = analysis::analyze(t, {.only = {"voronoi_area"}});
  EXPECT_EQ(analysis::find_result(results, "voronoi_area").convention, "all cells; mean over frames");
}

TEST(VoronoiArea, OfFewPointsFillsThePeriodicBox) {
  // Some of these cells reach farther than a quarter of the shorter period, all of those of one or two beads.
  std::mt19937_64 random(6);
  for (const auto& [points, width, height] :
       {std::tuple{40, 10.0, 10.0}, {7, 9.0, 3.0}, {2, 5.0, 6.0}, {1, 4.0, 4.0}}) {
    MemoryTrajectory t = empty(2, Vec3(width, 1, height), true);
    for (int f = 0; f < 50; ++f) {
      std::vector<Vec3> beads;
      for (int i = 0; i < points; ++i)
        beads.emplace_back(std::uniform_real_distribution<double>(0, width)(random), 0,
                           std::uniform_real_distribution<double>(0, height)(random));
      add(t, beads);
    }
    validate({"V5.22", "mean area of the cells of " + std::to_string(points) + " points in a period",
              width * height / points, 1e-9, "box over number of beads"},
             values_of(t, "voronoi_area")[0]);
  }
}

TEST(VoronoiArea, StatesTheCellsThatAreLeftOut) {
  // 5 x 5 beads of a square lattice between walls: 9 cells are enclosed, 16 of 25 are at the surface.
  MemoryTrajectory t = empty(2, Vec3(5, 1, 5), false);
  std::vector<Vec3> beads;
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k) beads.emplace_back(i + 0.5, 0, k + 0.5);
  add(t, beads);
  const auto results = analysis::analyze(t, {.only = {"voronoi_area"}});
  const analysis::Result& area = analysis::find_result(results, "voronoi_area");
  EXPECT_NEAR(area.value(), 1, 1e-12);
  EXPECT_NE(area.convention.find("64 % of the cells were left out, as they reach farther than 0.9 sigma"),
            std::string::npos)
      << area.convention;
}

TEST(VoronoiArea, OfAPlasticallyShearedLatticeIsUnchanged) {
  // A simple shear keeps the area of every cell: its rows slide as wholes.
  MemoryTrajectory t = empty(2, period_of_lattice(kColumns, kRows, 1), true);
  std::vector<Vec3> beads = triangular_lattice(kColumns, kRows, 1);
  for (Vec3& r : beads)
    if (r.z() > 5) r.x() += 0.2;
  add(t, beads);
  validate(
      {"V5.22", "mean area after a row has slipped", std::sqrt(3.0) / 2, 1e-12, "box over number of beads"},
      values_of(t, "voronoi_area")[0]);
}

}  // namespace twincell::test::contacts_and_cells_test
