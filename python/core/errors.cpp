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
    device_error.attr("__doc__") = "A device failed or does not support the request. The message is one "
                                   "line: the device and the operation.";
    const nb::exception<OutOfMemory> out_of_memory(module, "OutOfMemory", device_error.ptr());
    out_of_memory.attr("__doc__") =
        "A device has too little memory: the message gives the requested and the available bytes. The device "
        "remains usable.";
}

} // namespace tandem::python
