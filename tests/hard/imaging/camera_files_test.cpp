// Phantom .cine, NorPix .seq, Photron .mraw and IDT .mrf: every pixel depth and order, the time stamps, and
// every known form of damage to such a file.
#include "tests/support/camera_files.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "imaging/stack/open_frames.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::camera_files_test {

using namespace imaging;

namespace fs = std::filesystem;

namespace {

/// A distinct value for every pixel, within the depth.
PixelValue values(int bits) {
  return [bits](int x, int y, int frame) {
    return static_cast<unsigned>(7 + 211 * x + 1013 * y + 5003 * frame) & ((1U << bits) - 1);
  };
}

/// Expects a stack to contain exactly these values.
void expect_values(const fs::path& stack, int width, int height, int frames, int bits) {
  const PixelValue value = values(bits);
  const auto source = open_frames(stack);
  EXPECT_EQ(source->announced(), static_cast<std::size_t>(frames)) << stack;
  EXPECT_EQ(source->info().bits, bits) << stack;
  EXPECT_EQ(source->info().width, width);
  EXPECT_EQ(source->info().height, height);
  const auto read = read_all(stack);
  ASSERT_EQ(read.size(), static_cast<std::size_t>(frames)) << stack;
  for (int f = 0; f < frames; ++f) {
    const cv::Mat& m = read[static_cast<std::size_t>(f)];
    ASSERT_EQ(m.size(), cv::Size(width, height)) << stack;
    ASSERT_EQ(m.type(), bits == 8 ? CV_8UC1 : CV_16UC1) << stack;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(bits == 8 ? m.at<uchar>(y, x) : m.at<ushort>(y, x), value(x, y, f))
            << stack << ", frame " << f << ", column " << x << ", row " << y;
  }
}

/// Expects every truncated copy of the file to be refused in one line that names it.
void expect_truncation_is_found(const fs::path& file, const std::string& whole) {
  put_file(file, whole);
  ASSERT_EQ(refusal(file), "");
  for (std::size_t n = 0; n < whole.size(); n += n < 200 || n + 200 > whole.size() ? 1 : 13) {
    put_file(file, whole.substr(0, n));
    const std::string sentence = refusal(file);
    EXPECT_NE(sentence.find(file.filename().string()), std::string::npos)
        << n << " of " << whole.size() << " bytes";
    EXPECT_EQ(std::count(sentence.begin(), sentence.end(), '\n'), 0) << sentence;
  }
}

const fs::path kSamples = TWINCELL_SOURCE_DIR "/../shared/real_images/camera_formats";

struct Sample {
  const char* name;
  int width, height;
  std::size_t frames;
  int type;
  double smallest, largest, mean;
};

void expect_sample(const Sample& s) {
  const auto frames = read_all(kSamples / s.name);
  ASSERT_EQ(frames.size(), s.frames);
  EXPECT_EQ(frames[0].size(), cv::Size(s.width, s.height));
  EXPECT_EQ(frames[0].type(), s.type);
  double smallest = 0, largest = 0;
  cv::minMaxLoc(frames[0], &smallest, &largest);
  EXPECT_EQ(smallest, s.smallest);
  EXPECT_EQ(largest, s.largest);
  EXPECT_NEAR(cv::mean(frames[0])[0], s.mean, 0.005);
}

}  // namespace

// --- files of real cameras (soft-matter/pims @ d8bd899, pims/tests/data) and their known properties ---

TEST(RealCameraFiles, Cine) {
  if (!fs::exists(kSamples)) GTEST_SKIP() << "The real camera files are not beside the source tree.";
  expect_sample({"cine_781.cine", 256, 256, 15, CV_16UC1, 75, 3028, 2698.68});
  const auto source = open_frames(kSamples / "cine_781.cine");
  const StackInfo info = source->info();
  EXPECT_EQ(info.first_number, -5417);
  EXPECT_EQ(info.bits, 12);
  // Images are numbered from the trigger, so number and time stamp must agree at the rate of the stamps.
  cv::Mat frame;
  ASSERT_TRUE(source->next(frame));
  ASSERT_TRUE(info.stamped_rate_hz && source->time_s());
  EXPECT_NEAR(*source->time_s() * *info.stamped_rate_hz, -5417, 1);
  // Every tenth image of 90 000 per second was saved. The header does not state this; the stamps show it.
  EXPECT_EQ(info.frame_rate_hz, 90000);
  EXPECT_NEAR(*info.stamped_rate_hz, 9000, 9);
  ASSERT_EQ(info.notes.size(), 1U);
  expect_words(info.notes[0], {"90000", "stamps"});
}

