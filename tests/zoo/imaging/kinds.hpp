#pragma once
/// \file
/// The kinds of pictures of the zoo, as found in papers on shaken and sheared beads, each for any bead
/// diameter.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "imaging/benchmark/packing.hpp"
#include "imaging/benchmark/score.hpp"
#include "tests/zoo/imaging/painter.hpp"

namespace twincell::zoo {

/// A picture with its truth.
struct Exhibit {
  cv::Mat1b picture;
  std::vector<imaging::TruthBead> truth;
};

struct Place {
  double x, y, radius;
};
using Places = std::vector<Place>;

/// Side of the picture of beads of a diameter, px.
inline int side_of(double diameter) {
  return std::clamp(static_cast<int>(17 * diameter), 200, 500);
}

inline Places places_of(const std::vector<imaging::rendered::Disc>& discs) {
  Places places;
  for (const imaging::rendered::Disc& d : discs) places.push_back({d.x, d.y, d.radius});
  return places;
}

/// Beads that come to rest in the lower part of a room: a random packing with contacts.
inline Places at_rest(double diameter, const cv::Rect2d& room, double filled, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto n = static_cast<std::size_t>(filled * 1.02 * room.area() / (diameter * diameter));
  Places places;
  for (const Place& p :
       places_of(imaging::rendered::deposited(std::vector<double>(n, 0.5 * diameter), room, random)))
    if (p.y - p.radius > room.y) places.push_back(p);
  return places;
}

/// Beads apart from each other, at random.
inline Places apart(double diameter, const cv::Rect2d& room, double pitch, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto n = static_cast<std::size_t>(room.area() / (pitch * pitch * diameter * diameter));
  return places_of(imaging::rendered::sparse(std::vector<double>(n, 0.5 * diameter), room, random));
}

/// Grains of a crystal with contacts.
inline Places crystal(double diameter, const cv::Rect2d& room, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  return places_of(imaging::rendered::hexagonal(count, 0.5 * diameter, room, random));
}

/// The picture without a margin on every side, px.
inline cv::Rect2d inner(int side, double margin) {
  return {margin, margin, side - 2 * margin, side - 2 * margin};
}

inline std::vector<imaging::TruthBead> truth_of(const Places& places) {
  std::vector<imaging::TruthBead> truth;
  for (const Place& p : places) truth.push_back({-1, p.x, p.y, p.radius, 0, true});
  return truth;
}

/// 0 below a, 1 above b, smooth between.
inline double smooth_step(double a, double b, double x) {
  const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

constexpr double kLight = 200, kBlack = 18, kBlur = 0.7, kNoise = 3;

inline void paint_opaque(Painter& canvas, const Places& places, double level = kBlack) {
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [&](double, double, double) { return level; });
}

/// Opaque beads on a back-light, at rest.
inline Exhibit opaque(double d) {
  Painter canvas(side_of(d), kLight);
  const Places places = at_rest(d, inner(canvas.side(), 0.7 * d), 0.75, 1);
  paint_opaque(canvas, places);
  return {canvas.exposed(kBlur, kNoise, 1), truth_of(places)};
}

/// Translucent discs with dark rims in crystal grains; the discs differ by a few per cent in transmission.
inline Exhibit translucent(double d) {
  Painter canvas(side_of(d), kLight);
  const Places places = crystal(d, inner(canvas.side(), 0.7 * d), 150, 2);
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (const Place& p : places) {
    const double through = 0.55 + 0.03 * normal(random);
    canvas.disc(p.x, p.y, p.radius, [&](double u, double v, double below) {
      return below * (std::hypot(u, v) > 0.84 ? 0.18 : through);
    });
  }
  return {canvas.exposed(kBlur, kNoise, 2), truth_of(places)};
}

/// Glass spheres on a back-light: a broad dark rim and a bright centre, the image of the lamp.
inline Exhibit clear(double d) {
  Painter canvas(side_of(d), 170);
  const Places places = at_rest(d, inner(canvas.side(), 0.7 * d), 0.75, 3);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [](double u, double v, double below) {
      const double r = std::hypot(u, v);
      return below * (1.2 * (1 - smooth_step(0.2, 0.45, r)) +
                      smooth_step(0.2, 0.45, r) * (0.95 - 0.8 * smooth_step(0.5, 0.85, r)));
    });
  return {canvas.exposed(kBlur, kNoise, 3), truth_of(places)};
}

