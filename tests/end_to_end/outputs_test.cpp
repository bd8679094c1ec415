// The program never deletes or overwrites anything that it did not make. Every command that writes is run
// against every kind of unsafe output path.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "core/sha256.hpp"
#include "tests/support/program.hpp"

namespace twincell::outputs_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene =
    "preset = \"fortini-huang-2015\"\n[beads]\nlayers = 3\n[cell]\nwidth = 8\n[drive]\ngamma = "
    "1.5\n[time]\ncycles = 2\ndiscard = 0\n";

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A user's folder: scene, trajectory, frames, tables, and files unrelated to the program.
class Sandbox {
 public:
  Sandbox() : old_(fs::current_path()) {
    fs::create_directory(folder_ / "work");
    fs::current_path(folder_ / "work");
    write("scene.toml", kScene);
    write("plan.toml", "scene = \"scene.toml\"\n[axes]\ndrive.gamma = [1.2, 1.4]\n");
    write("table.csv", "x,y\n1,2\n2,4.1\n3,5.9\n4,8.2\n");
    EXPECT_EQ(run_program({"simulate", "scene.toml", "-o", "sim.h5", "-q"}).code, 0);
    EXPECT_EQ(run_program({"render", "sim.h5", "-o", "frames", "-q"}).code, 0);
    fs::remove("frames/twincell-manifest.json");  // the frames of an experiment have no manifest
    fs::create_directory("io");
    fs::copy_file("sim.h5", "io/sim.h5");
    write("io/notes.txt", "mine");
    write("notes.txt", "mine");
    fs::create_directory("foreign");
    write("foreign/thesis.tex", "mine");
    fs::create_directory("foreign/raw");
    write("foreign/raw/a.dat", "mine");
    fs::create_symlink("scene.toml", "link.toml");
    fs::create_symlink("nowhere", "dangling");
    fs::create_symlink("foreign", "to_foreign");
    ::mkfifo("pipe", 0600);
  }
  ~Sandbox() { fs::current_path(old_); }
  Sandbox(const Sandbox&) = delete;
  Sandbox& operator=(const Sandbox&) = delete;

  /// Contents of the folder: path -> hash, or kind of entry.
  [[nodiscard]] static std::map<std::string, std::string> contents() {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator("."))
      all[entry.path().string()] = entry.is_symlink() ? "link to " + fs::read_symlink(entry.path()).string()
                                   : entry.is_regular_file() ? sha256_of(entry.path())
                                   : entry.is_directory()    ? "folder"
                                                             : "other";
    return all;
  }

 private:
  TemporaryFolder folder_;
  fs::path old_;
};

struct Verb {
  const char* name;
  std::vector<std::string> words;  ///< before the output
  const char* option;
  bool folder;
};

