#pragma once
/// \file
/// Reproduction of a figure or table of the papers: targets, measured values, and simplifications.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/report/figure.hpp"
#include "reproduce/verdict.hpp"
#include "sweep/farm.hpp"

namespace twincell::reproduce {

/// One number or statement of the paper, with the measured value and the verdict.
struct Target {
  std::string name;      ///< "onset of bouncing, random, N_l = 20"
  std::string expected;  ///< "1.10 to 1.35"
  std::string measured;  ///< with interval
  Verdict verdict = Verdict::absent;
  std::string reason;     ///< what decides the verdict, if needed
  std::string runs = {};  ///< seeds and cycles behind the number; empty: Reproduction::runs
  /// Why the target is not in the sum of papers.md: "the same as in `p1-fig3`"; empty: it is.
  std::string not_counted = {};
};

/// Budget and options of a reproduction.
struct Request {
  double minutes = 10;  ///< clock time; ignored if full
  bool full = false;    ///< use the paper's own numbers, without a time limit
  int threads = 1;
  std::uint64_t seed = 1;
  std::filesystem::path folder;     ///< folder of the sweep; existing results are used
  std::filesystem::path runs = {};  ///< folder of runs that figures share (Reproducible::shared_runs)
  std::optional<std::pair<double, double>> window = {};  ///< the user's own window of W
  std::filesystem::path data = {};                       ///< the user's own points, CSV; empty: none
  std::string stored = {};  ///< Reproduction::measured of an earlier call: nothing runs, only the verdicts
                            ///< and figures are made anew; empty: none
  sweep::Watch* watch = nullptr;                   ///< must not be null when a reproduction runs
  sim::SolverKind solver = sim::SolverKind::best;  ///< of figures with Reproducible::on_device

  [[nodiscard]] sweep::FarmOptions farm() const { return {.threads = threads, .solver = solver}; }
};

/// Complete result of a reproduction.
struct Reproduction {
  std::string title;
  std::vector<Target> targets;
  std::vector<std::string> cheaper;          ///< simplifications relative to the paper, in sentences
  std::vector<std::string> conditions = {};  ///< conditions to state with each number, in sentences
  std::string runs = {};  ///< seeds and cycles behind the numbers: "3 runs a point, 200 cycles"
  std::string table;      ///< measured values as a text table
  std::string measured;   ///< measured values as JSON
  std::vector<analysis::Figure> figures;
  bool complete = false;  ///< false if the time ran out; the same command continues
};

/// One entry of the list. A file p1_fig3.cpp defines `Reproducible p1_fig3()`.
struct Reproducible {
  std::string name;  ///< "p1-fig3"
  std::string what;  ///< one line
  std::function<Reproduction(const Request&)> run;
  std::string shared_runs = {};  ///< folder of runs that other figures also use, next to the figure's
  bool takes_data = false;       ///< whether it uses Request::window or Request::data
  bool judges_stored = false;    ///< whether it can use Request::stored
  bool on_device = false;        ///< whether its beds can run on a device: a sweep of time steps
  double time_share = 1;         ///< share of the time of `reproduce --all`, relative to the others
  std::string runs_like = {};    ///< entry whose runs this one needs: `--all` gives it the same budget for
                                 ///< them, and no time of its own
  /// Its targets are those of other figures under other assumptions, or checks of the program, and no
  /// statements of the papers about results: papers.md leaves them out of its sum.
  bool judges_again = false;
  std::string same_as = {};  ///< entry with the same targets: `--all` leaves this one out
};
/// All reproductions. To add one: its file with its test, and its word in the list of list.cpp.
const std::vector<Reproducible>& list();

}  // namespace twincell::reproduce
