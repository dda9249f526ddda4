// Pages of the host's memory in OpenCL buffers. In: pages of a PagePool. Out: the pages, back in
// the pool once OpenCL needs them no more.
#pragma once

#include <memory>

#include "device/opencl.hpp"
#include "device/page_pool.hpp"

namespace dapple {

/// Lends `pages` to `buffer`. They return to `pool` when OpenCL destroys the buffer, which is after
/// its last command.
void hand_over(std::unique_ptr<Pages> pages, cl::Buffer& buffer,
               const std::shared_ptr<PagePool>& pool);

}  // namespace dapple
