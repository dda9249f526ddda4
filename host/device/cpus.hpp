// The CPUs that this process may run on.
#pragma once

#include <sched.h>

#include <vector>

namespace dapple {

/// Their numbers, ascending; empty where the system does not tell, as of more than 1,024.
inline std::vector<int> cpus_of_process() {
  cpu_set_t ours;
  std::vector<int> cpus;
  if (sched_getaffinity(0, sizeof ours, &ours) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &ours)) cpus.push_back(cpu);
  return cpus;
}

}  // namespace dapple
