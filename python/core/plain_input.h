// SPDX-License-Identifier: MIT
// The way of most frames from NumPy: arrays that are as the library takes them, looked at without a word of
// Python. After milliseconds of a frame the interpreter's own code and data have left the caches, so that
// each step of it counts.
#pragma once

#include "python/core/collider.h"

#include <deque>

namespace tandem::python {

/// Rows of float64 beside each other by the buffer protocol, held until it goes, with the interpreter's lock.
class PlainRows {
public:
    PlainRows() = default;
    PlainRows(const PlainRows&) = delete;
    PlainRows& operator=(const PlainRows&) = delete;
    ~PlainRows() {
        if (held_) PyBuffer_Release(&view_);
    }
    /// False where the object is something else.
    bool hold(nanobind::handle object, std::size_t columns);
    HostRows rows() const {
        return {static_cast<const double*>(view_.buf), static_cast<std::size_t>(view_.shape[0])};
    }

private:
    Py_buffer view_{};
    bool held_ = false;
};

/// A frame all of whose arrays are plain.
class PlainInput {
public:
    /// `poses`: None or an array; `vertices`: None, a list of one array for each deformable body, or {body:
    /// array}. False where anything is something else, also what is wrong: others have words for that.
    bool hold(const Collider& collider, nanobind::handle poses, nanobind::handle vertices);
    const HostInput& input() const { return input_; }

private:
    bool hold_vertices(const Collider& collider, nanobind::handle vertices);
    bool hold_body(const Collider& collider, std::size_t body, nanobind::handle rows);

    HostInput input_;
    std::deque<PlainRows> held_;
};

} // namespace tandem::python
