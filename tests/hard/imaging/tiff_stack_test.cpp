// TIFF and BigTIFF in every byte order and depth, ImageJ's stacks above 4 GB, and memory that does not grow
// with the stack.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tiffio.h>

#include <algorithm>

#include "imaging/stack/open_frames.hpp"
#include "tests/support/camera_files.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::tiff_stack_test {

using namespace imaging;

namespace fs = std::filesystem;

namespace {

PixelValue values(int bits) {
  return [bits](int x, int y, int frame) {
    return static_cast<unsigned>(7 + 211 * x + 1013 * y + 5003 * frame) & ((1U << bits) - 1);
  };
}

cv::Mat expected(int width, int height, int frame, int bits, const PixelValue& value) {
  cv::Mat m(height, width, bits == 8 ? CV_8U : CV_16U);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (bits == 8)
        m.at<uchar>(y, x) = static_cast<uchar>(value(x, y, frame));
      else
        m.at<ushort>(y, x) = static_cast<ushort>(value(x, y, frame));
  return m;
}

void expect_stack(const fs::path& stack, int width, int height, int frames, int bits,
                  const PixelValue& value) {
  EXPECT_EQ(open_frames(stack)->announced(), static_cast<std::size_t>(frames)) << stack;
  const auto read = read_all(stack);
  ASSERT_EQ(read.size(), static_cast<std::size_t>(frames)) << stack;
  for (int f = 0; f < frames; ++f)
    EXPECT_TRUE(equal(read[static_cast<std::size_t>(f)], expected(width, height, f, bits, value)))
        << stack << ", frame " << f;
}

long peak_kib() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return use.ru_maxrss;
}

}  // namespace

TEST(TiffStack, EveryOrderAndDepth) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.tif";
  for (const bool big_first : {false, true})
    for (const bool big_tiff : {false, true})
      for (const int bits : {8, 10, 12, 14, 16})
        for (const int width : {32, 13}) {  // 13 pixels of 10, 12 or 14 bits end in the middle of a byte
          put_file(file,
                   tiff_file({.width = width, .bits = bits, .big_first = big_first, .big_tiff = big_tiff},
                             values(bits)));
          SCOPED_TRACE(
              fmt::format("{} bits, width {}, big-endian {}, BigTIFF {}", bits, width, big_first, big_tiff));
          expect_stack(file, width, 20, 3, bits, values(bits));
          EXPECT_EQ(open_frames(file)->info().bits, bits);
        }
}

TEST(TiffStack, TwelveBitsInSixteen) {
  const TemporaryFolder folder;
  put_file(folder / "a.tif", tiff_file({.max_sample = 4095}, values(12)));
  expect_stack(folder / "a.tif", 32, 20, 3, 16, values(12));
  EXPECT_EQ(open_frames(folder / "a.tif")->info().bits, 12);
}

TEST(TiffStack, ZeroIsWhite) {
  const TemporaryFolder folder;
  for (const int bits : {8, 12, 16}) {
    put_file(folder / "a.tif", tiff_file({.bits = bits, .photometric = 0}, values(bits)));
    expect_stack(folder / "a.tif", 32, 20, 3, bits,
                 [&](int x, int y, int f) { return ((1U << bits) - 1) - values(bits)(x, y, f); });
    ASSERT_EQ(open_frames(folder / "a.tif")->info().notes.size(), 1U);
    expect_words(open_frames(folder / "a.tif")->info().notes[0], {"WhiteIsZero", "are inverted"});
  }
}

