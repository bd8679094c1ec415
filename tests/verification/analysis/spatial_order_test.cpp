// V5: constructed lattices and flows whose neighbours, defects, grains and circulation are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "analysis/gas/profiles.hpp"
#include "analysis/motion/convection_field.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/order/bond_order.hpp"
#include "analysis/order/defects.hpp"
#include "analysis/order/grains.hpp"
#include "analysis/order/lattice_orientation.hpp"
#include "tests/support/validation.hpp"

namespace twincell::spatial_order_test {

using namespace analysis;

namespace {

constexpr double kPi = std::numbers::pi;
const double kRow = std::sqrt(3.0) / 2;

Box open_box() {
  Box box;
  box.upper = Vec3(40, 1, 40);
  box.boundary = {Boundary::open, Boundary::open, Boundary::open};
  return box;
}

/// A hexagonal lattice of unit spacing, rotated by `degrees` and cut to a rectangle.
std::vector<Vec3> lattice(double degrees, double left, double right, double bottom, double top) {
  std::vector<Vec3> beads;
  const double c = std::cos(degrees * kPi / 180), s = std::sin(degrees * kPi / 180);
  for (int row = -60; row <= 60; ++row)
    for (int k = -60; k <= 60; ++k) {
      const double x = k + 0.5 * (row % 2 != 0 ? 1 : 0), z = row * kRow;
      const Vec3 r(10 + c * x - s * z, 0, 10 + s * x + c * z);
      if (r.x() >= left && r.x() <= right && r.z() >= bottom && r.z() <= top) beads.push_back(r);
    }
  return beads;
}

Frame frame_of(std::vector<Vec3> beads) {
  Frame frame;
  frame.position = std::move(beads);
  return frame;
}

MemoryTrajectory film(const std::vector<Frame>& frames, Box box = open_box()) {
  TrajectoryInfo info;
  info.n_beads = frames.front().position.size();
  info.box = box;
  info.columns.velocity = !frames.front().velocity.empty();
  if (frames.front().cycle >= 0) {
    info.columns.phase = true;
    info.phases_per_cycle = 1;
  }
  MemoryTrajectory trajectory(info);
  for (const Frame& frame : frames) trajectory.append(frame);
  return trajectory;
}

double value(const std::vector<Result>& results, const std::string& name) {
  const Result& r = find_result(results, name);
  EXPECT_TRUE(r.present()) << name << ": " << r.absent;
  return r.value();
}

/// An edge dislocation with Burgers vector (1, 0) at `core`: the lattice with the displacements of linear
/// isotropic elasticity (Hirth & Lothe, eq. 3-45, Poisson's ratio 1/3).
std::vector<Vec3> dislocated(std::vector<Vec3> beads, Vec3 core) {
  const double nu = 1.0 / 3;
  for (Vec3& r : beads) {
    const double x = r.x() - core.x(), z = r.z() - core.z(), r2 = x * x + z * z;
    const double ux = (std::atan2(z, x) + x * z / (2 * (1 - nu) * r2)) / (2 * kPi);
    const double uz =
        -((1 - 2 * nu) / (4 * (1 - nu)) * std::log(r2) + (x * x - z * z) / (4 * (1 - nu) * r2)) / (2 * kPi);
    r += Vec3(ux, 0, uz);
  }
  return beads;
}

}  // namespace

TEST(VoronoiCells, EdgesOfPerfectLattices) {
  const Frame hexagonal = frame_of(lattice(0, 0, 20, 0, 20));
  const VoronoiCells cells = voronoi_cells(hexagonal, open_box());
  double worst = 0;
  std::size_t enclosed = 0;
  for (std::size_t i = 0; i < hexagonal.position.size(); ++i) {
    if (cells.enclosed[i] == 0) continue;
    ++enclosed;
    ASSERT_EQ(cells.neighbours.count(i), 6U);
    for (std::size_t e = cells.neighbours.first[i]; e < cells.neighbours.first[i + 1]; ++e)
      worst = std::max(worst, std::abs(cells.edge[e] - 1 / std::sqrt(3.0)));
  }
  EXPECT_GT(enclosed, 350U);
  test::validate({"V5.1", "hexagonal lattice: largest error of a Voronoi edge", 0, 1e-12, "1/sqrt(3)"},
                 worst);

  Frame square;
  for (int x = 0; x < 9; ++x)
    for (int z = 0; z < 9; ++z) square.position.emplace_back(x, 0, z);
  const VoronoiCells squares = voronoi_cells(square, open_box());
  std::size_t inside = 0;
  for (std::size_t i = 0; i < square.position.size(); ++i)
    if (squares.enclosed[i] != 0) {
      ++inside;
      EXPECT_EQ(squares.neighbours.count(i),
                4U);  // four cells meet in a point: the diagonals do not share an edge
    }
  EXPECT_EQ(inside, 49U);
}

TEST(VoronoiCells, WeightsMakeOrderContinuous) {
  // A square lattice sheared by 1e-4: its diagonals become neighbours, with a Voronoi edge as short as the
  // shear.
  Frame sheared;
  for (int x = 0; x < 9; ++x)
    for (int z = 0; z < 9; ++z) sheared.position.emplace_back(x + 1e-4 * z, 0, z);
  const VoronoiCells cells = voronoi_cells(sheared, open_box());
  const std::size_t centre = 4 * 9 + 4;
  ASSERT_EQ(cells.neighbours.count(centre), 6U);
  const double plain = bond_order(cells.neighbours).psi4[centre];
  const double weighted = bond_order(cells.neighbours, cells.edge).psi4[centre];
  // 4 bonds with exp(4 i phi) = 1, two diagonals with -1.
  test::validate(
      {"V5.1", "psi4 of a square lattice with both of one pair of diagonals", 1.0 / 3, 1e-3, "closed form"},
      plain);
  test::validate({"V5.1", "the same, bonds weighted by Voronoi edges", 1, 5e-4, "Mickel et al. 2013"},
                 weighted);
}

TEST(VoronoiCells, AreTheDelaunayTriangulationWhereBeadsAreDense) {
  // Independent of the construction: a triangle is Delaunay if no bead is inside its circumcircle.
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> place(0, 12);
  Frame frame;
  for (int i = 0; i < 220; ++i) frame.position.emplace_back(place(generator), 0, place(generator));
  const double radius = 1.1;
  std::set<std::pair<std::size_t, std::size_t>> expected;
  const std::size_t n = frame.position.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) {
        const Vec3 a = frame.position[i], b = frame.position[j] - a, c = frame.position[k] - a;
        const double twice = 2 * (b.x() * c.z() - b.z() * c.x());
        const Vec3 centre((c.z() * b.squaredNorm() - b.z() * c.squaredNorm()) / twice, 0,
                          (b.x() * c.squaredNorm() - c.x() * b.squaredNorm()) / twice);
        if (centre.norm() >= radius) continue;
        bool empty = true;
        for (std::size_t m = 0; m < n && empty; ++m)
          empty = m == i || m == j || m == k || (frame.position[m] - a - centre).norm() > centre.norm();
        if (!empty) continue;
        expected.insert({i, j});
        expected.insert({i, k});
        expected.insert({j, k});
      }
  const VoronoiCells cells = voronoi_cells(frame, open_box(), radius);
  std::set<std::pair<std::size_t, std::size_t>> got;
  for (std::size_t i = 0; i < n; ++i)
    cells.neighbours.for_each(i, [&](std::size_t j, const Vec3&) {
      if (i < j && (cells.enclosed[i] != 0 || cells.enclosed[j] != 0)) got.insert({i, j});
    });
  EXPECT_GT(got.size(), 300U);
  for (const auto& edge : got) EXPECT_TRUE(expected.contains(edge));
  for (const auto& edge : expected)
    EXPECT_TRUE(got.contains(edge) || (cells.enclosed[edge.first] == 0 && cells.enclosed[edge.second] == 0));
}

