#include "sim/event_driven/collision.hpp"

#include <variant>

#include "sim/laws/contact_laws.hpp"

namespace twincell::sim {

double collision_time(const CollisionSetting& setting, double speed) {
  return std::visit([&](const auto& law) { return law.shortest_time(setting.pair, speed); },
                    setting.laws->normal);
}

}  // namespace twincell::sim
