#pragma once
/// \file
/// Memory that the process can still allocate.

namespace twincell {

/// Available memory, bytes: what the system reports as available including swap, or the limit of the
/// process's group (cgroup v2) or of the process itself (`ulimit -v`) if that is lower. Infinite if the
/// system reports none of these numbers.
double memory_available();

}  // namespace twincell