// Grey pages are copied, palettes and planes of few bits rendered by libtiff, which mirrors by itself.
TEST(TiffStack, PagesAreReadAsViewersShowThem) {
  const TemporaryFolder folder;
  constexpr int kWidth = 24, kHeight = 17;
  const auto write_page = [&](int bits, int orientation) {
    TIFF* t = TIFFOpen((folder / "a.tif").c_str(), "w");
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, kWidth);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, kHeight);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, kHeight);
    TIFFSetField(t, TIFFTAG_ORIENTATION, orientation);
    std::vector<unsigned char> row(static_cast<std::size_t>(kWidth * bits / 8));
    for (int y = 0; y < kHeight; ++y) {
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = static_cast<unsigned char>(values(8)(static_cast<int>(i), y, 0));
      TIFFWriteScanline(t, row.data(), static_cast<std::uint32_t>(y), 0);
    }
    TIFFClose(t);
  };
  for (const int bits : {8, 4}) {
    write_page(bits, 1);
    const cv::Mat stored = read_all(folder / "a.tif").at(0);
    const std::size_t notes = open_frames(folder / "a.tif")->info().notes.size();
    const auto turned = [&](int k) {
      cv::Mat m = stored.clone();
      if (k >= 5) m = m.t();
      if (k == 2 || k == 3 || k == 6 || k == 7) cv::flip(m, m, 1);
      if (k == 3 || k == 4 || k == 7 || k == 8) cv::flip(m, m, 0);
      return m;
    };
    for (int k = 2; k <= 8; ++k) {
      write_page(bits, k);
      EXPECT_TRUE(equal(read_all(folder / "a.tif").at(0), turned(k))) << bits << " bits, orientation " << k;
      const StackInfo info = open_frames(folder / "a.tif")->info();
      EXPECT_EQ(info.width, k >= 5 ? kHeight : kWidth);
      ASSERT_EQ(info.notes.size(), notes + 1);
      expect_words(info.notes.back(), {fmt::format("orientation {}", k)});
    }
  }
}

// libtiff writes the formats that the writer of the tests cannot: compressed, tiled, floating point, colour.
TEST(TiffStack, CompressedTiledRealColour) {
  const TemporaryFolder folder;
  const std::string file = (folder / "a.tif").string();
  constexpr std::uint32_t width = 50, height = 37;
  for (const std::uint16_t compression :
       {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS})
    for (const bool tiled : {false, true}) {
      SCOPED_TRACE(fmt::format("compression {}, tiled {}", compression, tiled));
      TIFF* t = TIFFOpen(file.c_str(), "w");
      ASSERT_NE(t, nullptr);
      for (int page = 0; page < 2; ++page) {
        TIFFSetField(t, TIFFTAG_IMAGEWIDTH, width);
        TIFFSetField(t, TIFFTAG_IMAGELENGTH, height);
        TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 16);
        TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(t, TIFFTAG_COMPRESSION, compression);
        if (compression == COMPRESSION_LZW) TIFFSetField(t, TIFFTAG_PREDICTOR, 2);
        const cv::Mat picture = expected(width, height, page, 16, values(16));
        if (tiled) {
          TIFFSetField(t, TIFFTAG_TILEWIDTH, 32U);
          TIFFSetField(t, TIFFTAG_TILELENGTH, 16U);
          std::vector<ushort> tile(32 * 16);
          for (std::uint32_t y = 0; y < height; y += 16)
            for (std::uint32_t x = 0; x < width; x += 32) {
              for (std::uint32_t r = 0; r < 16 && y + r < height; ++r)
                for (std::uint32_t c = 0; c < 32 && x + c < width; ++c)
                  tile[r * 32 + c] = picture.at<ushort>(static_cast<int>(y + r), static_cast<int>(x + c));
              TIFFWriteTile(t, tile.data(), x, y, 0, 0);
            }
        } else {
          TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 8U);
          for (std::uint32_t y = 0; y < height; ++y) {
            cv::Mat row = picture.row(static_cast<int>(y)).clone();
            TIFFWriteScanline(t, row.data, y, 0);
          }
        }
        TIFFWriteDirectory(t);
      }
      TIFFClose(t);
      expect_stack(file, width, height, 2, 16, values(16));
    }
  cv::Mat1f real(5, 4);
  for (int i = 0; i < 20; ++i) real(i / 4, i % 4) = 0.25F * static_cast<float>(i) - 1;
  write_picture(file, real);
  EXPECT_TRUE(equal(read_all(file).at(0), real));
  write_picture(file, cv::Mat(6, 5, CV_16UC3, cv::Scalar(20000, 10000, 5000)));  // B, G, R
  const cv::Mat grey = read_all(file).at(0);
  ASSERT_EQ(grey.type(), CV_16UC1);
  EXPECT_NEAR(grey.at<ushort>(3, 3), 0.299 * 5000 + 0.587 * 10000 + 0.114 * 20000, 2);
}

