// Videos: OpenCV decodes them to 8 bits with a warning. Where ffmpeg is installed, grey and deeper videos are
// decoded exactly through it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "imaging/codecs/codecs.hpp"
#include "imaging/stack/open_frames.hpp"
#include "tests/support/camera_files.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::video_test {

using namespace imaging;

namespace {

bool runs(const std::string& command) {
  return std::system((command + " > /dev/null 2>&1").c_str()) == 0;  // NOLINT: a fixed command of a test
}
const bool kFfmpeg = runs("ffmpeg -version") && runs("ffprobe -version");

/// Encodes raw frames as a video.
void encode(const std::string& raw, const std::string& pixels, int width, int height,
            const std::string& codec, const std::string& video) {
  ASSERT_TRUE(runs(fmt::format("ffmpeg -y -f rawvideo -pix_fmt {} -s {}x{} -r 50 -i {} -c:v {} {}", pixels,
                               width, height, raw, codec, video)));
}

PixelValue values(int bits) {
  return [bits](int x, int y, int frame) {
    return static_cast<unsigned>(7 + 211 * x + 1013 * y + 5003 * frame) & ((1U << bits) - 1);
  };
}

void write_film(const std::string& file, int frames) {
  const auto writer = imaging::codecs().create_film(file, "MJPG", 25, cv::Size(64, 48));
  ASSERT_NE(writer, nullptr);
  for (int i = 0; i < frames; ++i) {
    cv::Mat picture(48, 64, CV_8UC3, cv::Scalar::all(30 * i));
    picture(cv::Rect(0, 0, 16, 16)).setTo(cv::Scalar(0, 0, 200));  // coloured, so that the video is not grey
    writer->write(picture);
  }
}

}  // namespace

TEST(Video, ByOpenCvWithAWarning) {
  const TemporaryFolder folder;
  write_film(folder / "film.avi", 7);
  const auto frames = read_all(folder / "film.avi");
  ASSERT_EQ(frames.size(), 7U);
  for (int i = 0; i < 7; ++i) {
    const cv::Mat& frame = frames[static_cast<std::size_t>(i)];
    ASSERT_EQ(frame.type(), CV_8UC1);
    EXPECT_EQ(frame.size(), cv::Size(64, 48));
    EXPECT_NEAR(cv::mean(frame(cv::Rect(24, 24, 40, 24)))[0], 30 * i, 3);
  }
  const StackInfo info = open_frames(folder / "film.avi")->info();
  EXPECT_EQ(info.frame_rate_hz, 25);
  EXPECT_EQ(info.bits, 8);
  ASSERT_EQ(info.notes.size(), 1U);
  expect_words(info.notes[0], {"8 bits"});
}

TEST(Video, GreyAndDeepOnesThroughFfmpegAreExact) {
  if (!kFfmpeg) GTEST_SKIP() << "ffmpeg is not installed.";
  const TemporaryFolder folder;
  for (const auto& [bits, pixels] :
       {std::pair{8, "gray"}, {10, "gray10le"}, {12, "gray12le"}, {16, "gray16le"}}) {
    SCOPED_TRACE(pixels);
    const std::string raw = folder / "raw", video = folder / fmt::format("v{}.mkv", bits);
    put_file(raw, planes(64, 48, 5, bits == 8 ? 8 : 16, values(bits)));
    encode(raw, pixels, 64, 48, "ffv1", video);
    const auto frames = read_all(video);
    ASSERT_EQ(frames.size(), 5U);
    for (int f = 0; f < 5; ++f)
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
          const cv::Mat& m = frames[static_cast<std::size_t>(f)];
          ASSERT_EQ(bits == 8 ? m.at<uchar>(y, x) : m.at<ushort>(y, x), values(bits)(x, y, f));
        }
    const StackInfo info = open_frames(video)->info();
    EXPECT_EQ(info.bits, bits);
    EXPECT_EQ(info.frame_rate_hz, 50);
    EXPECT_TRUE(info.notes.empty());
  }
}

TEST(Video, ColourDeeperThanEightBitsKeepsItsDepth) {
  if (!kFfmpeg) GTEST_SKIP() << "ffmpeg is not installed.";
  const TemporaryFolder folder;
  put_file(folder / "raw",
           planes(64, 48, 2, 16, [](int x, int, int) { return static_cast<unsigned>(400 + 4 * x); }));
  const std::string video = folder / "v.mkv";
  encode(folder / "raw", "gray16le", 64, 48, "ffv1 -pix_fmt yuv420p10le", video);
  const StackInfo info = open_frames(video)->info();
  EXPECT_EQ(info.bits, 10);
  ASSERT_EQ(info.notes.size(), 1U);
  EXPECT_EQ(read_all(video).at(0).type(), CV_16UC1);
}

