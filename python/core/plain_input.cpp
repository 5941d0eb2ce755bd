// SPDX-License-Identifier: MIT
#include "python/core/plain_input.h"

#include <string_view>

namespace nb = nanobind;

namespace tandem::python {

bool PlainRows::hold(nb::handle object, std::size_t columns) {
    if (!PyObject_CheckBuffer(object.ptr())) return false;
    if (PyObject_GetBuffer(object.ptr(), &view_, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
        PyErr_Clear();
        return false;
    }
    held_ = true;
    return view_.ndim == 2 && view_.shape[1] == static_cast<Py_ssize_t>(columns) && view_.format != nullptr
           && std::string_view(view_.format) == "d";
}

bool PlainInput::hold_body(const Collider& collider, std::size_t body, nb::handle rows) {
    if (body >= collider.bodies() || !collider.is_deformable(body)) return false;
    auto& held = held_.emplace_back();
    if (!held.hold(rows, 3)) return false;
    input_.vertices[body] = held.rows();
    return true;
}

bool PlainInput::hold_vertices(const Collider& collider, nb::handle vertices) {
    input_.vertices.resize(collider.bodies());
    if (PyDict_CheckExact(vertices.ptr())) {
        if (PyDict_Size(vertices.ptr()) == 0) return false; // others know whether there are any to give
        PyObject *key = nullptr, *rows = nullptr;
        for (Py_ssize_t at = 0; PyDict_Next(vertices.ptr(), &at, &key, &rows) != 0;) {
            if (!PyLong_CheckExact(key)) return false;
            const auto body = PyLong_AsSize_t(key);
            if (PyErr_Occurred() != nullptr) PyErr_Clear(); // of a body that there is not
            if (!hold_body(collider, body, rows)) return false;
        }
        return true;
    }
    if (!PyList_CheckExact(vertices.ptr())) return false;
    Py_ssize_t next = 0;
    const auto count = PyList_GET_SIZE(vertices.ptr());
    for (std::size_t body = 0; body < collider.bodies(); ++body) {
        if (!collider.is_deformable(body)) continue;
        if (next == count || !hold_body(collider, body, PyList_GET_ITEM(vertices.ptr(), next++)))
            return false;
    }
    return next == count && count > 0;
}

bool PlainInput::hold(const Collider& collider, nb::handle poses, nb::handle vertices) {
    if (!poses.is_none()) {
        auto& held = held_.emplace_back();
        if (!held.hold(poses, 7)) return false;
        input_.poses = held.rows();
    }
    return vertices.is_none() || hold_vertices(collider, vertices);
}

} // namespace tandem::python