TEST(RealCameraFiles, LegacyCine) {
  if (!fs::exists(kSamples)) GTEST_SKIP() << "The real camera files are not beside the source tree.";
  expect_sample({"cine_legacy.cine", 128, 128, 97, CV_16UC1, 0, 6081, 273.70});
  const auto source = open_frames(kSamples / "cine_legacy.cine");
  const StackInfo info = source->info();
  EXPECT_EQ(info.first_number, -7722);
  EXPECT_EQ(info.bits, 14);
  EXPECT_EQ(info.frame_rate_hz, 35087);
  cv::Mat frame;
  ASSERT_TRUE(source->next(frame));
  ASSERT_TRUE(info.stamped_rate_hz && source->time_s());
  EXPECT_NEAR(*info.stamped_rate_hz, 35087, 35087 * 0.003);
  EXPECT_NEAR(*source->time_s() * 35087, -7722, 2);
}

TEST(RealCameraFiles, Seq) {
  if (!fs::exists(kSamples)) GTEST_SKIP() << "The real camera files are not beside the source tree.";
  expect_sample({"sample_norpix6.seq", 36, 32, 6, CV_8UC1, 0, 247, 124.67});
  const StackInfo info = open_frames(kSamples / "sample_norpix6.seq")->info();
  EXPECT_EQ(info.frame_rate_hz, 10);
  EXPECT_EQ(info.recorded_unix, 1435776075);
  ASSERT_TRUE(info.stamped_rate_hz);
  EXPECT_NEAR(*info.stamped_rate_hz, 5 / (0.944373 - 0.775430), 1e-3);  // its first and last stamp
}

TEST(CameraFiles, ColourBecomesGrey) {
  const TemporaryFolder folder;
  // Blue, green, red; ITU-R BT.601 weights 0.114, 0.587, 0.299. Rows differ, so that a wrong row order is
  // detected.
  const PixelValue colour = [](int, int y, int) {
    return y == 0 ? 200U << 16 | 100U << 8 | 50U : 10U << 16 | 20U << 8 | 30U;
  };
  put_file(folder / "a.cine", cine_file({.container = 24, .real_bits = 8}, colour));
  put_file(folder / "a.seq", seq_file({.bits = 24, .format = 200}, colour));
  put_file(folder / "a.mrf", mrf_file(6, 4, 3, 24, colour));
  for (const char* name : {"a.cine", "a.seq", "a.mrf"}) {
    const auto frames = read_all(folder / name);
    ASSERT_EQ(frames.size(), 3U) << name;
    ASSERT_EQ(frames[2].type(), CV_8UC1) << name;
    EXPECT_NEAR(frames[2].at<uchar>(0, 5), 0.114 * 200 + 0.587 * 100 + 0.299 * 50, 1) << name;
    EXPECT_NEAR(frames[2].at<uchar>(3, 5), 0.114 * 10 + 0.587 * 20 + 0.299 * 30, 1) << name;
    EXPECT_EQ(open_frames(folder / name)->info().bits, 8) << name;
  }
}

// --- cine ---

TEST(Cine, EveryDepth) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.cine";
  for (const auto& [container, bits] : {std::pair{8, 8}, {16, 8}, {16, 10}, {16, 12}, {16, 14}, {16, 16}}) {
    put_file(file, cine_file({.container = container, .real_bits = bits}, values(bits)));
    if (container == 16 && bits == 8) {  // the container sets the type, the header field sets the depth
      EXPECT_EQ(open_frames(file)->info().bits, 8);
      EXPECT_EQ(read_all(file).at(0).type(), CV_16UC1);
    } else {
      expect_values(file, 6, 4, 3, bits);
    }
  }
  // 3 x 3 pixels of 12 bits end in the middle of a byte.
  for (const unsigned packing : {256U, 1024U})
    for (const auto& [width, height] : {std::pair{8, 4}, {3, 3}}) {
      put_file(file, cine_file({.width = width, .height = height, .container = 12, .packing = packing},
                               values(12)));
      expect_values(file, width, height, 3, 12);
    }
}

