#include "device/programs/kernel_loader.hpp"

#include <exception>
#include <system_error>
#include <utility>

namespace dapple {

void KernelLoader::start(std::vector<KernelName> kernels) {
  stop();
  stopping_ = false;
  try {
    thread_ = std::thread([this, names = std::move(kernels)] { load(names); });
  } catch (const std::system_error&) {  // no thread is to be had: nothing is loaded ahead
  }
}

void KernelLoader::load(const std::vector<KernelName>& kernels) {
  for (const KernelName& kernel : kernels) {
    if (stopping_) return;
    try {
      if (context_.is_compiled(kernel, CompileTo::machine_code)) context_.prepare(kernel);
    } catch (const std::exception&) {  // thrown again by the caller's prepare()
    }
  }
}

void KernelLoader::wait() {
  if (thread_.joinable()) thread_.join();
}

void KernelLoader::stop() {
  stopping_ = true;
  wait();
}

}  // namespace dapple
