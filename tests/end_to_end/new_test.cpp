// `new` as a user runs it: the shipped stacks against their hand-written cell files, and stacks with faults.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "imaging/cell/cell.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::new_test {
namespace {

namespace fs = std::filesystem;

const fs::path kDemo = fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo";

std::string frame_name(int f) {
  return fmt::format("frame_{:05}.png", f);
}

/// A copy of the first `n` frames of a shipped stack, without its cell file; `change` edits each frame.
fs::path copy_of(const TemporaryFolder& folder, const std::string& name, int n,
                 const std::function<cv::Mat(const cv::Mat&, int)>& change = nullptr) {
  const fs::path stack = folder / ("copy-of-" + name);
  fs::create_directory(stack);
  for (int f = 0; f < n; ++f) {
    if (change)
      write_picture(stack / frame_name(f), change(read_picture(kDemo / name / frame_name(f)), f));
    else
      fs::copy_file(kDemo / name / frame_name(f), stack / frame_name(f));
  }
  return stack;
}

nlohmann::json run_json(std::vector<std::string> words, int code = 0) {
  words.insert(words.end(), {"-q", "--json"});
  const Ran ran = run_program(words);
  EXPECT_EQ(ran.code, code) << ran.err;
  return ran.code == 0 ? nlohmann::json::parse(ran.out) : nlohmann::json();
}

/// s_b and s_c of the first frames of a stack, tracked with a cell file.
std::pair<double, double> order_of(const TemporaryFolder& folder, const fs::path& stack,
                                   const fs::path& cell) {
  const fs::path trajectory = folder / (cell.stem().string() + "-" + stack.filename().string() + ".h5");
  const Ran ran = run_program({"track", stack, "--cell", cell, "-o", trajectory, "-q"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  const nlohmann::json r = run_json({"analyze", trajectory, "--only", "s_b", "s_c"})["results"];
  return {r["s_b"]["value"], r["s_c"]["value"]};
}

/// \return the document of `new`, which must name `what` as not measured
nlohmann::json without(const fs::path& stack, const fs::path& cell, const std::string& what,
                       const std::string& why) {
  const nlohmann::json d = run_json({"new", stack, "-o", cell})["cells"][0];
  bool named = false;
  for (const auto& m : d["not_measured"])
    named = named || (m["what"] == what && m["why"].get<std::string>().find(why) != std::string::npos);
  EXPECT_TRUE(named) << d["not_measured"].dump(1);
  EXPECT_TRUE(fs::exists(fs::path(cell).replace_extension(".png")));
  return d;
}

TEST(New, TheShippedStacksGiveTheNumbersOfTheirHandWrittenCells) {
  const TemporaryFolder folder;
  struct Shipped {
    const char *gamma, *stack, *cell;
  };
  for (const auto& [gamma, name, by_hand] : {Shipped{"0.9", "gamma-0.9", "gamma-0.9/CELL.toml"},
                                             Shipped{"1.6", "gamma-1.6", "gamma-1.6/CELL.toml"},
                                             Shipped{"2.8", "gamma-2.8.tif", "gamma-2.8.toml"}}) {
    const fs::path stack = kDemo / name, cell = folder / (std::string(gamma) + ".toml");
    const nlohmann::json d = run_json({"new", stack, "-o", cell, "--drive-gamma", gamma})["cells"][0];
    EXPECT_TRUE(d["open"].empty() && d["not_measured"].empty()) << d.dump(1);
    const imaging::CellDescription hand = imaging::read_cell(kDemo / by_hand),
                                   found = imaging::read_cell(cell);
    const auto error = [&](const char* key, std::size_t k = 0) {
      return d["measured"][key][k]["standard_error"].get<double>();
    };
    EXPECT_NEAR(*found.pixels_per_sigma, *hand.pixels_per_sigma, 3 * error("camera.pixels_per_sigma"));
    EXPECT_NEAR(found.origin->x_px, hand.origin->x_px, 3 * error("camera.origin_px", 0));
    EXPECT_NEAR(found.origin->y_px, hand.origin->y_px, 3 * error("camera.origin_px", 1));
    EXPECT_NEAR(*found.width, *hand.width, 3 * error("cell.width_sigma"));
    EXPECT_NEAR(found.drive()->amplitude, hand.drive()->amplitude, 3 * error("drive.amplitude_sigma"));
    EXPECT_LT(error("camera.origin_px", 1), 0.01);
    EXPECT_LT(error("camera.pixels_per_sigma"), 0.01);
    EXPECT_LT(error("drive.amplitude_sigma"), 0.002);
    EXPECT_NEAR(found.drive()->omega, 1, 1e-3);
    EXPECT_EQ(found.phase_lock.frames_per_cycle, hand.phase_lock.frames_per_cycle);
    EXPECT_EQ(found.phase_lock.first_phase, 0);
    EXPECT_EQ(found.sides, Boundary::wall);
    EXPECT_EQ(found.rotation_deg, 0);
  }
}

TEST(New, TrackingWithTheWrittenCellGivesTheSameResults) {
  const TemporaryFolder folder;
  const fs::path cell = folder / "new.toml", stack = kDemo / "gamma-1.6", hand = folder / "hand.toml";
  fs::copy_file(stack / "CELL.toml", hand);
  ASSERT_EQ(run_program({"new", stack, "-o", cell, "--drive-gamma", "1.6", "-q"}).code, 0);
  const auto [s_b, s_c] = order_of(folder, stack, cell);
  const auto [s_b_hand, s_c_hand] = order_of(folder, stack, hand);
  // The scales differ by 2e-5, and so do all lengths; 0.1 % leaves room for the origin's 0.002 px.
  EXPECT_NEAR(s_b, s_b_hand, 1e-3 * s_b_hand);
  EXPECT_NEAR(s_c, s_c_hand, 1e-3 * s_c_hand);
  EXPECT_GT(s_b, 1.0 / 30);
}

TEST(New, WithoutAnswersPlaceholdersAreLeftThatEveryVerbRefusesByName) {
  const TemporaryFolder folder;
  const fs::path cell = folder / "CELL.toml", stack = kDemo / "gamma-0.9";
  const Ran ran = run_program({"new", stack, "-o", cell});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("2 values are still needed"), std::string::npos) << ran.out;
  EXPECT_NE(bytes_of(cell).find("sigma_mm = \"FILL IN: bead diameter in mm\""), std::string::npos)
      << bytes_of(cell);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"track", stack, "--cell", cell, "-o", folder / "a.h5"},
        {"match", stack, cell, "-o", folder / "b"},
        {"calibrate", "walls", stack, "--cell", cell}}) {
    const Ran refused = run_program(words);
    EXPECT_EQ(refused.code, 2) << words[0];
    EXPECT_NE(refused.err.find("scale.sigma_mm"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("bead diameter in mm"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("drive.frequency_hz"), std::string::npos) << refused.err;
  }
  EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"CELL.png", "CELL.toml"}));
}