// The camera stores packed 10-bit values in companded form. The manufacturer's table has 1024 entries (listed
// in ottomatic-io/pycine pycine/linLUT.py); these are eight of them.
TEST(Cine, Packed10BitIsMadeLinear) {
  const TemporaryFolder folder;
  const std::vector<std::pair<unsigned, int>> table = {{64, 64},    {128, 125},  {256, 290},   {512, 998},
                                                       {800, 2468}, {960, 3620}, {1014, 4064}, {1023, 4095}};
  put_file(folder / "a.cine",
           cine_file({.width = 8, .height = 1, .frames = 1, .container = 10, .packing = 256},
                     [&](int x, int, int) { return table[static_cast<std::size_t>(x)].first; }));
  const auto source = open_frames(folder / "a.cine");
  EXPECT_EQ(source->info().bits, 12);
  ASSERT_EQ(source->info().notes.size(), 1U);
  expect_words(source->info().notes[0], {"10-bit", "linear"});
  cv::Mat frame;
  ASSERT_TRUE(source->next(frame));
  for (int x = 0; x < 8; ++x)
    EXPECT_NEAR(frame.at<ushort>(0, x), table[static_cast<std::size_t>(x)].second, 2) << x;
}

TEST(Cine, TopIsUpHoweverTheRowsLie) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.cine";
  for (const bool flip_v : {false, true})
    for (const bool flip_h : {false, true})
      for (const bool top_down : {false, true}) {
        put_file(file, cine_file({.flip_v = flip_v, .flip_h = flip_h, .top_down = top_down}, values(12)));
        expect_values(file, 6, 4, 3, 12);
        put_file(file, cine_file({.container = 12, .packing = 1024, .flip_v = flip_v, .flip_h = flip_h},
                                 values(12)));
        expect_values(file, 6, 4, 3, 12);
      }
}

TEST(Cine, TimesRateAndNumbers) {
  const TemporaryFolder folder;
  put_file(folder / "a.cine", cine_file({.frames = 5, .first_image = -2, .rate = 1000}, values(12)));
  const auto source = open_frames(folder / "a.cine");
  const StackInfo info = source->info();
  EXPECT_EQ(info.frame_rate_hz, 1000);
  EXPECT_EQ(info.first_number, -2);
  EXPECT_EQ(info.time_origin, "trigger");
  EXPECT_EQ(info.recorded_unix, 1600000000);
  EXPECT_EQ(info.exposure_s, 0x1p-10);
  ASSERT_TRUE(info.stamped_rate_hz);
  EXPECT_NEAR(*info.stamped_rate_hz, 1000, 5e-4);  // stamps count 2^-30 s, over 4 ms
  EXPECT_FALSE(source->time_s());
  cv::Mat frame;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(source->next(frame));
    ASSERT_TRUE(source->time_s());
    EXPECT_NEAR(*source->time_s(), (i - 2) * 1e-3,
                1e-9);  // stamps count 2^-32 s, the two lowest bits are flags
    expect_words(source->current(), {"a.cine", fmt::format("frame {} (image {})", i, i - 2)});
  }
  put_file(folder / "b.cine", cine_file({.times = false}, values(12)));
  const auto untimed = open_frames(folder / "b.cine");
  ASSERT_TRUE(untimed->next(frame));
  EXPECT_FALSE(untimed->time_s());
  EXPECT_EQ(untimed->info().time_origin, "");
}

TEST(Cine, OldFiles) {
  const TemporaryFolder folder;
  // 32-bit offsets; a set-up that ends before the fields of newer cameras.
  put_file(folder / "a.cine", cine_file({.version = 0}, values(12)));
  expect_values(folder / "a.cine", 6, 4, 3, 12);
  put_file(folder / "b.cine", cine_file({.real_bits = 16, .setup_bytes = 300}, values(16)));
  expect_values(folder / "b.cine", 6, 4, 3, 16);
  EXPECT_EQ(open_frames(folder / "b.cine")->info().frame_rate_hz, 1000);
}

