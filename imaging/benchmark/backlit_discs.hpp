#pragma once
/// \file
/// What a rendered picture shows: opaque discs in front of a light. picture.hpp states the model of the
/// exposure.

#include <vector>

namespace twincell::imaging::rendered {

/// Share of read noise in the variance of the back-light; the rest is shot noise.
constexpr double kReadShare = 0.25;

/// An opaque disc; lengths in px, (0, 0) is the centre of the first pixel.
struct Disc {
  double x = 0, y = 0;  ///< centre, at the middle of the exposure
  double radius = 7.5;
  double contrast = 1;            ///< a: share of the light that it blocks
  double path_x = 0, path_y = 0;  ///< displacement during the exposure
  double glare = 0;               ///< peak level of a bright spot on the disc, share of the light
  double glare_x = 0, glare_y = 0, glare_size = 1;  ///< position from the disc's centre; standard deviation
};

/// The scene in front of the camera.
struct Picture {
  int width = 600, height = 1500;
  double pedestal = 20;  ///< grey level without light
  double light = 190;    ///< grey levels of the back-light above the pedestal
  double uneven = 0;     ///< 0: uniform light; u: light falls by u towards the corners, with a ripple of u/10
  double blur = 0.8;     ///< s: standard deviation of the optical blur, px
  std::vector<Disc> discs;
};

}  // namespace twincell::imaging::rendered
