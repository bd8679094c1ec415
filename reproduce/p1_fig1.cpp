// Fortini & Huang 2015, Fig. 1: the beds before the drive starts, coloured by local order.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/neighbours/neighbours.hpp"
#include "analysis/neighbours/voronoi.hpp"
#include "analysis/report/snapshots_figure.hpp"
#include "reproduce/p1_packings.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

/// Order parameters over the beads inside the bed, whose Voronoi cells touch no wall, hole or free surface.
struct Bulk {
  double least_q6 = INFINITY, largest_q6 = -INFINITY, sum_q6 = 0, least_psi6 = INFINITY;
  std::size_t n = 0;
};

Bulk bulk_of(const Packing& p) {
  const analysis::VoronoiCells cells = analysis::voronoi_cells(p.moment.frame, p.box);
  Bulk b;
  for (std::size_t i = 0; i < cells.enclosed.size(); ++i) {
    if (cells.enclosed[i] == 0) continue;
    const double q6 = p.moment.order.q6[i];
    ++b.n;
    b.sum_q6 += q6;
    b.least_q6 = std::min(b.least_q6, q6);
    b.largest_q6 = std::max(b.largest_q6, q6);
    b.least_psi6 = std::min(b.least_psi6, p.moment.order.psi6[i]);
  }
  return b;
}

/// Clustering of defects. A defect is a bead inside the bed that does not have six neighbours. The number is
/// the share of defects that touch another defect, divided by that share at random positions, 1 - (1 - f)^6,
/// where f is the share of defects.
double clustering_of(const Packing& p) {
  const analysis::VoronoiCells cells = analysis::voronoi_cells(p.moment.frame, p.box);
  const auto defect = [&](std::size_t i) { return cells.enclosed[i] != 0 && cells.neighbours.count(i) != 6; };
  double inside = 0, defects = 0, joined = 0;
  for (std::size_t i = 0; i < cells.enclosed.size(); ++i) {
    if (cells.enclosed[i] == 0) continue;
    ++inside;
    if (!defect(i)) continue;
    ++defects;
    bool touches = false;
    cells.neighbours.for_each(i, [&](std::size_t j, const Vec3&) { touches = touches || defect(j); });
    joined += touches ? 1 : 0;
  }
  return defects == 0 ? 0 : joined / defects / (1 - std::pow(1 - defects / inside, 6));
}

std::vector<Target> targets_of(const Packings& all) {
  std::vector<Target> targets;
  const Packing* crystal = all.crystal("crystal_a");
  Target q6{"q6 inside the crystal", "0.7408 +- 0.001", "", Verdict::absent, ""};
  Target psi6{"psi6 inside the crystal", "above 0.999", "", Verdict::absent, ""};
  q6.not_counted = psi6.not_counted = "it describes how the bed is made";
  if (crystal != nullptr) {
    const Bulk b = bulk_of(*crystal);
    q6.measured = fmt::format("{:.5f}, from {:.5f} to {:.5f} over {} beads",
                              b.sum_q6 / static_cast<double>(b.n), b.least_q6, b.largest_q6, b.n);
    q6.verdict = judge({b.sum_q6 / static_cast<double>(b.n), b.least_q6, b.largest_q6}, 0.7398, 0.7418);
    psi6.measured = fmt::format("{:.6f} at least, over {} beads", b.least_psi6, b.n);
    psi6.verdict = judge(exact(b.least_psi6), 0.999, kUnbounded);
  }
  targets.push_back(q6);
  targets.push_back(psi6);
  Target ordered{"share of hexagonal beads (psi6 > 0.9) inside random beds", "above 0.5", "", Verdict::absent,
                 ""};
  Target lines{"defects of random beds lie together, times chance", "above 1", "", Verdict::absent, ""};
  Target grains{"random beds have grain boundaries", "in every bed", "", Verdict::absent, ""};
  if (!all.random.empty()) {
    const Estimate share = all.over_random([](const Packing& p) { return p.scalars.at("ordered_fraction"); });
    ordered.measured = fmt::format("{}, {} random", share.text(), all.random.size());
    ordered.verdict = judge(share, 0.5, kUnbounded);
    const Estimate together = all.over_random(clustering_of);
    lines.measured = together.text();
    lines.verdict = above(together, exact(1));
    const auto with = std::count_if(all.random.begin(), all.random.end(), [](const Packing& p) {
      return p.scalars.at("grain_boundary_fraction") > 0;
    });
    grains.measured =
        fmt::format("{} of {} beds; {} grains and {} dislocations a bed", with, all.random.size(),
                    all.over_random([](const Packing& p) { return p.scalars.at("grains"); }).text(),
                    all.over_random([](const Packing& p) { return p.scalars.at("dislocations"); }).text());
    grains.verdict = holds(static_cast<std::size_t>(with) == all.random.size());
  }
  targets.push_back(ordered);
  targets.push_back(lines);
  targets.push_back(grains);
  targets.push_back(
      {"initial bed of the experiment", "the same appearance", "", Verdict::absent,
       "its positions are printed in the figure alone; `match` makes a bed from a stack of frames"});
  return targets;
}

analysis::Figure figure_of(const Packings& all) {
  std::vector<analysis::BeadPanel> panels;
  const auto add = [&](const Packing& p) { panels.push_back({p.title(), &p.moment, p.box, p.radius}); };
  if (const Packing* crystal = all.crystal("crystal_a")) add(*crystal);
  for (std::size_t i = 0; i < std::min<std::size_t>(2, all.random.size()); ++i) add(all.random[i]);
  // Omit the seeds, which are long numbers; the table contains them.
  for (std::size_t i = 0; i < panels.size(); ++i) {
    if (panels[i].title.starts_with("random"))
      panels[i].title = panels.size() == 3 && i == 2 ? "another seed" : "random";
    panels[i].title = fmt::format("({}) {}", "abc"[i], panels[i].title);
  }
  analysis::Figure f = analysis::beads_figure(
      panels, "p1-fig1", fmt::format("Beds before the drive, N_l = {}", all.layers), panels.size());
  f.caption += " Form of Fortini & Huang 2015, Fig. 1.";
  return f;
}

Reproduction run(const Request& request) {
  const Packings all = settle_packings(request);
  const auto mean_q6 = [](const Bulk& b) { return b.sum_q6 / static_cast<double>(b.n); };
  return reproduction_of(
      all, "Fortini & Huang 2015, Fig. 1: initial beds", targets_of(all),
      [&](const Packing& p) {
        return fmt::format("q6 {:.4f}, psi6 > 0.9: {:.3f}, {:.0f} grains, {:.0f} dislocations",
                           mean_q6(bulk_of(p)), p.scalars.at("ordered_fraction"), p.scalars.at("grains"),
                           p.scalars.at("dislocations"));
      },
      [&](const Packing& p) {
        return json{{"q6_inside", mean_q6(bulk_of(p))}, {"defects_together_over_chance", clustering_of(p)}};
      },
      figure_of);
}

}  // namespace

Reproducible p1_fig1() {
  return {.name = "p1-fig1",
          .what = "crystal and random beds before the drive starts, coloured by q6",
          .run = run,
          .shared_runs = kPackingRuns};
}

}  // namespace twincell::reproduce
