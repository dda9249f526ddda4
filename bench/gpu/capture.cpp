// Writes one launch of a kernel to a folder, for replay.py: NVIDIA's profiler knows no OpenCL, but
// CUDA's driver launches the kernels that NVIDIA's OpenCL compiler makes. A library that is loaded
// before OpenCL's; bench/README.md has an example. In: CAPTURE_FOLDER, CAPTURE_KERNEL and the calls
// of a program. Out: of the first launch of that kernel with at least CAPTURE_ITEMS work-items,
// launch.txt, argN.bin for each argument, and program.bin, the compiled program (PTX of NVIDIA's
// driver). Launches of one dimension without offset, whose local memory is the kernel's own.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace {

using Bytes = std::vector<char>;

std::mutex mutex;
std::map<cl_kernel, std::map<cl_uint, Bytes>> arguments;
std::set<cl_mem> buffers;
bool is_captured = false;

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

void check(bool succeeded, const char* what) {
  if (succeeded) return;
  std::fprintf(stderr, "capture: %s failed\n", what);
  std::abort();
}

std::string kernel_name(cl_kernel kernel) {
  char name[256] = "";
  clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, sizeof name, name, nullptr);
  return name;
}

void save(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  check(!file.flush().fail(), path.c_str());
}

/// The buffer that an argument is; null: it is a value.
cl_mem buffer_of(const Bytes& argument) {
  cl_mem memory = nullptr;
  if (argument.size() != sizeof(cl_mem)) return nullptr;
  std::memcpy(&memory, argument.data(), sizeof(cl_mem));
  return buffers.contains(memory) ? memory : nullptr;
}

Bytes content(cl_command_queue queue, cl_mem memory) {
  std::size_t size = 0;
  clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof size, &size, nullptr);
  Bytes bytes(size);
  check(clEnqueueReadBuffer(queue, memory, CL_TRUE, 0, size, bytes.data(), 0, nullptr, nullptr) ==
            CL_SUCCESS,
        "reading a buffer");
  return bytes;
}

Bytes program_of(cl_kernel kernel) {
  cl_program program = nullptr;
  clGetKernelInfo(kernel, CL_KERNEL_PROGRAM, sizeof(cl_program), &program, nullptr);
  std::size_t size = 0;
  clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr);
  Bytes bytes(size);
  char* data = bytes.data();
  check(size && clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof(char*), &data, nullptr) ==
                    CL_SUCCESS,
        "reading the program");
  return bytes;
}

void capture(cl_command_queue queue, cl_kernel kernel, std::size_t items, std::size_t group) {
  const std::filesystem::path folder = variable("CAPTURE_FOLDER");
  std::filesystem::create_directories(folder);
  check(clFinish(queue) == CL_SUCCESS, "what was launched before");
  std::ofstream launch(folder / "launch.txt");
  launch << "items " << items << " group " << group << "\n";
  for (const auto& [index, argument] : arguments[kernel]) {
    cl_mem memory = buffer_of(argument);
    save(folder / ("arg" + std::to_string(index) + ".bin"),
         memory ? content(queue, memory) : argument);
    launch << index << (memory ? " buffer\n" : " value\n");
  }
  check(!launch.flush().fail(), "writing launch.txt");
  save(folder / "program.bin", program_of(kernel));
}

bool is_wanted(cl_kernel kernel, cl_uint dimensions, const size_t* items, const size_t* group) {
  if (is_captured || dimensions != 1 || !group || variable("CAPTURE_FOLDER").empty()) return false;
  const std::string least = variable("CAPTURE_ITEMS");
  return items[0] >= std::strtoull(least.c_str(), nullptr, 10) &&
         kernel_name(kernel) == variable("CAPTURE_KERNEL");
}

}  // namespace

// These replace OpenCL's functions.
// NOLINTBEGIN(readability-identifier-naming, readability-inconsistent-declaration-parameter-name)
extern "C" {

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host,
                      cl_int* error) {
  static const auto kCreate = next<decltype(&clCreateBuffer)>("clCreateBuffer");
  cl_mem memory = kCreate(context, flags, size, host, error);
  const std::scoped_lock lock(mutex);
  buffers.insert(memory);
  return memory;
}

cl_int clSetKernelArg(cl_kernel kernel, cl_uint index, size_t size, const void* value) {
  static const auto kSet = next<decltype(&clSetKernelArg)>("clSetKernelArg");
  {
    const std::scoped_lock lock(mutex);
    const char* bytes = static_cast<const char*>(value);
    arguments[kernel][index] = bytes ? Bytes(bytes, bytes + size) : Bytes(size);
  }
  return kSet(kernel, index, size, value);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* offset, const size_t* items, const size_t* group,
                              cl_uint waits, const cl_event* wait_for, cl_event* event) {
  static const auto kLaunch = next<decltype(&clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel");
  {
    const std::scoped_lock lock(mutex);
    if (is_wanted(kernel, dimensions, items, group)) {
      is_captured = true;
      capture(queue, kernel, items[0], group[0]);
    }
  }
  return kLaunch(queue, kernel, dimensions, offset, items, group, waits, wait_for, event);
}
}
// NOLINTEND(readability-identifier-naming, readability-inconsistent-declaration-parameter-name)
