#pragma once
/// \file
/// What --version prints.

#include <string>

namespace twincell::cli {

/// Version and commit, build type and compiler, versions of the libraries, one per line.
std::string version_text();

}  // namespace twincell::cli
