// Every guarantee of frame_source.hpp, and every known form of damage to a stack.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "imaging/stack/open_frames.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/tiff_pages.hpp"

namespace twincell::frame_source_test {

using namespace imaging;

namespace fs = std::filesystem;

namespace {

/// A picture in which every pixel has a distinct value, within the range of the depth.
template <class Pixel>
cv::Mat pattern(int width, int height, int offset = 0) {
  cv::Mat_<Pixel> m(height, width);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      m(y, x) = static_cast<Pixel>((offset + 7 * x + 131 * y) * (sizeof(Pixel) == 2 ? 37 : 1));
  return m;
}

/// An EXIF block that states an orientation and nothing else.
std::string exif(char orientation) {
  const char block[] = {'I', 'I', 42, 0, 8, 0,           0, 0, 1, 0, 0x12, 0x01, 3,
                        0,   1,   0,  0, 0, orientation, 0, 0, 0, 0, 0,    0,    0};
  return {block, sizeof(block)};
}

/// A chunk of a PNG.
std::string chunk(const std::string& kind_and_data) {
  boost::crc_32_type sum;
  sum.process_bytes(kind_and_data.data(), kind_and_data.size());
  const auto number = [](std::uint32_t n) {
    return std::string{static_cast<char>(n >> 24U), static_cast<char>(n >> 16U), static_cast<char>(n >> 8U),
                       static_cast<char>(n)};
  };
  return number(static_cast<std::uint32_t>(kind_and_data.size() - 4)) + kind_and_data +
         number(sum.checksum());
}

/// What a viewer shows of a picture with this orientation (TIFF 6.0, section 8).
cv::Mat shown(const cv::Mat& stored, int orientation) {
  const auto flipped = [](const cv::Mat& m, int axis) {
    cv::Mat out;
    cv::flip(m, out, axis);
    return out;
  };
  const auto turned = [](const cv::Mat& m, int how) {
    cv::Mat out;
    cv::rotate(m, out, how);
    return out;
  };
  switch (orientation) {
    case 2:
      return flipped(stored, 1);
    case 3:
      return turned(stored, cv::ROTATE_180);
    case 4:
      return flipped(stored, 0);
    case 5:
      return flipped(turned(stored, cv::ROTATE_90_CLOCKWISE), 1);
    case 6:
      return turned(stored, cv::ROTATE_90_CLOCKWISE);
    case 7:
      return flipped(turned(stored, cv::ROTATE_90_CLOCKWISE), 0);
    case 8:
      return turned(stored, cv::ROTATE_90_COUNTERCLOCKWISE);
    default:
      return stored;
  }
}

}  // namespace

TEST(FrameSource, PicturesAreReadAsViewersShowThem) {
  const TemporaryFolder folder;
  write_picture(folder / "a.jpg", pattern<uchar>(24, 17));
  write_picture(folder / "a.png", pattern<uchar>(24, 17));
  const std::string jpeg = bytes_of(folder / "a.jpg"), png = bytes_of(folder / "a.png");
  const cv::Mat of_jpeg = read_all(folder / "a.jpg").at(0), of_png = read_all(folder / "a.png").at(0);
  EXPECT_TRUE(open_frames(folder / "a.jpg")->info().notes.empty());
  constexpr std::size_t kAfterHead = 33;  // signature and IHDR
  for (int k = 1; k <= 8; ++k) {
    const std::string block = std::string("Exif\0\0", 6) + exif(static_cast<char>(k));
    const std::string app1 = std::string("\xff\xe1\0", 3) + static_cast<char>(block.size() + 2) + block;
    put_file(folder / "o.jpg", jpeg.substr(0, 2) + app1 + jpeg.substr(2));
    put_file(folder / "o.png",
             png.substr(0, kAfterHead) + chunk("eXIf" + exif(static_cast<char>(k))) + png.substr(kAfterHead));
    for (const auto& [name, stored] : {std::pair{"o.jpg", of_jpeg}, std::pair{"o.png", of_png}}) {
      const auto source = open_frames(folder / name);
      cv::Mat frame;
      ASSERT_TRUE(source->next(frame));
      EXPECT_TRUE(equal(frame, shown(stored, k))) << name << ", orientation " << k;
      EXPECT_EQ(source->info().width, frame.cols);
      ASSERT_EQ(source->info().notes.size(), k == 1 ? 0U : 1U);
      if (k != 1)
        expect_words(source->info().notes[0], {fmt::format("orientation {}", k), "as viewers show it"});
    }
  }
  // A block that is cut off states nothing.
  for (const std::size_t n : {0U, 7U, 13U, 25U}) {
    put_file(folder / "o.png",
             png.substr(0, kAfterHead) + chunk("eXIf" + exif(6).substr(0, n)) + png.substr(kAfterHead));
    EXPECT_EQ(open_frames(folder / "o.png")->info().notes.size(), n >= 22 ? 1U : 0U) << n;
  }
}

TEST(FrameSource, AnAnimatedPngIsOneFrameWithANote) {
  const TemporaryFolder folder;
  write_picture(folder / "a.png", pattern<uchar>(24, 17));
  const std::string png = bytes_of(folder / "a.png");
  put_file(folder / "a.png",
           png.substr(0, 33) + chunk(std::string("acTL\0\0\0\4\0\0\0\0", 12)) + png.substr(33));
  ASSERT_EQ(open_frames(folder / "a.png")->info().notes.size(), 1U);
  expect_words(open_frames(folder / "a.png")->info().notes[0],
               {"animated PNG has 4 frames", "first is read"});
}

// A video decoder would take them for damaged videos.
TEST(SpoiltFrames, PicturesOfOtherFormatsAreNamed) {
  const TemporaryFolder folder;
  const std::pair<const char*, std::string> heads[] = {
      {"WebP", std::string("RIFF\x10\0\0\0WEBPVP8 ", 16)},
      {"GIF", "GIF89a\x01\x02"},
      {"PPM", "P6\n2 2\n255\n\x01\x02\x03"},
      {"JPEG 2000", std::string("\0\0\0\x0cjP  \r\n\x87\n", 12)}};
  for (const auto& [name, head] : heads) {
    put_file(folder / "f.dat", head + std::string(64, '\1'));
    expect_words(refusal(folder / "f.dat"),
                 {std::string("is a ") + name + " picture", "PNG, TIFF, JPEG, BMP or PGM"});
  }
}

TEST(NaturalOrder, SortsNumbersNumerically) {
  EXPECT_TRUE(natural_less("frame_2.png", "frame_10.png"));
  EXPECT_FALSE(natural_less("frame_10.png", "frame_2.png"));
  EXPECT_TRUE(natural_less("a9b10", "a9b11"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_TRUE(natural_less("a99999999999999999999998", "a99999999999999999999999"));
  EXPECT_FALSE(natural_less("x1", "x1"));
  EXPECT_NE(natural_less("f01", "f1"), natural_less("f1", "f01"));
}

TEST(FrameSource, AFolderIsReadInNaturalOrderAndOnlyItsPictures) {
  const TemporaryFolder folder;
  for (const int i : {10, 2, 1, 9})
    write_picture(folder / fmt::format("frame_{}.png", i), pattern<uchar>(8, 6, i));
  put_file(folder / "truth.csv", "id\n");
  const auto source = open_frames(folder.path());
  EXPECT_EQ(source->announced(), 4U);
  cv::Mat frame;
  for (const int i : {1, 2, 9, 10}) {
    ASSERT_TRUE(source->next(frame));
    EXPECT_TRUE(equal(frame, pattern<uchar>(8, 6, i))) << i;
    expect_words(source->current(), {fmt::format("frame_{}.png", i)});
  }
  EXPECT_FALSE(source->next(frame));
}

TEST(FrameSource, DepthIsKept) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.tif", "a.bmp", "a.pgm"}) {
    write_picture(folder / name, pattern<uchar>(9, 7));
    const auto frames = read_all(folder / name);
    ASSERT_EQ(frames.size(), 1U) << name;
    EXPECT_TRUE(equal(frames[0], pattern<uchar>(9, 7))) << name;
  }
  for (const char* name : {"b.png", "b.tiff", "b.pgm"}) {
    write_picture(folder / name, pattern<ushort>(9, 7));
    const auto frames = read_all(folder / name);
    ASSERT_EQ(frames.size(), 1U) << name;
    EXPECT_TRUE(equal(frames[0], pattern<ushort>(9, 7))) << name;
  }
  cv::Mat1f real(5, 4, 0.25F);
  write_picture(folder / "c.tif", real);
  EXPECT_TRUE(equal(read_all(folder / "c.tif").at(0), real));
}

TEST(FrameSource, ColourBecomesGrey) {
  const TemporaryFolder folder;
  // ITU-R BT.601: 0.299 R + 0.587 G + 0.114 B.
  const cv::Mat bgr(6, 5, CV_8UC3, cv::Scalar(200, 100, 50));
  for (const char* name : {"colour.png", "colour.tif"}) {
    write_picture(folder / name, bgr);
    const cv::Mat grey = read_all(folder / name).at(0);
    ASSERT_EQ(grey.type(), CV_8UC1);
    EXPECT_NEAR(grey.at<uchar>(3, 3), 0.299 * 50 + 0.587 * 100 + 0.114 * 200, 1);
  }
  write_picture(folder / "deep.png", cv::Mat(6, 5, CV_16UC4, cv::Scalar(20000, 10000, 5000, 65535)));
  const cv::Mat grey = read_all(folder / "deep.png").at(0);
  ASSERT_EQ(grey.type(), CV_16UC1);
  EXPECT_NEAR(grey.at<ushort>(3, 3), 0.299 * 5000 + 0.587 * 10000 + 0.114 * 20000, 2);
}

TEST(FrameSource, AllPagesOfATiff) {
  const TemporaryFolder folder;
  std::vector<cv::Mat> pages;
  for (int i = 0; i < 40; ++i) pages.push_back(pattern<ushort>(12, 10, i));  // more than are read at a time
  write_pages(folder / "stack.tif", pages);
  EXPECT_EQ(open_frames(folder / "stack.tif")->announced(), 40U);
  const auto frames = read_all(folder / "stack.tif");
  ASSERT_EQ(frames.size(), 40U);
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_TRUE(equal(frames[i], pages[i])) << i;
}

TEST(FrameSource, APictureOfOnePixel) {
  const TemporaryFolder folder;
  for (const char* name : {"dot.png", "dot.tif"}) {
    write_picture(folder / name, cv::Mat1b(1, 1, uchar{77}));
    const auto frames = read_all(folder / name);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].at<uchar>(0, 0), 77);
  }
}

