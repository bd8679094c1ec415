// JSON that the program wrote and reads again, with each key removed and each value replaced by another type
// in turn: the results of a sweep, the records in a trajectory, the manifest of a folder. Whatever is
// damaged, the program uses it, or refuses it in one sentence of its own that names the file and the key.

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "core/json_view.hpp"
#include "core/manifest.hpp"
#include "core/progress.hpp"
#include "sweep/collect.hpp"
#include "sweep/store.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/program.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/rigid_bed.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "twin/comparison.hpp"
#include "twin/sweep_results.hpp"

namespace twincell::damaged_records_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Damage {
  std::string what;
  json document;
};

/// The document with each member removed in turn, and each value replaced by one of every other type. Of a
/// list, the first element stands for all.
std::vector<Damage> damages(const json& document) {
  std::vector<Damage> all;
  const std::function<void(const json::json_pointer&)> visit = [&](const json::json_pointer& at) {
    const json& here = document.at(at);
    for (const json& other :
         {json(), json(-7), json("word"), json::array({json::object()}), json::object()}) {
      if (other == here) continue;
      Damage d{at.to_string() + " is " + other.dump(), document};
      d.document[at] = other;
      all.push_back(std::move(d));
    }
    if (here.is_object())
      for (const auto& [key, value] : here.items()) {
        Damage d{(at / key).to_string() + " is missing", document};
        d.document[at].erase(key);
        all.push_back(std::move(d));
        visit(at / key);
      }
    if (here.is_array() && !here.empty()) visit(at / 0);
  };
  visit(json::json_pointer());
  return all;
}

/// Runs `use`. \return whether the damage was refused. Any other exception than an input error fails the
/// test.
bool refused(const Damage& damage, const std::string& file, const std::function<void()>& use) {
  try {
    use();
    return false;
  } catch (const InputError& e) {
    const std::string said = e.what();
    EXPECT_NE(said.find(file), std::string::npos) << damage.what << ": " << said;
    EXPECT_EQ(said.find("exception"), std::string::npos) << damage.what << ": " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << damage.what << ": " << said;
    return true;
  } catch (const std::exception& e) {
    ADD_FAILURE() << damage.what << ": " << e.what();
    return true;
  }
}

/// What a program of the user's meets: one line, code 3, no text of a library.
void expect_one_sentence(const std::vector<std::string>& words, const std::vector<std::string>& mentioned) {
  const Ran ran = run_program(words);
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  EXPECT_EQ(ran.err.find("exception"), std::string::npos) << ran.err;
  for (const auto& word : mentioned)
    EXPECT_NE(ran.err.find(word), std::string::npos) << "'" << word << "' is not in: " << ran.err;
}

class DamagedRecords : public ::testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }

  /// A search of two runs for each of two starts, with every kind of entry that results have.
  void run_sweep() const {
    put_file(at("plan.toml"),
             "results = [\"s_b\", \"phase\", \"s_j\"]\n[scene]\npreset = \"fortini-huang-2015\"\n"
             "beads.count = 12\ncell.width = 4.0\ntime.integrator = \"verlet\"\ntime.steps_per_contact = "
             "20\ntime.discard = 0\ntime.cycles = 3\ndrive.gamma = 1.5\n[search]\nkey = \"drive.gamma\"\n"
             "verdict = \"bouncing\"\nrange = [0.5, 2.5]\nwidth = 0.5\nruns = 2\nbatch = 2\n");
    const Ran ran = run_program({"sweep", "run", at("plan.toml"), "-q"});
    ASSERT_EQ(ran.code, 0) << ran.err;
  }

  TemporaryFolder folder_;
};

