#include "imaging/camera/synthetic_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "core/error.hpp"
#include "imaging/camera/dirt.hpp"
#include "imaging/camera/disc_image.hpp"
#include "imaging/camera/random.hpp"
#include "imaging/camera/sensor.hpp"

namespace twincell::imaging {

namespace {

// Gauss-Legendre nodes and weights on (-1/2, 1/2).
constexpr std::array<std::pair<double, double>, 3> kNodes{
    {{-0.387298334620741689, 5.0 / 18}, {0, 8.0 / 18}, {0.387298334620741689, 5.0 / 18}}};

// Share of light at a signed distance from a straight edge; `distance` > 0 on the dark side.
float edge(double distance, double s) {
  return static_cast<float>(0.5 * std::erfc(distance / (std::numbers::sqrt2 * s)));
}

// Times within the exposure and their weights. The exposure is split so that nothing moves much further than
// a pixel in one segment.
std::vector<std::pair<double, double>> exposure_times(double exposure, double length_px) {
  if (exposure == 0 || length_px < 1e-3) return {{0, 1}};
  const int pieces = std::clamp(cvCeil(length_px / 1.5), 1, 64);
  std::vector<std::pair<double, double>> nodes;
  for (int i = 0; i < pieces; ++i)
    for (const auto& [at, weight] : kNodes)
      nodes.emplace_back(exposure * ((i + 0.5 + at) / pieces - 0.5), weight / pieces);
  return nodes;
}

}  // namespace

// Disc images for all radii in use, in steps of 1/50 px. A radius between two steps is a radial shift of the
// nearest image.
class SyntheticCamera::Discs {
 public:
  static constexpr double kPerPixel = 50;
  Discs(const std::vector<double>& radii_px, double least_magnification, double most_magnification,
        double blur_px) {
    for (const double r : radii_px)
      for (auto k = std::lround(r * least_magnification * kPerPixel);
           k <= std::lround(r * most_magnification * kPerPixel); ++k)
        images_.try_emplace(std::max(k, 1L), std::max(k, 1L) / kPerPixel, blur_px);
  }
  struct Sized {
    const DiscImage* image;
    double shift;
    [[nodiscard]] double reach() const { return image->reach() + shift; }
    [[nodiscard]] float at(double dx, double dy, double r) const { return image->at(dx, dy, r - shift); }
  };
  [[nodiscard]] Sized of(double radius_px) const {
    auto found = images_.lower_bound(std::lround(radius_px * kPerPixel));
    if (found == images_.end()) --found;
    return {&found->second, radius_px - static_cast<double>(found->first) / kPerPixel};
  }

 private:
  std::map<long, DiscImage> images_;
};

SyntheticCamera::SyntheticCamera(const CameraOptions& stated, const TrajectoryInfo& info)
    : options_(stated.reduced(info.scale)), info_(info), shutter_(info) {
  const CameraOptions& options = options_;
  options.check();
  auto& [left_tilt, right_tilt] = info_.box.side_tilt;
  if (options.left_tilt != 0) left_tilt = options.left_tilt;
  if (options.right_tilt != 0) right_tilt = options.right_tilt;
  if (options.exposure > 0) Shutter::require_paths(info, "exposure");
  if (options.trigger_jitter > 0) Shutter::require_paths(info, "trigger-jitter");
  if (options.trigger_offset != 0) Shutter::require_paths(info, "trigger-offset");
  const double height = options.max_height > 0 ? options.max_height : info.box.size().z();
  const double amplitude = info.drive ? info.drive->displacement_bound() : 0;
  const double w = info.box.size().x() * options.pixels_per_sigma + 2 * options.margin_px;
  const double h = (height + 2 * amplitude) * options.pixels_per_sigma + 2 * options.margin_px;
  if (!(w >= 1 && h >= 1 && w <= 20000 && h <= 20000))
    throw ConfigError(
        Where{.file = {}, .key = "--pixels-per-sigma"},
        fmt::format("makes a frame of {:.0f} x {:.0f} pixels; at most 20000 a side are drawn.", w, h));
  size_ = {cvCeil(w), cvCeil(h)};
  map_.pixels_per_sigma = options.pixels_per_sigma;
  map_.origin = {options.margin_px - info.box.lower.x() * options.pixels_per_sigma,
                 size_.height - 1 - options.margin_px - amplitude * options.pixels_per_sigma};
  lens_ = std::make_shared<Lens>(size_, options.rotation_deg, options.distortion);

  // Disc images: made once for all radii, at every magnification that the lens produces.
  std::vector<double> radii;
  for (std::size_t k = 0; k < (info.radius.empty() ? 1 : info.n_beads); ++k) radii.push_back(radius_px(k));
  const double corner = lens_->magnification({-0.5, -0.5});
  discs_ = std::make_shared<Discs>(radii, std::min(1.0, corner), std::max(1.0, corner), options.blur_px);

  // Constant layers: light with dirt, upright walls and the map to the ideal picture do not change between
  // frames. Straight edges are blurred by the optics and by the pixel's width (variance 1/12).
  const double s = std::hypot(options.blur_px, std::sqrt(1.0 / 12));
  const bool walls = info.box.boundary[0] == Boundary::wall && left_tilt == 0 && right_tilt == 0;
  const double left = map_.pixel_from_cell(info.box.lower).x_px,
               right = map_.pixel_from_cell(info.box.upper).x_px;
  backlight_ = glass(size_, options);
  if (walls) walls_.create(size_);
  if (!lens_->identity()) ideal_.create(size_);
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x) {
      const double u = (2.0 * x + 1) / size_.width - 1, v = (2.0 * y + 1) / size_.height - 1;
      backlight_(y, x) *=
          static_cast<float>(options.backlight * (1 - options.vignetting * 0.5 * (u * u + v * v)));
      const PixelPoint p = lens_->identity() ? PixelPoint{double(x), double(y)}
                                             : lens_->ideal_from_picture({double(x), double(y)});
      if (walls) walls_(y, x) = edge(left - p.x_px, s) * edge(p.x_px - right, s);
      if (!ideal_.empty()) ideal_(y, x) = {p.x_px, p.y_px};
    }
}

