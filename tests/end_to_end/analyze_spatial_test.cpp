// Spatial observables and figures of `analyze`, as a user requests them.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rigid_bed.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::analyze_spatial_test {
namespace {

std::string film(const std::filesystem::path& path) {
  const test::RigidBed bed{.gamma = 1.5, .columns = 10, .rows = 12, .cycles = 8};
  const TrajectoryInfo info = test::rigid_bed_info(bed);
  H5mdWriter writer(path, info);
  test::film_rigid_bed(bed, info, writer);
  writer.finish();
  return path.string();
}

}  // namespace

TEST(AnalyzeSpatial, OrderByEveryRule) {
  const TemporaryFolder folder;
  const std::string file = film(folder / "bed.h5");
  for (const char* rule : {"cutoff", "delaunay", "voronoi"}) {
    const Ran ran = run_program({"analyze", file, "-q", "--json", "--neighbours", rule});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const auto results = nlohmann::json::parse(ran.out)["results"];
    EXPECT_NEAR(results["psi6"]["value"], 1, 1e-9) << rule;
    EXPECT_NEAR(results["orientation"]["value"], 0, 1e-9) << rule;
    EXPECT_EQ(results["orientation_a"]["value"], 1) << rule;
    EXPECT_EQ(results["grains"]["value"], 1) << rule;
    EXPECT_EQ(results["dislocations"]["value"], 0) << rule;
    EXPECT_EQ(results["defect_fraction_j"]["value"].size(), 8U);
    EXPECT_EQ(results["coordination_beads"]["shape"][0], 114);
  }
}

TEST(AnalyzeSpatial, EveryNumberHasAnIntervalOrSaysWhyNot) {
  const TemporaryFolder folder;
  const Ran ran = run_program({"analyze", film(folder / "bed.h5"), "-q", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto results = nlohmann::json::parse(ran.out)["results"];
  int numbers = 0;
  for (const auto& [name, r] : results.items()) {
    if (!r.contains("value") || r["value"].is_string()) continue;
    ++numbers;
    EXPECT_NE(r.contains("interval"), r.contains("no_interval")) << name;
    if (r.contains("no_interval")) {
      EXPECT_FALSE(r["no_interval"].get<std::string>().empty()) << name;
    }
  }
  EXPECT_GT(numbers, 30);
}

TEST(AnalyzeSpatial, FiguresAppearTogether) {
  const TemporaryFolder folder;
  const std::string file = film(folder / "bed.h5");
  const Ran ran = run_program({"analyze", file, "-q", "--figures", folder / "figures"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  std::vector<std::string> expected;
  for (const char* name : {"convection_field", "defect_evolution", "lattice", "profiles"})
    for (const char* ending : {".dat", ".gp", ".pdf", ".png", ".svg"})
      expected.push_back(std::string(name) + ending);
  expected.emplace_back("twincell-manifest.json");
  EXPECT_EQ(names_in(folder / "figures"), expected);
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"bed.h5", "figures"}));
  EXPECT_EQ(read_text_file(folder / "figures/lattice.svg").find("nan"), std::string::npos);
}

TEST(AnalyzeSpatial, Refusals) {
  const TemporaryFolder folder;
  const std::string file = film(folder / "bed.h5");
  EXPECT_EQ(run_program({"analyze", file, "-q", "--neighbours", "nearest"}).code, 2);
  EXPECT_EQ(run_program({"analyze", file, "-q", "--field-cell", "0"}).code, 2);
  EXPECT_EQ(run_program({"analyze", file, "-q", "--figures", folder / "no/figures"}).code, 2);
  const Ran radius = run_program({"analyze", file, "-q", "--cell-radius", "-1"});
  EXPECT_EQ(radius.code, 2);
  EXPECT_NE(radius.err.find("cell_radius"), std::string::npos) << radius.err;
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"bed.h5"}));
}

}  // namespace twincell::analyze_spatial_test
