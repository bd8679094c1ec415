#include "imaging/benchmark/cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "imaging/benchmark/packing.hpp"

namespace twincell::imaging::rendered {

namespace {

constexpr std::size_t kBeads = 1600;

using Random = std::mt19937_64;

// Bed of beads of `diameter` px in a frame of 40 x 100 diameters. The radii are uniformly distributed within
// +-spread. `over`: distance by which the bed extends beyond the left, right and bottom of the frame, px; a
// negative value keeps the bed that far inside.
Picture bed(Random& random, double diameter = 15, double spread = 0, double over = -10) {
  Picture p;
  p.width = static_cast<int>(40 * diameter);
  p.height = static_cast<int>(100 * diameter);
  std::vector<double> radii;
  for (std::size_t k = 0; k < kBeads; ++k)
    radii.push_back(0.5 * diameter * (1 + uniform(random, -spread, spread)));
  const double left = -over + uniform(random, 0, 1), floor = p.height + over - uniform(random, 0, 1);
  p.discs = deposited(radii, {left, 0, p.width - 2 * left, floor}, random);
  return p;
}

// Bed in which half of the discs have one size and half another, in random order.
Picture mixed_bed(Random& random, double one, double other) {
  Picture p;
  const double mean = 0.5 * (one + other);
  p.width = static_cast<int>(40 * mean);
  p.height = static_cast<int>(100 * mean);
  std::vector<double> radii;
  for (std::size_t k = 0; k < kBeads; ++k) radii.push_back(0.5 * (k % 2 == 0 ? one : other));
  std::shuffle(radii.begin(), radii.end(), random);
  p.discs = deposited(radii, {10, 0, p.width - 20.0, p.height - 10.0}, random);
  return p;
}

Picture spread_out(Random& random) {
  Picture p;
  p.discs = sparse(std::vector<double>(kBeads, 7.5), {5, 5, p.width - 10.0, p.height - 10.0}, random);
  return p;
}

Picture crystal(Random& random) {
  Picture p;
  p.discs = hexagonal(kBeads, 7.5, {10, 10, p.width - 20.0, p.height - 20.0}, random);
  return p;
}

void move_together(Picture& p, double length, double angle) {
  for (Disc& d : p.discs) {
    d.path_x = length * std::cos(angle);
    d.path_y = length * std::sin(angle);
  }
}

void add_glare(Picture& p, Random& random) {
  for (Disc& d : p.discs) {
    const double angle = uniform(random, 0, 2 * std::numbers::pi),
                 r = 0.3 * d.radius * std::sqrt(uniform(random, 0, 1));
    d.glare = uniform(random, 0.3, 0.8);
    d.glare_x = r * std::cos(angle);
    d.glare_y = r * std::sin(angle);
    d.glare_size = 0.13 * d.radius;
  }
}

const std::vector<double> kLevels{164, 51, 18.5, 8.5};
const std::vector<double> kOne{51};

const std::vector<Case> kCases{
    {"sparse", "isolated beads over the whole frame", 15, kLevels,
     [](std::uint64_t seed) {
       Random random(seed);
       return spread_out(random);
     }},
    {"hexagonal", "a crystal, every bead touches six others", 15, kLevels,
     [](std::uint64_t seed) {
       Random random(seed);
       return crystal(random);
     }},
    {"random", "a bed made by drop and roll, beads touch", 15, kLevels,
     [](std::uint64_t seed) {
       Random random(seed);
       return bed(random);
     }},
    {"motion_3px", "random, the bed moves by 3 px during the exposure", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random);
       move_together(p, 3, uniform(random, 0, std::numbers::pi));
       return p;
     }},
    {"motion_3px_each", "sparse, every bead moves by 3 px in its own direction", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = spread_out(random);
       for (Disc& d : p.discs) {
         const double angle = uniform(random, 0, 2 * std::numbers::pi);
         d.path_x = 3 * std::cos(angle);
         d.path_y = 3 * std::sin(angle);
       }
       return p;
     }},
    {"defocus_2px", "random, blur 2 px", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random);
       p.blur = 2;
       return p;
     }},
    {"defocus_4px", "random, beads of 30 px, blur 4 px", 30, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random, 30);
       p.blur = 4;
       return p;
     }},
    {"sizes_2pc", "random, radii within 2 %", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return bed(random, 15, 0.02);
     }},
    {"sizes_10pc", "random, radii within 10 %", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return bed(random, 15, 0.1);
     }},
    {"two_sizes",
     "random, half of the beads of 15 px, half of 21 px",
     15,
     kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return mixed_bed(random, 15, 21);
     },
     {21}},
    {"two_sizes_apart",
     "random, half of the beads of 12 px, half of 24 px",
     12,
     kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return mixed_bed(random, 12, 24);
     },
     {24}},
    {"glare", "random, a bright spot on every bead", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random);
       add_glare(p, random);
       return p;
     }},
    {"edge", "random, beads cut by the frame on three sides", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return bed(random, 15, 0, 20);
     }},
    {"uneven", "random, light falls by 40 % towards the corners", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random);
       p.uneven = 0.4;
       return p;
     }},
    {"black", "random, no pedestal: noise in the beads is cut off at level 0", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random);
       p.pedestal = 0;
       p.light = 210;
       return p;
     }},
    {"tracers", "random, one bead in twenty transmits 40 % of the light", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random);
       for (std::size_t k = 0; k < p.discs.size(); k += 20) p.discs[k].contrast = 0.6;
       return p;
     }},
    {"beads_6px", "random, beads of 6 px", 6, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return bed(random, 6);
     }},
    {"beads_8px", "random, beads of 8 px", 8, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return bed(random, 8);
     }},
    {"beads_30px", "random, beads of 30 px", 30, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       return bed(random, 30);
     }},
    {"all_at_once", "random, 2 % sizes, 3 px motion, glare, edge and uneven light", 15, kOne,
     [](std::uint64_t seed) {
       Random random(seed);
       Picture p = bed(random, 15, 0.02, 20);
       move_together(p, 3, uniform(random, 0, std::numbers::pi));
       add_glare(p, random);
       p.uneven = 0.4;
       return p;
     }},
};

}  // namespace

const std::vector<Case>& cases() {
  return kCases;
}

}  // namespace twincell::imaging::rendered