/// Steel balls under front light on a dark plate: shading from one side, a spot of glare and a faint rim.
inline Exhibit steel(double d) {
  Painter canvas(side_of(d), 40);
  const Places places = at_rest(d, inner(canvas.side(), 0.7 * d), 0.75, 4);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [](double u, double v, double) {
      const double w = std::sqrt(std::max(0.0, 1 - u * u - v * v));
      const double lit = std::max(0.0, -0.35 * u - 0.35 * v + 0.87 * w);
      const double glare = std::exp(-((u + 0.3) * (u + 0.3) + (v + 0.3) * (v + 0.3)) / 0.03);
      return 75 + 65 * lit + 150 * glare;
    });
  return {canvas.exposed(kBlur, kNoise, 4), truth_of(places)};
}

/// Photoelastic discs between polarisers, a light disc with a dark rim and with fringes around its contacts.
inline Exhibit photoelastic(double d) {
  Painter canvas(side_of(d), kLight);
  const Places places = at_rest(d, inner(canvas.side(), 0.7 * d), 0.75, 5);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform;
  for (const Place& p : places) {
    Places contacts;  // directions, and the force as radius
    for (const Place& q : places)
      if (const double r = std::hypot(q.x - p.x, q.y - p.y); r > 0 && r < 1.02 * d)
        contacts.push_back({(q.x - p.x) / r, (q.y - p.y) / r, 0.15 + 0.55 * uniform(random)});
    canvas.disc(p.x, p.y, p.radius, [&](double u, double v, double below) {
      if (std::hypot(u, v) > 0.86) return 0.2 * below;
      double stress = 0;
      for (const Place& c : contacts) stress += c.radius / (0.15 + std::hypot(u - c.x, v - c.y));
      return below * (0.55 + 0.25 * std::cos(2 * std::numbers::pi * stress));
    });
  }
  return {canvas.exposed(kBlur, kNoise, 5), truth_of(places)};
}

/// Fluorescent spheres on a dark ground; their brightness varies by a tenth.
inline Exhibit fluorescent(double d) {
  Painter canvas(side_of(d), 14);
  const Places places = at_rest(d, inner(canvas.side(), 0.7 * d), 0.6, 6);
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (const Place& p : places) {
    const double bright = 170 * (1 + 0.1 * normal(random));
    canvas.disc(p.x, p.y, p.radius, [&](double u, double v, double below) {
      return below + bright * std::sqrt(std::max(0.0, 1 - u * u - v * v));
    });
  }
  return {canvas.exposed(1, kNoise, 6), truth_of(places)};
}

/// Two layers of beads in projection. A bead counts if 0.6 of its rim is outside all other beads.
/// \param transmitted share of the light; beads behind each other transmit the product
inline Exhibit layers(double d, double transmitted) {
  Painter canvas(side_of(d), kLight);
  Places places = apart(d, inner(canvas.side(), 0.7 * d), 1.75, 7);
  const Places behind = apart(d, inner(canvas.side(), 0.9 * d), 1.9, 71);
  places.insert(places.end(), behind.begin(), behind.end());
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius,
                [&](double, double, double below) { return std::max(kBlack, transmitted * below); });
  std::vector<imaging::TruthBead> truth = truth_of(places);
  for (imaging::TruthBead& b : truth) {
    constexpr int kDirections = 180;
    int free = 0;
    for (int k = 0; k < kDirections; ++k) {
      const double turn = 2 * std::numbers::pi * k / kDirections;
      const double x = b.x + b.r * std::cos(turn), y = b.y + b.r * std::sin(turn);
      free += std::none_of(places.begin(), places.end(), [&](const Place& p) {
        return (p.x != b.x || p.y != b.y) && std::hypot(p.x - x, p.y - y) < p.radius;
      });
    }
    b.counts = free > 0.6 * kDirections;
  }
  return {canvas.exposed(kBlur, kNoise, 7), truth};
}