TEST(VoronoiCells, DoNotDependOnTheOrderOfBeadsOrOnThePeriod) {
  std::mt19937_64 generator(12);
  std::uniform_real_distribution<double> place(0, 10);
  Frame frame;
  for (int i = 0; i < 120; ++i) frame.position.emplace_back(place(generator), 0, place(generator));
  Box box = open_box();
  box.upper.x() = 10;
  box.boundary[0] = Boundary::periodic;
  Frame moved;
  for (auto r = frame.position.rbegin(); r != frame.position.rend(); ++r)
    moved.position.push_back(*r + Vec3(10.0 * static_cast<double>(moved.position.size() % 3) + 3.25, 0, 0));
  const VoronoiCells a = voronoi_cells(frame, box), b = voronoi_cells(moved, box);
  const std::size_t n = frame.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(a.neighbours.count(i), b.neighbours.count(n - 1 - i));
    EXPECT_EQ(a.enclosed[i], b.enclosed[n - 1 - i]);
    double edges = 0, others = 0;
    for (std::size_t e = a.neighbours.first[i]; e < a.neighbours.first[i + 1]; ++e) edges += a.edge[e];
    for (std::size_t e = b.neighbours.first[n - 1 - i]; e < b.neighbours.first[n - i]; ++e)
      others += b.edge[e];
    EXPECT_NEAR(edges, others, 1e-11);
  }
}

