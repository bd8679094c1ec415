// The same scene in LAMMPS, from the deck that `export` writes, read back by `import`. The two programs share
// no code and may differ only by rounding. A control measures how rounding grows in a bed of colliding beads:
// the difference between two Twincell runs whose gravity differs by parts in 10^11.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "core/atomic_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::lammps_test {
namespace {

namespace fs = std::filesystem;

// Forty beads between side walls that move with the plate, with spring friction and history. In the starting
// crystal every contact just touches, so no history has to be transferred.
const std::string kPaperOne = R"(
preset = "fortini-huang-2015"
[cell]
width = 8.0
[beads]
count = 40
[drive]
amplitude = 0.9
[start]
settle_limit = 0
[time]
integrator = "verlet"
discard = 0
cycles = 1
phases = 40
)";

// Forty rough beads, periodic, thrown into the air above a plate that propels them.
const std::string kPaperTwo = R"(
preset = "bhateja-2016-rough-2d"
[drive]
peak_velocity = 2.2
[start]
kind = "random"
seed = 3
settle_limit = 0
[time]
integrator = "verlet"
discard = 0
cycles = 1
phases = 40
)";

// The gas of the same model in three dimensions: a hundred rough spheres.
const std::string kSpace = R"(
preset = "bhateja-2016-rough-3d"
[drive]
peak_velocity = 2.2
[start]
kind = "random"
seed = 3
settle_limit = 0
[time]
integrator = "verlet"
discard = 0
cycles = 1
phases = 40
)";

/// Largest distance between the same bead in the two runs, per frame; frame k of `b` is frame k + skip of
/// `a`.
std::vector<double> differences(const fs::path& a, const fs::path& b, std::size_t skip = 0) {
  const H5mdReader first(a), second(b);
  EXPECT_EQ(second.info().n_beads, first.info().n_beads);
  std::vector<double> worst;
  Frame x, y;
  for (std::size_t k = 0; k < std::min(second.n_frames(), first.n_frames() - skip); ++k) {
    first.read(k + skip, x);
    second.read(k, y);
    EXPECT_EQ(x.phase, y.phase);
    EXPECT_NEAR(x.plate_height, y.plate_height, 1e-12);
    worst.push_back(0);
    for (std::size_t i = 0; i < x.position.size(); ++i)
      worst.back() = std::max(worst.back(), (x.position[i] - y.position[i]).norm());
  }
  return worst;
}

/// One word of a deck, selected by the beginning of its line and its index there, and its replacement.
/// Without a replacement the number increases by a hundredth. An index one past the last word appends.
struct Change {
  std::string line;
  std::size_t word;
  std::optional<std::string> by = std::nullopt;
};

std::string changed(const std::string& input, const Change& change) {
  std::istringstream lines(input);
  std::string out;
  bool found = false;
  for (std::string line; std::getline(lines, line); out += line + "\n") {
    std::istringstream blanks(line);
    std::vector<std::string> words;
    for (std::string word; blanks >> word;) words.push_back(word);
    if (fmt::format("{} ", fmt::join(words, " ")).rfind(change.line + " ", 0) != 0) continue;
    found = true;
    words.resize(std::max(words.size(), change.word + 1));
    words[change.word] = change.by ? *change.by : fmt::format("{}", 1.01 * std::stod(words[change.word]));
    line = fmt::format("{}", fmt::join(words, " "));
  }
  EXPECT_TRUE(found) << change.line << " is not in the deck:\n" << input;
  return out;
}

