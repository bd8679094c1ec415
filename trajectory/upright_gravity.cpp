#include "trajectory/upright_gravity.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/error.hpp"

namespace twincell {

double upright_share_of_gravity(const TrajectoryInfo& info) {
  const auto provenance = nlohmann::json::parse(info.provenance_json, nullptr, false);
  if (!provenance.is_object() || !provenance.contains("config") || !provenance.at("config").is_string())
    return 1;
  try {
    const Config scene = Config::from_text(provenance.at("config").get<std::string>(), "scene");
    const ConfigSection cell = scene.root().section("cell");
    if (!cell.is_list("gravity")) return std::cos(cell.number("tilt").value_or(0) * std::numbers::pi / 180);
    const std::vector<double> g =
        cell.numbers("gravity", cell.number("dimension").value_or(2) == 3 ? 3 : 2).value();
    double squares = 0;
    for (const double component : g) squares += component * component;
    return squares > 0 ? -g.back() / std::sqrt(squares) : 1;
  } catch (const ConfigError&) {  // the configuration of another program, or a damaged one
    return 1;
  }
}

}  // namespace twincell
