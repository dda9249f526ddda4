// How much memory the process may use. In: what Linux says of the machine and of control groups.
// Out: bytes.
#pragma once

#include <filesystem>
#include <string_view>

namespace dapple {

/// The memory of the machine, or the limit of the process's control group, such as a batch system
/// or a container sets, if that is less. In bytes; not above 0: unknown.
double machine_bytes();

/// The least limit of the memory groups in `membership`, the text of /proc/self/cgroup, and of
/// those above them, which are folders below `root`; infinity if there is none. Groups of both
/// versions count (kernel.org, "Control Group v2" and "Memory Resource Controller").
double group_limit(std::string_view membership, const std::filesystem::path& root);

}  // namespace dapple
