#include "sweep/onset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace twincell::sweep {

namespace {

// kLikelihoodDrop: 3.841 applies to a fixed design. Here the runs are few, and earlier results decide where
// runs are placed and when they stop. In simulated searches with w from a hundredth to a seventh of the
// range, intervals with 3.841 contained the true value in 83 to 99 % of cases, and intervals with 6 in 93 to
// 100 %.
constexpr int kWidths = 12;   // trial values of w
constexpr double kFiner = 8;  // steps of mu per wanted width
constexpr std::size_t kMaxSteps = 4000;

/// ln(1/(1 + e^-t)).
double log_logistic(double t) {
  return t > 0 ? -std::log1p(std::exp(-t)) : t - std::log1p(std::exp(t));
}

/// Number of answers at one x.
struct Heap {
  double x;
  double yes = 0, no = 0;
};

std::vector<Heap> heaps_of(std::vector<Trial> trials) {
  std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.x < b.x; });
  std::vector<Heap> heaps;
  for (const Trial& trial : trials) {
    if (heaps.empty() || heaps.back().x != trial.x) heaps.push_back({trial.x});
    (trial.yes ? heaps.back().yes : heaps.back().no) += 1;
  }
  return heaps;
}

/// Log-likelihood of mu, maximised over w on a logarithmic grid.
double profile(const std::vector<Heap>& heaps, double mu, double narrowest, double widest) {
  double best = -INFINITY;
  for (int k = 0; k < kWidths; ++k) {
    const double w = narrowest * std::pow(widest / narrowest, static_cast<double>(k) / (kWidths - 1));
    double sum = 0;
    for (const Heap& heap : heaps) {
      const double t = (heap.x - mu) / w;
      sum += heap.yes * log_logistic(t) + heap.no * log_logistic(-t);
    }
    best = std::max(best, sum);
  }
  return best;
}

}  // namespace

Onset estimate_onset(const std::vector<Trial>& trials, double low, double high, double width) {
  const double range = high - low;
  const std::vector<Heap> heaps = heaps_of(trials);
  const auto steps =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(range * kFiner / width)), 16, kMaxSteps);
  const std::size_t outside = steps / 2, all = steps + 2 * outside;
  const double h = range / static_cast<double>(steps);
  const auto mu_at = [&](std::size_t k) {
    return low + (static_cast<double>(k) - static_cast<double>(outside) + 0.5) * h;
  };
  std::vector<double> log_l(all);
  for (std::size_t k = 0; k < all; ++k) log_l[k] = profile(heaps, mu_at(k), width / kFiner, range / 2);
  const double top = *std::max_element(log_l.begin(), log_l.end());

  Onset onset;
  onset.n = trials.size();
  for (const Trial& trial : trials) onset.yes += trial.yes ? 1 : 0;
  // If several mu are equally likely, take the middle of them.
  std::size_t first = all, last = 0, from = all, to = 0;
  for (std::size_t k = 0; k < all; ++k) {
    if (log_l[k] > top - 1e-9) {
      first = std::min(first, k);
      last = k;
    }
    if (2 * (top - log_l[k]) < kLikelihoodDrop) {
      from = std::min(from, k);
      to = k;
    }
  }
  const double best = (mu_at(first) + mu_at(last)) / 2;
  const bool one_sided = onset.yes == 0 || onset.yes == onset.n;
  if (!one_sided && best >= low && best <= high) onset.value = best;
  if (from >= outside) onset.low = mu_at(from) - h / 2;
  if (to < outside + steps) onset.high = mu_at(to) + h / 2;
  for (std::size_t k = 0; k < all; ++k) onset.profile.push_back({mu_at(k), log_l[k] - top});
  std::vector<Heap> opposite = heaps;
  for (Heap& heap : opposite) std::swap(heap.yes, heap.no);
  double falling = -INFINITY;
  for (std::size_t k = outside; k < outside + steps; ++k)
    falling = std::max(falling, profile(opposite, mu_at(k), width / kFiner, range / 2));
  if (2 * (falling - top) > kLikelihoodDrop) {
    onset.falls = true;
    onset.value.reset(), onset.low.reset(), onset.high.reset();
  }
  return onset;
}

std::string Onset::text() const {
  const std::string of = fmt::format("yes in {} of {} runs", yes, n);
  if (n == 0) return "no answer yet";
  if (falls) return "none, as the answers change from yes to no: " + of;
  if (value && low && high) return fmt::format("{:.4g} [{:.4g}, {:.4g}], {}", *value, *low, *high, of);
  if (low && high) return fmt::format("in [{:.4g}, {:.4g}], {}", *low, *high, of);
  if (low) return fmt::format("above {:.4g}, {}", *low, of);
  if (high) return fmt::format("below {:.4g}, {}", *high, of);
  return fmt::format("not known, {}", of);
}

std::vector<double> next_places(const Onset& onset, double low, double high, double width, int batch) {
  double total = 0;
  for (const Likelihood& l : onset.profile) total += std::exp(l.log);
  const double grid = width / 2;
  std::vector<double> places;
  for (int i = 0; i < batch; ++i) {
    double left = total * (i + 0.5) / batch;
    std::size_t k = 0;
    while (k + 1 < onset.profile.size() && left > std::exp(onset.profile[k].log))
      left -= std::exp(onset.profile[k++].log);
    const double x = std::clamp(onset.profile[k].mu, low, high);
    // Round, so that positions recur and have short names.
    const double rounded = low + std::round((x - low) / grid) * grid;
    places.push_back(std::stod(fmt::format("{:.6g}", std::clamp(rounded, low, high))));
  }
  return places;
}

double evidence_above(const Onset& upper, const Onset& lower) {
  // For each mu of `lower`, take the best mu of `upper` that is not higher; both grids are in rising order.
  double best = -INFINITY, best_upper = -INFINITY;
  std::size_t u = 0;
  for (const Likelihood& l : lower.profile) {
    for (; u < upper.profile.size() && upper.profile[u].mu <= l.mu; ++u)
      best_upper = std::max(best_upper, upper.profile[u].log);
    best = std::max(best, best_upper + l.log);
  }
  return -2 * best;
}

bool settled(const Onset& onset, double low, double high, double width) {
  if (onset.falls) return true;
  if (onset.low && onset.high) return *onset.high - *onset.low <= width * (1 + 1e-9);
  if (onset.low) return *onset.low >= high - width;
  if (onset.high) return *onset.high <= low + width;
  return false;
}

}  // namespace twincell::sweep
