// Sweeps as a user meets them: the collected file is the same regardless of which process computes the points
// and how often it is stopped.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>

#include "tests/support/file_bytes.hpp"
#include "tests/support/program.hpp"

namespace twincell::sweep_test {
namespace {

namespace fs = std::filesystem;

constexpr int kDone = 0, kUsage = 2, kInput = 3, kPartial = 5;

constexpr const char* kScene = R"(
[scene]
preset = "fortini-huang-2015"
cell.width = 6.0
beads.layers = 3
time = { integrator = "split", steps_per_contact = 6.37, discard = 1, cycles = 4, phases = 10 }
)";

class Sweeps : public ::testing::Test {
 protected:
  Sweeps() {
    write(grid_,
          "seed = 7\nresults = [\"s_b\", \"s_c\", \"phase\"]\n" + std::string(kScene) +
              "[axes]\ndrive.gamma = [1.05, 1.6]\nstart.kind = [\"random\", \"crystal_a\"]\nseeds = 2\n");
  }

  static void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }
  static Ran run(const std::string& plan, const std::string& into,
                 const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"sweep", "run", plan, "--folder", into, "-q"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }
  /// Text that `collect` writes for a folder.
  static std::string collected(const std::string& plan, const std::string& folder) {
    const std::string out = folder + ".json";
    const Ran ran = run_program({"sweep", "collect", plan, "--folder", folder, "-o", out, "-q"});
    EXPECT_EQ(ran.code, kDone) << ran.err;
    return bytes_of(out) + bytes_of(folder + ".csv");
  }

  TemporaryFolder folder_;
  std::string grid_ = folder_ / "grid.toml";
};

TEST_F(Sweeps, OneCoreTwoCoresShardsAndRanksGiveTheSameBytes) {
  ASSERT_EQ(run(grid_, at("one"), {"--threads", "1"}).code, kDone);
  const std::string one = collected(grid_, at("one"));
  const auto document = nlohmann::json::parse(bytes_of(at("one.json")));
  ASSERT_EQ(document["points"].size(), 6U);  // another seed does not change the crystal
  EXPECT_EQ(document["open"], 0);
  for (const auto& point : document["points"]) {
    EXPECT_TRUE(point["results"]["s_b"].contains("value")) << point;
    EXPECT_FALSE(point.contains("computed"));
  }

  ASSERT_EQ(run(grid_, at("two"), {"--threads", "2"}).code, kDone);
  EXPECT_EQ(collected(grid_, at("two")), one);
  for (const char* shard : {"3/3", "1/3", "2/3"})
    ASSERT_EQ(run(grid_, at("parts"), {"--shard", shard}).code, kDone);
  EXPECT_EQ(collected(grid_, at("parts")), one);
}

TEST_F(Sweeps, ASweepEndsInItsPictureAndPlotDrawsOtherResults) {
  const Ran ran = run_program({"sweep", "run", grid_, "--folder", at("one")});
  ASSERT_EQ(ran.code, kDone) << ran.err;
  EXPECT_NE(ran.out.find("picture: " + at("one/figures/sweep.svg")), std::string::npos) << ran.out;
  // The table of the grid: the crystal has one run, because the seed does not change it.
  EXPECT_NE(ran.out.find("drive.gamma  start.kind  runs  phase"), std::string::npos) << ran.out;
  EXPECT_TRUE(std::regex_search(ran.out, std::regex(R"(\n1\.6 +random +2 +bouncing +\d\S* \.\.\. \d)")))
      << ran.out;
  EXPECT_TRUE(std::regex_search(ran.out, std::regex(R"(\n1\.05 +crystal_a +1 +co-moving +\d\S* +\d)")))
      << ran.out;
  const std::string drawn = bytes_of(at("one/figures/sweep.dat"));
  // s_c of two drives and two starts, the random one with the interval of its two seeds.
  EXPECT_NE(drawn.find("1.05 "), std::string::npos) << drawn;
  EXPECT_NE(drawn.find("1.6 "), std::string::npos) << drawn;
  const Ran plot = run_program({"sweep", "plot", grid_, "--folder", at("one"), "--figures", at("s_b"),
                                "--result", "s_b", "--over", "drive.gamma", "start.kind"});
  ASSERT_EQ(plot.code, kDone) << plot.err;
  const std::string name = "sweep-s_b-over-drive.gamma-start.kind";
  EXPECT_NE(bytes_of(at("s_b/" + name + ".gp")).find("start.kind = \"random\""), std::string::npos);
  // In the folder of the sweep, the picture of one result leaves that of another as it is.
  ASSERT_EQ(run_program({"sweep", "plot", grid_, "--folder", at("one"), "--result", "s_b"}).code, kDone);
  EXPECT_NE(bytes_of(at("one/figures/sweep-s_b.dat")), drawn);
  EXPECT_EQ(bytes_of(at("one/figures/sweep.dat")), drawn);
  write(at("one/figures/sweep-s_c.svg"), "of the user");
  const Ran foreign = run_program({"sweep", "plot", grid_, "--folder", at("one"), "--result", "s_c"});
  EXPECT_EQ(foreign.code, kUsage);
  EXPECT_NE(foreign.err.find("'sweep-s_c.svg' in it was not written by twincell"), std::string::npos)
      << foreign.err;
  const Ran wrong = run_program({"sweep", "plot", grid_, "--folder", at("one"), "--result", "s_d"});
  EXPECT_EQ(wrong.code, kUsage);
  EXPECT_NE(wrong.err.find("it has s_b, s_c"), std::string::npos) << wrong.err;
}

