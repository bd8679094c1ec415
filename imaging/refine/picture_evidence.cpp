#include "imaging/refine/picture_evidence.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <span>

#include "core/median.hpp"

namespace twincell::imaging {

namespace {

constexpr double kOutside = 2.5;             // px beyond the rim that belong to a disc
constexpr float kRim = 2;                    // px inside the rim that belong to it
constexpr double kPerPixel = 2;              // levels of the profile
constexpr double kDiscCost = 2.5;            // ln n_b each: half of x, y, R, a, o
constexpr double kStep = 0.5, kMinStep = 2;  // of R; px
constexpr int kDirections = 8;
constexpr int kRounds = 2;  // of learning the profile, then the level of each disc

/// The discs of one size: profile, scale of the residuals, and whether the profile is used, by r - R.
struct Size {
  double radius = 0;
  std::size_t first = 0, count = 0;  // levels among all sizes
  std::vector<double> level, scale;
  std::vector<bool> used;
  std::vector<cv::Point> steps;  // to the neighbours of a pixel on straight lines
};

/// A place in the profile of a size: level k and the share of level k + 1.
struct Place {
  std::size_t k;
  double part;
};

/// A level, among those of all sizes, its share in a pixel, and the disc from which it comes.
struct Term {
  Eigen::Index level;
  double share;
  std::size_t disc;
};

/// The steps to the neighbours of a pixel, for discs of a radius.
std::vector<cv::Point> steps_of(double radius) {
  std::vector<cv::Point> steps;
  const double far = std::max(kMinStep, kStep * radius);
  for (int k = 0; k < kDirections; ++k) {
    const double turn = std::numbers::pi * k / kDirections;
    steps.emplace_back(cvRound(far * std::cos(turn)), cvRound(far * std::sin(turn)));
  }
  return steps;
}

/// The description of a pixel by its neighbours.
struct Neighbourhood {
  float squares = HUGE_VALF;  ///< half of the mean square of the differences to them; infinite: it has none
  float difference = 0;       ///< to their mean
};

/// The two pixels at a distance on a straight line through a pixel, for the line with the smallest squares.
Neighbourhood best_line(const cv::Mat1f& grey, int x, int y, const std::vector<cv::Point>& steps) {
  const float here = grey(y, x);
  Neighbourhood best;
  for (const cv::Point& step : steps) {
    float squares = 0, sum = 0;
    int seen = 0;
    for (const int times : {-2, -1, 1, 2}) {
      const int i = x + times * step.x, j = y + times * step.y;
      if (i < 0 || j < 0 || i >= grey.cols || j >= grey.rows) continue;
      const float e = grey(j, i) - here;
      squares += e * e;
      sum += e;
      ++seen;
    }
    const auto n = static_cast<float>(seen);
    if (seen > 0 && squares / (2 * n) < best.squares) best = {squares / (2 * n), -sum / n};
  }
  return best;
}

/// e_0 of a pixel. In uniform areas the smallest of several would be below the noise.
double without_discs(const cv::Mat1f& grey, double noise, int x, int y, const std::vector<cv::Point>& steps) {
  constexpr double kTypical = 0.45;  // median of the square of a standard normal variable
  const float least = best_line(grey, x, y, steps).squares;
  const double floor = kTypical * noise * noise;
  return std::sqrt(std::isfinite(least) ? std::max(floor, static_cast<double>(least)) : floor);
}

class Explanation {
 public:
  Explanation(const cv::Mat1f& grey, const std::vector<Detection>& discs, const std::vector<double>& radii,
              double neighbour_radius, const cv::Mat1b& walls)
      : grey_(grey), discs_(discs), noise_(noise_level(grey)), owner_(grey.size(), -1) {
    for (const double r : radii) {
      Size s;
      s.radius = r;
      s.first = levels_;
      s.count = static_cast<std::size_t>(std::ceil((r + kOutside) * kPerPixel)) + 2;
      levels_ += s.count;
      s.level.assign(s.count, 0);
      s.scale.assign(s.count, noise_);
      s.used.assign(s.count, true);
      s.steps = steps_of(neighbour_radius > 0 ? neighbour_radius : r);
      sizes_.push_back(std::move(s));
    }
    for (const Detection& d : discs) size_of_.push_back(nearest_size(d.radius, radii));
    amplitude_.assign(discs.size(), 1);
    offset_.assign(discs.size(), 0);
    share_pixels();
    if (!walls.empty()) owner_.setTo(-1, walls);
    one_layer_ = std::none_of(discs.begin(), discs.end(), [](const Detection& d) { return d.overlap; });
    collect_terms();
  }

