// twincell import dump.lammpstrj: converts the output of another program to a trajectory.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>

#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/formats/lammps_dump.hpp"

namespace twincell::cli {

namespace {

struct ImportOptions {
  std::string dump, output;
  std::vector<double> origin;
  LammpsDumpOptions lammps;
};

void run(ImportOptions& o, const Common& common) {
  for (std::size_t k = 0; k < o.origin.size(); ++k) o.lammps.origin[static_cast<int>(k)] = o.origin[k];
  ProgressBar reading(common, "reading");
  const LammpsDump dump(o.dump, o.lammps, reading);
  TrajectoryInfo info = dump.info();
  Provenance provenance = common.provenance();
  provenance.inputs.emplace_back(o.dump);
  provenance.threads = 1;
  info.provenance_json = provenance.to_json();
  H5mdWriter writer(o.output, info);
  ProgressBar writing(common, "writing");
  dump.copy_to(writer, writing);
  writer.finish();
  if (!info.drive) note(common, "no drive was given: the phases and the height of the plate are absent.");
  print_result(common,
               {{"output", o.output},
                {"frames", dump.n_frames()},
                {"beads", info.n_beads},
                {"missing_beads", info.columns.identity}},
               fmt::format("{} frames of {} beads{}\n{}\n", dump.n_frames(), info.n_beads,
                           info.columns.identity ? ", not all of them in every frame" : "", o.output));
}

}  // namespace

void add_import(CLI::App& program, Common& common) {
  auto o = std::make_shared<ImportOptions>();
  CLI::App& verb =
      add_verb(program, common, "import",
               "Convert a text dump of LAMMPS to a trajectory. Writes the trajectory file, in units of the "
               "bead diameter and g.",
               "twincell import dump.lammpstrj -o lammps.h5 --timestep 4.44556610e-5 "
               "--drive-amplitude 1.5 --drive-omega 1 --frames-per-cycle 4");
  LammpsDumpOptions& l = o->lammps;
  verb.add_option("dump", o->dump, "Text dump of LAMMPS")->required();
  writes(common, verb,
         verb.add_option("-o,--output", o->output, "Trajectory file to write (H5MD)")->required(),
         Product::trajectory());
  verb.add_option("--dimension", l.dimension,
                  "Dimension of the dump; 2: the plane (x, y) with y upwards; 3: z upwards")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  verb.add_option("--timestep", l.timestep,
                  "Length of a step, in the time unit of the dump; required unless the dump contains ITEM: "
                  "TIME. All lengths and times below are in the units of the dump.");
  verb.add_option("--sigma", l.sigma, "Bead diameter, the unit of length of the trajectory")
      ->capture_default_str();
  verb.add_option("--gravity", l.gravity, "Acceleration of gravity g")->capture_default_str();
  verb.add_option(
          "--cell-origin", o->origin,
          "Lower left inside corner of the cell, with the plate at its mean height: x y [z]; default: 0")
      ->expected(2, 3);
  verb.add_option("--cell-width", l.width,
                  "Distance of the side walls; default: up to the end of the box of the dump");
  verb.add_option("--drive-amplitude", l.drive.amplitude,
                  "Amplitude A of the plate; without any drive option the drive is unknown");
  verb.add_option("--drive-omega", l.drive.omega, "Angular frequency omega = 2 pi f of the plate");
  former_option(verb, "--origin", "--cell-origin");
  former_option(verb, "--drive-frequency", "--drive-omega, with omega = 2 pi f");
  verb.add_option("--drive-gamma", l.drive.gamma, "Drive strength Gamma = A omega^2/g");
  verb.add_option(
          "--drive-axis", l.drive_axis,
          "Direction of the plate motion, in the axes of the trajectory (z upwards): x, y or z; default: z")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Axis>{{"x", Axis::x}, {"y", Axis::y}, {"z", Axis::z}}))
      ->option_text("AXIS");
  verb.add_option("--frames-per-cycle", l.phases_per_cycle,
                  "Frames per drive cycle; 0 (default): not phase-locked")
      ->check(CLI::Range(0, 1'000'000));
  verb.add_option(
          "--phase-of-step-zero", l.phase_of_step_zero,
          "Drive phase at step 0, as a fraction of a cycle; 0.75 for a wall that wiggles from step 0 on")
      ->capture_default_str();
  verb.add_option("--bead-mass", l.bead_mass,
                  "Bead mass m, the unit of the column mass; default: masses are not read");
  verb.add_option("--tracer-type", l.tracer_type, "Atom type that marks tracers; default: no tracers");
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