TEST(VoronoiCells, CoincidingAndIsolatedBeadsHaveCells) {
  const Frame frame = frame_of({Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(9, 0, 9)});
  const VoronoiCells cells = voronoi_cells(frame, open_box());
  EXPECT_EQ(cells.neighbours.count(3), 0U);
  EXPECT_EQ(cells.neighbours.count(2), 2U);
  for (const double edge : cells.edge) EXPECT_TRUE(std::isfinite(edge));
  EXPECT_TRUE(std::isnan(bond_order(cells.neighbours, cells.edge).q6[3]));
}

TEST(Orientation, CrystalsAAndB) {
  for (const auto& [degrees, name] : {std::pair{0.0, "A"}, {30.0, "B"}, {-60.0, "A"}}) {
    for (const char* rule : {"cutoff", "delaunay", "voronoi"}) {
      const auto results = analyze(film({frame_of(lattice(degrees, 0, 20, 0, 20))}),
                                   {.neighbours = neighbour_rule_named(rule)});
      const bool a = std::string(name) == "A";
      test::validate({"V5.11",
                      std::string("angle of crystal ") + name + (degrees < 0 ? " turned by -60" : "") + ", " +
                          rule + ", degrees",
                      a ? 0.0 : 30.0, 1e-9, "Fortini & Huang 2015, Fig. 2"},
                     value(results, "orientation"));
      EXPECT_EQ(value(results, "orientation_a"), a ? 1 : 0);
      EXPECT_EQ(value(results, "orientation_b"), a ? 0 : 1);
      EXPECT_EQ(value(results, "ordered_fraction"), 1);
      EXPECT_EQ(value(results, "grains"), 1);
    }
  }
}

// The angles 45 and -15 degrees are equivalent. For frames on either side of this seam, the mean must not
// become 15.
TEST(Orientation, FramesOnBothSidesOfTheSeamKeepTheirMean) {
  for (const double first : {44.9, 45.1}) {
    std::vector<Frame> frames;
    for (const double degrees : {first, 45.1, 44.9, 44.9, 45.1, 45.1, 44.9, 90 - first}) {
      std::vector<Vec3> beads = lattice(degrees, 0, 20, 0, 20);
      beads.resize(380);
      frames.push_back(frame_of(beads));
    }
    const Result orientation = find_result(analyze(film(frames)), "orientation");
    EXPECT_NEAR(misorientation(orientation.value(), 45), 0, 1e-9);
    EXPECT_GE(orientation.value(), -15);
    EXPECT_LT(orientation.value(), 45);
    ASSERT_TRUE(orientation.interval);
    EXPECT_LE(orientation.interval->low, orientation.value());
    EXPECT_GE(orientation.interval->high, orientation.value());
    EXPECT_LT(orientation.interval->high - orientation.interval->low, 1);
  }
}

// Disordered points have ordered beads by chance, in directions that cancel.
TEST(Orientation, OfPointsWithoutOrderIsAbsent) {
  constexpr int kRuns = 40, kFrames = 40, kPoints = 60;
  int present = 0;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> place(0, 20);
  for (int run = 0; run < kRuns; ++run) {
    std::vector<Frame> frames;
    for (int f = 0; f < kFrames; ++f) {
      std::vector<Vec3> points;
      for (int i = 0; i < kPoints; ++i) points.emplace_back(place(random), 0, place(random));
      frames.push_back(frame_of(points));
    }
    const auto results = analyze(film(frames), {.only = {"orientation", "orientation_a"}});
    const Result& orientation = find_result(results, "orientation");
    EXPECT_TRUE(find_result(results, "orientation_a").present());
    present += orientation.present() ? 1 : 0;
    if (!orientation.present()) {
      EXPECT_NE(orientation.absent.find("no common direction"), std::string::npos) << orientation.absent;
    }
    const auto one = analyze(film({frames.front()}), {.only = {"orientation"}});
    EXPECT_FALSE(find_result(one, "orientation").present()) << "one frame";
  }
  EXPECT_LE(present, 1) << "0.1 % of runs are expected";
}