TEST(Cine, Spoilt) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.cine";
  const std::string whole = cine_file({}, values(12));
  expect_truncation_is_found(file, whole);
  const auto changed = [&](std::size_t at, std::uint64_t value, std::size_t n) {
    std::string bytes = whole;
    for (std::size_t i = 0; i < n; ++i) bytes[at + i] = static_cast<char>(value >> (8 * i));
    put_file(file, bytes);
    return refusal(file);
  };
  expect_words(changed(4, 1, 2), {"a.cine", "JPEG"});
  expect_words(changed(6, 2, 2), {"version 2"});
  expect_words(changed(20, 0, 4), {"no frames"});
  expect_words(changed(20, 4000000000, 4), {"truncated", "4000000000 images"});
  expect_words(changed(48, 0x7FFFFFFF, 4), {"2147483647 x 4"});
  expect_words(changed(48, 1000, 4), {"damaged", "1000 x 4", "8000"});
  expect_words(changed(52, 0x80000000, 4), {"-2147483648"});
  expect_words(changed(58, 32, 2), {"32 bits"});
  expect_words(changed(60, 7, 4), {"packing 7"});
  expect_words(changed(84 + 140, 0, 2), {"no mark ST"});
  expect_words(changed(84 + 808, 3, 4), {"mosaic"});
  expect_words(changed(32, 0xFFFFFFF0, 4), {"truncated", "table"});
}

// --- seq ---

TEST(Seq, EveryDepthAndVersion) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.seq";
  for (const int version : {3, 5}) {
    put_file(file, seq_file({.version = version}, values(8)));
    expect_values(file, 6, 4, 3, 8);
    for (const int bits : {10, 12, 16}) {
      put_file(file, seq_file({.bits = 16, .real_bits = bits, .version = version}, values(bits)));
      expect_values(file, 6, 4, 3, bits);
    }
  }
}

TEST(Seq, TimesAndRate) {
  const TemporaryFolder folder;
  for (const int version : {3, 5}) {
    put_file(folder / "a.seq", seq_file({.frames = 4, .version = version}, values(8)));
    const auto source = open_frames(folder / "a.seq");
    const double step = version >= 5 ? 0.0025 : 0.003;
    EXPECT_EQ(source->info().frame_rate_hz, 400);
    EXPECT_NEAR(*source->info().stamped_rate_hz, 1 / step, 1e-6);
    EXPECT_EQ(source->info().notes.size(), version >= 5 ? 0U : 1U);  // 333 frames/s differ from 400
    EXPECT_EQ(source->info().recorded_unix, 1600000000);
    cv::Mat frame;
    for (int i = 0; i < 4; ++i) {  // the second stamp is in the next second of the clock
      ASSERT_TRUE(source->next(frame));
      EXPECT_NEAR(*source->time_s(), i * step, 1e-9);
    }
  }
}

TEST(Seq, ARecordingThatWasNeverClosed) {
  const TemporaryFolder folder;
  put_file(folder / "a.seq", seq_file({.frames = 5, .counted = false}, values(8)));
  EXPECT_EQ(read_all(folder / "a.seq").size(), 5U);
  ASSERT_EQ(open_frames(folder / "a.seq")->info().notes.size(), 1U);
  expect_words(open_frames(folder / "a.seq")->info().notes[0], {"counts no frames", "room for 5"});
}

TEST(Seq, Spoilt) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.seq";
  expect_truncation_is_found(file, [] {
    // The padding after the last time stamp may be missing.
    const std::string whole = seq_file({}, values(8));
    return whole.substr(0, whole.size() - 16);
  }());
  put_file(file, seq_file({.compression = 1}, values(8)));
  expect_words(refusal(file), {"a.seq", "compressed"});
  put_file(file, seq_file({.format = 102}, values(8)));
  expect_words(refusal(file), {"format 102 with 8 bits"});
  std::string bytes = seq_file({}, values(8));
  bytes[580] = 10;
  put_file(file, bytes);
  expect_words(refusal(file), {"10 bytes apart"});
  put_file(file, seq_file({.frames = 0, .counted = false}, values(8)));
  expect_words(refusal(file), {"no frames"});
}

// --- mrf ---

TEST(Mrf, EveryDepth) {
  const TemporaryFolder folder;
  for (const int bits : {8, 10, 12, 16}) {
    put_file(folder / "a.mrf", mrf_file(6, 4, 3, bits, values(bits)));
    expect_values(folder / "a.mrf", 6, 4, 3, bits);
  }
}

TEST(Mrf, Spoilt) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.mrf";
  expect_truncation_is_found(file, mrf_file(6, 4, 3, 10, values(10)));
  put_file(file, mrf_file(6, 4, 0, 10, values(10)));
  expect_words(refusal(file), {"a.mrf", "no frames"});
  put_file(file, mrf_file(6, 4, 1, 32, values(8)));
  expect_words(refusal(file), {"32 bits"});
}

