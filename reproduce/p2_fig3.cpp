// Bhateja, Sharma & Singh 2016, Fig. 3: which layers move well below W_f, just below it and at it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/json_text.hpp"
#include "reproduce/gas.hpp"
#include "sim/run/simulation.hpp"
#include "sim/scene/read_scene.hpp"

namespace twincell::reproduce {

namespace {

/// W = 1.397, 2.012 and 2.739. The paper states of its three snapshots only W < W_f, W just below W_f and
/// W = W_f.
constexpr int kRpm[] = {500, 600, 700};
constexpr std::size_t kLayers = 4;

/// Share of mobile beads per layer: beads that move by more than a fifth of a diameter relative to the centre
/// of mass within a cycle. A bead belongs to the layer in which it starts the cycle.
class Mobility : public TrajectorySink {
 public:
  explicit Mobility(const Box& box) : box_(box) {}

  void append(const Frame& frame) override {
    if (frame.phase != 0) return;
    if (!last.position.empty()) count(frame);
    last = frame;
  }
  [[nodiscard]] double mobile(std::size_t layer) const { return moved_[layer] / std::max(1.0, seen_[layer]); }

  Frame last;  ///< at the beginning of the last cycle

 private:
  void count(const Frame& now) {
    const std::size_t n = now.position.size();
    std::vector<Vec3> step(n);
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      step[i] = box_.nearest_image(now.position[i] - last.position[i]);
      mean += step[i] / static_cast<double>(n);
    }
    std::vector<std::size_t> by_height(n);
    std::iota(by_height.begin(), by_height.end(), std::size_t{0});
    std::sort(by_height.begin(), by_height.end(),
              [&](std::size_t a, std::size_t b) { return last.position[a].z() < last.position[b].z(); });
    constexpr double kFifth = 0.2;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t layer = k * kLayers / n;
      seen_[layer] += 1;
      if ((step[by_height[k]] - mean).norm() > kFifth) moved_[layer] += 1;
    }
  }

  Box box_;
  std::array<double, kLayers> seen_{}, moved_{};
};

/// A bed at the beginning of a cycle.
struct BedSnapshot {
  double w;
  Frame frame;
  Box box;

  /// Speed of bead i about the centre of mass, over V_p.
  [[nodiscard]] double speed(std::size_t i) const {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& v : frame.velocity) mean += v / static_cast<double>(frame.velocity.size());
    return (frame.velocity[i] - mean).norm() / std::sqrt(w);
  }
};

/// One figure for each snapshot, all with the same scales of length and of speed.
std::vector<analysis::Figure> snapshot_figures(const std::vector<BedSnapshot>& all) {
  static constexpr std::array<const char*, 3> kRelations = {
      "for the paper’s W < W_f", "for the paper’s W ≲ W_f", "for the paper’s W = W_f"};
  constexpr double kShown = 12;  // a bead thrown high must not shrink the bed
  double top = 0, fastest = 0;
  for (const BedSnapshot& s : all)
    for (std::size_t i = 0; i < s.frame.position.size(); ++i) {
      top = std::max(top, std::min(kShown, s.frame.position[i].z() + 1));
      fastest = std::max(fastest, s.speed(i));
    }
  std::vector<analysis::Figure> figures;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const BedSnapshot& s = all[k];
    const double wide = s.box.size().x();
    analysis::Figure f{.name = fmt::format("p2-fig3{}", "abc"[k]),
                       .title = fmt::format("W = {:.3g}", s.w),
                       .width = 480,
                       .height = static_cast<int>(150 + 330 * (top + 1) / wide)};
    f.data = "# x z radius speed about the centre of mass/V_p\n";
    for (std::size_t i = 0; i < s.frame.position.size(); ++i) {
      const Vec3 r = s.box.wrap(s.frame.position[i]);
      // A bead at one side of the periodic cell is drawn at the other side too.
      for (const double image : {-wide, 0.0, wide})
        if (const double x = r.x() + image; x > s.box.lower.x() - 0.5 && x < s.box.upper.x() + 0.5)
          f.data += fmt::format("{} {} 0.5 {}\n", x, r.z(), s.speed(i));
    }
    f.plot =
        fmt::format(
            "set size ratio -1\nset xlabel 'x/d'\nset ylabel 'z/d'\nset xrange [{}:{}]\nset yrange "
            "[-1:{:.3g}]\n",
            s.box.lower.x(), s.box.upper.x(), top) +
        analysis::figure_style::panel_title("abc"[k],
                                            fmt::format("2D smooth, W = {:.3g}, {}", s.w, kRelations[k])) +
        fmt::format(
            "set style fill solid border lc rgb '#444444'\nset cbrange [0:{:.3g}]\nset cblabel 'speed about "
            "the centre of mass/V_p'\nunset key\n"
            "plot '{}.dat' using 1:2:3:4 with circles fc palette, {} lw 3 lc rgb '#222222'\n",
            fastest, f.name, s.frame.plate_height);
    f.caption =
        "A smooth bed of the plane at the beginning of a cycle, up to 12 d; the scale of speed is the same "
        "in (a), (b) and (c). The paper states W relative to W_f alone. Form of Bhateja et al. 2016, Fig. 3.";
    figures.push_back(f);
  }
  return figures;
}