// The interval of a lattice whose direction scatters from frame to frame contains the direction.
TEST(Orientation, OfScatteredLatticesHasTheIntervalOfItsDirection) {
  constexpr int kRuns = 100;
  int of = 0, held = 0;
  std::mt19937_64 random(9);
  std::normal_distribution<double> turn(40, 6);  // across the seam at 45
  for (int run = 0; run < kRuns; ++run) {
    std::vector<Frame> frames;
    for (int f = 0; f < 40; ++f) frames.push_back(frame_of(lattice(turn(random), 0, 8, 0, 8)));
    for (Frame& frame : frames) frame.position.resize(45, Vec3::Constant(std::nan("")));
    const Result r = find_result(analyze(film(frames), {.only = {"orientation"}}), "orientation");
    ASSERT_TRUE(r.present() && r.interval) << r.absent << r.no_interval;
    EXPECT_LT(r.interval->high - r.interval->low, 15);
    const double centre = (r.interval->low + r.interval->high) / 2, half = r.interval->high - centre;
    ++of;
    held += misorientation(40, centre) <= half ? 1 : 0;
  }
  EXPECT_NEAR(100.0 * held / of, 95, 6);
}

TEST(Orientation, ALatticeTurnedByTheWidthIsWithinIt) {
  EXPECT_EQ(value(analyze(film({frame_of(lattice(-10, 0, 20, 0, 20))})), "orientation_a"), 1);
  EXPECT_EQ(value(analyze(film({frame_of(lattice(20, 0, 20, 0, 20))})), "orientation_b"), 1);
}

TEST(Orientation, LatticesLyingAnyhowAreAThirdEach) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> angle(0, 360);
  double a = 0, b = 0;
  const int samples = 3000;
  for (int s = 0; s < samples; ++s) {
    const double theta = angle(generator);
    const double lattice = lattice_angle(std::cos(6 * theta * kPi / 180), std::sin(6 * theta * kPi / 180));
    EXPECT_GE(lattice, -15);
    EXPECT_LT(lattice, 45);
    EXPECT_NEAR(misorientation(lattice, theta), 0, 1e-9);
    a += misorientation(lattice, 0) <= kOrientationWidth ? 1 : 0;
    b += misorientation(lattice, 30) <= kOrientationWidth ? 1 : 0;
  }
  EXPECT_NEAR(a / samples, 1.0 / 3, 0.03);
  EXPECT_NEAR(b / samples, 1.0 / 3, 0.03);
}

TEST(Defects, PerfectCrystalHasNoneAtWallsEither) {
  for (const double degrees : {0.0, 30.0, 17.0}) {
    const Defects d = find_defects(voronoi_cells(frame_of(lattice(degrees, 0, 20, 0, 20)), open_box()));
    EXPECT_GT(d.bulk, 330U);
    EXPECT_EQ(d.five + d.seven + d.other + d.dislocations + d.holes, 0U) << degrees;
  }
}

TEST(Defects, AMissingBeadIsAHole) {
  std::vector<Vec3> beads = lattice(0, 0, 20, 0, 20);
  const Defects before = find_defects(voronoi_cells(frame_of(beads), open_box()));
  const auto centre = std::min_element(beads.begin(), beads.end(), [](const Vec3& a, const Vec3& b) {
    return (a - Vec3(10, 0, 10)).norm() < (b - Vec3(10, 0, 10)).norm();
  });
  beads.erase(centre);
  const Defects d = find_defects(voronoi_cells(frame_of(beads), open_box()));
  EXPECT_EQ(d.holes, 1U);
  EXPECT_EQ(d.five + d.seven + d.other, 0U);
  EXPECT_EQ(before.bulk - d.bulk, 7U);  // the bead and its six neighbours, which are now at a surface
}

TEST(Defects, ADislocationIsAFiveAndASeven) {
  // The extra half row ends at the core: one bead there has 5 neighbours, the adjacent bead has 7.
  const Frame frame = frame_of(dislocated(lattice(0, 0, 20, 0, 20), Vec3(10.25, 0, 10 + 0.25 * kRow)));
  const VoronoiCells cells = voronoi_cells(frame, open_box());
  const Defects d = find_defects(cells);
  test::validate({"V5.12", "one dislocation: 5-fold beads", 1, 0, "Nelson & Halperin 1979"},
                 static_cast<double>(d.five));
  test::validate({"V5.12", "one dislocation: 7-fold beads", 1, 0, "Nelson & Halperin 1979"},
                 static_cast<double>(d.seven));
  EXPECT_EQ(d.dislocations, 1U);
  EXPECT_EQ(d.other + d.holes, 0U);
  const auto results = analyze(film({frame}));
  EXPECT_EQ(value(results, "free_disclinations"), 0);
  EXPECT_NEAR(value(results, "defect_fraction"), 2.0 / static_cast<double>(d.bulk), 1e-15);
}

