// `match` as a user runs it, on frames that the synthetic camera took of a bed that is shipped with its true
// positions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/atomic_file.hpp"
#include "imaging/codecs/codecs.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/rigid_bed.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "twin/twin.hpp"

namespace twincell::match_test {
namespace {

namespace fs = std::filesystem;

const fs::path kStack = fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/gamma-0.9";

/// The first cycle of the shipped stack, for speed.
fs::path short_stack(const TemporaryFolder& folder) {
  fs::path stack = folder.path() / "frames";
  fs::create_directory(stack);
  for (int f = 0; f < 20; ++f) {
    const std::string name = "frame_000" + std::string(f < 10 ? "0" : "") + std::to_string(f) + ".png";
    fs::copy_file(kStack / name, stack / name);
  }
  return stack;
}

/// CELL.toml of the shipped stack without the lines that begin with `key` or `other`.
fs::path cell_without(const TemporaryFolder& folder, const std::string& key,
                      const std::string& other = "[none]") {
  std::ifstream in(kStack / "CELL.toml");
  fs::path path = folder.path() / ("without_" + key + ".toml");
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key, 0) != 0 && line.rfind(other, 0) != 0) out << line << "\n";
  return path;
}

/// Films a simulated bed from so high that the plate is never in the image. \return the folder of the frames,
/// with a correct CELL.toml
fs::path film_above_plate(const TemporaryFolder& folder, double gamma, int seed) {
  const fs::path run = folder / "run.h5", stack = folder / "above";
  EXPECT_EQ(
      run_program({"simulate", fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/experiment.toml", "-q",
                   "-o", run, "--set", "drive.gamma=" + std::to_string(gamma), "--set",
                   "start.seed=" + std::to_string(seed), "--set", "time.discard=2", "--set", "time.cycles=6"})
          .code,
      0);
  EXPECT_EQ(run_program({"render", run, "-q", "-o", stack, "--pixels-per-sigma", "12", "--margin", "20",
                         "--max-height", "22"})
                .code,
            0);
  const double plate_px = imaging::read_cell(stack / "CELL.toml").origin->y_px;
  for (const auto& entry : fs::directory_iterator(stack))
    if (entry.path().extension() == ".png") {
      const cv::Mat all = read_picture(entry.path());
      const int rows = static_cast<int>(plate_px - 12 * (gamma + 0.3));
      write_picture(entry.path(), all.rowRange(0, rows));
    }
  return stack;
}

/// CELL.toml of a stack with another line for the amplitude.
fs::path with_amplitude(const fs::path& stack, const std::string& line_of_amplitude) {
  std::ifstream in(stack / "CELL.toml");
  fs::path path = stack / "misstated.toml";
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);)
    out << (line.rfind("amplitude", 0) == 0 ? line_of_amplitude : line) << "\n";
  return path;
}

/// Drives of a cell in laboratory units, for a film with A = 0.9 sigma and omega = 1/t0, of beads of 2 mm: t0
/// = sqrt(2 mm / 9.81 m/s^2) = 14.28 ms, so that f = 1/(2 pi t0) = 11.15 Hz.
const double kT0_s = std::sqrt(0.002 / 9.81), kHertz = 1 / (2 * std::acos(-1.0) * kT0_s);
struct StatedDrive {
  std::string lines;     ///< of the table [drive]
  std::string disagree;  ///< what is said of it; empty: it agrees
};
std::vector<StatedDrive> stated_drives() {
  const auto drive = [](const std::string& amplitude, const char* key, double value) {
    return amplitude + "\n" + key + " = " + fmt::format("{:.12g}", value) + "\n";
  };
  const std::string a = "amplitude_sigma = 0.9";
  return {{drive(a, "frequency_hz", kHertz), ""},
          {drive("amplitude_mm = 1.8", "omega_rad_s", 1 / kT0_s), ""},
          {drive(a, "frequency_hz", 1.02 * kHertz), ""},
          {drive(a, "frequency_hz", 1.06 * kHertz), "states 1.06"},
          {drive(a, "frequency_hz", 2 * kHertz), "states 2"},
          {drive(a, "frequency_hz", kHertz / 2), "states 0.5"},
          {drive(a, "frequency_per_t0", kHertz), "states 70.04"},                   // hertz, but per t0
          {drive(a, "frequency_hz", 1 / (2 * std::acos(-1.0))), "states 0.01428"},  // per t0, but hertz
          {drive(a, "omega_rad_s", kHertz), "states 0.1592, 1/(2 pi) of it, as from Hz taken for rad/s"},
          {drive("amplitude_mm = 0.9", "frequency_hz", kHertz), "A = "}};  // sigma, but millimetres
}

/// CELL.toml of a stack in laboratory units, with the frame rate and another drive.
fs::path laboratory_cell(const fs::path& stack, const fs::path& path, const std::string& drive) {
  std::ifstream in(stack / "CELL.toml");
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("amplitude", 0) == 0 || line.rfind("omega", 0) == 0) continue;
    if (line.rfind("width", 0) == 0) line.replace(0, 5, "width_sigma");
    if (line.rfind("height", 0) == 0) line.replace(0, 6, "height_sigma");
    out << line << "\n";
    if (line == "[camera]") out << "frame_rate_hz = " << fmt::format("{:.12g}", 20 * kHertz) << "\n";
    if (line == "[drive]") out << drive;
  }
  out << "[scale]\nsigma_mm = 2.0\ngravity_m_s2 = 9.81\n";
  return path;
}

