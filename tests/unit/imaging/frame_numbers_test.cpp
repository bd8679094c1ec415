#include "imaging/stack/formats/frame_numbers.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace twincell::imaging::frames::frame_numbers_test {
namespace {

std::vector<std::string> numbered(const char* form, int from, int to, int step = 1) {
  std::vector<std::string> names;
  for (int i = from; i <= to; i += step) names.push_back(fmt::format(fmt::runtime(form), i));
  return names;
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(FrameNumbers, SignedNumbersOfATriggerInTheMiddleAreInOrder) {
  std::vector<std::string> names = {"img+01.png", "img-02.png", "img+00.png", "img-10.png", "img-01.png"};
  sort_as_frames(names);
  EXPECT_EQ(names,
            (std::vector<std::string>{"img-10.png", "img-02.png", "img-01.png", "img+00.png", "img+01.png"}));
  names.clear();
  for (int k = -40; k < 40; ++k) names.push_back(fmt::format("img{:+03}.png", k));
  EXPECT_TRUE(notes_on_names(names).empty());
  // A dash alone is no sign.
  names = {"img-10.png", "img-2.png", "img-1.png"};
  sort_as_frames(names);
  EXPECT_EQ(names, (std::vector<std::string>{"img-1.png", "img-2.png", "img-10.png"}));
}

TEST(FrameNumbers, WholeSeriesGiveNoSentence) {
  EXPECT_TRUE(notes_on_names({}).empty());
  EXPECT_TRUE(notes_on_names({"only.png"}).empty());
  EXPECT_TRUE(notes_on_names(numbered("{}.png", 1, 30)).empty());
  EXPECT_TRUE(notes_on_names(numbered("img_{:05}.tif", 0, 400, 20)).empty());
  EXPECT_TRUE(notes_on_names(joined({"dark.png"}, numbered("f{}.png", 1, 9))).empty());
}

TEST(FrameNumbers, SkippedOnesAreNamed) {
  const auto names = joined(joined(numbered("f_{:03}.png", 0, 30), numbered("f_{:03}.png", 32, 40)),
                            numbered("f_{:03}.png", 44, 60));
  const auto notes = notes_on_names(names);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("skip 4 frames: 31, 41 to 43;"), std::string::npos) << notes[0];
}

TEST(FrameNumbers, AGapInAShortStackIsNamed) {
  const auto notes = notes_on_names(joined(numbered("f_{}.png", 0, 2), numbered("f_{}.png", 4, 7)));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("skip 1 frame: 3;"), std::string::npos) << notes[0];
}

TEST(FrameNumbers, FramesThatAreThereTwiceAreNamed) {
  for (const auto& [first, second] :
       {std::pair{"f_{}.png", "f_{}.tif"}, std::pair{"f_{}.png", "f_{:03}.png"}}) {
    const auto notes = notes_on_names(joined(numbered(first, 1, 4), numbered(second, 1, 4)));
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes[0].find("4 pictures have a number that another picture has too, first f_1.png and f_"),
              std::string::npos)
        << notes[0];
  }
  EXPECT_EQ(notes_on_names(joined(numbered("f{}.png", 1, 9), {"f4_old.png"})).size(), 1U);
}

// Numbers that are times: 75 % of the steps are not equal, or the others are no multiples.
TEST(FrameNumbers, UnevenStepsAreNoGaps) {
  EXPECT_TRUE(notes_on_names({"t100.png", "t133.png", "t167.png", "t200.png", "t233.png"}).empty());
  auto names = numbered("t{}.png", 100, 400, 10);
  names.push_back("t415.png");
  EXPECT_TRUE(notes_on_names(names).empty());
  EXPECT_TRUE(notes_on_names({"1234567890123456789012.png", "1234567890123456789019.png"}).empty());
}

TEST(FrameNumbers, APictureOfAnotherNameIsNoFrame) {
  using Names = std::vector<std::string>;
  const Names film = numbered("frame_{:04}.png", 0, 79);
  EXPECT_EQ(outside_the_series(joined(film, {"overlay.png"})), Names{"overlay.png"});
  EXPECT_EQ(outside_the_series(joined(film, {"background.tif", "mask_2.png"})),
            (Names{"background.tif", "mask_2.png"}));
  EXPECT_TRUE(outside_the_series(film).empty());
  // The series continues these names.
  EXPECT_TRUE(outside_the_series(joined({"s.tif"}, numbered("s_{}.tif", 1, 9))).empty());
  EXPECT_TRUE(outside_the_series(joined({"img.png"}, numbered("img ({}).png", 1, 9))).empty());
  EXPECT_TRUE(outside_the_series(joined({"cell-.png"}, numbered("cell-{}.png", 1, 9))).empty());
  // Too few frames to know, two recordings, or names of their own.
  EXPECT_TRUE(outside_the_series(joined(numbered("f_{}.png", 1, 7), {"overlay.png"})).empty());
  EXPECT_TRUE(outside_the_series(joined(numbered("a_{}.png", 1, 20), numbered("b_{}.png", 1, 2))).empty());
  EXPECT_TRUE(
      outside_the_series({"a.png", "b.png", "c.png", "d.png", "e.png", "f.png", "g.png", "h.png"}).empty());
}

TEST(FrameNumbers, TwoCamerasInAFolderAreNoticed) {
  const auto notes = notes_on_names(joined(numbered("camA_{}.png", 1, 5), numbered("camB_{}.png", 1, 6)));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("2 series, 'camA_' (5 frames), 'camB_' (6 frames)"), std::string::npos) << notes[0];
}

}  // namespace
}  // namespace twincell::imaging::frames::frame_numbers_test
