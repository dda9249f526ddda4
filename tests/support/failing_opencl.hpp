// OpenCL between dapple and the driver, in the test program only: counts calls and living objects,
// fails the call it is told to, and makes a device look smaller or farther than it is.
#pragma once

#include <cstddef>
#include <string>

namespace dapple::opencl_test {

/// Counting starts anew; the n-th call from now on fails, and no other. 0: none does.
void fail_call(int n);
/// The same of calls that allocate a buffer only.
void fail_allocation(int n);
/// Calls since fail_call(), allocations since fail_allocation().
int calls();
int allocations();
/// "clFinish", the call that failed; empty when none did.
std::string failed_call();

/// Contexts, queues, buffers, programs, kernels and events that nobody has released.
int living_objects();

/// What every device says of its memory from now on; 0: the truth.
void pretend_memory(std::size_t global_bytes, std::size_t allocation_bytes);

/// Whether devices say from now on that they share no memory with the host.
void pretend_own_memory(bool own);

/// By all clEnqueueWriteBuffer() so far.
std::size_t written_bytes();

}  // namespace dapple::opencl_test
