#pragma once
/// \file
/// What it means to reproduce a figure or table of the papers: targets, what was measured, and what was
/// cheaper.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/report/figures.hpp"
#include "sweep/farm.hpp"

namespace twincell::reproduce {

/// How a target fared.
enum class Verdict {
  met,
  missed,
  open,    ///< the measurement does not decide
  absent,  ///< not measured
};
/// "met", "MISSED", "open", "absent".
std::string word_of(Verdict fate);

/// One number or statement of the paper beside what was measured.
struct Target {
  std::string name;      ///< "onset of bouncing, random, N_l = 20"
  std::string wanted;    ///< "1.10 to 1.35"
  std::string measured;  ///< with interval
  Verdict fate = Verdict::absent;
  std::string reason;  ///< why, where that is not plain
};

/// How much may be spent.
struct Request {
  double minutes = 10;  ///< of clock time; ignored if full
  bool full = false;    ///< whatever the paper's own numbers take
  int threads = 1;
  std::uint64_t seed = 1;
  std::filesystem::path folder;     ///< for the sweep; taken up if it is there
  std::filesystem::path runs = {};  ///< for runs that several figures share (Reproducible::shared_runs)
  std::optional<std::pair<double, double>> window = {};  ///< the user's own window of W
  std::filesystem::path data = {};                       ///< the user's own points, CSV; empty: none
  sweep::Watch* watch = nullptr;                         ///< never null when a reproduction runs
};

/// All that is to be said.
struct Reproduction {
  std::string title;
  std::vector<Target> targets;
  std::vector<std::string> cheaper;          ///< what was cheaper than the paper, in sentences
  std::vector<std::string> conditions = {};  ///< what must be stated beside each number, in sentences
  std::string table;                         ///< what was measured, for a reader
  std::string measured;                      ///< the same as JSON
  std::vector<Figure> figures;
  bool complete = false;  ///< false: the time was up; the same command goes on
};

/// One entry of the list: a file p1_fig3.cpp has a `Reproducible p1_fig3()`.
struct Reproducible {
  std::string name;  ///< "p1-fig3"
  std::string what;  ///< one line
  std::function<Reproduction(const Request&)> run;
  std::string shared_runs = {};  ///< folder beside the figure's where runs lie that other figures use too
  bool takes_data = false;       ///< whether Request::window and Request::data mean something to it
};
/// All that can be reproduced. To add one: its file, a line here, a word in list.cpp, a test.
const std::vector<Reproducible>& list();

Reproducible p1_fig1();
Reproducible p1_fig2();
Reproducible p1_fig3();
Reproducible p1_fig4();
Reproducible p1_fig5();
Reproducible p1_table1();
Reproducible p1_appendix();
Reproducible p1_step();
Reproducible p2_fig2();
Reproducible p2_fig3();
Reproducible p2_fig4();
Reproducible p2_fig5();
Reproducible p2_fig6();
Reproducible p2_fig7();
Reproducible p2_fig8();
Reproducible p2_fig9();
Reproducible p2_fig10();
Reproducible p2_fig11();
Reproducible p2_fig12();
Reproducible p2_fig13();
Reproducible p2_fig14();
Reproducible p2_fig15();
Reproducible p2_fig16();
Reproducible p2_table1();
Reproducible p2_table2();
Reproducible p2_table3();

/// Whether an onset lies within [low, high]: met if its value does, missed if its whole interval does not,
/// else open.
Verdict within(const sweep::Onset& onset, double low, double high);
/// Whether one onset lies above another: met or missed if the opposite is excluded (evidence_above), else
/// open.
Verdict above(const sweep::Onset& upper, const sweep::Onset& lower);

}  // namespace twincell::reproduce
