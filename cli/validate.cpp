// twincell validate FILE: checks that a trajectory file is complete and conforms to H5MD.

#include <CLI/CLI.hpp>
#include <limits>
#include <memory>

#include "cli/output.hpp"
#include "cli/verb.hpp"
#include "core/error.hpp"
#include "core/plural.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/trajectory_doubts.hpp"

namespace twincell::cli {

namespace {
struct ValidateOptions {
  std::string file;
};
}  // namespace

void add_validate(CLI::App& program, Common& common) {
  auto options = std::make_shared<ValidateOptions>();
  CLI::App& verb = add_verb(program, common, "validate",
                            "Check that a trajectory file is complete and conforms to H5MD 1.1. Prints every "
                            "fault, and ends with exit code 3 if there is one. Notes numbers that contradict "
                            "each other, such as velocities that the beads do not move with.",
                            "twincell validate sim.h5");
  verb.add_option("file", options->file, "Trajectory file (H5MD)")->required();
  verb.callback([options, &common] {
    const auto faults = validate_h5md(options->file);
    std::string text =
        faults.empty() ? options->file + ": conforms to H5MD 1.1, every frame is readable.\n" : "";
    for (const auto& fault : faults) text += options->file + ": " + fault + "\n";
    std::vector<std::string> doubts;
    if (faults.empty())
      doubts = doubts_of(H5mdReader(options->file), std::numeric_limits<std::size_t>::max());
    for (const auto& doubt : doubts) note(common, options->file + ": " + doubt + ".");
    print_result(
        common,
        {{"file", options->file}, {"conforms", faults.empty()}, {"faults", faults}, {"doubts", doubts}},
        text);
    if (!faults.empty())
      throw InputError({options->file, 0, 0, ""}, plural(faults.size(), "fault") + " found.");
  });
}

}  // namespace twincell::cli