// No order of placing discs at random fills more than 0.55 of an area.
TEST_F(Sweeps, ABedThatCannotBePlacedIsTheResultOfItsPointAndTheOthersRun) {
  const std::string plan = at("dense.toml");
  write(plan, R"(results = ["T_g"]
[scene]
preset = "fortini-huang-2015"
cell = { width = 8.0, height = 8.0, lid = "wall", gravity = 0 }
drive = { amplitude = 0.1, omega = 1.0 }
time = { integrator = "split", steps_per_contact = 6.37, discard = 1, cycles = 4, phases = 10 }
[axes]
start.kind = ["random"]
beads.count = [12, 60]
)");
  const Ran ran = run_program({"sweep", "run", plan, "--folder", at("dense")});
  ASSERT_EQ(ran.code, kDone) << ran.err;
  EXPECT_NE(ran.out.find("failed (1): beads.count: 60 beads cannot be placed at random"), std::string::npos)
      << ran.out;
  (void)collected(plan, at("dense"));
  const auto points = nlohmann::json::parse(bytes_of(at("dense.json")))["points"];
  ASSERT_EQ(points.size(), 2U);
  EXPECT_TRUE(points[0]["results"]["T_g"]["value"].is_number()) << points[0];
  EXPECT_NE(points[1]["failed"].get<std::string>().find("60 beads cannot be placed at random"),
            std::string::npos)
      << points[1];
  EXPECT_FALSE(points[1].contains("results"));
}

TEST_F(Sweeps, CompareDrawsTheDiagramOfASweepAlone) {
  ASSERT_EQ(run(grid_, at("one")).code, kDone);
  (void)collected(grid_, at("one"));
  // The files of the points are its input, whatever --force says.
  for (const std::string place : {"one/points/new.json", "one/points/../points/new.json"}) {
    const Ran among =
        run_program({"sweep", "collect", grid_, "--folder", at("one"), "-o", at(place), "--force"});
    EXPECT_EQ(among.code, 2) << among.out;
    EXPECT_NE(among.err.find("is among the points of the sweep in"), std::string::npos) << among.err;
  }
  const Ran ran = run_program({"compare", "--sweep", at("one.json"), "-o", at("report")});
  ASSERT_EQ(ran.code, kDone) << ran.err;
  EXPECT_NE(ran.out.find("points of a sweep"), std::string::npos) << ran.out;
  EXPECT_NE(bytes_of(at("report/report.html")).find("points of a sweep"), std::string::npos);
  EXPECT_GT(fs::file_size(at("report/figures/boundaries.svg")), 1000U);
  EXPECT_EQ(run_program({"compare", "-o", at("none"), "-q"}).code, kUsage);
}

