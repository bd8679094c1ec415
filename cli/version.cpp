#include "cli/version.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/provenance.hpp"

namespace twincell::cli {

std::string version_text() {
  const auto known = nlohmann::json::parse(version_json());
  const auto& libraries = known["libraries"];
  return fmt::format("{}\nbuild      {}, {}\nlibraries  OpenCV {}, HDF5 {}, Ceres {}, Eigen {}\n",
                     version_line(), TWINCELL_BUILD_TYPE, known["compiler"].get<std::string>(),
                     TWINCELL_OPENCV, libraries["hdf5"].get<std::string>(), TWINCELL_CERES,
                     libraries["eigen"].get<std::string>());
}

}  // namespace twincell::cli