  PictureEvidence evidence() {
    fit();
    PictureEvidence result = gains();
    result.rims = shift_rims();
    return result;
  }

  cv::Mat1f residuals() {
    fit();
    cv::Mat1f left(grey_.size());
    const std::vector<cv::Point>& of_ground = sizes_.front().steps;
    for (int y = 0; y < grey_.rows; ++y)
      for (int x = 0; x < grey_.cols; ++x) left(y, x) = best_line(grey_, x, y, of_ground).difference;
    over_owned([&](int x, int y, std::size_t b, std::size_t k) {
      if (sizes_[size_of_[b]].used[k]) left(y, x) = static_cast<float>(residual(x, y));
    });
    return left;
  }

 private:
  /// Learns the profiles, the levels of the discs and the scales of the residuals.
  void fit() {
    for (int round = 0; round < kRounds; ++round) {
      learn_profiles(round == 0);
      render();
      level_discs();
      render();
    }
    measure();
  }

  /// Calls use(x, y, r - R) for the pixels of the picture that a disc reaches.
  template <class Use>
  void over(const Detection& d, Use&& use) const {
    const double reach = d.radius + kOutside;
    for (int y = std::max(0, cvCeil(d.y - reach)); y <= std::min(grey_.rows - 1, cvFloor(d.y + reach)); ++y) {
      const double dy = y - d.y, half = std::sqrt(std::max(0.0, reach * reach - dy * dy));
      for (int x = std::max(0, cvCeil(d.x - half)); x <= std::min(grey_.cols - 1, cvFloor(d.x + half)); ++x)
        use(x, y, std::sqrt((x - d.x) * (x - d.x) + dy * dy) - d.radius);
    }
  }
  /// Where discs overlap in projection, a pixel shows only the disc that it belongs to.
  template <class Use>
  void over_shown(std::size_t b, Use&& use) const {
    over(discs_[b], [&](int x, int y, double out) {
      if (one_layer_ || owner_(y, x) == static_cast<int>(b)) use(x, y, out);
    });
  }
  /// The place in the profile at r - R. The innermost level serves a disc that is larger than its size.
  [[nodiscard]] Place place(const Size& s, double out) const {
    const double t = std::clamp((out + s.radius) * kPerPixel, 0.0, static_cast<double>(s.count) - 1.001);
    const auto k = static_cast<std::size_t>(t);
    return {k, t - static_cast<double>(k)};
  }

  /// Gives each pixel to the disc whose rim it is nearest to, or deepest inside of.
  void share_pixels() {
    cv::Mat1f nearest(grey_.size(), static_cast<float>(kOutside));
    for (std::size_t b = 0; b < discs_.size(); ++b)
      over(discs_[b], [&](int x, int y, double out) {
        if (static_cast<float>(out) >= nearest(y, x)) return;
        nearest(y, x) = static_cast<float>(out);
        owner_(y, x) = static_cast<int>(b);
      });
    out_ = nearest;
  }

  [[nodiscard]] std::size_t pixel_at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(grey_.cols) + static_cast<std::size_t>(x);
  }

