#include "imaging/benchmark/centre_scores.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace twincell::imaging::rendered {

void CentreScores::add(const Picture& picture, const std::vector<cv::Point2d>& found,
                       const std::vector<double>& bound) {
  const std::vector<Disc>& discs = picture.discs;
  struct Pair {
    double distance;
    std::size_t disc, find;
  };
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < discs.size(); ++k)
    for (std::size_t f = 0; f < found.size(); ++f) {
      const double dx = found[f].x - discs[k].x, dy = found[f].y - discs[k].y;
      if (std::abs(dx) <= discs[k].radius && std::hypot(dx, dy) <= discs[k].radius)
        pairs.push_back({std::hypot(dx, dy), k, f});
    }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  auto inside = [&](const Disc& d) {
    return d.x >= -0.5 && d.y >= -0.5 && d.x <= picture.width - 0.5 && d.y <= picture.height - 0.5;
  };
  for (std::size_t k = 0; k < discs.size(); ++k)
    if (inside(discs[k])) {
      ++beads_;
      bounds_ += bound[k] * bound[k];
    }
  // Nearest pairs first: each disc and each detection is matched at most once.
  std::vector<bool> disc_taken(discs.size(), false), find_taken(found.size(), false);
  for (const Pair& p : pairs) {
    if (disc_taken[p.disc] || find_taken[p.find]) continue;
    disc_taken[p.disc] = find_taken[p.find] = true;
    const Disc& d = discs[p.disc];
    if (inside(d)) errors_.push_back({d.x, d.y, found[p.find].x - d.x, found[p.find].y - d.y});
  }
  invented_ += static_cast<std::size_t>(std::count(find_taken.begin(), find_taken.end(), false));
}

CentreScores::Summary CentreScores::summary() const {
  constexpr int kBins = 10;
  Summary s;
  s.beads = beads_;
  s.found = errors_.size();
  s.invented = invented_;
  s.recall = beads_ > 0 ? static_cast<double>(s.found) / static_cast<double>(beads_) : 1;
  s.precision =
      s.found + invented_ > 0 ? static_cast<double>(s.found) / static_cast<double>(s.found + invented_) : 1;
  s.error_by_phase.assign(kBins, 0);
  s.found_by_phase.assign(kBins, 0);
  s.truth_by_phase.assign(kBins, 0);
  auto bin = [](double x) {
    return static_cast<std::size_t>(std::min(kBins - 1.0, kBins * (x - std::floor(x))));
  };
  std::complex<double> harmonic = 0;
  double squares = 0;
  for (const Error& e : errors_) {
    squares += e.dx * e.dx + e.dy * e.dy;
    s.bias_x += e.dx;
    s.bias_y += e.dy;
    s.largest = std::max(s.largest, std::hypot(e.dx, e.dy));
    for (const auto& [at, error] : {std::pair{e.at_x, e.dx}, std::pair{e.at_y, e.dy}}) {
      harmonic += error * std::polar(1.0, -2 * std::numbers::pi * at);
      s.error_by_phase[bin(at)] += error;
      ++s.truth_by_phase[bin(at)];
      ++s.found_by_phase[bin(at + error)];
    }
  }
  const double n = std::max<double>(1, static_cast<double>(errors_.size()));
  s.rms = std::sqrt(squares / (2 * n));
  s.bound = std::sqrt(bounds_ / std::max<double>(1, static_cast<double>(beads_)));
  s.bias_x /= n;
  s.bias_y /= n;
  s.locking = 2 / (2 * n) * std::abs(harmonic);
  for (std::size_t b = 0; b < kBins; ++b) s.error_by_phase[b] /= std::max(1, s.truth_by_phase[b]);
  return s;
}

}  // namespace twincell::imaging::rendered