TEST_F(Sweeps, RanksOfMpiGiveTheSameBytes) {
  if (std::system("command -v mpirun >/dev/null 2>&1") != 0) GTEST_SKIP() << "mpirun is not there";
  ASSERT_EQ(run(grid_, at("one"), {"--threads", "1"}).code, kDone);
  const std::string line =
      "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -n 3 " +
      std::string(TWINCELL_PROGRAM) + " sweep run " + grid_ + " --folder " + at("ranks") + " -q --mpi >" +
      at("log") + " 2>&1";
  const int status = std::system(line.c_str());
  if (bytes_of(at("log")).find("built without MPI") != std::string::npos) GTEST_SKIP() << "built without MPI";
  ASSERT_EQ(WEXITSTATUS(status), kDone) << bytes_of(at("log"));
  EXPECT_EQ(collected(grid_, at("ranks")), collected(grid_, at("one")));
}

/// Runs a template's script in a shell that finds the program. \returns its exit code
int run_script(const std::string& script, const std::string& before, const fs::path& folder) {
  const std::string file = folder / "script.sh";
  std::ofstream(file) << script;
  const std::string line = "PATH=" + fs::path(TWINCELL_PROGRAM).parent_path().string() +
                           ":$PATH; export PATH; " + before + " bash " + file + " >" + file + ".log 2>&1";
  return WEXITSTATUS(std::system(line.c_str()));
}

TEST_F(Sweeps, TheTemplatesOfGnuParallelAndOfSlurmGiveTheSameBytes) {
  ASSERT_EQ(run(grid_, at("one"), {"--threads", "1"}).code, kDone);
  const std::string one = collected(grid_, at("one"));
  const auto script = [&](const char* engine, const std::string& folder) {
    const Ran ran = run_program({"sweep", "template", engine, grid_, "--folder", folder, "--jobs", "3"});
    EXPECT_EQ(ran.code, kDone) << ran.err;
    return ran.out;
  };
  // Slurm runs an array of three by calling the script once with each number.
  const std::string array = script("slurm", at("array"));
  EXPECT_NE(array.find("#SBATCH --array=1-3"), std::string::npos) << array;
  for (const char* task : {"2", "1", "3"})
    ASSERT_EQ(run_script(array, "SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_ID=" + std::string(task),
                         folder_.path()),
              kDone)
        << bytes_of(at("script.sh.log"));
  EXPECT_EQ(collected(grid_, at("array")), one);
  if (std::system("parallel --version 2>/dev/null | grep -q GNU") != 0)
    GTEST_SKIP() << "GNU parallel is not there";
  ASSERT_EQ(run_script(script("parallel", at("parallel")), "", folder_.path()), kDone)
      << bytes_of(at("script.sh.log"));
  EXPECT_EQ(collected(grid_, at("parallel")), one);
}

TEST_F(Sweeps, KilledAgainAndAgainNothingIsLostAndNothingDoneTwice) {
  ASSERT_EQ(run(grid_, at("whole")).code, kDone);
  std::mt19937 random(20150101);
  const auto results = [&] {
    // The text includes the seconds of each point, which would differ if the point were computed again.
    std::map<std::string, std::string> all;
    if (fs::exists(at("k") + "/points"))
      for (const auto& point : fs::directory_iterator(at("k") + "/points"))
        if (fs::exists(point.path() / "result.json"))
          all[point.path().filename()] = bytes_of(point.path() / "result.json");
    return all;
  };
  int killed = 0;
  for (int k = 0; k < 200; ++k) {
    const auto before = results();
    FolderEvents changes(folder_.path());
    RunningProgram program({"sweep", "run", grid_, "--folder", at("k"), "-q", "--threads", "2"});
    const std::size_t last = 10 + random() % 60;  // of the changes of files of this run
    for (std::size_t seen = 0, more = 1; seen < last && more > 0; seen += more)
      more = changes.wait(program.id());
    program.signal(SIGKILL);
    const Ran ran = program.wait();
    const auto after = results();
    for (const auto& [id, text] : before) EXPECT_EQ(after.at(id), text) << "computed twice, or lost";
    for (const auto& [id, text] : after)
      EXPECT_TRUE(nlohmann::json::accept(text)) << "half a result of " << id;
    if (ran.code == 0) break;
    ++killed;
  }
  EXPECT_GE(killed, 1);
  EXPECT_EQ(run(grid_, at("k")).code, kDone);
  EXPECT_EQ(collected(grid_, at("k")), collected(grid_, at("whole")));
}