/// Every option of every command that names an output.
std::vector<Verb> verbs() {
  return {
      {"simulate", {"simulate", "scene.toml"}, "-o", false},
      {"measure", {"measure", "scene.toml"}, "-o", false},
      {"analyze", {"analyze", "sim.h5"}, "-o", false},
      {"analyze figures", {"analyze", "sim.h5"}, "--figures", true},
      {"render", {"render", "sim.h5"}, "-o", true},
      {"render movie", {"render", "sim.h5"}, "--movie", false},
      {"draw", {"draw", "sim.h5"}, "-o", false},
      {"locate", {"locate", "frames"}, "-o", false},
      {"locate overlay", {"locate", "frames", "-o", "beads.csv"}, "--overlay", false},
      {"locate candidates", {"locate", "frames", "-o", "beads.csv"}, "--candidates", false},
      {"locate debug", {"locate", "frames", "-o", "beads.csv"}, "--debug-dir", true},
      {"locate view", {"locate", "frames", "-o", "beads.csv"}, "--view", false},
      {"track", {"track", "frames", "--cell", "frames/CELL.toml"}, "-o", false},
      {"track csv", {"track", "frames", "--cell", "frames/CELL.toml", "-o", "t.h5"}, "--csv", false},
      {"import", {"import", "notes.txt"}, "-o", false},
      {"export", {"export", "scene.toml", "--to", "lammps"}, "-o", true},
      {"fit", {"fit", "table.csv", "--law", "line"}, "-o", true},
      {"compare", {"compare", "--experiment", "io/sim.h5", "--simulation", "sim.h5"}, "-o", true},
      {"match", {"match", "frames", "frames/CELL.toml"}, "-o", true},
      {"cost", {"cost", "sim", "--quick"}, "-o", true},
      {"reproduce", {"reproduce", "p1-appendix"}, "-o", true},
      {"sweep run", {"sweep", "run", "plan.toml"}, "--folder", true},
      {"sweep plan", {"sweep", "plan", "plan.toml"}, "--folder", true},
      {"calibrate plate", {"calibrate", "plate", "frames", "--cell", "frames/CELL.toml"}, "-o", false},
      {"calibrate plate figures",
       {"calibrate", "plate", "frames", "--cell", "frames/CELL.toml"},
       "--figures",
       true},
      {"calibrate plate phases",
       {"calibrate", "plate", "frames", "--cell", "frames/CELL.toml"},
       "--phases",
       false},
      {"calibrate walls", {"calibrate", "walls", "frames"}, "-o", false},
      {"calibrate walls figures", {"calibrate", "walls", "frames"}, "--figures", true},
      {"calibrate beads", {"calibrate", "beads", "frames"}, "-o", false},
      {"calibrate beads figures", {"calibrate", "beads", "frames"}, "--figures", true},
      {"calibrate camera", {"calibrate", "camera", "frames"}, "-o", false},
      {"calibrate camera figures", {"calibrate", "camera", "frames"}, "--figures", true},
      {"calibrate bounce", {"calibrate", "contacts", "bounce", "table.csv"}, "-o", false},
      {"calibrate bounce figures", {"calibrate", "contacts", "bounce", "table.csv"}, "--figures", true},
      {"calibrate collisions", {"calibrate", "contacts", "collisions", "sim.h5"}, "-o", false},
      {"calibrate collisions figures", {"calibrate", "contacts", "collisions", "sim.h5"}, "--figures", true},
      {"calibrate infer",
       {"calibrate", "contacts", "infer", "sim.h5", "--scene", "scene.toml", "--vary", "contact.mu=0.1:0.9"},
       "-o",
       false},
      {"calibrate infer figures",
       {"calibrate", "contacts", "infer", "sim.h5", "--scene", "scene.toml", "--vary", "contact.mu=0.1:0.9"},
       "--figures",
       true},
      {"new", {"new", "frames"}, "-o", false},
      {"example", {"example"}, "", true},
      {"man", {"man"}, "-o", true},
      {"sweep collect", {"sweep", "collect", "plan.toml", "--folder", "swept"}, "-o", false},
  };
}

