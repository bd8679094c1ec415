// Stacks as a user meets them: the same frames in every format give the same beads, `info` describes the
// stack, and an unreadable file is refused in one line.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "core/hdf5.hpp"
#include "tests/support/camera_files.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"

namespace twincell::frames_test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 160, kHeight = 120, kFrames = 3;

/// Back-lit discs of 12 bits that move to the right, drawn eight times as large and averaged to pixels.
std::vector<cv::Mat> discs() {
  std::vector<cv::Mat> frames;
  for (int f = 0; f < kFrames; ++f) {
    cv::Mat large(8 * kHeight, 8 * kWidth, CV_8U, cv::Scalar(215)), small, deep;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 3; ++j)
        cv::circle(large, {8 * (25 + 35 * i + 2 * f), 8 * (25 + 33 * j)}, 60, cv::Scalar(20), -1);
    cv::resize(large, small, {kWidth, kHeight}, 0, 0, cv::INTER_AREA);
    small.convertTo(deep, CV_16U, 16);
    frames.push_back(deep);
  }
  return frames;
}

void put(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class Frames : public ::testing::Test {
 protected:
  Frames() {
    const std::vector<cv::Mat> frames = discs();
    const PixelValue value = [&](int x, int y, int f) {
      return frames[static_cast<std::size_t>(f)].at<std::uint16_t>(y, x);
    };
    fs::create_directory(at("folder"));
    for (int f = 0; f < kFrames; ++f)
      write_picture(at("folder/f" + std::to_string(f) + ".png"), frames[static_cast<std::size_t>(f)]);
    put(at("a.cine"), cine_file({.width = kWidth, .height = kHeight, .frames = kFrames}, value));
    put(at("packed.cine"),
        cine_file({.width = kWidth, .height = kHeight, .frames = kFrames, .container = 12, .packing = 1024},
                  value));
    put(at("a.seq"),
        seq_file({.width = kWidth, .height = kHeight, .frames = kFrames, .bits = 16, .real_bits = 12},
                 value));
    put(at("a.mrf"), mrf_file(kWidth, kHeight, kFrames, 12, value));
    put(at("a.mraw"), planes(kWidth, kHeight, kFrames, 12, value));
    put(at("a.cih"), cih_text(kWidth, kHeight, kFrames, 12, 12));
    put(at("a.tif"), tiff_file({.width = kWidth, .height = kHeight, .pages = kFrames, .bits = 12}, value));
    put(at("imagej.tif"), tiff_file({.width = kWidth,
                                     .height = kHeight,
                                     .pages = kFrames,
                                     .big_first = true,
                                     .description = "ImageJ=1.53t\nimages=3\n",
                                     .pages_written = 1},
                                    value));
    h5::quiet();
    const h5::Handle file =
        h5::own(H5Fcreate(at("a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "a.h5");
    const std::string all = planes(kWidth, kHeight, kFrames, 16, value);
    const std::vector<hsize_t> shape = {kFrames, kHeight, kWidth};
    const h5::Handle space = h5::own(H5Screate_simple(3, shape.data(), nullptr), "space");
    const h5::Handle dataset = h5::own(
        H5Dcreate2(file.get(), "frames", H5T_STD_U16LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        "frames");
    h5::check(H5Dwrite(dataset.get(), H5T_STD_U16LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), "writing");
  }
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] nlohmann::json info(const std::string& name) const {
    const Ran ran = run_program({"info", at(name), "--json"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return nlohmann::json::parse(ran.out);
  }

  TemporaryFolder folder_;
};

TEST_F(Frames, TheSameInEveryFormatAndForAnyNumberOfThreads) {
  const auto located = [&](const std::string& name, const std::string& threads) {
    const Ran ran = run_program(
        {"locate", at(name), "--diameter", "15", "-o", at("beads.csv"), "--threads", threads, "-q"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.err, "");
    return bytes_of(at("beads.csv"));
  };
  const std::string beads = located("folder", "1");
  ASSERT_EQ(std::count(beads.begin(), beads.end(), '\n'), 1 + 12 * kFrames) << beads;
  for (const char* name : {"folder", "a.cine", "packed.cine", "a.seq", "a.mrf", "a.mraw", "a.cih", "a.tif",
                           "imagej.tif", "a.h5", "a.h5:/frames"})
    for (const char* threads : {"1", "3"})
      EXPECT_EQ(located(name, threads), beads) << name << ", " << threads << " threads";
}

TEST_F(Frames, AreDividedByAFlatField) {
  write_picture(at("blank.png"), cv::Mat(kHeight, kWidth, CV_16U, cv::Scalar(215 * 16)));
  write_picture(at("small.png"), cv::Mat(kHeight / 2, kWidth, CV_16U, cv::Scalar(215 * 16)));
  const auto located = [&](const std::vector<std::string>& options) {
    fs::remove(at("beads.csv"));
    std::vector<std::string> words = {"locate", at("folder"),    "--diameter", "15",
                                      "-o",     at("beads.csv"), "-q"};
    words.insert(words.end(), options.begin(), options.end());
    return run_program(words);
  };
  for (const std::string& flat : {std::string("stack"), at("blank.png")}) {
    const Ran ran = located({"--flat", flat});
    EXPECT_EQ(ran.code, 0) << ran.err;
    const std::string beads = bytes_of(at("beads.csv"));
    EXPECT_EQ(std::count(beads.begin(), beads.end(), '\n'), 1 + 12 * kFrames) << flat;
  }
  const auto refused = [&](const std::vector<std::string>& options, int code, const std::string& why) {
    const Ran ran = located(options);
    EXPECT_EQ(ran.code, code) << ran.err;
    EXPECT_NE(ran.err.find(why), std::string::npos) << ran.err;
    EXPECT_FALSE(fs::exists(at("beads.csv")));
  };
  refused({"--flat", at("small.png")}, 3, "the flat field is 160 x 60 px");
  refused({"--flat", at("nosuch")}, 3, "does not exist");
  refused({"--flat", "stack", "--bright"}, 2, "give frames of the cell without beads");
  const Ran tracked =
      run_program({"track", at("folder"), "--diameter", "15", "-o", at("t.h5"), "--flat", "stack", "-q"});
  EXPECT_EQ(tracked.code, 0) << tracked.err;
}

TEST_F(Frames, InfoSaysWhatTheyHold) {
  for (const char* name :
       {"folder", "a.cine", "packed.cine", "a.seq", "a.mrf", "a.mraw", "a.tif", "imagej.tif", "a.h5"}) {
    const nlohmann::json d = info(name);
    EXPECT_EQ(d["width"], kWidth) << name;
    EXPECT_EQ(d["height"], kHeight) << name;
    EXPECT_EQ(d["frames"], kFrames) << name;
    EXPECT_EQ(d["pixel_type"], "uint16") << name;
    EXPECT_EQ(d["first_frame"]["min"], 320) << name;
    EXPECT_EQ(d["first_frame"]["max"], 3440) << name;
    EXPECT_EQ(d["first_frame"]["bits"], 12) << name;
  }
  EXPECT_FALSE(info("folder").contains("bits"));  // a PNG does not state it
  for (const char* name : {"a.cine", "packed.cine", "a.seq", "a.mrf", "a.mraw", "a.tif"})
    EXPECT_EQ(info(name)["bits"], 12) << name;
  const nlohmann::json cine = info("a.cine");
  EXPECT_EQ(cine["first_number"], -2);
  EXPECT_EQ(cine["frame_rate_hz"], 1000);
  EXPECT_NEAR(cine["stamped_rate_hz"], 1000, 1e-3);  // time stamps count 2^-30 s, over 2 ms
  EXPECT_EQ(cine["time"]["origin"], "trigger");
  EXPECT_NEAR(cine["time"]["first_s"], -0.002, 1e-9);
  EXPECT_NEAR(cine["time"]["second_s"], -0.001, 1e-9);
  EXPECT_EQ(cine["recorded_unix"], 1600000000);
  const Ran text = run_program({"info", at("a.cine")});
  for (const char* words : {"Phantom cine", "160 x 120 px", "12 bits as stated by the file", "1000 frames/s",
                            "-0.002000000 s", "2020-09-13 12:26:40 UTC"})
    EXPECT_NE(text.out.find(words), std::string::npos) << words << "\n" << text.out;
}

TEST_F(Frames, InfoNotesWhatTheValuesSuggest) {
  const auto notes = [&](int bits, const PixelValue& value) {
    put(at("x.tif"), tiff_file({.width = 40, .height = 30, .pages = 1, .bits = bits}, value));
    std::string all;
    const nlohmann::json d = info("x.tif");
    for (const auto& sentence : d["notes"]) all += sentence.get<std::string>() + "\n";
    return all;
  };
  EXPECT_EQ(notes(16, [](int x, int y, int) { return static_cast<unsigned>(1000 + x + y); }), "");
  EXPECT_NE(notes(8, [](int, int, int) { return 0U; }).find("every pixel of the first frame has the value 0"),
            std::string::npos);
  // 36 of 1200 pixels are at the full scale of twelve bits; the limit for a note is a hundredth.
  const auto clipped = [](int wide) {
    return [wide](int x, int y, int) { return x < wide && y < 6 ? 4095U : static_cast<unsigned>(100 + x); };
  };
  EXPECT_NE(
      notes(16, clipped(6)).find("3.0 % of the first frame's pixels are 4095, the full scale of 12 bits"),
      std::string::npos);
  EXPECT_EQ(notes(16, clipped(2)), "");
  EXPECT_NE(notes(16, [](int x, int y, int) { return static_cast<unsigned>(1000 + x + y) << 4; })
                .find("multiple of 16: these may be 12-bit values"),
            std::string::npos);
}

TEST_F(Frames, ATrackOfADatasetRemembersItsFile) {
  const Ran ran = run_program({"track", at("a.h5:/frames"), "--diameter", "15", "-o", at("track.h5"), "-q"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json d = info("track.h5");
  EXPECT_EQ(d["provenance"]["inputs"][0]["path"].get<std::string>(), at("a.h5"));
  // A trajectory is not a stack, although it contains three-dimensional datasets.
  const Ran refused = run_program({"locate", at("track.h5"), "--diameter", "15", "-o", at("beads.csv")});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("trajectory (H5MD)"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(at("beads.csv")));
}

TEST_F(Frames, WhatCannotBeReadIsRefusedInOneLine) {
  put(at("empty.cine"), "");
  put(at("text.seq"), "hello\n");
  put(at("notes.txt"), "hello\n");
  put(at("lone.mraw"), "planes");
  put(at("cut.cine"), bytes_of(at("a.cine")).substr(0, 50000));
  put(at("cut.tif"), bytes_of(at("a.tif")).substr(0, 50000));
  const auto before = names_in(folder_.path());
  for (const auto& [name, words] :
       std::vector<std::pair<std::string, std::string>>{{"empty.cine", "is empty"},
                                                        {"text.seq", "not what its name says"},
                                                        {"notes.txt", "is not a stack of frames"},
                                                        {"lone.mraw", "lone.cih"},
                                                        {"cut.cine", "truncated"},
                                                        {"cut.tif", "truncated"},
                                                        {"a.h5:/none", "no dataset /none"},
                                                        {"a.cine:/frames", "not an HDF5 file"},
                                                        {"nowhere", "does not exist"}})
    for (const char* verb : {"info", "locate", "track"}) {
      std::vector<std::string> line{verb, at(name), "-q"};
      if (std::string(verb) != "info") line.insert(line.end(), {"--diameter", "15", "-o", at("out")});
      const Ran ran = run_program(line);
      EXPECT_EQ(ran.code, 3) << verb << " " << name << ": " << ran.err;
      EXPECT_EQ(ran.out, "");
      EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
      EXPECT_NE(ran.err.find(words), std::string::npos) << "wanted: " << words << ", said: " << ran.err;
    }
  EXPECT_EQ(names_in(folder_.path()), before);
}

TEST_F(Frames, WithoutFfmpegOneSentenceSaysSo) {
  put(at("noise.mp4"), std::string("\0\x01\x02\x03", 4) + std::string(5000, '\x7f'));
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const Ran ran = run_program({"info", at("noise.mp4")});
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  for (const char* words : {"noise.mp4", "OpenCV", "ffmpeg", "not installed"})
    EXPECT_NE(ran.err.find(words), std::string::npos) << words << " is not in: " << ran.err;
}

}  // namespace
}  // namespace twincell::frames_test