inline Exhibit two_layers(double d) {
  return layers(d, 0);
}
inline Exhibit two_pale_layers(double d) {
  return layers(d, 0.5);
}

/// Opaque beads under a free surface: a dark, wavy water line with a bright line above it.
inline Exhibit water_line(double d) {
  Painter canvas(side_of(d), kLight);
  const int side = canvas.side();
  const double level = 3.2 * d;
  canvas.everywhere([&](double x, double y, double below) {
    const double surface = level + 0.3 * d * std::sin(2 * std::numbers::pi * x / side + 0.6) +
                           0.05 * d * std::sin(2 * std::numbers::pi * x / (2.3 * d));
    if (std::abs(y - surface) < 0.22 * d) return 35.0;
    if (y > surface - 0.45 * d && y < surface) return 235.0;
    return y < surface ? 0.85 * below : below;
  });
  cv::Rect2d room = inner(side, 0.7 * d);
  room.y += 4 * d, room.height -= 4 * d;
  const Places places = at_rest(d, room, 0.8, 8);
  paint_opaque(canvas, places);
  return {canvas.exposed(kBlur, kNoise, 8), truth_of(places)};
}

/// Opaque beads in a round container with a dark wall and grey surroundings.
inline Exhibit round_cell(double d) {
  Painter canvas(side_of(d), kLight);
  const double middle = 0.5 * (canvas.side() - 1), inside = middle - 1.4 * d;
  canvas.everywhere([&](double x, double y, double below) {
    const double r = std::hypot(x - middle, y - middle);
    return r < inside ? below : r < inside + 0.6 * d ? 45.0 : 120.0;
  });
  Places places;
  for (const Place& p : at_rest(d, inner(canvas.side(), 0.9 * d), 1, 9))
    if (std::hypot(p.x - middle, p.y - middle) < inside - p.radius) places.push_back(p);
  paint_opaque(canvas, places);
  return {canvas.exposed(kBlur, kNoise, 9), truth_of(places)};
}

/// Opaque beads next to a ruler, under a time stamp and a label.
inline Exhibit ruler_and_text(double d) {
  Painter canvas(side_of(d), kLight);
  const int side = canvas.side();
  const double wide = 2.2 * d;
  canvas.area({0, 0, wide, static_cast<double>(side)}, [](double, double, double) { return 225.0; });
  for (int k = 0; k * 0.5 * d < side; ++k)
    canvas.area({wide - (k % 5 == 0 ? 0.9 : 0.45) * d, k * 0.5 * d, (k % 5 == 0 ? 0.9 : 0.45) * d, 0.09 * d},
                [](double, double, double) { return 30.0; });
  for (int k = 1; 2.5 * k * d < side; ++k)
    canvas.text(std::to_string(k), 0.2 * d, 2.5 * k * d + 0.4 * d, 0.8 * d, 30);
  canvas.text("t = 0.08 s  run 0609", wide + 0.6 * d, 1.6 * d, 0.9 * d, 20);
  cv::Rect2d room = inner(side, 0.7 * d);
  room.x = wide + 0.5 * d, room.width = side - room.x - 0.7 * d;
  room.y += 2.2 * d, room.height -= 2.2 * d;
  const Places places = at_rest(d, room, 0.75, 10);
  paint_opaque(canvas, places);
  return {canvas.exposed(kBlur, kNoise, 10), truth_of(places)};
}

