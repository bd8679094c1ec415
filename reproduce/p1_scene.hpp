#pragma once
/// \file
/// The cell of Fortini & Huang 2015 as all reproductions of that paper run it, and what is to be said of it
/// beside every number.

#include <string>
#include <vector>

namespace twincell::reproduce {

/// One run of the paper's cell.
struct P1Run {
  int layers;         ///< N_l
  std::string start;  ///< "random", "crystal_a", "crystal_b", or empty for a plan whose axes say it
  int cycles;         ///< N_f
  double discard = 10;
};

/// The scene as a table [scene] of a plan. Split at n = 6.37 is no less accurate than Verlet at n = 50 in any
/// single collision, and 3.7 times quicker (docs/accuracy.md). A crystal is perturbed by 1e-9 sigma: that
/// breaks its mirror symmetry and makes ensembles of it.
std::string p1_scene(const P1Run& run);

/// What a reproduction must state: n, k_n, damping, friction, tension and slip rule, start, cycles, phases,
/// conventions, read off the scene that is run.
std::vector<std::string> p1_conditions(const P1Run& run);

/// Of those, what does not depend on the run: cell, contacts, tension and slip rule.
std::vector<std::string> p1_contact_conditions();
/// Of those, how it is stepped.
std::string p1_step_condition(const P1Run& run);

/// The sentence on the integrator for Reproduction::cheaper.
std::string p1_cheaper_steps();

}  // namespace twincell::reproduce
