#include "commands/interruption.hpp"

#include <unistd.h>

#include <csignal>

namespace dapple {
namespace {

constexpr int kSignalled = 128;  ///< added to a signal's number, as shells do

// The only variables that a signal handler may access.
volatile std::sig_atomic_t received = 0;
volatile std::sig_atomic_t saving = 0;
volatile std::sig_atomic_t has_temporary = 0;
char temporary[4096];  // written only while has_temporary is 0

// An unfinished file of a process that ends here has a temporary name; the next run removes it. A
// second SIGTERM does not end the process at once: process managers send it twice.
extern "C" void on_interruption(int signal) {
  if (!saving || (received && signal == SIGINT)) {
    if (has_temporary) unlink(temporary);
    _exit(kSignalled + signal);
  }
  if (!received) received = signal;
}

}  // namespace

void catch_interruptions() {
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = on_interruption;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
  }
}

Stop save_when_interrupted() {
  return [] {
    saving = 1;
    return received != 0;
  };
}

void remove_when_interrupted(const std::string& path) {
  has_temporary = 0;
  if (path.empty() || path.size() >= sizeof temporary) return;
  temporary[path.copy(temporary, path.size())] = '\0';
  has_temporary = 1;
}

int interruption_code() { return received ? kSignalled + received : 0; }

}  // namespace dapple
