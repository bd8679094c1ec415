// twincell info FILE: prints the content of a trajectory or a stack of frames.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>

#include "cli/output.hpp"
#include "cli/stack_info.hpp"
#include "cli/verb.hpp"
#include "core/json_text.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/time_unit.hpp"

namespace twincell::cli {

namespace {

struct InfoOptions {
  std::string file;
};

nlohmann::json describe(const H5mdReader& file) {
  const TrajectoryInfo& t = file.info();
  nlohmann::json d;
  d["file"] = file.name();
  d["source"] = word_of(t.source);
  d["frames"] = file.n_frames();
  d["beads"] = t.n_beads;
  d["columns"] = nlohmann::json::array({"position"});
  auto column = [&](bool present, const char* name) {
    if (present) d["columns"].push_back(name);
  };
  column(t.columns.velocity, "velocity");
  column(t.columns.spin, "spin");
  column(t.columns.identity, "identity");
  column(t.columns.phase, "drive phase and cycle");
  column(t.columns.plate_height, "plate height");
  column(t.columns.contact_forces, "contact forces");
  column(t.columns.contacts, "contact springs");
  column(!t.radius.empty(), "radius");
  column(!t.mass.empty(), "mass");
  column(!t.tracer.empty(), "tracer");
  const Vec3 size = t.box.size();
  d["box"] = {
      {"dimension", t.box.dimension},
      {"size", {size.x(), size.y(), size.z()}},
      {"boundary",
       {sides_word(t.box.boundary[0]), sides_word(t.box.boundary[1]), sides_word(t.box.boundary[2])}}};
  if (t.box.side_tilt != std::array<double, 2>{}) d["box"]["side_tilt"] = t.box.side_tilt;
  if (t.drive)
    d["drive"] = {{"amplitude", t.drive->amplitude},
                  {"omega", t.drive->omega},
                  {"gamma", t.drive->gamma()},
                  {"k_m", t.drive->k_m()},
                  {"displacement", t.drive->formula()}};
  if (t.drive && t.drive->ramp) {
    const Drive end =
        t.drive->at(t.drive->ramp->first + t.drive->ramp->cycles / (t.drive->ramp->returns ? 2 : 1));
    d["drive"]["ramp"] = {{"amplitude", end.amplitude},
                          {"omega", end.omega},
                          {"gamma", end.gamma()},
                          {"k_m", end.k_m()},
                          {"first_cycle", t.drive->ramp->first},
                          {"cycles", t.drive->ramp->cycles},
                          {"returns", t.drive->ramp->returns}};
  }
  if (t.phases_per_cycle > 0) d["phases_per_cycle"] = t.phases_per_cycle;
  if (t.scale.sigma_m) d["scale"]["sigma_m"] = *t.scale.sigma_m;
  if (t.scale.gravity_m_s2) d["scale"]["gravity_m_s2"] = *t.scale.gravity_m_s2;
  if (t.scale.pixels_per_sigma) d["scale"]["pixels_per_sigma"] = *t.scale.pixels_per_sigma;
  Frame frame;
  std::size_t fewest = t.n_beads, most = 0;
  for (std::size_t f = 0; f < file.n_frames(); ++f) {
    file.read(f, frame);
    if (f == 0) d["first"] = {{"step", frame.step}, {"time", frame.time}};
    d["last"] = {{"step", frame.step}, {"time", frame.time}, {"cycle", frame.cycle}};
    fewest = std::min(fewest, frame.n_present());
    most = std::max(most, frame.n_present());
  }
  d["time_unit"] = time_is_frame_number(t) ? "frame" : "t0";
  d["beads_per_frame"] = {{"fewest", file.n_frames() > 0 ? fewest : 0}, {"most", most}};
  d["provenance"] = nlohmann::json();
  if (!t.provenance_json.empty()) {
    auto provenance = nlohmann::json::parse(t.provenance_json, nullptr, false);
    if (provenance.is_object())
      d["provenance"] = std::move(provenance);
    else
      d["damaged"] = nlohmann::json::array({"provenance"});
  }
  return d;
}

std::string as_text(const nlohmann::json& d) {
  std::string s =
      fmt::format("{}\n  source      {}\n  frames      {}\n  beads       {} ({} to {} in a frame)\n",
                  d["file"].get<std::string>(), d["source"].get<std::string>(), d["frames"].get<long>(),
                  d["beads"].get<long>(), d["beads_per_frame"]["fewest"].get<long>(),
                  d["beads_per_frame"]["most"].get<long>());
  std::string columns;
  for (const auto& c : d["columns"]) columns += (columns.empty() ? "" : ", ") + c.get<std::string>();
  s += "  columns     " + columns + "\n";
  const auto& box = d["box"];
  s += fmt::format("  box         {}D, x {:g} ({}), y {:g} ({}), z {:g} ({}) sigma\n",
                   box["dimension"].get<int>(), box["size"][0].get<double>(),
                   box["boundary"][0].get<std::string>(), box["size"][1].get<double>(),
                   box["boundary"][1].get<std::string>(), box["size"][2].get<double>(),
                   box["boundary"][2].get<std::string>());
  if (box.contains("side_tilt"))
    s += fmt::format("  side walls  lean outward by {:g} and {:g} degrees\n",
                     box["side_tilt"][0].get<double>(), box["side_tilt"][1].get<double>());
  if (d.contains("first"))
    s += fmt::format("  time        {:.6g} to {:.6g} {}, steps {} to {}\n", d["first"]["time"].get<double>(),
                     d["last"]["time"].get<double>(),
                     d["time_unit"] == "frame" ? "(number of the frame)" : d["time_unit"].get<std::string>(),
                     d["first"]["step"].get<long>(), d["last"]["step"].get<long>());
  if (d.contains("drive"))
    s += fmt::format("  drive       {}, A = {:.6g} sigma, omega = {:.6g}/t0, Gamma = {:.6g}, K_m = {:.6g}\n",
                     d["drive"]["displacement"].get<std::string>(), d["drive"]["amplitude"].get<double>(),
                     d["drive"]["omega"].get<double>(), d["drive"]["gamma"].get<double>(),
                     d["drive"]["k_m"].get<double>());
  if (d.contains("drive") && d["drive"].contains("ramp"))
    s +=
        fmt::format("  ramp        to A = {:.6g} sigma, omega = {:.6g}/t0, Gamma = {:.6g} {}in {:g} cycles\n",
                    d["drive"]["ramp"]["amplitude"].get<double>(), d["drive"]["ramp"]["omega"].get<double>(),
                    d["drive"]["ramp"]["gamma"].get<double>(),
                    d["drive"]["ramp"]["returns"].get<bool>() ? "and back " : "",
                    d["drive"]["ramp"]["cycles"].get<double>());
  s += d.contains("phases_per_cycle")
           ? fmt::format("  phases      {} per cycle\n", d["phases_per_cycle"].get<int>())
           : "  phases      not phase-locked\n";
  s += "  scale       " + (d.contains("scale") ? json_text(d["scale"]) : std::string("absent")) + "\n";
  if (d.contains("damaged")) s += "  made by     unknown: the provenance is damaged\n";
  if (d["provenance"].is_object() && d["provenance"].contains("command_line") &&
      d["provenance"]["command_line"].is_string())
    s += "  made by     " + d["provenance"]["command_line"].get<std::string>() + "\n";
  return s;
}

}  // namespace

void add_info(CLI::App& program, Common& common) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App& verb = add_verb(program, common, "info",
                            "Print the content of a trajectory or a stack of frames: size, times, drive, "
                            "scale, grey values and origin.",
                            "twincell info sim.h5\n  twincell info frames/");
  verb.add_option("file", options->file,
                  "Trajectory (H5MD), or a stack: folder of pictures, TIFF, camera file, HDF5 stack or video "
                  "(docs/frames.md)")
      ->required();
  verb.callback([options, &common] {
    if (is_trajectory(options->file)) {
      const H5mdReader file(options->file);
      const nlohmann::json document = describe(file);
      print_result(common, document, as_text(document));
    } else {
      const nlohmann::json document = describe_stack(options->file);
      print_result(common, document, stack_as_text(document));
    }
  });
}

}  // namespace twincell::cli
