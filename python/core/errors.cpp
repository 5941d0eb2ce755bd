// SPDX-License-Identifier: MIT
#include "python/core/errors.h"

#include "backends/device.h"
#include "base/error.h"

namespace nb = nanobind;

namespace tandem::python {

void bind_errors(nb::module_& module) {
    nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
        try {
            std::rethrow_exception(thrown);
        } catch (const InputError& error) {
            PyErr_SetString(PyExc_ValueError, error.what());
        }
    });
    const nb::exception<DeviceError> device_error(module, "DeviceError", PyExc_RuntimeError);
    device_error.attr("__doc__") =
        "A device failed or cannot do what was asked: one line that says which, and what was being done.";
    const nb::exception<OutOfMemory> out_of_memory(module, "OutOfMemory", device_error.ptr());
    out_of_memory.attr("__doc__") =
        "Memory of a device does not suffice: what was asked for and what there is. The device works on.";
}

} // namespace tandem::python
