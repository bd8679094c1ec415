// Data passed to the interactive page, read back as JSON.
#include "analysis/report/report_data.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace twincell::analysis::report_data_test {
namespace {

Run bare(const std::string& name) {
  Run run;
  run.name = name;
  run.box.lower = Vec3(0, -0.5, 0);
  run.box.upper = Vec3(10, 0.5, 20);
  return run;
}

nlohmann::json told(const Run& run) {
  Comparison c;
  c.runs = {run};
  return nlohmann::json::parse(report_data(c))["runs"][0];
}

}  // namespace

TEST(ReportData, MomentsInThousandthsAndAbsentBeadsAsNull) {
  auto run = bare("</script><b>");
  run.phases_per_cycle = 20;
  Snapshot snapshot;
  snapshot.frame.cycle = 3;
  snapshot.frame.phase = 5;
  snapshot.frame.position = {Vec3(1.23456, 0, 2), Vec3(NAN, NAN, NAN)};
  snapshot.frame.id = {0, -1};
  snapshot.order = {.q6 = {0.7408, NAN}, .psi6 = {1, NAN}, .psi4 = {0, NAN}, .n_bonds = {6, 0}};
  snapshot.plate = 0.5;
  run.show.snapshots = {snapshot};
  run.show.pictures = {"Man"};
  run.show.camera =
      PictureFrame{.pixels_per_sigma = 12, .origin_x = 20, .origin_y = 230, .width = 160, .height = 300};
  Comparison c;
  c.runs = {run};
  EXPECT_EQ(report_data(c).find("</script"), std::string::npos);
  const auto j = told(run), m = j["moments"][0];
  EXPECT_EQ(j["name"], "</script><b>");
  EXPECT_EQ(m["label"], "cycle 3, phase 5/20");
  EXPECT_EQ(m["fraction"], 0.25);
  EXPECT_EQ(m["x"], nlohmann::json::parse("[1235, null]"));
  EXPECT_EQ(m["q6"], nlohmann::json::parse("[74, -1]"));
  EXPECT_EQ(m["structure"], nlohmann::json::parse("[1, 0]"));
  EXPECT_EQ(m["picture"], "data:image/png;base64,TWFu");  // example of RFC 4648
  EXPECT_EQ(j["camera"]["s"], 12);
}

TEST(ReportData, Base64PadsAsRfc4648Says) {
  for (const auto& [bytes, text] : {std::pair<std::string, std::string>{"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="}}) {
    auto run = bare("a");
    run.show.snapshots = {Snapshot{}};
    run.show.pictures = {bytes};
    EXPECT_EQ(told(run)["moments"][0]["picture"], "data:image/png;base64," + text);
  }
}

TEST(ReportData, TheConvectionFieldWithItsExtent) {
  auto run = bare("a");
  EXPECT_TRUE(told(run)["convection"].is_null());
  Result field{.name = "displacement_field", .values = {1, 2, 3, 4, NAN, NAN}, .shape = {1, 3, 2}};
  Result x{.name = "field_x", .values = {0.5, 1.5, 2.5}, .shape = {3}},
      z{.name = "field_z", .values = {4}, .shape = {1}};
  run.results = {field, x, z};
  const auto c = told(run)["convection"];
  EXPECT_EQ(c["extent"], nlohmann::json::parse("[0.0, 3.0, 3.5, 4.5]"));
  EXPECT_EQ(c["u"], nlohmann::json::parse("[1.0, 3.0, null]"));
  EXPECT_EQ(c["w"], nlohmann::json::parse("[2.0, 4.0, null]"));
  EXPECT_FALSE(told(run)["results"].contains("displacement_field"));
}

}  // namespace twincell::analysis::report_data_test
