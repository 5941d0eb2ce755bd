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

/// The arguments for one frame, with its entries.
struct FrameObjects {
    nb::handle poses;
    Entries vertices;
    std::vector<std::uint32_t> posed{};
};

template<class ReadRows>
Input make_input(const Collider& collider, const FrameObjects& frame, const std::optional<FrameObjects>& next,
                 const ReadRows& read_rows) {
    Input input;
    nb::handle last_gpu_type;
    const auto rows = [&](nb::handle array, const WantedRows& wanted) {
        auto given = read_rows(array, wanted);
        input.on_device |= given.on_device;
        return given;
    };
    const auto arrays = [&](const FrameObjects& objects, bool of_next) {
        FrameArrays result;
        result.posed = objects.posed;
        if (!objects.poses.is_none())
            result.poses = rows(objects.poses, {collider.devices(), 7, last_gpu_type, of_next});
        result.vertices.resize(objects.vertices.size());
        for (std::size_t body = 0; body < objects.vertices.size(); ++body)
            if (const auto& array = objects.vertices[body]; array && !array.is_none())
                result.vertices[body] = rows(array, {collider.devices(), 3, last_gpu_type, of_next, body});
        return result;
    };
    input.frame = arrays(frame, false);
    if (next) input.next = arrays(*next, true);
    return input;
}

bool is_given(const FrameArguments& frame) { return !frame.poses.is_none() || !frame.vertices.is_none(); }

} // namespace

std::optional<Input> input_of(const Collider& collider, const FrameArguments& frame,
                              const FrameArguments& next) {
    auto entries = entries_of(collider, frame.vertices), next_entries = entries_of(collider, next.vertices);
    if (!entries || !next_entries) return std::nullopt;
    std::optional<FrameObjects> successor;
    if (is_given(next)) successor = {next.poses, std::move(*next_entries)};
    return make_input(collider, {frame.poses, std::move(*entries)}, successor, given_rows);
}

Input update_of(const Collider& collider, const ChangeArguments& frame,
                const std::optional<ChangeArguments>& next) {
    const auto objects = [&](const ChangeArguments& changes) {
        return FrameObjects{changes.poses, entries_of(collider, changes.vertices).value_or(Entries()),
                            changes.posed};
    };
    auto input =
        make_input(collider, objects(frame), next ? std::optional(objects(*next)) : std::nullopt, given_rows);
    input.updates = true;
    return input;
}

Input device_input(const Collider& collider, const FrameArguments& frame, const FrameArguments& next) {
    const auto objects = [](const FrameArguments& arguments) {
        FrameObjects result{arguments.poses, {}};
        if (!arguments.vertices.is_none())
            for (const auto rows : nb::borrow<nb::list>(arguments.vertices))
                result.vertices.push_back(nb::borrow(rows));
        return result;
    };
    auto input = make_input(collider, objects(frame),
                            is_given(next) ? std::optional(objects(next)) : std::nullopt, device_rows);
    input.on_device = true;
    return input;
}

} // namespace tandem::python
