// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/collider.h"

namespace tandem::python {

/// Arguments of a call for one frame. `poses`: None or an array; `vertices`: None, a list with one array per
/// deformable body, or {body: array}.
struct FrameArguments {
    nanobind::handle poses, vertices;
};

/// `next`: the frame's successor; there is none if both of its arguments are None. None for another
/// `vertices`, before any array is read: the Python caller reports the error. Throws as given_rows does.
std::optional<Input> input_of(const Collider& collider, const FrameArguments& frame,
                              const FrameArguments& next);

/// Arguments of an update for one frame. `poses`: None, or an array with a row for each body of `posed`.
/// `vertices`: None or {body: array}.
struct ChangeArguments {
    std::vector<std::uint32_t> posed;
    nanobind::handle poses, vertices;
};

/// Input::updates, of checked numbers of bodies. Throws as given_rows does.
Input update_of(const Collider& collider, const ChangeArguments& frame,
                const std::optional<ChangeArguments>& next);

/// The same as input_of by device_rows; `vertices` are None or a list with one entry per body.
Input device_input(const Collider& collider, const FrameArguments& frame, const FrameArguments& next);

} // namespace tandem::python
