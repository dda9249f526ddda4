// Tells whether two paths name one file: see output_paths.hpp.
#include "commands/arguments/output_paths.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>

#include "dapple/error.hpp"
#include "files/output_file.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

/// Without links in its folders; empty if it has none.
std::string whole_path(const std::string& path) {
  std::error_code error;
  // Absolute first: weakly_canonical() does not change a relative path that does not exist.
  const fs::path whole = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? std::string() : whole.string();
}

/// Existing files are the same if device and inode are, also through symbolic and hard links.
/// Others are the same if their folders and names are.
bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const std::string whole = whole_path(a);
  return !whole.empty() && whole == whole_path(b);
}

[[noreturn]] void refuse(const OutputPath& output, const std::string& why) {
  throw Error(ErrorKind::usage, fmt::format("{} {}: {}", output.flag, output.path, why));
}

}  // namespace

bool has_frame_digits(const std::string& path) {
  return fs::path(path).filename().string().find('#') != std::string::npos;
}

std::string frame_path(const std::string& pattern, std::int64_t number) {
  const std::size_t last = pattern.find_last_of('#');
  const std::size_t before = pattern.find_last_not_of('#', last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return fmt::format("{}{:0{}}{}", pattern.substr(0, first), number, last - first + 1,
                     pattern.substr(last + 1));
}

void check_outputs(const std::vector<OutputPath>& outputs, Folders folders) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    try {
      check_output_path(outputs[i].path);
      if (folders == Folders::tidy) remove_abandoned_beside(outputs[i].path);
    } catch (const Error& error) {
      throw Error(error.kind(), fmt::format("{}: {}", outputs[i].flag, error.what()));
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (!is_same_file(outputs[i].path, outputs[k].path)) continue;
      refuse(outputs[i],
             fmt::format("is the same file as {} {}", outputs[k].flag, outputs[k].path));
    }
  }
}

void check_outputs_spare(const std::vector<OutputPath>& outputs,
                         const std::vector<std::string>& inputs) {
  const InputFiles files(inputs);
  for (const OutputPath& output : outputs) check_spares(output, files);
}

InputFiles::InputFiles(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    struct stat found {};
    if (stat(path.c_str(), &found) == 0)
      paths_.try_emplace({found.st_dev, found.st_ino}, path);
    else if (const std::string whole = whole_path(path); !whole.empty())
      missing_.try_emplace(whole, path);
  }
}

const std::string* InputFiles::same_as(const std::string& path) const {
  struct stat found {};
  if (stat(path.c_str(), &found) == 0) {
    const auto at = paths_.find({found.st_dev, found.st_ino});
    return at == paths_.end() ? nullptr : &at->second;
  }
  const auto at = missing_.empty() ? missing_.end() : missing_.find(whole_path(path));
  return at == missing_.end() ? nullptr : &at->second;
}

void check_spares(const OutputPath& output, const InputFiles& inputs) {
  if (const std::string* input = inputs.same_as(output.path))
    refuse(output, fmt::format("would overwrite {}, which is read", *input));
}

}  // namespace dapple