TEST(Video, ATruncatedOneIsRefused) {
  const TemporaryFolder folder;
  std::vector<std::string> names;
  write_film(folder / "opencv.avi", 60);
  names.emplace_back("opencv.avi");
  if (kFfmpeg) {
    // Incompressible values, so that half of the file contains half of the frames.
    std::mt19937 chance(1);
    put_file(folder / "raw",
             planes(64, 48, 20, 16, [&](int, int, int) { return static_cast<unsigned>(chance() & 0xFFFF); }));
    for (const char* name : {"deep.avi", "deep.mkv"}) {
      encode(folder / "raw", "gray16le", 64, 48, "ffv1", folder / name);
      names.emplace_back(name);
    }
  }
  for (const std::string& name : names) {
    const std::string whole = bytes_of(folder / name);
    ASSERT_EQ(refusal(folder / name), "");
    put_file(folder / name, whole.substr(0, whole.size() / 2));
    const std::string sentence = refusal(folder / name);
    expect_words(sentence, {name, "frame"});
    EXPECT_EQ(std::count(sentence.begin(), sentence.end(), '\n'), 0) << sentence;
  }
}

// A streamed film states no number of frames, and ffv1 in Matroska never does.
TEST(Video, FramesAreCountedWhereTheHeaderStatesNone) {
  if (!kFfmpeg) GTEST_SKIP() << "ffmpeg is not installed.";
  const TemporaryFolder folder;
  put_file(folder / "raw", planes(64, 48, 23, 8, values(8)));
  encode(folder / "raw", "gray", 64, 48, "ffv1", folder / "grey.mkv");
  write_film(folder / "film.avi", 23);
  ASSERT_TRUE(runs(fmt::format("sh -c 'ffmpeg -y -i {} -c copy -f matroska - | cat > {}'",
                               std::string(folder / "film.avi"), std::string(folder / "streamed.mkv"))));
  for (const char* name : {"grey.mkv", "streamed.mkv", "film.avi"}) {
    EXPECT_EQ(open_frames(folder / name)->announced(), 23U) << name;
    EXPECT_EQ(read_all(folder / name).size(), 23U) << name;
  }
}

TEST(Video, ACutFilmIsRefusedWithoutAnAddress) {
  if (!kFfmpeg) GTEST_SKIP() << "ffmpeg is not installed.";
  const TemporaryFolder folder;
  std::mt19937 chance(1);
  put_file(folder / "raw",
           planes(64, 48, 20, 16, [&](int, int, int) { return static_cast<unsigned>(chance() & 0xFFFF); }));
  encode(folder / "raw", "gray16le", 64, 48, "ffv1", folder / "deep.mkv");
  const std::string whole = bytes_of(folder / "deep.mkv");
  put_file(folder / "deep.mkv", whole.substr(0, whole.size() / 2));
  const std::string sentence = refusal(folder / "deep.mkv");
  expect_words(sentence, {"deep.mkv", "ffmpeg says"});
  EXPECT_EQ(sentence.find("0x"), std::string::npos) << sentence;
}

TEST(Video, SpecialCharactersInNamesAreHarmless) {
  if (!kFfmpeg) GTEST_SKIP() << "ffmpeg is not installed.";
  const TemporaryFolder folder;
  put_file(folder / "raw", planes(64, 48, 2, 8, values(8)));
  encode(folder / "raw", "gray", 64, 48, "ffv1", folder / "v.mkv");
  const std::string odd = folder / "-i pipe:0; $(touch x) 'v%03d'.mkv";
  std::filesystem::rename(folder / "v.mkv", odd);
  EXPECT_EQ(read_all(odd).size(), 2U);
}

TEST(Video, UndecodableFilesAreRefused) {
  const TemporaryFolder folder;
  std::string noise(5005, '\x7f');
  noise.replace(0, 4, "\0\x01\x02\x03", 4);
  noise.back() = '\0';
  put_file(folder / "noise.mp4", noise);
  expect_words(refusal(folder / "noise.mp4"), {"noise.mp4", "cannot be decoded as a video", "ffmpeg"});
}

TEST(Video, APlaylistOpensNoOtherFile) {
  const TemporaryFolder folder;
  write_film(folder / "secret.avi", 5);
  const std::filesystem::path here = std::filesystem::path(folder / "secret.avi").parent_path();
  const std::vector<std::string> lists = {
      "ffconcat version 1.0\nfile secret.avi\n",
      "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nsecret.avi\n#EXT-X-ENDLIST\n"};
  for (const std::string& list : lists)
    for (const char* ending : {".avi", ".mkv", ".mp4"}) {
      const std::filesystem::path file = here / (std::string("list") + ending);
      // A non-text byte: the reader leaves a text file alone before any decoder sees it.
      std::ofstream(file, std::ios::binary) << list << "#\x01\n";
      EXPECT_THROW((void)read_all(file), InputError) << file;
    }
}

TEST(Video, NamesThatLookLikeProtocolsAreFiles) {
  const TemporaryFolder folder;
  const std::filesystem::path here = std::filesystem::path(folder / "a.avi").parent_path();
  write_film(folder / "a.avi", 5);
  const std::filesystem::path back = std::filesystem::current_path();
  std::filesystem::current_path(here);
  for (const char* name : {"concat:a.avi|a.avi", "-i.avi", "http:x.avi", "subfile,,start,0,end,9,,:a.avi"}) {
    std::string file = name;
    if (!file.ends_with(".avi")) file += ".avi";
    std::filesystem::copy_file("a.avi", file);
    EXPECT_EQ(read_all(file).size(), 5U) << file;
  }
  std::filesystem::current_path(back);
}

}  // namespace twincell::video_test