TEST(SpoiltFrames, NothingToRead) {
  const TemporaryFolder folder;
  expect_words(refusal(folder / "nowhere"), {"nowhere", "does not exist"});
  expect_words(refusal(folder.path()), {folder.path().string(), "holds no PNG"});
  put_file(folder / "notes.txt", "hello");
  expect_words(refusal(folder.path()), {"holds no PNG"});
  expect_words(refusal(folder / "notes.txt"), {"notes.txt", "is not a stack of frames"});
  put_file(folder / "empty.png", "");
  expect_words(refusal(folder / "empty.png"), {"empty.png", "is empty"});
  fs::create_directory(folder / "folder.png");
  expect_words(refusal(folder / "folder.png"), {"folder.png", "holds no PNG"});
}

TEST(SpoiltFrames, TheFoldersBelowThatHoldPicturesAreNamed) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "notes");
  fs::create_directory(folder / "gamma-10");
  write_picture(folder / "gamma-10/f.png", cv::Mat1b(8, 8, uchar{7}));
  expect_words(refusal(folder.path()), {"holds no PNG", "; its folder gamma-10 does."});
  fs::create_directory(folder / "gamma-2");
  write_picture(folder / "gamma-2/f.tif", cv::Mat1b(8, 8, uchar{7}));
  expect_words(refusal(folder.path()), {"; its folders gamma-2, gamma-10 do."});
}