Ran run_verb(const Verb& verb, const std::string& output, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = verb.words;
  if (*verb.option != '\0') words.emplace_back(verb.option);
  words.push_back(output);
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

TEST(Outputs, ForeignFilesAreNotOverwritten) {
  const Sandbox sandbox;
  const auto before = Sandbox::contents();
  const std::vector<std::string> for_all = {
      "/",       "//",       ".",  "..",         "../work", "a/..",      "./",   "dangling", "pipe",
      "foreign", "foreign/", "io", "to_foreign", "frames",  "/dev/null", "/tmp", "",         "missing/out"};
  for (const Verb& verb : verbs()) {
    std::vector<std::string> places = for_all;
    places.insert(places.end(), {"scene.toml", "./io/../scene.toml", "link.toml", "sim.h5", "table.csv",
                                 "notes.txt", "frames/frame_00000.png", "plan.toml", "foreign/thesis.tex"});
    for (const std::string& place : places) {
      // A product of the same kind may be replaced unless it is an input, so these cases are skipped.
      if (place == "sim.h5" && std::string(verb.name) != "analyze" && !verb.folder) continue;
      const Ran ran = run_verb(verb, place);
      EXPECT_EQ(ran.code, 2) << verb.name << " into '" << place << "': " << ran.err;
      EXPECT_FALSE(ran.err.empty()) << verb.name << " into '" << place << "'";
    }
    ASSERT_EQ(Sandbox::contents(), before) << verb.name;
    // An input is not overwritten, even with --force.
    if (!verb.folder) {
      const Ran ran =
          run_verb(verb, verb.words[1] == "frames" ? "frames/frame_00000.png" : "foreign", {"--force"});
      EXPECT_EQ(ran.code, 2) << verb.name << ": " << ran.err;
      ASSERT_EQ(Sandbox::contents(), before) << verb.name;
    }
  }
}

// The ending lets every verb get as far as the question whether the file is one of its products, and to read
// a pipe without a writer is to wait for ever.
TEST(Outputs, APipeUnderTheNameOfAProductIsRefusedUnread) {
  const Sandbox sandbox;
  for (const Verb& verb : verbs()) {
    const std::string ending = verb.folder ? "" : std::string(verb.name) == "new" ? ".toml" : ".csv";
    const std::string pipe = "waiting" + ending;
    if (!fs::exists(pipe)) ::mkfifo(pipe.c_str(), 0600);
    const auto before = Sandbox::contents();
    const Ran ran = run_verb(verb, pipe);
    EXPECT_EQ(ran.code, 2) << verb.name << ": " << ran.err;
    ASSERT_EQ(Sandbox::contents(), before) << verb.name;
  }
}

// `-o -`: a single-file text output goes to standard output, complete and alone; all other outputs are
// refused.
TEST(Outputs, StandardOutputTakesTextAlone) {
  const Sandbox sandbox;
  EXPECT_EQ(run_program({"sweep", "run", "plan.toml", "--folder", "swept", "-q"}).code, 0);
  const auto before = Sandbox::contents();
  const std::string frames = "frames", cell = "frames/CELL.toml";
  const Ran table = run_program({"locate", frames, "-o", "-", "-v"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_TRUE(table.out.starts_with("y,x,mass,")) << table.out.substr(0, 200);
  EXPECT_GT(std::count(table.out.begin(), table.out.end(), '\n'), 100);
  EXPECT_NE(table.err.find("frame 0: "), std::string::npos) << table.err;
  const Ran named = run_program({"locate", frames, "-o", "named.csv", "-q"});
  std::ifstream file("named.csv");
  EXPECT_EQ(table.out, std::string(std::istreambuf_iterator<char>(file), {}));
  fs::remove("named.csv");
  const Ran tracks = run_program({"track", frames, "--cell", cell, "-o", "t.h5", "--csv", "-", "-q"});
  EXPECT_EQ(tracks.code, 0) << tracks.err;
  EXPECT_TRUE(tracks.out.starts_with("y,x,frame,particle,")) << tracks.out.substr(0, 200);
  EXPECT_EQ(tracks.err, "");
  fs::remove("t.h5");
  const Ran toml = run_program({"calibrate", "beads", frames, "--cell", cell, "-o", "-"});
  EXPECT_EQ(toml.code, 0) << toml.err;
  EXPECT_TRUE(toml.out.starts_with("# twincell ")) << toml.out.substr(0, 200);
  const Ran json = run_program({"sweep", "collect", "plan.toml", "--folder", "swept", "-o", "-"});
  EXPECT_EQ(json.code, 0) << json.err;
  EXPECT_TRUE(nlohmann::json::parse(json.out, nullptr, false).is_object()) << json.out.substr(0, 200);
  EXPECT_EQ(Sandbox::contents(), before);
  // Standard output accepts one output only.
  EXPECT_EQ(run_program({"locate", frames, "-o", "-", "--candidates", "-"}).code, 2);
  EXPECT_EQ(run_program({"locate", frames, "-o", "-", "--json"}).code, 2);
  for (const Verb& verb : verbs()) {
    const std::string name = verb.name;
    const bool text = name.starts_with("calibrate") || name.starts_with("sweep collect") ||
                      name == "locate" || name == "locate candidates" || name == "locate view" ||
                      name == "track csv";
    if (text && !verb.folder) continue;
    const Ran ran = run_verb(verb, "-");
    EXPECT_EQ(ran.code, 2) << name;
    EXPECT_NE(ran.err.find("'-'"), std::string::npos) << name << ": " << ran.err;
    EXPECT_EQ(ran.out, "") << name;
  }
  EXPECT_EQ(Sandbox::contents(), before);
}

// `sweep collect` also writes tables under names that the user did not give.
TEST(Outputs, ATableBesideTheCollectedFileIsHeldToTheSameRules) {
  const Sandbox sandbox;
  write("plan.toml", "scene = \"scene.toml\"\n[axes]\nstart.kind = [\"random\"]\nseeds = 2\n");
  EXPECT_EQ(run_program({"sweep", "run", "plan.toml", "--folder", "swept", "-q"}).code, 0);
  const std::vector<std::string> collect = {"sweep", "collect", "plan.toml", "--folder",
                                            "swept", "-o",      "r.json"};
  for (const char* table : {"r.csv", "r.pooled.csv"}) {
    write(table, "mine");
    const auto before = Sandbox::contents();
    const Ran ran = run_program(collect);
    EXPECT_EQ(ran.code, 2) << table;
    EXPECT_NE(ran.err.find(table), std::string::npos) << ran.err;
    EXPECT_EQ(Sandbox::contents(), before) << table;
    fs::remove(table);
  }
  for (int time = 0; time < 2; ++time) EXPECT_EQ(run_program(collect).code, 0) << time;
  EXPECT_TRUE(fs::exists("r.pooled.csv"));
  // The plan names other axes and results now: the tables are still those of a sweep.
  write("plan.toml",
        "scene = \"scene.toml\"\nresults = [\"s_b\"]\n[axes]\nstart.kind = [\"random\"]\ndrive.gamma = "
        "[1.2]\nseeds = 2\n");
  EXPECT_EQ(run_program({"sweep", "run", "plan.toml", "--folder", "swept", "-q"}).code, 0);
  const Ran again = run_program(collect);
  EXPECT_EQ(again.code, 0) << again.err;
  std::string heading;
  std::getline(std::ifstream("r.pooled.csv") >> std::ws, heading);
  EXPECT_EQ(heading, "drive.gamma,start.kind,runs,s_b,s_b_low,s_b_high");
}

TEST(Outputs, CollectedResultsMayBeNamedByTheirTable) {
  const Sandbox sandbox;
  write("plan.toml", "scene = \"scene.toml\"\nresults = [\"s_b\", \"S_q\"]\n[axes]\ndrive.gamma = [1.3]\n");
  EXPECT_EQ(run_program({"sweep", "run", "plan.toml", "--folder", "swept", "-q"}).code, 0);
  const Ran ran = run_program({"sweep", "collect", "plan.toml", "--folder", "swept", "-o", "r.csv"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("r.json\nr.csv\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.err.find("only in r.json: S_q."), std::string::npos) << ran.err;
  std::string table, json;
  std::getline(std::ifstream("r.csv") >> std::ws, table);
  std::getline(std::ifstream("r.json") >> std::ws, json);
  EXPECT_EQ(table.rfind("id,", 0), 0U) << table;
  EXPECT_EQ(json, "{");
}

/// Runs the program under a limit of a resource, which it inherits.
Ran run_limited(decltype(RLIMIT_AS) resource, rlim_t most, const std::vector<std::string>& words) {
  rlimit usual{};
  EXPECT_EQ(::getrlimit(resource, &usual), 0);
  const rlimit limit{most, usual.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);  // inherited: a write beyond the limit is an error, as on a full disk
  ::setrlimit(resource, &limit);
  RunningProgram program(words);
  ::setrlimit(resource, &usual);
  std::signal(SIGXFSZ, SIG_DFL);
  return program.wait();
}

TEST(Outputs, TheCauseOfAFailureToWriteIsReported) {
  const Sandbox sandbox;
  const Ran table = run_limited(RLIMIT_FSIZE, 20'000, {"locate", "frames", "-o", "b.csv", "-q"});
  EXPECT_EQ(table.code, 1);
  EXPECT_NE(table.err.find("b.csv: cannot be written (File too large)."), std::string::npos) << table.err;
  const Ran track = run_limited(RLIMIT_FSIZE, 20'000,
                                {"track", "frames", "--cell", "frames/CELL.toml", "-o", "t.h5", "-q"});
  EXPECT_EQ(track.code, 1);
  EXPECT_NE(track.err.find(fs::current_path().string() + ": the temporary file of the located beads"),
            std::string::npos)
      << track.err;
  // The cell file would fit; without its picture, neither is left.
  const Ran cell = run_limited(RLIMIT_FSIZE, 5'000, {"new", "frames", "-o", "own.toml", "-q"});
  EXPECT_EQ(cell.code, 1);
  EXPECT_NE(cell.err.find("own.png: writing failed (File too large)."), std::string::npos) << cell.err;
  EXPECT_FALSE(fs::exists("own.toml"));
  EXPECT_FALSE(fs::exists("own.png"));
}

TEST(Outputs, AFullDiskUnderTheHelpIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "/dev/full is not there";
  for (const char* words : {"help", "--version", "help track", "keys", "completion bash"}) {
    std::string command = TWINCELL_PROGRAM;
    command.append(" ").append(words).append(" > /dev/full 2> /dev/null");
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1) << words;
  }
}

TEST(Outputs, AnInputIsNeverAnOutputThroughAnyName) {
  const Sandbox sandbox;
  fs::create_hard_link("scene.toml", "hard.toml");
  fs::create_symlink("sim.h5", "soft.h5");
  const auto before = Sandbox::contents();
  for (const std::string place :
       {"scene.toml", "link.toml", "hard.toml", "./scene.toml", "io/../scene.toml"}) {
    EXPECT_EQ(run_program({"simulate", "scene.toml", "-o", place, "--force"}).code, 2) << place;
    EXPECT_EQ(Sandbox::contents(), before) << place;
  }
  EXPECT_EQ(run_program({"analyze", "soft.h5", "-o", "sim.h5", "--force"}).code, 2);
  EXPECT_EQ(run_program({"simulate", "scene.toml", "--set", "start.kind=trajectory", "--set",
                         "start.from=sim.h5", "-o", "sim.h5"})
                .code,
            2);
  EXPECT_EQ(Sandbox::contents(), before);
}

// A scene names the bed from which it starts and the record of its drive, a plan its scene.
TEST(Outputs, AFileThatAnInputNamesIsNeverAnOutput) {
  const Sandbox sandbox;
  std::ofstream("from.toml") << "preset = \"fortini-huang-2015\"\n[drive]\ngamma = 1.2\n[start]\nkind = "
                                "\"trajectory\"\nfrom = \"sim.h5\"\n[cell]\nwidth = 8.0\n";
  std::ofstream record("record");
  record << "time_t0,position_sigma\n";
  for (int i = 0; i <= 400; ++i) record << i << ',' << std::sin(0.5 * i) << '\n';
  record.close();
  std::ofstream("recorded.toml") << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 4\n[cell]\nwidth = "
                                    "4.0\n[drive]\nfile = \"record\"\nomega = 0.5\n[time]\ndiscard = 0\n"
                                    "cycles = 2\n";
  std::ofstream("measured")
      << "[drive.omega]\nvalue = 0.5\nstandard_error = 0.001\nunit = \"1/t0\"\nmethod = "
         "\"m\"\ndata = \"d\"\n";
  std::ofstream("calibrated.toml") << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 4\n[cell]\nwidth = "
                                      "4.0\n[drive]\ngamma = 1.2\n[calibration]\nfrom = \"measured\"\n";
  std::ofstream("named.json") << "preset = \"fortini-huang-2015\"\n[beads]\ncount = 4\n";
  std::ofstream("plan.toml") << "scene = \"named.json\"\n[axes]\ndrive.gamma = [1.2]\n";
  const auto before = Sandbox::contents();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"simulate", "from.toml", "-o", "sim.h5"},
           {"simulate", "from.toml", "-o", "io/../sim.h5", "--force"},
           {"simulate", "scene.toml", "--set", "start.kind=\"trajectory\"", "--set", "start.from=\"sim.h5\"",
            "-o", "sim.h5"},
           {"simulate", "recorded.toml", "-o", "record", "--force"},
           {"simulate", "calibrated.toml", "-o", "measured", "--force"},
           {"measure", "recorded.toml", "-o", "record", "--force"},
           {"measure", "from.toml", "-o", "sim.h5", "--force"},
           {"sweep", "collect", "plan.toml", "-o", "named.json", "--force"}}) {
    const Ran ran = run_program(words);
    EXPECT_EQ(ran.code, 2) << ran.err;
    EXPECT_NE(ran.err.find("the output is an input of the same command"), std::string::npos) << ran.err;
    EXPECT_EQ(Sandbox::contents(), before) << words.back();
  }
}

TEST(Outputs, AWordOfTheProgramIsNoInputThoughAFileHasItsName) {
  const Sandbox sandbox;
  for (int time = 0; time < 2; ++time) {  // the second run continues in the folder that the first made
    const Ran figure = run_program({"reproduce", "p1-table1", "-q"});
    EXPECT_EQ(figure.code, 0) << figure.err;
    std::ofstream("t.csv") << "x,y\n1,2\n2,4.1\n3,5.9\n4,8\n";
    const Ran fit = run_program({"fit", "t.csv", "--law", "line", "-o", "line", "-q"});
    EXPECT_EQ(fit.code, 0) << fit.err;
  }
}

TEST(Outputs, NamesOfAnyBytesAreWritten) {
  const Sandbox sandbox;
  for (const std::string name : {"with space", "it's \"quoted\"", "new\nline", "./-o", "caf\xc3\xa9",
                                 "\xff\xfe bytes", "$(touch PWNED)", "`touch PWNED`", "a;touch PWNED"}) {
    const Ran fit = run_program({"fit", "table.csv", "--law", "line", "-o", name, "-q"});
    EXPECT_EQ(fit.code, 0) << name << ": " << fit.err;
    EXPECT_TRUE(fs::exists(fs::path(name) / "fit.svg")) << name;
    const Ran json = run_program({"simulate", "scene.toml", "-o", name + ".h5", "-q", "--json"});
    EXPECT_EQ(json.code, 0) << name << ": " << json.err;
    EXPECT_FALSE(nlohmann::json::parse(json.out, nullptr, false).is_discarded()) << name;
    EXPECT_EQ(run_program({"analyze", name + ".h5", "-o", name + ".results.h5", "-q"}).code, 0) << name;
  }
  EXPECT_FALSE(fs::exists("PWNED"));
  for (const auto& [path, kind] : Sandbox::contents())
    EXPECT_EQ(path.find(".twincell-"), std::string::npos) << path;
}

TEST(Outputs, AFolderIsReplacedAsFarAsItsManifestGoes) {
  const Sandbox sandbox;
  const std::vector<std::string> render = {"render", "sim.h5", "-o", "new", "-q"};
  ASSERT_EQ(run_program(render).code, 0);
  const auto manifest = nlohmann::json::parse(std::ifstream("new/twincell-manifest.json"));
  EXPECT_EQ(manifest["product"], "a rendered stack");
  for (const auto& [name, hashes] : manifest["files"].items())
    EXPECT_EQ(hashes, nlohmann::json::array({sha256_of(fs::path("new") / name)})) << name;
  EXPECT_EQ(manifest["files"].size() + 1, names_in("new").size());

  // Foreign files stay, in the folder and in its subfolders; a shorter stack leaves no old frames.
  write("new/thesis.tex", "mine");
  fs::create_directories("new/deep/er");
  write("new/deep/er/a.txt", "mine");
  ASSERT_EQ(run_program({"simulate", "scene.toml", "-o", "short.h5", "-q", "--set", "time.cycles=1"}).code,
            0);
  ASSERT_EQ(run_program({"render", "short.h5", "-o", "new", "-q"}).code, 0);
  EXPECT_TRUE(fs::exists("new/thesis.tex"));
  EXPECT_TRUE(fs::exists("new/deep/er/a.txt"));
  EXPECT_TRUE(fs::exists("new/frame_00019.png"));
  EXPECT_FALSE(fs::exists("new/frame_00020.png"));

  // A file that was changed no longer belongs to the program.
  write("new/CELL.toml", "changed by hand");
  const Ran refused = run_program(render);
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("CELL.toml"), std::string::npos) << refused.err;
  std::ifstream cell("new/CELL.toml");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(cell), {}), "changed by hand");

  // Unfinished output of another run is not removed.
  fs::create_directory("busy");
  write("busy/.twincell-notes", "mine");
  EXPECT_EQ(run_program({"render", "sim.h5", "-o", "busy", "-q"}).code, 2);
  EXPECT_TRUE(fs::exists("busy/.twincell-notes"));

  // Nor is a folder of another product, or one whose manifest points outside it.
  EXPECT_EQ(run_program({"analyze", "sim.h5", "--figures", "new", "-q"}).code, 2);
  fs::create_directory("trap");
  write("trap/twincell-manifest.json",
        nlohmann::json({{"program", "twincell"},
                        {"product", "a rendered stack"},
                        {"files", {{"../notes.txt", {sha256_of("notes.txt")}}}}})
            .dump());
  EXPECT_EQ(run_program({"render", "sim.h5", "-o", "trap", "-q"}).code, 2);
  EXPECT_TRUE(fs::exists("notes.txt"));
}

// The names that a run certainly writes are checked before its work.
TEST(Outputs, AFileInTheWayOfAFolderIsRefusedAtOnce) {
  const Sandbox sandbox;
  const std::vector<std::string> fit = {"fit", "table.csv", "--law", "line", "-o", "fit", "-q"};
  ASSERT_EQ(run_program(fit).code, 0);
  EXPECT_EQ(run_program(fit).code, 0);
  auto manifest = nlohmann::json::parse(std::ifstream("fit/twincell-manifest.json"));
  manifest["files"].erase("fit.dat");
  write("fit/twincell-manifest.json", manifest.dump());
  const Ran unlisted = run_program(fit);
  EXPECT_EQ(unlisted.code, 2);
  EXPECT_NE(unlisted.err.find("'fit.dat' in it was not written by twincell"), std::string::npos)
      << unlisted.err;

  // Figures of several kinds of calibration share a folder: only the own ones count.
  const auto calibrate = [](const std::string& kind) {
    return run_program(
        {"calibrate", kind, "frames", "--cell", "frames/CELL.toml", "--figures", "figures", "-q"});
  };
  ASSERT_EQ(calibrate("beads").code, 0);
  write("figures/beads.svg", "changed by hand");
  write("figures/edges.pdf", "mine");
  EXPECT_EQ(calibrate("plate").code, 0);
  for (const auto& [kind, said] :
       {std::pair<std::string, std::string>{"beads", "'beads.svg' in it has changed since twincell wrote it"},
        {"walls", "'edges.pdf' in it was not written by twincell"}}) {
    const Ran refused = calibrate(kind);
    EXPECT_EQ(refused.code, 2) << kind;
    EXPECT_NE(refused.err.find(said), std::string::npos) << refused.err;
  }
}

TEST(Outputs, AnImportReplacesImportsAlone) {
  const Sandbox sandbox;
  write("beads.csv", "frame,particle,x,y\n0,0,1,1\n0,1,3,1\n1,0,1,2\n1,1,3,2\n");
  const auto import = [](const std::string& output, const std::string& source) {
    return run_program(
        {"import", "beads.csv", "-o", output, "--timestep", "1", "--y-up", "--source", source, "-q"});
  };
  const std::string simulated = sha256_of("sim.h5");
  for (const char* source : {"simulation", "experiment", "unknown"}) {
    const Ran refused = import("sim.h5", source);
    EXPECT_EQ(refused.code, 2) << source;
    EXPECT_NE(refused.err.find("is not an imported trajectory"), std::string::npos) << refused.err;
    EXPECT_EQ(sha256_of("sim.h5"), simulated);
  }
  for (int k = 0; k < 2; ++k) {
    const Ran ran = import("imported.h5", "simulation");
    EXPECT_EQ(ran.code, 0) << ran.err;
  }
}

TEST(Outputs, FilesAreReplacedByTheirOwnKindOrByForce) {
  const Sandbox sandbox;
  const std::vector<std::vector<std::string>> twice = {
      {"simulate", "scene.toml", "-o", "a.h5"},
      {"analyze", "sim.h5", "-o", "r.h5"},
      {"locate", "frames", "-o", "b.csv", "--overlay", "o.png", "--candidates", "c.csv", "--debug-dir", "d",
       "--view", "v.html"},
      {"track", "frames", "--cell", "frames/CELL.toml", "-o", "t.h5", "--csv", "t.csv"},
      {"render", "sim.h5", "--movie", "f.avi"},
      {"draw", "sim.h5", "-o", "d.png"},
      {"draw", "sim.h5", "-o", "d.avi", "--frames", ":2"},
      {"fit", "table.csv", "--law", "line", "-o", "fit"},
      {"export", "scene.toml", "--to", "lammps", "-o", "deck"},
      {"export", "sim.h5", "--to", "xyz", "-o", "e.xyz"},
      {"export", "sim.h5", "--to", "csv", "-o", "e.csv"},
      {"export", "sim.h5", "--to", "gsd", "-o", "e.gsd"},
      {"export", "sim.h5", "--to", "trackmate", "-o", "e.xml"},
      {"export", "sim.h5", "--to", "isbi", "-o", "i.xml"},
      {"export", "sim.h5", "--to", "mat", "-o", "e.mat"},
      {"export", "sim.h5", "--to", "vtk", "-o", "e"}};
  for (auto words : twice) {
    words.emplace_back("-q");
    EXPECT_EQ(run_program(words).code, 0) << words[0];
    const Ran again = run_program(words);
    EXPECT_EQ(again.code, 0) << words[0] << ": " << again.err;
  }
  // The format of a dump has no place for its maker, which the refusal says.
  const std::vector<std::string> dump = {"export", "sim.h5", "--to", "lammps-dump", "-o", "e.dump", "-q"};
  EXPECT_EQ(run_program(dump).code, 0);
  const Ran refused = run_program(dump);
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("does not state which program made it"), std::string::npos) << refused.err;
  // An output of one kind does not replace one of another kind.
  write("user.xyz", "1\nProperties=species:S:1:pos:R:3\nX 0 0 0\n");
  write("user.csv", "frame,particle,x,y,step,time,my_column\n0,0,1,2,0,0,5\n");
  EXPECT_EQ(run_program({"export", "sim.h5", "--to", "xyz", "-o", "user.xyz", "-q"}).code, 2);
  EXPECT_EQ(run_program({"export", "sim.h5", "--to", "csv", "-o", "user.csv", "-q"}).code, 2);
  EXPECT_EQ(run_program({"export", "sim.h5", "--to", "xyz", "-o", "e.csv", "-q"}).code, 2);
  EXPECT_EQ(run_program({"analyze", "sim.h5", "-o", "a.h5", "-q"}).code, 2);
  EXPECT_EQ(run_program({"locate", "frames", "-o", "t.csv", "-q"}).code, 2);
  EXPECT_EQ(run_program({"simulate", "scene.toml", "-o", "notes.txt", "-q"}).code, 2);
  EXPECT_EQ(run_program({"simulate", "scene.toml", "-o", "notes.txt", "-q", "--force"}).code, 0);
}

