// Compares locators with rendered true positions and the Cramér-Rao bound. locate_peers.py runs this program,
// which writes its rows to standard output as one JSON document.
//
//   --case NAME --snr S --method NAME   only these (repeatable; --method matches a part of the name)
//   --frames N     frames per case and noise level, default 3
//   --write DIR    write the frames only: CASE_SNR_FRAME.pgm, CASE_FRAME_truth.csv, and
//                  index.json with each case's diameters
//   --read DIR     also score the results of other programs: DIR/METHOD/CASE_SNR_FRAME.csv,
//                  first line processor ms, then x,y
//   --tune         search OpenCV's settings on the random packing at SNR 51 instead

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "bench/locate/contestants.hpp"
#include "core/malloc_tuning.hpp"
#include "imaging/benchmark/cases.hpp"
#include "imaging/benchmark/centre_scores.hpp"
#include "imaging/benchmark/cramer_rao_bound.hpp"

using namespace twincell::bench;
using namespace twincell::imaging::rendered;
namespace fs = std::filesystem;

namespace {

struct Wanted {
  std::vector<std::string> cases, methods;
  std::vector<double> snr;
  int frames = 3;
  std::string write, read;
  bool tune = false;

  [[nodiscard]] bool takes(const Case& c) const {
    return cases.empty() || std::find(cases.begin(), cases.end(), c.name) != cases.end();
  }
  [[nodiscard]] bool takes(double level) const {
    return snr.empty() || std::find(snr.begin(), snr.end(), level) != snr.end();
  }
  [[nodiscard]] bool takes_method(const std::string& name) const {
    return methods.empty() || std::any_of(methods.begin(), methods.end(), [&](const std::string& part) {
             return name.find(part) != std::string::npos;
           });
  }
};

double processor_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

std::string frame_name(const Case& c, double snr, int frame) {
  return fmt::format("{}_{:g}_{}", c.name, snr, frame);
}

std::uint64_t seed_of(int frame) {
  return 1 + static_cast<std::uint64_t>(frame);
}

// Results of another program, if they were requested.
struct Reported {
  double ms = 0;
  std::vector<cv::Point2d> found;
};
std::optional<Reported> read_found(const fs::path& file) {
  std::ifstream in(file);
  Reported r;
  if (!(in >> r.ms)) return std::nullopt;
  cv::Point2d p;
  for (char comma = 0; in >> p.x >> comma >> p.y;) r.found.push_back(p);
  return r;
}

// A value that is undefined because no bead was found is absent.
nlohmann::json as_json(const CentreScores::Summary& s) {
  nlohmann::json j{{"beads", s.beads},   {"found", s.found},         {"invented", s.invented},
                   {"recall", s.recall}, {"precision", s.precision}, {"bound", s.bound}};
  if (s.found == 0) return j;
  j.update({{"rms", s.rms},
            {"rms_over_bound", s.rms / s.bound},
            {"bias", std::sqrt(0.5 * (s.bias_x * s.bias_x + s.bias_y * s.bias_y))},
            {"bias_x", s.bias_x},
            {"bias_y", s.bias_y},
            {"largest", s.largest},
            {"locking", s.locking},
            {"error_by_phase", s.error_by_phase},
            {"found_by_phase", s.found_by_phase},
            {"truth_by_phase", s.truth_by_phase}});
  return j;
}

// The fastest of a few runs: other processes only ever add time.
double time_of(const Contestant& contestant, const cv::Mat1b& frame, const Case& of,
               std::vector<cv::Point2d>& found) {
  constexpr double kEnough_ms = 150;
  constexpr int kRuns = 3;
  double best = 1e300, sum = 0;
  for (int i = 0; i < kRuns && (i == 0 || sum < kEnough_ms); ++i) {
    const double before = processor_ms();
    found = contestant.find(frame, of);
    const double ms = processor_ms() - before;
    best = std::min(best, ms);
    sum += ms;
  }
  return best;
}

void write_frames(const Wanted& wanted) {
  fs::create_directories(wanted.write);
  nlohmann::json index;
  for (const Case& c : cases())
    if (wanted.takes(c))
      for (int f = 0; f < wanted.frames; ++f) {
        const Picture picture = c.make(seed_of(f));
        const cv::Mat1d light = expected(picture);
        std::ofstream truth(fs::path(wanted.write) / fmt::format("{}_{}_truth.csv", c.name, f));
        truth << "x_px,y_px,r_px\n";
        for (const Disc& d : picture.discs)
          truth << fmt::format("{:.6f},{:.6f},{:.6f}\n", d.x, d.y, d.radius);
        for (const double snr : c.snr) {
          if (!wanted.takes(snr)) continue;
          const std::string name = frame_name(c, snr, f);
          cv::imwrite((fs::path(wanted.write) / (name + ".pgm")).string(),
                      expose(light, picture, snr, seed_of(f)));
          index.push_back({{"frame", name},
                           {"case", c.name},
                           {"snr", snr},
                           {"number", f},
                           {"diameter", c.diameter},
                           {"other_diameters", c.other_diameters}});
        }
      }
  std::ofstream(fs::path(wanted.write) / "index.json") << index.dump(1);
}

struct Row {
  std::string method;
  CentreScores scores;
  double ms = 1e300;
};

// A method that exceeds this time on its first frame is skipped for the rest of that case.
constexpr double kPatience_ms = 1000;

nlohmann::json measure(const Wanted& wanted) {
  std::vector<Contestant> here;
  for (Contestant& c : contestants())
    if (wanted.takes_method(c.name)) here.push_back(std::move(c));
  std::vector<std::string> elsewhere;
  if (!wanted.read.empty())
    for (const auto& entry : fs::directory_iterator(wanted.read))
      if (entry.is_directory() && wanted.takes_method(entry.path().filename()))
        elsewhere.push_back(entry.path().filename());
  std::sort(elsewhere.begin(), elsewhere.end());

  nlohmann::json rows = nlohmann::json::array();
  for (const Case& c : cases()) {
    if (!wanted.takes(c)) continue;
    std::vector<Picture> pictures;
    std::vector<cv::Mat1d> light;
    for (int f = 0; f < wanted.frames; ++f) {
      pictures.push_back(c.make(seed_of(f)));
      light.push_back(expected(pictures.back()));
    }
    for (const double snr : c.snr) {
      if (!wanted.takes(snr)) continue;
      std::cerr << fmt::format("locate_truth: {}, SNR {:g}\n", c.name, snr);
      std::vector<Row> table;
      for (const Contestant& who : here) table.push_back({who.name, {}});
      for (const std::string& who : elsewhere) table.push_back({who, {}});
      for (std::size_t f = 0; f < pictures.size(); ++f) {
        const std::vector<double> bound = cramer_rao_bound(light[f], pictures[f], snr);
        const cv::Mat1b frame = expose(light[f], pictures[f], snr, seed_of(static_cast<int>(f)));
        for (std::size_t k = 0; k < table.size(); ++k) {
          if (f > 0 && table[k].ms > kPatience_ms && k < here.size()) continue;
          std::vector<cv::Point2d> found;
          double ms = 0;
          if (k < here.size()) {
            ms = time_of(here[k], frame, c, found);
          } else {
            const auto reported = read_found(fs::path(wanted.read) / table[k].method /
                                             (frame_name(c, snr, static_cast<int>(f)) + ".csv"));
            if (!reported) continue;
            ms = reported->ms;
            found = reported->found;
          }
          table[k].ms = std::min(table[k].ms, ms);
          table[k].scores.add(pictures[f], found, bound);
        }
      }
      for (const Row& row : table) {
        const CentreScores::Summary s = row.scores.summary();
        if (s.beads == 0) continue;
        nlohmann::json j = as_json(s);
        j["case"] = c.name;
        j["what"] = c.what;
        j["snr"] = snr;
        j["method"] = row.method;
        j["ms_per_frame"] = row.ms;
        rows.push_back(std::move(j));
      }
    }
  }
  return rows;
}

// Tries every OpenCV setting on one frame and lists the best first, by the harmonic mean of recall and
// precision, then by rms.
void tune() {
  const Case& c =
      *std::find_if(cases().begin(), cases().end(), [](const Case& k) { return k.name == "random"; });
  const Picture picture = c.make(99);
  const cv::Mat1b frame = expose(expected(picture), picture, 51, 99);
  const std::vector<double> bound(picture.discs.size(), 1);
  struct Try {
    std::string name;
    CentreScores::Summary s;
    double f;
  };
  std::vector<Try> tries;
  for (const auto& [name, settings] : hough_grid()) {
    CentreScores scores;
    scores.add(picture, opencv_hough(frame, c, settings), bound);
    const CentreScores::Summary s = scores.summary();
    tries.push_back(
        {name, s, std::round(100 * 2 * s.recall * s.precision / std::max(1e-9, s.recall + s.precision))});
  }
  std::sort(tries.begin(), tries.end(),
            [](const Try& a, const Try& b) { return a.f != b.f ? a.f > b.f : a.s.rms < b.s.rms; });
  for (const Try& t : tries)
    std::cout << fmt::format("{:60} recall {:.4f} precision {:.4f} rms {:.4f} bias {:+.3f} {:+.3f}\n", t.name,
                             t.s.recall, t.s.precision, t.s.rms, t.s.bias_x, t.s.bias_y);
}

}  // namespace

int main(int argc, char** argv) {
  twincell::tune_malloc();
  Wanted wanted;
  CLI::App program("Locators against rendered truth and the Cramér-Rao bound");
  program.add_option("--case", wanted.cases, "Only this case");
  program.add_option("--snr", wanted.snr, "Only this signal-to-noise ratio");
  program.add_option("--method", wanted.methods, "Only methods with this in their name");
  program.add_option("--frames", wanted.frames, "Frames per case and noise level")
      ->check(CLI::Range(1, 1000));
  program.add_option("--write", wanted.write, "Only write the frames into this folder");
  program.add_option("--read", wanted.read, "Folder with what others found");
  program.add_flag("--tune", wanted.tune, "Search OpenCV's settings");
  CLI11_PARSE(program, argc, argv);
  cv::setNumThreads(1);
  if (wanted.tune)
    tune();
  else if (!wanted.write.empty())
    write_frames(wanted);
  else
    std::cout << nlohmann::json{{"rows", measure(wanted)}}.dump(1) << "\n";
  return 0;
}