double SyntheticCamera::radius_px(std::size_t slot) const {
  return radius_of(info_.radius, slot) * options_.pixels_per_sigma;
}

Vec3 SyntheticCamera::place(const Exposure& exposure, std::size_t slot, double tau) const {
  Vec3 r = shutter_.position(exposure, slot, exposure.late + tau);
  if (info_.box.periodic(Axis::x)) r.x() = info_.box.wrap(r).x();
  return r;
}

void SyntheticCamera::draw_plate(const Exposure& exposure, cv::Mat1f& share) const {
  const double s = std::hypot(options_.blur_px, std::sqrt(1.0 / 12));
  auto floor_at = [&](double tau) {
    return map_.pixel_from_cell(Vec3(0, 0, shutter_.plate(exposure, exposure.late + tau))).y_px;
  };
  const double e = options_.exposure;
  std::vector<std::pair<double, double>> floors;  // row and weight
  for (const auto& [tau, weight] : exposure_times(
           e, std::abs(floor_at(0.5 * e) - floor_at(0)) + std::abs(floor_at(-0.5 * e) - floor_at(0))))
    floors.emplace_back(floor_at(tau), weight);
  auto light = [&](double y) {
    float sum = 0;
    for (const auto& [floor, weight] : floors) sum += static_cast<float>(weight) * edge(y - floor, s);
    return sum;
  };
  const auto [low, high] = std::minmax_element(floors.begin(), floors.end());
  const double above = low->first - 6 * s, below = high->first + 6 * s;
  for (int y = 0; y < share.rows; ++y) {
    auto* row = share.ptr<float>(y);
    if (ideal_.empty()) {
      if (y < above) continue;
      const float left = y > below ? 0 : light(y);
      for (int x = 0; x < share.cols; ++x) row[x] *= left;
    } else {
      const auto* at = ideal_.ptr<cv::Vec2d>(y);
      for (int x = 0; x < share.cols; ++x)
        if (at[x][1] > above) row[x] *= at[x][1] > below ? 0 : light(at[x][1]);
    }
  }
}

void SyntheticCamera::draw_leaning_walls(const Exposure& exposure, cv::Mat1f& share) const {
  constexpr double kDegree = std::numbers::pi / 180;
  const double s = std::hypot(options_.blur_px, std::sqrt(1.0 / 12));
  const double left = map_.pixel_from_cell(info_.box.lower).x_px,
               right = map_.pixel_from_cell(info_.box.upper).x_px;
  const double floor = map_.pixel_from_cell(Vec3(0, 0, shutter_.plate(exposure, exposure.late))).y_px;
  const double l = info_.box.side_tilt[0] * kDegree, r = info_.box.side_tilt[1] * kDegree;
  for (int y = 0; y < share.rows; ++y)
    for (int x = 0; x < share.cols; ++x) {
      const PixelPoint p =
          ideal_.empty() ? PixelPoint{double(x), double(y)} : PixelPoint{ideal_(y, x)[0], ideal_(y, x)[1]};
      const double up = floor - p.y_px;
      share(y, x) *= edge((left - std::tan(l) * up - p.x_px) * std::cos(l), s) *
                     edge((p.x_px - right - std::tan(r) * up) * std::cos(r), s);
    }
}

