// The CPUs that this process may run on, by the scheduler's mask. Out: their numbers, by which
// host/device chooses numbers of threads and processes.
#pragma once

#include <sched.h>

#include <vector>

namespace dapple {

/// CPU numbers, ascending. Empty when the system call fails, as with more than 1,024 CPUs.
inline std::vector<int> cpus_of_process() {
  cpu_set_t ours;
  std::vector<int> cpus;
  if (sched_getaffinity(0, sizeof ours, &ours) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &ours)) cpus.push_back(cpu);
  return cpus;
}

}  // namespace dapple