TEST(Defects, AFreeDisclinationHasNoPartner) {
  // Five wedges of 60 degrees around one bead, stretched to 72: a 5-fold disclination in an otherwise 6-fold
  // sheet.
  Frame frame;
  frame.position.emplace_back(10, 0, 10);
  for (int ring = 1; ring <= 7; ++ring)
    for (int wedge = 0; wedge < 5; ++wedge)
      for (int k = 0; k < ring; ++k) {
        const double x = ring - 0.5 * k, z = kRow * k;  // along the wedge's far side
        const double radius = std::hypot(x, z), angle = std::atan2(z, x) * 6 / 5 + wedge * 2 * kPi / 5;
        frame.position.emplace_back(10 + radius * std::cos(angle), 0, 10 + radius * std::sin(angle));
      }
  const Defects d = find_defects(voronoi_cells(frame, open_box(), 1.2));
  EXPECT_EQ(d.five, 1U);
  EXPECT_EQ(d.seven + d.other + d.dislocations, 0U);
  EXPECT_EQ(d.coordination[0], 5U);
}

TEST(Defects, PairsAreAsManyAsCanBeMade) {
  // A constructed chain 7 - 5 - 7 - 5: greedy pairing from the middle would give one pair; the maximum is
  // two.
  VoronoiCells cells;
  const std::vector<std::vector<std::size_t>> beside = {{1}, {0, 2}, {1, 3}, {2}};
  const std::vector<std::size_t> wanted = {7, 5, 7, 5};
  const std::size_t extra = 4;  // beads that only complete the neighbour counts
  cells.neighbours.first = {0};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    std::vector<std::size_t> list = beside[i];
    while (list.size() < wanted[i]) list.push_back(extra);
    for (const std::size_t j : list) {
      cells.neighbours.index.push_back(j);
      cells.neighbours.bond.emplace_back(1, 0, 0);
    }
    cells.neighbours.first.push_back(cells.neighbours.index.size());
  }
  cells.neighbours.first.push_back(cells.neighbours.index.size());
  cells.edge.assign(cells.neighbours.index.size(), 1);
  cells.open_left.assign(cells.neighbours.index.size(), 0);
  cells.enclosed = {1, 1, 1, 1, 0};
  EXPECT_EQ(find_defects(cells).dislocations, 2U);
}

TEST(Grains, TwoGrainsOfKnownMisorientation) {
  for (const double degrees : {12.0, 20.0, 30.0}) {
    std::vector<Vec3> beads = lattice(0, 0, 10, 0, 20);
    for (const Vec3& r : lattice(degrees, 10.0, 20, 0, 20))
      if (std::none_of(beads.begin(), beads.end(), [&](const Vec3& b) { return (b - r).norm() < 0.8; }))
        beads.push_back(r);
    const Frame frame = frame_of(beads);
    const VoronoiCells cells = voronoi_cells(frame, open_box());
    const Grains grains = find_grains(bond_order(cells.neighbours, cells.edge), cells);
    ASSERT_EQ(grains.beads.size(), 2U) << degrees;
    test::validate({"V5.13", "misorientation of two grains, degrees", degrees, 0.5, "by construction"},
                   misorientation(grains.angle[0], grains.angle[1]));
    EXPECT_GT(grains.beads[1], 0.4 * static_cast<double>(beads.size()));
    const auto results = analyze(film({frame}), {.neighbours = NeighbourRule::voronoi});
    EXPECT_NEAR(value(results, "grain_boundary_angle"), degrees, 0.5);
    EXPECT_EQ(value(results, "grains"), 2);
    // One line of beads on each side of a boundary 20 long, out of 20 x 20.
    EXPECT_NEAR(value(results, "grain_boundary_fraction"), 2.0 / 20, 0.035);
    EXPECT_GE(value(results, "dislocations"), 3) << degrees;
  }
}