TEST_F(Sweeps, TwoProcessesInOneFolderShareTheWork) {
  RunningProgram first({"sweep", "run", grid_, "--folder", at("both"), "-q", "--threads", "1"}),
      second({"sweep", "run", grid_, "--folder", at("both"), "-q", "--threads", "1"});
  EXPECT_EQ(first.wait().code, kDone);
  EXPECT_EQ(second.wait().code, kDone);
  ASSERT_EQ(run(grid_, at("one")).code, kDone);
  EXPECT_EQ(collected(grid_, at("both")), collected(grid_, at("one")));
}

TEST_F(Sweeps, AFullDiskIsOneSentenceAndTheSweepGoesOn) {
  struct rlimit usual {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &usual), 0);
  for (const rlim_t bytes : {rlim_t{400}, rlim_t{800}}) {  // no room for a scene; no room for a result
    const rlimit limit{bytes, usual.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const Ran ran = run(grid_, at("f"));
    ::setrlimit(RLIMIT_FSIZE, &usual);
    EXPECT_EQ(ran.code, kPartial) << bytes;
    EXPECT_NE(ran.err.find("the same command continues"), std::string::npos) << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
  EXPECT_EQ(run(grid_, at("f")).code, kDone);
  ASSERT_EQ(run(grid_, at("one")).code, kDone);
  EXPECT_EQ(collected(grid_, at("f")), collected(grid_, at("one")));
}

TEST_F(Sweeps, ASearchBracketsTheOnsetOfBouncingWhateverTheEngine) {
  const std::string plan = at("search.toml");
  write(plan, "seed = 3\nresults = [\"s_b\"]\n" + std::string(kScene) +
                  "start.perturbation = 1e-9\n[search]\nverdict = \"bouncing\"\nrange = [1.0, 1.6]\nwidth = "
                  "0.1\nruns = 20\n");
  ASSERT_EQ(run(plan, at("s"), {"--threads", "1"}).code, kDone);
  const std::string one = collected(plan, at("s"));
  const auto document = nlohmann::json::parse(bytes_of(at("s.json")));
  ASSERT_EQ(document["onsets"].size(), 1U);
  const auto& onset = document["onsets"][0];
  EXPECT_TRUE(onset["complete"]);
  // A completely inelastic rigid bed crosses s_b = sigma/30 at Gamma = 1.1636; a bed of beads does so nearby.
  EXPECT_GT(onset["value"], 1.06);
  EXPECT_LT(onset["value"], 1.30);
  EXPECT_LT(onset["low"], onset["value"]);
  EXPECT_GT(onset["high"], onset["value"]);
  ASSERT_EQ(run(plan, at("t"), {"--threads", "2"}).code, kDone);
  EXPECT_EQ(collected(plan, at("t")), one);
}

TEST_F(Sweeps, AShortSearchAnEditedSceneAndDecimalCommasAreNamed) {
  const std::string plan = at("search.toml");
  const auto search = [&](const char* perturbation) {
    write(plan, "results = [\"s_b\"]\n" + std::string(kScene) + "start.perturbation = " + perturbation +
                    "\n[search]\nverdict = \"bouncing\"\nrange = [1.0, 1.6]\nwidth = 0.02\nruns = 4\n");
  };
  search("1e-9");
  const Ran short_of = run_program({"sweep", "run", plan, "--folder", at("s")});
  ASSERT_EQ(short_of.code, kDone) << short_of.err;
  EXPECT_NE(short_of.out.find("; not within search.width = 0.02 after search.runs = 4"), std::string::npos)
      << short_of.out;
  search("2e-9");
  const Ran status = run_program({"sweep", "status", plan, "--folder", at("s")});
  ASSERT_EQ(status.code, kDone) << status.err;
  EXPECT_NE(status.err.find("4 results of another scene, seed or plan are there and are not used"),
            std::string::npos)
      << status.err;
  const std::string commas = at("commas.toml");
  write(commas, std::string(kScene) + "[axes]\ndrive.gamma = [1,5, 2,0]\n");
  const Ran planned = run_program({"sweep", "plan", commas, "--folder", at("c")});
  EXPECT_EQ(planned.code, kDone) << planned.err;
  EXPECT_NE(planned.err.find("the 4 values 1; 5; 2; 0 do not ascend"), std::string::npos) << planned.err;
}

TEST_F(Sweeps, WhereNothingFlipsTheOnsetIsALimit) {
  const std::string plan = at("none.toml");
  write(plan, "results = [\"s_b\"]\n" + std::string(kScene) +
                  "[search]\nverdict = \"bouncing\"\nrange = [0.5, 0.9]\nwidth = 0.2\nruns = 12\n");
  ASSERT_EQ(run(plan, at("n")).code, kDone);
  collected(plan, at("n"));
  const auto onset = nlohmann::json::parse(bytes_of(at("n.json")))["onsets"][0];
  EXPECT_TRUE(onset["value"].is_null());
  EXPECT_TRUE(onset["high"].is_null());
  EXPECT_EQ(onset["yes"], 0);
  EXPECT_NE(onset["text"].get<std::string>().find("above"), std::string::npos) << onset;
}

TEST_F(Sweeps, ARunStopsEarlyWithTheSameAnswerAndSaysWhy) {
  const std::string tail = "[search]\nverdict = \"bouncing\"\nrange = [1.0, 1.6]\nwidth = 0.3\nruns = 3\n";
  const std::string scene = R"(
[scene]
preset = "fortini-huang-2015"
cell.width = 6.0
beads.layers = 3
time = { integrator = "split", steps_per_contact = 6.37, discard = 1, cycles = 60, phases = 10 }
)";
  write(at("long.toml"), "results = [\"s_b\"]\n" + scene + tail);
  write(at("short.toml"), "results = [\"s_b\"]\nstop_early = true\n" + scene + tail);
  ASSERT_EQ(run(at("long.toml"), at("long")).code, kDone);
  ASSERT_EQ(run(at("short.toml"), at("short")).code, kDone);
  collected(at("long.toml"), at("long"));
  collected(at("short.toml"), at("short"));
  const auto whole = nlohmann::json::parse(bytes_of(at("long.json")))["points"];
  const auto early = nlohmann::json::parse(bytes_of(at("short.json")))["points"];
  ASSERT_EQ(whole.size(), early.size());
  int stopped = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(whole[i]["answer"], early[i]["answer"]);
    EXPECT_EQ(whole[i]["n_cycles"], 60);
    if (!early[i].contains("stopped")) continue;
    ++stopped;
    EXPECT_LT(early[i]["n_cycles"], 60);
  }
  EXPECT_GE(stopped, 1);
}