class Lammps : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v lmp >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "LAMMPS is not installed (Debian: apt-get install lammps)";
  }

  static void run(const std::vector<std::string>& words) {
    const Ran ran = run_program(words);
    ASSERT_EQ(ran.code, 0) << ran.err;
  }

  /// Runs the scene in Twincell, and again with slightly different gravity as the control.
  void simulate(const std::string& scene, const std::vector<std::string>& set) {
    put_file(folder_ / "scene.toml", scene);
    set_ = set;
    simulate_as("ours.h5", "");
    const double gravity = 1;
    for (const double change : {1e-11, -1e-11, 2e-11, -2e-11}) {
      simulate_as("control.h5", fmt::format("cell.gravity={:.17g}", gravity + change));
      const auto d = differences(folder_ / "ours.h5", folder_ / "control.h5");
      control_.resize(d.size());
      double so_far = kRounding;
      for (std::size_t k = 0; k < d.size(); ++k) control_[k] = so_far = std::max({so_far, control_[k], d[k]});
    }
  }

  void export_deck(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = with_set(
        {"export", folder_ / "scene.toml", "--to", "lammps", "--json", "-q", "-o", folder_ / "deck"});
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run_program(words);
    ASSERT_EQ(ran.code, 0) << ran.err;
    import_command_ = nlohmann::json::parse(ran.out).at("import");
    input_ = read_text_file(folder_ / "deck/in.twincell");
  }

  /// Runs a deck and returns the differences per frame.
  std::vector<double> lammps(const std::string& input, std::size_t skip = 0) {
    put_file(folder_ / "deck/in.twincell", input);
    const std::string command =
        fmt::format("cd '{}' && lmp -in in.twincell -log none >log.txt 2>&1", (folder_ / "deck").string());
    EXPECT_EQ(std::system(command.c_str()), 0) << read_text_file(folder_ / "deck/log.txt");
    std::istringstream words(import_command_);
    std::vector<std::string> import;
    for (std::string word; words >> word;) {
      if (word == "dump.lammpstrj" || word == "lammps.h5") word = folder_ / "deck" / word;
      if (word != "twincell") import.push_back(word);
    }
    run(import);
    return differences(folder_ / "ours.h5", folder_ / "deck/lammps.h5", skip);
  }

  /// Largest ratio of a difference to the control's limit for that frame.
  [[nodiscard]] double over_control(const std::vector<double>& d, std::size_t skip = 0) const {
    double most = 0;
    for (std::size_t k = 0; k < d.size(); ++k) most = std::max(most, d[k] / control_[k + skip]);
    return most;
  }

  /// The unchanged deck agrees; with any one word changed it does not.
  void expect_agreement_and_notice(const std::vector<Change>& wrong) {
    const auto d = lammps(input_);
    ASSERT_EQ(d.size(), 40U);
    fmt::print(
        "differences: {:.1e} after 1/40 of a cycle, {:.1e} after 10/40, {:.1e} after 39/40; largest "
        "against the control: {:.2g}\n",
        d[1], d[10], d[39], over_control(d));
    EXPECT_LT(d[1], 1e-12);
    EXPECT_LT(over_control(d), 10);
    for (const Change& change : wrong) {
      const double noticed = over_control(lammps(changed(input_, change)));
      fmt::print("  {}, word {}, {}: {:.2g}\n", change.line, change.word, change.by.value_or("1 % more"),
                 noticed);
      EXPECT_GT(noticed, 1000) << change.line << " word " << change.word;
    }
  }

  std::vector<std::string> with_set(std::vector<std::string> words) const {
    for (const auto& s : set_) words.insert(words.end(), {"--set", s});
    return words;
  }

  TemporaryFolder folder_;
  std::string input_, import_command_;

 private:
  static constexpr double kRounding = 1e-12;

  void simulate_as(const std::string& name, const std::string& change) {
    std::vector<std::string> words =
        with_set({"simulate", folder_ / "scene.toml", "-q", "-o", folder_ / name});
    if (!change.empty()) words.insert(words.end(), {"--set", change});
    run(words);
  }

  std::vector<std::string> set_;
  std::vector<double> control_;  ///< per frame, the largest difference so far, at least kRounding
};

// Words of `pair_style`: 2 k_n, 3 k_t, 4 gamma_n, 5 gamma_t, 6 mu; words 5 to 9 of `fix … wall/gran` are the
// same.
TEST_F(Lammps, FirstPaperPressedBed) {
  simulate(kPaperOne, {});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 2},
                               {"pair_style", 3},
                               {"pair_style", 4},
                               {"pair_style", 5},
                               {"pair_style", 6},
                               {"fix bottom", 7},
                               {"fix left_right", 6},
                               {"fix left_right", 9},
                               {"fix left_right", 16},
                               {"fix motion", 4, ""}});
}

TEST_F(Lammps, FirstPaperBouncingBed) {
  simulate(kPaperOne, {"drive.amplitude=2.0"});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 4}, {"fix bottom", 16}});
}

TEST_F(Lammps, SecondPaperRough) {
  simulate(kPaperTwo, {});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 4}, {"pair_style", 5}, {"pair_style", 6}, {"fix bottom", 7}});
}

TEST_F(Lammps, SecondPaperSmooth) {
  simulate(kPaperTwo, {"contact.tangential=none", "contact.mu=0.0"});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 4}});
}

// Options that the papers do not use: no tension, damping constants, walls at rest, a tilted cell.
TEST_F(Lammps, OtherWords) {
  simulate(kPaperTwo, {"contact.normal=linear-no-tension", "contact.c_n=47.0", "contact.c_t=30.0",
                       "cell.sides=walls", "cell.side_walls=rest", "cell.tilt=10.0"});
  export_deck();
  expect_agreement_and_notice(
      {{"pair_style", 8, ""}, {"fix left_right", 15, "wiggle y 1 2.856"}, {"fix weight", 6, "0.18"}});
}

