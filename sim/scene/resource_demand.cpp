#include "sim/scene/resource_demand.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace twincell::sim {

std::string bytes_text(double bytes) {
  static constexpr const char* kUnits[] = {"bytes", "kB", "MB", "GB", "TB", "PB"};
  std::size_t unit = 0;
  for (; bytes >= 1000 && unit + 1 < std::size(kUnits); ++unit) bytes /= 1000;
  return fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

ResourceDemand resource_demand(const Scene& s, const Plan& plan, std::size_t beads) {
  const auto n = static_cast<double>(beads);
  const bool flat = s.dimension == 2;
  const bool unlike = s.spread != SizeSpread::none || s.intruder || start_row(s.start).from_file;
  ResourceDemand demand;
  demand.memory = n * ((flat ? 3000 : 4600) + (unlike ? 1500 : 0));
  const double spins = !plan.rotation ? 0 : flat ? 1 : 3;
  demand.frames = static_cast<double>(s.cycles) * s.phases;
  demand.disk = demand.frames * n * 0.85 * 8 * (2 * s.dimension + spins);
  // Between a bed in flight and a dense packing: a contact per bead, 8 float and 2 integer numbers.
  constexpr double kBytesOfContact = 30;
  if (s.contacts) demand.disk += demand.frames * n * kBytesOfContact;
  return demand;
}

void require_memory(const Scene& s, const Plan& plan, std::size_t beads, double available) {
  const ResourceDemand demand = resource_demand(s, plan, beads);
  if (demand.memory <= available) return;
  const bool layers = s.source && s.source->has("beads.layers");
  throw ConfigError(
      s.where(layers ? "beads.layers" : "beads.count"),
      fmt::format("requests {} beads, which need about {} of memory; the machine has {} available.", beads,
                  bytes_text(demand.memory), bytes_text(available)));
}

void require_disk(const Scene& s, const Plan& plan, std::size_t beads, const std::filesystem::path& output) {
  std::error_code unknown;
  const auto parent = std::filesystem::absolute(output).parent_path();
  const std::filesystem::space_info disk = std::filesystem::space(parent, unknown);
  const ResourceDemand demand = resource_demand(s, plan, beads);
  if (unknown || demand.disk <= static_cast<double>(disk.available)) return;
  throw ConfigError(
      s.where("time.cycles"),
      fmt::format("{} cycles of {} frames of {} beads take at least {}; the disk of {} has {} free.",
                  s.cycles, s.phases, beads, bytes_text(demand.disk), output.string(),
                  bytes_text(static_cast<double>(disk.available))));
}

}  // namespace twincell::sim
