// SPDX-License-Identifier: MIT
// DLPack's table of C functions, which the arrays of a library have without a word of Python (DLPack 1.3).
#pragma once

#include <cstdint>
#include <nanobind/ndarray.h>
#include <optional>

namespace tandem::python {

/// An array, and the stream that its library gives its work to now; null of the host's memory.
struct Exchanged {
    nanobind::ndarray<nanobind::ro> array;
    void* stream = nullptr;
};

/// By __dlpack_c_exchange_api__ of the array's type. None where it has none, or would not give the array: its
/// __dlpack__ says why.
std::optional<Exchanged> exchanged(nanobind::handle array);

} // namespace tandem::python