  /// The levels of which each pixel is the sum, from all discs that reach it.
  void collect_terms() {
    first_term_.assign(grey_.total() + 1, 0);
    for (std::size_t b = 0; b < discs_.size(); ++b)
      over_shown(b, [&](int x, int y, double) { first_term_[pixel_at(x, y) + 1] += 2; });
    std::partial_sum(first_term_.begin(), first_term_.end(), first_term_.begin());
    terms_.resize(first_term_.back());
    std::vector<std::size_t> next(first_term_.begin(), first_term_.end() - 1);
    for (std::size_t b = 0; b < discs_.size(); ++b) {
      const Size& s = sizes_[size_of_[b]];
      over_shown(b, [&](int x, int y, double out) {
        const Place p = place(s, out);
        const auto level = static_cast<Eigen::Index>(s.first + p.k);
        std::size_t& at = next[pixel_at(x, y)];
        terms_[at++] = {level, 1 - p.part, b};
        terms_[at++] = {level + 1, p.part, b};
      });
    }
  }

  /// Fits the levels of all profiles, and in the first round a common ground, by weighted least squares.
  void learn_profiles(bool first) {
    const auto n = static_cast<Eigen::Index>(levels_ + 1);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    double pixels = 0;
    for (int y = 0; y < grey_.rows; ++y)
      for (int x = 0; x < grey_.cols; ++x) {
        if (owner_(y, x) < 0) continue;
        const std::size_t pixel = pixel_at(x, y);
        const auto b = static_cast<std::size_t>(owner_(y, x));
        const double v = static_cast<double>(grey_(y, x)) - offset_[b];
        double weight = 1;
        if (!first) {
          const double e = v - static_cast<double>(model_(y, x));
          const double scale = 10 * noise_;
          weight = scale * scale / (scale * scale + e * e);
        }
        const std::span terms(terms_.data() + first_term_[pixel], terms_.data() + first_term_[pixel + 1]);
        for (const Term& t : terms) {
          const double share = weight * amplitude_[t.disc] * t.share;
          right[t.level] += share * v;
          if (first) a(n - 1, t.level) += share;
          for (const Term& u : terms)
            if (u.level <= t.level) a(t.level, u.level) += share * amplitude_[u.disc] * u.share;
        }
        if (first) a(n - 1, n - 1) += 1, right[n - 1] += v;
        ++pixels;
      }
    // Levels in few pixels follow their neighbours; the profile is 0 where the disc has ended.
    const double smooth = 0.01 * (pixels + 1) / static_cast<double>(n);
    for (const Size& s : sizes_) {
      for (std::size_t k = 1; k < s.count; ++k) {
        const auto i = static_cast<Eigen::Index>(s.first + k);
        a(i - 1, i - 1) += smooth, a(i, i) += smooth, a(i, i - 1) -= smooth;
      }
      const auto last = static_cast<Eigen::Index>(s.first + s.count - 1);
      a(last, last) += 100 * smooth;
    }
    a.diagonal().array() += 1e-9 * (pixels + 1);
    const Eigen::VectorXd solved = a.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    for (Size& s : sizes_)
      for (std::size_t k = 0; k < s.count; ++k) s.level[k] = solved[static_cast<Eigen::Index>(s.first + k)];
  }

  /// The sum of the profiles of all discs, each with its amplitude, and the profile of the owner alone.
  void render() {
    model_ = cv::Mat1f::zeros(grey_.size());
    own_ = cv::Mat1f::zeros(grey_.size());
    for (std::size_t b = 0; b < discs_.size(); ++b) {
      const Size& s = sizes_[size_of_[b]];
      over_shown(b, [&](int x, int y, double out) {
        const Place p = place(s, out);
        const double f = (1 - p.part) * s.level[p.k] + p.part * s.level[p.k + 1];
        model_(y, x) += static_cast<float>(amplitude_[b] * f);
        if (owner_(y, x) == static_cast<int>(b)) own_(y, x) = static_cast<float>(f);
      });
    }
  }

