// Chooses a command, and turns what goes wrong into one line and an exit code.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "commands/arguments/argument_errors.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "device/driver_crash.hpp"
#include "device/programs/compiler_processes.hpp"

namespace {

constexpr int kUsage = static_cast<int>(dapple::ErrorKind::usage);
constexpr int kFailed = static_cast<int>(dapple::ErrorKind::failed);

/// Not by fmt: that throws where nothing can be written. `reason`: an errno, or 0 for none.
int say(const char* what, int reason = 0) {
  std::fprintf(stderr, "dapple: %s%s%s\n", what, reason ? ": " : "",
               reason ? std::strerror(reason) : "");
  return kFailed;
}

/// Whether even arguments could not be read without an overflow. Says so with hardly any stack.
bool is_stack_too_small() {
  constexpr rlim_t kLeastBytes = 64 * 1024;
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= kLeastBytes) return false;
  constexpr std::string_view kText =
      "dapple: stacks may only have less than 64 kB here (ulimit -s), and OpenCL drivers need 1024 "
      "kB to compile kernels\n";
  (void)!write(STDERR_FILENO, kText.data(), kText.size());
  return true;
}

/// Files that are opened later must not become the standard input, output or error.
void occupy_closed_descriptors() {
  const auto is_closed = [](int descriptor) { return fcntl(descriptor, F_GETFD) < 0; };
  // Writing to the standard output must fail, unless nobody would be told, as of daemons.
  const bool output_fails = !is_closed(STDERR_FILENO);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (!is_closed(descriptor)) continue;
    const bool fails = descriptor == STDIN_FILENO || (descriptor == STDOUT_FILENO && output_fails);
    (void)!open("/dev/null", fails ? O_RDONLY : O_WRONLY);
  }
}

/// Nobody reads what is printed any more, as after a lost connection. It goes nowhere from now on,
/// and the work goes on: what it writes to files is wanted. A handler of SIGPIPE.
void print_nowhere(int) {
  const int error = errno;
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    pollfd output{descriptor, 0, 0};
    if (poll(&output, 1, 0) != 1 || !(output.revents & POLLERR)) continue;
    const int nowhere = open("/dev/null", O_WRONLY);
    if (nowhere < 0) continue;
    dup2(nowhere, descriptor);
    close(nowhere);
  }
  errno = error;
}

/// Says what failed in the standard library; returns the exit code.
int report(const std::system_error& error) {
  if (error.code() != std::errc::resource_unavailable_try_again) return say(error.what());
  return say(
      "cannot start a thread: too many processes and threads run (ulimit -u, or the limit of a "
      "container), or memory has run out");
}

int refuse(const CLI::App& app, const CLI::ParseError& error) {
  const auto parsed = app.get_subcommands();
  const std::string command = parsed.empty() ? "" : " " + parsed.front()->get_name();
  say(fmt::format("{}; dapple{} --help lists the options", dapple::argument_error_text(app, error),
                  command)
          .c_str());
  return kUsage;
}

struct Command {
  const char* name;
  const char* description;
  dapple::Run (*add)(CLI::App& command);
};

constexpr std::array kCommands{
    Command{"render", "Render AO and light passes to an OpenEXR file", dapple::add_render_command},
    Command{"merge", "Add up parts of an image that several runs made", dapple::add_merge_command},
    Command{"plan", "Say what a render would take: memory, time, bytes of files",
            dapple::add_plan_command},
    Command{"points", "Compute AO, visible sky and irradiance at points",
            dapple::add_points_command},
    Command{"bake", "Bake AO into the vertices, a texture or the instances of a glTF file",
            dapple::add_bake_command},
    Command{"info", "Print what a scene holds and what its BVH costs", dapple::add_info_command},
    Command{"scene", "Write a procedural scene as a GLB file", dapple::add_scene_command},
    Command{"devices", "List the OpenCL devices", dapple::add_devices_command},
    Command{"compare", "Print the differences of two OpenEXR files", dapple::add_compare_command},
    Command{"compile", "Compile kernels for another process", dapple::add_compile_command},
    Command{"document", "Write the manual page or completions", dapple::add_document_command},
};

int run(int argc, char** argv) {
  CLI::App app{
      "Ambient occlusion and soft shadows through foliage, hair and forests.\n\n"
      "Example:\n  dapple render scene:demo -o demo.exr --png demo.png"};
  bool version = false, verbose = false;
  app.add_flag("--version", version, "Print the version");
  app.add_flag("--verbose", verbose,
               "With --version: how dapple was built, and the device libraries");
  app.footer(
      "Exit codes: 0 done, 1 failed, 2 usage, 3 bad input, 4 no usable device, 5 images differ,\n"
      "129 interrupted by SIGHUP, 130 by SIGINT, 143 by SIGTERM, 152 by SIGXCPU.\n"
      "dapple COMMAND --help lists the options of each.");
  std::vector<std::pair<CLI::App*, dapple::Run>> commands;
  for (const Command& command : kCommands) {
    CLI::App& added = *app.add_subcommand(command.name, command.description);
    commands.emplace_back(&added, command.add(added));
    dapple::refuse_empty_values(added);
  }
  dapple::refuse_missing_values(argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : refuse(app, error);  // 0: --help
  }
  if (version) {
    dapple::print_version(verbose);
    return 0;
  }
  // Not CLI11's own requirement: that hides the name of a command it does not know.
  if (app.get_subcommands().empty()) {
    say("a subcommand is needed: render, merge, plan, bake, points, info, scene, devices "
        "or compare");
    return kUsage;
  }
  for (const auto& [command, work] : commands) {
    if (command->parsed()) work();
  }
  return dapple::interruption_code();
}

/// Runs the command; returns the exit code.
int run_and_report(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    dapple::put_now();
    const int failure = dapple::output_failure();
    // EPIPE: print_nowhere().
    return failure == 0 || failure == EPIPE ? code
                                            : say("cannot write to the standard output", failure);
  } catch (const dapple::Error& error) {
    say(error.what());
    return static_cast<int>(error.kind());
  } catch (const std::bad_alloc&) {
    return say("out of memory; try a smaller image, fewer rays or a smaller scene");
  } catch (const std::system_error& error) {
    return report(error);
  } catch (const std::exception& error) {
    return say(error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (is_stack_too_small()) return kFailed;
  occupy_closed_descriptors();
  std::signal(SIGCHLD, SIG_DFL);  // whatever we were started with: we wait for processes of ours
  std::signal(SIGXFSZ, SIG_IGN);  // a write past ulimit -f fails, and says why
  std::signal(SIGPIPE, print_nowhere);
  dapple::keep_signal_handler(SIGPIPE);
  dapple::report_driver_crashes();
  dapple::CompilerProcesses::use("/proc/self/exe");
  const int code = run_and_report(argc, argv);
  dapple::expect_exit();
  return code;
}
