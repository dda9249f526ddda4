// Temporary files for output that is not finished. In: a folder. Out: a new file in it, locked as
// long as the process that made it has it open. So a later run can find the files of runs that were
// killed, and remove them.
#pragma once

#include <cstddef>
#include <string>

namespace dapple {

struct TemporaryFile {
  std::string path;
  int descriptor = -1;  ///< for reading and writing; closing its last duplicate unlocks
};

/// Makes a new, empty, locked file in `folder`. The descriptor is -1, and errno is set, when that
/// fails.
TemporaryFile create_temporary_file(const std::string& folder);

/// Removes the temporary files in `folder` whose processes have ended; returns how many. Locks of
/// other hosts may not be visible here, so their files must also be unchanged for a day. Files that
/// cannot be opened or removed stay.
std::size_t remove_abandoned_files(const std::string& folder);

}  // namespace dapple
