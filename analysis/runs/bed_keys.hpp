#pragma once
/// \file
/// What the scene of a simulated run says of its beads, contacts and cell.

#include <map>
#include <string>

namespace twincell::analysis {

/// Keys and values, as text (numbers as short as possible), of the tables `[contact]`, `[beads]` and `[cell]`
/// of the scene that the provenance of a simulation contains (`config`). Left out are the number of beads and
/// the size of the cell, which trajectories state themselves. Empty for other provenance
std::map<std::string, std::string> bed_keys(const std::string& provenance_json);

/// All keys that determine the motion of such a run, the seed among them; left out are those that say which
/// part of it is recorded (cycles, discard, phases, contacts, springs). Two runs with the same keys are the
/// same run. Empty also for a start from a file, whose content the keys do not state
std::map<std::string, std::string> motion_keys(const std::string& provenance_json);

}  // namespace twincell::analysis
