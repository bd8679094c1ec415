// `locate --view`: the page holds the frames, the beads of the table and the dropped candidates with their
// reasons.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/atomic_file.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::locate_view_test {
namespace {

namespace fs = std::filesystem;

const fs::path kDemo = fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/gamma-0.9";

/// A frame of the demo, 100 beads of 12 px, with two discs in its empty part that absorb little.
cv::Mat with_pale_discs() {
  cv::Mat picture = read_picture(kDemo / "frame_00000.png");
  for (const int x : {45, 90}) {
    const double light = picture.at<uchar>(30, x);
    cv::circle(picture, {x, 30}, 6, 0.75 * light, cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

/// The document of the page.
nlohmann::json data_of(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const auto at = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
}

struct Verdict {
  int frame;
  double x, y;
  std::string word;
};
using Verdicts = std::vector<Verdict>;

Verdicts of_table(const fs::path& table) {
  Verdicts verdicts;
  std::ifstream in(table);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::vector<std::string> c;
    for (std::string cell; std::getline(cells, cell, ',');) c.push_back(cell);
    verdicts.push_back({std::stoi(c[0]), std::stod(c[1]), std::stod(c[2]), c[8]});
  }
  return verdicts;
}

Verdicts of_page(const nlohmann::json& data, std::size_t set) {
  Verdicts verdicts;
  const nlohmann::json& frames = data["sets"][set]["frames"];
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (const nlohmann::json& c : frames[f])
      verdicts.push_back(
          {data["frames"][f]["number"], c[0], c[1], data["verdicts"][c[7].get<std::size_t>()]["word"]});
  return verdicts;
}

/// Expects the same verdicts in the same order. The page has two decimals, the table four.
void expect_same(const Verdicts& page, const Verdicts& table) {
  ASSERT_EQ(page.size(), table.size());
  for (std::size_t i = 0; i < page.size(); ++i) {
    EXPECT_EQ(page[i].frame, table[i].frame) << i;
    EXPECT_NEAR(page[i].x, table[i].x, 0.0051) << i;
    EXPECT_NEAR(page[i].y, table[i].y, 0.0051) << i;
    EXPECT_EQ(page[i].word, table[i].word) << i;
  }
}

std::size_t count(const Verdicts& verdicts, const std::string& word) {
  return static_cast<std::size_t>(
      std::count_if(verdicts.begin(), verdicts.end(), [&](const Verdict& v) { return v.word == word; }));
}

}  // namespace

TEST(LocateView, HoldsEveryCandidateWithItsReasonAndAsksForNothing) {
  const TemporaryFolder folder;
  const std::string picture = folder / "discs.png", beads = folder / "b.csv", page = folder / "view.html",
                    table = folder / "c.csv";
  write_picture(picture, with_pale_discs());
  const Ran ran = run_program({"locate", picture, "-o", beads, "--view", page, "--candidates", table});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find(page), std::string::npos);
  const std::string html = read_text_file(page);
  const nlohmann::json data = data_of(html);
  const Verdicts stored = of_page(data, 0);
  expect_same(stored, of_table(table));
  EXPECT_EQ(count(stored, "bead"), 100U);
  EXPECT_GE(stored.size(), 102U);
  EXPECT_NE(html.find("100 beads"), std::string::npos);
  // What was tried, and both polarities.
  EXPECT_NE(html.find("--dark --refine exact</code> (chosen)"), std::string::npos);
  EXPECT_GE(data["sets"].size(), 2U);
  EXPECT_FALSE(data["sets"][0]["bright"].get<bool>());
  EXPECT_TRUE(data["sets"][1]["bright"].get<bool>());
  // The picture is in the page, whole.
  const std::string uri = data["frames"][0]["picture"];
  EXPECT_TRUE(uri.starts_with("data:image/png;base64,"));
  EXPECT_EQ(data["frames"][0]["width"], read_picture(picture).cols);
  for (const char* outside : {"src=\"http", "href=\"http", "@import", "url(", "fetch("})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  EXPECT_EQ(data["command"], "twincell locate " + picture + " -o " + beads);
}

TEST(LocateView, ShowsTheFirstTwelveChosenFramesInThePartThatIsSearched) {
  const TemporaryFolder folder;
  const std::string page = folder / "view.html", table = folder / "c.csv";
  const Ran ran =
      run_program({"locate", kDemo, "-q", "-o", folder / "b.csv", "--view", page, "--candidates", table,
                   "--frames", "3:40:2", "--roi", "30,60,80,100", "--diameter", "12", "--dark"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string html = read_text_file(page);
  const nlohmann::json data = data_of(html);
  ASSERT_EQ(data["frames"].size(), 12U);
  EXPECT_NE(html.find("12 of 19 frames"), std::string::npos);
  EXPECT_EQ(data["frames"][11]["number"], 25);
  EXPECT_EQ(data["frames"][0]["x"], 30);
  EXPECT_EQ(data["frames"][0]["height"], 100);
  Verdicts first_twelve = of_table(table);
  std::erase_if(first_twelve, [](const Verdict& v) { return v.frame > 25; });
  expect_same(of_page(data, 0), first_twelve);
  EXPECT_GT(count(first_twelve, "bead"), 12U * 10);
  // Nothing was tried, so the other polarity is located with the same diameter.
  ASSERT_EQ(data["sets"].size(), 2U);
  EXPECT_TRUE(data["sets"][1]["bright"].get<bool>());
  EXPECT_EQ(data["sets"][1]["diameters"], nlohmann::json({12.0}));
  EXPECT_EQ(data["given"], " --diameter 12 --dark");
  EXPECT_NE(data["command"].get<std::string>().find(" --roi 30,60,80,100 --frames 3:40:2"),
            std::string::npos);
}

TEST(LocateView, LargeFramesAreReducedAndPlacesAreNot) {
  const TemporaryFolder folder;
  cv::Mat1b large(1000, 2400, uchar{200});
  for (int i = 0; i < 20; ++i)
    cv::circle(large, {100 + 110 * i, 300 + 20 * i}, 20, 20, cv::FILLED, cv::LINE_AA);
  write_picture(folder / "large.png", large);
  const std::string page = folder / "view.html";
  const Ran ran = run_program({"locate", folder / "large.png", "-q", "-o", folder / "b.csv", "--view", page,
                               "--diameter", "40", "--dark"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json data = data_of(read_text_file(page));
  EXPECT_EQ(data["frames"][0]["width"], 2400);
  const std::string uri = data["frames"][0]["picture"];
  EXPECT_TRUE(uri.starts_with("data:image/jpeg;base64,"));
  EXPECT_LT(uri.size(), 300'000U);
  ASSERT_EQ(count(of_page(data, 0), "bead"), 20U);
  EXPECT_NEAR(data["sets"][0]["frames"][0][19][0], 2190, 0.3);
}

TEST(LocateView, MinExplainedDropsBeadsBelowIt) {
  const TemporaryFolder folder;
  const auto beads = [&](const std::string& least) {
    const Ran ran = run_program({"locate", kDemo, "--json", "-o", folder / "b.csv", "--frames", "0:1",
                                 "--diameter", "12", "--dark", "--min-explained", least});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return nlohmann::json::parse(ran.out)["frames"][0];
  };
  EXPECT_EQ(beads("0.5")["beads"], 100);
  const nlohmann::json none = beads("1");
  EXPECT_EQ(none["beads"], 0);
  EXPECT_EQ(none["dropped"]["unexplained"], 100);
  const Ran refused = run_program(
      {"locate", kDemo, "-o", folder / "b.csv", "--diameter", "12", "--dark", "--min-explained", "1.5"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("min-explained"), std::string::npos) << refused.err;
}

}  // namespace twincell::locate_view_test
