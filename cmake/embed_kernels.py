# SPDX-License-Identifier: MIT
"""Flattens kernel files with their headers, writes them as C++ strings, and as host C++ per geometry."""
import argparse
import pathlib
import re

INCLUDE = re.compile(r'^#include "([^"]+)"')
ENTRY = re.compile(r"^KERNEL void (\w+)\(", re.M)
DEFAULT = re.compile(r"^#ifndef (\w+)\n#define \1 (\d+)$", re.M)


def flatten(root, name, seen):
    """The text of `name` with each header included once, with #line marks for the compilers' messages."""
    lines = [f'#line 1 "{name}"']
    for number, line in enumerate((root / name).read_text().splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            lines.append(line)
            continue
        if match[1] not in seen:
            seen.add(match[1])
            lines += flatten(root, match[1], seen)
        lines.append(f'#line {number + 1} "{name}"')
    return lines


def write(path, text):
    """Writes only what changed, so that ccache and ninja have less to do."""
    if not path.exists() or path.read_text() != text:
        path.write_text(text)
    else:
        path.touch()


def handed_out(row, names, function, own):
    """How rows reach those who look for them: the library's by a function, a program's own by adding themselves."""
    table = f"static const {row} all[] = {{{', '.join(names)}}};"
    if own:
        return f"{table}\n[[maybe_unused]] static const bool added = (add_{function}(all), true);"
    return f"std::span<const {row}> {function}() {{\n    {table}\n    return all;\n}}"


def sources(kernels, own):
    out = ['#include "algorithms/sources.h"', "namespace tandem {", "namespace {"]
    for index, (name, text) in enumerate(kernels.items()):
        out.append(f'constexpr KernelSource source_{index}{{"{name}",\nR"KERNEL({text})KERNEL"}};')
    names = [f"source_{index}" for index in range(len(kernels))]
    out += ["} // namespace", handed_out("KernelSource", names, "kernel_sources", own), "} // namespace tandem", ""]
    return "\n".join(out)


def named(text, geometry):
    """The part of a geometry that the text names."""
    return [pair for pair in geometry.split(",") if re.search(rf"\b{pair.split('=')[0]}\b", text)]


def host_variant(kernels, geometry, geometries, identifier):
    """Kernels of one geometry; one that does not name all of it is in the first variant of what it does name."""
    out, rows = [], []
    for index, (name, text) in enumerate(kernels.items()):
        own = named(text, geometry)
        if geometry != next(g for g in geometries if named(text, g) == own):
            continue
        fixed = dict(pair.split("=") for pair in own)
        defaults = {key: value for key, value in DEFAULT.findall(text) if key not in fixed and key != "GROUP_SIZE"}
        names = sorted(defaults)
        # A namespace of this variant's own: types of one name differ between variants.
        scope = f"{identifier}_kernel_{index}"
        out += [f"namespace {scope} {{", "#undef TANDEM_PORTABLE_H"]
        out += [f"#define {key} {value}" for key, value in fixed.items()] + ["#define GROUP_SIZE 1"]
        for key in names:
            out += [f"static constinit thread_local long runtime_{key} = {defaults[key]};", f"#define {key} runtime_{key}"]
        out += [text, f'#line 1 "{identifier}"', "static const tandem::host::RuntimeDefine runtime[] = {"]
        out += [f'{{"{key}", [](long value) {{ runtime_{key} = value; }}, {defaults[key]}}},' for key in names] + ["{nullptr, nullptr, 0}};", "}"]
        macros = set(re.findall(r"^#\s*define (\w+)", text, re.M)) | set(fixed) | set(names) | {"GROUP_SIZE"}
        out += [f"#undef {macro}" for macro in sorted(macros)]
        for entry in ENTRY.findall(text):
            call = f"tandem::host::Invoke<&{scope}::{entry}>"
            rows.append(f'{{"{name}", "{entry}", "{";".join(own)}", {call}::run, {call}::count, '
                        f"{{{scope}::runtime, {len(names)}}}}},")
    out += [f"extern const std::span<const tandem::host::HostKernel> {identifier};",
            f"static const tandem::host::HostKernel {identifier}_rows[] = {{", *rows, "};",
            f"const std::span<const tandem::host::HostKernel> {identifier}({identifier}_rows);", ""]
    return "\n".join(out)


def host_table(identifiers, own):
    out = ['#include "backends/host/dialect.h"']
    out += [f"extern const std::span<const tandem::host::HostKernel> {name};" for name in identifiers]
    names = ["::" + name for name in identifiers]
    out += ["namespace tandem::host {", handed_out("std::span<const HostKernel>", names, "host_kernels", own),
            "} // namespace tandem::host", ""]
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--geometries", nargs="+")
    parser.add_argument("--each", type=int, default=1, help="geometries in a file")
    parser.add_argument("--kernels", nargs="+")
    parser.add_argument("--own", default="", help="the target whose own these are; left out for the library")
    parser.add_argument("--flatten", help="only print this kernel file with its headers")
    arguments = parser.parse_args()
    if arguments.flatten:
        print("\n".join(flatten(arguments.root, arguments.flatten, set())))
        return
    arguments.out.mkdir(parents=True, exist_ok=True)
    kernels = {name: "\n".join(flatten(arguments.root, name, set())) + "\n" for name in arguments.kernels}
    write(arguments.out / "sources.cpp", sources(kernels, arguments.own))
    identifiers = ["_".join(filter(None, ["host", re.sub(r"\W", "_", arguments.own), re.sub(r"\W", "_", geometry)]))
                   for geometry in arguments.geometries]
    variants = [host_variant(kernels, geometry, arguments.geometries, identifier)
                for geometry, identifier in zip(arguments.geometries, identifiers)]
    for part, first in enumerate(range(0, len(variants), arguments.each)):
        write(arguments.out / f"host_{part}.cpp",
              "\n".join(['#include "backends/host/dialect.h"', *variants[first:first + arguments.each]]))
    write(arguments.out / "host_table.cpp", host_table(identifiers, arguments.own))


main()
