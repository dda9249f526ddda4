// The parts of the Python module, a function a file. Each adds classes and functions to `module`.
#pragma once

#include <nanobind/nanobind.h>

namespace dapple::python {

void bind_errors();
void bind_options(nanobind::module_& module);
void bind_scene(nanobind::module_& module);
void bind_points(nanobind::module_& module);
void bind_pictures(nanobind::module_& module);
void bind_bakes(nanobind::module_& module);

}  // namespace dapple::python
