// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

namespace tandem {

/// Those of `defines` that the text names: the others cannot change what it compiles to, so that cells which
/// differ in them share a program.
inline Defines defines_in(const KernelSource& source, Defines defines) {
    std::erase_if(defines, [&](const auto& define) {
        return source.text.find(define.first) == std::string_view::npos;
    });
    return defines;
}

} // namespace tandem
