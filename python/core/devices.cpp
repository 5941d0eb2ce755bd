// SPDX-License-Identifier: MIT
#include "python/core/devices.h"

#include "backends/registry.h"
#include "base/memory.h"
#include "python/core/process.h"

#include <nanobind/stl/string_view.h>

namespace nb = nanobind;

namespace tandem::python {

namespace {

/// Fields have the names of `tandem devices --json`.
nb::dict dictionary(const std::string& backend, const DeviceInfo& info) {
    nb::dict fields;
    fields["id"] = info.id.c_str();
    fields["backend"] = backend.c_str();
    fields["name"] = info.name.c_str();
    fields["driver"] = info.driver.c_str();
    fields["compiler"] = info.compiler.c_str();
    fields["compute_units"] = info.compute_units;
    fields["memory_bytes"] = info.global_bytes;
    fields["local_bytes"] = info.local_bytes;
    fields["double"] = info.has_double;
    fields["hardware"] = info.hardware.empty() ? nb::object(nb::none()) : nb::str(info.hardware.c_str());
    return fields;
}

nb::list devices() {
    check_process("devices()");
    note_runtime();
    const auto backends = [] {
        const nb::gil_scoped_release released;
        return discover();
    }();
    nb::list all;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) all.append(dictionary(backend.name, device->info()));
    return all;
}

} // namespace

void bind_devices(nb::module_& module) {
    module.def(
        "devices", &devices, nb::sig("def devices() -> list[dict[str, object]]"),
        "All devices, with the fields of `tandem devices --json`: id (the argument `device` of Collider), "
        "backend, name, driver, compiler, compute_units, memory_bytes, local_bytes, double (whether it "
        "has that type), hardware (PCI address or UUID; None if unknown). A backend without devices "
        "has no entry; a Collider on one of its devices raises an error with the reason.");
    module.def("refuse_beyond_memory", &refuse_beyond_memory, nb::arg("what"), nb::arg("bytes"),
               "Raises ValueError if `what` needs more bytes than this process can still allocate.");
}

} // namespace tandem::python
