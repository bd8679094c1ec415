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

/// All keys that determine the bed and its motion, the seed among them; left out are the tables `[time]` and
/// `[until]`, which say how the run is computed and which part of it is recorded. Two runs with the same keys
/// begin with the same bed and are not independent. Empty also for a start from a file, whose content the
/// keys do not state
std::map<std::string, std::string> motion_keys(const std::string& provenance_json);

}  // namespace twincell::analysis