// Root may write to any file, so that the permissions must be asked for.
TEST(Outputs, AWriteProtectedFileIsReplacedByForceAlone) {
  const Sandbox sandbox;
  fs::copy_file("sim.h5", "kept.h5");
  fs::permissions("kept.h5", fs::perms::owner_read | fs::perms::group_read);
  const std::string before = sha256_of("kept.h5");
  const Ran refused = run_program({"simulate", "scene.toml", "-o", "kept.h5", "-q"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("write-protected"), std::string::npos) << refused.err;
  EXPECT_EQ(sha256_of("kept.h5"), before);
  EXPECT_EQ(run_program({"simulate", "scene.toml", "-o", "kept.h5", "-q", "--force"}).code, 0);
  EXPECT_EQ(fs::status("kept.h5").permissions(), fs::perms::owner_read | fs::perms::group_read);
  fs::permissions("sim.h5", fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(run_program({"simulate", "scene.toml", "-o", "sim.h5", "-q"}).code, 0);
  EXPECT_EQ(fs::status("sim.h5").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(Outputs, ASimulationDoesNotReplaceAFilmNorAFileOfAFolderOfTwincell) {
  const Sandbox sandbox;
  ASSERT_EQ(run_program({"track", "frames", "--cell", "frames/CELL.toml", "-o", "film.h5", "-q"}).code, 0);
  const std::string before = sha256_of("film.h5");
  const Ran refused = run_program({"simulate", "scene.toml", "-o", "film.h5", "-q"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("is not a trajectory of a simulation"), std::string::npos) << refused.err;
  EXPECT_EQ(run_program({"track", "frames", "--cell", "frames/CELL.toml", "-o", "sim.h5", "-q"}).code, 2);
  EXPECT_EQ(sha256_of("film.h5"), before);
  // A folder of twincell lists its files.
  ASSERT_EQ(run_program({"render", "sim.h5", "-o", "stack", "-q"}).code, 0);
  fs::copy_file("sim.h5", "stack/sim.h5");
  write("stack/twincell-manifest.json", nlohmann::json({{"program", "twincell"},
                                                        {"product", "a match"},
                                                        {"files", {{"sim.h5", {sha256_of("stack/sim.h5")}}}}})
                                            .dump());
  const Ran listed = run_program({"simulate", "scene.toml", "-o", "stack/sim.h5", "-q"});
  EXPECT_EQ(listed.code, 2);
  EXPECT_NE(listed.err.find("belongs to the folder"), std::string::npos) << listed.err;
  const Ran list = run_program({"analyze", "sim.h5", "-o", "stack/twincell-manifest.json", "-q", "--force"});
  EXPECT_EQ(list.code, 2);
}

TEST(Outputs, TwoRunsDoNotShareAnOutput) {
  const Sandbox sandbox;
  // The lock of an output, as another process would keep it.
  RunningProgram first({"simulate", "scene.toml", "-o", "both.h5", "-q", "--set", "time.cycles=100000"});
  const auto temporaries = [] {
    int n = 0;
    for (const auto& entry : fs::directory_iterator("."))
      n += entry.path().filename().string().starts_with(".twincell-") ? 1 : 0;
    return n;
  };
  const auto lock_and_unfinished_file = [&] { return temporaries() == 2; };
  ASSERT_TRUE(first.wait_until(".", lock_and_unfinished_file));
  const Ran second = run_program({"simulate", "scene.toml", "-o", "both.h5", "-q"});
  EXPECT_EQ(second.code, 2);
  EXPECT_NE(second.err.find("another process"), std::string::npos) << second.err;
  first.signal(SIGTERM);
  EXPECT_EQ(first.wait().code, 143);
  EXPECT_EQ(temporaries(), 0);
  EXPECT_FALSE(fs::exists("both.h5"));

  // The next run with the same output removes the files that a killed run left.
  RunningProgram killed({"simulate", "scene.toml", "-o", "both.h5", "-q", "--set", "time.cycles=100000"});
  ASSERT_TRUE(killed.wait_until(".", lock_and_unfinished_file));
  killed.signal(SIGKILL);
  EXPECT_EQ(killed.wait().code, 137);
  EXPECT_EQ(run_program({"simulate", "scene.toml", "-o", "both.h5", "-q"}).code, 0);
  EXPECT_EQ(temporaries(), 0);
  EXPECT_TRUE(fs::exists("both.h5"));
}

TEST(Outputs, ASecondSignalLeavesNothingEither) {
  const Sandbox sandbox;
  RunningProgram run({"render", "sim.h5", "-o", "big", "-q", "--pixels-per-sigma", "200"});
  ASSERT_TRUE(run.wait_until(".", [] {  // the unfinished folder
    const fs::directory_iterator entries(".");
    return std::any_of(begin(entries), end(entries), [](const auto& entry) {
      return entry.is_directory() && entry.path().filename().string().starts_with(".twincell-");
    });
  }));
  run.signal(SIGINT);
  run.signal(SIGINT);
  EXPECT_NE(run.wait().code, 0);
  for (const auto& [path, kind] : Sandbox::contents())
    EXPECT_EQ(path.find(".twincell-"), std::string::npos) << path;
}

}  // namespace
}  // namespace twincell::outputs_test
