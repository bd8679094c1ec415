#include "sim/stepping/listed_beads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "sim/laws/cell_laws.hpp"

namespace twincell::sim {

BeadOrder BeadOrder::by_cells(const std::vector<Bead>& beads, double cell) {
  BeadOrder order;
  order.bead.resize(beads.size());
  std::iota(order.bead.begin(), order.bead.end(), 0);
  std::vector<std::array<double, 3>> key(beads.size());
  for (std::size_t b = 0; b < beads.size(); ++b) {
    const auto whole = [&](double x) { return std::abs(x) < 1e9 ? std::floor(x / cell) : 1e9; };
    key[b] = {whole(beads[b].z), whole(beads[b].y), whole(beads[b].x)};
  }
  std::stable_sort(order.bead.begin(), order.bead.end(), [&](std::int32_t a, std::int32_t b) {
    return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)];
  });
  order.place.resize(beads.size());
  for (std::size_t k = 0; k < order.bead.size(); ++k)
    order.place[static_cast<std::size_t>(order.bead[k])] = static_cast<std::int32_t>(k);
  return order;
}

ListedBeads::ListedBeads(const Plan& of, const Target& target)
    : plan(of),
      kernels(target.find(of.key)),
      layout{static_cast<std::size_t>(target.width), static_cast<std::size_t>(of.dimension),
             static_cast<std::size_t>(kernels.remembered)},
      packed(plan) {}

void ListedBeads::set_shared_constants() {
  if (!packed.equal() || packed.size() == 0 || !of_pairs.empty()) return;
  of_pairs = layout.broadcast(pair_constants(plan, packed, 0, 0));
  for (std::size_t w = 0; w < plan.laws->walls.size(); ++w)
    of_walls.push_back(layout.broadcast(wall_constants(plan, packed, w, 0)));
}

}  // namespace twincell::sim