namespace {

/// Beads of a 20 x 20 box, repeatedly displaced by the same field and recorded at the beginnings of cycles.
template <class Field>
MemoryTrajectory carried(const Field& field, int cycles, double noise = 0) {
  std::mt19937_64 generator(9);
  std::normal_distribution<double> shake(0, noise > 0 ? noise : 1);
  Box box;
  box.lower = Vec3(0, -0.5, 0);
  box.upper = Vec3(20, 0.5, 20);
  Frame frame;
  // Each cell of side 2 contains four beads at positions symmetric in the cell: their mean is the field at
  // its centre.
  for (int x = 0; x < 20; ++x)
    for (int z = 0; z < 20; ++z) frame.position.emplace_back(x + 0.5, 0, z + 0.5);
  const std::vector<Vec3> home = frame.position;
  std::vector<Frame> frames;
  for (int j = 0; j <= 2 * cycles; ++j) {
    // Every second step returns the beads to their initial positions. The cycle number jumps there, so the
    // return does not count as a displacement.
    frame.phase = 0;
    frame.cycle = j + j / 2;
    frame.step = j;
    for (std::size_t i = 0; i < home.size(); ++i) {
      const Vec3 u = field(home[i]);
      frame.position[i] = home[i] + (j % 2 == 0 ? -0.5 : 0.5) * u;
      if (noise > 0) frame.position[i] += Vec3(shake(generator), 0, shake(generator));
    }
    frames.push_back(frame);
  }
  return film(frames, box);
}

}  // namespace

TEST(Convection, SolidRotationHasTheCirculationOfItsRectangle) {
  const double omega = 0.01;
  const auto trajectory =
      carried([&](const Vec3& r) { return Vec3(-omega * (r.z() - 10), 0, omega * (r.x() - 10)); }, 12);
  const auto results = analyze(trajectory);
  // 2 omega times the area inside the outermost centres, 18 x 18; half of it on each side.
  test::validate({"V5.14", "circulation of solid rotation, left half", 2 * omega * 18 * 9, 1e-10, "Stokes"},
                 value(results, "circulation_left"));
  test::validate({"V5.14", "circulation of solid rotation, right half", 2 * omega * 18 * 9, 1e-10, "Stokes"},
                 value(results, "circulation_right"));
  EXPECT_EQ(value(results, "rolls"), 1);
  EXPECT_EQ(find_result(results, "convection_sense").text, "one sense, counter-clockwise");
  EXPECT_EQ(find_result(results, "displacement_field").shape, (std::vector<std::size_t>{10, 10, 2}));
  EXPECT_EQ(find_result(results, "field_x").values.front(), 1);
}

TEST(Convection, RollsOfAStreamFunction) {
  // u = (-d psi/dz, d psi/dx), psi = -a sin(pi m x/L) sin(pi z/L): m rolls side by side with alternating
  // signs. For a > 0 the first rotates counter-clockwise: down at the left wall.
  const double L = 20, a = 0.3;
  for (const int m : {1, 2, 4}) {
    const auto psi_flow = [&](const Vec3& r) {
      const double kx = kPi * m / L, kz = kPi / L;
      return Vec3(a * kz * std::sin(kx * r.x()) * std::cos(kz * r.z()), 0,
                  -a * kx * std::cos(kx * r.x()) * std::sin(kz * r.z()));
    };
    const auto results = analyze(carried(psi_flow, 12, 0.01));
    EXPECT_EQ(value(results, "rolls"), m);
    if (m != 2) continue;
    EXPECT_EQ(find_result(results, "convection_sense").text, "down at the walls, up in the middle");
    const Result& left = find_result(results, "circulation_left");
    ASSERT_TRUE(left.interval);
    EXPECT_GT(left.interval->low, 0);
    // The line integral round the loop through the outermost centres and along half of the middle one, in
    // closed form from the cell means (a cell mean is the field at its four beads).
    EXPECT_NEAR(left.value() + value(results, "circulation_right"), 0,
                3 * (left.interval->high - left.value()));
    const auto mirrored = analyze(carried([&](const Vec3& r) { return Vec3(-psi_flow(r)); }, 12, 0.01));
    EXPECT_EQ(find_result(mirrored, "convection_sense").text, "up at the walls, down in the middle");
  }
}

TEST(Convection, AHalfWithoutCellsHasNoCirculation) {
  // Solid rotation by 0.1, with data in the left three of six columns.
  DisplacementField field;
  field.columns = 6, field.rows = 2, field.dx = field.dz = 2;
  for (std::size_t r = 0; r < 2; ++r)
    for (std::size_t k = 0; k < 6; ++k) {
      field.ux.push_back(k < 3 ? -0.1 * 2 * static_cast<double>(r) : std::nan(""));
      field.uz.push_back(k < 3 ? 0.1 * 2 * static_cast<double>(k) : std::nan(""));
    }
  const Circulation c = circulation_of(field);
  EXPECT_NEAR(c.left, 2 * 0.1 * 2 * 4, 1e-12);  // Stokes: twice the rate times the area of two loops
  EXPECT_TRUE(std::isnan(c.right));
}

