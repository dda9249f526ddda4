// Folders with a list of their files and checksums, so that a truncated, empty or missing file is
// found before it is used. In: a folder and names of files. Out: the list, or verified copies of
// the files. This protects against damage, not against malice.
#pragma once

#include <filesystem>
#include <vector>

namespace dapple {

/// Writes the list of `files`, which are paths relative to `folder`. False when a file cannot be
/// read or the list cannot be written.
bool seal(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files);

/// The paths that `sealed` lists; none when the list is damaged.
std::vector<std::filesystem::path> sealed_files(const std::filesystem::path& sealed);

/// Makes hard links, or copies, of the files that `sealed` lists in `target`, and adds their paths
/// to `files`. If a file differs from its checksum, removes them from `target` and returns false.
bool unseal(const std::filesystem::path& sealed, const std::filesystem::path& target,
            std::vector<std::filesystem::path>& files);

}  // namespace dapple
