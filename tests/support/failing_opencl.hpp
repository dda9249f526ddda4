// A layer between dapple and the OpenCL driver, in the test program only. It counts calls and
// living objects, fails a chosen call, and can report less memory than the device has, or memory
// that is not shared with the host.
#pragma once

#include <cstddef>
#include <string>

namespace dapple::opencl_test {

/// Restarts the count. Only the n-th call from now on fails; with 0 none does.
void fail_call(int n);
/// The same, but counts and fails only calls that allocate a buffer.
void fail_allocation(int n);
/// Calls since fail_call(), allocations since fail_allocation().
int calls();
int allocations();
/// Name of the call that failed, for example "clFinish"; empty when none did.
std::string failed_call();

/// Number of contexts, queues, buffers, programs, kernels and events that are not yet released.
int living_objects();

/// From now on every device reports these sizes of its memory, in bytes; 0: its real size.
void pretend_memory(std::size_t global_bytes, std::size_t allocation_bytes);

/// With true, devices report from now on that they share no memory with the host.
void pretend_own_memory(bool own);

/// From now on every device reports this version of its driver; empty: its real one.
void pretend_driver_version(const std::string& version);

/// Bytes that all clEnqueueWriteBuffer() calls wrote so far.
std::size_t written_bytes();

}  // namespace dapple::opencl_test
