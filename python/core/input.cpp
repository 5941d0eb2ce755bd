// SPDX-License-Identifier: MIT
#include "python/core/input.h"

namespace nb = nanobind;

namespace tandem::python {

namespace {

using Entries = std::vector<nb::object>; ///< one array or none per body, kept alive while Python code runs

bool add(const Collider& collider, std::size_t body, nb::handle rows, Entries& entries) {
    if (body >= collider.bodies() || !collider.is_deformable(body)) return false;
    entries[body] = nb::borrow(rows);
    return true;
}

bool add_all_of_dict(const Collider& collider, const nb::dict& vertices, Entries& entries) {
    for (const auto [key, rows] : vertices) {
        if (!PyLong_CheckExact(key.ptr())) return false;
        const auto body = PyLong_AsSize_t(key.ptr());
        if (PyErr_Occurred() != nullptr) PyErr_Clear(); // a negative or too large number: add refuses it
        if (!add(collider, body, rows, entries)) return false;
    }
    return collider.is_any_deformable();
}

bool add_all_of_list(const Collider& collider, const nb::list& vertices, Entries& entries) {
    std::size_t next = 0;
    for (std::size_t body = 0; body < collider.bodies(); ++body)
        if (collider.is_deformable(body)
            && (next == vertices.size() || !add(collider, body, vertices[next++], entries)))
            return false;
    return next == vertices.size() && next > 0;
}

std::optional<Entries> entries_of(const Collider& collider, nb::handle vertices) {
    if (vertices.is_none()) return Entries();
    Entries entries(collider.bodies());
    const bool all = PyDict_CheckExact(vertices.ptr())
                         ? add_all_of_dict(collider, nb::borrow<nb::dict>(vertices), entries)
                         : PyList_CheckExact(vertices.ptr())
                               && add_all_of_list(collider, nb::borrow<nb::list>(vertices), entries);
    return all ? std::optional(std::move(entries)) : std::nullopt;
}

template<class ReadRows>
Input make_input(const Collider& collider, nb::handle poses, const Entries& entries,
                 const ReadRows& read_rows) {
    Input input;
    nb::handle last_gpu_type;
    const auto rows = [&](nb::handle array, const WantedRows& wanted) {
        auto given = read_rows(array, wanted);
        input.on_device |= given.on_device;
        return given;
    };
    if (!poses.is_none()) input.poses = rows(poses, {collider.devices(), 7, last_gpu_type});
    input.vertices.resize(entries.size());
    for (std::size_t body = 0; body < entries.size(); ++body)
        if (entries[body] && !entries[body].is_none())
            input.vertices[body] = rows(entries[body], {collider.devices(), 3, last_gpu_type, body});
    return input;
}

} // namespace

std::optional<Input> input_of(const Collider& collider, nb::handle poses, nb::handle vertices) {
    const auto entries = entries_of(collider, vertices);
    return entries ? std::optional(make_input(collider, poses, *entries, given_rows)) : std::nullopt;
}

Input device_input(const Collider& collider, nb::handle poses, const nb::list& vertices) {
    Entries entries;
    for (const auto rows : vertices) entries.push_back(nb::borrow(rows));
    auto input = make_input(collider, poses, entries, device_rows);
    input.on_device = true;
    return input;
}

} // namespace tandem::python
