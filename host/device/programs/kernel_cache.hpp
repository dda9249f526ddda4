// Compiled kernels, kept from one run to the next. PoCL aborts the process on a damaged file in
// its cache, so it gets a folder that this process alone writes to; what it compiles there is
// kept sealed, by program, and only what still is as it was sealed comes back.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "device/programs/private_folder.hpp"

namespace dapple {

class KernelCache {
 public:
  /// The one of this process; never throws.
  static KernelCache& of_process();

  /// Chooses the first place that can be written: $POCL_CACHE_DIR, else $XDG_CACHE_HOME or
  /// ~/.cache; else the folder for temporary files, from which nothing is kept.
  KernelCache();

  /// What PoCL gets as POCL_CACHE_DIR; empty where nothing can be written.
  [[nodiscard]] std::filesystem::path folder() const;
  /// Which places could not be used and why, "/root/.cache/dapple: Read-only file system"; empty
  /// when the first could.
  [[nodiscard]] const std::string& refusals() const { return refusals_; }

  /// Whether compiled programs are kept for later processes, and go to them.
  [[nodiscard]] bool keeps() const { return !store_.empty(); }
  /// Whether that program is kept, and with it machine code of `kernel` unless that is empty.
  [[nodiscard]] bool has(const std::string& text, const std::string& kernel) const;
  /// Runs `build`, which compiles the program that `text` stands for: its source, its options, and
  /// all there is to know of its compiler. What is kept of it is there when `build` runs.
  void build(const std::string& text, const std::function<void()>& build);
  /// Keeps what has been compiled for that program. Never throws: what cannot be kept is compiled
  /// again.
  void keep(const std::string& text);

 private:
  using Files = std::set<std::filesystem::path>;  ///< inside folder()
  struct Program {
    Files folders;  ///< where PoCL puts what it compiles
    Files kept;
  };

  bool use(const std::filesystem::path& place);
  void restore(const std::filesystem::path& entry, Program& program) const;
  [[nodiscard]] Files program_folders() const;
  [[nodiscard]] Files compiled_files(const Program& program) const;
  void publish(const Files& files, const std::filesystem::path& entry) const;
  void forget_oldest() const;

  std::unique_ptr<PrivateFolder> private_;
  std::filesystem::path store_;  ///< where entries are kept; empty: nowhere
  std::string refusals_;
  std::mutex mutex_;
  std::map<std::string, Program> programs_;  ///< by name of the entry
};

}  // namespace dapple
