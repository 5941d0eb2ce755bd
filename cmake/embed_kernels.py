# SPDX-License-Identifier: MIT
"""Flattens kernel files with their headers, and writes them as C++ strings and as host C++ for each
geometry."""

import argparse
import pathlib
import re

INCLUDE = re.compile(r'^#include "([^"]+)"')
ENTRY = re.compile(r"^KERNEL void (\w+)\(", re.M)
DEFAULT = re.compile(r"^#ifndef (\w+)\n#define \1 (\d+)$", re.M)


def flatten(root, name, included):
    """Text of `name` with each header included once, and #line directives for compiler messages. An include
    with * includes all files that it matches, by name. Extends `included`."""
    lines = [f'#line 1 "{name}"']
    for number, line in enumerate((root / name).read_text().splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            lines.append(line)
            continue
        for header in sorted(path.relative_to(root).as_posix() for path in root.glob(match[1])) or [match[1]]:
            if header not in included:
                included.add(header)
                lines += flatten(root, header, included)
        lines.append(f'#line {number + 1} "{name}"')
    return lines


def write(path, text):
    """Writes the file where its text differs. Otherwise only touches it, so that ninja takes it as new."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    else:
        path.touch()


def table_code(row, names, function, own):
    """Code that publishes rows: a function returns the library's; those of another target add themselves at
    program start."""
    table = f"static const {row} all[] = {{{', '.join(names)}}};"
    if own:
        return f"{table}\n[[maybe_unused]] static const bool added = (add_{function}(all), true);"
    return f"std::span<const {row}> {function}() {{\n    {table}\n    return all;\n}}"


def sources(kernels, own):
    out = ['#include "algorithms/sources.h"', "namespace tandem {", "namespace {"]
    for index, (name, text) in enumerate(kernels.items()):
        out.append(f'constexpr KernelSource source_{index}{{"{name}",\nR"KERNEL({text})KERNEL"}};')
    names = [f"source_{index}" for index in range(len(kernels))]
    out += [
        "} // namespace",
        table_code("KernelSource", names, "kernel_sources", own),
        "} // namespace tandem",
        "",
    ]
    return "\n".join(out)


def named(text, geometry):
    """Those defines of a geometry that occur in the text."""
    return [pair for pair in geometry.split(",") if re.search(rf"\b{pair.split('=')[0]}\b", text)]


def choices(text):
    """Defines, besides the geometry, for which a text is compiled separately: SLABS determines sizes of
    arrays."""
    return [["SLABS=0"], ["SLABS=1"]] if re.search(r"^#if SLABS\b", text, re.M) else [[]]


def has_lanes(text):
    """Whether a kernel file has loops over lanes, which the compiler vectorises."""
    return re.search(r"^(?!#define|//).*\bFOR_LANES\b", text, re.M) is not None


def is_of_higher_levels(defines, higher_k):
    """Whether levels above the lowest contain this variant: only those that are measured most. The lowest
    level has all of them."""
    k = [pair[2:] for pair in defines if pair.startswith("K=")]
    return not {"PRECISION=64", "SLABS=1"} & set(defines) and (not higher_k or set(k) <= set(higher_k))


def host_variant(kernels, geometry, geometries, identifier, level, is_wanted):
    """Code of the kernels of one geometry. A kernel that names only some of its defines is in the first
    geometry with these values. `level`: x86-64-v2, -v3 or -v4, for which the file is compiled; 0: any
    processor. `is_wanted`: whether the level has a variant with these defines."""
    out, rows = [], []
    variants = [(name, text, choice) for name, text in kernels.items() for choice in choices(text)]
    for index, (name, text, choice) in enumerate(variants):
        own = named(text, geometry)
        if geometry != next(g for g in geometries if named(text, g) == own):
            continue
        own = own + choice
        if not is_wanted(own):
            continue
        fixed = dict(pair.split("=") for pair in own)
        defaults = {
            key: value for key, value in DEFAULT.findall(text) if key not in fixed and key != "GROUP_SIZE"
        }
        names = sorted(defaults)
        # Local memory on the stack, so that nothing is shared with files that are compiled for other
        # processors.
        stack = ["#define LOCAL_ON_STACK"] if has_lanes(text) else []
        # A namespace for each variant: types of one name differ between variants.
        scope = f"{identifier}_kernel_{index}"
        out += [f"namespace {scope} {{", "#undef TANDEM_PORTABLE_H"]
        out += [f"#define {key} {value}" for key, value in fixed.items()] + ["#define GROUP_SIZE 1"] + stack
        for key in names:
            out += [
                f"static constinit thread_local long runtime_{key} = {defaults[key]};",
                f"#define {key} runtime_{key}",
            ]
        out += [text, f'#line 1 "{identifier}"', "static const tandem::host::RuntimeDefine runtime[] = {"]
        out += [
            f'{{"{key}", [](long value) {{ runtime_{key} = value; }}, {defaults[key]}}},' for key in names
        ] + ["{nullptr, nullptr, 0}};", "}"]
        macros = (
            set(re.findall(r"^#\s*define (\w+)", text, re.M))
            | set(fixed)
            | set(names)
            | {"GROUP_SIZE", "LOCAL_ON_STACK"}
        )
        out += [f"#undef {macro}" for macro in sorted(macros)]
        for entry in ENTRY.findall(text):
            call = f"tandem::host::Invoke<&{scope}::{entry}>"
            rows.append(
                f'{{"{name}", "{entry}", "{";".join(own)}", {call}::run, {call}::count, '
                f"{{{scope}::runtime, {len(names)}}}, {level}}},"
            )
    if not rows:
        return ""
    out += [
        f"extern const std::span<const tandem::host::HostKernel> {identifier};",
        f"static const tandem::host::HostKernel {identifier}_rows[] = {{",
        *rows,
        "};",
        f"const std::span<const tandem::host::HostKernel> {identifier}({identifier}_rows);",
        "",
    ]
    return "\n".join(out)


def host_table(identifiers, own):
    out = ['#include "backends/host/dialect.h"']
    out += [f"extern const std::span<const tandem::host::HostKernel> {name};" for name in identifiers]
    names = ["::" + name for name in identifiers]
    out += [
        "namespace tandem::host {",
        table_code("std::span<const HostKernel>", names, "host_kernels", own),
        "} // namespace tandem::host",
        "",
    ]
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--geometries", nargs="+")
    parser.add_argument("--each", type=int, default=1, help="geometries per file")
    parser.add_argument("--kernels", nargs="+")
    parser.add_argument(
        "--levels",
        nargs="*",
        type=int,
        default=[],
        help="levels of x86-64 for which files with lanes are compiled",
    )
    parser.add_argument(
        "--higher-k", nargs="*", default=[], help="values of K at levels above the lowest; left out: all"
    )
    parser.add_argument(
        "--own", default="", help="the target that contains the kernels; left out for the library"
    )
    parser.add_argument("--flatten", help="only print this kernel file with its headers")
    arguments = parser.parse_args()
    if arguments.flatten:
        print("\n".join(flatten(arguments.root, arguments.flatten, set())))
        return
    arguments.out.mkdir(parents=True, exist_ok=True)
    kernels = {name: "\n".join(flatten(arguments.root, name, set())) + "\n" for name in arguments.kernels}
    write(arguments.out / "sources.cpp", sources(kernels, arguments.own))
    identifiers = []
    for level in [0, *arguments.levels]:
        these = {
            name: text
            for name, text in kernels.items()
            if not arguments.levels or has_lanes(text) == (level != 0)
        }
        own = re.sub(r"\W", "_", arguments.own)
        names = [
            "_".join(filter(None, ["host", own, f"v{level}" if level else "", re.sub(r"\W", "_", geometry)]))
            for geometry in arguments.geometries
        ]
        has_all = level in (0, min(arguments.levels, default=0))
        variants = [
            host_variant(
                these,
                geometry,
                arguments.geometries,
                name,
                level,
                lambda own, has_all=has_all: has_all or is_of_higher_levels(own, arguments.higher_k),
            )
            for geometry, name in zip(arguments.geometries, names)
        ]
        for part, first in enumerate(range(0, len(variants), arguments.each)):
            these_variants = variants[first : first + arguments.each]
            write(
                arguments.out / (f"host_v{level}_{part}.cpp" if level else f"host_{part}.cpp"),
                "\n".join(
                    ['#include "backends/host/dialect.h"', *these_variants] if any(these_variants) else []
                ),
            )
        identifiers += [name for name, variant in zip(names, variants) if variant]
    write(arguments.out / "host_table.cpp", host_table(identifiers, arguments.own))


main()
