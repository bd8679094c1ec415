// What a user may give by mistake: numbers out of range, columns that do not exist, files of another kind, a
// folder for a file. Each command ends with its exit code and one sentence that contains the words of the
// table, prints nothing else, and leaves every file as it was.

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "core/sha256.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/rigid_bed.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::refusals_test {
namespace {

namespace fs = std::filesystem;

constexpr int kUsage = 2, kInput = 3;

struct Refusal {
  /// Words, separated by blanks; FOLDER/ is put before words with the prefix "@", and '' is an empty one.
  std::string command;
  int code;
  std::vector<std::string> said;
};

/// One folder of inputs for all tests, which no command may change.
class Refusals : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    put_file(at("s.toml"),
             "preset = \"fortini-huang-2015\"\n[beads]\ncount = 4\n[cell]\nwidth = 4.0\n[drive]\n"
             "gamma = 1.5\n[time]\ndiscard = 0\ncycles = 1\nintegrator = \"verlet\"\n");
    write_run("t.h5", test::rigid_bed({.gamma = 1.5, .columns = 4, .rows = 3, .phases = 20, .cycles = 3}));
    const MemoryTrajectory bed =
        test::rigid_bed({.gamma = 1.5, .columns = 4, .rows = 3, .phases = 20, .cycles = 1});
    write_run("noframes.h5", MemoryTrajectory(bed.info()));
    TrajectoryInfo no_beads = bed.info();
    no_beads.n_beads = 0;
    no_beads.radius.clear();
    no_beads.mass.clear();
    no_beads.tracer.clear();
    MemoryTrajectory empty_cell(no_beads);
    for (Frame frame : bed.frames()) {
      frame.id.clear();
      for (auto* column : {&frame.position, &frame.velocity, &frame.spin}) column->clear();
      empty_cell.append(frame);
    }
    write_run("nobeads.h5", empty_cell);
    TrajectoryInfo deep = bed.info();
    deep.box.dimension = 3;
    deep.box.boundary = {Boundary::wall, Boundary::wall, Boundary::wall};
    MemoryTrajectory deep_bed(deep);
    for (const Frame& frame : bed.frames()) deep_bed.append(frame);
    write_run("deep.h5", deep_bed);
    put_file(at("deep.csv"), "frame,particle,x,y,z\n0,0,1,2,0.5\n0,1,3,2,0.7\n1,0,1,2,0.5\n1,1,3,2,0.7\n");
    put_file(at("beads.csv"), "frame,x,y\n0,1,2\n0,3,2\n");
    put_file(at("nothing.toml"), "scene = \"s.toml\"\nresults = []\n[axes]\ndrive.gamma = [1.2, 1.4]\n");
    put_file(at("g.csv"), "x,y\n1,2.1\n2,3.9\n3,6.2\n4,7.8\n5,10.1\n");
    put_file(at("p.csv"), "x,y,trials,s\n1,0.1,5,0.1\n2,0.5,5,-1\n3,0.9,5.5,0.1\n");
    std::string flights = "time,height\n";
    for (int i = 0; i < 100; ++i)
      flights += std::to_string(0.02 * i) + "," + std::to_string(1 - 0.0002 * i * i) + "\n";
    put_file(at("fall.csv"), flights);
    put_file(at("back.csv"), "time,height\n2,1\n1,0.9\n0,0.7\n");
    put_file(at("semicolons.csv"), "x;y\n1,5;2,1\n2,5;3,9\n");
    put_file(at("commas.csv"), "x,y\n1,5,2,1\n2,5,3,9\n");
    put_file(at("bare.csv"), "1,2\n2,4\n3,6\n");
    put_file(at("twice.csv"), "x,x\n1,2\n2,4\n3,6\n");
    put_file(at("nan.csv"), "x,y\n1,nan\n2,nan\n3,nan\n");
    put_file(at("empty"), "");
    put_file(at("text.h5"), "this is text\n");
    put_file(at("text.png"), "this is text\n");
    put_file(at("doubled.toml"), "[drive]\ngamma = 1.5\ngamma = 1.6\n");
    fs::create_directory(at("folder"));
    put_file(at("folder/mine.txt"), "mine");
    fs::create_symlink(at("t.h5"), at("link.h5"));
    fs::copy_file(at("t.h5"), at("copy.h5"));
    fs::create_hard_link(at("g.csv"), at("link.csv"));
    fs::create_directory(at("mixed"));
    for (int k = 0; k < 3; ++k)
      write_picture(at("mixed/f" + std::to_string(k) + ".png"),
                    cv::Mat(64, k == 2 ? 60 : 64, CV_8U, cv::Scalar(200)));
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static std::string at(const std::string& name) { return *folder_ / name; }