TEST_F(Sweeps, TheResultsAreThoseOfSimulateAndAnalyze) {
  const std::string plan = at("one.toml");
  write(plan, std::string(kScene) + "[axes]\ndrive.gamma = [1.6]\n");
  ASSERT_EQ(run(plan, at("o"), {"--keep-trajectories"}).code, kDone);
  const fs::path point = fs::directory_iterator(at("o") + "/points")->path();
  const auto result = nlohmann::json::parse(bytes_of(point / "result.json"));
  const auto& swept = result["results"];
  const std::string rest = result["rest_height"].dump();  // from the bed; not stored in a file
  const auto scene = nlohmann::json::parse(bytes_of(point / "point.json"))["scene"].get<std::string>();
  write(at("scene.toml"), scene);
  ASSERT_EQ(run_program({"simulate", at("scene.toml"), "-o", at("sim.h5"), "-q"}).code, kDone);
  for (const std::string& file : {at("sim.h5"), (point / "trajectory.h5").string()}) {
    const Ran analysed = run_program({"analyze", file, "--json", "-q", "--rest-height", rest});
    ASSERT_EQ(analysed.code, kDone) << analysed.err;
    EXPECT_TRUE(nlohmann::json::parse(analysed.out)["results"] == swept) << file;
  }
}