  /// Fits offset and amplitude of each disc to its pixels. Discs of one size look alike, so the amplitude is
  /// within a factor of 0.5 to 1.5 of the common one.
  void level_discs() {
    struct Sums {
      double n = 0, m = 0, v = 0, mm = 0, mv = 0;
    };
    constexpr double kMinAmplitude = 0.5, kMaxAmplitude = 1.5;  // in units of the common one
    const std::vector<double> rendered = amplitude_;
    for (int pass = 0; pass < 2; ++pass) {
      std::vector<Sums> sums(discs_.size());
      for (int y = 0; y < grey_.rows; ++y)
        for (int x = 0; x < grey_.cols; ++x) {
          const int b = owner_(y, x);
          if (b < 0) continue;
          const auto k = static_cast<std::size_t>(b);
          const auto m = static_cast<double>(own_(y, x)),
                     v = static_cast<double>(grey_(y, x) - model_(y, x)) + rendered[k] * m;
          double w = 1;
          if (pass > 0) {
            const double e = v - offset_[k] - amplitude_[k] * m, scale = 10 * noise_;
            w = scale * scale / (scale * scale + e * e);
          }
          Sums& s = sums[k];
          s.n += w, s.m += w * m, s.v += w * v, s.mm += w * m * m, s.mv += w * m * v;
        }
      for (std::size_t b = 0; b < discs_.size(); ++b) {
        const Sums& s = sums[b];
        if (s.n <= 0) continue;
        const double spread = s.mm - s.m * s.m / s.n;
        amplitude_[b] =
            spread > 0 ? std::clamp((s.mv - s.m * s.v / s.n) / spread, kMinAmplitude, kMaxAmplitude) : 1.0;
        offset_[b] = (s.v - amplitude_[b] * s.m) / s.n;
      }
    }
  }

  [[nodiscard]] double residual(int x, int y) const {
    const auto b = static_cast<std::size_t>(owner_(y, x));
    return static_cast<double>(grey_(y, x)) - offset_[b] - static_cast<double>(model_(y, x));
  }
  template <class Use>
  void over_owned(Use&& use) const {
    for (int y = 0; y < grey_.rows; ++y)
      for (int x = 0; x < grey_.cols; ++x)
        if (const int b = owner_(y, x); b >= 0) {
          const auto k = static_cast<std::size_t>(b);
          use(x, y, k, place(sizes_[size_of_[k]], static_cast<double>(out_(y, x))).k);
        }
  }

  /// Measures the scale of the residuals by r - R, and decides where the profile is used.
  void measure() {
    std::vector<std::vector<double>> residuals(levels_);
    over_owned([&](int x, int y, std::size_t b, std::size_t k) {
      residuals[sizes_[size_of_[b]].first + k].push_back(std::abs(residual(x, y)));
    });
    for (Size& s : sizes_)
      for (std::size_t k = 0; k < s.count; ++k)
        if (auto& of = residuals[s.first + k]; !of.empty())
          s.scale[k] = std::max(noise_, robust_spread(std::move(of)));
    std::vector<double> sums(levels_);
    gain_.create(grey_.size());
    over_owned([&](int x, int y, std::size_t b, std::size_t k) {
      const Size& s = sizes_[size_of_[b]];
      const double gain =
          pixel_gain(residual(x, y), s.scale[k], without_discs(grey_, noise_, x, y, s.steps), noise_);
      gain_(y, x) = gain;
      sums[s.first + k] += gain;
    });
    for (Size& s : sizes_)
      for (std::size_t k = 0; k < s.count; ++k) s.used[k] = sums[s.first + k] > 0;
  }

  /// Cost of the place of a disc: n discs have N^n/n! places among N pixels.
  [[nodiscard]] double place_cost() const {
    return 1 + std::log(static_cast<double>(grey_.total()) / static_cast<double>(discs_.size()));
  }

