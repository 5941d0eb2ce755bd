// SPDX-License-Identifier: MIT
#include "python/core/frame_arrays.h"

#include "base/error.h"

#include <fmt/format.h>

namespace tandem::python {

namespace {

/// `prefix`: how the names of the arguments begin.
void check_rows(const Scene& scene, const FrameArrays& arrays, std::string_view prefix) {
    const auto bodies = scene.bodies.size();
    if (arrays.poses && arrays.posed.empty() && arrays.poses->rows != bodies)
        throw InputError(fmt::format("{}poses: {} rows for {} bodies; give each body its row", prefix,
                                     arrays.poses->rows, bodies));
    for (std::size_t body = 0; body < bodies; ++body) {
        const auto* const given = arrays.vertices_of(body);
        const auto count = scene.meshes[scene.bodies[body].mesh].vertices.size();
        if (given != nullptr && given->rows != count)
            throw InputError(fmt::format("{}vertices: {} rows for body {}, whose mesh has {} vertices",
                                         prefix, given->rows, body, count));
    }
}

} // namespace

void check_rows(const Scene& scene, const Input& input) {
    check_rows(scene, input.frame, "");
    if (input.next) check_rows(scene, *input.next, "next_");
}

} // namespace tandem::python
