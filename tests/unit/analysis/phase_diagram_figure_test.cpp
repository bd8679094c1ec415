// The static phase diagram: brackets of the onsets, and the phases between them.
#include "analysis/report/phase_diagram_figure.hpp"

#include <gtest/gtest.h>

namespace twincell::analysis::phase_diagram_figure_test {
namespace {

using Runs = std::vector<Run>;  // in the body of a test `Run` is a name of googletest

/// Experiments and simulations that bounce above Gamma = 1 and convect above 2, at each strength.
Runs runs_at(double n_l, std::initializer_list<double> gammas) {
  Runs runs;
  for (const Side side : {Side::experiment, Side::simulation})
    for (const double gamma : gammas) {
      Run& run = runs.emplace_back();
      run.side = side;
      run.gamma = gamma;
      run.k_m = gamma * gamma;
      run.omega = 1;
      run.n_l = n_l;
      run.phase = gamma > 2 ? BedPhase::convecting : gamma > 1 ? BedPhase::bouncing : BedPhase::co_moving;
    }
  return runs;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(PhaseDiagramFigure, OnsetsAreBarsAndThePhasesBetweenThemAreShaded) {
  const Runs runs = runs_at(8, {0.8, 1.4, 2.5});
  const Figure f = phase_diagram_figure(runs, find_boundaries(runs));
  EXPECT_EQ(count(f.plot, "set arrow"), 4U) << f.plot;
  EXPECT_EQ(count(f.plot, ",0.8 to "), 2U) << f.plot;  // the bracket of bouncing, 0.8 to 1.4, on both sides
  EXPECT_EQ(count(f.plot, ",1.4 heads"), 2U) << f.plot;
  EXPECT_EQ(count(f.plot, "set object rectangle"), 2U) << "between 1.4 and 1.4 there is nothing to shade";
  EXPECT_EQ(count(f.plot, "title 'onset of convection, experiment'"), 1U);
  const Runs more = runs_at(8, {0.8, 1.2, 1.8, 2.5});
  EXPECT_EQ(count(phase_diagram_figure(more, find_boundaries(more)).plot, "set object rectangle"), 3U);
}

TEST(PhaseDiagramFigure, WithoutAnOnsetOrWithSeveralHeightsNothingIsShaded) {
  const Runs one = runs_at(8, {0.8});
  const Figure alone = phase_diagram_figure(one, find_boundaries(one));
  EXPECT_EQ(count(alone.plot, "set arrow") + count(alone.plot, "set object"), 0U) << alone.plot;
  Runs two = runs_at(8, {0.8, 1.4, 2.5});
  const Runs high = runs_at(20, {0.8, 1.4, 2.5});
  two.insert(two.end(), high.begin(), high.end());
  const Figure both = phase_diagram_figure(two, find_boundaries(two));
  EXPECT_EQ(count(both.plot, "set arrow"), 8U);
  EXPECT_EQ(count(both.plot, "set object"), 0U) << "the onsets of two heights need not be the same";
}

}  // namespace
}  // namespace twincell::analysis::phase_diagram_figure_test
