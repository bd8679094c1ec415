// What a film says of beads that leave the picture.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "imaging/track/link_detections.hpp"

namespace twincell::imaging {
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
  EXPECT_NE(said({0, 3}).find("hold 0 to 3 beads"), std::string::npos);
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
}  // namespace twincell::imaging