/// The image of one bead in its own window of the picture.
struct SyntheticCamera::Stamp {
  cv::Rect window;
  Discs::Sized disc{};
  double radius_px = 0;       // in the ideal picture
  double magnification = 1;   // by the distortion
  bool has_spot = false;      // a bright spot
  std::vector<float> shares;  // of the window's pixels that the disc covers, averaged over its path
};

double SyntheticCamera::path_length_px(const Exposure& exposure, std::size_t slot) const {
  const double e = options_.exposure;
  if (!(e > 0)) return 0;
  return options_.pixels_per_sigma * ((shutter_.position(exposure, slot, exposure.late + 0.5 * e) -
                                       shutter_.position(exposure, slot, exposure.late))
                                          .norm() +
                                      (shutter_.position(exposure, slot, exposure.late - 0.5 * e) -
                                       shutter_.position(exposure, slot, exposure.late))
                                          .norm());
}

bool SyntheticCamera::has_bright_spot(std::size_t slot) const {
  return options_.glare > 0 &&
         RandomStream(options_.seed, Chance::glare, static_cast<std::int64_t>(slot)).uniform() <
             options_.glare_share;
}

void SyntheticCamera::add_to_stamp(const Vec3& at, float weight, Stamp& stamp, cv::Mat1f& glow) const {
  // Local copies: the stores do not change them, which the compiler cannot know.
  const cv::Rect window = stamp.window;
  const Discs::Sized disc = stamp.disc;
  const double magnification = stamp.magnification;
  const bool bent = options_.distortion != 0, has_spot = stamp.has_spot;
  const bool reflected = options_.glare_kind == "reflected";
  const double off = reflected ? -0.35 * stamp.radius_px : 0,
               spot = (reflected ? 0.13 : 0.25) * stamp.radius_px, spot_reach = 4 * spot;
  const PixelPoint ideal = map_.pixel_from_cell(at), c = lens_->picture_from_ideal(ideal);
  float* share = stamp.shares.data();
  for (int y = window.y; y < window.y + window.height; ++y)
    for (int x = window.x; x < window.x + window.width; ++x, ++share) {
      const double dx = x - c.x_px, dy = y - c.y_px;
      double r = 0;
      if (bent) {
        const cv::Vec2d& q = ideal_(y, x);
        r = magnification *
            std::sqrt((q[0] - ideal.x_px) * (q[0] - ideal.x_px) + (q[1] - ideal.y_px) * (q[1] - ideal.y_px));
      } else {
        r = std::sqrt(dx * dx + dy * dy);
      }
      *share += weight * disc.at(dx, dy, r);
      if (has_spot && std::abs(dx - off) < spot_reach && std::abs(dy - off) < spot_reach)
        glow(y, x) +=
            weight * static_cast<float>(options_.glare *
                                        std::exp(-0.5 * ((dx - off) * (dx - off) + (dy - off) * (dy - off)) /
                                                 (spot * spot)));
    }
}

void SyntheticCamera::block_light(const Stamp& stamp, float depth, cv::Mat1f& share) const {
  // In two dimensions discs do not overlap and the blocked light adds up; in three it multiplies.
  const bool flat = info_.box.dimension == 2;
  const cv::Rect& window = stamp.window;
  std::size_t i = 0;
  for (int y = window.y; y < window.y + window.height; ++y) {
    auto* row = share.ptr<float>(y);
    for (int x = window.x; x < window.x + window.width; ++x, ++i)
      row[x] = flat ? row[x] - depth * stamp.shares[i] : row[x] * (1 - depth * stamp.shares[i]);
  }
}

void SyntheticCamera::draw_bead(const Exposure& exposure, std::size_t slot, Stamp& stamp, cv::Mat1f& share,
                                cv::Mat1f& glow) const {
  const Vec3 here = place(exposure, slot, 0);
  const double length = path_length_px(exposure, slot);
  stamp.radius_px = radius_px(slot);
  stamp.magnification = lens_->magnification(map_.pixel_from_cell(here));
  stamp.disc = discs_->of(stamp.radius_px * stamp.magnification);
  const PixelPoint middle = lens_->picture_from_ideal(map_.pixel_from_cell(here));
  const double reach = stamp.disc.reach() * (options_.distortion != 0 ? 1.1 : 1) + 1 + length;
  stamp.window = cv::Rect(cv::Point(cvFloor(middle.x_px - reach), cvFloor(middle.y_px - reach)),
                          cv::Point(cvCeil(middle.x_px + reach) + 1, cvCeil(middle.y_px + reach) + 1)) &
                 cv::Rect({}, size_);
  if (stamp.window.empty()) return;
  stamp.shares.assign(static_cast<std::size_t>(stamp.window.area()), 0);
  stamp.has_spot = has_bright_spot(slot);
  for (const auto& [tau, weight] : exposure_times(options_.exposure, length)) {
    Vec3 at = shutter_.position(exposure, slot, exposure.late + tau);
    // One periodic image for the whole path.
    at.x() += here.x() - shutter_.position(exposure, slot, exposure.late).x();
    add_to_stamp(at, static_cast<float>(weight), stamp, glow);
  }
  const bool tracer = !info_.tracer.empty() && info_.tracer[slot] != 0;
  block_light(stamp, static_cast<float>(tracer ? options_.tracer_darkness : 1), share);
}

