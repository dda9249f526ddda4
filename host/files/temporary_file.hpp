// Temporary files for output that is not finished. In: a folder. Out: a new file in it, locked as
// long as the process that made it has it open. So a later run can find the files of runs that were
// killed, and remove them.
#pragma once

#include <cstddef>
#include <string>

namespace dapple {

/// Files and folders of other hosts, whose locks may not be visible here, count as abandoned when
/// they have been unchanged for so long.
inline constexpr long kAbandonedSeconds = 24 * 60 * 60;

/// Eight digits that name this host in names of temporary files and folders.
std::string host_code();

struct TemporaryFile {
  std::string path;
  int descriptor = -1;  ///< for reading and writing; closing its last duplicate unlocks
};

/// Makes a new, empty, locked file in `folder`. The descriptor is -1, and errno is set, when that
/// fails.
TemporaryFile create_temporary_file(const std::string& folder);

/// Removes the temporary files in `folder` whose processes have ended; returns how many. Files of
/// other hosts must also be unchanged for kAbandonedSeconds. Files that cannot be opened or removed
/// stay.
std::size_t remove_abandoned_files(const std::string& folder);

}  // namespace dapple