/// Dark discs in a light box, in light that falls by two thirds to one side, with a bright spot.
inline Exhibit uneven_light(double d) {
  Painter canvas(side_of(d), 190);
  const int side = canvas.side();
  const cv::Rect2d box = inner(side, 1.2 * d);
  canvas.everywhere([&](double x, double y, double) {
    const bool in = x > box.x && x < box.br().x && y > box.y && y < box.br().y;
    const bool frame =
        x > box.x - 0.5 * d && x < box.br().x + 0.5 * d && y > box.y - 0.5 * d && y < box.br().y + 0.5 * d;
    return in ? 190.0 : frame ? 110.0 : 150.0;
  });
  const Places places = at_rest(d, box, 0.75, 11);
  paint_opaque(canvas, places, 45);
  canvas.everywhere([&](double x, double y, double below) {
    const double spot = std::hypot(x / side - 0.3, y / side - 0.35);
    return below * ((1 - 0.66 * x / side) * 0.95 + 0.25 * std::exp(-spot * spot / 0.02));
  });
  return {canvas.exposed(kBlur, kNoise, 11), truth_of(places)};
}

/// A pile of dark discs next to grey tape, with a tilted strip of dark tape above it.
inline Exhibit tape(double d) {
  Painter canvas(side_of(d), kLight);
  const int side = canvas.side();
  canvas.everywhere([&](double x, double y, double below) {
    const double crease = 12 * std::sin(x / (0.9 * d) + 0.3 * std::sin(y / d));
    if (x < 3.1 * d) return 110 + crease;
    const double across = y - 1.6 * d - 0.12 * x;
    return std::abs(across) < 0.75 * d ? 50 + 0.5 * crease : below;
  });
  cv::Rect2d room = inner(side, 0.7 * d);
  room.x = 3.6 * d, room.width = side - room.x - 0.7 * d;
  room.y += 5 * d, room.height -= 5 * d;
  const Places places = at_rest(d, room, 0.75, 12);
  paint_opaque(canvas, places, 40);
  return {canvas.exposed(kBlur, kNoise, 12), truth_of(places)};
}

/// Dark polygons in random directions, of the size of beads. \param stretched ratio of length and width
inline Exhibit polygons(double d, int sides, double stretched = 1) {
  Painter canvas(side_of(d), kLight);
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> uniform(0, 2 * std::numbers::pi);
  for (const Place& p : apart(d, inner(canvas.side(), 0.7 * d), 1.5, 13)) {
    const double turn = uniform(random), part = 2 * std::numbers::pi / sides;
    canvas.disc(p.x, p.y, p.radius, [&](double u, double v, double below) {
      const double along = u * std::cos(turn) + v * std::sin(turn),
                   across = stretched * (v * std::cos(turn) - u * std::sin(turn));
      const double angle = std::atan2(across, along), within = angle - part * std::floor(angle / part);
      return std::hypot(along, across) * std::cos(within - 0.5 * part) < std::cos(0.5 * part) ? 20 : below;
    });
  }
  return {canvas.exposed(kBlur, kNoise, 13), {}};
}

/// Dark objects of the shape inside(u, v), with u and v from -1 to 1, in random directions.
inline Exhibit shapes(double d, const std::function<bool(double, double)>& inside) {
  Painter canvas(side_of(d), kLight);
  std::mt19937_64 random(16);
  std::uniform_real_distribution<double> uniform(0, 2 * std::numbers::pi);
  for (const Place& p : apart(d, inner(canvas.side(), 0.7 * d), 1.5, 16)) {
    const double turn = uniform(random), c = std::cos(turn), s = std::sin(turn);
    canvas.disc(p.x, p.y, p.radius, [&](double u, double v, double below) {
      return inside(u * c + v * s, v * c - u * s) ? 20 : below;
    });
  }
  return {canvas.exposed(kBlur, kNoise, 16), {}};
}

/// Spherocylinders. \param stretched ratio of length and width
inline Exhibit rods(double length, double stretched) {
  const double radius = 1 / stretched;
  return shapes(length, [=](double u, double v) {
    return std::hypot(std::max(0.0, std::abs(u) - 1 + radius), v) < radius;
  });
}

