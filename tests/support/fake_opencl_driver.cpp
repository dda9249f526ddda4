// An OpenCL driver for tests of several drivers: its devices are listed and cannot be opened. The
// first is a GPU of 96 compute units that has the host's memory, the second, if it is given a name,
// one of 24 with its own. In: environment variables for the names that they tell. Out: a library
// for an .icd file.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl_icd.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

// Every object of a driver begins with the driver's functions, for the loader (cl_khr_icd).
struct _cl_platform_id {
  const cl_icd_dispatch* functions;
};
struct _cl_device_id {
  const cl_icd_dispatch* functions;
  bool is_second;
};

namespace {

cl_platform_id the_platform();
cl_device_id first_device();
cl_device_id second_device();

std::string from_environment(const char* variable, const char* otherwise) {
  const char* value = std::getenv(variable);
  return value ? value : otherwise;
}

/// Where a query puts its answer: `room` bytes at `to`, or none if that is null.
struct Answer {
  std::size_t room;
  void* to;
  std::size_t* size;

  [[nodiscard]] cl_int bytes(const void* value, std::size_t count) const {
    if (size) *size = count;
    if (!to) return CL_SUCCESS;
    if (room < count) return CL_INVALID_VALUE;
    std::memcpy(to, value, count);
    return CL_SUCCESS;
  }
  [[nodiscard]] cl_int text(const std::string& value) const {
    return bytes(value.c_str(), value.size() + 1);
  }
  template <class Value>
  [[nodiscard]] cl_int value(const Value& value) const {
    return bytes(&value, sizeof value);
  }
};

/// Gives the only object to a caller that wants `room` of them.
template <class Object>
cl_int list(Object object, cl_uint room, Object* objects, cl_uint* count) {
  if (count) *count = 1;
  if (objects && room > 0) objects[0] = object;
  return CL_SUCCESS;
}

cl_int get_platforms(cl_uint room, cl_platform_id* platforms, cl_uint* count) {
  return list(the_platform(), room, platforms, count);
}

cl_int get_platform_info(cl_platform_id, cl_platform_info query, std::size_t room, void* to,
                         std::size_t* size) {
  const Answer answer{room, to, size};
  switch (query) {
    case CL_PLATFORM_NAME:
      return answer.text(from_environment("FAKE_OPENCL_PLATFORM", "Fake"));
    case CL_PLATFORM_VENDOR:
      return answer.text("dapple's tests");
    case CL_PLATFORM_VERSION:
      return answer.text("OpenCL 1.2 ");
    case CL_PLATFORM_PROFILE:
      return answer.text("FULL_PROFILE");
    case CL_PLATFORM_EXTENSIONS:
      return answer.text("cl_khr_icd");
    case CL_PLATFORM_ICD_SUFFIX_KHR:
      return answer.text("FAKE");
    default:
      return CL_INVALID_VALUE;
  }
}

cl_int get_devices(cl_platform_id, cl_device_type, cl_uint room, cl_device_id* devices,
                   cl_uint* count) {
  const bool has_second = std::getenv("FAKE_OPENCL_SECOND_DEVICE") != nullptr;
  list(first_device(), room, devices, count);
  if (!has_second) return CL_SUCCESS;
  if (count) *count = 2;
  if (devices && room > 1) devices[1] = second_device();
  return CL_SUCCESS;
}

cl_int get_device_info(cl_device_id device, cl_device_info query, std::size_t room, void* to,
                       std::size_t* size) {
  const Answer answer{room, to, size};
  switch (query) {
    case CL_DEVICE_NAME:
      return answer.text(device->is_second ? from_environment("FAKE_OPENCL_SECOND_DEVICE", "")
                                           : from_environment("FAKE_OPENCL_DEVICE", "fake"));
    case CL_DRIVER_VERSION:
      return answer.text(from_environment("FAKE_OPENCL_VERSION", "1"));
    case CL_DEVICE_VERSION:
      return answer.text("OpenCL 1.2 ");
    case CL_DEVICE_OPENCL_C_VERSION:
      return answer.text(from_environment("FAKE_OPENCL_C", "OpenCL C 1.2 "));
    case CL_DEVICE_TYPE:  // so that it is listed before a CPU
      return answer.value(cl_device_type{CL_DEVICE_TYPE_GPU});
    case CL_DEVICE_PLATFORM:
      return answer.value(the_platform());
    case CL_DEVICE_AVAILABLE:
    case CL_DEVICE_COMPILER_AVAILABLE:
    case CL_DEVICE_ENDIAN_LITTLE:
      return answer.value(cl_bool{CL_TRUE});
    case CL_DEVICE_HOST_UNIFIED_MEMORY:
      if (from_environment("FAKE_OPENCL_MEMORY", "known") == "unknown") return CL_INVALID_VALUE;
      return answer.value(device->is_second ? cl_bool{CL_FALSE} : cl_bool{CL_TRUE});
    case CL_DEVICE_MAX_COMPUTE_UNITS:
      return answer.value(device->is_second ? cl_uint{24} : cl_uint{96});
    case CL_DEVICE_GLOBAL_MEM_SIZE:
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
      return answer.value(cl_ulong{1} << 30);
    default:
      return CL_INVALID_VALUE;
  }
}

cl_int keep_device(cl_device_id) { return CL_SUCCESS; }

cl_context refuse_context(const cl_context_properties*, cl_uint, const cl_device_id*,
                          void(CL_CALLBACK*)(const char*, const void*, std::size_t, void*), void*,
                          cl_int* status) {
  if (status) *status = CL_DEVICE_NOT_AVAILABLE;
  return nullptr;
}

const cl_icd_dispatch* functions() {
  static const cl_icd_dispatch table = [] {
    cl_icd_dispatch functions{};
    functions.clGetPlatformIDs = get_platforms;
    functions.clGetPlatformInfo = get_platform_info;
    functions.clGetDeviceIDs = get_devices;
    functions.clGetDeviceInfo = get_device_info;
    functions.clRetainDevice = keep_device;
    functions.clReleaseDevice = keep_device;
    functions.clCreateContext = refuse_context;
    return functions;
  }();
  return &table;
}

cl_platform_id the_platform() {
  static _cl_platform_id platform{functions()};
  return &platform;
}

cl_device_id first_device() {
  static _cl_device_id device{functions(), false};
  return &device;
}

cl_device_id second_device() {
  static _cl_device_id device{functions(), true};
  return &device;
}

}  // namespace

/// The only function that the library exports: those of the loader have the names of the others.
extern "C" __attribute__((visibility("default"))) void* clGetExtensionFunctionAddress(
    const char* name) {
  if (std::string_view(name) == "clIcdGetPlatformIDsKHR")
    return reinterpret_cast<void*>(get_platforms);
  if (std::string_view(name) == "clGetPlatformInfo")
    return reinterpret_cast<void*>(get_platform_info);
  return nullptr;
}