// --- mraw ---

TEST(Mraw, EveryDepth) {
  const TemporaryFolder folder;
  for (const auto& [stored, bits] : {std::pair{8, 8}, {10, 10}, {12, 12}, {16, 10}, {16, 12}, {16, 16}}) {
    put_file(folder / "a.mraw", planes(8, 4, 3, stored, values(bits)));
    put_file(folder / "a.cih", cih_text(8, 4, 3, stored, bits));
    expect_values(folder / "a.mraw", 8, 4, 3, bits);
    expect_values(folder / "a.cih", 8, 4, 3, bits);
    put_file(folder / "b.mraw", planes(8, 4, 3, stored, values(bits)));
    put_file(folder / "b.cihx", cihx_text(8, 4, 3, stored, bits));
    expect_values(folder / "b.mraw", 8, 4, 3, bits);
    expect_values(folder / "b.cihx", 8, 4, 3, bits);
  }
  // Twelve bits in the upper bits of sixteen.
  put_file(folder / "c.mraw",
           planes(8, 4, 3, 16, [](int x, int y, int f) { return values(12)(x, y, f) << 4; }));
  put_file(folder / "c.CIH", cih_text(8, 4, 3, 16, 12, "Higher"));
  expect_values(folder / "c.mraw", 8, 4, 3, 12);
}

TEST(Mraw, RateExposureNumber) {
  const TemporaryFolder folder;
  put_file(folder / "a.mraw", planes(8, 4, 3, 16, values(12)));
  for (const bool xml : {false, true}) {
    fs::remove(folder / "a.cih");
    put_file(folder / (xml ? "a.cihx" : "a.cih"),
             xml ? cihx_text(8, 4, 3, 16, 12) : cih_text(8, 4, 3, 16, 12));
    const StackInfo info = open_frames(folder / "a.mraw")->info();
    EXPECT_EQ(info.frame_rate_hz, 2000);
    EXPECT_EQ(info.exposure_s, 0.00025);
    EXPECT_EQ(info.first_number, -5);
  }
}

TEST(Mraw, Spoilt) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.mraw";
  const std::string whole = planes(8, 4, 3, 12, values(12));
  put_file(file, whole);
  expect_words(refusal(file), {"a.mraw", "lacks the file a.cih or .cihx"});
  put_file(folder / "lone.cih", cih_text(8, 4, 3, 12, 12));
  expect_words(refusal(folder / "lone.cih"), {"lone.cih", "lacks the file lone.mraw"});
  put_file(folder / "a.cih", cih_text(8, 4, 3, 12, 12));
  expect_truncation_is_found(file, whole);
  const auto with = [&](const std::string& text) {
    put_file(file, whole);
    put_file(folder / "a.cih", text);
    return refusal(file);
  };
  const std::string text = cih_text(8, 4, 3, 12, 12);
  for (const char* key : {"Total Frame", "Image Width", "Image Height", "Color Bit", "EffectiveBit Depth"}) {
    std::string without = text;
    without.replace(without.find(key), 3, "***");
    if (std::string(key) == "Total Frame") continue;  // still in "Original Total Frame"
    expect_words(with(without), {"a.cih", key});
  }
  expect_words(with(cih_text(8, 4, 0, 12, 12)), {"no frames"});
  expect_words(with(cih_text(-8, 4, 3, 12, 12)), {"Image Width", "-8"});
  expect_words(with(cih_text(8, 4, 3, 14, 12)), {"Color Bit = 14"});
  expect_words(with(cih_text(8, 4, 3, 12, 12, "Higher")), {"Higher", "12-bit"});
  expect_words(with("neither keys nor values"), {"a.cih", "not a Photron header"});
  expect_words(with(std::string(text).replace(text.find("MRaw"), 4, "TIFF")), {"'TIFF'"});
  expect_words(with(std::string(text).replace(text.find("Mono"), 4, "Color")), {"colours"});
  for (std::size_t n = 0; n < text.size(); n += 7) {
    const std::string sentence = with(text.substr(0, n));
    if (text.find("EffectiveBit Depth") > n) {
      EXPECT_NE(sentence, "") << n;
    }
  }
}

}  // namespace twincell::camera_files_test