TEST(SpoiltFrames, MixedSizesAreNamedWithTheirFiles) {
  const TemporaryFolder folder;
  write_picture(folder / "f1.png", pattern<uchar>(8, 6));
  write_picture(folder / "f2.png", pattern<uchar>(8, 6));
  write_picture(folder / "f3.png", pattern<uchar>(9, 6));
  expect_words(refusal(folder.path()), {"f3.png", "9 x 6", "f1.png", "8 x 6"});
}

// Grey values of 8 and of 16 bits are on different scales.
TEST(SpoiltFrames, MixedTypesAreNamedWithTheirFiles) {
  const TemporaryFolder folder;
  write_picture(folder / "f1.png", pattern<uchar>(8, 6));
  write_picture(folder / "f2.png", pattern<ushort>(8, 6));
  expect_words(refusal(folder.path()), {"f2.png", "16-bit values", "f1.png", "8-bit values", "one type"});
}

TEST(SpoiltFrames, TextThatCallsItselfAPicture) {
  const TemporaryFolder folder;
  for (const char* name :
       {"t.png", "t.tif", "t.jpg", "t.bmp", "t.pgm", "t.cine", "t.seq", "t.mrf", "t.h5", "t.avi"}) {
    put_file(folder / name, "This is not a picture at all, whatever its name says.\n");
    const std::string sentence = refusal(folder / name);
    expect_words(sentence, {name, "is not what its name says", fs::path(name).extension().string()});
    EXPECT_EQ(std::count(sentence.begin(), sentence.end(), '\n'), 0) << sentence;
  }
}

