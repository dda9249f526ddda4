// Shared by the tests that run the program as a process. In: arguments, and shell commands that run
// before it (limits, namespaces); out: exit code and what it printed.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/files/film_files.hpp"

namespace dapple::program_test {

struct Outcome {
  int code = -1;  ///< exit code; -1 where a signal ended the process
  std::string out, err;
};

/// A prefix for a command. The command then runs in its own mount namespace, where mounting needs
/// no rights, after the shell commands `steps`. Check has_namespaces() first.
inline std::string in_namespace(const std::string& steps) {
  return "unshare --user --map-root-user --mount sh -c '" + steps + " && exec \"$@\"' sh";
}

/// Whether every user of this system may create namespaces and mount in them.
inline bool has_namespaces() {
  static const bool has =
      std::system((in_namespace("mount -t tmpfs none /mnt") + " true >/dev/null 2>&1").c_str()) ==
      0;
  return has;
}

class ProgramRun : public film_test::FilmFile {
 protected:
  ProgramRun() { std::filesystem::create_directory(logs()); }
  ~ProgramRun() override { std::filesystem::remove_all(logs()); }

  /// Runs the program in the test's folder; `before` is shell code in front of it.
  [[nodiscard]] Outcome dapple(const std::string& arguments, const std::string& before = "") const {
    const std::string out = (logs() / "out").string(), err = (logs() / "err").string();
    const std::string command = "cd '" + folder_.string() + "' && " + before +
                                " " DAPPLE_PROGRAM " " + arguments + " >'" + out + "' 2>'" + err +
                                "' </dev/null";
    // If the shell was replaced by the program, a signal ends it; a shell that still runs returns
    // 128 + signal.
    const int status = std::system(command.c_str());
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return {code > 128 ? -1 : code, film_test::bytes_of(out), film_test::bytes_of(err)};
  }

  /// Renders a picture of 8 by 8 pixels, one sample each, into out.exr.
  [[nodiscard]] Outcome render(const std::string& arguments, const std::string& before = "") const {
    return dapple(
        "render 'scene:cube?divisions=1' -o out.exr --width 8 --height 8 --spp 1 " + arguments,
        before);
  }

  static void expect_failure(const Outcome& run, int code, const std::string& part) {
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_TRUE(film_test::contains(run.err, part)) << "'" << part << "' is not in: " << run.err;
    EXPECT_EQ(run.out, "");
  }

  /// Beside the test's folder, so that files_in_folder() counts the program's files only.
  [[nodiscard]] std::filesystem::path logs() const { return folder_.string() + "_logs"; }
};

}  // namespace dapple::program_test
