// Fortini & Huang 2015, Fig. 2: the two orientations of a hexagonal lattice at a side wall, and the shares of
// random beds in each.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "analysis/report/colours.hpp"
#include "analysis/report/figure_style.hpp"
#include "reproduce/p1_packings.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

struct Orientation {
  const char *start, *name, *colour;
  double angle;  ///< of close-packed rows to the floor, degrees; the lattice repeats every 60 degrees
};
constexpr Orientation kA = {"crystal_a", "A", analysis::colours::kSky, 0},
                      kB = {"crystal_b", "B", analysis::colours::kOrange, 30};

constexpr const char* kBetween = "#DDDDDD";

double share(const Packing& p, const char* name) {
  return p.scalars.at(name);
}

std::vector<Target> targets_of(const Packings& all) {
  std::vector<Target> targets;
  for (const Orientation& o : {kA, kB}) {
    Target t{fmt::format("close-packed rows of the crystal in orientation {}", o.name),
             fmt::format("{:g} +- 1 degrees to the floor", o.angle), "", Verdict::absent, ""};
    if (const Packing* crystal = all.crystal(o.start)) {
      const double angle = crystal->scalars.at("orientation");
      t.measured = fmt::format("{:.4f} degrees", angle);
      t.verdict = judge(exact(angle), o.angle - 1, o.angle + 1);
      t.not_counted = "it describes how the bed is made";
      if (std::string_view(o.start) == kB.start)
        t.reason =
            "a width of 20 sigma is not a multiple of the distance of the rows, so this crystal has a seam "
            "of "
            "dislocations";
    }
    targets.push_back(t);
  }
  Target favoured{"random beds favour A: share of A less share of B", "above 0", "", Verdict::absent, ""};
  Target both{"random beds hold grains of both, with boundaries", "in every bed", "", Verdict::absent, ""};
  if (!all.random.empty()) {
    const Estimate difference = all.over_random(
        [](const Packing& p) { return share(p, "orientation_a") - share(p, "orientation_b"); });
    favoured.measured = fmt::format("{}, {} random", difference.text(), all.random.size());
    favoured.verdict = above(difference, exact(0));
    if (favoured.verdict == Verdict::inconclusive)
      favoured.reason = "beds differ more among each other than A from B";
    if (favoured.verdict == Verdict::fail)
      favoured.reason =
          "the paper does not say how its beads were placed: beds that fall from a dilute column "
          "(start.fraction = 0.1) favour A, those from the default column B";
    const auto with = std::count_if(all.random.begin(), all.random.end(), [](const Packing& p) {
      return share(p, "orientation_a") > 0 && share(p, "orientation_b") > 0 &&
             share(p, "grain_boundary_fraction") > 0;
    });
    both.measured = fmt::format("{} of {} beds", with, all.random.size());
    both.verdict = holds(static_cast<std::size_t>(with) == all.random.size());
    both.not_counted = "the beds are those of `p1-fig1`";
  }
  targets.push_back(favoured);
  targets.push_back(both);
  targets.push_back({"the experiment's beds favour B", "B above A", "", Verdict::absent,
                     "their positions are printed in Fig. 1 alone; `analyze` gives orientation_a and "
                     "orientation_b of a film"});
  return targets;
}

