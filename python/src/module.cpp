// The Python module dapple._native. The package around it (python/dapple) checks and names what
// callers see.
#include <string>

#include "bindings.hpp"
#include "dapple/device.hpp"
#include "dapple/error.hpp"
#include "engine_call.hpp"
#include "nanobind/stl/string.h"
#include "nanobind/stl/vector.h"
#include "scene_on_device.hpp"

namespace dapple::python {
namespace {

namespace nb = nanobind;

/// The class of dapple/_errors.py for an error's kind.
const char* class_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "UsageError";
    case ErrorKind::input:
      return "InputError";
    case ErrorKind::device:
      return "DeviceError";
    default:
      return "Error";
  }
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const nb::object type = nb::module_::import_("dapple._errors").attr(class_of(error.kind()));
    std::string text = error.what();
    if (text.starts_with("no OpenCL platform found")) text += ", or pip install 'dapple[cpu]'";
    PyErr_SetString(type.ptr(), text.c_str());
  }
}

}  // namespace

void bind_errors() { nb::register_exception_translator(translate); }

}  // namespace dapple::python

NB_MODULE(_native, module) {
  using namespace dapple::python;
  module.doc() = "dapple's engine; use the package dapple around it.";
  module.def("version", [] { return DAPPLE_VERSION; });
  module.def("keep_kernels", keep_kernels);
  bind_errors();
  bind_options(module);
  bind_scene(module);
  bind_points(module);
  bind_pictures(module);
  bind_bakes(module);
  module.def(
      "devices",
      [] {
        const nb::gil_scoped_release released;
        const EngineLock lock;
        std::vector<std::string> names;
        for (const dapple::DeviceInfo& info : dapple::list_devices()) names.push_back(info.name);
        return names;
      },
      "Names of the OpenCL devices, best first.\n\n"
      ">>> len(dapple.devices()) > 0\nTrue");
}