inline Exhibit crosses(double d) {
  return shapes(d, [](double u, double v) { return std::min(std::abs(u), std::abs(v)) < 0.28; });
}

/// A picture of level(x, y).
inline Exhibit pattern(const std::function<double(double, double)>& level) {
  Painter canvas(300, kLight);
  canvas.everywhere([&](double x, double y, double) { return level(x, y); });
  return {canvas.exposed(kBlur, kNoise, 17), {}};
}

inline Exhibit checkerboard(double pitch) {
  return pattern([=](double x, double y) {
    return std::fmod(std::floor(x / pitch) + std::floor(y / pitch), 2.0) == 0 ? 200.0 : 30.0;
  });
}

/// Bricks of twice the height in length, with joints of 0.15 heights, in running bond.
inline Exhibit bricks(double height) {
  return pattern([=](double x, double y) {
    const double row = std::floor(y / height), shifted = x + height * std::fmod(row, 2.0);
    const bool joint = y - row * height < 0.15 * height || std::fmod(shifted, 2 * height) < 0.15 * height;
    return joint ? 200.0 : 90.0;
  });
}

/// A page of text.
inline Exhibit page(double height) {
  Painter canvas(300, 230);
  for (int line = 0; (line + 1) * 1.5 * height < canvas.side(); ++line)
    canvas.text("tilt " + std::to_string(114 + 17 * line) + ", fixed walls, dry", 4,
                (line + 1) * 1.5 * height, height, 25);
  return {canvas.exposed(kBlur, kNoise, 14), {}};
}

/// Dark spots of all shapes on light ground: a sum of waves in random directions, cut at a level.
inline Exhibit spots(double wave) {
  Painter canvas(300, kLight);
  std::mt19937_64 random(15);
  std::uniform_real_distribution<double> uniform(0, 2 * std::numbers::pi);
  std::vector<std::array<double, 3>> waves;
  for (int k = 0; k < 40; ++k) {
    const double turn = uniform(random), number = (0.6 + 0.1 * uniform(random)) * 2 * std::numbers::pi / wave;
    waves.push_back({number * std::cos(turn), number * std::sin(turn), uniform(random)});
  }
  canvas.everywhere([&](double x, double y, double below) {
    double sum = 0;
    for (const auto& [kx, ky, phase] : waves) sum += std::cos(kx * x + ky * y + phase);
    return sum > 3 ? 50.0 : below;
  });
  return {canvas.exposed(kBlur, kNoise, 15), {}};
}

struct Kind {
  std::string name;
  std::function<Exhibit(double)> make;
};

inline const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {{"opaque", opaque},
                                        {"translucent", translucent},
                                        {"clear", clear},
                                        {"steel", steel},
                                        {"photoelastic", photoelastic},
                                        {"fluorescent", fluorescent},
                                        {"two layers", two_layers},
                                        {"pale layers", two_pale_layers},
                                        {"water line", water_line},
                                        {"round cell", round_cell},
                                        {"ruler, text", ruler_and_text},
                                        {"uneven light", uneven_light},
                                        {"tape", tape}};
  return all;
}

/// Pictures without beads.
inline const std::vector<Kind>& without_beads() {
  static const std::vector<Kind> all = {{"triangles", [](double d) { return polygons(d, 3); }},
                                        {"squares", [](double d) { return polygons(d, 4); }},
                                        {"ellipses", [](double d) { return polygons(d, 60, 2); }},
                                        {"hexagons", [](double d) { return polygons(d, 6); }},
                                        {"rods", [](double d) { return rods(d, 2); }},
                                        {"long rods", [](double d) { return rods(d, 4); }},
                                        {"crosses", crosses},
                                        {"checkerboard", checkerboard},
                                        {"bricks", bricks},
                                        {"text", page},
                                        {"spots", spots}};
  return all;
}

}  // namespace twincell::zoo
