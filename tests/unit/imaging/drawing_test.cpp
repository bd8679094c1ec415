// Drawings: where a bead lies, which colour it has, and which frames are drawn.

#include "imaging/drawing/drawing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::drawing_test {
namespace {

// Ends and middle of viridis as matplotlib lists them (Smith & van der Walt 2015), BGR.
const cv::Vec3b kDark(84, 1, 68), kMiddle(140, 145, 33), kBright(37, 231, 253);

void expect_colour(const cv::Vec3b& found, const cv::Vec3b& wanted, int tolerance, const char* what) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], tolerance) << what << ", channel " << k;
}

/// Beads at known places in a cell of 10 x 6; bead 1 is missing from frame 0; the plate rises by 0.25 a
/// frame.
MemoryTrajectory three_beads(int dimension = 2) {
  TrajectoryInfo info;
  info.n_beads = 3;
  info.columns.identity = true;
  info.columns.velocity = true;
  info.columns.plate_height = true;
  info.columns.contact_forces = true;
  info.box.dimension = dimension;
  info.box.upper = Vec3(10, dimension == 2 ? 1 : 10, 6);
  info.radius = {0.5, 0.5, 0.5};
  MemoryTrajectory trajectory(info);
  for (int f = 0; f < 4; ++f) {
    Frame frame;
    frame.step = f;
    frame.time = f;
    frame.plate_height = 0.25 * f;
    frame.position = {Vec3(2, 0.5, 2), Vec3(5, 0.5, 3), Vec3(8 - f, 0.5, 4)};
    frame.velocity = {Vec3::Zero(), Vec3::Zero(), Vec3(-1, 0, 0)};
    frame.id = {0, f == 0 ? -1 : 1, 2};
    frame.contact_forces = {{.i = 0, .j = -1, .overlap = 0, .normal = Vec3(1, 0, 0), .normal_force = 3}};
    trajectory.append(frame);
  }
  return trajectory;
}

BeadColours by_slot() {
  return {.name = "slot",
          .unit = "",
          .of =
              [](std::size_t, const Frame& frame) {
                std::vector<double> values(frame.position.size());
                for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
                return values;
              },
          .range = std::nullopt};
}

cv::Mat3b drawn(const TrajectorySource& source, DrawJob job) {
  const TemporaryFolder folder;
  job.output = folder / "p.png";
  draw(source, job);
  return read_picture(job.output);
}

cv::Vec3b at(const cv::Mat3b& picture, const cv::Point2d& p) {
  return picture(static_cast<int>(std::lround(p.y)), static_cast<int>(std::lround(p.x)));
}

TEST(Drawing, TheMapIsViridis) {
  expect_colour(map_colour(-3, {-3, 5}), kDark, 1, "lower end");
  expect_colour(map_colour(1, {-3, 5}), kMiddle, 2, "middle");
  expect_colour(map_colour(5, {-3, 5}), kBright, 1, "upper end");
  EXPECT_EQ(map_colour(9, {-3, 5}), map_colour(5, {-3, 5}));
  EXPECT_EQ(map_colour(NAN, {0, 1}), cv::Vec3b(190, 190, 190));
}

