// The synthetic camera against closed forms. Its images must be exact, because the locators are measured on
// them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "imaging/camera/noise_matched_camera.hpp"
#include "imaging/camera/sensor.hpp"
#include "imaging/camera/synthetic_camera.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::camera_test {

using namespace imaging;

namespace {

constexpr double kPixelVariance = 1.0 / 12;

/// A square cell without walls; the plate is below the image.
TrajectoryInfo empty_cell(double side, std::size_t beads = 1) {
  TrajectoryInfo info;
  info.n_beads = beads;
  info.box.upper = Vec3(side, 0.5, side);
  info.box.boundary[0] = Boundary::open;
  return info;
}

Frame frame_with(std::vector<Vec3> positions) {
  Frame frame;
  frame.position = std::move(positions);
  frame.plate_height = -100;
  return frame;
}

CameraOptions plain() {
  CameraOptions o;
  o.vignetting = 0;
  o.margin_px = 0;
  o.electrons_per_level = 0;
  o.read_noise = 0;
  return o;
}

/// Frames in memory.
class Held : public FrameSource {
 public:
  explicit Held(std::vector<cv::Mat> frames) : frames_(std::move(frames)) {}
  bool next(cv::Mat& frame) override {
    if (next_ == frames_.size()) return false;
    frame = frames_[next_++];
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return frames_.size(); }
  [[nodiscard]] std::string current() const override { return "memory"; }

 private:
  std::vector<cv::Mat> frames_;
  std::size_t next_ = 0;
};

/// Moments of the darkness of an image.
struct Moments {
  double mass = 0, x = 0, y = 0, xx = 0, yy = 0;
};
Moments moments_of(const cv::Mat1f& light, double backlight) {
  Moments m;
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      const double d = 1 - double{light(y, x)} / backlight;
      m.mass += d;
      m.x += d * x;
      m.y += d * y;
    }
  m.x /= m.mass;
  m.y /= m.mass;
  for (int y = 0; y < light.rows; ++y)
    for (int x = 0; x < light.cols; ++x) {
      const double d = 1 - double{light(y, x)} / backlight;
      m.xx += d * (x - m.x) * (x - m.x);
      m.yy += d * (y - m.y) * (y - m.y);
    }
  m.xx /= m.mass;
  m.yy /= m.mass;
  return m;
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Free flight under g = 1, with or without velocities.
MemoryTrajectory flight(bool velocities, int frames = 40, double step = 0.1) {
  TrajectoryInfo info = empty_cell(12, 2);
  info.columns.velocity = velocities;
  MemoryTrajectory trajectory(info);
  for (int f = 0; f < frames; ++f) {
    const double t = step * f;
    Frame frame = frame_with(
        {Vec3(2 + 0.8 * t, 0, 3 + 2.5 * t - 0.5 * t * t), Vec3(9 - 0.5 * t, 0, 2 + 3 * t - 0.5 * t * t)});
    frame.step = f;
    frame.time = t;
    if (velocities) frame.velocity = {Vec3(0.8, 0, 2.5 - t), Vec3(-0.5, 0, 3 - t)};
    trajectory.append(frame);
  }
  return trajectory;
}

}  // namespace