TEST_F(DamagedRecords, ResultOfAPoint) {
  run_sweep();
  const sweep::Plan plan = sweep::read_plan(at("plan.toml"));
  const sweep::Store store(at("plan.sweep"));
  const sweep::Point point = sweep::Schedule(plan, store).curves().front().points.front();
  const std::string file = store.of(point) / "result.json";
  json result = json::parse(read_text_file(file));
  // Without its checksum, as earlier versions wrote it; the checksum would refuse most damages by itself.
  result.erase("sha256");
  put_file(file, result.dump());
  // This version writes one; without it the result was edited.
  EXPECT_NE(complaint_of([&] { (void)store.result(point); }).find("has no sha256, so it was changed by hand"),
            std::string::npos);
  result["computed"].erase("processor_seconds");
  // Entries that only other scenes have.
  result["rest_height"] = 1.5;
  result["contact_fraction"] = 0.01;
  result["until"] = {{"reached", true}, {"text", "precise"}};
  ASSERT_TRUE(result["results"]["s_j"]["value"].is_array());
  const auto use = [&] {
    const sweep::Schedule schedule(plan, store);
    (void)sweep::collected_json(schedule);
    (void)sweep::collected_csv(schedule);
    (void)sweep::pooled_csv(schedule);
    (void)sweep::collected_text(schedule);
  };
  put_file(file, result.dump());
  use();
  std::size_t refusals = 0;
  const auto all = damages(result);
  for (const Damage& damage : all) {
    put_file(file, damage.document.dump());
    const bool found = refused(damage, file, [&] { (void)store.result(point); });
    // A damage that is not found must hurt no reader.
    if (!found) {
      EXPECT_FALSE(refused(damage, file, use)) << damage.what;
    }
    refusals += found ? 1 : 0;
  }
  EXPECT_GT(refusals, all.size() / 2) << "of " << all.size();

  // The program, on one damage of each kind.
  const std::vector<std::pair<Damage, std::string>> seen = {
      {{"/computed/seconds", result}, "computed.seconds"},
      {{"/results/s_b/value", result}, "results.s_b.value"},
      {{"/until/text", result}, "until.text"},
      {{"/n_cycles", result}, "n_cycles"}};
  for (auto [damage, key] : seen) {
    damage.document[json::json_pointer(damage.what)] = json::object();
    put_file(file, damage.document.dump());
    for (const char* verb : {"status", "collect", "run"})
      expect_one_sentence({"sweep", verb, at("plan.toml"), "-q"}, {"result.json: " + key, "remove the file"});
  }
}

TEST_F(DamagedRecords, CollectedResults) {
  run_sweep();
  ASSERT_EQ(run_program({"sweep", "collect", at("plan.toml"), "-q"}).code, 0);
  const std::string file = at("plan.sweep/results.json");
  json whole = json::parse(read_text_file(file));
  ASSERT_EQ(whole["onsets"].size(), 1U);
  whole["points"].erase(whole["points"].begin() + 1, whole["points"].end());
  whole.erase("pooled");
  put_file(file, whole.dump());
  const auto use = [&] {
    analysis::Comparison c;
    twin::add_sweep(file, c);
  };
  use();
  std::size_t refusals = 0;
  for (const Damage& damage : damages(whole)) {
    put_file(file, damage.document.dump());
    refusals += refused(damage, file, use) ? 1 : 0;
  }
  EXPECT_GT(refusals, 50U);

  put_file(at("text.json"), "not JSON at all");
  json other = whole;
  other["format"] = 3;
  put_file(at("other.json"), other.dump());
  other = whole;
  other.erase("points");
  put_file(at("points.json"), other.dump());
  other = whole;
  other["onsets"][0]["conditions"]["n_l"] = "many";
  put_file(at("count.json"), other.dump());
  {
    const MemoryTrajectory bed =
        test::rigid_bed({.gamma = 1.5, .columns = 4, .rows = 3, .phases = 20, .cycles = 2});
    H5mdWriter writer(at("sim.h5"), bed.info());
    for (const Frame& frame : bed.frames()) writer.append(frame);
    writer.finish();
  }
  for (const auto& [name, key] : {std::pair<std::string, std::string>{"text.json", "is not JSON"},
                                  {"other.json", "twincell sweep 1"},
                                  {"points.json", "points: is missing"},
                                  {"count.json", "onsets[0].conditions.n_l: is a text; a number is needed"}})
    expect_one_sentence(
        {"compare", "--simulation", at("sim.h5"), "--sweep", at(name), "-o", at("report"), "-q"},
        {name, key});
}

