// `analyze` and `compare` as a user runs them, on beds with known s_b and s_c.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "core/hdf5.hpp"
#include "tests/support/program.hpp"
#include "tests/support/rigid_bed.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::analyze_and_compare_test {
namespace {

namespace fs = std::filesystem;

std::string film(const fs::path& path, const test::RigidBed& bed) {
  const TrajectoryInfo info = test::rigid_bed_info(bed);
  H5mdWriter writer(path, info);
  test::film_rigid_bed(bed, info, writer);
  writer.finish();
  return path.string();
}

test::RigidBed bed(double gamma, double shear, Origin source) {
  return {.gamma = gamma,
          .columns = 10,
          .rows = 6,
          .cycles = 8,
          .shear_per_cycle = shear,
          .velocities = source == Origin::simulation,
          .source = source};
}

int files_called(const fs::path& folder, const std::string& ending) {
  int n = 0;
  for (const auto& entry : fs::directory_iterator(folder)) n += entry.path().extension() == ending ? 1 : 0;
  return n;
}

/// True if every opened element is closed in order, attributes are quoted and no ampersand is bare. This is
/// enough to reject a broken drawing.
bool well_formed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] == '&') {
      const auto end = xml.find(';', i);
      if (end == std::string::npos || end - i > 8) return false;
    }
    if (xml[i] == '>') return false;
    if (xml[i] != '<') continue;
    if (xml.compare(i, 4, "<!--") == 0) {
      i = xml.find("-->", i);
      if (i == std::string::npos) return false;
      i += 2;
      continue;
    }
    std::size_t j = i + 1;
    char quote = 0;
    for (; j < xml.size() && (quote != 0 || xml[j] != '>'); ++j) {
      if (quote != 0 && xml[j] == quote)
        quote = 0;
      else if (quote == 0 && (xml[j] == '"' || xml[j] == '\''))
        quote = xml[j];
      else if (xml[j] == '<')
        return false;
    }
    if (j == xml.size()) return false;
    const std::string tag = xml.substr(i + 1, j - i - 1);
    const std::string name = tag.substr(tag.front() == '/' ? 1 : 0,
                                        tag.find_first_of(" \t\n/>", 1) - (tag.front() == '/' ? 1 : 0));
    if (tag.front() == '/') {
      if (open.empty() || open.back() != name) return false;
      open.pop_back();
    } else if (tag.front() != '?' && tag.front() != '!' && tag.back() != '/') {
      open.push_back(name);
    }
    i = j;
  }
  return open.empty();
}

/// Every difference is the sum of the camera's contribution and the remainder. The camera's contribution to
/// s_b is small: beads filmed at 15 px each are located to a hundredth of a bead.
void check_parts(const nlohmann::json& differences) {
  int filmed = 0;
  for (const auto& d : differences) {
    const double e = d["experiment"]["value"], s = d["simulation"]["value"];
    EXPECT_NEAR(d["difference"].get<double>(), e - s, 1e-9);
    if (d["camera"].is_null()) continue;
    EXPECT_NEAR(d["camera"].get<double>() + d["remainder"].get<double>(), e - s, 1e-9);
    if (d["number"] != "s_b") continue;
    ++filmed;
    EXPECT_LT(std::abs(d["camera"].get<double>()), 0.01) << d;
    EXPECT_FALSE(d["tracers"].is_null());
  }
  EXPECT_EQ(filmed, 3);
}

}  // namespace

TEST(Analyze, TextJsonAndFileSayTheSame) {
  const TemporaryFolder folder;
  const std::string file = film(folder / "sim.h5", bed(1.5, 0, Origin::simulation));
  const Ran text = run_program({"analyze", file});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_EQ(text.err, "");
  EXPECT_EQ(run_program({"analyze", file, "-q"}).out, "");
  EXPECT_NE(text.out.find("bouncing"), std::string::npos);

  const Ran json = run_program({"analyze", file, "--json", "-q", "-o", folder / "results.h5"});
  ASSERT_EQ(json.code, 0) << json.err;
  const auto document = nlohmann::json::parse(json.out);
  const double s_b = document["results"]["s_b"]["value"];
  std::cout << "s_b at Gamma 1.5 with 20 phases: " << s_b << " (0.2935 with infinitely many)\n";
  EXPECT_NEAR(s_b, 0.2935, 0.01);
  EXPECT_EQ(document["results"]["phase"]["value"], "bouncing");
  EXPECT_EQ(document["results"]["s_k"]["value"].size(), 20U);
  EXPECT_EQ(document["results"]["s_j"]["value"].size(), 8U);
  EXPECT_EQ(document["provenance"]["inputs"].size(), 1U);

  h5::quiet();
  const h5::Handle h5file =
      h5::own(H5Fopen((folder / "results.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "opening");
  double stored = 0;
  ASSERT_TRUE(h5::read_scalar(h5file.get(), "results/s_b/value", stored));
  EXPECT_EQ(stored, s_b);
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"results.h5", "sim.h5"}));
}

