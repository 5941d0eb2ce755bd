// SPDX-License-Identifier: MIT
#include "python/core/signals.h"

namespace nb = nanobind;

namespace tandem::python {

namespace {

/// Rare enough that waiting for the interpreter's lock costs nothing beside frames.
constexpr std::chrono::milliseconds between_checks(100);

} // namespace

Signals::Signals(const DeviceGroup& devices) : devices_(devices) {
    for (auto* device : devices_) device->set_check([this] { check(); });
}

Signals::~Signals() {
    for (auto* device : devices_) device->set_check({});
}

/// Only the caller's thread asks Python. It also works on one of several devices.
void Signals::check() {
    if (raised_) throw Raised{};
    if (std::this_thread::get_id() != caller_) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < between_checks) return;
    const nb::gil_scoped_acquire held;
    const bool is_raised = PyErr_CheckSignals() != 0;
    last_ = std::chrono::steady_clock::now();
    if (!is_raised) return;
    error_ = std::make_exception_ptr(nb::python_error()); // takes it from the interpreter
    raised_ = true;
    throw Raised{};
}

void Signals::finish() const {
    for (auto* device : devices_) device->finish();
}

} // namespace tandem::python
