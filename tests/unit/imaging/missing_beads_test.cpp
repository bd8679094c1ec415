// What a film says of beads that leave the picture.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "imaging/track/link_detections.hpp"

namespace twincell::imaging::missing_beads_test {
namespace {

/// The sentence about frames with these numbers of beads.
std::string said(const std::vector<std::size_t>& numbers) {
  LinkedDetections film{.frames = DetectionStore({}), .tracks = {}, .phases = {}, .links = {}};
  for (const std::size_t n : numbers) film.frames.append(std::vector<TrackedBead>(n));
  return film.missing_beads();
}

TEST(MissingBeadsOfAFilm, ANumberThatVariesByMoreThanATwentiethIsNoted) {
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({52}), "");
  EXPECT_EQ(said({100, 95, 100}), "");
  EXPECT_NE(said({100, 94, 100}).find("hold 94 to 100 beads"), std::string::npos);
  EXPECT_NE(said({26, 52, 40}).find("hold 26 to 52 beads"), std::string::npos);
  EXPECT_EQ(said({0, 3}), "") << "empty_frames names it";
}

/// The sentence about frames without beads among frames with these numbers of beads.
std::string said_of_empty(const std::vector<std::size_t>& numbers) {
  LinkedDetections film{.frames = DetectionStore({}), .tracks = {}, .phases = {}, .links = {}};
  for (const std::size_t n : numbers) film.frames.append(std::vector<TrackedBead>(n));
  return film.empty_frames();
}

TEST(FramesWithoutBeads, AreNamed) {
  EXPECT_EQ(said_of_empty({}), "");
  EXPECT_EQ(said_of_empty({0, 0}), "") << "no beads at all";
  EXPECT_EQ(said_of_empty({3, 4, 3}), "");
  EXPECT_NE(said_of_empty({3, 0, 3}).find("one frame shows no bead (frame 1, counted"), std::string::npos);
  EXPECT_NE(said_of_empty({0, 9, 0, 0, 0, 0, 9, 0}).find("6 frames show no bead (frames 0, 2, 3, 4, 5, ..."),
            std::string::npos);
}

/// A crystal that moves by 0.6 lattice constants a frame, whose frames in [from, to) are black. \returns the
/// number of tracks
std::int64_t tracks_of_film_with_black_frames(std::size_t from, std::size_t to) {
  constexpr double kDiameter_px = 10;
  constexpr int kSide = 8;
  DetectionStore located({});
  for (std::size_t f = 0; f < 12; ++f) {
    std::vector<TrackedBead> beads;
    for (int k = 0; k < kSide * kSide && (f < from || f >= to); ++k)
      beads.push_back({.x_px = kDiameter_px * (k % kSide) + 0.6 * kDiameter_px * static_cast<double>(f),
                       .y_px = kDiameter_px * static_cast<double>(k / kSide),
                       .radius_px = kDiameter_px / 2});
    located.append(beads);
  }
  const LinkedDetections linked = link_detections(located, {.diameter_px = kDiameter_px}, {},
                                                  {.method = PhaseMethod::none}, {}, Progress::none(), {});
  EXPECT_EQ(linked.frames.size(), located.size());
  for (const TrackSummary& t : linked.tracks) EXPECT_NEAR(t.last, 11, linked.n_tracks > 64 ? 11 : 0);
  return linked.n_tracks;
}

TEST(FramesWithoutBeads, AreBridgedAsFramesThatWereNotTaken) {
  EXPECT_EQ(tracks_of_film_with_black_frames(0, 0), 64);
  EXPECT_EQ(tracks_of_film_with_black_frames(5, 6), 64);
  EXPECT_EQ(tracks_of_film_with_black_frames(5, 8), 64) << "three, the default memory";
  EXPECT_EQ(tracks_of_film_with_black_frames(0, 2), 64) << "at the beginning";
  EXPECT_EQ(tracks_of_film_with_black_frames(5, 9), 128) << "four: all tracks end";
}

/// The sentence about tracks of frames with these numbers of beads.
std::string said_of_tracks(std::int64_t tracks, const std::vector<std::size_t>& numbers) {
  LinkedDetections film{.frames = DetectionStore({}), .tracks = {}, .phases = {}, .links = {}};
  film.n_tracks = tracks;
  for (const std::size_t n : numbers) film.frames.append(std::vector<TrackedBead>(n));
  return film.surplus_tracks();
}

TEST(TracksOfAFilm, AFifthMoreThanBeadsIsNoted) {
  EXPECT_EQ(said_of_tracks(0, {}), "");
  EXPECT_EQ(said_of_tracks(100, {100, 90}), "");
  EXPECT_EQ(said_of_tracks(120, {90, 100}), "");
  EXPECT_NE(said_of_tracks(121, {90, 100}).find("121 tracks, but at most 100 beads"), std::string::npos);
}

}  // namespace
}  // namespace twincell::imaging::missing_beads_test
