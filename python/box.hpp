#pragma once
/// \file
/// The classes Box and Drive of the Python module.

#include "python/module.hpp"

namespace twincell::python {

/// Adds Box to the module.
void bind_box(py::module_& module);
/// Adds Drive to the module.
void bind_drive(py::module_& module);

}  // namespace twincell::python