Reproduction run(const Request& request) {
  Reproduction r;
  r.title = "Bhateja et al. 2016, Fig. 3: which layers of a smooth bed move";
  const int cycles = request.full ? 400 : 100;
  std::vector<std::array<double, kLayers>> mobile;
  std::vector<BedSnapshot> snapshots;
  nlohmann::json measured = nlohmann::json::array();
  for (const int rpm : kRpm) {
    const double w = w_of_rpm(rpm);
    sim::Simulation bed(sim::read_scene_text(
        fmt::format("preset = \"bhateja-2016-smooth-2d\"\ndrive.k_m = {:.17g}\n{}\nstart.seed = "
                    "{}\ntime.integrator = \"split\"\n"
                    "time.steps_per_contact = 6.37\ntime.discard = 50\ntime.cycles = {}\ntime.phases = 1\n",
                    w, kAbrupt, request.seed, cycles),
        fmt::format("p2-fig3, {} rpm", rpm)));
    const Box box = bed.trajectory_info().box;
    Mobility mobility(box);
    bed.run(mobility);
    std::array<double, kLayers> shares{};
    for (std::size_t k = 0; k < kLayers; ++k) shares[k] = mobility.mobile(k);
    mobile.push_back(shares);
    measured.push_back({{"w", w}, {"mobile", shares}});
    r.table += fmt::format(
        "  W = {:.4g}: share of mobile beads a cycle, from the lowest layer up: {:.2f} {:.2f} {:.2f} "
        "{:.2f}\n",
        w, shares[0], shares[1], shares[2], shares[3]);
    snapshots.push_back({w, mobility.last, box});
  }
  r.figures = snapshot_figures(snapshots);
  const auto said = [&](std::size_t k) {
    return fmt::format("lowest {:.2f}, highest {:.2f}", mobile[k][0], mobile[k][kLayers - 1]);
  };
  r.targets = {{"W < W_f, here 1.397: only the upper layers are mobilized",
                "lowest layer less than half of the highest", said(0),
                holds(mobile[0][0] < mobile[0][kLayers - 1] / 2),
                "the paper states no W; mobile: 0.2 d relative to the centre of mass within a cycle; in a "
                "bed that begins by moving along with the plate, the lower layers hardly move "
                "(docs/reproduce.md)"},
               {"W = W_f, here 2.739: all layers are agitated", "every layer more than half mobile", said(2),
                holds(*std::min_element(mobile[2].begin(), mobile[2].end()) > 0.5), ""},
               {"the lowest layer moves more at W = W_f, here 2.739, than at W < W_f, here 1.397", "more",
                fmt::format("{:.2f}, {:.2f}, {:.2f}", mobile[0][0], mobile[1][0], mobile[2][0]),
                holds(mobile[0][0] < mobile[2][0]), ""}};
  r.measured = json_text(measured);
  r.conditions = {"beds begin abruptly from rest, as in Fig. 2",
                  "split integrator, n = 6.37 steps per contact",
                  fmt::format("50 cycles discarded, {} counted, seed {}", cycles, request.seed)};
  r.runs = fmt::format("one run a point, {} cycles", cycles);
  r.cheaper = {fmt::format("one seed, {} cycles each", cycles),
               "the insets, T_bar_z near W = 1, are p2-fig2's points"};
  r.complete = true;
  return r;
}

}  // namespace

Reproducible p2_fig3() {
  return {.name = "p2-fig3",
          .what = "snapshots below, near and at W_f, and the mobile layers",
          .run = run,
          .time_share = 0.2};
}

}  // namespace twincell::reproduce
