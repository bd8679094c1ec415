#pragma once
/// \file
/// Scene of the cell of Fortini & Huang 2015, which all reproductions of that paper share, and the conditions
/// to state with every number.

#include <string>
#include <vector>

namespace twincell::reproduce {

/// One run of the paper's cell.
struct P1Run {
  int layers;             ///< N_l
  std::string start;      ///< "random", "crystal_a", "crystal_b"; empty if an axis of the plan sets it
  int cycles;             ///< N_f
  double discard = 10;    ///< cycles before the first recorded one
  std::string keys = {};  ///< further keys of the scene, each with its line end
};

/// The scene as a table [scene] of a plan. The split integrator at n = 6.37 is as accurate as Verlet at n =
/// 50 in every measured quantity except e averaged over entry phases, with 7.9 times fewer steps
/// (docs/accuracy.md). A crystal is perturbed by 1e-9 sigma, which breaks its mirror symmetry and makes runs
/// with different seeds differ.
std::string p1_scene(const P1Run& run);

/// Conditions that a reproduction states, read from the scene that is run: n, k_n, damping, friction, tension
/// and slip rule, start, cycles, phases, conventions.
std::vector<std::string> p1_conditions(const P1Run& run);

/// The conditions on cell, contacts, tension and slip rule. \param keys P1Run::keys
std::vector<std::string> p1_contact_conditions(const std::string& keys = {});
/// The condition on integrator and time step.
std::string p1_step_condition(const P1Run& run);

/// Sentence on the integrator for Reproduction::cheaper.
std::string p1_cheaper_steps();

}  // namespace twincell::reproduce