// Mass pi R^2, centre c, variance per axis R^2/4 + s^2 + 1/12: a disc convolved with any kernel of unit mass.
// The sum over pixels gives the mass exactly. The centre and the width are exact only to the extent that the
// blur hides the grid, up to exp(-2 (pi s)^2).
TEST(Camera, MassCentreAndWidthOfADiscAreExact) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> place(3.4, 4.6);
  for (const double blur : {0.4, 0.8, 2.0}) {
    double worst_mass = 0, worst_centre = 0, worst_width = 0;
    for (const double size : {4.0, 8.0, 15.0, 15.013, 30.0})
      for (int i = 0; i < 5; ++i) {
        CameraOptions o = plain();
        o.pixels_per_sigma = size;
        o.blur_px = blur;
        o.margin_px = 10;
        const SyntheticCamera camera(o, empty_cell(8));
        const double x = place(generator);
        const Frame frame = frame_with({Vec3(x, 0, place(generator))});
        const Exposure exposure{.now = &frame};
        const Moments m = moments_of(camera.light(exposure), o.backlight);
        const TrueBead truth = camera.truth(exposure).at(0);
        const double radius = size / 2;
        worst_mass = std::max(worst_mass, std::abs(m.mass / (std::numbers::pi * radius * radius) - 1));
        worst_centre = std::max({worst_centre, std::abs(m.x - truth.x), std::abs(m.y - truth.y)});
        const double width = radius * radius / 4 + blur * blur + kPixelVariance;
        worst_width = std::max({worst_width, std::abs(m.xx / width - 1), std::abs(m.yy / width - 1)});
        EXPECT_DOUBLE_EQ(truth.visible, 1);
      }
    std::cout << "blur " << blur << " px: largest error of mass " << worst_mass << ", centre " << worst_centre
              << " px, variance " << worst_width << "\n";
    const double grid = std::exp(-2 * std::pow(std::numbers::pi * blur, 2));
    EXPECT_LE(worst_mass, 1e-4);
    EXPECT_LE(worst_centre, 1e-4 + 0.01 * grid);
    EXPECT_LE(worst_width, 3e-4 + 0.1 * grid);
  }
}

// The same disc, drawn on a grid 64 times as fine, blurred and averaged over pixels by OpenCV.
TEST(Camera, PixelsAgreeWithABruteForcePicture) {
  constexpr int kFine = 64, kSide = 32;
  const double radius = 7.5, blur = 0.8, cx = 15.37, cy = 16.21;
  cv::Mat1f fine(kSide * kFine, kSide * kFine, 1.0F);
  for (int y = 0; y < fine.rows; ++y)
    for (int x = 0; x < fine.cols; ++x)
      fine(y, x) = static_cast<float>(std::clamp(
          0.5 + kFine * (std::hypot((x + 0.5) / kFine - 0.5 - cx, (y + 0.5) / kFine - 0.5 - cy) - radius),
          0.0, 1.0));
  cv::GaussianBlur(fine, fine, {641, 641}, blur * kFine);
  cv::Mat1f coarse;
  cv::resize(fine, coarse, {kSide, kSide}, 0, 0, cv::INTER_AREA);
  CameraOptions o = plain();
  o.pixels_per_sigma = 15;
  o.backlight = 1;
  const SyntheticCamera camera(o, empty_cell(kSide / 15.0));
  ASSERT_EQ(camera.size(), cv::Size(kSide, kSide));
  const Frame frame = frame_with({camera.pixel_frame().cell_from_pixel({cx, cy})});
  const double worst = cv::norm(camera.light({.now = &frame}), coarse, cv::NORM_INF);
  std::cout << "largest difference of a pixel " << worst << " of the light\n";
  EXPECT_LE(worst, 5e-5);
}

TEST(Camera, ATurnedOrMirroredSceneIsATurnedOrMirroredPicture) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> place(1, 9);
  std::vector<Vec3> beads;
  for (int i = 0; i < 20; ++i) {
    const double x = place(generator);
    beads.emplace_back(x, 0, place(generator));
  }
  const TrajectoryInfo info = empty_cell(10, beads.size());
  CameraOptions o = plain();
  o.vignetting = 0.4;
  o.distortion = 0.05;
  const SyntheticCamera upright(o, info);
  const Frame frame = frame_with(beads);
  const cv::Mat1f light = upright.light({.now = &frame});
  for (const auto& [angle, how] : {std::pair{90, cv::ROTATE_90_COUNTERCLOCKWISE},
                                   {180, cv::ROTATE_180},
                                   {-90, cv::ROTATE_90_CLOCKWISE}}) {
    o.rotation_deg = angle;
    cv::Mat1f turned;
    cv::rotate(light, turned, how);
    EXPECT_LE(cv::norm(SyntheticCamera(o, info).light({.now = &frame}), turned, cv::NORM_INF), 2e-3)
        << angle << " degrees";
  }
  Frame mirrored = frame;
  for (Vec3& r : mirrored.position) {
    PixelPoint p = upright.pixel_frame().pixel_from_cell(r);
    p.x_px = upright.size().width - 1 - p.x_px;
    r = upright.pixel_frame().cell_from_pixel(p);
  }
  cv::Mat1f flipped;
  cv::flip(light, flipped, 1);
  EXPECT_LE(cv::norm(upright.light({.now = &mirrored}), flipped, cv::NORM_INF), 2e-3) << "of 215 grey levels";
}