TEST_F(Lammps, SecondPaperInSpace) {
  simulate(kSpace, {});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 4}, {"pair_style", 5}, {"pair_style", 6}, {"fix bottom", 7}});
}

TEST_F(Lammps, SecondPaperSmoothInSpace) {
  simulate(kSpace, {"preset=bhateja-2016-smooth-3d"});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 4}, {"fix bottom", 16}});
}

TEST_F(Lammps, SecondPaperInABox) {
  simulate(kSpace, {"cell.sides=walls", "cell.plates=walls"});
  export_deck();
  expect_agreement_and_notice({{"fix left_right", 7}, {"fix front_back", 8}, {"fix front_back", 16}});
}

// The pressed bed with spheres in three dimensions: the tangential spring is then a vector in the tangent
// plane.
TEST_F(Lammps, PressedBedInSpace) {
  simulate(kPaperOne, {"cell.dimension=3", "cell.depth=1.2", "beads.inertia=sphere"});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 3}, {"fix left_right", 9}, {"fix left_right", 16}});
}

// Driven along x between two end walls, floor and lid at rest.
TEST_F(Lammps, HorizontalDriveUnderALid) {
  simulate(kSpace, {"preset=bhateja-2016-horizontal", "cell.width=6.0", "cell.depth=4.0", "cell.height=8.0",
                    "beads.count=60", "drive.amplitude=1.0"});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 4}, {"fix left_right", 16}, {"fix bottom_lid", 7}});
}

// One large bead among the others, with its own mass and radius.
TEST_F(Lammps, Intruder) {
  simulate(kPaperTwo, {"beads.intruder={radius=1.0, z=3.0}", "contact.gamma_n=90.0", "contact.gamma_t=90.0"});
  export_deck();
  expect_agreement_and_notice({{"pair_style", 4}, {"fix motion", 4, "disc"}});
}

TEST_F(Lammps, GoesOnFromAFrame) {
  constexpr std::size_t kFrame = 10;
  simulate(kPaperTwo, {});
  export_deck({"--from", folder_ / "ours.h5", "--frame", std::to_string(kFrame)});
  const auto d = lammps(input_, kFrame);
  ASSERT_EQ(d.size(), 30U);
  EXPECT_LT(d.front(), 1e-15);
  EXPECT_LT(over_control(d, kFrame), 10);
}

// If the scene states no integrator, Twincell's default differs from LAMMPS's integrator, so the deck states
// the latter.
TEST(LammpsDeck, WithoutAnIntegratorIsOfLammpssOwnAndSaysSo) {
  const TemporaryFolder folder;
  std::string silent = kPaperOne;
  silent.erase(silent.find("integrator = \"verlet\"\n"), std::string("integrator = \"verlet\"\n").size());
  put_file(folder / "stated.toml", kPaperOne);
  put_file(folder / "silent.toml", silent);
  const auto deck_of = [&](const std::string& name, const std::string& said) {
    const Ran ran = run_program({"export", folder / (name + ".toml"), "--to", "lammps", "-o", folder / name});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_EQ(ran.err.find("time.integrator is not set") != std::string::npos, !said.empty()) << ran.err;
    EXPECT_NE(ran.err.find(said), std::string::npos) << ran.err;
    return read_text_file(folder / name / "in.twincell");
  };
  const std::string stated = deck_of("stated", ""),
                    deck = deck_of("silent", "\"verlet\", LAMMPS's own integrator, at 50 steps per contact");
  const auto line = [](const std::string& text, const std::string& head) {
    const std::size_t at = text.find(head);
    return at == std::string::npos ? "no " + head : text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_EQ(line(deck, "timestep "), line(stated, "timestep "));
  EXPECT_NE(line(deck, "timestep ").find("e-05"), std::string::npos);  // 2.2e-3 t0 over 50
  EXPECT_EQ(line(deck, "# integrator"), "# integrator = 'verlet'") << deck;
  EXPECT_EQ(read_text_file(folder / "silent/data.twincell"), read_text_file(folder / "stated/data.twincell"));
  // A scene that states another integrator is refused.
  const Ran split = run_program({"export", folder / "silent.toml", "--to", "lammps", "-o", folder / "split",
                                 "--set", "time.integrator=split"});
  EXPECT_EQ(split.code, 2);
  EXPECT_NE(split.err.find("LAMMPS integrates as \"verlet\", not as \"split\""), std::string::npos)
      << split.err;
}

}  // namespace
}  // namespace twincell::lammps_test