TEST(Convection, NoiseHasNoRolls) {
  const auto results = analyze(carried([](const Vec3&) { return Vec3(0, 0, 0); }, 16, 0.05));
  EXPECT_EQ(value(results, "rolls"), 0);
  EXPECT_EQ(find_result(results, "convection_sense").text, "none");
}

TEST(Convection, TooFewCyclesAreReported) {
  const auto one = analyze(carried([](const Vec3&) { return Vec3(0.1, 0, 0); }, 2));
  EXPECT_TRUE(find_result(one, "displacement_field").present());
  EXPECT_NE(find_result(one, "rolls").absent.find("blocks"), std::string::npos);
  // One displacement of each bead: no cell has five displacements, and without cells there is no circulation.
  const auto two = analyze(carried([](const Vec3&) { return Vec3(0.1, 0, 0); }, 1));
  EXPECT_FALSE(find_result(two, "circulation_left").present());
  EXPECT_FALSE(find_result(two, "circulation_right").present());
  Frame still = frame_of(lattice(0, 0, 20, 0, 20));
  EXPECT_EQ(find_result(analyze(film({still})), "displacement_field").absent,
            "the frames have no cycle number");
}

TEST(Profiles, OverlapIsExact) {
  test::validate({"V5.15", "disc of radius 1/2 below its centre", kPi / 8, 1e-15, "pi/8"},
                 disc_below(0.5, 0));
  // Circular segment of half-angle 60 degrees: R^2 (pi/3 - sqrt(3)/4).
  test::validate({"V5.15", "disc of radius 2 below half a radius under its centre",
                  4 * (kPi / 3 - std::sqrt(3.0) / 4), 1e-14, "circular segment"},
                 disc_below(2, -1));
  test::validate({"V5.15", "sphere of radius 2 below half a radius under its centre",
                  kPi * 1 * (3 * 2 - 1) / 3, 1e-14, "spherical cap"},
                 sphere_below(2, -1));
  EXPECT_EQ(disc_below(0.5, -0.6), 0);
  EXPECT_NEAR(sphere_below(0.5, 0.6), kPi / 6, 1e-15);
}

TEST(Profiles, PackingAndTemperatureOfKnownBeds) {
  // Touching discs in a square lattice, shifted by z0: a slab has packing fraction pi/4 at any position.
  std::mt19937_64 generator(8);
  std::normal_distribution<double> thermal(0, 1);
  std::vector<Frame> frames;
  Box box;
  box.upper = Vec3(10, 1, 30);
  for (int f = 0; f < 400; ++f) {
    Frame frame;
    frame.step = f;
    for (int x = 0; x < 10; ++x)
      for (int z = 0; z < 10; ++z) {
        frame.position.emplace_back(x + 0.5, 0, z + 0.8);
        // Variance (1 + z)/10 about a mean velocity of the slab, which must cancel.
        frame.velocity.emplace_back(3, 0, z + std::sqrt((1.0 + z) / 10) * thermal(generator));
      }
    frames.push_back(frame);
  }
  const auto results = analyze(film(frames, box));
  const Result& phi = find_result(results, "phi_z");
  const Result& t = find_result(results, "T_z_z");
  ASSERT_EQ(phi.values.size(), 11U);
  double total = 0;
  for (std::size_t k = 0; k < 11; ++k) {
    total += phi.values[k] * 10;
    if (k == 10) continue;
    if (k > 0) {
      EXPECT_NEAR(phi.values[k], kPi / 4, 1e-12);
    }
    // The variance of 4000 velocities has a relative error of 0.022.
    EXPECT_NEAR(t.values[k] / ((1.0 + static_cast<double>(k)) / 10), 1, 0.09);
  }
  test::validate({"V5.15", "area of 100 discs in the profile", 25 * kPi, 1e-10, "100 pi/4"}, total);
  EXPECT_TRUE(std::isnan(t.values[10]));  // discs extend into the slab, but no centre is in it
  EXPECT_NEAR(find_result(results, "T_x_z").values[3], 0, 1e-12);
}

