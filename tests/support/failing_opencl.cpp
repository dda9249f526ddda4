// The linker prefers functions of the program to those of its libraries. So dapple's OpenCL calls
// arrive here; each forwards to the real function, which dlsym() finds.
#include "support/failing_opencl.hpp"

#include <dlfcn.h>

#include <atomic>
#include <cstring>
#include <string>

#include "device/opencl.hpp"

namespace dapple::opencl_test {
namespace {

std::atomic<int> call_count{0}, allocation_count{0}, living{0};
std::atomic<int> failing_call{0}, failing_allocation{0};
std::atomic<const char*> failed{nullptr};
std::atomic<std::size_t> pretended_global{0}, pretended_allocation{0}, written{0};
std::atomic<bool> has_own_memory{false};
std::string pretended_version;

bool fails(const char* name, bool allocates = false) {
  const bool by_call = ++call_count == failing_call;
  const bool by_allocation = allocates && ++allocation_count == failing_allocation;
  if (by_call || by_allocation) failed = name;
  return by_call || by_allocation;
}

template <class Function>
Function* next(Function*, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// Counts the event that a call returns, if the caller requested one.
cl_int count_event(cl_int status, const cl_event* event) {
  if (status == CL_SUCCESS && event != nullptr) ++living;
  return status;
}

template <class Object>
Object count_object(Object object) {
  if (object != nullptr) ++living;
  return object;
}

template <class Object>
Object refuse(cl_int* status, cl_int code) {
  if (status != nullptr) *status = code;
  return nullptr;
}

}  // namespace

void fail_call(int n) {
  failed = nullptr;
  call_count = 0;
  failing_call = n;
  failing_allocation = 0;
}

void fail_allocation(int n) {
  failed = nullptr;
  allocation_count = 0;
  failing_allocation = n;
  failing_call = 0;
}

int calls() { return call_count; }
int allocations() { return allocation_count; }
int living_objects() { return living; }

std::string failed_call() {
  const char* name = failed;
  return name ? name : "";
}

void pretend_memory(std::size_t global_bytes, std::size_t allocation_bytes) {
  pretended_global = global_bytes;
  pretended_allocation = allocation_bytes;
}

void pretend_own_memory(bool own) { has_own_memory = own; }

void pretend_driver_version(const std::string& version) { pretended_version = version; }

std::size_t written_bytes() { return written; }

}  // namespace dapple::opencl_test

using namespace dapple::opencl_test;

extern "C" {

cl_int clGetDeviceInfo(cl_device_id a, cl_device_info b, size_t c, void* d, size_t* e) {
  if (fails("clGetDeviceInfo")) return CL_OUT_OF_RESOURCES;
  if (b == CL_DRIVER_VERSION && !pretended_version.empty()) {
    const std::size_t bytes = pretended_version.size() + 1;
    if (d != nullptr && c >= bytes) std::memcpy(d, pretended_version.c_str(), bytes);
    if (e != nullptr) *e = bytes;
    return CL_SUCCESS;
  }
  const cl_int status = next(&clGetDeviceInfo, "clGetDeviceInfo")(a, b, c, d, e);
  cl_ulong pretended = 0;
  if (b == CL_DEVICE_GLOBAL_MEM_SIZE) pretended = pretended_global;
  if (b == CL_DEVICE_MAX_MEM_ALLOC_SIZE) pretended = pretended_allocation;
  if (pretended != 0 && d != nullptr) std::memcpy(d, &pretended, sizeof pretended);
  const cl_bool shared = CL_FALSE;
  if (b == CL_DEVICE_HOST_UNIFIED_MEMORY && has_own_memory && d != nullptr)
    std::memcpy(d, &shared, sizeof shared);
  return status;
}

cl_int clGetPlatformIDs(cl_uint a, cl_platform_id* b, cl_uint* c) {
  if (fails("clGetPlatformIDs")) return CL_OUT_OF_RESOURCES;
  return next(&clGetPlatformIDs, "clGetPlatformIDs")(a, b, c);
}

cl_int clGetPlatformInfo(cl_platform_id a, cl_platform_info b, size_t c, void* d, size_t* e) {
  if (fails("clGetPlatformInfo")) return CL_OUT_OF_RESOURCES;
  return next(&clGetPlatformInfo, "clGetPlatformInfo")(a, b, c, d, e);
}

cl_int clGetDeviceIDs(cl_platform_id a, cl_device_type b, cl_uint c, cl_device_id* d, cl_uint* e) {
  if (fails("clGetDeviceIDs")) return CL_OUT_OF_RESOURCES;
  return next(&clGetDeviceIDs, "clGetDeviceIDs")(a, b, c, d, e);
}

cl_int clGetProgramBuildInfo(cl_program a, cl_device_id b, cl_program_build_info c, size_t d,
                             void* e, size_t* f) {
  if (fails("clGetProgramBuildInfo")) return CL_OUT_OF_RESOURCES;
  return next(&clGetProgramBuildInfo, "clGetProgramBuildInfo")(a, b, c, d, e, f);
}

cl_int clGetKernelWorkGroupInfo(cl_kernel a, cl_device_id b, cl_kernel_work_group_info c, size_t d,
                                void* e, size_t* f) {
  if (fails("clGetKernelWorkGroupInfo")) return CL_OUT_OF_RESOURCES;
  return next(&clGetKernelWorkGroupInfo, "clGetKernelWorkGroupInfo")(a, b, c, d, e, f);
}

cl_int clGetEventProfilingInfo(cl_event a, cl_profiling_info b, size_t c, void* d, size_t* e) {
  if (fails("clGetEventProfilingInfo")) return CL_OUT_OF_RESOURCES;
  return next(&clGetEventProfilingInfo, "clGetEventProfilingInfo")(a, b, c, d, e);
}

cl_int clBuildProgram(cl_program a, cl_uint b, const cl_device_id* c, const char* d,
                      void(CL_CALLBACK* e)(cl_program, void*), void* f) {
  if (fails("clBuildProgram")) return CL_OUT_OF_RESOURCES;
  return next(&clBuildProgram, "clBuildProgram")(a, b, c, d, e, f);
}

cl_int clSetKernelArg(cl_kernel a, cl_uint b, size_t c, const void* d) {
  if (fails("clSetKernelArg")) return CL_OUT_OF_RESOURCES;
  return next(&clSetKernelArg, "clSetKernelArg")(a, b, c, d);
}

cl_int clEnqueueReadBuffer(cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e, void* f,
                           cl_uint g, const cl_event* h, cl_event* i) {
  if (fails("clEnqueueReadBuffer")) return CL_OUT_OF_RESOURCES;
  return count_event(next(&clEnqueueReadBuffer, "clEnqueueReadBuffer")(a, b, c, d, e, f, g, h, i),
                     i);
}

cl_int clEnqueueWriteBuffer(cl_command_queue a, cl_mem b, cl_bool c, size_t d, size_t e,
                            const void* f, cl_uint g, const cl_event* h, cl_event* i) {
  if (fails("clEnqueueWriteBuffer")) return CL_OUT_OF_RESOURCES;
  written += e;
  return count_event(next(&clEnqueueWriteBuffer, "clEnqueueWriteBuffer")(a, b, c, d, e, f, g, h, i),
                     i);
}

cl_int clEnqueueFillBuffer(cl_command_queue a, cl_mem b, const void* c, size_t d, size_t e,
                           size_t f, cl_uint g, const cl_event* h, cl_event* i) {
  if (fails("clEnqueueFillBuffer")) return CL_OUT_OF_RESOURCES;
  return count_event(next(&clEnqueueFillBuffer, "clEnqueueFillBuffer")(a, b, c, d, e, f, g, h, i),
                     i);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue a, cl_kernel b, cl_uint c, const size_t* d,
                              const size_t* e, const size_t* f, cl_uint g, const cl_event* h,
                              cl_event* i) {
  if (fails("clEnqueueNDRangeKernel")) return CL_OUT_OF_RESOURCES;
  return count_event(
      next(&clEnqueueNDRangeKernel, "clEnqueueNDRangeKernel")(a, b, c, d, e, f, g, h, i), i);
}

cl_int clFinish(cl_command_queue a) {
  if (fails("clFinish")) return CL_OUT_OF_RESOURCES;
  return next(&clFinish, "clFinish")(a);
}

cl_context clCreateContext(const cl_context_properties* a, cl_uint b, const cl_device_id* c,
                           void(CL_CALLBACK* d)(const char*, const void*, size_t, void*), void* e,
                           cl_int* status) {
  if (fails("clCreateContext")) return refuse<cl_context>(status, CL_OUT_OF_HOST_MEMORY);
  return count_object(next(&clCreateContext, "clCreateContext")(a, b, c, d, e, status));
}

cl_command_queue clCreateCommandQueue(cl_context a, cl_device_id b, cl_command_queue_properties c,
                                      cl_int* status) {
  if (fails("clCreateCommandQueue")) return refuse<cl_command_queue>(status, CL_OUT_OF_HOST_MEMORY);
  return count_object(next(&clCreateCommandQueue, "clCreateCommandQueue")(a, b, c, status));
}

cl_mem clCreateBuffer(cl_context a, cl_mem_flags b, size_t c, void* d, cl_int* status) {
  if (fails("clCreateBuffer", true))
    return refuse<cl_mem>(status, CL_MEM_OBJECT_ALLOCATION_FAILURE);
  return count_object(next(&clCreateBuffer, "clCreateBuffer")(a, b, c, d, status));
}

cl_program clCreateProgramWithSource(cl_context a, cl_uint b, const char** c, const size_t* d,
                                     cl_int* status) {
  if (fails("clCreateProgramWithSource")) return refuse<cl_program>(status, CL_OUT_OF_HOST_MEMORY);
  return count_object(
      next(&clCreateProgramWithSource, "clCreateProgramWithSource")(a, b, c, d, status));
}

cl_kernel clCreateKernel(cl_program a, const char* b, cl_int* status) {
  if (fails("clCreateKernel")) return refuse<cl_kernel>(status, CL_OUT_OF_HOST_MEMORY);
  return count_object(next(&clCreateKernel, "clCreateKernel")(a, b, status));
}

// Releases never fail here: an object that could not be released would always be a leak.

cl_int clReleaseContext(cl_context a) {
  --living;
  return next(&clReleaseContext, "clReleaseContext")(a);
}

cl_int clRetainContext(cl_context a) {
  ++living;
  return next(&clRetainContext, "clRetainContext")(a);
}

cl_int clReleaseCommandQueue(cl_command_queue a) {
  --living;
  return next(&clReleaseCommandQueue, "clReleaseCommandQueue")(a);
}

cl_int clRetainCommandQueue(cl_command_queue a) {
  ++living;
  return next(&clRetainCommandQueue, "clRetainCommandQueue")(a);
}

cl_int clReleaseMemObject(cl_mem a) {
  --living;
  return next(&clReleaseMemObject, "clReleaseMemObject")(a);
}

cl_int clRetainMemObject(cl_mem a) {
  ++living;
  return next(&clRetainMemObject, "clRetainMemObject")(a);
}

cl_int clReleaseProgram(cl_program a) {
  --living;
  return next(&clReleaseProgram, "clReleaseProgram")(a);
}

cl_int clRetainProgram(cl_program a) {
  ++living;
  return next(&clRetainProgram, "clRetainProgram")(a);
}

cl_int clReleaseKernel(cl_kernel a) {
  --living;
  return next(&clReleaseKernel, "clReleaseKernel")(a);
}

cl_int clRetainKernel(cl_kernel a) {
  ++living;
  return next(&clRetainKernel, "clRetainKernel")(a);
}

cl_int clReleaseEvent(cl_event a) {
  --living;
  return next(&clReleaseEvent, "clReleaseEvent")(a);
}

cl_int clRetainEvent(cl_event a) {
  ++living;
  return next(&clRetainEvent, "clRetainEvent")(a);
}

}  // extern "C"