TEST(Camera, LensAndItsInverse) {
  for (const double k1 : {-0.2, -0.05, 0.0, 0.1, 0.2})
    for (const double angle : {0.0, 3.0, 90.0, -127.0}) {
      const Lens lens({600, 1500}, angle, k1);
      for (double x = 0; x <= 600; x += 60)
        for (double y = 0; y <= 1500; y += 150) {
          const PixelPoint seen = lens.picture_from_ideal({x, y}), back = lens.ideal_from_picture(seen);
          EXPECT_NEAR(back.x_px, x, 1e-9);
          EXPECT_NEAR(back.y_px, y, 1e-9);
        }
    }
  // The corner of the image is half a diagonal from the middle. It moves by k1 times that distance; the
  // middle does not move.
  const Lens lens({600, 1500}, 0, 0.02);
  EXPECT_NEAR(lens.picture_from_ideal({-0.5, -0.5}).x_px, 299.5 - 1.02 * 300, 1e-9);
  EXPECT_NEAR(lens.picture_from_ideal({299.5, 749.5}).x_px, 299.5, 1e-12);
  // Counter-clockwise as seen: a point to the right of the middle moves above it.
  const PixelPoint turned = Lens({101, 101}, 90, 0).picture_from_ideal({70, 50});
  EXPECT_NEAR(turned.x_px, 50, 1e-12);
  EXPECT_NEAR(turned.y_px, 30, 1e-12);
}

// The centre of a disc's image differs slightly from the image of the disc's centre: by 3 k1 R^2 v/u^2 to
// first order in k1, where v is the position from the middle and u is half the diagonal. One third is the
// mean of the map, two thirds the change of area.
TEST(Camera, UnderDistortionTheCentreOfAPictureIsOffByItsClosedForm) {
  CameraOptions o = plain();
  o.distortion = -0.02;
  o.rotation_deg = 17;
  const SyntheticCamera camera(o, empty_cell(40));
  const double u = 0.5 * std::hypot(camera.size().width, camera.size().height),
               middle = 0.5 * (camera.size().width - 1);
  for (const Vec3& r : {Vec3(20, 0, 20), Vec3(30, 0, 25), Vec3(8, 0, 10)}) {
    const Frame frame = frame_with({r});
    const Exposure exposure{.now = &frame};
    const Moments m = moments_of(camera.light(exposure), o.backlight);
    const TrueBead truth = camera.truth(exposure).at(0);
    const double off = 3 * o.distortion * 7.5 * 7.5 / (u * u);
    EXPECT_NEAR(m.x - truth.x, off * (truth.x - middle), 5e-4);
    EXPECT_NEAR(m.y - truth.y, off * (truth.y - middle), 5e-4);
    EXPECT_NEAR(m.mass / (std::numbers::pi * truth.radius * truth.radius), 1, 1e-3);
  }
}

