// SPDX-License-Identifier: MIT
#include "python/core/queued.h"

#include "algorithms/parameters/table.h"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/unique_ptr.h>

namespace nb = nanobind;

namespace tandem::python {

Queued::~Queued() {
    if (collider_->is_lost()) {
        static_cast<void>(new auto(std::move(frame_)));
        return;
    }
    const auto lock = collider_->lock_at_end();
    frame_ = {};
}

std::unique_ptr<Answer> Queued::collect() const {
    auto run = collider_->collect(number_);
    return run ? std::make_unique<Answer>(collider_, *std::move(run), true) : nullptr;
}

namespace {

std::unique_ptr<Answer> collected(const Queued& queued) {
    const nb::gil_scoped_release released;
    return queued.collect();
}

/// Rows in memory of the device, without a copy. Empty buffers have no rows.
template<class Number>
nb::ndarray<nb::array_api, Number> rows_of(nb::handle self, const Buffer& buffer, std::size_t count,
                                           std::size_t columns) {
    const auto& queued = nb::cast<const Queued&>(self);
    const auto& device = *queued.collider()->devices().front();
    const auto kind = dlpack_device(device);
    if (!kind)
        throw InputError(
            fmt::format("no array library takes OpenCL's memory by DLPack, and the answer is on {}; "
                        "call collect()",
                        device.info().id));
    return {buffer.native(), {buffer ? count : 0, columns}, self, {}, nb::dtype<Number>(), kind->first,
            kind->second};
}

nb::object pair_rows(nb::handle self) {
    const auto& frame = nb::cast<const Queued&>(self).frame();
    return nb::cast(rows_of<std::int32_t>(self, frame.pairs, frame.pair_capacity, 4));
}

nb::object contact_id_rows(nb::handle self) {
    const auto& frame = nb::cast<const Queued&>(self).frame();
    return nb::cast(rows_of<std::int32_t>(self, frame.contact_ids, frame.contact_capacity, 2));
}

nb::object contact_value_rows(nb::handle self) {
    const auto& queued = nb::cast<const Queued&>(self);
    const auto& frame = queued.frame();
    if (queued.collider()->settings()[parameters::precision] == Precision::fp64)
        return nb::cast(rows_of<double>(self, frame.contact_values, frame.contact_capacity, 8));
    return nb::cast(rows_of<float>(self, frame.contact_values, frame.contact_capacity, 8));
}

nb::object count_row(nb::handle self) {
    return nb::cast(
        rows_of<std::int64_t>(self, nb::cast<const Queued&>(self).frame().counts, 1, QUEUED_WORDS / 2));
}

} // namespace

void bind_queued(nb::module_& module) {
    nb::class_<Queued>(module, "Queued", "A frame of Collider.enqueue; tandem.Queued wraps it.")
        .def("collect", &collected, "The answer, after a wait; None if it is not complete.")
        .def_prop_ro("pairs", &pair_rows)
        .def_prop_ro("contact_ids", &contact_id_rows)
        .def_prop_ro("contact_values", &contact_value_rows)
        .def_prop_ro("counts", &count_row)
        .def_prop_ro("origin", [](const Queued& self) { return self.frame().origin; });
}

} // namespace tandem::python
