#include "device/programs/kernels_ahead.hpp"

#include <utility>

namespace dapple {

KernelsAhead::KernelsAhead(DeviceContext& context, std::vector<KernelName> kernels)
    : kernels_(std::move(kernels)), loader_(context) {
  processes_.start(context, kernels_, CompileTo::machine_code);
  loader_.start(kernels_);
}

void KernelsAhead::finish() {
  loader_.wait();
  processes_.wait();
  loader_.start(kernels_);
  loader_.wait();
}

}  // namespace dapple
