// A film that is named twice, or a copy of it, is refused before any work.
#include "imaging/stack/different_stacks.hpp"

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "tests/support/frames.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::different_stacks_test {
namespace {

namespace fs = std::filesystem;

/// A film of noise. \param later from this frame on the pictures depend on the seed
void film(const fs::path& folder, int seed, int frames, int later = 0) {
  fs::create_directory(folder);
  for (int f = 0; f < frames; ++f) {
    cv::RNG random(static_cast<std::uint64_t>(f < later ? 1 + f : 1000 * seed + f + 1));
    cv::Mat1b picture(12, 16);
    random.fill(picture, cv::RNG::UNIFORM, 0, 255);
    write_picture(folder / ("f" + std::to_string(f) + ".png"), picture);
  }
}

std::string refusal(const std::vector<fs::path>& stacks) {
  try {
    require_different_stacks(stacks);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(DifferentStacks, ACopyIsRefusedAndNamed) {
  const TemporaryFolder folder;
  film(folder / "a", 1, 10);
  film(folder / "b", 2, 10);
  fs::copy(folder / "a", folder / "c", fs::copy_options::recursive);
  EXPECT_EQ(refusal({folder / "a", folder / "b"}), "");
  EXPECT_EQ(refusal({folder / "a", folder / "b", folder / "c"}),
            (folder / "c").string() + ": begins with the same pictures as " + (folder / "a").string() +
                "; name each film once.");
  EXPECT_NE(refusal({folder / "a", folder / "a"}), "");
}

TEST(DifferentStacks, FilmsThatBeginAlikeAreDifferent) {
  const TemporaryFolder folder;
  film(folder / "a", 1, 10, 7);
  film(folder / "b", 2, 10, 7);
  EXPECT_EQ(refusal({folder / "a", folder / "b"}), "");
  film(folder / "short", 1, 7, 7);  // a part of a: another number of frames
  EXPECT_EQ(refusal({folder / "a", folder / "short"}), "");
  film(folder / "c", 3, 10, 8);
  film(folder / "d", 4, 12, 8);
  EXPECT_NE(refusal({folder / "c", folder / "d"}), "");
}

TEST(DifferentStacks, AMissingStackIsFoundAtOnce) {
  const TemporaryFolder folder;
  film(folder / "a", 1, 2);
  EXPECT_NE(refusal({folder / "a", folder / "none"}).find("none"), std::string::npos);
}

}  // namespace
}  // namespace twincell::imaging::different_stacks_test
