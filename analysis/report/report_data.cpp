#include "analysis/report/report_data.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/observable/results.hpp"
#include "analysis/report/page_parts.hpp"
#include "analysis/runs/match_verdict.hpp"
#include "core/json_text.hpp"

namespace twincell::analysis {
namespace {

using nlohmann::json;

json thousandths(double v) {
  return std::isfinite(v) ? json(std::lround(1000 * v)) : json(nullptr);
}
json hundredths(double v) {
  return std::isfinite(v) ? std::lround(100 * v) : -1;
}

std::string label_of(const Frame& frame, int phases) {
  if (frame.cycle < 0 || frame.phase < 0 || phases <= 0) return fmt::format("frame {}", frame.step);
  return fmt::format("cycle {}, phase {}/{}", frame.cycle, frame.phase, phases);
}

/// Media type of a picture, by its first bytes.
std::string media_type_of(std::string_view picture) {
  return picture.starts_with("\xff\xd8") ? "image/jpeg" : "image/png";
}

json snapshot_json(const Snapshot& snapshot, int phases, const std::string& picture) {
  const Frame& f = snapshot.frame;
  const bool locked = f.cycle >= 0 && f.phase >= 0 && phases > 0;
  json j = {{"label", label_of(f, phases)},
            {"step", f.step},
            {"cycle", locked ? json(f.cycle) : json(nullptr)},
            {"fraction", locked ? static_cast<double>(f.phase) / phases : 0.0},
            {"plate", number_or_null(snapshot.plate)},
            {"picture", picture.empty() ? json(nullptr) : json(data_uri(media_type_of(picture), picture))}};
  for (const char* column : {"x", "z", "q6", "psi6", "bonds", "coordination", "structure"})
    j[column] = json::array();
  for (std::size_t i = 0; i < f.position.size(); ++i) {
    const bool there = f.present(i) && f.position[i].allFinite();
    j["x"].push_back(there ? thousandths(f.position[i].x()) : json(nullptr));
    j["z"].push_back(there ? thousandths(f.position[i].z()) : json(nullptr));
    j["q6"].push_back(hundredths(snapshot.order.q6[i]));
    j["psi6"].push_back(hundredths(snapshot.order.psi6[i]));
    j["bonds"].push_back(snapshot.order.n_bonds[i]);
    j["coordination"].push_back(i < snapshot.coordination.size() ? snapshot.coordination[i] : 0);
    j["structure"].push_back(static_cast<int>(structure_of(snapshot.order, i)));
  }
  return j;
}

/// Results without those of single beads and the displacement field, which the page takes from snapshots and
/// convection.
json results_of(const Run& run) {
  json all = json::parse(results_json(run.results));
  for (auto it = all.begin(); it != all.end();)
    if (it.key().ends_with("_beads") || it.key() == "displacement_field")
      it = all.erase(it);
    else
      ++it;
  return all;
}

/// The convection field, or null if it is absent: displacements per cycle (u along x, w along z), row by row,
/// and the extent of the field.
json convection_json(const std::vector<Result>& results) {
  const Result *field = seek_result(results, "displacement_field"), *x = seek_result(results, "field_x"),
               *z = seek_result(results, "field_z");
  for (const Result* r : {field, x, z})
    if (r == nullptr || !r->present()) return nullptr;
  const std::size_t rows = z->values.size(), columns = x->values.size();
  if (rows == 0 || columns == 0 || field->values.size() != 2 * rows * columns) return nullptr;
  // The cells are square, so that a single row or column has the spacing of the other axis.
  const auto spacing = [](const Result& r, double other) {
    return r.values.size() > 1 ? r.values[1] - r.values[0] : other;
  };
  const double dx = spacing(*x, spacing(*z, 1)), dz = spacing(*z, dx);
  json j = {{"rows", rows},
            {"columns", columns},
            {"extent",
             {x->values.front() - dx / 2, x->values.back() + dx / 2, z->values.front() - dz / 2,
              z->values.back() + dz / 2}},
            {"u", json::array()},
            {"w", json::array()}};
  for (std::size_t k = 0; k < rows * columns; ++k) {
    j["u"].push_back(number_or_null(field->values[2 * k]));
    j["w"].push_back(number_or_null(field->values[2 * k + 1]));
  }
  return j;
}

json run_json(const Run& run) {
  json j = {{"side", side_name(run.side)},
            {"name", run.name},
            {"start", run.start},
            {"gamma", number_or_null(run.gamma)},
            {"k_m", number_or_null(run.k_m)},
            {"omega", number_or_null(run.omega)},
            {"n_l", number_or_null(run.n_l)},
            {"phase", phase_name(run.phase)},
            {"beads", run.n_beads},
            {"box", {run.box.lower.x(), run.box.upper.x(), run.box.lower.z(), run.box.upper.z()}},
            {"periodic", run.box.periodic(Axis::x)},
            {"radius", nullptr},
            {"tracers", run.tracers},
            {"camera", nullptr},
            {"convection", convection_json(run.results)},
            {"results", results_of(run)},
            {"moments", json::array()}};
  if (!run.radius.empty()) {
    j["radius"] = json::array();
    for (const double r : run.radius) j["radius"].push_back(thousandths(r));
  }
  if (const auto& c = run.show.camera)
    j["camera"] = {{"s", c->pixels_per_sigma},
                   {"ox", c->origin_x},
                   {"oy", c->origin_y},
                   {"w", c->width},
                   {"h", c->height}};
  for (std::size_t m = 0; m < run.show.snapshots.size(); ++m) {
    Snapshot snapshot = run.show.snapshots[m];
    for (Vec3& r : snapshot.frame.position)  // a bead beyond a periodic boundary is shown inside the cell
      if (r.allFinite()) r = run.box.wrap(r);
    j["moments"].push_back(snapshot_json(
        snapshot, run.phases_per_cycle, m < run.show.pictures.size() ? run.show.pictures[m] : std::string()));
  }
  return j;
}

}  // namespace

std::string report_data(const Comparison& comparison) {
  json document = {{"runs", json::array()},
                   {"matches", json::array()},
                   {"boundaries", json::array()},
                   {"sweep", json::array()}};
  for (const Run& run : comparison.runs) document["runs"].push_back(run_json(run));
  for (const Match& match : comparison.matches)
    document["matches"].push_back({{"gamma", match.gamma},
                                   {"experiments", match.experiments},
                                   {"simulations", match.simulations},
                                   {"verdict", verdict_word(comparison.runs, match)}});
  for (const PhaseBoundary& b : comparison.boundaries) {
    const auto gamma = b.gamma();
    const auto half = b.half_width();
    document["boundaries"].push_back(
        {{"side", side_name(b.side)},
         {"of", boundary_of(b)},
         {"onset", phase_name(b.onset)},
         {"n_l", b.n_l},
         {"gamma", gamma ? json(*gamma) : json(nullptr)},
         {"below", b.below ? json(*b.below) : json(nullptr)},
         {"above", b.above ? json(*b.above) : json(nullptr)},
         {"sweep", b.sweep},
         {"low", gamma && half ? json((*b.below + *b.above) / 2 - *half) : json(gamma.value_or(0))},
         {"high", gamma && half ? json((*b.below + *b.above) / 2 + *half) : json(gamma.value_or(0))}});
  }
  for (const SweepPoint& p : comparison.sweep)
    document["sweep"].push_back(
        {{"n_l", p.n_l}, {"gamma", p.gamma}, {"start", p.start}, {"phase", phase_name(p.phase)}});
  return json_script_text(document);
}

}  // namespace twincell::analysis
