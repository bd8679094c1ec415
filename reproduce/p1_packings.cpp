#include "reproduce/p1_packings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "analysis/statistics/statistics.hpp"
#include "core/json_text.hpp"
#include "reproduce/p1_scene.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::reproduce {

namespace {

using nlohmann::json;

constexpr double kCutoff = 1.2;  ///< sigma; touching beads are at 1, the next shell at 1.41 or 1.73

/// Extent of the study at a given budget. The paper shows N_l = 60.
struct Size {
  double core_minutes;
  int layers, seeds;
};
constexpr int kPaperLayers = 60;
const Size& size_for(const Request& request) {
  static constexpr std::array<Size, 4> all = {{{0, 20, 1}, {0.5, 20, 4}, {2, 60, 32}, {1e300, 60, 40}}};
  if (request.full) return all.back();
  const Size* chosen = &all.front();
  for (const Size& size : all)
    if (request.minutes * request.threads >= size.core_minutes) chosen = &size;
  return *chosen;
}

/// Plan of beds without drive; one frame of each.
sweep::Plan plan_of(const P1Run& run, const std::string& axes, std::uint64_t seed) {
  return sweep::read_plan_text(
      fmt::format("seed = {}\nresults = [\"q6\", \"psi6\", \"ordered_fraction\", \"orientation\", "
                  "\"orientation_a\", \"orientation_b\", \"grains\", \"grain_boundary_fraction\", "
                  "\"grain_boundary_angle\", \"dislocations\", \"defect_fraction\"]\n{}time.phases = "
                  "1\ndrive.gamma = 0.0\n[axes]\n{}",
                  seed, p1_scene(run), axes),
      fmt::format("packings, {} layers", run.layers));
}

Packing packing_of(const sweep::Point& point, const std::string& start, const std::string& result,
                   const sweep::Store& store) {
  Packing p;
  p.start = start;
  p.seed = point.seed;
  const json results = json::parse(result).value("results", json::object());
  for (const auto& [name, r] : results.items())
    if (r.contains("value") && r["value"].is_number()) p.scalars[name] = r["value"].get<double>();
  const H5mdReader trajectory(store.of(point) / "trajectory.h5");
  p.box = trajectory.info().box;
  p.radius = trajectory.info().radius;
  p.moment = analysis::snapshot(trajectory, 0, kCutoff);
  return p;
}

}  // namespace

std::string Packing::title() const {
  if (start == "crystal_a") return "crystal A";
  if (start == "crystal_b") return "crystal B";
  return fmt::format("random, seed {}", seed);
}

const Packing* Packings::crystal(const std::string& start) const {
  const auto found =
      std::find_if(crystals.begin(), crystals.end(), [&](const Packing& p) { return p.start == start; });
  return found == crystals.end() ? nullptr : &*found;
}

Estimate Packings::over_random(const std::function<double(const Packing&)>& of) const {
  std::vector<double> values;
  values.reserve(random.size());
  for (const Packing& p : random) values.push_back(of(p));
  Estimate e;
  for (const double v : values) e.value += v / static_cast<double>(values.size());
  if (const auto interval = analysis::mean_interval(values, "random beds")) {
    e.low = interval->low;
    e.high = interval->high;
  }
  return e;
}

Packings settle_packings(const Request& request) {
  const Size& size = size_for(request);
  const sweep::Store store(request.runs);
  const P1Run crystal{size.layers, "crystal_a", 1, 0}, random{size.layers, "random", 1, 0};
  P1Run any_crystal = crystal;
  any_crystal.start.clear();
  const sweep::Plan crystals =
      plan_of(any_crystal, "start.kind = [\"crystal_a\", \"crystal_b\"]\n", request.seed);
  const sweep::Plan randoms = plan_of(random, fmt::format("seeds = {}\n", size.seeds), request.seed);
  sweep::Schedule c(crystals, store), r(randoms, store);
  Packings all;
  all.layers = size.layers;
  all.complete = run_here({&c, &r}, store, {request.threads, true}, *request.watch);
  for (const sweep::Schedule* schedule : {&c, &r})
    for (const sweep::Curve& curve : schedule->curves())
      for (std::size_t i = 0; i < curve.points.size(); ++i) {
        if (!curve.results[i] || curve.failed[i] != 0) continue;
        const bool is_random = schedule == &r;
        const std::string& value = is_random ? "random" : curve.values.front();
        (is_random ? all.random : all.crystals)
            .push_back(packing_of(curve.points[i],
                                  is_random                               ? "random"
                                  : value.find("_b") != std::string::npos ? "crystal_b"
                                                                          : "crystal_a",
                                  *curve.results[i], store));
      }
  all.conditions = p1_contact_conditions();
  all.conditions.push_back(p1_step_condition(random));
  all.conditions.emplace_back(
      "beds at rest, before the drive begins; crystals unperturbed; neighbours within 1.2 sigma");
  all.conditions.push_back(fmt::format("{} random bed{}, seeds drawn from the master seed {}",
                                       all.random.size(), all.random.size() == 1 ? "" : "s", request.seed));
  all.cheaper.push_back(p1_cheaper_steps());
  if (size.layers != kPaperLayers)
    all.cheaper.push_back(fmt::format("N_l = {}, where the paper shows {}", size.layers, kPaperLayers));
  return all;
}

Reproduction reproduction_of(const Packings& all, const std::string& title, std::vector<Target> targets,
                             const std::function<std::string(const Packing&)>& line,
                             const std::function<json(const Packing&)>& more,
                             const std::function<analysis::Figure(const Packings&)>& figure) {
  Reproduction r{.title = title,
                 .targets = std::move(targets),
                 .cheaper = all.cheaper,
                 .conditions = all.conditions,
                 .complete = all.complete};
  r.runs = fmt::format("{} random beds, each crystal once", all.random.size());
  json measured = json::array();
  for (const auto* beds : {&all.crystals, &all.random})
    for (const Packing& p : *beds) {
      json bed = {{"start", p.start}, {"layers", all.layers}, {"seed", p.seed}, {"results", p.scalars}};
      bed.update(more(p));
      measured.push_back(std::move(bed));
      r.table += fmt::format("  {:<26} {}\n", p.title(), line(p));
    }
  r.measured = json_text(measured);
  if (!all.crystals.empty() || !all.random.empty()) r.figures = {figure(all)};
  return r;
}

}  // namespace twincell::reproduce
