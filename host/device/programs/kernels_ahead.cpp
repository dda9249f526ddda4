#include "device/programs/kernels_ahead.hpp"

#include <utility>

namespace dapple {

KernelsAhead::KernelsAhead(DeviceContext& context, std::vector<KernelName> kernels)
    : context_(context), kernels_(std::move(kernels)), loader_(context) {
  processes_.start(context, kernels_, CompileTo::machine_code);
  loader_.start(kernels_);
}

void KernelsAhead::finish() {
  loader_.wait();
  processes_.wait();
  for (const KernelName& kernel : kernels_) context_.prepare(kernel);
}

}  // namespace dapple