/// `track` reports that a drive does not fit the film, and keeps it; `compare` and `match` refuse it.
void expect_the_drive_checked(const fs::path& stack, const StatedDrive& stated, const std::string& by) {
  SCOPED_TRACE(by + ": " + stated.lines);
  const TemporaryFolder folder;
  const fs::path cell = laboratory_cell(stack, folder / "cell.toml", stated.lines);
  const Ran tracked = run_program({"track", stack, "--cell", cell, "-o", folder / "kept.h5"});
  ASSERT_EQ(tracked.code, 0) << tracked.err;
  const Ran compared = run_program(
      {"compare", "--experiment", folder / "kept.h5", "-o", folder / "report", "-q", "--no-film"});
  if (stated.disagree.empty()) {
    EXPECT_EQ(tracked.err.find("does not fit the film"), std::string::npos) << tracked.err;
    EXPECT_EQ(compared.code, 0) << compared.err;
    return;
  }
  const Ran matched = run_program({"match", stack, cell, "-o", folder / "twin", "--twins", "1", "--no-film",
                                   "--set", "time.steps_per_contact=20", "-q"});
  EXPECT_NE(tracked.err.find("does not fit the film"), std::string::npos) << tracked.err;
  EXPECT_EQ(compared.code, 2) << compared.err;
  EXPECT_EQ(matched.code, 2) << matched.err;
  EXPECT_FALSE(fs::exists(folder / "report"));
  EXPECT_FALSE(fs::exists(folder / "twin/experiment.h5"));
  for (const std::string& said : {tracked.err, compared.err, matched.err}) {
    EXPECT_NE(said.find(by), std::string::npos) << said;
    EXPECT_NE(said.find(stated.disagree), std::string::npos) << said;
    EXPECT_NE(said.find("--trust-stated-drive"), std::string::npos) << said;
    if (const auto omega = said.find("omega = "); stated.disagree != "A = ") {
      ASSERT_NE(omega, std::string::npos) << said;
      EXPECT_NEAR(std::stod(said.substr(omega + 8)), 1, 0.01) << said;
    }
  }
}
}  // namespace

TEST(Match, GivesTheTwinOfAFilmedCell) {
  const TemporaryFolder folder;
  const fs::path stack = short_stack(folder);
  const Ran ran = run_program({"match", stack, kStack / "CELL.toml", "-o", folder / "twin", "--twins", "2",
                               "--set", "time.steps_per_contact=20", "-q", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto d = nlohmann::json::parse(ran.out);
  // SOURCE.md: 100 beads of 12 px; truth.csv: located to a hundredth of a bead.
  EXPECT_EQ(d["beads"], 100);
  EXPECT_EQ(d["pixels_per_sigma"], 12);
  EXPECT_EQ(d["cycles"], 1);
  EXPECT_GT(d["position_error"].get<double>(), 1e-5);
  EXPECT_LT(d["position_error"].get<double>(), 0.01);
  // The film begins with the bed at rest.
  EXPECT_LT(std::abs(d["settling_fall"].get<double>()), 0.01);
  EXPECT_EQ(ran.err.find("mid-motion"), std::string::npos) << ran.err;
  EXPECT_EQ(names_in(folder / "twin"),
            (std::vector<std::string>{"experiment.h5", "report", "scene.toml", "simulation-1.h5",
                                      "simulation-2.h5", "twincell-manifest.json"}));
  EXPECT_EQ(d["matches"][0]["experiments"].size(), 1U);
  EXPECT_EQ(d["matches"][0]["simulations"].size(), 2U);

  // Experiment and twins have the same cell. The first twin starts at the observed bead positions, up to the
  // displacement of settling.
  const H5mdReader experiment(folder / "twin/experiment.h5"), one(folder / "twin/simulation-1.h5"),
      two(folder / "twin/simulation-2.h5");
  EXPECT_NEAR(one.info().drive->gamma(), 0.9, 1e-12);
  EXPECT_EQ(one.info().phases_per_cycle, experiment.info().phases_per_cycle);
  EXPECT_EQ(one.n_frames(), experiment.n_frames());
  EXPECT_DOUBLE_EQ(one.info().box.size().x(), 10);
  Frame seen, begun, shifted;
  experiment.read(0, seen);
  one.read(0, begun);
  two.read(0, shifted);
  double farthest = 0;
  int shifted_beads = 0, far_away = 0;
  for (std::size_t i = 0; i < begun.position.size(); ++i) {
    double nearest = INFINITY;
    for (std::size_t k = 0; k < seen.position.size(); ++k)
      if (seen.present(k))
        nearest = std::min(nearest, std::hypot(seen.position[k].x() - begun.position[i].x(),
                                               seen.position[k].z() - begun.position[i].z()));
    farthest = std::max(farthest, nearest);
    const double apart = (begun.position[i] - shifted.position[i]).norm();
    shifted_beads += apart > 0 ? 1 : 0;
    far_away += apart > 0.1 ? 1 : 0;
  }
  EXPECT_LT(farthest, 0.1);
  EXPECT_EQ(shifted_beads, 100) << "the second twin begins a little elsewhere";
  EXPECT_LT(far_away, 5) << "but only beads that nothing holds settle far away";

  // The scene contains what --set changed, runs on its own and reproduces the first twin bit for bit.
  const Ran again = run_program({"simulate", folder / "twin/scene.toml", "-q", "-o", folder / "again.h5"});
  ASSERT_EQ(again.code, 0) << again.err;
  const H5mdReader repeated(folder / "again.h5");
  Frame last_of_one, last_of_again;
  one.read(one.n_frames() - 1, last_of_one);
  repeated.read(repeated.n_frames() - 1, last_of_again);
  for (std::size_t i = 0; i < last_of_one.position.size(); ++i)
    EXPECT_EQ(last_of_one.position[i], last_of_again.position[i]) << i;

  // A trajectory that somebody put in the place of a twin stays; the untouched match is replaced.
  fs::rename(folder / "twin/simulation-2.h5", folder / "mine.h5");
  fs::copy_file(folder / "again.h5", folder / "twin/simulation-2.h5");
  const std::vector<std::string> match_again = {
      "match",     stack,   kStack / "CELL.toml",        "-o",    folder / "twin", "--twins", "2",
      "--no-film", "--set", "time.steps_per_contact=20", "--set", "time.cycles=2", "-q",      "--json"};
  const Ran refused = run_program(match_again);
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_NE(refused.err.find("'simulation-2.h5' in it has changed"), std::string::npos) << refused.err;
  EXPECT_EQ(bytes_of(folder / "twin/simulation-2.h5"), bytes_of(folder / "again.h5"));
  fs::rename(folder / "mine.h5", folder / "twin/simulation-2.h5");
  const Ran replaced = run_program(match_again);
  ASSERT_EQ(replaced.code, 0) << replaced.err;
  EXPECT_EQ(nlohmann::json::parse(replaced.out)["cycles"], 2) << "of --set, not of the film";
}

// The shipped stack was rendered with A = 0.9 sigma (SOURCE.md), 20 frames a cycle, the first at phase 0.
TEST(Match, AFilmThatBeginsInMidMotionIsNoted) {
  const TemporaryFolder folder;
  const fs::path six = fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/six-layers";
  const auto match = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"match",
                                      six / "gamma-2.8.tif",
                                      six / "gamma-2.8.toml",
                                      "--frames",
                                      "0:40",
                                      "--twins",
                                      "1",
                                      "--no-film",
                                      "--json",
                                      "--set",
                                      "time.steps_per_contact=20",
                                      "-o",
                                      folder / name};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    // Six layers settle at a mean height of about 3 sigma; thrown, they are about twice as high.
    EXPECT_GT(nlohmann::json::parse(ran.out)["settling_fall"].get<double>(), 1);
    EXPECT_LT(nlohmann::json::parse(ran.out)["settling_fall"].get<double>(), 5);
    return ran.err;
  };
  EXPECT_NE(match("from-rest", {}).find("begins in mid-motion"), std::string::npos);
  EXPECT_EQ(match("steady", {"--set", "time.discard=1"}).find("mid-motion"), std::string::npos);
}

