#include "sim/laws/contact_laws.hpp"

#include <type_traits>
#include <variant>

#include "sim/laws/separate_integration.hpp"

namespace twincell::sim {

bool remembers(const ContactLaws& laws) {
  if (laws.rolling.index() != 0) return false;
  return std::visit([]<class N, class T>(const N&, const T&) { return kRemembers<N, T>; }, laws.normal,
                    laws.tangential);
}

bool integrable_alone(const ContactLaws& laws) {
  if (laws.rolling.index() != 0) return false;
  return std::visit(
      []<class N, class T>(const N&, const T&) {
        return kRemembers<N, T> || (SmoothNormal<N> && PresentTangential<T>);
      },
      laws.normal, laws.tangential);
}

}  // namespace twincell::sim