  PictureEvidence gains() {
    PictureEvidence result;
    const double cost = std::log(static_cast<double>(grey_.total()));
    result.of_disc.assign(discs_.size(), -place_cost());
    result.misfit.assign(discs_.size(), 0);
    std::vector<double> pixels(discs_.size()), owned(discs_.size());
    over_owned([&](int x, int y, std::size_t b, std::size_t k) {
      const Size& s = sizes_[size_of_[b]];
      ++owned[b];
      if (!s.used[k]) return;
      const double e1 = residual(x, y);
      result.of_disc[b] += gain_(y, x);
      if (out_(y, x) < -kRim) return;
      result.misfit[b] += std::log(1 + e1 * e1 / (s.scale[k] * s.scale[k]));
      ++pixels[b];
    });
    for (std::size_t b = 0; b < discs_.size(); ++b) {
      if (pixels[b] > 0) result.misfit[b] /= pixels[b];
      result.of_disc[b] -= kDiscCost * std::log(std::max(1.0, owned[b]));
    }
    for (const double of : result.of_disc) result.total += of;
    for (const Size& s : sizes_)
      result.total -= 0.5 * cost * static_cast<double>(std::count(s.used.begin(), s.used.end(), true));
    return result;
  }

  /// f'(r - R) of a size, by differences of its levels.
  [[nodiscard]] static std::vector<double> slopes(const Size& s) {
    std::vector<double> slope(s.count);
    for (std::size_t k = 0; k < s.count; ++k) {
      const std::size_t below = k > 0 ? k - 1 : 0, above = std::min(k + 1, s.count - 1);
      slope[k] = kPerPixel * (s.level[above] - s.level[below]) / static_cast<double>(above - below);
    }
    return slope;
  }

  std::vector<RimShift> shift_rims() {
    constexpr double kWidth = 0.35, kMinWidth = 2;  // of R; px
    constexpr double kNoise = 2, kModel = 0.02;  // largest residuals by chance: noise; range of the profile
    constexpr auto kSectors = static_cast<double>(RimShift::kSectors);
    std::vector<std::vector<double>> slope;
    for (const Size& s : sizes_) slope.push_back(slopes(s));
    std::vector<RimShift> rims(discs_.size());
    std::vector<double> squares(discs_.size()), pixels(discs_.size()), weights(discs_.size());
    for (int y = 0; y < grey_.rows; ++y)
      for (int x = 0; x < grey_.cols; ++x) {
        if (owner_(y, x) < 0) continue;
        const auto b = static_cast<std::size_t>(owner_(y, x));
        const Detection& d = discs_[b];
        const auto out = static_cast<double>(out_(y, x));
        if (std::abs(out) > std::max(kMinWidth, kWidth * d.radius)) continue;
        const Place p = place(sizes_[size_of_[b]], out);
        const std::vector<double>& f = slope[size_of_[b]];
        const double change = -amplitude_[b] * ((1 - p.part) * f[p.k] + p.part * f[p.k + 1]),
                     e = residual(x, y), turn = std::atan2(y - d.y, x - d.x) / (2 * std::numbers::pi);
        const auto sector =
            static_cast<std::size_t>((turn - std::floor(turn)) * kSectors) % RimShift::kSectors;
        rims[b].px[sector] += change * e;
        rims[b].weight[sector] += change * change;
        rims[b].radius += change * change * (d.radius + out);
        weights[b] += change * change;
        squares[b] += e * e;
        ++pixels[b];
      }
    for (std::size_t b = 0; b < rims.size(); ++b) {
      RimShift& rim = rims[b];
      const std::vector<double>& level = sizes_[size_of_[b]].level;
      const auto [low, high] = std::minmax_element(level.begin(), level.end());
      const double range = amplitude_[b] * (*high - *low);
      if (range < noise_) {  // no rim is seen
        rim = {};
        continue;
      }
      for (std::size_t k = 0; k < RimShift::kSectors; ++k) {
        if (rim.weight[k] <= 0) continue;
        squares[b] -= rim.px[k] * rim.px[k] / rim.weight[k];
        rim.px[k] /= rim.weight[k];
        --pixels[b];
      }
      rim.radius /= weights[b];
      // A larger residual is another shape, not noise.
      const double by_chance = std::hypot(kNoise * noise_, kModel * range);
      rim.variance = std::min(std::max(0.0, squares[b]) / std::max(1.0, pixels[b]), by_chance * by_chance);
    }
    return rims;
  }

