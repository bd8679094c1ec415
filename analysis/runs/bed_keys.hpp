#pragma once
/// \file
/// The keys of the scene of a simulated run that describe its beads, contacts and cell.

#include <map>
#include <string>

namespace twincell::analysis {

/// Keys and values, as text (numbers as short as possible), of the tables `[contact]`, `[beads]` and `[cell]`
/// of the scene that the provenance of a simulation contains (`config`). The number of beads and the size of
/// the cell are left out, because trajectories state them. Empty for provenance without a scene.
std::map<std::string, std::string> bed_keys(const std::string& provenance_json);

/// All keys that determine the bed and its motion, including the seed. The tables `[time]` and `[until]` are
/// left out, because they state how the run is computed and which part of it is recorded. Two runs with the
/// same keys begin with the same bed and are not independent. Empty also for a start from a file, because the
/// keys do not state its content.
std::map<std::string, std::string> motion_keys(const std::string& provenance_json);

}  // namespace twincell::analysis
