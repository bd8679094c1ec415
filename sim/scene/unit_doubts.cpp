#include "sim/scene/unit_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/laws/parameters.hpp"
#include "trajectory/unit_checks.hpp"

namespace twincell::sim {

namespace {

void doubt_gravity(const Scene& s, std::vector<std::string>& doubts) {
  constexpr double kInMetres = 9.81, kNear = 0.01;
  if (s.scale.gravity_m_s2 && s.g() != 1)
    doubts.push_back(
        fmt::format("cell.gravity = {:g} is in units of scale.gravity_m_s2: gravity is {:.4g} m/s^2.", s.g(),
                    s.g() * *s.scale.gravity_m_s2));
  else if (std::abs(s.g() / kInMetres - 1) < kNear)
    doubts.push_back(
        fmt::format("cell.gravity = {:g} is in units of g, in which that of the Earth is 1.", s.g()));
}

/// Coefficients of friction above 3 are unknown among dry beads; those above 100 stand for beads that never
/// slip.
void doubt_friction(const Scene& s, std::vector<std::string>& doubts) {
  const auto in_percent = [](const ContactTable& table) {
    const double mu = read_friction(table);
    return mu > 3 && mu <= 100;
  };
  std::vector<const ContactTable*> tables = {&s.contact.bead};
  for (const auto& [name, table] : s.contact.wall) tables.push_back(&table);
  const auto found =
      std::find_if(tables.begin(), tables.end(), [&](const auto* t) { return in_percent(*t); });
  if (found == tables.end()) return;
  const double mu = read_friction(**found);
  doubts.push_back(fmt::format("{} = {:g} is more friction than beads have; a coefficient of {:g} % is {:g}.",
                               (*found)->where("mu").key, mu, mu, mu / 100));
}

}  // namespace

std::vector<std::string> doubtful_units(const Scene& s) {
  std::vector<std::string> doubts;
  doubt_friction(s, doubts);
  if (s.radius == 1.0)
    doubts.emplace_back(
        "beads of radius 1 sigma are 2 sigma wide; sigma is the diameter of a bead, whose radius is 0.5.");
  if (!(s.g() > 0)) return doubts;
  doubt_gravity(s, doubts);
  for (std::string& doubt : implausible_numbers(shaken_cell(s.scale, s.drive)))
    doubts.push_back(std::move(doubt));
  return doubts;
}

}  // namespace twincell::sim
