// `fit` as a user runs it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"

namespace twincell::fit_test {
namespace {

std::string slips(const TemporaryFolder& folder) {
  std::string text = "# made up: E_b = 7\nK_m, p_s, trials\n";
  for (const double k : {2.0, 2.5, 3.0, 4.0, 6.0, 10.0})
    text += fmt::format("{}, {:.9f}, 40000\n", k, std::exp(-7 / k));
  text += "0.6, 0, 40000\n";
  put_file(folder / "p_s.csv", text);
  return (folder / "p_s.csv").string();
}

}  // namespace

TEST(Fit, TextJsonAndPictureSayTheSame) {
  const TemporaryFolder folder;
  const std::string table = slips(folder);
  const Ran json = run_program({"fit", table, "--law", "arrhenius", "--x", "K_m", "--y", "p_s", "--trials",
                                "trials", "--json", "-q", "-o", folder / "fit"});
  ASSERT_EQ(json.code, 0) << json.err;
  const auto document = nlohmann::json::parse(json.out);
  EXPECT_NEAR(document["parameters"]["E_b"]["value"].get<double>(), 7, 0.01);
  EXPECT_EQ(document["n"]["zero"], 1);
  EXPECT_EQ(document["upper_limits"].size(), 1U);
  EXPECT_TRUE(document["weighted"]);
  EXPECT_EQ(document["undetermined"].size(), 0U);
  EXPECT_FALSE(document["stop_reason"].get<std::string>().empty());
  EXPECT_EQ(document["covariance"].size(), 2U);
  EXPECT_EQ(names_in(folder / "fit"),
            (std::vector<std::string>{"fit.dat", "fit.gp", "fit.json", "fit.pdf", "fit.png", "fit.svg",
                                      "twincell-manifest.json"}));
  EXPECT_EQ(nlohmann::json::parse(read_text_file(folder / "fit/fit.json"))["parameters"],
            document["parameters"]);

  const Ran text = run_program({"fit", table, "--law", "arrhenius", "--trials", "trials"});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("E_b"), std::string::npos);
  EXPECT_NE(
      text.out.find("x is K_m, y is p_s; 7 points used, 1 of them zero; maximum likelihood of the counts"),
      std::string::npos)
      << text.out;
}

TEST(Fit, Refusals) {
  const TemporaryFolder folder;
  const std::string table = slips(folder);
  const auto refused = [](const std::vector<std::string>& words, int code, const std::string& says) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_NE(ran.err.find(says), std::string::npos) << ran.err;
  };
  refused({"fit", table, "--law", "parabola", "-q"}, 2, "arrhenius");
  refused({"fit", table, "--law", "arrhenius", "--y", "p_t", "-q"}, 2, "K_m, p_s, trials");
  refused({"fit", table, "--law", "arrhenius", "--window", "20,30", "-q"}, 3, "[20, 30]");
  refused({"fit", table, "--law", "arrhenius", "--window", "30,20", "-q"}, 2, "window");
  refused({"fit", folder / "no.csv", "--law", "line", "-q"}, 3, "no.csv");
  refused({"fit", table, "--law", "line", "-q", "-o", folder / "no/fit"}, 2, "no");
  put_file(folder / "zeros.csv", "x,y\n1,0\n2,0\n3,0\n");
  refused({"fit", folder / "zeros.csv", "--law", "power", "-q"}, 3, "3 zero");
  refused({"fit", folder / "zeros.csv", "--law", "arrhenius", "--x", "y", "--y", "x", "--trials", "x", "-q"},
          3, "row 2 contains 2");
  put_file(folder / "bad.csv", "x,y\n1,2\n3,four\n");
  refused({"fit", folder / "bad.csv", "--law", "line", "-q"}, 3, "bad.csv:3");
  put_file(folder / "short.csv", "x,y\n1,2\n3\n");
  refused({"fit", folder / "short.csv", "--law", "line", "-q"}, 3, "short.csv:3");
  EXPECT_EQ(names_in(folder.path()),
            (std::vector<std::string>{"bad.csv", "p_s.csv", "short.csv", "zeros.csv"}));
}

TEST(Fit, CopiesOfPointsAreSaid) {
  const TemporaryFolder folder;
  put_file(folder / "once.csv", "x,y\n1,2\n2,4.1\n3,5.9\n4,8.2\n");
  put_file(folder / "twice.csv", "x,y\n1,2\n2,4.1\n3,5.9\n4,8.2\n1,2\n2,4.1\n3,5.9\n4,8.2\n");
  const Ran once = run_program({"fit", folder / "once.csv", "--law", "line"}),
            twice = run_program({"fit", folder / "twice.csv", "--law", "line"});
  EXPECT_EQ(once.out.find("to the last digit"), std::string::npos) << once.out;
  EXPECT_NE(twice.out.find("4 points are equal to another one to the last digit"), std::string::npos)
      << twice.out;
}

TEST(Fit, ErrorsThatAreNoneAreSaid) {
  const TemporaryFolder folder;
  put_file(folder / "flat.csv", "x,y,s\n1,2,0\n2,2,0\n4,2,0.1\n8,2,0\n16,2,0\n");
  const Ran line = run_program({"fit", folder / "flat.csv", "--law", "line", "--sigma", "s"});
  EXPECT_EQ(line.code, 0) << line.err;
  EXPECT_NE(line.out.find("not weighted: the given errors are not above 0 at 4 of 5 points"),
            std::string::npos)
      << line.out;
  // Without scatter and without decay, the plateau is determined. The decay is not, and its error is not 0.
  const Ran flat = run_program({"fit", folder / "flat.csv", "--law", "algebraic", "--json"});
  EXPECT_EQ(flat.code, 0) << flat.err;
  const auto document = nlohmann::json::parse(flat.out);
  EXPECT_EQ(document["undetermined"], (nlohmann::json{"b", "c"}));
  EXPECT_NEAR(document["parameters"]["a"]["value"].get<double>(), 2, 1e-12);
  EXPECT_TRUE(document["parameters"]["a"].contains("interval"));
  EXPECT_FALSE(document["parameters"]["b"].contains("interval"));
  EXPECT_FALSE(document["parameters"]["c"].contains("interval"));
}

TEST(Fit, ALawThatMissesThePointsIsNoted) {
  const TemporaryFolder folder;
  put_file(folder / "scatter.csv",
           "x,y,s\n1,5,.001\n2,1,.001\n3,9,.001\n4,2,.001\n5,7,.001\n6,1,.001\n7,8,.001\n");
  const Ran bad = run_program({"fit", folder / "scatter.csv", "--law", "line", "--sigma", "s"});
  EXPECT_EQ(bad.code, 0) << bad.err;
  EXPECT_NE(bad.out.find("misses the points by more than their stated errors"), std::string::npos) << bad.out;
  put_file(folder / "good.csv", "x,y,s\n1,1.1,.1\n2,1.9,.1\n3,3.05,.1\n4,4,.1\n5,4.9,.1\n");
  const Ran good = run_program({"fit", folder / "good.csv", "--law", "line", "--sigma", "s"});
  EXPECT_EQ(good.out.find("misses the points"), std::string::npos) << good.out;
}

}  // namespace twincell::fit_test