analysis::Figure figure_of(const Packings& all) {
  constexpr double kCornerSide_sigma = 6;  // enough rows to show the orientation
  analysis::Figure f{
      .name = "p1-fig2", .title = "Orientations of the lattice at a side wall", .width = 720, .height = 330};
  f.plot = "set multiplot\nunset grid\n";
  // Left panels: a corner of the crystal in each orientation.
  int index = 0;
  for (const Orientation& o : {kA, kB}) {
    const Packing* crystal = all.crystal(o.start);
    if (crystal == nullptr) continue;
    f.data += fmt::format("# orientation {}, beads at the left wall: x, z, radius\n", o.name);
    for (std::size_t i = 0; i < crystal->moment.frame.position.size(); ++i) {
      const Vec3& at = crystal->moment.frame.position[i];
      if (at.x() < kCornerSide_sigma && at.z() < kCornerSide_sigma)
        f.data += fmt::format("{:.5f} {:.5f} {:g}\n", at.x(), at.z(), radius_of(crystal->radius, i));
    }
    f.data += "\n\n";
    const double left = 0.01 + 0.31 * index;
    f.plot += fmt::format(
        "set lmargin at screen {0}\nset rmargin at screen {1}\nset bmargin at screen 0.16\nset tmargin at "
        "screen 0.86\nset size ratio -1\nunset tics\nunset border\nunset key\nset xrange [-0.6:{2}]\nset "
        "yrange [-0.6:{2}]\n{3}set object 1 rectangle from -0.5,0 to 0,{2} fs solid 0.6 noborder fc rgb "
        "'#888888' front\nset object 2 rectangle from -0.5,-0.5 to {2},0 fs solid 0.6 noborder fc rgb "
        "'#888888' front\nplot '{4}.dat' index {5} using 1:2:3 with circles fs solid border lc rgb '#333333' "
        "fc rgb '{6}'\nunset object 1\nunset object 2\n",
        left, left + 0.29, kCornerSide_sigma,
        analysis::figure_style::panel_title("ab"[index], fmt::format("orientation {}", o.name)), f.name,
        index, o.colour);
    ++index;
  }
  // Right panel: shares of the orientations in the random beds.
  if (!all.random.empty()) {
    f.data += "# random beds by their share of A: rank, shares of A, between, B\n";
    std::vector<std::pair<double, double>> shares;
    for (const Packing& p : all.random)
      shares.emplace_back(share(p, "orientation_a"), share(p, "orientation_b"));
    std::sort(shares.rbegin(), shares.rend());
    for (std::size_t i = 0; i < shares.size(); ++i)
      f.data += fmt::format("{} {:.5f} {:.5f} {:.5f}\n", i + 1, shares[i].first,
                            1 - shares[i].first - shares[i].second, shares[i].second);
    f.plot += fmt::format(
        "set lmargin at screen 0.74\nset rmargin at screen 0.98\nset tmargin at screen 0.86\nset bmargin at "
        "screen 0.36\nset size noratio\nset border\nset tics\nset xtics {8} scale 0\nset ytics 0.2\n"
        "set xrange [0.3:{0}]\nset yrange [0:1]\n{1}"
        "set xlabel 'beds, by share of A'\nset ylabel 'share of ordered beads' offset 1,0\nset boxwidth 0.8\n"
        "set style fill solid noborder\n"
        "plot '{2}.dat' index {3} using 1:($2+$3+$4) with boxes lc rgb '{4}' notitle, '' index {3} using "
        "1:($2+$3) with boxes lc rgb '{5}' notitle, '' index {3} using 1:2 with boxes lc rgb '{6}' notitle, "
        "1./3 with lines {7} notitle, 2./3 with lines {7} notitle\n",
        static_cast<double>(all.random.size()) + 0.7,
        analysis::figure_style::panel_title('c', fmt::format("random, N_l = {}", all.layers)), f.name, index,
        kB.colour, kBetween, kA.colour, analysis::figure_style::kStated, all.random.size() > 12 ? 8 : 1);
  }
  const auto box = [](const char* colour, const char* title) {
    return fmt::format("keyentry with boxes lc rgb '{}' title '{}'", colour, title);
  };
  f.plot +=
      analysis::figure_style::Panels(1, 3, f.width, f.height, 1)
          .end({box(kA.colour, "A"), box(kBetween, "between"), box(kB.colour, "B"),
                fmt::format("keyentry with lines {} title 'by chance'", analysis::figure_style::kStated)});
  f.caption =
      "(a), (b) Crystals in the two orientations at the side wall and the floor. (c) Of the ordered beads "
      "(psi6 > 0.9) of each random bed, beds in the order of their share of A, the shares whose close-packed "
      "rows are within 10 degrees of the "
      "floor (A) and of the side walls (B); randomly oriented lattices would give a third each (dashed). The "
      "paper's random beds favour A. Form of Fortini & Huang 2015, Fig. 2.";
  return f;
}

Reproduction run(const Request& request) {
  const Packings all = settle_packings(request);
  return reproduction_of(
      all, "Fortini & Huang 2015, Fig. 2: orientations of the lattice", targets_of(all),
      [](const Packing& p) {
        return fmt::format("{:7.3f} degrees, A {:.3f}, B {:.3f}", p.scalars.at("orientation"),
                           share(p, "orientation_a"), share(p, "orientation_b"));
      },
      [](const Packing&) { return json::object(); }, figure_of);
}

}  // namespace

Reproducible p1_fig2() {
  return {.name = "p1-fig2",
          .what = "lattice orientations A and B at a side wall, and their shares in random beds",
          .run = run,
          .shared_runs = kPackingRuns};
}

}  // namespace twincell::reproduce
