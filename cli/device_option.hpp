#pragma once
/// \file
/// Option --device of the verbs that run many beds at once.

#include <string>

#include "sim/run/make_solver.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace twincell::cli {

struct Common;

/// Adds --device to a verb.
/// \returns the option
CLI::Option* add_device_option(CLI::App& verb, std::string& device);

/// Where the beds are computed, and how many at once.
struct Workers {
  sim::SolverKind solver = sim::SolverKind::best;
  int count = 1;
};
/// The workers that --device and --threads ask for. Notes the name of a graphics card.
/// \throws ConfigError if there is none
Workers workers_of(const std::string& device, const Common& common);

}  // namespace twincell::cli