TEST(Analyze, AbsentIsSaidInJson) {
  const TemporaryFolder folder;
  const std::string file = film(folder / "exp.h5", bed(1.5, 0, Origin::experiment));
  const Ran ran = run_program({"analyze", file, "--json", "-q", "--only", "T_g,s_c"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto results = nlohmann::json::parse(ran.out)["results"];
  EXPECT_EQ(results.size(), 2U);
  EXPECT_TRUE(results["T_g"].contains("absent"));
  EXPECT_FALSE(results["T_g"].contains("value"));
}

TEST(Analyze, Refusals) {
  const TemporaryFolder folder;
  const std::string file = film(folder / "sim.h5", bed(1.5, 0, Origin::simulation));
  EXPECT_EQ(run_program({"analyze", folder / "no.h5", "-q"}).code, 3);
  EXPECT_EQ(run_program({"analyze", file, "-q", "--only", "s_d"}).code, 2);
  const Ran unread = run_program({"analyze", file, "-q", "--only", "q6", "--s-b", "as_printed"});
  EXPECT_EQ(unread.code, 2);
  EXPECT_NE(unread.err.find("s_b: no requested result depends on it; s_k, s_b,"), std::string::npos)
      << unread.err;
  EXPECT_EQ(run_program({"analyze", file, "-q", "--discard", "8"}).code, 2);
  EXPECT_EQ(run_program({"analyze", file, "-q", "-o", folder / "no/r.h5"}).code, 2);
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"sim.h5"}));
}

TEST(Compare, OneReportWithEverythingInIt) {
  const TemporaryFolder folder;
  std::vector<std::string> words = {"compare", "-q", "--json", "-o", folder / "report", "--experiment"};
  words.push_back(film(folder / "exp_a<&>.h5", bed(1.10, 0, Origin::experiment)));
  words.push_back(film(folder / "exp_b.h5", bed(1.50, 0, Origin::experiment)));
  words.push_back(film(folder / "exp_c.h5", bed(2.00, 0.2, Origin::experiment)));
  words.emplace_back("--simulation");
  words.push_back(film(folder / "sim_a.h5", bed(1.105, 0, Origin::simulation)));
  words.push_back(film(folder / "sim_b.h5", bed(1.505, 0, Origin::simulation)));
  words.push_back(film(folder / "sim_c.h5", bed(2.00, 0, Origin::simulation)));
  const Ran ran = run_program(words);
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto document = nlohmann::json::parse(ran.out);
  ASSERT_EQ(document["matches"].size(), 3U);
  EXPECT_EQ(document["matches"][0]["verdict"], "same");
  EXPECT_EQ(document["matches"][0]["simulations"][0]["phase"], "co-moving");
  EXPECT_EQ(document["matches"][1]["verdict"], "same");
  EXPECT_EQ(document["matches"][1]["experiments"][0]["phase"], "bouncing");
  EXPECT_EQ(document["matches"][2]["verdict"], "differ");
  EXPECT_EQ(document["matches"][2]["experiments"][0]["phase"], "convecting");
  EXPECT_TRUE(document["notes"].empty()) << document["notes"];
  check_parts(document["differences"]);

  const fs::path report = folder / "report";
  EXPECT_EQ(names_in(report),
            (std::vector<std::string>{"differences.csv", "figures", "phases.txt", "provenance.json",
                                      "report.html", "results.json", "runs.csv", "series_s_j.csv",
                                      "series_s_k.csv", "twincell-manifest.json"}));
  for (const char* ending : {".gp", ".dat", ".svg", ".png", ".pdf"})
    EXPECT_EQ(files_called(report / "figures", ending), 9) << ending;
  for (const auto& entry : fs::directory_iterator(report / "figures"))
    if (entry.path().extension() == ".svg") {
      EXPECT_TRUE(well_formed(read_text_file(entry.path()))) << entry.path();
    } else if (entry.path().extension() == ".png") {
      EXPECT_EQ(read_text_file(entry.path()).substr(1, 3), "PNG");
    } else if (entry.path().extension() == ".pdf") {
      EXPECT_EQ(read_text_file(entry.path()).substr(0, 5), "%PDF-");
    }

  const std::string html = read_text_file(report / "report.html");
  // tests/end_to_end/report_test.py checks that a browser makes no request. Here the text of the page is
  // checked.
  const std::string markup = html.substr(0, html.find("<script"));
  for (const char* outside : {"src=", "@import", "<link", "href=\"http"})
    EXPECT_EQ(markup.find(outside), std::string::npos) << outside;
  EXPECT_EQ(html.find("<script src"), std::string::npos);
  EXPECT_EQ(html.find("exp_a<&>"), std::string::npos);  // a file name is text, not markup
  EXPECT_NE(html.find("exp_a&lt;&amp;&gt;"), std::string::npos);
  EXPECT_NE(html.find("exp_a\\u003c&>"), std::string::npos);  // nor in the page's data
  EXPECT_LT(html.size(), 3600000U);

  // The rigid beds cross sigma/30 between Gamma 1.1 and 1.5 in both experiment and simulation. Only the
  // experiment shows convection.
  const auto& boundaries = document["boundaries"];
  ASSERT_EQ(boundaries.size(), 4U);
  EXPECT_EQ(boundaries[0]["of"], "experiment");
  EXPECT_NEAR(boundaries[0]["gamma"].get<double>(), 1.3, 1e-9);
  EXPECT_NEAR(boundaries[0]["half_width"].get<double>(), 0.2, 1e-9);
  EXPECT_TRUE(boundaries[3]["gamma"].is_null());
  EXPECT_NEAR(boundaries[3]["below"].get<double>(), 2.0, 1e-9);
}