  static void write_run(const std::string& name, const MemoryTrajectory& run) {
    H5mdWriter writer(at(name), run.info());
    for (const Frame& frame : run.frames()) writer.append(frame);
    writer.finish();
  }

  static std::map<std::string, std::string> content() {
    std::map<std::string, std::string> sums;
    for (const auto& entry : fs::recursive_directory_iterator(folder_->path()))
      sums[entry.path()] = entry.is_regular_file() ? sha256_of(entry.path()) : "";
    return sums;
  }

  static void expect(const std::vector<Refusal>& table) {
    const auto before = content();
    for (const Refusal& r : table) {
      SCOPED_TRACE(r.command);
      std::vector<std::string> words;
      std::istringstream in(r.command);
      for (std::string word; in >> word;)
        words.push_back(word == "''" ? "" : word.front() == '@' ? at(word.substr(1)) : word);
      words.emplace_back("-q");
      const Ran ran = run_program(words);
      EXPECT_EQ(ran.code, r.code) << ran.err << ran.out;
      EXPECT_EQ(ran.out, "");
      EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
      EXPECT_LT(ran.err.size(), 1500U) << ran.err;
      for (const auto& word : r.said)
        EXPECT_NE(ran.err.find(word), std::string::npos) << "'" << word << "' is not in: " << ran.err;
      for (const char* raw :
           {"std::", "exception", "assert", ".cpp", "internal error", "1844674407370955161", "WARNING"})
        EXPECT_EQ(ran.err.find(raw), std::string::npos) << ran.err;
    }
    EXPECT_EQ(content(), before);
  }

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* Refusals::folder_ = nullptr;

TEST_F(Refusals, Fit) {
  expect({{"fit @g.csv", kUsage, {"--law is required"}},
          {"fit @g.csv --law parabola", kUsage, {"no law called \"parabola\"", "line"}},
          {"fit @g.csv --law line --x z", kUsage, {"g.csv", "no column \"z\"", "x, y"}},
          {"fit @g.csv --law line --y z", kUsage, {"g.csv", "no column \"z\""}},
          {"fit @g.csv --law line --x x --y x", kUsage, {"--y", "'x'", "--x"}},
          {"fit @g.csv --law line --sigma z", kUsage, {"no column \"z\""}},
          {"fit @g.csv --law line --sigma y --trials y", kUsage, {"--trials", "--sigma", "only one"}},
          {"fit @p.csv --law line --sigma s", kInput, {"p.csv", "s", "row 2", "-1"}},
          {"fit @p.csv --law line --trials trials", kInput, {"p.csv", "row 3", "5.5", "whole number"}},
          {"fit @g.csv --law line --trials x", kInput, {"g.csv", "row 1", "2.1", "from 0 to 1"}},
          {"fit @g.csv --law line --window 3", kUsage, {"--window"}},
          {"fit @g.csv --law line --window 3,1", kUsage, {"window", "low must be below high"}},
          {"fit @g.csv --law line --window nan,3", kUsage, {"--window", "'nan'"}},
          {"fit @g.csv --law line --window a,b", kUsage, {"--window", "'a'"}},
          {"fit @g.csv --law line --window 100,200", kInput, {"window", "[1, 5]"}},
          {"fit @g.csv --law line -o @folder", kUsage, {"folder", "mine.txt"}},
          {"fit @g.csv --law line -o @g.csv", kUsage, {"g.csv"}},
          {"fit @empty --law line", kInput, {"empty", "no row"}},
          {"fit @folder --law line", kInput, {"this is a folder"}},
          {"fit @t.h5 --law line", kInput, {"t.h5", "not a text file"}},
          {"fit @none.csv --law line", kInput, {"none.csv", "does not exist"}},
          {"fit @semicolons.csv --law line", kInput, {"semicolons", "decimal points"}},
          {"fit @commas.csv --law line", kInput, {"commas.csv:2", "4 fields"}},
          {"fit @bare.csv --law line", kInput, {"bare.csv:1", "must name the columns"}},
          {"fit @twice.csv --law line",
           kInput,
           {"twice.csv:2", "x: the column occurs twice, with the values '1' and '2'"}},
          {"fit @nan.csv --law line", kInput, {"nan.csv", "y", "no number"}}});
}

// As of an unset variable of a shell: before, such an option counted as left out.
TEST_F(Refusals, EmptyValues) {
  expect({{"track @mixed -o @n.h5 --mask ''", kUsage, {"--mask", "is empty"}},
          {"track @mixed -o @n.h5 --frames ''", kUsage, {"--frames", "is empty"}},
          {"fit @g.csv --law line --sigma ''", kUsage, {"--sigma", "is empty"}},
          {"render @t.h5 -o @n --camera ''", kUsage, {"--camera", "is empty"}},
          {"compare --simulation '' -o @n", kUsage, {"--simulation", "is empty"}}});
}

TEST_F(Refusals, ADamagedFrame) {
  expect({{"track @mixed -o @n.h5 --diameter 10 --dark",
           kInput,
           {"f2.png", "--frames 0:2 reads those before it"}}});
}

// Before, one of the two was dropped.
TEST_F(Refusals, TwoOptionsThatSayDifferentThings) {
  const std::string track = "track @mixed -o @n.h5 ";
  expect({{track + "--frames-per-cycle 10 --phase-lock 20", kUsage, {"--frames-per-cycle", "10", "20"}},
          {track + "--first-phase 7 --phase-lock found", kUsage, {"--first-phase", "found"}},
          {track + "--frames-per-cycle 20 --phase-lock none", kUsage, {"--frames-per-cycle", "none"}},
          {track + "--set camera.frames_per_cycle=10 --frames-per-cycle 20",
           kUsage,
           {"--frames-per-cycle", "is 20", "camera.frames_per_cycle=10"}},
          {track + "--set camera.pixels_per_sigma=11 --pixels-per-sigma 12",
           kUsage,
           {"--pixels-per-sigma", "is 12", "camera.pixels_per_sigma=11"}},
          {track + "--set camera.origin_px=[1,2] --origin-px 1 3", kUsage, {"--origin-px", "[1,2]"}}});
}

TEST_F(Refusals, Bounce) {
  const std::string b = "calibrate contacts bounce ";
  expect({{b + "@t.h5 --bead -1", kUsage, {"--bead", "'-1'", "whole number"}},
          {b + "@t.h5 --bead 12", kUsage, {"--bead", "12", "beads 0 to 10"}},
          {b + "@t.h5 --bead 1.5", kUsage, {"--bead", "'1.5'", "whole number"}},
          {b + "@t.h5 --bead 99999999999999999999", kUsage, {"--bead", "whole number"}},
          {b + "@fall.csv --bead 1", kUsage, {"--bead", "fall.csv", "one bead"}},
          {b + "@nobeads.h5", kInput, {"nobeads.h5", "no beads"}},
          {b + "@noframes.h5", kInput, {"noframes.h5", "0 samples"}},
          {b + "@t.h5 --gravity 0", kUsage, {"--gravity", "'0'", "above 0"}},
          {b + "@t.h5 --gravity -1", kUsage, {"--gravity", "above 0"}},
          {b + "@t.h5 --gravity nan", kUsage, {"--gravity", "'nan' is not a finite number"}},
          {b + "@t.h5 --gravity inf", kUsage, {"--gravity", "'inf'"}},
          {b + "@t.h5 --gravity 1e999", kUsage, {"--gravity", "'1e999'"}},
          {b + "@t.h5 --gravity 9,81", kUsage, {"--gravity", "9.81", "decimal point"}},
          {b + "@t.h5 --gravity 9.81m", kUsage, {"--gravity", "'9.81m'"}},
          {b + "@t.h5 --drive-amplitude nan --drive-omega 1", kUsage, {"--drive-amplitude", "'nan'"}},
          {b + "@t.h5 --drive-amplitude -1 --drive-omega 1", kUsage, {"--drive-amplitude", "0 or above"}},
          {b + "@t.h5 --drive-amplitude 1 --drive-omega 0", kUsage, {"--drive-omega", "above 0"}},
          {b + "@t.h5 --drive-amplitude 1", kUsage, {"--drive-amplitude", "--drive-omega", "together"}},
          {b + "@t.h5 --drive-omega 1", kUsage, {"--drive-omega", "together"}},
          {b + "@fall.csv --drive-phase 1", kUsage, {"--drive-phase", "does not vibrate"}},
          {b + "@fall.csv --drive-amplitude 1 --drive-omega 1 --drive-phase nan",
           kUsage,
           {"--drive-phase", "'nan'"}},
          {b + "@fall.csv", kInput, {"fall.csv", "two consecutive flights"}},
          {b + "@back.csv", kInput, {"back.csv", "row 2", "must increase"}},
          {b + "@g.csv", kUsage, {"g.csv", "no column \"time\""}},
          {b + "@empty", kInput, {"empty", "no row"}},
          {b + "@folder", kInput, {"this is a folder"}},
          {b + "@fall.csv -o @folder", kUsage, {"folder"}},
          {b + "@fall.csv -o @fall.csv", kUsage, {"fall.csv", "input of the same command"}}});
}

TEST_F(Refusals, ContactNumbers) {
  const std::string n = "calibrate contacts numbers ";
  expect(
      {{n + "--restitution 1.5 --contact-time 0.1", kUsage, {"restitution", "1.5", "at most 1"}},
       {n + "--restitution 0 --contact-time 0.1", kUsage, {"restitution", "greater than 0"}},
       {n + "--restitution nan --contact-time 0.1", kUsage, {"--restitution", "'nan'"}},
       {n + "--restitution 0.9 --contact-time 0", kUsage, {"contact time", "greater than 0"}},
       {n + "--restitution 0.9 --contact-time 1e-200", kUsage, {"--contact-time", "1e-200", "no stiffness"}},
       {n + "--restitution 0.9", kUsage, {"exactly one of the two pairs"}},
       {n + "--restitution 0.9 --contact-time 0.1 --k-n 3", kUsage, {"exactly one of the two pairs"}},
       {n + "--k-n -1 --gamma-n 3", kUsage, {"--k-n", "above 0"}},
       {n + "--k-n nan --gamma-n 3", kUsage, {"--k-n", "'nan'"}},
       {n + "--k-n 1e6 --gamma-n -3", kUsage, {"--gamma-n", "0 or above"}},
       {n + "--k-n 1e6 --gamma-n 100 --m-eff nan", kUsage, {"--m-eff", "'nan'"}},
       {n + "--k-n 1e6 --gamma-n 100 --m-eff 0", kUsage, {"--m-eff", "above 0"}},
       {"calibrate contacts collisions @t.h5 --gravity nan", kUsage, {"--gravity", "'nan'"}},
       {"calibrate contacts collisions @t.h5 --least-speed nan", kUsage, {"--least-speed", "'nan'"}},
       {"calibrate contacts collisions @t.h5 --least-speed -1", kUsage, {"--least-speed", "0 or above"}},
       {"calibrate contacts collisions @t.h5 --shape cube", kUsage, {"--shape", "cube", "disc"}},
       {"calibrate contacts collisions @s.toml", kInput, {"s.toml", "not an HDF5 file"}},
       {"calibrate contacts collisions @noframes.h5", kInput, {"noframes.h5", "0 frames"}},
       {"calibrate contacts collisions @nobeads.h5", kInput, {"nobeads.h5", "impacts"}}});
}

TEST_F(Refusals, Infer) {
  const std::string i = "calibrate contacts infer ", film = i + "@t.h5 --scene @s.toml ",
                    mu = "--vary contact.mu=0.1:0.9 ", onset = i + "--scene @s.toml " + mu + "--onset ";
  expect({{i + "--scene @s.toml " + mu, kUsage, {"--onset", "trajectory"}},
          {i + "@t.h5 " + mu, kUsage, {"--scene is required"}},
          {i + "@s.toml --scene @s.toml " + mu, kInput, {"s.toml", "not an HDF5 file"}},
          {i + "@t.h5 --scene @t.h5 --observables s_b " + mu, kInput, {"t.h5", "not a TOML file"}},
          {i + "@noframes.h5 --scene @s.toml " + mu, kInput, {"noframes.h5", "no frame"}},
          {film, kUsage, {"--vary is required"}},
          {film + "--vary contact.mu", kUsage, {"--vary", "key=low:high"}},
          {film + "--vary contact.mu=0.9:0.1", kUsage, {"--vary", "low must be below high"}},
          {film + "--vary contact.mu=0.1:nan", kUsage, {"--vary", "key=low:high"}},
          {film + "--vary contact.mu=a:b", kUsage, {"--vary", "key=low:high"}},
          {film + "--vary contact.mux=0.1:0.9 --observables s_b",
           kUsage,
           {"contact.mux", "did you mean 'contact.mu'"}},
          {film + "--vary contact.mu=-1:0.9 --observables s_b", kUsage, {"contact.mu", "at least 0"}},
          {film + mu + "contact.mu=0.2:0.8", kUsage, {"names contact.mu twice"}},
          {film + mu + "--set contact.mu=0.3", kUsage, {"--vary", "contact.mu", "--set"}},
          {film + "--vary a=0:1 b=0:1 c=0:1 d=0:1", kUsage, {"4 parameters", "at most 3"}},
          {film + "--vary start.seed=1:9", kUsage, {"--vary", "start.seed"}},
          {film + mu + "--runs 4", kUsage, {"--runs", "5"}},
          {film + mu + "--runs many", kUsage, {"--runs", "'many'", "whole number"}},
          {film + mu + "--observables onset", kUsage, {"--observables", "--onset"}},
          {film + mu + "--observables phase", kUsage, {"--observables", "neither a number nor a curve"}},
          {film + mu + "--observables nothing",
           kUsage,
           {"--observables: there is no result called \"nothing\""}},
          {film + mu + "--observables s_b,s_b", kUsage, {"--observables", "names s_b twice"}},
          {film + mu + "--observables s_b --discard -1", kUsage, {"--discard", "-1"}},
          {film + mu + "--observables s_b --discard 99", kUsage, {"discard", "99 cycles"}},
          {onset + "bouncing", kUsage, {"--onset", "GAMMA+-ERROR"}},
          {onset + "bouncing=1.2", kUsage, {"--onset", "GAMMA+-ERROR"}},
          {onset + "bouncing=nan+-0.1", kUsage, {"--onset", "GAMMA+-ERROR"}},
          {onset + "bouncing=1.2+-x", kUsage, {"--onset", "GAMMA+-ERROR"}},
          {onset + "melting=1.2+-0.1", kUsage, {"--onset", "neither bouncing nor convecting"}},
          {onset + "bouncing=-1.2+-0.1", kUsage, {"--onset", "above 0"}},
          {onset + "bouncing=1.2+--0.1", kUsage, {"--onset", "at least 0"}},
          {onset + "bouncing=1.2+-0.1 --onset bouncing=1.4+-0.1",
           kUsage,
           {"--onset", "onset of bouncing twice"}},
          {i + "--scene @s.toml --vary drive.gamma=1:2 --onset bouncing=1.2+-0.1",
           kUsage,
           {"--vary", "drive.gamma", "--onset"}}});
}

TEST_F(Refusals, NumbersInOptions) {
  const std::string film = "locate @mixed --diameter ", sim = "simulate @s.toml -o @new.h5 ",
                    analyze = "analyze @t.h5 ", render = "render @t.h5 -o @new ";
  expect(
      {{film + "nan -o @new.csv", kUsage, {"--diameter", "'nan'"}},
       {film + "12,nan -o @new.csv", kUsage, {"--diameter"}},
       {film + "0 -o @new.csv", kUsage, {"--diameter", "3"}},
       {film + "12px -o @new.csv", kUsage, {"--diameter", "'12px'"}},
       {"track @mixed -o @new.h5 --frames-per-cycle -3", kUsage, {"--frames-per-cycle", "0 to 100000"}},
       {"track @mixed -o @new.h5 --frames-per-cycle 1000000000",
        kUsage,
        {"--frames-per-cycle", "0 to 100000"}},
       {"track @mixed -o @new.h5 --memory 1.5", kUsage, {"--memory", "whole number"}},
       {"track @mixed -o @new.h5 --cell-width nan", kUsage, {"--cell-width", "'nan'"}},
       {"track @mixed -o @new.h5 --drive-gamma nan", kUsage, {"--drive-gamma", "'nan'"}},
       {"track @mixed -o @new.h5 --truth @beads.csv --scored-rows 9 3", kUsage, {"--scored-rows", "9", "3"}},
       {"track @mixed -o @new.h5 --scored-rows 3 9", kUsage, {"--scored-rows", "--truth"}},
       {"locate @mixed -o @new.csv --scored-rows 3 9", kUsage, {"--scored-rows", "--truth"}},
       {"draw @t.h5 -o @new.html --fps 0", kUsage, {"--fps", "0.01"}},
       {"export @s.toml --to lammps --units mm -o @new", kUsage, {"--units", "trajectory"}},
       {"export @s.toml --to lammps --complete -o @new", kUsage, {"--complete", "trajectory"}},
       {"export @t.h5 --to xyz --seed 3 -o @new.xyz", kUsage, {"--seed", "scene"}},
       {"analyze @t.h5 --seed 3", kUsage, {"--seed"}},
       {"locate @mixed -o @mixed/new.png", kUsage, {"new.png", "is an input", "one of its frames"}},
       {"locate @mixed -o @new.csv --candidates @mixed/new.TIF", kUsage, {"new.TIF", "is an input"}},
       {sim + "--threads -1", kUsage, {"--threads", "0 to 4096"}},
       {sim + "--threads 2.5", kUsage, {"--threads", "whole number"}},
       {sim + "--seed -1", kUsage, {"--seed", "'-1'", "whole number"}},
       {sim + "--seed 1e3", kUsage, {"--seed", "'1e3'", "whole number"}},
       {sim + "--seed 99999999999999999999", kUsage, {"--seed", "whole number"}},
       {sim + "-j 0", kUsage, {"-j"}},
       {sim + "--set nonsense", kUsage, {"--set", "section.key=value"}},
       {sim + "--set =3", kUsage, {"--set", "section.key=value"}},
       {sim + "--set beads.count=1e3", kUsage, {"beads.count", "not a number with a decimal point"}},
       {sim + "--set beads.count=-1", kUsage, {"beads.count", "at least 0"}},
       {sim + "--set beads.count=99999999999", kUsage, {"beads.count", "at most"}},
       {sim + "--set beads=3", kUsage, {"beads", "a table is needed, not an integer"}},
       {sim + "--set beads.radius=1,5", kUsage, {"beads.radius", "a number is needed"}},
       {sim + "--set cell.width=-4", kUsage, {"cell.width", "greater than 0"}},
       {sim + "--set drive.gamma=1.5 --set drive.gamma=2", kUsage, {"drive.gamma", "set twice"}},
       {analyze + "--discard 1e3", kUsage, {"--discard", "whole number"}},
       {analyze + "--discard 5", kUsage, {"discard", "5 cycles"}},
       {analyze + "--cycles -1", kUsage, {"cycles", "-1"}},
       {analyze + "--cycles 4", kUsage, {"t.h5", "4 cycles were requested", "has 3"}},
       {analyze + "--discard 1 --cycles 3", kUsage, {"3 cycles were requested", "has 2 after the skipped"}},
       {analyze + "--cutoff nan", kUsage, {"--cutoff", "'nan'"}},
       {analyze + "--tracer-band nan,3", kUsage, {"--tracer-band", "'nan'"}},
       {analyze + "--tracer-band 3,1", kUsage, {"tracer_band", "low must be below high"}},
       {analyze + "--tracers 99", kUsage, {"tracers", "0 to 10"}},
       {analyze + "--only nothing", kUsage, {"nothing"}},
       {render + "--pixels-per-sigma nan", kUsage, {"--pixels-per-sigma", "'nan'"}},
       {render + "--pixels-per-sigma 1e12", kUsage, {"pixels-per-sigma", "at most 400"}},
       {render + "--margin -3", kUsage, {"margin", "at least 0"}},
       {"compare --simulation @t.h5 -o @new --tolerance nan", kUsage, {"--tolerance", "'nan'"}},
       {"compare --simulation @t.h5 @t.h5 -o @new", kUsage, {"--simulation", "t.h5", "same run"}},
       {"export @s.toml --to lammps -o @new --from @t.h5 --frame -1", kUsage, {"--frame", "'-1'"}},
       {"match @mixed @s.toml -o @new --twins 0", kUsage, {"--twins", "1 to 1000"}},
       {"reproduce p1-fig1 -o @new --budget nan", kUsage, {"--budget", "'nan'"}},
       {"sweep run @s.toml --folder @new --shard 0/2", kUsage, {"s.toml", "scene"}}});
}

// The libraries name an option by its key, and a file may have that name.
TEST_F(Refusals, AFileWithTheNameOfAnOption) {
  expect({{"analyze only", kInput, {"twincell: only: the file does not exist"}},
          {"track frames -o @new.h5 --cell frames", kInput, {"twincell: frames: the file does not exist"}},
          {"draw @t.h5 -o .",
           kUsage,
           {"twincell: .: the output is a folder where a file is to be written.\n"}}});
}

// What belongs to another output, another number of stacks, another dimension or another side.
TEST_F(Refusals, WordsThatDoNotGoTogether) {
  const std::string film = "locate @mixed -o @new.csv ", table = "import @deep.csv --timestep 1 -o @new.h5 ";
  expect(
      {{"draw @t.h5 -o @new.png --fps 10", kUsage, {"--fps", "picture"}},
       {"render @t.h5 -o @new --fps 10", kUsage, {"--fps", "--movie"}},
       {film + "--frame 1", kUsage, {"--frame", "--overlay"}},
       {film + "--view @new.png", kUsage, {"--view", ".html", "--overlay"}},
       {film + "--overlay @mixed/o.png", kUsage, {"o.png", "is an input", "one of its frames"}},
       {film + "--diameter 12,13", kUsage, {"--diameter", "decimal point, 12.13", "several as 12 13"}},
       {"analyze @t.h5 --only nothing", kUsage, {"--only: there is no result"}},
       {"analyze @t.h5 --table @new.csv", kUsage, {"--table", "--window-cycles"}},
       {"analyze @t.h5 --window-cycles 1 -o @new.h5", kUsage, {"--output", "--table"}},
       {"analyze @t.h5 --window-cycles 1 --cycles 2", kUsage, {"--cycles", "windows"}},
       {"analyze @t.h5 --window-cycles 999", kUsage, {"no window of 999 cycles fits"}},
       {"draw @t.h5 -o @new.html --contacts", kUsage, {"--contacts", "simulate --contacts"}},
       {"draw @t.h5 -o @new.html --pixels-per-sigma 3", kUsage, {"--pixels-per-sigma", "page"}},
       {"draw @t.h5 -o @new.htm", kUsage, {"--output", ".html"}},
       {"new @mixed @folder -o @new --drive-gamma 2", kUsage, {"--drive-gamma", "2 stacks", "--drive-hz"}},
       {"import @t.h5 -o @new.h5", kUsage, {"t.h5", "already"}},
       {"import @g.csv -o @new.h5", kInput, {"g.csv:1", "no column 'frame'"}},
       {"import @beads.csv -o @new.h5", kInput, {"beads.csv:1", "'particle'", "track"}},
       {"import @text.png -o @new.h5", kUsage, {"text.png", "--format", "'ITEM:'", "csv"}},
       {table + "--dimension 3", kUsage, {"--cell-origin", "y of this file increases downwards"}},
       {table, kInput, {"deep.csv:3", "z = 0.7", "--dimension 3"}},
       {table + "--columns y=x", kUsage, {"--columns", "'x' is both x and y"}},
       {"sweep status @folder", kUsage, {"folder", "plan", "--folder"}},
       {"compare --experiment @t.h5 --simulation @link.h5 -o @new", kUsage, {"link.h5", "same run"}},
       {"compare --experiment @t.h5 --simulation @copy.h5 -o @new", kUsage, {"copy.h5", "same run"}},
       {"compare --simulation @t.h5 @deep.h5 -o @new", kUsage, {"--simulation", "has 3 dimensions", "has 2"}},
       {"sweep plan @nothing.toml --folder @new", kUsage, {"results", "empty"}}});
}

TEST_F(Refusals, FilesOfAnotherKind) {
  std::vector<Refusal> table = {
      {"simulate @doubled.toml -o @new.h5", kUsage, {"doubled.toml:3", "gamma"}},
      {"track @mixed -o @new.h5 --diameter 12 --frames-per-cycle 3",
       kInput,
       {"f2.png", "60 x 64", "one size"}},
      {"locate @text.png -o @new.csv", kInput, {"text.png"}},
      {"compare --simulation @t.h5 --sweep @empty -o @new", kInput, {"empty", "is not JSON"}},
      {"compare --simulation @t.h5 --sweep @t.h5 -o @new", kInput, {"is not JSON"}},
      {"compare --simulation @noframes.h5 -o @new", kInput, {"noframes.h5", "no frame"}},
      {"render @noframes.h5 -o @new", kInput, {"noframes.h5", "no frame"}},
      {"analyze @noframes.h5", kInput, {"noframes.h5", "no frame"}},
      {"analyze @noframes.h5 --window-cycles 1", kInput, {"noframes.h5", "no frame"}},
      {"draw @noframes.h5 -o @new.html", kUsage, {"noframes.h5", "no frames"}},
      // The output is an input, through a link, a hard link and dots.
      {"analyze @t.h5 -o @link.h5", kUsage, {"link.h5", "input of the same command"}},
      {"analyze @link.h5 -o @t.h5", kUsage, {"t.h5", "input of the same command"}},
      {"analyze @t.h5 -o @folder/../t.h5", kUsage, {"input of the same command"}},
      {"calibrate contacts bounce @g.csv -o @link.csv", kUsage, {"link.csv", "input of the same command"}},
      {"simulate @s.toml -o @s.toml --force", kUsage, {"input of the same command"}}};
  // A binary file, and a folder, where a text is meant.
  for (const std::string verb : {"simulate", "measure", "explain"}) {
    const std::string out = verb == "simulate" ? " -o @new.h5" : "";
    table.push_back({verb + " @t.h5" + out, kInput, {"t.h5", "not a TOML file"}});
    table.push_back({verb + " @folder" + out, kInput, {"folder", "this is a folder"}});
    table.push_back({verb + " @empty" + out, kUsage, {"empty", "drive"}});
  }
  for (const std::string verb : {"sweep run", "sweep plan", "sweep status", "sweep collect"})
    table.push_back({verb + " @t.h5 --folder @new", kInput, {"t.h5", "not a TOML file"}});
  // A text, and a folder, where a trajectory is meant.
  for (const std::string verb : {"analyze", "validate", "info"})
    table.push_back({verb + " @text.h5", kInput, {"text.h5"}});
  for (const std::string verb : {"analyze", "validate", "render -o @new"})
    table.push_back({verb + " @folder", kInput, {"this is a folder"}});
  // A trajectory where frames are meant, and reverse.
  for (const std::string verb : {"locate -o @new.csv", "calibrate camera", "calibrate plate"})
    table.push_back({verb + " @t.h5", kInput, {"t.h5", "is a trajectory"}});
  table.push_back({"match @mixed @t.h5 -o @new", kUsage, {"CELL.toml", "does not exist"}});
  table.push_back({"match @t.h5 @folder -o @new", kUsage, {"CELL.toml", "does not exist"}});
  expect(table);
}

// CELL.toml with one line replaced: the message names the line and the key.
TEST_F(Refusals, CellDescriptions) {
  const TemporaryFolder folder;
  struct Line {
    std::string from, to, said;
  };
  for (const auto& [from, to, said] :
       {Line{"pixels_per_sigma = 12", "pixels_per_sigma = -12", "cell.toml:2:20: camera.pixels_per_sigma"},
        {"pixels_per_sigma = 12", "pixels_per_sigma = 0", "cell.toml:2:20: camera.pixels_per_sigma"},
        {"origin_px = [20, 50]", "origin_px = [20]", "cell.toml:3:13: camera.origin_px"},
        {"origin_px = [20, 50]", "origin_px = [1e300, 50]", "cell.toml:3:13: camera.origin_px"},
        {"frames_per_cycle = 3", "frames_per_cycle = 3.5", "cell.toml:4:20: camera.frames_per_cycle"},
        {"frames_per_cycle = 3", "frames_per_cycle = -1", "cell.toml:4:20: camera.frames_per_cycle"},
        {"width = 4", "width = 0", "cell.toml:6:9: cell.width"},
        {"width = 4", "width = 1e300", "cell.toml:6:9: cell.width"},
        {"width = 4", "width = \"4 sigma\"", "cell.toml:6:9: cell.width"},
        {"height = 4", "height = -4", "cell.toml:7:10: cell.height"},
        {"\"walls\"", "\"wall\"", "'wall' is not one of walls, periodic, open"},
        {"amplitude = 1.5", "amplitude = -1", "cell.toml:10:13: drive.amplitude"},
        {"amplitude = 1.5", "amplitude = nan", "cell.toml:10:13: drive.amplitude"},
        {"omega = 1", "omega = 0", "cell.toml:11:9: drive.omega"},
        {"omega = 1", "omega = 1e300", "cell.toml:11:9: drive.omega"},
        {"omega = 1", "omega = 1\nomega = 2", "cell.toml:12"},
        {"omega = 1", "Omega = 1", "did you mean 'drive.omega'"}}) {
    std::string text =
        "[camera]\npixels_per_sigma = 12\norigin_px = [20, 50]\nframes_per_cycle = 3\n[cell]\nwidth = 4\n"
        "height = 4\nsides = \"walls\"\n[drive]\namplitude = 1.5\nomega = 1\n";
    text.replace(text.find(from), from.size(), to);
    put_file(folder / "cell.toml", text);
    const Ran ran =
        run_program({"track", at("mixed"), "--cell", folder / "cell.toml", "-o", folder / "o.h5", "-q"});
    EXPECT_EQ(ran.code, kUsage) << to << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    EXPECT_NE(ran.err.find(said), std::string::npos) << to << ": " << ran.err;
  }
}

// Trajectories at the edge of what is one: no frame, no bead, one frame, one bead. No verb crashes on them.
TEST_F(Refusals, SmallestTrajectories) {
  TemporaryFolder folder;
  const auto all = test::rigid_bed({.gamma = 1.5, .columns = 1, .rows = 1, .phases = 20, .cycles = 2});
  const auto bed = test::rigid_bed({.gamma = 1.5, .columns = 4, .rows = 3, .phases = 20, .cycles = 1});
  MemoryTrajectory one_frame(bed.info());
  one_frame.append(bed.frames().front());
  const auto write = [&](const char* name, const MemoryTrajectory& run) {
    H5mdWriter writer(folder / name, run.info());
    for (const Frame& frame : run.frames()) writer.append(frame);
    writer.finish();
  };
  write("one-bead.h5", all);
  write("one-frame.h5", one_frame);
  const std::vector<std::string> files = {folder / "one-bead.h5", folder / "one-frame.h5", at("nobeads.h5"),
                                          at("noframes.h5")};
  int n = 0;
  for (const std::string& file : files)
    for (std::vector<std::string> words :
         {std::vector<std::string>{"info", file},
          {"validate", file},
          {"analyze", file},
          {"render", file, "-o", "NEW"},
          {"render", file, "--movie", "NEW.avi"},
          {"compare", "--simulation", file, "-o", "NEW"},
          {"compare", "--experiment", file, "-o", "NEW"},
          {"calibrate", "contacts", "bounce", file},
          {"calibrate", "contacts", "collisions", file},
          {"export", at("s.toml"), "--to", "lammps", "-o", "NEW", "--from", file}}) {
      for (std::string& word : words)
        if (word.starts_with("NEW")) word = folder / ("new" + std::to_string(++n) + word.substr(3));
      words.emplace_back("-q");
      const Ran ran = run_program(words);
      SCOPED_TRACE(words[0] + " " + words[1] + " " + fs::path(file).filename().string());
      EXPECT_TRUE(ran.code == 0 || ran.code == kUsage || ran.code == kInput) << ran.code << ran.err;
      if (ran.code != 0) {
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
      }
      EXPECT_EQ(ran.err.find("internal error"), std::string::npos) << ran.err;
    }
}

}  // namespace
}  // namespace twincell::refusals_test
