#include "sim/laws/contact_laws.hpp"

#include <type_traits>
#include <variant>

#include "sim/laws/separate_integration.hpp"

namespace twincell::sim {

bool resists_rolling(const ContactLaws& laws) {
  return std::visit([]<class R>(const R&) { return R::kActs; }, laws.rolling);
}

bool remembers(const ContactLaws& laws) {
  if (resists_rolling(laws)) return false;
  return std::visit([]<class N, class T>(const N&, const T&) { return kRemembers<N, T>; }, laws.normal,
                    laws.tangential);
}

bool integrable_alone(const ContactLaws& laws) {
  if (resists_rolling(laws)) return false;
  return std::visit(
      []<class N, class T>(const N&, const T&) {
        return kRemembers<N, T> || (SmoothNormal<N> && PresentTangential<T>);
      },
      laws.normal, laws.tangential);
}

}  // namespace twincell::sim
