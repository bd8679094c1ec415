#include "imaging/link/link_options.hpp"

#include <algorithm>

namespace twincell::imaging {

void LinkReport::add(const LinkReport& f) {
  frames += f.frames;
  links += f.links;
  settled += f.settled;
  bridged += f.bridged;
  ambiguous += f.ambiguous;
  births += f.births;
  losses += f.losses;
  edges += f.edges;
  networks += f.networks;
  largest_network = std::max(largest_network, f.largest_network);
  unsolved += f.unsolved;
  rematched += f.rematched;
  unclear_shifts += f.unclear_shifts;
}

}  // namespace twincell::imaging