// Uniform motion over a length L adds L^2/12 to the variance along the motion; the centre is that of the
// mid-exposure position.
TEST(Camera, MotionBlurFollowsTheVelocity) {
  TrajectoryInfo info = empty_cell(8);
  info.columns.velocity = true;
  CameraOptions o = plain();
  o.exposure = 0.1;
  const SyntheticCamera camera(o, info);
  Frame frame = frame_with({Vec3(4.03, 0, 3.98)});
  for (const double speed : {0.5, 2.0, 6.0}) {
    frame.velocity = {Vec3(0.6 * speed, 0, 0.8 * speed)};
    const Exposure exposure{.now = &frame};
    const Moments m = moments_of(camera.light(exposure), o.backlight);
    const TrueBead truth = camera.truth(exposure).at(0);
    const double length = 0.1 * speed * 15, still = 7.5 * 7.5 / 4 + 0.8 * 0.8 + kPixelVariance;
    EXPECT_NEAR(m.x, truth.x, 1e-3);
    EXPECT_NEAR(m.y, truth.y, 1e-3);
    EXPECT_NEAR(m.xx - still, 0.36 * length * length / 12, 5e-3);
    EXPECT_NEAR(m.yy - still, 0.64 * length * length / 12, 5e-3);
  }
}

// In free flight both methods of path interpolation are exact at any time between two frames.
TEST(Camera, PathsBetweenFramesAreExactInFreeFlight) {
  for (const bool velocities : {true, false}) {
    const MemoryTrajectory film = flight(velocities);
    const Shutter shutter(film.info());
    for (const double tau : {-0.1, -0.043, 0.0, 0.02, 0.07}) {
      const Exposure exposure{&film.frames()[9], &film.frames()[10], &film.frames()[11]};
      const double t = 1 + tau;
      const Vec3 r = shutter.position(exposure, 0, tau);
      EXPECT_NEAR(r.x(), 2 + 0.8 * t, 1e-12);
      EXPECT_NEAR(r.z(), 3 + 2.5 * t - 0.5 * t * t, 1e-12);
    }
  }
}

TEST(Camera, NoiseHasTheVarianceOfItsElectrons) {
  for (const double level : {0.05, 0.5, 3.0, 20.0, 200.0}) {
    CameraOptions o;
    o.electrons_per_level = 4;
    o.read_noise = 0.7;
    o.black_level = 10;
    o.bits = 12;
    const cv::Mat picture = read_out(cv::Mat1f(400, 500, static_cast<float>(level)), o, 7);
    cv::Scalar mean, deviation;
    cv::meanStdDev(picture, mean, deviation);
    const double expected = level / 4 + 0.49 + 1.0 / 12 / 256;
    const double n = 400.0 * 500;
    EXPECT_NEAR(mean[0] / 16, level + 10, 5 * std::sqrt(expected / n));
    EXPECT_NEAR(deviation[0] * deviation[0] / 256 / expected, 1, 5 * std::sqrt(2 / n) * 1.5);
  }
}

TEST(Camera, DepthChangesTheCountingAndNothingElse) {
  CameraOptions o = plain();
  const cv::Mat1f light(3, 3, 123.4F);
  for (const int bits : {8, 10, 12, 14, 16}) {
    o.bits = bits;
    const cv::Mat picture = read_out(light, o, 0);
    const double value = bits == 8 ? picture.at<std::uint8_t>(1, 1) : picture.at<std::uint16_t>(1, 1);
    EXPECT_EQ(value, std::round(double{123.4F} * std::ldexp(1, bits - 8)));
    const cv::Mat white = read_out(cv::Mat1f(1, 1, 1e6F), o, 0);
    EXPECT_EQ(bits == 8 ? white.at<std::uint8_t>(0, 0) : white.at<std::uint16_t>(0, 0), (1 << bits) - 1);
  }
}

TEST(Camera, DiscsHideEachOtherInThreeDimensionsOnly) {
  TrajectoryInfo info = empty_cell(8, 2);
  info.box.dimension = 3;
  const SyntheticCamera camera(plain(), info);
  const Frame frame = frame_with({Vec3(4, 0, 4), Vec3(4.5, 0.9, 4)});
  const Exposure exposure{.now = &frame};
  const Moments m = moments_of(camera.light(exposure), plain().backlight);
  // Area of the union of two circles of radius R whose centres are R apart.
  const double lens = 2 * std::acos(0.5) - 0.5 * std::sqrt(3.0);
  EXPECT_NEAR(m.mass / (7.5 * 7.5), 2 * std::numbers::pi - lens, 0.03);
  // A third of each rim is inside the other disc: the cosine of half the angle is 1/2.
  EXPECT_NEAR(camera.truth(exposure).at(0).visible, 2.0 / 3, 0.04);
}