TEST_F(DamagedRecords, RecordsOfATrajectory) {
  MemoryTrajectory bed = test::rigid_bed(
      {.gamma = 0.9, .columns = 3, .rows = 2, .phases = 4, .cycles = 2, .source = Origin::experiment});
  const json tracking = {{"camera",
                          {{"pixels_per_sigma", 12.0},
                           {"origin_px", {1.0, 2.0}},
                           {"width_px", 100},
                           {"height_px", 200},
                           {"rotation_deg", 0.1},
                           {"distortion", 0.001},
                           {"bright", true}}},
                         {"drive_check", {{"by", "plate"}, {"amplitude", 0.9}, {"amplitude_error", 0.01}}}};
  const json provenance = {{"program", "twincell"},
                           {"command_line", "twincell track"},
                           {"config", "[start]\nkind = \"random\"\n"},
                           {"inputs", {{{"path", "frames"}, {"bytes", 3}}}}};
  const auto write = [&](const json& t, const json& p) {
    bed.info().tracking_json = t.dump();
    bed.info().provenance_json = p.dump();
    fs::remove(at("e.h5"));
    H5mdWriter writer(at("e.h5"), bed.info());
    for (const Frame& frame : bed.frames()) writer.append(frame);
    writer.finish();
  };
  std::vector<std::string> notes;
  const auto use = [&] {
    twin::ComparingOptions options;
    options.experiments = {at("e.h5")};
    options.film = false;
    const auto silent = [](const std::string&) { return std::make_unique<Progress>(); };
    const analysis::Comparison c = twin::compare_runs(options, silent);
    notes = c.notes;
    if (const auto& camera = c.runs.front().show.camera) {
      EXPECT_GT(camera->pixels_per_sigma, 0);
      EXPECT_GT(camera->width, 0);
    }
  };
  write(tracking, provenance);
  use();
  for (const Damage& damage : damages(tracking)) {
    SCOPED_TRACE(damage.what);
    write(damage.document, provenance);
    EXPECT_FALSE(refused(damage, "", use)) << "a record in an experiment is no reason to refuse it";
    if (damage.what.starts_with("/camera/pixels_per_sigma is m")) {
      ASSERT_FALSE(notes.empty());
      EXPECT_NE(notes.front().find("camera.pixels_per_sigma: is missing"), std::string::npos)
          << notes.front();
    }
  }
  for (const Damage& damage : damages(provenance)) {
    write(tracking, damage.document);
    EXPECT_FALSE(refused(damage, "", use)) << damage.what;
  }
  // The program: information about a damaged record, and a comparison with it.
  for (const json& p : {json(3), json::array(), json({{"config", 3}}), json({{"command_line", {1, 2}}}),
                        json({{"inputs", 3}})}) {
    write(json({{"camera", json::array()}, {"drive_check", 3}}), p);
    EXPECT_EQ(run_program({"info", at("e.h5"), "-q"}).code, 0) << p;
    const Ran compared = run_program({"compare", "--experiment", at("e.h5"), "-o", at("report"), "-q"});
    EXPECT_EQ(compared.code, 0) << p << compared.err;
  }
}

// `simulate --resume` asks the output whose run it is.
TEST_F(DamagedRecords, ProvenanceOfAFinishedRun) {
  put_file(at("s.toml"),
           "preset = \"fortini-huang-2015\"\n[beads]\ncount = 4\n[cell]\nwidth = 4.0\n[drive]\ngamma = 1.5\n"
           "[time]\ncycles = 1\ndiscard = 0\n");
  MemoryTrajectory bed = test::rigid_bed({.gamma = 1.5, .columns = 4, .rows = 1, .phases = 20, .cycles = 1});
  for (const json& p :
       {json(3), json::array(), json({{"config", 3}}), json({{"config", {{"a", 1}}}}), json::object()}) {
    fs::remove(at("o.h5"));
    bed.info().provenance_json = p.dump();
    {
      H5mdWriter writer(at("o.h5"), bed.info());
      for (const Frame& frame : bed.frames()) writer.append(frame);
      writer.finish();
    }
    const Ran ran = run_program({"simulate", at("s.toml"), "-o", at("o.h5"), "--resume", "-q"});
    EXPECT_EQ(ran.code, 2) << p << ran.err;
    EXPECT_NE(ran.err.find("another scene"), std::string::npos) << p << ran.err;
  }
}

// A damaged manifest is none: the folder counts as foreign and stays.
TEST_F(DamagedRecords, ManifestOfAFolder) {
  put_file(at("t.csv"), "x,y\n1,1\n2,2\n3,3.1\n4,4\n");
  const std::vector<std::string> fit = {"fit", at("t.csv"), "--law", "line", "-o", at("fit"), "-q"};
  ASSERT_EQ(run_program(fit).code, 0);
  ASSERT_EQ(run_program(fit).code, 0);
  const std::string file = at("fit/twincell-manifest.json");
  const json manifest = json::parse(read_text_file(file));
  for (const Damage& damage : damages(manifest)) {
    put_file(file, damage.document.dump());
    const auto read = Manifest::read(at("fit"));
    // A list of files may be shorter or their hashes others: then these files are foreign.
    if (read) {
      EXPECT_TRUE(damage.what.starts_with("/files") || damage.what.starts_with("/product is")) << damage.what;
    }
  }
  for (const char* key : {"program", "product", "files"}) {
    json without = manifest;
    without.erase(key);
    put_file(file, without.dump());
    const Ran ran = run_program(fit);
    EXPECT_EQ(ran.code, 2) << key << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    EXPECT_TRUE(fs::exists(at("fit/fit.json")));
  }
}

}  // namespace
}  // namespace twincell::damaged_records_test
