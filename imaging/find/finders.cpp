#include <tuple>

#include "imaging/find/finder.hpp"
#include "imaging/find/hough_finder.hpp"
#include "imaging/find/vote_finder.hpp"

namespace twincell::imaging {

namespace {

// The list of finders; the first is the default.
using Finders = std::tuple<VoteFinder, HoughFinder>;

template <class Visit>
void for_each_finder(Visit&& visit) {
  std::apply(
      [&]<CircleFinder... F>(const F&...) { (visit.template operator()<F>(), ...); }, Finders{});
}

}  // namespace

std::vector<Proposal> propose(const std::string& finder, const Prepared& image, const FindOptions& options) {
  std::vector<Proposal> found;
  for_each_finder([&]<class F>() {
    if (F::name == finder) found = F::find(image, options);
  });
  return found;
}

std::vector<std::string> finder_names() {
  std::vector<std::string> names;
  for_each_finder([&]<class F>() { names.emplace_back(F::name); });
  return names;
}

}  // namespace twincell::imaging