TEST(Camera, GlareIsAtItsStatedPosition) {
  CameraOptions o = plain();
  o.glare = 0.5;
  const TrajectoryInfo info = empty_cell(8);
  const Frame frame = frame_with({Vec3(4, 0, 4)});
  for (const auto& [kind, off] : {std::pair{"reflected", -0.35 * 7.5}, {"transmitted", 0.0}}) {
    o.glare_kind = kind;
    o.glare = 0.5;
    const SyntheticCamera camera(o, info);
    o.glare = 0;
    const cv::Mat1f spot = camera.light({.now = &frame}) - SyntheticCamera(o, info).light({.now = &frame});
    const TrueBead truth = camera.truth({.now = &frame}).at(0);
    const cv::Moments m = cv::moments(spot);
    EXPECT_NEAR(m.m10 / m.m00, truth.x + off, 1e-2);
    EXPECT_NEAR(m.m01 / m.m00, truth.y + off, 1e-2);
  }
}

TEST(Camera, DroppedAndDoubledFramesAreKeptTrackOf) {
  const TemporaryFolder folder;
  CameraOptions o;
  o.drop = 0.2;
  o.doubled = 0.2;
  o.trigger_offset = 0.03;
  o.trigger_jitter = 0.005;
  const MemoryTrajectory film = flight(true);
  const Rendered done = render(film, o, RenderJob{.folder = folder / "a", .threads = 1});
  EXPECT_GT(done.dropped, 0U);
  EXPECT_GT(done.doubled, 0U);
  EXPECT_EQ(done.frames, film.n_frames() - done.dropped + done.doubled);
  std::ifstream record(folder / "a" / "frames.csv"), truth(folder / "a" / "truth.csv");
  std::string line;
  std::getline(record, line);
  std::getline(truth, line);
  std::size_t stored = 0, doubles = 0;
  for (; std::getline(record, line); ++stored) {
    std::stringstream row(line);
    std::vector<std::string> cell;
    for (std::string word; std::getline(row, word, ',');) cell.push_back(word);
    const double t = std::stod(cell[3]);
    EXPECT_NEAR(t, 0.1 * std::stod(cell[1]) + 0.03, 0.03) << "the time at which the picture was really taken";
    doubles += cell[10] == "1" ? 1 : 0;
    if (cell[10] == "1") {
      EXPECT_EQ(bytes_of(folder / "a" / fmt::format("frame_{:05}.png", stored)),
                bytes_of(folder / "a" / fmt::format("frame_{:05}.png", stored - 1)));
    }
    // Both beads are in the image throughout. The true position of the first one is that of its flight at
    // time t.
    ASSERT_TRUE(std::getline(truth, line));
    std::stringstream first(line);
    std::vector<double> number;
    for (std::string word; std::getline(first, word, ',');) number.push_back(std::stod(word));
    const SyntheticCamera camera(read_camera(folder / "a" / "CAMERA.toml"), film.info());
    const PixelPoint p =
        camera.pixel_frame().pixel_from_cell(Vec3(2 + 0.8 * t, 0, 3 + 2.5 * t - 0.5 * t * t));
    EXPECT_EQ(number[0], static_cast<double>(stored));
    EXPECT_NEAR(number[2], p.x_px, 2e-5);
    EXPECT_NEAR(number[3], p.y_px, 2e-5);
    std::getline(truth, line);
  }
  EXPECT_EQ(stored, done.frames);
  EXPECT_EQ(doubles, done.doubled);
}