TEST(SpoiltFrames, TruncatedAtAnyLength) {
  const TemporaryFolder folder;
  for (const char* name : {"whole.png", "whole.jpg", "whole.tif", "whole.bmp", "whole.pgm"}) {
    write_picture(folder / name, pattern<uchar>(37, 29));
    const std::string whole = bytes_of(folder / name);
    ASSERT_TRUE(refusal(folder / name).empty()) << refusal(folder / name);
    const fs::path cut = folder / fmt::format("cut{}", fs::path(name).extension().string());
    for (std::size_t n = 0; n < whole.size(); n += n < 64 || n + 64 > whole.size() ? 1 : 17) {
      put_file(cut, whole.substr(0, n));
      EXPECT_FALSE(refusal(cut).empty()) << name << " cut to " << n << " of " << whole.size() << " bytes";
    }
  }
}

TEST(SpoiltFrames, APngWithoutItsEndOrWithAFlippedBit) {
  const TemporaryFolder folder;
  write_picture(folder / "p.png", pattern<ushort>(37, 29));
  const std::string whole = bytes_of(folder / "p.png");
  put_file(folder / "p.png", whole.substr(0, whole.size() - 12));  // all but IEND
  expect_words(refusal(folder / "p.png"), {"p.png", "truncated"});
  std::string flipped = whole;
  flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 4);
  put_file(folder / "p.png", flipped);
  expect_words(refusal(folder / "p.png"), {"p.png", "checksum"});
}

TEST(SpoiltFrames, ATruncatedTiffStackIsNotAShorterOne) {
  const TemporaryFolder folder;
  std::vector<cv::Mat> pages;
  for (int i = 0; i < 5; ++i) pages.push_back(pattern<ushort>(23, 19, i));
  write_pages(folder / "s.tif", pages);
  const std::string whole = bytes_of(folder / "s.tif");
  for (std::size_t n = 1; n < whole.size(); n += 31) {
    put_file(folder / "s.tif", whole.substr(0, n));
    EXPECT_FALSE(refusal(folder / "s.tif").empty()) << "cut to " << n << " of " << whole.size() << " bytes";
  }
}

TEST(SpoiltFrames, ASpoiltFrameInTheMiddleIsNamed) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) write_picture(folder / fmt::format("f{}.png", i), pattern<uchar>(16, 16, i));
  put_file(folder / "f1.png", bytes_of(folder / "f1.png").substr(0, 60));
  expect_words(refusal(folder.path()), {"f1.png", "truncated"});
}

// ffmpeg can take any bytes for a film. In a folder of pictures such bytes are a damaged picture and are not
// passed to ffmpeg.
TEST(SpoiltFrames, BytesNamedLikeAPictureInAFolder) {
  const TemporaryFolder folder;
  write_picture(folder / "f1.png", pattern<uchar>(16, 16));
  std::string bytes = bytes_of(folder / "f1.png");
  bytes[0] = '\0';
  put_file(folder / "f2.png", bytes);
  expect_words(refusal(folder.path()), {"f2.png", "is not what its name says", "no picture"});
}

TEST(FrameSource, ContentDecidesNotTheName) {
  const TemporaryFolder folder;
  write_picture(folder / "a.tif", pattern<ushort>(9, 7));
  fs::rename(folder / "a.tif", folder / "a.png");
  write_picture(folder / "b.png", pattern<ushort>(9, 7, 1));
  fs::rename(folder / "b.png", folder / "b.cine");
  EXPECT_TRUE(equal(read_all(folder / "a.png").at(0), pattern<ushort>(9, 7)));
  EXPECT_TRUE(equal(read_all(folder / "b.cine").at(0), pattern<ushort>(9, 7, 1)));
  EXPECT_TRUE(equal(read_all(folder.path()).at(0), pattern<ushort>(9, 7)));  // in a folder, too
}

