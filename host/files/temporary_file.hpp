// Unfinished files: made beside what they will become under a name of their own, locked as long
// as their maker lives, so that a later run can tell what a dead one left behind and remove it.
#pragma once

#include <cstddef>
#include <string>

namespace dapple {

struct TemporaryFile {
  std::string path;
  int descriptor = -1;  ///< open for reading and writing; the lock ends with its last duplicate
};

/// A new, empty, locked file in `folder`. Descriptor -1 and errno when that cannot be.
TemporaryFile create_temporary_file(const std::string& folder);

/// Removes the temporary files in `folder` whose makers are dead; returns how many. Those of
/// other hosts, whose locks may not reach here, only when they have not changed for a day. What
/// cannot be read or removed is left.
std::size_t remove_abandoned_files(const std::string& folder);

}  // namespace dapple