TEST(Camera, ThreadsDoNotMatter) {
  const TemporaryFolder folder;
  CameraOptions o;
  o.exposure = 0.05;
  o.trigger_jitter = 0.01;
  o.lamp_flicker = 0.05;
  o.dust = 5;
  o.scratches = 2;
  o.drop = 0.1;
  const MemoryTrajectory film = flight(true, 25);
  const Rendered one = render(film, o, RenderJob{.folder = folder / "one", .threads = 1});
  const Rendered three = render(film, o, RenderJob{.folder = folder / "three", .threads = 3});
  ASSERT_EQ(one.frames, three.frames);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "one")) {
    EXPECT_EQ(bytes_of(entry.path()), bytes_of(folder / "three" / entry.path().filename()))
        << entry.path().filename();
    ++files;
  }
  EXPECT_EQ(files, one.frames + 5);  // truth, record, cell, camera, manifest
}

TEST(Camera, AFilmHasItsFrames) {
  const TemporaryFolder folder;
  const MemoryTrajectory film = flight(true, 12);
  for (const char* name : {"film.mp4", "film.avi"}) {
    render(film, CameraOptions{.bits = 12}, RenderJob{.movie = folder / name});
    EXPECT_GT(std::filesystem::file_size(folder / name), 1000U);
  }
  EXPECT_THROW(render(film, {}, RenderJob{.movie = folder / "film.gif"}), ConfigError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2)
      << "nothing half-written stays";
}

TEST(Camera, OptionsFileIsReadBackAndRefusesWhatItDoesNotKnow) {
  const TemporaryFolder folder;
  CameraOptions o;
  o.glare_kind = "transmitted";
  o.bits = 10;
  o.bright = true;
  o.distortion = -0.0123456789;
  o.seed = 42;
  put_file(folder / "CAMERA.toml", camera_text(o));
  EXPECT_EQ(camera_text(read_camera(folder / "CAMERA.toml")), camera_text(o));
  for (const char* bad : {"blur = 9.0", "glare_kind = \"blue\"", "bits = 9", "blurr = 1.0", "bright = 3"}) {
    put_file(folder / "bad.toml", bad);
    EXPECT_THROW(read_camera(folder / "bad.toml"), ConfigError) << bad;
  }
}

// Beads of 2 mm: t0 = 14.2784 ms, so 714 us are 0.05 t0.
TEST(Camera, LaboratoryUnitsGiveTheReducedOptions) {
  const TemporaryFolder folder;
  const Scale scale{.sigma_m = 0.002, .gravity_m_s2 = 9.81, .pixels_per_sigma = {}};
  put_file(
      folder / "c.toml",
      "exposure_us = 713.92\ntrigger_jitter_us = 142.784\ntrigger_offset_t0 = 0.02\nmax_height_mm = 24\n");
  const CameraOptions stated = read_camera(folder / "c.toml"), o = stated.reduced(scale);
  EXPECT_NEAR(o.exposure, 0.05, 1e-6);
  EXPECT_NEAR(o.trigger_jitter, 0.01, 1e-6);
  EXPECT_EQ(o.trigger_offset, 0.02);
  EXPECT_DOUBLE_EQ(o.max_height, 12);
  put_file(folder / "again.toml", camera_text(o));
  EXPECT_EQ(read_camera(folder / "again.toml").reduced(scale).exposure, o.exposure);
  put_file(folder / "again.toml", camera_text(stated));
  EXPECT_EQ(read_camera(folder / "again.toml").reduced(scale).exposure, o.exposure);
  expect_refusal<ConfigError>([&] { (void)stated.reduced({}); }, "max-height-mm", "scale.sigma_mm");
  put_file(folder / "bare.toml", "exposure = 0.05\n");
  const CameraOptions bare = read_camera(folder / "bare.toml");
  EXPECT_EQ(bare.reduced({}).exposure, 0.05);
  expect_refusal<ConfigError>([&] { (void)bare.reduced(scale); }, "exposure: is 0.05 without a unit",
                              "exposure-t0", "exposure-us");
  put_file(folder / "twice.toml", "exposure_t0 = 0.05\nexposure_us = 714\n");
  expect_refusal<ConfigError>([&] { (void)read_camera(folder / "twice.toml"); }, "twice.toml:", "exposure_t0",
                              "give only one of the two");
  put_file(folder / "low.toml", "exposure_us = -1\n");
  expect_refusal<ConfigError>([&] { (void)read_camera(folder / "low.toml"); }, "exposure_us", "at least 0");
}