TEST(Drawing, ABeadHasTheColourOfItsNumberAtItsPlace) {
  const MemoryTrajectory trajectory = three_beads();
  DrawJob job;
  job.colours = by_slot();
  job.pixels_per_sigma = 40;
  const View view = view_of(trajectory, job);
  const cv::Mat3b picture = drawn(trajectory, job);
  ASSERT_EQ(picture.size(), view.size());
  // Distances on the drawing are those of the cell, z up.
  const cv::Point2d a = view.project(Vec3(2, 0.5, 2)).at, b = view.project(Vec3(5, 0.5, 3)).at;
  EXPECT_NEAR(b.x - a.x, 120, 1e-9);
  EXPECT_NEAR(b.y - a.y, -40, 1e-9);
  expect_colour(at(picture, a), kDark, 1, "bead 0");
  expect_colour(at(picture, b), kMiddle, 2, "bead 1");
  expect_colour(at(picture, view.project(Vec3(5, 0.5, 4)).at), kBright, 1, "bead 2 in the last frame");
  // A disc of radius 0.5: 0.4 from the centre is in it, 0.6 is not.
  expect_colour(at(picture, a + cv::Point2d(16, 0)), kDark, 1, "inside");
  expect_colour(at(picture, a + cv::Point2d(24, 0)), {255, 255, 255}, 1, "outside");
  // The plate is drawn at its height in this frame.
  EXPECT_LT(at(picture, view.project(Vec3(5, 0.5, 0.75)).at)[0], 100);
  EXPECT_GT(at(picture, view.project(Vec3(5, 0.5, 0.4)).at)[0], 250);
}

// The room for the colour bar at the right is there only with a colour bar.
TEST(Drawing, WithoutColoursThePictureEndsAtTheCell) {
  const MemoryTrajectory trajectory = three_beads();
  DrawJob job;
  job.pixels_per_sigma = 80;
  const View plain = view_of(trajectory, job);
  job.colours = by_slot();
  const View coloured = view_of(trajectory, job);
  EXPECT_EQ(plain.cell().width, coloured.cell().width);
  EXPECT_LE(plain.size().width - plain.cell().br().x, 30);
  EXPECT_GE(coloured.size().width - coloured.cell().br().x, 150);
}

TEST(Drawing, OnlyTheChosenFramesAndThePresentBeadsAreDrawn) {
  const MemoryTrajectory trajectory = three_beads();
  DrawJob job;
  job.colours = by_slot();
  job.colours.range = {0, 2};
  job.pixels_per_sigma = 40;
  job.frames = {.first = 0, .end = 1, .step = 1};
  const View view = view_of(trajectory, job);
  const cv::Mat3b picture = drawn(trajectory, job);
  expect_colour(at(picture, view.project(Vec3(8, 0.5, 4)).at), kBright, 1, "bead 2 in frame 0");
  expect_colour(at(picture, view.project(Vec3(5, 0.5, 4)).at), {255, 255, 255}, 1, "bead 2 of frame 3");
  expect_colour(at(picture, view.project(Vec3(5, 0.5, 3)).at), {255, 255, 255}, 1, "missing bead 1");
  job.frames = {.first = 4, .end = -1, .step = 1};
  EXPECT_THROW(drawn(trajectory, job), ConfigError);
}

TEST(Drawing, TracksArrowsAndContactsAreDrawnWhereAsked) {
  const MemoryTrajectory trajectory = three_beads();
  DrawJob job;
  job.pixels_per_sigma = 40;
  const View view = view_of(trajectory, job);
  const auto dark = [&](const DrawJob& j, const Vec3& r, int channel) {
    return at(drawn(trajectory, j), view.project(r).at)[channel] < 150;
  };
  // Bead 2 went from x = 8 to x = 5; its arrow is 2 sigma long; the contact of bead 0 lies to its left.
  const Vec3 track(7.25, 0.5, 4), older(7.75, 0.5, 4), arrow(3.5, 0.5, 4), contact(1.75, 0.5, 2);
  for (const Vec3& r : {track, older, arrow, contact}) EXPECT_FALSE(dark(job, r, 0)) << r.transpose();
  DrawJob tracks = job, vectors = job, contacts = job;
  tracks.tracks = 3, vectors.vectors = true, contacts.contacts = true;
  EXPECT_TRUE(dark(tracks, track, 0));
  EXPECT_TRUE(dark(tracks, older, 0));
  tracks.tracks = 2;  // back to frame 1, x = 7
  EXPECT_FALSE(dark(tracks, older, 0));
  EXPECT_TRUE(dark(vectors, arrow, 0));
  EXPECT_TRUE(dark(contacts, contact, 0));
}