TEST_F(Sweeps, SeedsArePooledAsAnalyzePoolsThem) {
  const std::string plan = at("seeds.toml");
  write(plan, "seed = 3\n" + std::string(kScene) +
                  "[axes]\ndrive.gamma = [1.05, 1.6]\nstart.kind = \"random\"\n" + "seeds = 3\n");
  ASSERT_EQ(run(plan, at("o"), {"--keep-trajectories"}).code, kDone);
  ASSERT_EQ(run_program({"sweep", "collect", plan, "--folder", at("o"), "-o", at("r.json"), "-q"}).code,
            kDone);
  const auto collected = nlohmann::json::parse(bytes_of(at("r.json")));
  ASSERT_EQ(collected["pooled"].size(), 2U);
  const std::string table = bytes_of(at("r.pooled.csv"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
  for (const auto& group : collected["pooled"]) {
    EXPECT_EQ(group["runs"], 3);
    std::vector<std::string> words = {"analyze", "--json", "-q"};
    for (const auto& point : collected["points"])
      if (point["axes"] == group["axes"])
        words.push_back(at("o") + "/points/" + point["id"].get<std::string>() + "/trajectory.h5");
    const Ran ran = run_program(words);
    ASSERT_EQ(ran.code, kDone) << ran.err;
    const auto pooled = nlohmann::json::parse(ran.out)["results"];
    for (const char* name : {"s_b", "s_c", "T_g", "q6", "phase"})
      EXPECT_TRUE(pooled[name] == group["results"][name]) << pooled[name] << group["results"][name];
    EXPECT_EQ(pooled["s_b"]["runs"].size(), 3U);
    EXPECT_LT(pooled["s_b"]["interval"]["low"], pooled["s_b"]["value"]);
    // The same runs appear in the report as runs and as points of the sweep.
    words = {"compare", "-q",         "--json",       "--sweep", at("r.json"),
             "-o",      at("report"), "--simulation", words[3],  words[4]};
    const Ran compared = run_program(words);
    EXPECT_EQ(compared.code, kDone) << compared.err;
    EXPECT_NE(bytes_of(at("report/report.html")).find("sweep"), std::string::npos);
  }
  // Two drive strengths are not one condition, and one run repeated is not two runs.
  const std::string a =
      at("o") + "/points/" + collected["points"][0]["id"].get<std::string>() + "/trajectory.h5";
  const std::string b =
      at("o") + "/points/" + collected["points"][5]["id"].get<std::string>() + "/trajectory.h5";
  const Ran other = run_program({"analyze", a, b, "-q"});
  EXPECT_EQ(other.code, kUsage);
  EXPECT_NE(other.err.find("Gamma"), std::string::npos) << other.err;
  EXPECT_NE(run_program({"analyze", a, a, "-q"}).err.find("same run"), std::string::npos);
}

TEST_F(Sweeps, SeedsThatChangeNothingAreRunOnceAndSaid) {
  const auto planned = [&](const std::string& axes) {
    write(at("p.toml"), std::string(kScene) + "start.kind = \"crystal_a\"\n" + axes);
    return run_program({"sweep", "plan", at("p.toml"), "--folder", at("planned"), "--json"});
  };
  const Ran seeds = planned("[axes]\ndrive.gamma = 1.6\nseeds = 3\n");
  ASSERT_EQ(seeds.code, kDone) << seeds.err;
  EXPECT_NE(seeds.err.find("2 of the plan's runs would repeat another"), std::string::npos) << seeds.err;
  EXPECT_EQ(nlohmann::json::parse(seeds.out)["points"], 1);
  EXPECT_EQ(nlohmann::json::parse(seeds.out)["repeats_left_out"], 2);
  EXPECT_EQ(nlohmann::json::parse(planned("[axes]\ndrive.gamma = 1.6\nstart.seed = [1, 2]\n").out)["points"],
            1);
  // A scene with a random property gives a different run for each seed.
  for (const char* chance :
       {"start.perturbation = 0.01\n", "beads.spread = \"uniform\"\nbeads.spread_width = 0.05\n"}) {
    const Ran drawn = planned(chance + std::string("[axes]\ndrive.gamma = 1.6\nseeds = 3\n"));
    ASSERT_EQ(drawn.code, kDone) << drawn.err;
    EXPECT_EQ(nlohmann::json::parse(drawn.out)["points"], 3) << chance;
  }
  // Run and collected: one run, so no interval over runs.
  planned("[axes]\ndrive.gamma = 1.6\nseeds = 3\n");
  ASSERT_EQ(run(at("p.toml"), at("o")).code, kDone);
  ASSERT_EQ(
      run_program({"sweep", "collect", at("p.toml"), "--folder", at("o"), "-o", at("r.json"), "-q"}).code,
      kDone);
  const auto collected = nlohmann::json::parse(bytes_of(at("r.json")));
  EXPECT_EQ(collected["points"].size(), 1U);
  EXPECT_TRUE(collected["pooled"].empty());
}

// As `explain` and `simulate` say them, but each once, with the points that it concerns.
TEST_F(Sweeps, WarningsOfTheScenesAreSaidOnceWithTheirPoints) {
  const std::string plan = at("doubtful.toml");
  write(plan, R"(results = ["s_b"]
[scene]
preset = "fortini-huang-2015"
cell.width = 6.0
beads.layers = 3
contact.k_t = 1000.0
drive.start = "abrupt"
time = { steps_per_contact = 6.37, discard = 0, cycles = 2, phases = 10 }
[axes]
drive.gamma = [1.05, 1.6]
contact.mu = [0.0, 0.3]
)");
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  const std::string coarse = "time.steps_per_contact = 6.37 is below 20";
  for (const char* verb : {"plan", "run"}) {
    const Ran ran = run_program({"sweep", verb, plan, "--folder", at("doubtful"), "--json"});
    ASSERT_EQ(ran.code, kDone) << ran.err;
    EXPECT_EQ(count(ran.err, coarse), 1U) << ran.err;
    EXPECT_NE(ran.err.find("may not rest. It concerns all 4 points of the plan."), std::string::npos);
    EXPECT_NE(
        ran.err.find("contact.k_t has no effect: mu is 0 for all contacts. It concerns contact.mu = 0.0, "
                     "drive.gamma = 1.05; contact.mu = 0.0, drive.gamma = 1.6."),
        std::string::npos)
        << ran.err;
    const auto document = nlohmann::json::parse(ran.out);
    EXPECT_GE(document["warnings"].size(), 2U) << document;
  }
  // What only the run can tell is in its result: the abrupt start of the drive.
  const std::string abrupt = "the drive starts abruptly";
  const Ran again = run_program({"sweep", "run", plan, "--folder", at("doubtful")});
  EXPECT_EQ(count(again.err, abrupt), 1U) << again.err;
  EXPECT_NE(again.err.find("and, with other numbers, 2 other points"), std::string::npos) << again.err;
}

TEST_F(Sweeps, WrongPlansAreRefusedInOneSentence) {
  const auto refused = [&](const std::string& text, const std::vector<std::string>& mentioned,
                           int code = kUsage) {
    write(at("bad.toml"), text);
    const Ran ran = run(at("bad.toml"), at("bad"));
    EXPECT_EQ(ran.code, code) << text << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    for (const auto& word : mentioned)
      EXPECT_NE(ran.err.find(word), std::string::npos) << word << "\n" << ran.err;
  };
  const std::string scene = kScene;
  refused("seed = 1\n", {"bad.toml", "scene"});
  refused("scene = \"none.toml\"\n", {"none.toml"}, kInput);
  refused(scene + "[axes]\ndrive.gama = [1.0]\n", {"bad.toml:8", "axes", "drive.gama", "drive.gamma"});
  refused(scene + "[axes]\ndrive.gamma = [-1.0]\n", {"bad.toml:8", "-1"});
  refused(scene + "[axes]\ndrive.gamma = [1.0]\ndrive.k_m = [2.0]\n", {"contradicts"});
  refused(scene + "[axes]\ndrive.gamma = [1.5, 1.5]\n", {"bad.toml:8", "twice"});
  refused(scene + "[axes]\nstart.seed = [1, 2]\nseeds = 2\n", {"bad.toml:8", "start.seed"});
  refused(scene + "[axes]\ndrive.gamma = []\n", {"bad.toml", "no values"});
  refused(scene + "[search]\nrange = [1.0, 2.0]\nwidth = 0.1\n", {"verdict"});
  refused(scene + "[search]\nverdict = \"flying\"\nrange = [1.0, 2.0]\nwidth = 0.1\n",
          {"flying", "bouncing"});
  refused(scene + "[search]\nverdict = \"bouncing\"\nrange = [2.0, 1.0]\nwidth = 0.1\n",
          {"bad.toml", "range"});
  refused(scene + "[search]\nresult = \"q7\"\nabove = 1\nrange = [1.0, 2.0]\nwidth = 0.1\n", {"q7", "q6"});
  for (const char* several : {"s_k", "phase"})
    refused(scene + "[search]\nresult = \"" + several + "\"\nabove = 1\nrange = [1.0, 2.0]\nwidth = 0.1\n",
            {"bad.toml", several, "one number"});
  refused("stop_early = true\n" + scene, {"stop_early"});
  refused("sedd = 3\n" + scene, {"sedd", "seed"});
  for (const char* shard : {"0/3", "4/3", "1/0", "x", "1/2/3"}) {
    const Ran ran = run(grid_, at("bad"), {"--shard", shard});
    EXPECT_EQ(ran.code, kUsage) << shard;
    EXPECT_NE(ran.err.find("--shard"), std::string::npos) << ran.err;
  }
}

// The base scene states Gamma and layers; an axis states the same quantities by other keys.
TEST_F(Sweeps, AnAxisDisplacesWhatTheSceneSaysInOtherWords) {
  write(at("km.toml"), "results = [\"s_b\"]\n" + std::string(kScene) +
                           "drive.gamma = 1.2\n[axes]\ndrive.k_m = [2.25]\nbeads.count = [12]\n");
  write(at("gamma.toml"), "results = [\"s_b\"]\n" + std::string(kScene) + "[axes]\ndrive.gamma = [1.5]\n");
  const auto scene_in = [&](const std::string& plan) {
    const Ran ran = run_program({"sweep", "plan", at(plan), "--folder", at(plan) + ".d", "-q"});
    EXPECT_EQ(ran.code, kDone) << ran.err;
    return bytes_of(fs::directory_iterator(at(plan) + ".d/points")->path() / "point.json");
  };
  const std::string by_k_m = scene_in("km.toml");
  EXPECT_NE(by_k_m.find("k_m = 2.25"), std::string::npos) << by_k_m;
  EXPECT_EQ(by_k_m.find("gamma = 1.2"), std::string::npos) << by_k_m;
  EXPECT_NE(by_k_m.find("count = 12"), std::string::npos) << by_k_m;
  EXPECT_EQ(by_k_m.find("layers"), std::string::npos) << by_k_m;
  ASSERT_EQ(run(at("km.toml"), at("km.toml.d")).code, kDone);
}

TEST_F(Sweeps, PlanAndStatusSayHowFarItIs) {
  EXPECT_EQ(run_program({"sweep", "status", grid_, "--folder", at("p")}).code, kInput);
  ASSERT_EQ(run_program({"sweep", "plan", grid_, "--folder", at("p"), "-q"}).code, kDone);
  const auto status = [&] {
    const Ran ran = run_program({"sweep", "status", grid_, "--folder", at("p"), "--json"});
    EXPECT_EQ(ran.code, kDone) << ran.err;
    return nlohmann::json::parse(ran.out);
  };
  EXPECT_EQ(status()["points"], 6);
  EXPECT_EQ(status()["done"], 0);
  EXPECT_FALSE(status()["complete"]);
  ASSERT_EQ(run(grid_, at("p"), {"--shard", "1/2"}).code, kDone);
  EXPECT_EQ(status()["done"], 3);
  EXPECT_GT(status()["core_seconds_left"], 0);
  ASSERT_EQ(run(grid_, at("p")).code, kDone);
  EXPECT_TRUE(status()["complete"]);
}

TEST_F(Sweeps, ADamagedResultIsNotRead) {
  ASSERT_EQ(run(grid_, at("d")).code, kDone);
  const fs::path point = fs::directory_iterator(at("d") + "/points")->path();
  write(point / "result.json", "{\"id\": \"");
  const Ran ran = run(grid_, at("d"));
  EXPECT_EQ(ran.code, kInput);
  EXPECT_NE(ran.err.find((point / "result.json").string()), std::string::npos) << ran.err;
  fs::remove(point / "result.json");
  EXPECT_EQ(run(grid_, at("d")).code, kDone);
}

}  // namespace
}  // namespace twincell::sweep_test
