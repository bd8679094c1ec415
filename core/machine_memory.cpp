#include "core/machine_memory.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

namespace twincell {

namespace {

/// Sum of "MemAvailable: 1234 kB" and "SwapFree: ...", bytes; infinite without MemAvailable.
double of_system() {
  std::ifstream info("/proc/meminfo");
  double bytes = 0;
  bool found = false;
  for (std::string line; std::getline(info, line);)
    for (const std::string name : {"MemAvailable:", "SwapFree:"})
      if (line.starts_with(name)) {
        bytes += 1024 * std::strtod(line.c_str() + name.size(), nullptr);
        found = found || name == "MemAvailable:";
      }
  return found ? bytes : HUGE_VAL;
}

/// Lowest limit of the process's group and all groups above it, bytes.
double of_groups() {
  std::ifstream groups("/proc/self/cgroup");
  double least = HUGE_VAL;
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::/")) continue;  // cgroup version 2
    for (std::string path = line.substr(3);; path.erase(path.rfind('/'))) {
      double most = 0;
      if (std::ifstream limit("/sys/fs/cgroup" + path + "/memory.max"); limit >> most)
        least = std::min(least, most);
      if (path.find('/') == std::string::npos || path.empty()) break;
    }
  }
  return least;
}

double of_process() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return HUGE_VAL;
  return static_cast<double>(limit.rlim_cur);
}

}  // namespace

double memory_available() {
  return std::min({of_system(), of_groups(), of_process()});
}

}  // namespace twincell