TEST(Camera, PathsThatCannotBeDrawnAreRefused) {
  TrajectoryInfo info = empty_cell(8);
  info.phases_per_cycle = 4;
  CameraOptions o;
  o.exposure = 0.1;
  EXPECT_THROW(SyntheticCamera(o, info), ConfigError);
  info.phases_per_cycle = 8;
  EXPECT_NO_THROW(SyntheticCamera(o, info));
  const TemporaryFolder folder;
  o.exposure = 100;  // longer than the whole record
  expect_refusal<ConfigError>([&] { render(flight(true), o, RenderJob{.folder = folder / "a"}); }, "exposure",
                              "t0 is longer than");
  o = {};
  o.trigger_jitter = 1;
  EXPECT_THROW(render(flight(true), o, RenderJob{.folder = folder / "a"}), ConfigError)
      << "frames would change places";
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
}

TEST(CameraLike, FindsTheNoiseOfAnotherCamera) {
  // Touching beads in the lower half, light above. The images have 12 bits, so the grey levels are those of
  // another camera.
  std::vector<Vec3> beads;
  for (int x = 0; x < 12; ++x)
    for (int z = 0; z < 6; ++z) beads.emplace_back(x + 0.5, 0, z + 0.5);
  for (const auto& [read_noise, electrons] : {std::pair(4.0, 20.0), {2.0, 0.0}, {8.0, 10.0}}) {
    CameraOptions other;
    other.pixels_per_sigma = 24;
    other.bits = 12;
    other.read_noise = read_noise;
    other.electrons_per_level = electrons;
    other.backlight = 150;
    const SyntheticCamera camera(other, empty_cell(12, beads.size()));
    std::vector<cv::Mat> frames;
    for (int f = 0; f < 3; ++f) {
      Frame frame = frame_with(beads);
      frame.step = f;
      frames.push_back(camera.expose(frame));
    }
    Held stack(frames);
    const CameraOptions like = with_noise_of(stack, 24, false, plain());
    // The noise is compared as a fraction of the light: 4 levels of 150 are 5.73 of 215. Black is clipped at
    // 0, so dark pixels show less noise than there is; bright pixels show all of it.
    const auto in_the_light = [](const CameraOptions& o) {
      return std::pow(o.read_noise / o.backlight, 2) +
             (o.electrons_per_level > 0 ? 1 / (o.electrons_per_level * o.backlight) : 0);
    };
    EXPECT_NEAR(in_the_light(like) / in_the_light(other), 1, 0.15) << read_noise << " " << electrons;
  }
  // Noise below one level of an 8-bit image.
  CameraOptions quiet;
  quiet.pixels_per_sigma = 24;
  quiet.read_noise = 0.3;
  quiet.electrons_per_level = 400;
  Frame frame = frame_with(beads);
  Held stack(std::vector<cv::Mat>{SyntheticCamera(quiet, empty_cell(12, beads.size())).expose(frame)});
  const CameraOptions like = with_noise_of(stack, 24, false, quiet);
  const double variance = 0.09 + 215.0 / 400;
  EXPECT_NEAR(like.read_noise * like.read_noise + like.backlight / like.electrons_per_level, variance,
              0.2 * variance);
  Held none(std::vector<cv::Mat>{});
  EXPECT_THROW(with_noise_of(none, 24, false, plain()), InputError);
}

}  // namespace twincell::camera_test
