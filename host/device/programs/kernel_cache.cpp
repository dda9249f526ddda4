#include "device/programs/kernel_cache.hpp"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "dapple/error.hpp"
#include "device/programs/sealed_folder.hpp"
#include "files/checksum.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

/// Maximum number of programs kept, each about 300 kB; the least recently used are removed first.
constexpr std::size_t kMaxPrograms = 96;

/// Free disk space that is required: several times what compiling every kernel needs.
constexpr std::uint64_t kBytesNeeded = 8u << 20;

/// Characters. PoCL builds paths in 1,024 characters and does not check their length; about 200 of
/// them are its own.
constexpr std::size_t kMaxPathLength = 700;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// The folder to keep compiled kernels in; empty when none of the environment variables is set.
fs::path cache_path() {
  if (const std::string chosen = variable("POCL_CACHE_DIR"); !chosen.empty()) return chosen;
  if (const std::string cache = variable("XDG_CACHE_HOME"); !cache.empty())
    return fs::path(cache) / "dapple" / "kernels";
  if (const std::string home = variable("HOME"); !home.empty())
    return fs::path(home) / ".cache" / "dapple" / "kernels";
  return {};
}

/// Why PoCL could not compile in `folder`, which exists; empty when it can.
std::string refusal(const fs::path& folder) {
  struct statvfs status {};
  if (folder.native().size() > kMaxPathLength) return "the name is too long for PoCL";
  if (statvfs(folder.c_str(), &status) != 0) return {};
  if (status.f_flag & ST_NOEXEC) return "programs may not be run from there (mounted noexec)";
  const auto bytes = static_cast<std::uint64_t>(status.f_bavail) * status.f_frsize;
  if (bytes >= kBytesNeeded) return {};
  return fmt::format("no space left ({} bytes, compiling needs {})", bytes, kBytesNeeded);
}

std::string entry_name(const std::string& text) { return hex_text(checksum(text)).substr(0, 16); }

}  // namespace

KernelCache& KernelCache::of_process() {
  static KernelCache cache;
  return cache;
}

KernelCache::KernelCache() {
  const fs::path chosen = cache_path();
  if (!chosen.empty() && use(chosen)) {
    store_ = fs::absolute(chosen);
    return;
  }
  // Kernels are not kept there: where everybody may write, others could plant kernels.
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  if (!error && use(temporary)) return;
  if (temporary != "/tmp") use("/tmp");
}

bool KernelCache::use(const fs::path& parent) {
  std::string reason;
  try {
    auto folder = std::make_unique<PrivateFolder>(fs::absolute(parent));
    reason = refusal(folder->path());
    if (reason.empty()) private_ = std::move(folder);
  } catch (const std::exception& error) {
    reason = error.what();
  }
  if (private_) return true;
  refusals_ += (refusals_.empty() ? "" : "; ") + parent.string() + ": " + reason;
  return false;
}

fs::path KernelCache::folder() const { return private_ ? private_->path() / "pocl" : fs::path(); }

std::string KernelCache::shortage() const {
  const std::string reason = private_ ? refusal(private_->path()) : "";
  return reason.empty() ? "" : fmt::format("{}: {}", private_->path().string(), reason);
}

KernelCache::Files KernelCache::program_folders() const {
  Files found;
  std::error_code ignored;
  for (const fs::directory_entry& first : fs::directory_iterator(folder(), ignored)) {
    if (!first.is_directory(ignored)) continue;
    for (const fs::directory_entry& second : fs::directory_iterator(first, ignored))
      found.insert(fs::path(first.path().filename()) / second.path().filename());
  }
  return found;
}

KernelCache::Files KernelCache::compiled_files(const Program& program) const {
  Files found;
  std::error_code ignored;
  for (const fs::path& part : program.folders) {
    if (!fs::exists(folder() / part / "program.bc", ignored)) continue;  // the compiler refused it
    for (const auto& entry : fs::recursive_directory_iterator(folder() / part, ignored)) {
      const fs::path extension = entry.path().extension();
      if (extension == ".so" || extension == ".bc")
        found.insert(entry.path().lexically_relative(folder()));
    }
  }
  return found;
}

void KernelCache::restore(const fs::path& entry, Program& program) const {
  std::error_code ignored;
  std::vector<fs::path> files;
  if (!fs::exists(entry, ignored)) return;
  if (!unseal(entry, folder(), files)) {
    fs::remove_all(entry, ignored);
    return;
  }
  fs::last_write_time(entry, fs::file_time_type::clock::now(), ignored);
  program.kept = {files.begin(), files.end()};
}

bool KernelCache::has(const std::string& text, const std::string& kernel) const {
  if (!keeps()) return false;
  const std::vector<fs::path> files = sealed_files(store_ / entry_name(text));
  const std::string wanted = kernel.empty() ? "program.bc" : kernel + ".so";
  return std::any_of(files.begin(), files.end(),
                     [&](const fs::path& file) { return file.filename() == wanted; });
}

void KernelCache::build(const std::string& text, const std::function<void()>& build) {
  if (!private_) {
    build();
    return;
  }
  const std::lock_guard guard(mutex_);
  const std::string name = entry_name(text);
  const auto [program, is_new] = programs_.try_emplace(name);
  const Files before = program_folders();
  if (is_new && !store_.empty()) restore(store_ / name, program->second);
  build();
  const Files after = program_folders();
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::inserter(program->second.folders, program->second.folders.begin()));
}

void KernelCache::keep(const std::string& text) try {
  if (store_.empty()) return;
  const std::lock_guard guard(mutex_);
  const std::string name = entry_name(text);
  const auto program = programs_.find(name);
  if (program == programs_.end()) return;
  Files files = compiled_files(program->second);
  if (files.empty() || files == program->second.kept) return;
  publish(files, store_ / name);
  program->second.kept = std::move(files);
  forget_oldest();
} catch (const std::exception&) {
}

void KernelCache::publish(const Files& files, const fs::path& entry) const {
  const fs::path staged = private_->path() / "staged", former = private_->path() / "former";
  std::error_code ignored;
  fs::remove_all(staged, ignored);
  for (const fs::path& file : files) {
    fs::create_directories((staged / file).parent_path());
    fs::create_hard_link(folder() / file, staged / file, ignored);
    if (ignored) fs::copy_file(folder() / file, staged / file);
  }
  if (!seal(staged, {files.begin(), files.end()})) return;
  // A process that reads the former entry at this moment misses a file, and compiles the program.
  fs::rename(entry, former, ignored);
  fs::rename(staged, entry, ignored);
  fs::remove_all(former, ignored);
}

void KernelCache::forget_oldest() const {
  std::vector<std::pair<fs::file_time_type, fs::path>> entries;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(store_, ignored)) {
    if (fs::exists(entry.path() / "sealed", ignored))
      entries.emplace_back(entry.last_write_time(ignored), entry.path());
  }
  std::sort(entries.begin(), entries.end());
  for (std::size_t i = 0; i + kMaxPrograms < entries.size(); ++i)
    fs::remove_all(entries[i].second, ignored);
}

}  // namespace dapple