TEST(TiffStack, APaletteIsRendered) {
  const TemporaryFolder folder;
  const std::string file = (folder / "a.tif").string();
  std::vector<std::uint16_t> red(256), green(256), blue(256);
  red[7] = 65535;
  green[8] = 65535;
  TIFF* t = TIFFOpen(file.c_str(), "w");
  ASSERT_NE(t, nullptr);
  TIFFSetField(t, TIFFTAG_IMAGEWIDTH, 2U);
  TIFFSetField(t, TIFFTAG_IMAGELENGTH, 1U);
  TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_PALETTE);
  TIFFSetField(t, TIFFTAG_COLORMAP, red.data(), green.data(), blue.data());
  std::array<std::uint8_t, 2> row = {7, 8};
  TIFFWriteScanline(t, row.data(), 0, 0);
  TIFFClose(t);
  const cv::Mat grey = read_all(file).at(0);
  EXPECT_NEAR(grey.at<uchar>(0, 0), 0.299 * 255, 1);
  EXPECT_NEAR(grey.at<uchar>(0, 1), 0.587 * 255, 1);
  expect_words(open_frames(file)->info().notes.at(0), {"palette", "8 bit"});
}

TEST(TiffStack, AnImageJStackOnOnePage) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.tif";
  const std::string words = "ImageJ=1.53t\nimages=5\nslices=5\nfinterval=0.002\nloop=false\n";
  for (const bool big_first : {false, true})
    for (const int bits : {8, 16}) {
      put_file(
          file,
          tiff_file(
              {.pages = 5, .bits = bits, .big_first = big_first, .description = words, .pages_written = 1},
              values(bits)));
      expect_stack(file, 32, 20, 5, bits, values(bits));
      EXPECT_EQ(open_frames(file)->info().frame_rate_hz, 500);
    }
  // "fps" is the speed at which ImageJ plays the stack; "finterval" is the camera's.
  put_file(file, tiff_file({.pages = 5, .description = "ImageJ=1.53t\nimages=5\nfps=7\n"}, values(16)));
  EXPECT_EQ(open_frames(file)->info().frame_rate_hz, 7);
  EXPECT_TRUE(open_frames(file)->info().playback);
  put_file(file,
           tiff_file({.pages = 5, .description = "ImageJ=1.53t\nfps=7\nfinterval=0.002\n"}, values(16)));
  EXPECT_EQ(open_frames(file)->info().frame_rate_hz, 500);
  EXPECT_FALSE(open_frames(file)->info().playback);
  // An ordinary stack with ImageJ's description is read page by page.
  put_file(file, tiff_file({.pages = 5, .description = words}, values(16)));
  expect_stack(file, 32, 20, 5, 16, values(16));
  // Planes that the description claims but the file lacks.
  put_file(file, tiff_file({.pages = 4, .description = words, .pages_written = 1}, values(16)));
  expect_words(refusal(file), {"a.tif", "truncated", "plane 5 of 5"});
  put_file(file, tiff_file({.pages = 1, .description = "ImageJ=1.53t\nimages=1e30\n"}, values(16)));
  expect_words(refusal(file), {"1e+30 planes"});
}

// The stack is beyond the range of a TIFF's 32-bit offsets, which is why ImageJ writes it on one page. It is
// also long, so that memory growing with the stack would be detected. The file is sparse except for its ends.
TEST(TiffStack, AboveFourGigabytesAndInLittleMemory) {
  if (kSanitized) GTEST_SKIP() << "Memory cannot be judged under a sanitizer.";
  const TemporaryFolder folder;
  const fs::path file = folder / "large.tif";
  constexpr int width = 1024, height = 1024, frames = 2100;
  constexpr std::uint64_t plane_bytes = std::uint64_t{width} * height * 2;
  const std::string head = tiff_file({.width = width,
                                      .height = height,
                                      .pages = frames,
                                      .big_first = true,
                                      .description = fmt::format("ImageJ=1.53t\nimages={}\n", frames),
                                      .pages_written = 1,
                                      .only_head = true},
                                     values(16));
  const std::uint64_t first = head.size() - plane_bytes;
  put_file(file, head);
  fs::resize_file(file, first + plane_bytes * frames);
  ASSERT_GT(fs::file_size(file), std::uint64_t{1} << 32);
  {
    std::fstream out(file, std::ios::in | std::ios::out | std::ios::binary);
    out.seekp(static_cast<std::streamoff>(first + plane_bytes * (frames - 1)));
    out << plane(width, height, 16, frames - 1, values(16), false, true);
  }
  const auto source = open_frames(file);
  ASSERT_EQ(source->announced(), static_cast<std::size_t>(frames));
  cv::Mat frame;
  ASSERT_TRUE(source->next(frame));
  EXPECT_TRUE(equal(frame, expected(width, height, 0, 16, values(16))));
  const long before = peak_kib();
  int read = 1;
  for (; source->next(frame); ++read) {
  }
  EXPECT_EQ(read, frames);
  EXPECT_TRUE(equal(frame, expected(width, height, frames - 1, 16, values(16))));
  EXPECT_LT(peak_kib() - before, 16 * 1024) << "KiB of memory for 2099 frames of 2 MiB";
}