  const cv::Mat1f& grey_;
  const std::vector<Detection>& discs_;
  double noise_;
  std::vector<Size> sizes_;
  std::size_t levels_ = 0;
  bool one_layer_ = true;
  std::vector<std::size_t> size_of_;
  std::vector<double> amplitude_, offset_;
  std::vector<std::size_t> first_term_;  // of each pixel in terms_
  std::vector<Term> terms_;
  cv::Mat1i owner_;  // the disc that a pixel belongs to; -1: none
  cv::Mat1f out_;    // r - R of that disc
  cv::Mat1f model_;  // sum of the profiles, each times its amplitude
  cv::Mat1d gain_;   // of each pixel of a disc
  cv::Mat1f own_;    // the profile of the owner, without its amplitude
};

}  // namespace

std::size_t nearest_size(double radius, const std::vector<double>& radii) {
  const auto ratio = [&](double r) { return std::abs(std::log(radius / r)); };
  const auto nearest =
      std::min_element(radii.begin(), radii.end(), [&](double a, double b) { return ratio(a) < ratio(b); });
  return static_cast<std::size_t>(nearest - radii.begin());
}

double pixel_gain(double e1, double s1, double e0, double s0) {
  return std::log(s1 / s0) + std::log((s0 * s0 + e0 * e0) / (s1 * s1 + e1 * e1));
}

double noise_level(const cv::Mat1f& grey) {
  constexpr double kSamples = 40000;      // pixels
  constexpr double kFlattestShare = 0.2;  // of the pixels: those with the smallest second differences
  constexpr double kQuantile = 0.2533;    // of |z|: a fifth of a normal distribution lies within
  constexpr double kMinNoise = 1e-3;      // fraction of the range of the levels
  double low = 0, high = 0;
  cv::minMaxLoc(grey, &low, &high);
  const double least = std::max(kMinNoise * (high - low), 1e-12);
  const int stride = std::max(1, static_cast<int>(static_cast<double>(grey.total()) / kSamples));
  std::vector<float> seen;
  for (int y = stride / 2; y < grey.rows; y += stride) {
    const float* v = grey[y];
    for (int x = 1; x + 1 < grey.cols; ++x) seen.push_back(std::abs(v[x - 1] - 2 * v[x] + v[x + 1]));
  }
  if (seen.empty()) return least;
  const auto at =
      seen.begin() + static_cast<std::ptrdiff_t>(kFlattestShare * static_cast<double>(seen.size()));
  std::nth_element(seen.begin(), at, seen.end());
  return std::max(least, static_cast<double>(*at) / (kQuantile * std::sqrt(6.0)));
}

double possible_evidence(const cv::Mat& grey, double neighbour_radius_px) {
  constexpr double kTypical =
      0.84;  // of a normal variable z: 1 + kTypical^2 is the geometric mean of 1 + z^2
  if (grey.empty()) return 0;
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  const double noise = noise_level(levels);
  const std::vector<cv::Point> steps = steps_of(neighbour_radius_px);
  double sum = 0;
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x)
      sum += std::max(0.0,
                      pixel_gain(kTypical * noise, noise, without_discs(levels, noise, x, y, steps), noise));
  return sum;
}

PictureEvidence picture_evidence(const cv::Mat& grey, const std::vector<Detection>& discs,
                                 const std::vector<double>& radii_px, double neighbour_radius_px,
                                 const cv::Mat1b& walls) {
  if (discs.empty() || grey.empty())
    return {0, std::vector<double>(discs.size(), 0.0), std::vector<double>(discs.size(), 0.0),
            std::vector<RimShift>(discs.size())};
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  return Explanation(levels, discs, radii_px, neighbour_radius_px, walls).evidence();
}

cv::Mat1f residual_picture(const cv::Mat& grey, const std::vector<Detection>& discs,
                           const std::vector<double>& radii_px) {
  if (grey.empty()) return {};
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  return Explanation(levels, discs, radii_px, 0, {}).residuals();
}

}  // namespace twincell::imaging
