// SPDX-License-Identifier: MIT
// DLPack's table of C functions (DLPack 1.3): exports arrays without running Python code.
#pragma once

#include <cstdint>
#include <nanobind/ndarray.h>
#include <optional>

namespace tandem::python {

/// An array, and the stream on which its library currently enqueues work; null for host memory.
struct Exchanged {
    nanobind::ndarray<nanobind::ro> array;
    void* stream = nullptr;
};

/// Exports an array by __dlpack_c_exchange_api__ of its type. None if the type has no such table or the
/// export fails; __dlpack__ then raises the reason.
std::optional<Exchanged> exchanged(nanobind::handle array);

} // namespace tandem::python