TEST(Compare, TextEndsWithThePathOfTheReport) {
  const TemporaryFolder folder;
  const std::string one = film(folder / "exp.h5", bed(1.5, 0, Origin::experiment));
  const Ran ran = run_program({"compare", "--experiment", one, "-o", folder / "report"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("only experiment"), std::string::npos);
  const std::string last = "report: " + (folder / "report/report.html").string() + "\n";
  EXPECT_EQ(ran.out.substr(ran.out.size() - last.size()), last);
}

TEST(Compare, Refusals) {
  const TemporaryFolder folder;
  const std::string file = film(folder / "sim.h5", bed(1.5, 0, Origin::simulation));
  EXPECT_EQ(run_program({"compare", "-q", "-o", folder / "report"}).code, 2);
  EXPECT_EQ(run_program({"compare", "-q", "--simulation", file}).code, 2);
  EXPECT_EQ(
      run_program({"compare", "-q", "--simulation", file, "-o", folder / "report", "--stack", file}).code, 2);
  EXPECT_EQ(run_program({"compare", "-q", "--simulation", file, "-o", folder / "report", "--camera",
                         folder / "no.toml"})
                .code,
            3);
  EXPECT_EQ(run_program({"compare", "-q", "--simulation", folder / "no.h5", "-o", folder / "report"}).code,
            3);
  test::RigidBed still = bed(1.5, 0, Origin::simulation);
  TrajectoryInfo info = test::rigid_bed_info(still);
  {
    TrajectoryInfo undriven = info;
    undriven.drive.reset();
    H5mdWriter writer(folder / "undriven.h5", undriven);
    test::film_rigid_bed(still, info, writer);
    writer.finish();
  }
  const Ran undriven =
      run_program({"compare", "-q", "--simulation", folder / "undriven.h5", "-o", folder / "report"});
  EXPECT_EQ(undriven.code, 3);
  EXPECT_NE(undriven.err.find("Gamma"), std::string::npos) << undriven.err;

  const std::string path = std::getenv("PATH");
  setenv("PATH", folder.path().c_str(), 1);
  const Ran no_gnuplot = run_program({"compare", "-q", "--simulation", file, "-o", folder / "report"});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(no_gnuplot.code, 1);
  EXPECT_NE(no_gnuplot.err.find("gnuplot"), std::string::npos) << no_gnuplot.err;
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"sim.h5", "undriven.h5"}));
}

}  // namespace twincell::analyze_and_compare_test