// A square lattice of discs drifts through a period of 10.4 along z, in which no slab of thickness 1 fits
// evenly.
TEST(Profiles, AlongAPeriodAreThoseOfTheCell) {
  std::vector<Frame> frames;
  Box box;
  box.upper = Vec3(10, 1, 10.4);
  box.boundary = {Boundary::periodic, Boundary::open, Boundary::periodic};
  for (int f = 0; f < 520; ++f) {
    Frame frame;
    frame.step = f;
    for (int x = 0; x < 10; ++x)
      for (int z = 0; z < 8; ++z) {
        frame.position.emplace_back(x, 0, 1.3 * z + 0.21 * f);
        frame.velocity.emplace_back(0, 0, f % 2 == 0 ? 1 : -1);
      }
    frames.push_back(frame);
  }
  const auto results = analyze(film(frames, box));
  const Result &z = find_result(results, "profile_z"), &phi = find_result(results, "phi_z");
  ASSERT_EQ(phi.values.size(), 10U);
  EXPECT_NEAR(z.values.front(), 0.52, 1e-12);
  EXPECT_NEAR(z.values.back(), 10.4 - 0.52, 1e-12);
  for (const double each : phi.values) EXPECT_NEAR(each, 80 * kPi / 4 / 104, 2e-3);
  for (const double t : find_result(results, "T_z_z").values) EXPECT_NEAR(t, 1, 0.01);
  EXPECT_FALSE(find_result(results, "phi_top").present());
  EXPECT_NE(find_result(results, "phi_top").absent.find("periodic along z"), std::string::npos);
}

TEST(Profiles, ASlabThatIsEmptyHalfOfTheTimeHasHalfTheTemperatureOverFrames) {
  // Two beads separate at speed 2 relative to their centre of mass, which itself moves.
  std::vector<Frame> frames;
  Box box;
  box.upper = Vec3(10, 1, 30);
  for (int f = 0; f < 400; ++f) {
    Frame frame;
    frame.step = f;
    frame.position = {Vec3(3, 0, 0.5), Vec3(3, 0, f % 2 == 0 ? 5.5 : 7.5)};
    frame.velocity = {Vec3(0, 0, 5 - 2), Vec3(0, 0, 5 + 2)};
    frames.push_back(frame);
  }
  const auto results = analyze(film(frames, box));
  const Result &z = find_result(results, "profile_z"), &over = find_result(results, "T_z_frames_z");
  ASSERT_EQ(z.values, (std::vector<double>{0.5, 5.5, 7.5}));
  EXPECT_NEAR(over.values[0], 4, 1e-12);
  EXPECT_NEAR(over.values[1], 2, 1e-12);
  EXPECT_NEAR(over.values[2], 2, 1e-12);
  // There are no fluctuations about the mean of the slab.
  for (const double t : find_result(results, "T_z_z").values) EXPECT_NEAR(t, 0, 1e-12);
  for (const double t : find_result(results, "T_z_instant_z").values) EXPECT_EQ(t, 0);
}

TEST(Profiles, TheTemperatureOfTheInstantLeavesOutTheCommonMotionOfASlab) {
  // Beads of mass 1 with w = c + 1 and c - 1 in the lowest slab, where c = +-3 by frames; a third bead is
  // alone in its slab in half of the frames, and with another one at w + 4 in the others.
  std::vector<Frame> frames;
  Box box;
  box.upper = Vec3(10, 1, 30);
  for (int f = 0; f < 400; ++f) {
    const double c = f % 2 == 0 ? 3 : -3;
    Frame frame;
    frame.step = f;
    frame.position = {Vec3(2, 0, 0.5), Vec3(4, 0, 0.5), Vec3(3, 0, 5.5), Vec3(5, 0, c > 0 ? 5.5 : 7.5)};
    frame.velocity = {Vec3(0, 0, c + 1), Vec3(0, 0, c - 1), Vec3(0, 0, c), Vec3(0, 0, c + 4)};
    frames.push_back(frame);
  }
  const auto results = analyze(film(frames, box));
  ASSERT_EQ(find_result(results, "profile_z").values, (std::vector<double>{0.5, 5.5, 7.5}));
  const Result& t = find_result(results, "T_z_instant_z");
  test::validate({"V5.15", "T_z of the instant, two beads at +-1 about their mean", 1, 1e-12, "(1 + 1)/2"},
                 t.values[0]);
  test::validate({"V5.15", "T_z of the instant, two beads at +-2 in half of the frames", 2, 1e-12, "4/2"},
                 t.values[1]);
  EXPECT_EQ(t.values[2], 0);
  EXPECT_NEAR(find_result(results, "T_z_z").values[0], 10, 1e-12);  // with the variance 9 of c
}

}  // namespace twincell::spatial_order_test
