// Options over all verbs: one quantity has one option. A former option is refused with the present one.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/program.hpp"

namespace twincell::options_test {
namespace {

/// Every option of the program without its unit suffix, and its quantity. A new option gets a row here; if
/// its quantity is in the list already, the option has the name that stands there.
const std::map<std::string, std::string> kQuantities = {
    {"accelerometer", "measurement of an accelerometer"},
    {"accuracy", "requested accuracy"},
    {"all", "all figures and tables"},
    {"background", "picture of the cell without beads"},
    {"backlight", "grey level of the light"},
    {"bead", "index of a bead"},
    {"bead-mass", "mass of a bead in the dump"},
    {"bits", "bit depth"},
    {"black-level", "grey level without light"},
    {"blur", "blur of the optics, px"},
    {"both-starts", "second run from a boiling bed"},
    {"bright", "beads brighter than the background"},
    {"budget", "time limit, minutes"},
    {"camera", "file of the synthetic camera"},
    {"candidates", "table of the candidates"},
    {"cell", "file of the cell"},
    {"cell-height", "height of the cell"},
    {"cell-origin", "corner of the cell in the dump"},
    {"cell-radius", "radius of Voronoi cells"},
    {"cell-width", "width of the cell"},
    {"checkpoint-every", "time between checkpoints"},
    {"colour", "number that the colour of a bead shows"},
    {"colour-range", "ends of the colour map"},
    {"columns", "names of the columns of a table"},
    {"complete", "beads that are in all frames"},
    {"contact-time", "contact time"},
    {"contacts", "contacts of every frame"},
    {"csv", "table of tracks"},
    {"cutoff", "largest distance of neighbours"},
    {"cycles", "number of cycles"},
    {"dark", "beads darker than the background"},
    {"data", "own points"},
    {"debug-dir", "pictures of the stages"},
    {"device", "machine that runs the beds"},
    {"diameter", "diameter of the beads, px"},
    {"dimension", "dimension of the dump"},
    {"discard", "cycles skipped at the start"},
    {"distortion", "radial distortion"},
    {"double", "probability of a doubled frame"},
    {"drive-amplitude", "amplitude of the drive"},
    {"drive-axis", "axis of the drive"},
    {"drive-gamma", "strength of the drive"},
    {"drive-hz", "frequency of the drive, Hz"},
    {"drive-omega", "angular frequency of the drive, unit of the data"},
    {"drive-phase", "phase of the drive at time 0"},
    {"drop", "probability of a lost frame"},
    {"dust", "specks on the glass"},
    {"electrons-per-level", "electrons per grey level"},
    {"experiment", "trajectories of experiments"},
    {"explain", "whether the choice of the settings is printed"},
    {"exposure", "exposure time"},
    {"field-cell", "cells of displacement averages"},
    {"figures", "folder of figures"},
    {"first-phase", "phase of the first frame"},
    {"flat", "flat field"},
    {"focal-px", "focal length, px"},
    {"folder", "folder of a sweep"},
    {"force", "replace outputs of another kind"},
    {"format", "format of an imported file"},
    {"fps", "playback rate of a film"},
    {"frame", "index of a frame"},
    {"frame-rate-hz", "frame rate of the camera, Hz"},
    {"frames", "frames that are read or drawn"},
    {"frames-per-cycle", "frames per drive cycle"},
    {"from", "trajectory of the scene"},
    {"full", "no time limit"},
    {"gamma-n", "damping rate"},
    {"glare", "level of a bright spot"},
    {"glare-kind", "position of a bright spot"},
    {"glare-share", "share of beads with a bright spot"},
    {"gravity", "acceleration of gravity"},
    {"help", "help"},
    {"jobs", "number of shards"},
    {"json", "result as JSON"},
    {"k-n", "stiffness"},
    {"keep-trajectories", "store trajectories of points"},
    {"lamp-drift", "change of the light over the film"},
    {"lamp-flicker", "change of the light between frames"},
    {"law", "law to fit"},
    {"least-speed", "smallest speed of approach"},
    {"left-tilt", "tilt of the left wall"},
    {"locator", "finder of candidates"},
    {"m-eff", "effective mass"},
    {"margin", "width of the wall shown, px"},
    {"markdown", "print tables in Markdown"},
    {"mask", "picture of the part that is searched"},
    {"max-height", "height shown"},
    {"memory", "frames for which a bead may be missing"},
    {"min-explained", "smallest score of a bead"},
    {"min-score", "visible share of an edge"},
    {"movie", "film to write"},
    {"mpi", "ranks of an MPI job"},
    {"neighbours", "definition of neighbours"},
    {"no-drag", "drag of the air"},
    {"no-film", "no virtual experiment"},
    {"observables", "observables that are matched"},
    {"only", "results to compute"},
    {"onset", "measured onset"},
    {"origin-px", "corner of the cell in the frame, px"},
    {"output", "output of the verb"},
    {"over", "axes of a plot"},
    {"overlay", "frame with marked beads"},
    {"phase-lock", "source of the phases"},
    {"phase-of-step-zero", "phase of an import's first step"},
    {"phases", "list of phases to write"},
    {"picture-size", "size of the frames of a table, px"},
    {"pixels-per-sigma", "scale of the camera"},
    {"profile", "where the time went"},
    {"quick", "fewer settings"},
    {"quiet", "no progress"},
    {"range", "search range of the linker"},
    {"read-noise", "read noise, grey levels"},
    {"refine", "refiner"},
    {"relax", "push overlaps apart"},
    {"rest-height", "height of the bed at rest"},
    {"restitution", "coefficient of restitution"},
    {"result", "result of a plot"},
    {"resume", "continue a run"},
    {"right-tilt", "tilt of the right wall"},
    {"roi", "part of the picture that is searched"},
    {"rotation", "rotation of the frame"},
    {"runs", "number of simulations, or folder of shared runs"},
    {"s-b", "form of s_b"},
    {"sampled-frames", "number of frames that are evaluated"},
    {"scene", "scene file"},
    {"scored-rows", "rows that are scored, px"},
    {"scratches", "scratches on the glass"},
    {"seed", "seed of random numbers"},
    {"set", "key of a file"},
    {"shape", "shape of the beads"},
    {"shard", "share of a sweep"},
    {"shortest", "shortest track"},
    {"sigma", "diameter in an import, or column of errors"},
    {"simulation", "trajectories of simulations"},
    {"source", "origin of imported beads"},
    {"stack", "stacks of experiments"},
    {"stored", "results of an earlier call"},
    {"sweep", "collected results of sweeps"},
    {"table", "table of windows"},
    {"target", "picture of a calibration target"},
    {"target-grid", "points of the target"},
    {"target-kind", "kind of the target"},
    {"target-spacing", "spacing of the target"},
    {"threads", "number of threads"},
    {"timestep", "length of a step of an import"},
    {"to", "format of an export"},
    {"tolerance", "tolerance of Gamma"},
    {"tracer-band", "heights of tracers"},
    {"tracer-darkness", "darkness of a tracer"},
    {"tracer-type", "atom type of tracers"},
    {"tracers", "identities of tracers"},
    {"tracks", "frames over which paths are drawn"},
    {"trials", "column of the number of trials"},
    {"trigger-jitter", "scatter of the trigger time"},
    {"trigger-offset", "delay of the trigger time"},
    {"trust-stated-cell", "no check of the stated walls and origin"},
    {"trust-stated-drive", "no check of the stated drive"},
    {"truth", "ground truth"},
    {"twins", "number of twins"},
    {"units", "units of an export"},
    {"vary", "parameter to infer"},
    {"version", "version"},
    {"vignetting", "loss of light in the corners"},
    {"vectors", "velocities as arrows"},
    {"verbose", "print every detail"},
    {"view", "page of the located frames"},
    {"window", "window of the abscissa"},
    {"window-cycles", "cycles of a window"},
    {"x", "column of the abscissa"},
    {"y", "column of the ordinate"},
    {"y-up", "direction of y in a table"},
};

/// Endings of options that exist in several units, as the keys of scenes and cells do.
constexpr const char* kUnits[] = {"-mm", "-m-s2", "-sigma", "-us", "-t0"};

std::string help_of(std::vector<std::string> words) {
  words.emplace_back("--help");
  const Ran ran = run_program(words);
  EXPECT_EQ(ran.code, 0) << ran.err;
  return ran.out;
}

/// Adds the long options in the help of this verb and of the verbs below it.
void walk(const std::vector<std::string>& verb, std::set<std::string>& options) {
  const std::string help = help_of(verb), below = "\nSubcommands:\n";
  const std::size_t list = help.find(below);
  const std::string head = help.substr(0, list);
  static const std::regex line(R"(\n  ((?:-\w,)?--[a-z][^\s]*))"), name(R"(--([a-z][a-z0-9-]*))");
  for (std::sregex_iterator l(head.begin(), head.end(), line), end; l != end; ++l) {
    const std::string names = (*l)[1];
    for (std::sregex_iterator n(names.begin(), names.end(), name); n != end; ++n) options.insert((*n)[1]);
  }
  if (list == std::string::npos) return;
  const std::size_t begin = list + below.size();
  const std::string verbs = help.substr(begin, help.find("\n\n", begin) - begin);
  static const std::regex entry(R"((?:^|\n)  ([a-z]+)\s)");
  for (std::sregex_iterator v(verbs.begin(), verbs.end(), entry), end; v != end; ++v) {
    std::vector<std::string> deeper = verb;
    deeper.push_back((*v)[1]);
    walk(deeper, options);
  }
}

/// The option without the suffix of a unit, if the program has it in several units.
std::string without_unit(const std::string& option, const std::set<std::string>& options) {
  for (const std::string unit : kUnits)
    if (option.ends_with(unit))
      if (const std::string stem = option.substr(0, option.size() - unit.size()); options.contains(stem))
        return stem;
  return option;
}

TEST(Options, OneQuantityHasOneOptionOverAllVerbs) {
  std::set<std::string> options;
  walk({}, options);
  EXPECT_GT(options.size(), 100U) << "the help is not understood";
  std::map<std::string, std::string> option_of;
  std::set<std::string> seen;
  for (const std::string& option : options) {
    const std::string stem = without_unit(option, options);
    seen.insert(stem);
    const auto row = kQuantities.find(stem);
    if (row == kQuantities.end()) {
      ADD_FAILURE() << "--" << option << " has no row in the list of quantities";
      continue;
    }
    const auto [known, is_new] = option_of.emplace(row->second, stem);
    EXPECT_TRUE(is_new || known->second == stem)
        << "--" << stem << " and --" << known->second << " are both the " << row->second;
  }
  for (const auto& [option, quantity] : kQuantities)
    EXPECT_TRUE(seen.contains(option)) << "no verb has --" << option;
}

TEST(Options, AFormerOptionIsRefusedWithThePresentOne) {
  const struct {
    std::vector<std::string> words;
    std::string says;
  } former[] = {
      {{"calibrate", "contacts", "bounce", "b.csv", "--amplitude", "1"},
       "--amplitude: is a former option; write --drive-amplitude."},
      {{"calibrate", "contacts", "bounce", "b.csv", "--omega", "1"}, "write --drive-omega."},
      {{"calibrate", "contacts", "bounce", "b.csv", "--phase=1"}, "write --drive-phase."},
      {{"calibrate", "plate", "frames", "--fps", "500"}, "write --frame-rate-hz."},
      {{"calibrate", "camera", "frames", "--frames", "8"}, "write --sampled-frames."},
      {{"calibrate", "beads", "frames", "--frames", "8"}, "write --sampled-frames."},
      {{"import", "d.txt", "-o", "t.h5", "--drive-frequency", "1"},
       "write --drive-omega, with omega = 2 pi f."},
      {{"import", "d.txt", "-o", "t.h5", "--origin", "0", "0"}, "write --cell-origin."},
      {{"locate", "frames", "--overlay-frame", "3"}, "write --frame."},
      {{"compare", "--simulation", "a.h5", "--frames", "f"}, "write --stack."},
      {{"sweep", "run", "plan.toml", "-o", "folder"}, "write --folder."},
      {{"sweep", "plan", "plan.toml", "--output", "folder"}, "write --folder."},
      {{"sweep", "status", "plan.toml", "-o", "folder"}, "write --folder."},
      {{"sweep", "template", "slurm", "plan.toml", "-o", "folder"}, "write --folder."},
      {{"sweep", "plot", "plan.toml", "--result", "q6", "-o", "p.png"}, "write --figures."},
  };
  for (const auto& f : former) {
    const Ran ran = run_program(f.words);
    EXPECT_EQ(ran.code, 2) << f.words[0];
    EXPECT_NE(ran.err.find(f.says), std::string::npos) << "wanted: " << f.says << "\nsaid:   " << ran.err;
  }
}

// --help after a word that is no verb of its group must not show the help of the group.
TEST(Options, AMisplacedVerbIsRefusedWithItsPlace) {
  const std::pair<std::vector<std::string>, std::string> wrong[] = {
      {{"calibrate", "infer", "--help"},
       "there is no verb 'calibrate infer'; did you mean 'calibrate contacts infer'?"},
      {{"calibrate", "contacts", "bouce", "--help"}, "did you mean 'calibrate contacts bounce'?"},
      {{"sweep", "runs"}, "did you mean 'sweep run'?"},
      {{"trak", "--help"}, "there is no verb 'trak'; did you mean 'track'?"},
      {{"sweep", "zzzzzzzz"}, "there is no verb 'sweep zzzzzzzz'; sweep has plan, run, "}};
  for (const auto& [words, says] : wrong) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 2);
    EXPECT_NE(ran.err.find(says), std::string::npos) << "wanted: " << says << "\nsaid:   " << ran.err;
  }
  EXPECT_NE(help_of({"calibrate", "contacts", "infer"}).find("--vary"), std::string::npos);
}

}  // namespace
}  // namespace twincell::options_test
