#pragma once
/// \file
/// How much memory the process can still get.

namespace twincell {

/// Bytes: what the system says is available, swap included, or less where the process's group (cgroup v2) or
/// its own limit (`ulimit -v`) allows less. Infinite where the system does not say.
double memory_available();

}  // namespace twincell
