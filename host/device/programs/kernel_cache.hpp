// A cache of compiled kernels, kept from one run to the next. In: what identifies a program, and a
// function that compiles it. Out: PoCL's files of the program. PoCL aborts the process when a file
// in its cache is damaged, so it gets a folder that only this process writes to. Copies of its
// files are kept with checksums, and restored only when the checksums still match.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "files/private_folder.hpp"

namespace dapple {

class KernelCache {
 public:
  /// The cache that the whole process shares. Never throws.
  static KernelCache& of_process();

  /// Uses $POCL_CACHE_DIR if that is set, else dapple/kernels in $XDG_CACHE_HOME or in ~/.cache. If
  /// that folder cannot be written, uses the folder for temporary files, where nothing is kept.
  KernelCache();

  /// The value of POCL_CACHE_DIR for PoCL; empty when no folder can be written.
  [[nodiscard]] std::filesystem::path folder() const;
  /// "/tmp/x: no space left ...", of folder(), where compiling now would fail; else empty.
  [[nodiscard]] std::string shortage() const;
  /// Which folders could not be used and why, "/root/.cache/dapple: Read-only file system"; empty
  /// when the first one could.
  [[nodiscard]] const std::string& refusals() const { return refusals_; }

  /// Whether compiled programs are kept for later processes.
  [[nodiscard]] bool keeps() const { return !store_.empty(); }
  /// Whether the program that `text` identifies is kept; if `kernel` is not empty, whether machine
  /// code of that kernel is kept.
  [[nodiscard]] bool has(const std::string& text, const std::string& kernel) const;
  /// Runs `build`, which compiles the program that `text` identifies: its source, its options, and
  /// the names and versions of device and driver. Restores the program's kept files to folder()
  /// before.
  void build(const std::string& text, const std::function<void()>& build);
  /// Keeps the compiled files of that program. Never throws: a program that cannot be kept is
  /// compiled again.
  void keep(const std::string& text);

 private:
  using Files = std::set<std::filesystem::path>;  ///< paths relative to folder()
  struct Program {
    Files folders;  ///< where PoCL writes the program's files
    Files kept;     ///< files that are in the store
  };

  bool use(const std::filesystem::path& parent);
  void restore(const std::filesystem::path& entry, Program& program) const;
  [[nodiscard]] Files program_folders() const;
  [[nodiscard]] Files compiled_files(const Program& program) const;
  void publish(const Files& files, const std::filesystem::path& entry) const;
  void forget_oldest() const;

  std::unique_ptr<PrivateFolder> private_;
  std::filesystem::path store_;  ///< folder of kept entries; empty: nothing is kept
  std::string refusals_;
  std::mutex mutex_;
  std::map<std::string, Program> programs_;  ///< by the name of their entry
};

}  // namespace dapple