TEST(New, AnEditedCellIsNotReplacedWithoutForce) {
  const TemporaryFolder folder;
  const fs::path cell = folder / "CELL.toml", stack = copy_of(folder, "gamma-0.9", 20);
  ASSERT_EQ(run_program({"new", stack, "-o", cell, "-q"}).code, 0);
  const std::string before = bytes_of(cell);
  const Ran ran = run_program({"new", stack, "-o", cell, "-q", "--drive-gamma", "0.9"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("CELL.toml: is an earlier cell file"), std::string::npos) << ran.err;
  EXPECT_EQ(bytes_of(cell), before);
  EXPECT_EQ(run_program({"new", stack, "-o", cell, "-q", "--drive-gamma", "0.9", "--force"}).code, 0);
  EXPECT_NE(bytes_of(cell), before);
}

TEST(New, SeveralStacksGetACellEachInOneFolder) {
  const TemporaryFolder folder;
  const fs::path a = copy_of(folder, "gamma-0.9", 22), b = copy_of(folder, "gamma-1.6", 22);
  const Ran wrong = run_program({"new", a, b, "-o", folder / "CELL.toml"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.err.find("2 stacks"), std::string::npos) << wrong.err;
  const nlohmann::json d =
      run_json({"new", a, b, "-o", folder / "cells", "--sigma-mm", "2", "--drive-hz", "11.15"});
  ASSERT_EQ(d["cells"].size(), 2U);
  // 2 mm and 11.15 Hz are omega = 1.0003 /t0: Gamma is A omega^2.
  EXPECT_NEAR(imaging::read_cell(folder / "cells/copy-of-gamma-0.9.toml").drive()->gamma(), 0.9, 0.003);
  EXPECT_NEAR(imaging::read_cell(folder / "cells/copy-of-gamma-1.6.toml").drive()->gamma(), 1.6, 0.003);
  // One Gamma for each stack.
  const Ran strengths = run_program({"new", a, b, "-o", folder / "by-gamma", "--drive-gamma", "0.9,1.6"});
  ASSERT_EQ(strengths.code, 0) << strengths.err;
  EXPECT_NE(strengths.out.find("next: twincell match " + a.string() + " " + b.string()), std::string::npos)
      << strengths.out;
  EXPECT_NEAR(imaging::read_cell(folder / "by-gamma/copy-of-gamma-0.9.toml").drive()->gamma(), 0.9, 1e-9);
  EXPECT_NEAR(imaging::read_cell(folder / "by-gamma/copy-of-gamma-1.6.toml").drive()->gamma(), 1.6, 1e-9);
  const Ran one = run_program({"new", a, b, "-o", folder / "no", "--drive-gamma", "0.9"});
  EXPECT_EQ(one.code, 2);
  EXPECT_NE(
      one.err.find("--drive-gamma: states 1 strength, but there are 2 stacks; state one for each stack"),
      std::string::npos)
      << one.err;
  EXPECT_FALSE(fs::exists(folder / "no"));
}

TEST(New, OneFrameGivesBeadsWallsAndSaysThatTheMotionIsMissing) {
  const TemporaryFolder folder;
  const fs::path cell = folder / "CELL.toml";
  const nlohmann::json d = without(copy_of(folder, "gamma-0.9", 1), cell, "the plate's motion", "1");
  EXPECT_TRUE(d["measured"].contains("camera.pixels_per_sigma")) << d.dump(1);
  EXPECT_TRUE(d["measured"].contains("cell.width_sigma"));
  EXPECT_NE(bytes_of(cell).find("frames_per_cycle = \"FILL IN"), std::string::npos) << bytes_of(cell);
  EXPECT_NE(bytes_of(cell).find("origin_px = \"FILL IN"), std::string::npos);
}

// One camera and one cell give one scale and one width; a stack that was enlarged, or whose walls are
// elsewhere, is noted.
TEST(New, StacksThatDifferInScaleOrWidthAreNoted) {
  const TemporaryFolder folder;
  const fs::path a = copy_of(folder, "gamma-0.9", 22),
                 b = copy_of(folder, "gamma-1.6", 22, [](const cv::Mat&frame, int) {
                   cv::Mat larger;
                   cv::resize(frame, larger, {}, 1.1, 1.1, cv::INTER_CUBIC);
                   return larger;
                 });
  const std::string scales = "the scales differ: 12.00 px per bead in ",
                    widths = "the distances of the side walls";
  const Ran ran = run_program({"new", a, b, "-o", folder / "cells", "--drive-gamma", "0.9,1.6"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.err.find(scales), std::string::npos) << ran.err;
  EXPECT_EQ(ran.err.find(widths), std::string::npos) << "in bead diameters the cell is the same\n" << ran.err;
  // Six columns more in the middle of the picture: the walls are half a bead further apart.
  const TemporaryFolder other;
  const fs::path c = copy_of(other, "gamma-1.6", 22, [](const cv::Mat& frame, int) {
    const int middle = frame.cols / 2;
    cv::Mat wider;
    cv::hconcat(std::vector<cv::Mat>{frame.colRange(0, middle), cv::repeat(frame.col(middle), 1, 6),
                                     frame.colRange(middle, frame.cols)},
                wider);
    return wider;
  });
  const Ran walls = run_program({"new", a, c, "-o", folder / "walls", "--drive-gamma", "0.9,1.6"});
  ASSERT_EQ(walls.code, 0) << walls.err;
  EXPECT_NE(walls.err.find(widths), std::string::npos) << walls.err;
  EXPECT_EQ(walls.err.find(scales), std::string::npos) << walls.err;
}

// A film without a plate, whose rate and frequency are stated.
TEST(New, FrameRateAndFrequencyGiveTheFramesPerCycle) {
  const TemporaryFolder folder;
  const fs::path stack = copy_of(folder, "gamma-0.9", 40, [](const cv::Mat& frame, int) {
    return frame(cv::Rect(0, 0, frame.cols, 150)).clone();  // above the plate
  });
  const auto frames_per_cycle = [&](const char* rate) {
    const fs::path cell = folder / "CELL.toml";
    const Ran ran = run_program({"new", stack, "-o", cell, "--frame-rate-hz", rate, "--drive-hz", "10",
                                 "--sigma-mm", "2", "--force"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    const std::string text = bytes_of(cell);
    const std::size_t at = text.find("frames_per_cycle = ");
    return at == std::string::npos ? std::string() : text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_TRUE(frames_per_cycle("200").starts_with("frames_per_cycle = 20 ")) << frames_per_cycle("200");
  EXPECT_TRUE(frames_per_cycle("200.5").starts_with("frames_per_cycle = 20 "));  // 0.1 frames in 40
  const std::string uneven = frames_per_cycle("175.2");
  EXPECT_TRUE(uneven.starts_with("frames_per_cycle = \"FILL IN")) << uneven;
  EXPECT_NE(uneven.find("is 17.52, no whole number"), std::string::npos) << uneven;
}

TEST(New, AFrameOfAnotherSizeEndsTheStackThere) {
  const TemporaryFolder folder;
  const fs::path stack = copy_of(folder, "gamma-0.9", 30, [](const cv::Mat& frame, int f) {
    return f == 25 ? frame(cv::Rect(0, 0, 100, 100)).clone() : frame;
  });
  const Ran ran = run_program({"new", stack, "-o", folder / "CELL.toml", "--drive-gamma", "0.9"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.err.find("only the first 25 frames are used"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("frame_00025.png"), std::string::npos) << ran.err;
  EXPECT_NEAR(imaging::read_cell(folder / "CELL.toml").drive()->amplitude, 0.9, 0.003);
}

TEST(New, AStackWithoutBeadsGivesWallsAndPlate) {
  const TemporaryFolder folder;
  // The cell as it would be empty: light everywhere above the plate and between the walls.
  const fs::path stack = copy_of(folder, "gamma-0.9", 22, [](const cv::Mat& frame, int f) {
    cv::Mat empty(frame.size(), CV_8U, cv::Scalar(20));
    const double plate = 186.2 - 10.8 * std::sin(2 * M_PI * f / 20);
    for (int r = 0; r < empty.rows; ++r)
      for (int c = 20; c < 140; ++c)
        empty.at<unsigned char>(r, c) =
            static_cast<unsigned char>(20 + 190 * std::clamp(plate - r, 0.0, 1.0));
    cv::GaussianBlur(empty, empty, {}, 0.8);
    return empty;
  });
  const nlohmann::json d = without(stack, folder / "CELL.toml", "the bead diameter", "no round beads");
  EXPECT_TRUE(d["measured"].contains("camera.origin_px")) << d.dump(1);
  EXPECT_EQ(d["frames_per_cycle"], 20);
  EXPECT_NE(bytes_of(folder / "CELL.toml").find("pixels_per_sigma = \"FILL IN"), std::string::npos);
}

TEST(New, WithoutThePlateInThePictureItsKeysAreLeftOpen) {
  const TemporaryFolder folder;
  // Above the highest position of the plate: only beads and walls are in the picture.
  const fs::path stack = copy_of(folder, "gamma-1.6", 30, [](const cv::Mat& frame, int) {
    return frame(cv::Rect(0, 0, frame.cols, 205)).clone();
  });
  const nlohmann::json d = without(stack, folder / "CELL.toml", "the plate", "");
  EXPECT_TRUE(d["measured"].contains("cell.width_sigma")) << d.dump(1);
  EXPECT_TRUE(d["measured"].contains("camera.pixels_per_sigma"));
  EXPECT_FALSE(d["measured"].contains("camera.origin_px")) << d.dump(1);
}

/// A stack in which nothing but beads is seen: discs on even ground, with some noise.
void draw_beads(const fs::path& trajectory, const fs::path& stack, double pixels_per_sigma, bool bright) {
  constexpr int kMargin = 40, kHeight = 420;
  const H5mdReader run(trajectory);
  fs::create_directory(stack);
  cv::RNG noise(7);
  Frame frame;
  for (std::size_t f = 0; f < run.n_frames(); ++f) {
    run.read(f, frame);
    const int width = static_cast<int>(pixels_per_sigma * run.info().box.upper.x()) + 2 * kMargin;
    const double ground = bright ? 15 : 210, disc = bright ? 200 : 40;
    cv::Mat picture(kHeight, width, CV_8U, cv::Scalar(ground)), grain(picture.size(), CV_16S);
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
      const double x = kMargin + pixels_per_sigma * frame.position[i].x(),
                   y = kHeight - 2 * kMargin - pixels_per_sigma * frame.position[i].z();
      const double radius = pixels_per_sigma * run.info().radius[i];
      for (int r = std::max(0, static_cast<int>(y - radius) - 1);
           r < std::min(kHeight, static_cast<int>(y + radius) + 2); ++r)
        for (int c = std::max(0, static_cast<int>(x - radius) - 1);
             c < std::min(width, static_cast<int>(x + radius) + 2); ++c) {
          const double inside = std::clamp(radius + 0.5 - std::hypot(c - x, r - y), 0.0, 1.0);
          auto& pixel = picture.at<unsigned char>(r, c);
          pixel = static_cast<unsigned char>(std::lround(pixel + inside * (disc - ground)) & 255);
          if (inside == 1) pixel = static_cast<unsigned char>(disc);
        }
    }
    cv::GaussianBlur(picture, picture, {}, 0.8);
    noise.fill(grain, cv::RNG::NORMAL, 0, 2);
    cv::add(picture, grain, picture, {}, CV_8U);
    write_picture(stack / frame_name(static_cast<int>(f)), picture);
  }
}

// Walls and plate are taken from the beads that touch them.
TEST(New, ACellWithoutEdgesIsMeasuredByItsBeads) {
  const TemporaryFolder folder;
  constexpr double kScale = 16;
  for (const double gamma : {0.8, 1.5})
    for (const std::string start : {"crystal_a", "random"}) {
      const std::string name = start + fmt::format("-{:g}", gamma);
      const fs::path scene = folder / (name + ".toml"), run = folder / (name + ".h5"), stack = folder / name,
                     cell = folder / (name + "-cell.toml");
      put_file(scene,
               fmt::format("preset = \"fortini-huang-2015\"\n[cell]\nwidth = 12.3\n[beads]\nlayers = "
                           "7\n[drive]\ngamma = {}\n[start]\nkind = \"{}\"\nperturbation = 1e-6\n[time]\n"
                           "steps_per_contact = 6.37\ndiscard = 3\ncycles = 5\nphases = 20\n",
                           gamma, start));
      ASSERT_EQ(run_program({"simulate", scene, "-o", run, "-q"}).code, 0) << name;
      draw_beads(run, stack, kScale, start == "random");
      const nlohmann::json d =
          run_json({"new", stack, "-o", cell, "--drive-gamma", fmt::format("{}", gamma)})["cells"][0];
      ASSERT_TRUE(d["open"].empty()) << name << d.dump(1);
      const imaging::CellDescription found = imaging::read_cell(cell);
      const auto near = [&](double value, double truth, double bound, const char* key, std::size_t k = 0) {
        EXPECT_NEAR(value, truth, bound) << name << ": " << key;
        EXPECT_NEAR(value, truth, 4 * d["measured"][key][k]["standard_error"].get<double>())
            << name << ": the stated error of " << key;
      };
      near(*found.width, 12.3, 0.03, "cell.width_sigma");
      near(found.origin->x_px, 40, 0.02 * kScale, "camera.origin_px", 0);
      near(found.origin->y_px, 420 - 80, 0.06 * kScale, "camera.origin_px", 1);
      near(found.drive()->amplitude, gamma, 0.05 * gamma, "drive.amplitude_sigma");
      EXPECT_EQ(found.phase_lock.frames_per_cycle, 20) << name;
      EXPECT_EQ(found.phase_lock.first_phase, 0) << name;
      EXPECT_EQ(found.sides, Boundary::wall) << name;
    }
}

// A heap without walls, and a strength that is not stated.
TEST(New, WhatTheBeadsDoNotShowIsLeftOpen) {
  const TemporaryFolder folder;
  put_file(
      folder / "s.toml",
      "preset = \"fortini-huang-2015\"\n[cell]\nwidth = 12.0\nsides = \"periodic\"\n[beads]\ncount = 60\n"
      "[drive]\ngamma = 1.5\n[start]\nkind = \"random\"\n[time]\nsteps_per_contact = 6.37\ndiscard = 3\n"
      "cycles = 4\nphases = 20\n");
  ASSERT_EQ(run_program({"simulate", folder / "s.toml", "-o", folder / "s.h5", "-q"}).code, 0);
  draw_beads(folder / "s.h5", folder / "stack", 16, false);
  const nlohmann::json d = without(folder / "stack", folder / "CELL.toml", "the plate", "no edge");
  EXPECT_FALSE(d["measured"].contains("cell.width_sigma")) << d.dump(1);
  EXPECT_FALSE(d["measured"].contains("camera.origin_px")) << d.dump(1);
  EXPECT_NE(d.dump().find("--drive-gamma"), std::string::npos);
}

// A film that was resized along one side, as by an editor that takes pixels for square ones.
TEST(New, PixelsThatAreNotSquareAreNoted) {
  const TemporaryFolder folder;
  for (const double wanted : {1.0, 1.08}) {
    double ratio = 0;
    const fs::path stack = copy_of(folder, "gamma-1.6", 40, [&](const cv::Mat& frame, int) {
      cv::Mat resized;
      cv::resize(frame, resized, {frame.cols, cvRound(wanted * frame.rows)}, 0, 0, cv::INTER_CUBIC);
      ratio = static_cast<double>(resized.rows) / frame.rows;
      return resized;
    });
    const auto expect = [&](const Ran& ran, const nlohmann::json& aspect) {
      EXPECT_NEAR(aspect["value"].get<double>(), ratio, 0.007);
      EXPECT_LT(aspect["standard_error"].get<double>(), 0.007);
      EXPECT_EQ(ran.err.find("its pixels are not square") == std::string::npos, wanted == 1) << ran.err;
    };
    const Ran drafted =
        run_program({"new", stack, "-o", folder / "c.toml", "--drive-gamma", "1.6", "--json", "--force"});
    ASSERT_EQ(drafted.code, 0) << drafted.err;
    expect(drafted, nlohmann::json::parse(drafted.out)["cells"][0]["aspect"]);
    const Ran tracked = run_program({"track", stack, "-o", folder / "t.h5", "--json", "--force"});
    ASSERT_EQ(tracked.code, 0) << tracked.err;
    expect(tracked, nlohmann::json::parse(tracked.out)["aspect"]);
  }
}

// A period of 6 2/3 frames: the command that `new` names, and the refusal of `match` without it, lead on.
TEST(New, APeriodThatIsNoWholeNumberOfFramesHasANextCommandThatWorks) {
  const TemporaryFolder folder;
  const fs::path stack = folder / "every-third", cell = folder / "CELL.toml";
  fs::create_directory(stack);
  for (int f = 0; f < 26; ++f) fs::copy_file(kDemo / "gamma-1.6" / frame_name(3 * f), stack / frame_name(f));
  const Ran made = run_program({"new", stack, "-o", cell, "--sigma-mm", "2", "--drive-hz", "15"});
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_NE(made.out.find("next: twincell match"), std::string::npos) << made.out;
  EXPECT_NE(made.out.find(" --phase-lock found -o twin/"), std::string::npos) << made.out;
  const Ran refused = run_program({"match", stack, cell, "-o", folder / "no", "-q"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--phase-lock found takes them from the plate"), std::string::npos)
      << refused.err;
  const Ran tracked =
      run_program({"track", stack, "--cell", cell, "--phase-lock", "found", "-o", folder / "t.h5", "-q"});
  EXPECT_EQ(tracked.code, 0) << tracked.err;
  const Ran whole = run_program({"new", copy_of(folder, "gamma-1.6", 40), "-o", folder / "WHOLE.toml"});
  EXPECT_EQ(whole.out.find("--phase-lock found -o"), std::string::npos) << whole.out;
}

TEST(New, AMissingStackIsAnError) {
  const TemporaryFolder folder;
  const Ran ran = run_program({"new", folder / "none", "-o", folder / "CELL.toml"});
  EXPECT_EQ(ran.code, 3);
  EXPECT_NE(ran.err.find("none"), std::string::npos);
  EXPECT_TRUE(names_in(folder.path()).empty());
}

namespace {

/// Films a bed of the first paper with coarse, noisy pixels and measures the film: folder/film,
/// folder/new.toml. \param bed keys of the scene \param gamma of the drive \param camera further options of
/// `render`
imaging::CellDescription measured_coarse_film(const TemporaryFolder& folder, const std::string& bed,
                                              const std::string& gamma, const std::string& camera) {
  put_file(folder / "scene.toml", "preset = \"fortini-huang-2015\"\nstart.kind = \"random\"\ndrive.gamma = " +
                                      gamma + "\ntime.discard = 4\n" + bed);
  EXPECT_EQ(run_program({"simulate", folder / "scene.toml", "-o", folder / "sim.h5", "-q"}).code, 0);
  std::vector<std::string> words = {"render", folder / "sim.h5", "-o", folder / "film", "-q"};
  std::istringstream options(
      "--pixels-per-sigma 8 --margin 26 --backlight 150 --electrons-per-level 8 "
      "--read-noise 3 " +
      camera);
  for (std::string word; options >> word;) words.push_back(word);
  EXPECT_EQ(run_program(words).code, 0);
  fs::remove(folder / "film/CELL.toml");
  EXPECT_EQ(
      run_program({"new", folder / "film", "-o", folder / "new.toml", "--drive-gamma", gamma, "-q"}).code, 0);
  return imaging::read_cell(folder / "new.toml");
}

}  // namespace

// A lamp in front lights the corners of a picture less than its middle. The walls, as bright as the beads,
// were taken for beads, and evidence from their pixels made profiles win, with a scale 1.6 % too small.
TEST(New, CoarseBrightBeadsUnderALampInFrontAreMeasured) {
  const TemporaryFolder folder;
  const imaging::CellDescription cell = measured_coarse_film(
      folder,
      "cell.width = 17.0\nbeads.count = 150\ndrive.omega = 1.8\nstart.seed = 11\ntime.cycles = "
      "5\ntime.phases = 10\n",
      "1.4",
      "--bright --seed 4 --rotation -0.8 --blur 0.9 --vignetting 0.3 --lamp-drift -0.1 --black-level 12");
  EXPECT_TRUE(cell.bright);
  EXPECT_EQ(cell.refine, std::nullopt);
  EXPECT_NEAR(cell.pixels_per_sigma.value(), 8, 0.02);
  EXPECT_NEAR(cell.width.value(), 17, 0.05);
  EXPECT_NEAR(cell.rotation_deg, -0.8, 0.05);
  EXPECT_EQ(cell.phase_lock.frames_per_cycle, 10);
  EXPECT_EQ(cell.phase_lock.first_phase, 0);
  const auto drive = cell.drive();
  ASSERT_TRUE(drive);
  EXPECT_NEAR(drive->amplitude, 1.4 / (1.8 * 1.8), 0.01);
  const Ran track = run_program(
      {"track", folder / "film", "--cell", folder / "new.toml", "-o", folder / "film.h5", "--json"});
  ASSERT_EQ(track.code, 0) << track.err;
  const auto found = nlohmann::json::parse(track.out);
  EXPECT_NEAR(found.at("tracks").get<double>(), 150, 5) << track.out;
  // A frame counter, far brighter than the beads, does not set the scale of darkness: the walls are still
  // seen.
  for (const auto& entry : fs::directory_iterator(folder / "film"))
    if (entry.path().extension() == ".png") {
      cv::Mat frame = read_picture(entry.path());
      cv::putText(frame, "01234", {2, 11}, cv::FONT_HERSHEY_SIMPLEX, 0.4, 255);
      write_picture(entry.path(), frame);
    }
  ASSERT_EQ(
      run_program({"new", folder / "film", "-o", folder / "text.toml", "--drive-gamma", "1.4", "-q"}).code,
      0);
  const imaging::CellDescription with_text = imaging::read_cell(folder / "text.toml");
  EXPECT_NEAR(with_text.pixels_per_sigma.value(), 8, 0.03);
  EXPECT_NEAR(with_text.width.value(), 17, 0.05);
  EXPECT_NEAR(with_text.origin.value().x_px, cell.origin.value().x_px, 0.1);
}

// Coarse, noisy beads hide the plate where it is lowest. A cycle of 22 to 24 frames, of which the same ones
// are lost each time, fitted the rest better than the film's 20.
TEST(New, ATroughThatIsNotSeenInventsNoLostFrames) {
  const TemporaryFolder folder;
  const imaging::CellDescription cell =
      measured_coarse_film(folder,
                           "cell.width = 12.0\nbeads.count = 100\ndrive.omega = 1.5\nstart.seed = "
                           "7\ntime.cycles = 6\ntime.phases = 20\n",
                           "1.2", "--seed 2");
  EXPECT_EQ(cell.phase_lock.frames_per_cycle, 20);
  EXPECT_EQ(cell.phase_lock.first_phase, 0);
  const auto drive = cell.drive();
  ASSERT_TRUE(drive);
  EXPECT_NEAR(drive->amplitude, 1.2 / (1.5 * 1.5), 0.01);
}

}  // namespace
}  // namespace twincell::new_test
