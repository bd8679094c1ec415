#include "core/progress.hpp"

namespace twincell {

Progress& Progress::none() {
  static Progress silent;
  return silent;
}

}  // namespace twincell