TEST(Drawing, InSpaceTheNearerBeadHidesTheFartherAndIsLarger) {
  MemoryTrajectory trajectory = three_beads(3);
  DrawJob job;
  const View view = view_of(trajectory, job);
  const Projected near = view.project(Vec3(5, 1, 3)), far = view.project(Vec3(5, 9, 3));
  EXPECT_GT(near.scale, far.scale);
  EXPECT_LT(near.depth, far.depth);
  // Similar triangles: magnifications are inverse to the distances from the eye, three diagonals away.
  const double eye = 3 * std::sqrt(100 + 100 + std::pow(view.height(), 2));
  const double apart = 8 * std::cos(M_PI / 6) * std::cos(M_PI / 12);
  EXPECT_NEAR(1 / far.scale - 1 / near.scale, apart / (eye * view.pixels_per_sigma()), 1e-12);
}

TEST(Drawing, ACellThatIsDrivenSidewaysIsDrawnWhereItIs) {
  MemoryTrajectory trajectory = three_beads();
  trajectory.info().drive = Drive{.axis = Axis::x, .amplitude = 1, .omega = 1};
  DrawJob job;
  job.pixels_per_sigma = 40;
  const View view = view_of(trajectory, job);
  const cv::Mat3b picture = drawn(trajectory, job);
  // In the last frame the cell is 0.75 to the right, and its plate at rest.
  EXPECT_LT(at(picture, view.project(Vec3(0.75, 0, 1)).at)[0], 100);
  EXPECT_LT(at(picture, view.project(Vec3(10.75, 0, 1)).at)[0], 100);
  EXPECT_LT(at(picture, view.project(Vec3(5, 0, 0)).at)[0], 100);
  for (const Vec3& r : {Vec3(0, 0, 1), Vec3(10, 0, 1), Vec3(5, 0, 0.75)})
    EXPECT_GT(at(picture, view.project(r).at)[0], 250) << r.transpose();
}

TEST(Drawing, AFilmHasTheChosenFrames) {
  const MemoryTrajectory trajectory = three_beads();
  const TemporaryFolder folder;
  DrawJob job;
  job.output = folder / "f.avi";
  job.frames = {.first = 1, .end = 4, .step = 1};
  job.pixels_per_sigma = 20;
  const Drawn done = draw(trajectory, job);
  EXPECT_EQ(done.frames, 3U);
  const auto film = codecs().open_film(job.output.string(), false);
  ASSERT_NE(film, nullptr);
  int n = 0;
  for (cv::Mat frame; film->read(frame); ++n) EXPECT_EQ(frame.size(), done.size);
  EXPECT_EQ(n, 3);
}

TEST(Drawing, WrongRequestsAreRefused) {
  MemoryTrajectory trajectory = three_beads();
  DrawJob job;
  job.output = "p.jpg";
  EXPECT_THROW(draw(trajectory, job), ConfigError);
  job.output = "p.png";
  job.pixels_per_sigma = 1e4;
  EXPECT_THROW(draw(trajectory, job), ConfigError);
  job.pixels_per_sigma = 10;
  job.colours.range = {0, 1};  // without a number
  EXPECT_THROW(draw(trajectory, job), ConfigError);
  job.colours = by_slot();
  for (const std::array<double, 2> range : {std::array{1.0, 1.0}, std::array{0.0, double{INFINITY}}}) {
    job.colours.range = range;
    EXPECT_THROW(draw(trajectory, job), ConfigError) << range[1];
  }
  job.colours = {};
  trajectory.info().columns.velocity = trajectory.info().columns.contact_forces = false;
  DrawJob vectors = job, contacts = job;
  vectors.vectors = contacts.contacts = true;
  EXPECT_THROW(draw(trajectory, vectors), ConfigError);
  EXPECT_THROW(draw(trajectory, contacts), ConfigError);
}

}  // namespace
}  // namespace twincell::imaging::drawing_test