TEST(FrameSource, AFolderSaysWhatItPassesOver) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) write_picture(folder / fmt::format("f{}.PNG", i), pattern<uchar>(8, 6, i));
  put_file(folder / "truth.csv", "id\n");
  put_file(folder / "notes.txt", "hello");
  put_file(folder / "._f0.PNG", "what another system leaves behind");
  fs::create_directory(folder / "sub.png");
  const auto source = open_frames(folder.path());
  EXPECT_EQ(source->announced(), 3U);
  EXPECT_EQ(source->info().other_files, 2U);
  EXPECT_EQ(read_all(folder.path()).size(), 3U);
}

TEST(FrameSource, AFolderOfStacksIsOneStack) {
  const TemporaryFolder folder;
  for (int part = 0; part < 3; ++part) {
    std::vector<cv::Mat> pages;
    for (int i = 0; i < 4 - part; ++i) pages.push_back(pattern<ushort>(12, 10, 10 * part + i));
    write_pages(folder / fmt::format("run_{}.tif", part), pages);
  }
  EXPECT_EQ(open_frames(folder.path())->announced(), 9U);
  const auto frames = read_all(folder.path());
  ASSERT_EQ(frames.size(), 9U);
  for (const auto& [at, offset] : {std::pair{0, 0}, {3, 3}, {4, 10}, {7, 20}, {8, 21}})
    EXPECT_TRUE(equal(frames[static_cast<std::size_t>(at)], pattern<ushort>(12, 10, offset))) << at;
}

TEST(FrameSource, TheDepthAPgmStatesIsKept) {
  const TemporaryFolder folder;
  put_file(folder / "a.pgm", "P5\n# twelve bits\n2 1\n4095\n\x0f\xff\x01\x02");
  const auto source = open_frames(folder / "a.pgm");
  EXPECT_EQ(source->info().bits, 12);
  cv::Mat frame;
  ASSERT_TRUE(source->next(frame));
  ASSERT_EQ(frame.type(), CV_16UC1);
  EXPECT_EQ(frame.at<ushort>(0, 0), 4095);
  EXPECT_EQ(frame.at<ushort>(0, 1), 258);
}

TEST(SpoiltFrames, WhatIsNoFile) {
  const TemporaryFolder folder;
  expect_words(refusal("/dev/zero"), {"/dev/zero", "not a regular file"});
  fs::create_symlink(folder / "nowhere", folder / "dangling.png");
  expect_words(refusal(folder / "dangling.png"), {"dangling.png", "does not exist"});
  fs::remove(folder / "dangling.png");
  put_file(folder / "run.cine", "CI");
  expect_words(refusal(folder.path()), {"holds no PNG", "it holds run.cine: name that file"});
}

TEST(SpoiltFrames, AFileThatMayNotBeRead) {
  const TemporaryFolder folder;
  write_picture(folder / "locked.png", pattern<uchar>(8, 6));
  fs::permissions(folder / "locked.png", fs::perms::none);
  if (std::ifstream(folder / "locked.png")) GTEST_SKIP() << "This user may read everything.";
  expect_words(refusal(folder / "locked.png"), {"locked.png", "cannot be opened for reading"});
}

TEST(SpoiltFrames, AHeaderThatPromisesMoreThanAFileCanHold) {
  const TemporaryFolder folder;
  put_file(folder / "a.pgm", "P5 1048576 256 255\n");
  expect_words(refusal(folder / "a.pgm"), {"a.pgm", "1048576 x 256", "cannot hold"});
  put_file(folder / "b.pgm", "P5 4000000000 1 255\n");
  expect_words(refusal(folder / "b.pgm"), {"4000000000 x 1", "sides"});
  write_picture(folder / "c.png", pattern<uchar>(8, 6));
  std::string bytes = bytes_of(folder / "c.png");
  bytes[16] = bytes[20] = 1;  // 2^24 more pixels in each direction
  put_file(folder / "c.png", bytes);
  expect_words(refusal(folder / "c.png"), {"c.png", "pixels"});
  write_picture(folder / "d.jpg", pattern<uchar>(8, 6));
  bytes = bytes_of(folder / "d.jpg");
  const std::size_t frame = bytes.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  for (std::size_t i = 5; i < 9; ++i) bytes[frame + i] = '\xff';
  put_file(folder / "d.jpg", bytes);
  expect_words(refusal(folder / "d.jpg"), {"d.jpg", "65535 x 65535"});
}

}  // namespace twincell::frame_source_test
