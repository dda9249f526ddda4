// Folders whose files are listed with their checksums, so that a truncated, emptied or missing
// one is noticed before anybody relies on it. Against damage, not against malice.
#pragma once

#include <filesystem>
#include <vector>

namespace dapple {

/// Writes the list of `files`, paths inside `folder`. False where one cannot be read or the list
/// not be written.
bool seal(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& files);

/// The paths that `sealed` lists; none where the list is damaged.
std::vector<std::filesystem::path> sealed_files(const std::filesystem::path& sealed);

/// Puts the files that `sealed` lists into `target`, by hard links where that goes, and their paths
/// into `files`. False, and nothing is left in `target`, where one is not what was sealed.
bool unseal(const std::filesystem::path& sealed, const std::filesystem::path& target,
            std::vector<std::filesystem::path>& files);

}  // namespace dapple
