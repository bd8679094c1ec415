// `locate --explain`: what was tried, and the options of the chosen settings give the same beads.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::locate_explain_test {
namespace {

/// Black discs of 16 px, apart from each other, on a light ground with noise.
/// \param middle level inside half of the radius
void write_discs(const std::string& file, float middle = 20) {
  constexpr int kSide = 200, kSamples = 4;
  cv::Mat1f fine(kSide * kSamples, kSide * kSamples, 200.0F), picture;
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 7; ++j) {
      const cv::Point centre((24 + 25 * i + 2 * j) * kSamples, (24 + 25 * j + i % 3) * kSamples);
      cv::circle(fine, centre, 8 * kSamples, 20.0F, cv::FILLED);
      cv::circle(fine, centre, 4 * kSamples, middle, cv::FILLED);
    }
  cv::GaussianBlur(fine, fine, {0, 0}, 0.7 * kSamples);
  cv::resize(fine, picture, {kSide, kSide}, 0, 0, cv::INTER_AREA);
  std::mt19937_64 random(1);
  std::normal_distribution<float> normal(0, 2);
  for (float& level : picture) level += normal(random);
  cv::Mat1b bytes;
  picture.convertTo(bytes, CV_8U);
  write_picture(file, bytes);
}

}  // namespace

TEST(LocateExplain, ThreadsChangeNoNumberOfWhatWasTried) {
  const TemporaryFolder folder;
  const std::string picture = (folder.path() / "discs.png").string(),
                    table = (folder.path() / "beads.csv").string();
  write_discs(picture, 120);  // plain discs do not suffice, and the other models are tried
  std::vector<nlohmann::json> tried;
  for (const char* threads : {"1", "3"}) {
    const Ran ran = run_program({"locate", picture, "-o", table, "--json", "--threads", threads});
    ASSERT_EQ(ran.code, 0) << ran.err;
    tried.push_back(nlohmann::json::parse(ran.out)["settings_tried"]);
    EXPECT_GE(tried.back().size(), 3U);
  }
  EXPECT_EQ(tried[0], tried[1]);
}

TEST(LocateExplain, PrintsWhatWasTriedAndAClearWin) {
  const TemporaryFolder folder;
  const std::string picture = (folder.path() / "discs.png").string(),
                    table = (folder.path() / "beads.csv").string();
  write_discs(picture);
  const Ran text = run_program({"locate", picture, "-o", table, "--explain"});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("evidence/nats"), std::string::npos);
  EXPECT_NE(text.out.find("(chosen)"), std::string::npos);
  EXPECT_EQ(text.out.find("nearly as well"), std::string::npos);
  EXPECT_NE(text.out.find("they explain nearly all of the picture"), std::string::npos) << text.out;
  const Ran json = run_program({"locate", picture, "-o", table, "--json"});
  const auto said = nlohmann::json::parse(json.out);
  ASSERT_FALSE(said["settings_tried"].empty());
  const nlohmann::json chosen = said["settings_tried"][0];
  EXPECT_EQ(chosen["chosen"], true);
  EXPECT_EQ(chosen["beads"], 49);
  EXPECT_EQ(chosen["not_chosen"], "");
  EXPECT_LT(chosen["rim_variation"].get<double>(), 0.03);
  EXPECT_LT(chosen["rim_shift"].get<double>(), 0.028);
  EXPECT_TRUE(said["warnings"].empty()) << said["warnings"];
  EXPECT_GT(chosen["evidence"].get<double>(), 49 * 100);
  // The options, pasted, give the same beads.
  std::vector<std::string> pasted = {"locate", picture, "-o", table, "--json"};
  std::istringstream words(chosen["options"].get<std::string>());
  for (std::string word; words >> word;) pasted.push_back(word);
  const auto again = nlohmann::json::parse(run_program(pasted).out);
  EXPECT_EQ(again["frames"][0]["beads"], 49);
  EXPECT_FALSE(again.contains("settings_tried"));
}

TEST(LocateExplain, WhatIsNotRoundIsRefusedUnlessADiameterIsGiven) {
  const TemporaryFolder folder;
  const std::string picture = (folder.path() / "squares.png").string(),
                    table = (folder.path() / "beads.csv").string();
  cv::Mat1b squares(220, 220, uchar{200});
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const cv::RotatedRect square(cv::Point2f(25 + 34.0F * i, 25 + 34.0F * j), {18, 18},
                                   17.0F * (i + 2 * j));
      std::array<cv::Point2f, 4> corners;
      square.points(corners.data());
      cv::fillConvexPoly(squares, std::vector<cv::Point>(corners.begin(), corners.end()), cv::Scalar(20),
                         cv::LINE_AA);
    }
  cv::GaussianBlur(squares, squares, {0, 0}, 0.8);
  write_picture(picture, squares);
  const Ran refused = run_program({"locate", picture, "-o", table, "--explain"});
  EXPECT_EQ(refused.code, 3) << refused.err;
  EXPECT_NE(refused.err.find("what stands out is not round"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(table));
  // What was tried, with the reasons.
  EXPECT_EQ(refused.out.substr(0, 13), "evidence/nats");
  EXPECT_NE(refused.out.find("(not round: "), std::string::npos) << refused.out;
  EXPECT_EQ(refused.out.find("(chosen)"), std::string::npos);
  const Ran document = run_program({"locate", picture, "-o", table, "--explain", "--json"});
  const nlohmann::json first = nlohmann::json::parse(document.out)["settings_tried"].at(0);
  EXPECT_EQ(first["chosen"], false);
  EXPECT_EQ(first["not_chosen"].get<std::string>().substr(0, 10), "not round:");
  const Ran given = run_program({"locate", picture, "-o", table, "--diameter", "20"});
  EXPECT_EQ(given.code, 0) << given.err;
}

}  // namespace twincell::locate_explain_test