void SyntheticCamera::add_cell_and_lamp(const Exposure& exposure, const cv::Mat1f& glow,
                                        cv::Mat1f& share) const {
  // Walls and plate: beads do not overlap them, so what they block adds up. A product of blurred shapes would
  // be too bright where a bead touches a wall, because the blur acts on the picture as a whole.
  cv::Mat1f cell(size_, 1.0F);
  draw_plate(exposure, cell);
  if (walls_.empty() && info_.box.boundary[0] == Boundary::wall) draw_leaning_walls(exposure, cell);
  const auto lamp = static_cast<float>(exposure.lamp);
  for (int y = 0; y < size_.height; ++y)
    for (int x = 0; x < size_.width; ++x) {
      const float open = walls_.empty() ? cell(y, x) : cell(y, x) * walls_(y, x);
      float left = std::max(0.0F, share(y, x) - (1 - open));
      if (options_.bright) left = 1 - left;
      if (!glow.empty()) left += glow(y, x);
      share(y, x) = lamp * backlight_(y, x) * left;
    }
}

cv::Mat1f SyntheticCamera::light(const Exposure& exposure) const {
  const Frame& frame = *exposure.now;
  cv::Mat1f share(size_, 1.0F), glow;
  if (options_.glare > 0) glow = cv::Mat1f::zeros(size_);
  Stamp stamp;  // of one bead after the other, so that its memory is allocated once
  for (std::size_t k = 0; k < info_.n_beads; ++k)
    if (frame.present(k) && std::isfinite(frame.position[k].x())) draw_bead(exposure, k, stamp, share, glow);
  add_cell_and_lamp(exposure, glow, share);
  return share;
}

cv::Mat SyntheticCamera::expose(const Exposure& exposure) const {
  return read_out(light(exposure), options_, exposure.now->step);
}

std::vector<TrueBead> SyntheticCamera::truth(const Exposure& exposure) const {
  constexpr int kRim = 64;
  std::vector<TrueBead> beads;
  for (std::size_t k = 0; k < info_.n_beads; ++k) {
    if (!exposure.now->present(k) || !std::isfinite(exposure.now->position[k].x())) continue;
    const PixelPoint ideal = map_.pixel_from_cell(place(exposure, k, 0)),
                     p = lens_->picture_from_ideal(ideal);
    beads.push_back({k, p.x_px, p.y_px, radius_px(k) * lens_->magnification(ideal), 1,
                     !info_.tracer.empty() && info_.tracer[k] != 0});
  }
  auto inside = [&](double x, double y) {
    return x >= -0.5 && y >= -0.5 && x <= size_.width - 0.5 && y <= size_.height - 0.5;
  };
  // Sorted by x, so that only nearby discs are tested for covering a bead.
  std::vector<std::size_t> order(beads.size());
  std::iota(order.begin(), order.end(), 0);
  double largest = 0;
  if (info_.box.dimension == 3) {
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return beads[a].x < beads[b].x; });
    for (const TrueBead& b : beads) largest = std::max(largest, b.radius);
  }
  for (std::size_t n = 0; n < order.size(); ++n) {
    TrueBead& bead = beads[order[n]];
    int seen = 0;
    for (int a = 0; a < kRim; ++a) {
      const double angle = 2 * std::numbers::pi * (a + 0.5) / kRim;
      const double x = bead.x + bead.radius * std::cos(angle), y = bead.y + bead.radius * std::sin(angle);
      bool free = inside(x, y);
      auto covered = [&](const TrueBead& other) {
        return std::hypot(x - other.x, y - other.y) < other.radius * (1 - 1e-6);
      };
      if (info_.box.dimension == 3) {
        for (std::size_t m = n + 1; free && m < order.size() && beads[order[m]].x < x + largest; ++m)
          free = !covered(beads[order[m]]);
        for (std::size_t m = n; free && m-- > 0 && beads[order[m]].x > x - largest;)
          free = !covered(beads[order[m]]);
      }
      seen += free ? 1 : 0;
    }
    bead.visible = static_cast<double>(seen) / kRim;
  }
  // Beads outside the picture are removed last, because they can cover beads inside it.
  std::erase_if(beads, [&](const TrueBead& b) { return !inside(b.x, b.y); });
  return beads;
}

}  // namespace twincell::imaging
