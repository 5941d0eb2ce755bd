# SPDX-License-Identifier: MIT
"""Headers with a C++ structure for the arguments of each kernel (backends/handles.h, KernelOf)."""

import pathlib
import re

KERNEL = re.compile(r"^KERNEL void (\w+)\(([^)]*)\)", re.M)
BUFFER = re.compile(r"GLOBAL (?:const )?\w+\* (\w+)")
TYPES = {"uint": "std::uint32_t", "ulong": "std::uint64_t", "float": "float", "double": "double"}
SCALAR = re.compile(rf"({'|'.join(TYPES)}) (\w+)")


def member(parameter):
    """Name of a parameter, and the type of its member. Raises ValueError."""
    if match := BUFFER.fullmatch(parameter):
        return match[1], "const Buffer&"
    if match := SCALAR.fullmatch(parameter):
        return match[2], f"Exact<{TYPES[match[1]]}>"
    raise ValueError(f"parameter '{parameter}' is neither a pointer to GLOBAL memory nor {', '.join(TYPES)}")


def structure(file, entry, parameters):
    members = [member(" ".join(parameter.split())) for parameter in parameters.split(",")]
    return [
        f"struct {entry.title().replace('_', '')} {{",
        f'    static constexpr std::string_view source = "{file}", entry = "{entry}";',
        *(f"    {kind} {name};" for name, kind in members),
        f"    std::array<Argument, {len(members)}> in_order() const {{",
        f"        return {{{', '.join(name for name, _ in members)}}};",
        "    }",
        "};",
    ]


def header(file, text):
    """The header of a kernel file with this text, in a namespace with the name of the file. Raises
    ValueError."""
    lines = [
        "#pragma once",
        '#include "backends/handles.h"',
        f"namespace tandem::kernels::{pathlib.PurePath(file).stem} {{",
    ]
    for entry, parameters in KERNEL.findall(text):
        try:
            lines += structure(file, entry, parameters)
        except ValueError as error:
            raise ValueError(f"{file}: kernel {entry}: {error}") from error
    return "\n".join([*lines, "}", ""])
