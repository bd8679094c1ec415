#include "cli/device_option.hpp"

#include <CLI/CLI.hpp>

#include "cli/output.hpp"

namespace twincell::cli {

namespace {

/// Beds at once on a graphics card, unless --threads states them.
constexpr int kBeds = 256;

}  // namespace

CLI::Option* add_device_option(CLI::App& verb, std::string& device) {
  return verb
      .add_option(
          "--device", device,
          "Run the beds on a device, with the same results. gpu: a graphics card, with as many beds at "
          "once as --threads states, by default 256; host: the same kernel on the processor, to test "
          "it (docs/gpu.md)")
      ->check(CLI::IsMember({"gpu", "host"}));
}

Workers workers_of(const std::string& device, const Common& common) {
  if (device == "host") return {sim::SolverKind::device_on_host, common.n_threads()};
  if (device != "gpu") return {sim::SolverKind::best, common.n_threads()};
  note(common, sim::graphics_card() + ".");
  return {sim::SolverKind::gpu, common.threads > 0 ? common.threads : kBeds};
}

}  // namespace twincell::cli