TEST(Match, MeasuresTheDriveThatTheCellDoesNotState) {
  const TemporaryFolder folder;
  const fs::path cell = cell_without(folder, "amplitude", "frames_per_cycle");
  const Ran ran = run_program({"match", kStack, cell, "-o", folder / "twin", "--twins", "1", "--no-film",
                               "--set", "time.steps_per_contact=20", "-q", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const std::string drive = nlohmann::json::parse(ran.out)["drive"];
  EXPECT_NE(drive.find("A = "), std::string::npos) << drive;
  EXPECT_NE(drive.find("20 frames per cycle"), std::string::npos) << drive;
  const H5mdReader experiment(folder / "twin/experiment.h5"), twin(folder / "twin/simulation-1.h5");
  EXPECT_NEAR(twin.info().drive->amplitude, 0.9, 0.002);  // a fortieth of a pixel
  EXPECT_EQ(twin.info().drive->omega, 1);
  EXPECT_EQ(experiment.info().drive->amplitude, twin.info().drive->amplitude);
  EXPECT_EQ(experiment.info().phases_per_cycle, 20);
  Frame first;
  experiment.read(0, first);
  EXPECT_EQ(first.phase, 0);
}

TEST(Match, StatedDriveIsCheckedAgainstThePlate) {
  const TemporaryFolder folder;
  std::ifstream in(kStack / "CELL.toml");
  const fs::path cell = folder / "wrong.toml";
  {
    std::ofstream out(cell);
    for (std::string line; std::getline(in, line);)  // the plate in the film moves 1.6 times as far
      out << (line.rfind("amplitude", 0) == 0 ? "amplitude = 0.5625" : line) << "\n";
  }
  std::vector<std::string> words = {"match",   kStack, cell,        "-o",    folder / "twin",
                                    "--twins", "1",    "--no-film", "--set", "time.steps_per_contact=20",
                                    "-q"};
  const Ran refused = run_program(words);
  EXPECT_EQ(refused.code, 2);
  const auto seen = refused.err.find("A = ");
  ASSERT_NE(seen, std::string::npos) << refused.err;
  EXPECT_NEAR(std::stod(refused.err.substr(seen + 4)), 0.9, 0.002) << refused.err;
  EXPECT_NE(refused.err.find("0.5625"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--trust-stated-drive"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(folder / "twin"));

  // `track` reports the mismatch and keeps the statement; `compare` refuses the kept file.
  const fs::path kept = folder / "kept.h5", trusted_film = folder / "trusted.h5";
  const Ran noted = run_program({"track", kStack, "--cell", cell, "-o", kept});
  ASSERT_EQ(noted.code, 0) << noted.err;
  EXPECT_NE(noted.err.find("does not fit the film"), std::string::npos) << noted.err;
  const Ran compared = run_program({"compare", "--experiment", kept, "-o", folder / "report", "-q"});
  EXPECT_EQ(compared.code, 2);
  EXPECT_NE(compared.err.find("0.5625"), std::string::npos) << compared.err;
  EXPECT_NE(compared.err.find("--trust-stated-drive"), std::string::npos) << compared.err;
  EXPECT_FALSE(fs::exists(folder / "report"));
  EXPECT_EQ(
      run_program({"compare", "--experiment", kept, "-o", folder / "report", "-q", "--trust-stated-drive"})
          .code,
      0);
  ASSERT_EQ(
      run_program({"track", kStack, "--cell", cell, "-o", trusted_film, "-q", "--trust-stated-drive"}).code,
      0);
  EXPECT_EQ(run_program({"compare", "--experiment", trusted_film, "-o", folder / "trusted", "-q"}).code, 0);

  words.emplace_back("--trust-stated-drive");
  const Ran trusted = run_program(words);
  EXPECT_EQ(trusted.code, 0) << trusted.err;
}

// The cell of another camera and another strength: the plate is 45 px from its stated row.
TEST(Match, TheCellFileOfAnotherStackIsRefused) {
  const TemporaryFolder folder;
  const fs::path cell = folder / "other.toml";
  {
    std::ifstream in(kStack / "CELL.toml");
    std::ofstream out(cell);
    for (std::string line; std::getline(in, line);)
      out << (line.starts_with("amplitude")   ? "amplitude = 1.6"
              : line.starts_with("origin_px") ? "origin_px = [20, 230.8]"
                                              : line)
          << "\n";
  }
  const Ran refused = run_program({"match", kStack, cell, "-o", folder / "twin", "--twins", "1", "--no-film",
                                   "--set", "time.steps_per_contact=20", "-q"});
  EXPECT_EQ(refused.code, 2) << refused.err;
  const auto seen = refused.err.find("A = ");
  ASSERT_NE(seen, std::string::npos) << refused.err;
  EXPECT_NEAR(std::stod(refused.err.substr(seen + 4)), 0.9, 0.002) << refused.err;
  EXPECT_NE(refused.err.find("where camera.origin_px states 230.8"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("but the cell states 1.6"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(folder / "twin/experiment.h5"));
}

// One cell for two strengths, which states one of them: to trust it would be wrong for the other.
TEST(Match, ACellOfSeveralStacksThatStatesOneStrengthIsRefusedWithTheRemedy) {
  const TemporaryFolder folder;
  const fs::path stronger = kStack.parent_path() / "gamma-1.6";
  const Ran refused = run_program({"match", kStack, stronger, stronger / "CELL.toml", "-o", folder / "twins",
                                   "--twins", "1", "--no-film", "-q"});
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_NE(refused.err.find("the cell serves 2 stacks: leave the strength of the drive out of it"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(refused.err.find("--trust-stated-drive"), std::string::npos) << refused.err;
}

/// The shipped cell with one line replaced.
fs::path cell_with(const TemporaryFolder& folder, const std::string& key, const std::string& line_of_key) {
  std::ifstream in(kStack / "CELL.toml");
  fs::path path = folder / "changed.toml";
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);)
    out << (line.starts_with(key + " ") ? key + " = " + line_of_key : line) << "\n";
  return path;
}

TEST(Match, WhatTheFilmContradictsIsRefusedBeforeTheTwins) {
  const TemporaryFolder folder;
  const auto refused = [&](const fs::path& cell, const std::vector<std::string>& more,
                           const std::string& why) {
    std::vector<std::string> words{"match", kStack, cell, "-o", folder / "twin", "--no-film", "-q"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 2) << ran.err;
    EXPECT_NE(ran.err.find(why), std::string::npos) << ran.err;
    EXPECT_FALSE(fs::exists(folder / "twin/simulation-1.h5"));
  };
  refused(cell_with(folder, "first_phase", "10"), {}, "shows the first frame at phase 0 of 20");
  refused(cell_with(folder, "width", "1"), {}, "lie inside the cell of width 1");
  refused(kStack / "CELL.toml", {"--discard", "50"}, "--discard: is 50, but ");
}

TEST(Match, ASecondMatchIntoAFolderMixesNothing) {
  const TemporaryFolder folder;
  const std::string twin = folder / "twin";
  const auto match = [&](const std::string& twins) {
    return run_program({"match", kStack, "-o", twin, "--twins", twins, "--no-film", "-q", "--set",
                        "time.steps_per_contact=20"});
  };
  ASSERT_EQ(match("2").code, 0);
  EXPECT_EQ(match("2").code, 0) << "the same again";
  const Ran fewer = match("1");
  EXPECT_EQ(fewer.code, 2);
  EXPECT_NE(fewer.err.find("simulation-2.h5: it is a twin of an earlier match"), std::string::npos)
      << fewer.err;
  const Ran several =
      run_program({"match", kStack, fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/gamma-1.6", "-o", twin,
                   "--no-film", "-q"});
  EXPECT_EQ(several.code, 2);
  EXPECT_NE(several.err.find("it holds the match of one stack"), std::string::npos) << several.err;
  // What the user writes into the report or the scene stays, and is noticed before any work.
  const std::string scene = read_text_file(fs::path(twin) / "scene.toml");
  std::ofstream(fs::path(twin) / "scene.toml", std::ios::app) << "# my words\n";
  const Ran changed = match("2");
  EXPECT_EQ(changed.code, 2);
  EXPECT_NE(changed.err.find("scene.toml: it has changed since twincell wrote it"), std::string::npos);
  EXPECT_EQ(read_text_file(fs::path(twin) / "scene.toml"), scene + "# my words\n");
  std::ofstream(fs::path(twin) / "scene.toml") << scene;
  const auto before = fs::last_write_time(fs::path(twin) / "experiment.h5");
  std::ofstream(fs::path(twin) / "report/report.html", std::ios::app) << "<!-- my words -->\n";
  EXPECT_EQ(match("2").code, 2);
  EXPECT_EQ(fs::last_write_time(fs::path(twin) / "experiment.h5"), before);
}

TEST(Match, AStackWithoutBeadsIsRefused) {
  const TemporaryFolder folder;
  const fs::path stack = folder / "blank";
  fs::create_directory(stack);
  for (int f = 0; f < 10; ++f)
    write_picture(stack / ("frame_" + std::to_string(f) + ".png"), cv::Mat(218, 160, CV_8U, cv::Scalar(128)));
  for (const std::vector<std::string>& verb :
       {std::vector<std::string>{"track", stack, "--cell", kStack / "CELL.toml", "-o", folder / "t.h5"},
        std::vector<std::string>{"match", stack, kStack / "CELL.toml", "-o", folder / "twin"}}) {
    const Ran ran = run_program(verb);
    EXPECT_EQ(ran.code, 3) << ran.err;
    EXPECT_NE(ran.err.find("No bead was located in any frame"), std::string::npos) << ran.err;
  }
  EXPECT_FALSE(fs::exists(folder / "t.h5"));
  // Of several stacks, it is named.
  const Ran ran =
      run_program({"match", stack, kStack, kStack / "CELL.toml", "-o", folder / "twins", "--no-film", "-q"});
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_NE(ran.err.find(stack.string() + ": No bead was located in any frame"), std::string::npos)
      << ran.err;
}

TEST(Match, AFilmThatIsNamedTwiceIsRefusedBeforeAnyWork) {
  const TemporaryFolder folder;
  fs::copy(kStack, folder / "copy", fs::copy_options::recursive);
  const Ran ran =
      run_program({"match", kStack, folder / "copy", kStack / "CELL.toml", "-o", folder / "twins", "-q"});
  EXPECT_EQ(ran.code, 2) << ran.err;
  EXPECT_NE(ran.err.find("begins with the same pictures as"), std::string::npos) << ran.err;
  EXPECT_FALSE(fs::exists(folder / "twins"));
}

TEST(Match, StatedDriveIsCheckedAgainstTheBedIfThePlateIsNotVisible) {
  for (const double gamma : {0.9, 1.6}) {
    const TemporaryFolder folder;
    const fs::path stack = film_above_plate(folder, gamma, 1);
    const fs::path cell = with_amplitude(stack, "amplitude = " + std::to_string(gamma / 1.6));
    const Ran refused = run_program({"match", stack, cell, "-o", folder / "twin", "--twins", "1", "--no-film",
                                     "--set", "time.steps_per_contact=20", "-q"});
    EXPECT_EQ(refused.code, 2) << refused.err;
    const auto seen = refused.err.find("A = ");
    ASSERT_NE(seen, std::string::npos) << refused.err;
    EXPECT_NEAR(std::stod(refused.err.substr(seen + 4)), gamma, 0.1 * gamma) << refused.err;
    EXPECT_NE(refused.err.find("the bed"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find(gamma < 1 ? "states 0.5625" : "states 1;"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("--trust-stated-drive"), std::string::npos) << refused.err;
    EXPECT_FALSE(fs::exists(folder / "twin/experiment.h5"));
    // `track` reports the mismatch and keeps the statement; `compare` refuses the kept file.
    const fs::path kept = folder / "kept.h5";
    const Ran noted = run_program({"track", stack, "--cell", cell, "-o", kept});
    EXPECT_EQ(noted.code, 0);
    EXPECT_NE(noted.err.find("does not fit the film"), std::string::npos) << noted.err;
    const Ran compared = run_program({"compare", "--experiment", kept, "-o", folder / "report", "-q"});
    EXPECT_EQ(compared.code, 2) << compared.err;
    // Without the plate, a false edge in the image must not be used to measure a drive.
    const Ran unknown = run_program({"match", stack, with_amplitude(stack, ""), "-o", folder / "twin", "-q"});
    EXPECT_EQ(unknown.code, 3) << unknown.err;
    EXPECT_NE(unknown.err.find("cannot be seen on the plate"), std::string::npos) << unknown.err;
  }
}

TEST(Match, SecondHarmonicIsCheckedAgainstThePlate) {
  const TemporaryFolder folder;
  const fs::path run = folder / "run.h5", stack = folder / "frames";
  ASSERT_EQ(
      run_program({"simulate", fs::path(TWINCELL_SOURCE_DIR) / "data_samples/demo/experiment.toml", "-q",
                   "-o", run, "--set", "drive.gamma=0.9", "--set", "drive.harmonics=[[0.1, 0.25]]", "--set",
                   "time.discard=1", "--set", "time.cycles=3"})
          .code,
      0);
  ASSERT_EQ(run_program({"render", run, "-q", "-o", stack, "--pixels-per-sigma", "12"}).code, 0);
  const auto noted = [&](const fs::path& cell) {
    const Ran ran = run_program({"track", stack, "--cell", cell, "-o", folder / "t.h5", "--force"});
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran.err.find("the plate in the frames has a second harmonic of 0.1") != std::string::npos;
  };
  EXPECT_FALSE(noted(stack / "CELL.toml"));
  std::ifstream in(stack / "CELL.toml");
  std::ofstream out(folder / "sine.toml");
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with("harmonics")) out << line << "\n";
  out.close();
  EXPECT_TRUE(noted(folder / "sine.toml"));
  // `new` measures it and writes it.
  ASSERT_EQ(run_program({"new", stack, "-q", "-o", folder / "new.toml", "--drive-gamma", "0.9"}).code, 0);
  EXPECT_FALSE(noted(folder / "new.toml"));
  const imaging::CellDescription found = imaging::read_cell(folder / "new.toml");
  ASSERT_EQ(found.harmonics.size(), 1U);
  EXPECT_NEAR(found.harmonics[0].amplitude, 0.1, 0.002);
  EXPECT_NEAR(found.harmonics[0].phase, 0.25, 0.005);
}

// The shaker is off: one frame, 40 times with the noise of a camera.
TEST(Match, ABedAtRestContradictsAStatedAmplitude) {
  const TemporaryFolder folder;
  const fs::path stack = folder / "still";
  fs::create_directory(stack);
  const cv::Mat frame = read_picture(kStack / "frame_00000.png");
  cv::RNG random(3);
  for (int f = 0; f < 60; ++f) {
    cv::Mat noise(frame.size(), CV_16S), noisy;
    random.fill(noise, cv::RNG::NORMAL, 0, 1);
    cv::add(frame, noise, noisy, cv::noArray(), CV_8U);
    write_picture(stack / fmt::format("frame_{:05}.png", f), noisy);
  }
  const Ran refused = run_program({"match", stack, kStack / "CELL.toml", "-o", folder / "twin", "--twins",
                                   "1", "--no-film", "--set", "time.steps_per_contact=20", "-q"});
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_NE(
      refused.err.find("the beads stand still in the frames, but the cell states a plate of A = 0.9 sigma"),
      std::string::npos)
      << refused.err;
  // `analyze` repeats what `track` has noted.
  const Ran noted = run_program({"track", stack, "--cell", kStack / "CELL.toml", "-o", folder / "t.h5"});
  EXPECT_NE(noted.err.find("the beads stand still"), std::string::npos) << noted.err;
  const Ran analysed = run_program({"analyze", folder / "t.h5", "--only", "s_b"});
  EXPECT_EQ(analysed.code, 0) << analysed.err;
  EXPECT_NE(analysed.err.find("the stated drive does not fit the film: the beads stand still"),
            std::string::npos)
      << analysed.err;
}

TEST(Match, StatedFrequencyIsCheckedAgainstThePlate) {
  for (const StatedDrive& stated : stated_drives())
    expect_the_drive_checked(kStack, stated, "the plate in the frames");
}

// Two cycles without a frame rate show no hertz, but a bed that is not thrown.
TEST(Match, AFrequencyThatWouldThrowTheBedIsRefused) {
  const TemporaryFolder folder;
  const fs::path with_rate =
      laboratory_cell(kStack, folder / "rate.toml",
                      fmt::format("amplitude_sigma = 0.9\nfrequency_hz = {:.6g}\n", 2 * kHertz));
  const fs::path cell = folder / "cell.toml";
  std::ifstream in(with_rate);
  std::ofstream out(cell);
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with("frame_rate_hz")) out << line << "\n";
  out.close();
  const Ran refused = run_program({"match", kStack, cell, "-o", folder / "twin", "--twins", "1", "--no-film",
                                   "--set", "time.steps_per_contact=20", "-q"});
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_NE(refused.err.find("the bed follows its plate over the whole cycle"), std::string::npos)
      << refused.err;
}

TEST(Match, DriveInLaboratoryUnitsIsCheckedAgainstTheBed) {
  const TemporaryFolder folder;
  const fs::path stack = film_above_plate(folder, 0.9, 1);
  const auto all = stated_drives();
  for (const std::size_t k : {0U, 9U}) expect_the_drive_checked(stack, all[k], "the bed on its plate");
  // A bed without its plate cannot show another frequency, but the stated frame rate can.
  for (const std::size_t k : {4U, 6U}) expect_the_drive_checked(stack, all[k], "frames per second");
}

// 20 frames per cycle are true. Neither a frame rate nor a scale is needed to see another number.
TEST(Match, StatedFramesPerCycleAreHeldAgainstThePlate) {
  for (const int stated : {10, 40, 21}) {
    const TemporaryFolder folder;
    const fs::path cell = folder / "cell.toml";
    std::ifstream in(kStack / "CELL.toml");
    std::ofstream out(cell);
    for (std::string line; std::getline(in, line);)
      out << (line.rfind("frames_per_cycle", 0) == 0 ? "frames_per_cycle = " + std::to_string(stated) : line)
          << "\n";
    out.close();
    const Ran tracked = run_program({"track", kStack, "--cell", cell, "-o", folder / "kept.h5"});
    EXPECT_EQ(tracked.code, 2) << tracked.err;
    EXPECT_NE(tracked.err.find("after 20 frames"), std::string::npos) << tracked.err;
    EXPECT_NE(tracked.err.find("is " + std::to_string(stated)), std::string::npos) << tracked.err;
    const Ran matched =
        run_program({"match", kStack, cell, "-o", folder / "twin", "--twins", "1", "--no-film", "-q"});
    EXPECT_EQ(matched.code, 2) << matched.err;
    const auto period = matched.err.find("a period of ");
    ASSERT_NE(period, std::string::npos) << matched.err;
    EXPECT_NEAR(std::stod(matched.err.substr(period + 12)), 20, 0.1) << matched.err;
    EXPECT_NE(matched.err.find("states " + std::to_string(stated) + " frames per cycle"), std::string::npos)
        << matched.err;
  }
}

// The film is played at 25 frames per second and was taken at 223. Only a stated rate counts.
TEST(Match, ThePlaybackRateOfAVideoIsNotTheCamerasRate) {
  const TemporaryFolder folder;
  const fs::path video = folder / "film.mkv";
  {
    std::set<fs::path> pictures;
    for (const auto& entry : fs::directory_iterator(kStack))
      if (entry.path().extension() == ".png") pictures.insert(entry.path());
    const auto out =
        imaging::codecs().create_film(video.string(), "FFV1", 25, read_picture(*pictures.begin()).size());
    ASSERT_NE(out, nullptr);
    for (const fs::path& picture : pictures) {
      cv::Mat colour;
      cv::cvtColor(read_picture(picture), colour, cv::COLOR_GRAY2BGR);
      out->write(colour);
    }
  }
  const std::string right = stated_drives()[0].lines;
  const fs::path cell = laboratory_cell(kStack, folder / "cell.toml", right);
  fs::path bare = folder / "bare.toml";  // without the frame rate
  {
    std::ifstream in(cell);
    std::ofstream out(bare);
    for (std::string line; std::getline(in, line);)
      if (line.rfind("frame_rate_hz", 0) != 0) out << line << "\n";
  }
  const Ran tracked = run_program({"track", video, "--cell", bare, "-o", folder / "t.h5"});
  EXPECT_EQ(tracked.code, 0) << tracked.err;
  EXPECT_EQ(tracked.err.find("does not fit"), std::string::npos) << tracked.err;
  const fs::path driveless = laboratory_cell(kStack, folder / "driveless.toml", "");
  fs::path unknown = folder / "unknown.toml";  // neither drive nor frame rate
  {
    std::ifstream in(driveless);
    std::ofstream out(unknown);
    for (std::string line; std::getline(in, line);)
      if (line.rfind("frame_rate_hz", 0) != 0) out << line << "\n";
  }
  const Ran matched = run_program({"match", video, unknown, "-o", folder / "twin", "-q"});
  EXPECT_EQ(matched.code, 2) << matched.err;
  EXPECT_NE(matched.err.find("camera.frame_rate_hz"), std::string::npos) << matched.err;
}

TEST(Match, AMisstatedFrequencyMayBeTrusted) {
  const TemporaryFolder folder;
  const fs::path cell = laboratory_cell(kStack, folder / "cell.toml", stated_drives()[4].lines);
  const Ran tracked = run_program({"track", kStack, "--cell", cell, "-o", folder / "kept.h5"});
  ASSERT_EQ(tracked.code, 0) << tracked.err;
  const Ran compared = run_program({"compare", "--experiment", folder / "kept.h5", "-o", folder / "report",
                                    "-q", "--no-film", "--trust-stated-drive"});
  EXPECT_EQ(compared.code, 0) << compared.err;
  const Ran matched = run_program({"match", kStack, cell, "-o", folder / "twin", "--twins", "1", "--no-film",
                                   "--set", "time.steps_per_contact=20", "-q", "--trust-stated-drive"});
  EXPECT_EQ(matched.code, 0) << matched.err;
}

TEST(Match, CompareChecksADriveThatNoTrackingHasChecked) {
  const TemporaryFolder folder;
  MemoryTrajectory bed =
      test::rigid_bed({.gamma = 0.9, .rows = 5, .phases = 20, .cycles = 6, .source = Origin::experiment});
  for (const double stated : {0.9, 0.9 / 1.6}) {
    bed.info().drive->amplitude = stated;
    const fs::path file = folder / ("states-" + std::to_string(stated) + ".h5");
    H5mdWriter writer(file, bed.info());
    for (const Frame& frame : bed.frames()) writer.append(frame);
    writer.finish();
    const Ran ran = run_program(
        {"compare", "--experiment", file, "-o", folder / ("report-" + file.stem().string()), "-q"});
    EXPECT_EQ(ran.code, stated == 0.9 ? 0 : 2) << ran.err;
    if (stated != 0.9) {
      EXPECT_NE(ran.err.find("A = 0.9 "), std::string::npos) << ran.err;
      EXPECT_NE(ran.err.find("0.5625"), std::string::npos) << ran.err;
    }
  }
}

TEST(Match, ACorrectDriveRaisesNoAlarmWhereThePlateIsNotInThePicture) {
  for (const double gamma : {0.9, 1.6, 2.5})
    for (const int seed : {1, 2}) {
      const TemporaryFolder folder;
      const fs::path stack = film_above_plate(folder, gamma, seed), tracked = folder / "tracked.h5";
      const Ran ran = run_program({"track", stack, "--cell", stack / "CELL.toml", "-o", tracked, "--json"});
      ASSERT_EQ(ran.code, 0) << ran.err;
      EXPECT_EQ(ran.err.find("does not fit"), std::string::npos) << gamma << ", seed " << seed << ran.err;
      const auto check = nlohmann::json::parse(ran.out)["drive_check"];
      EXPECT_EQ(check.value("by", ""), gamma < 2 ? "bed" : "") << check;
    }
}

TEST(Match, SaysWhatTheCellLacksAndLeavesNothing) {
  const TemporaryFolder folder;
  const fs::path stack = short_stack(folder);
  for (const auto& [key, named] : {std::pair<std::string, std::string>{"origin_px", "camera.origin_px"},
                                   {"width", "cell.width"},
                                   {"omega", "drive.omega"}}) {
    const fs::path cell = cell_without(folder, key);
    const Ran ran = run_program({"match", stack, cell, "-o", folder / "twin", "-q"});
    EXPECT_EQ(ran.code, 2) << key;
    EXPECT_NE(ran.err.find(named), std::string::npos) << ran.err;
    const bool measured =
        ran.err.find("twincell new " + stack.string() + " -o CELL.toml measures it.") != std::string::npos;
    EXPECT_EQ(measured, key != "omega") << ran.err;
    EXPECT_FALSE(fs::exists(folder / "twin")) << key;
  }
  EXPECT_EQ(run_program({"match", folder / "no", kStack / "CELL.toml", "-o", folder / "twin", "-q"}).code, 3);
  EXPECT_EQ(run_program({"match", stack, folder / "no.toml", "-o", folder / "twin", "-q"}).code, 3);
  EXPECT_EQ(run_program({"match", stack, kStack / "CELL.toml", "-o", folder / "no/twin", "-q"}).code, 2);
  EXPECT_EQ(run_program(
                {"match", stack, kStack / "CELL.toml", "-o", folder / "twin", "-q", "--set", "contact.mu=-1"})
                .code,
            2);
  EXPECT_FALSE(fs::exists(folder / "twin"));
}

// The bed of the film lies between walls 10 sigma apart.
TEST(Match, ACellInWhichTheBedCannotLieIsRefused) {
  const TemporaryFolder folder;
  const fs::path stack = short_stack(folder);
  std::string cell = bytes_of(kStack / "CELL.toml");
  const auto at = cell.find("width = 10");
  ASSERT_NE(at, std::string::npos) << cell;
  cell.replace(at, 10, "width = 12");
  put_file(folder / "wide.toml", cell);
  std::vector<std::string> words = {
      "match",     stack,   folder / "wide.toml",        "-o", folder / "twin", "--twins", "1",
      "--no-film", "--set", "time.steps_per_contact=20", "-q"};
  const Ran refused = run_program(words);
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_NE(refused.err.find("no closer to the right wall than 2.0"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--trust-stated-cell"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(folder / "twin/experiment.h5"));
  words.emplace_back("--trust-stated-cell");
  EXPECT_EQ(run_program(words).code, 0);
}

TEST(Match, TheCellsDriveDisplacesTheScenes) {
  imaging::CellDescription cell;
  cell.width = 12;
  cell.origin = imaging::PixelPoint{0, 100};
  cell.phase_lock.frames_per_cycle = 20;
  cell.drive_spec.gamma = 2;
  cell.drive_spec.omega = 2;
  const std::string text = twin::twin_scene("[drive]\nk_m = 3\nfrequency = 1\n[contact]\nmu = 0.3\n",
                                            "base.toml", cell, "exp.h5", 4, 7);
  EXPECT_EQ(text.find("k_m"), std::string::npos) << text;
  EXPECT_NE(text.find("[contact]"), std::string::npos) << text;
  const sim::Scene scene = sim::read_scene_text(twin::twin_scene("", "", cell, "exp.h5", 4, 7), "twin");
  EXPECT_DOUBLE_EQ(scene.drive.amplitude, 0.5);
  EXPECT_DOUBLE_EQ(scene.drive.omega, 2);
  EXPECT_DOUBLE_EQ(scene.width, 12);
  EXPECT_EQ(scene.frame, 4U);
  EXPECT_EQ(scene.cycles, 7);
  EXPECT_EQ(scene.contact.tangential, "spring");  // the preset of paper 1
  EXPECT_TRUE(scene.drive.harmonics.empty());
  cell.harmonics = {{0.1, 0.25}, {1.0 / 3, 0}};
  const sim::Scene shaken = sim::read_scene_text(twin::twin_scene("", "", cell, "exp.h5", 4, 7), "twin");
  EXPECT_EQ(shaken.drive.displacement(0.3), cell.drive()->displacement(0.3));
  EXPECT_EQ(shaken.drive.harmonics.size(), 2);
}

}  // namespace twincell::match_test