// Many ordinary pages, so that memory kept per page would be detected.
TEST(TiffStack, PagesInLittleMemory) {
  if (kSanitized) GTEST_SKIP() << "Memory cannot be judged under a sanitizer.";
  const TemporaryFolder folder;
  const fs::path file = folder / "pages.tif";
  constexpr int frames = 400;
  put_file(file, tiff_file({.width = 512, .height = 256, .pages = frames}, values(16)));
  const auto source = open_frames(file);
  cv::Mat frame;
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(source->next(frame));
  const long before = peak_kib();
  int read = 40;
  for (; source->next(frame); ++read) {
  }
  EXPECT_EQ(read, frames);
  EXPECT_LT(peak_kib() - before, 8 * 1024) << "KiB of memory for 360 frames of 256 KiB";
}

TEST(TiffStack, Spoilt) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.tif";
  for (const bool big_tiff : {false, true}) {
    const std::string whole =
        tiff_file({.width = 13, .height = 5, .bits = 12, .big_tiff = big_tiff}, values(12));
    for (std::size_t n = 1; n < whole.size(); ++n) {
      put_file(file, whole.substr(0, n));
      const std::string sentence = refusal(file);
      ASSERT_NE(sentence.find("a.tif"), std::string::npos) << n << " of " << whole.size() << " bytes";
      EXPECT_EQ(std::count(sentence.begin(), sentence.end(), '\n'), 0) << sentence;
    }
  }
  // A cyclic chain of pages.
  std::string round = tiff_file({.pages = 1}, values(16));
  const std::size_t link = 8 + 2 + 9 * 12;
  ASSERT_EQ(round.substr(link, 4), std::string(4, '\0'));
  round[link] = 8;
  put_file(file, round);
  expect_words(refusal(file), {"a.tif", "no end"});
  // Pages of different sizes.
  std::string mixed = tiff_file({.pages = 2}, values(16));
  const std::size_t second =
      mixed.rfind(std::string("\x01\x01\x04\x00\x01\x00\x00\x00\x14", 9));  // height 20
  ASSERT_NE(second, std::string::npos);
  mixed[second + 8] = 10;
  put_file(file, mixed);
  expect_words(refusal(file), {"page 2: is 32 x 10", "page 1 is 32 x 20"});
  // More rows than there are pixels for, in one strip and in strips without a location.
  std::string tall = tiff_file({.pages = 1}, values(16));
  const std::size_t rows = 8 + 2 + 12, rows_per_strip = 8 + 2 + 7 * 12;
  ASSERT_EQ(tall.substr(rows, 2), "\x01\x01");
  ASSERT_EQ(tall.substr(rows_per_strip, 2), "\x16\x01");
  tall[rows + 8] = tall[rows_per_strip + 8] = 21;
  put_file(file, tall);
  expect_words(refusal(file), {"1280 bytes of pixels, of the 1344"});
  tall[rows_per_strip + 8] = 7;
  put_file(file, tall);
  expect_words(refusal(file), {"3 pieces, of which 1"});
  // Unreasonable image dimensions.
  std::string huge = tiff_file({.pages = 1}, values(16));
  huge[8 + 2 + 8 + 3] = 0x70;
  put_file(file, huge);
  expect_words(refusal(file), {"a.tif", "1879048224 x 20"});
}

}  // namespace twincell::tiff_stack_test
