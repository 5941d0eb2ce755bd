# SPDX-License-Identifier: MIT
"""Flattens kernel files with their headers, and writes them as C++ strings, as host C++ for each variant, and
headers with the arguments of each kernel.

A kernel file says in one line of which defines its host code is compiled once for each value, and whether it
has loops over lanes, which are compiled for several levels of x86-64:

    // Host variants: AXES K PRECISION PRESSURE_SLAB SLABS=0|1, in lanes; of higher levels: PRECISION=32 SLABS=1
    // Host constants: MOTION PLACEMENT

AXES, K, PRECISION and PRESSURE_SLAB have the values of the build's geometries. Levels above the lowest have only
variants with the values that follow "of higher levels", or with others after an "or". All other defines are variables of the host code. Levels above
x86-64-v2 have these variants twice if the text names constants: once with the defaults of these defines."""

import argparse
import dataclasses
import itertools
import pathlib
import re
import sys

import kernel_arguments

INCLUDE = re.compile(r'^#include "([^"]+)"')
DEFAULT = re.compile(r"^#ifndef (\w+)\n#define \1 (\d+)$", re.M)
VARIANTS = re.compile(r"^// Host variants: (.*?)(, in lanes)?(?:; of higher levels: (.*))?$", re.M)
CONSTANTS = re.compile(r"^// Host constants: (.*)$", re.M)
OF_GEOMETRY = {"AXES", "K", "PRECISION", "PRESSURE_SLAB"}
LANES = re.compile(r"^(?!#define|//).*\bFOR_LANES\b|^#define IN_PACKS$", re.M)


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
    out = ['#include "algorithms/kernels/sources.h"', "namespace tandem {", "namespace {"]
    # With the suffix sv the compiler does not count two million characters one by one.
    out.append("using namespace std::string_view_literals;")
    for index, kernel in enumerate(kernels):
        out.append(
            f'constexpr KernelSource source_{index}{{"{kernel.name}",\nR"KERNEL({kernel.text})KERNEL"sv}};'
        )
    names = [f"source_{index}" for index in range(len(kernels))]
    out += [
        "} // namespace",
        table_code("KernelSource", names, "kernel_sources", own),
        "} // namespace tandem",
        "",
    ]
    return "\n".join(out)


@dataclasses.dataclass
class Kernel:
    """A kernel file. text: with its headers. geometry: names of defines that the build gives values for;
    choices: [["SLABS=0"], ["SLABS=1"]], other defines for each variant; on_higher: sets of values, one of which
    variants of levels above the lowest have; usual: names of defines whose defaults are constants in variants of their own."""

    name: str
    text: str
    own_text: str
    geometry: list = dataclasses.field(default_factory=list)
    choices: list = dataclasses.field(default_factory=list)
    in_lanes: bool = False
    on_higher: list = dataclasses.field(default_factory=list)
    usual: list = dataclasses.field(default_factory=list)

    def __post_init__(self):
        """Raises ValueError where the line of variants does not fit the text."""
        lines = VARIANTS.findall(self.own_text)
        if len(lines) != 1:
            raise ValueError(f"{self.name}: {len(lines)} lines '// Host variants: ...' instead of one")
        names, lanes, on_higher = lines[0]
        self.geometry = [word for word in names.split() if "=" not in word]
        lists = [word.split("=") for word in names.split() if "=" in word]
        self.choices = list(
            itertools.product(*([f"{name}={value}" for value in values.split("|")] for name, values in lists))
        )
        self.in_lanes, self.on_higher = (
            bool(lanes),
            [set(values.split()) for values in on_higher.split(" or ")],
        )
        self.usual = " ".join(CONSTANTS.findall(self.own_text)).split()
        for name in set(self.usual) - dict(DEFAULT.findall(self.text)).keys():
            raise ValueError(f"{self.name}: the text has no default of {name}")
        for name in {*OF_GEOMETRY, *self.geometry, *(name for name, _ in lists)}:
            is_listed = name in self.geometry or name in (pair[0] for pair in lists)
            if is_listed != bool(re.search(rf"\b{name}\b", VARIANTS.sub("", self.text))):
                raise ValueError(f"{self.name}: host variants and text differ in whether they name {name}")
        if self.in_lanes != bool(LANES.search(self.text)):
            raise ValueError(f"{self.name}: host variants and text differ in whether they have lanes")

    def variants(self, geometry):
        """Defines of the variants in a geometry, "AXES=0,K=8,PRECISION=32,PRESSURE_SLAB=0"."""
        own = [pair for pair in geometry.split(",") if pair.partition("=")[0] in self.geometry]
        return [[*own, *choice] for choice in self.choices]

    def is_on_higher(self, defines, higher_k):
        """Whether levels above the lowest have this variant, of those values of k in `higher_k` or of all."""
        has = set(defines)
        slab = 2 if "PRESSURE_SLAB=1" in has else 0
        is_of_k = not higher_k or "K" not in self.geometry or has & {f"K={int(k) + slab}" for k in higher_k}
        return any(values <= has for values in self.on_higher) and is_of_k


def variant_code(kernel, defines, constants, scope, level):
    """Code of one variant, in a namespace of its own because types of one name differ between variants, and its
    rows in the table. constants: names of defines that are no variables but have their defaults."""
    fixed = dict(pair.split("=") for pair in defines)
    found = dict(sorted(DEFAULT.findall(kernel.text)))
    usual = {key: found[key] for key in constants}
    fixed |= usual
    defaults = {key: value for key, value in found.items() if key not in fixed and key != "GROUP_SIZE"}
    out = [f"namespace {scope} {{", "#undef TANDEM_PORTABLE_H"]
    out += [f"#define {key} {value}" for key, value in fixed.items()] + ["#define GROUP_SIZE 1"]
    if kernel.in_lanes:  # nothing is shared with files that are compiled for other processors
        out.append("#define LOCAL_ON_STACK")
    for key, value in defaults.items():
        out.append(f"static constinit thread_local long runtime_{key} = {value};")
        out.append(f"#define {key} runtime_{key}")
    out += [kernel.text, f'#line 1 "{scope}"', "static const tandem::host::RuntimeDefine runtime[] = {"]
    out += [
        f'{{"{key}", [](long to) {{ runtime_{key} = to; }}, {value}}},' for key, value in defaults.items()
    ]
    out += ["{nullptr, nullptr, 0}};", "}"]
    macros = {*re.findall(r"^#\s*define (\w+)", kernel.text, re.M), *fixed, *defaults}
    out += [f"#undef {macro}" for macro in sorted(macros | {"GROUP_SIZE", "LOCAL_ON_STACK"})]
    rows = []
    for entry, _ in kernel_arguments.KERNEL.findall(kernel.text):
        call = f"tandem::host::Invoke<&{scope}::{entry}>"
        rows.append(
            f'{{"{kernel.name}", "{entry}", "{";".join(defines)}", {call}::run, {call}::count, '
            f"{{{scope}::runtime, {len(defaults)}}}, {level}, "
            f'"{"".join(f"{key}={value};" for key, value in usual.items())}"}},'
        )
    return out, rows


def host_variant(kernels, geometry, geometries, identifier, level, higher_k):
    """Code of the kernels of one geometry. A kernel that names only some of its defines is in the first
    geometry with these values. `level`: x86-64-v2, -v3 or -v4, for which the file is compiled; 0: any
    processor. `higher_k`: None at the lowest level, which has all variants."""
    out, rows = [], []
    for number, kernel in enumerate(kernels):
        own = kernel.variants(geometry)
        if geometry != next(g for g in geometries if kernel.variants(g) == own):
            continue
        for choice, defines in enumerate(own):
            if higher_k is not None and not kernel.is_on_higher(defines, higher_k):
                continue
            has_usual = kernel.usual and level > 2 and kernel.is_on_higher(defines, higher_k)
            for constants in [[], kernel.usual] if has_usual else [[]]:
                scope = f"{identifier}_kernel_{number}_{choice}{'_usual' if constants else ''}"
                code, own_rows = variant_code(kernel, defines, constants, scope, level)
                out += code
                rows += own_rows
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


def write_level(arguments, kernels, level):
    """Writes the host code of a level, several geometries to a file; returns the names of its tables."""
    these = [kernel for kernel in kernels if not arguments.levels or kernel.in_lanes == (level != 0)]
    own = re.sub(r"\W", "_", arguments.own)
    has_all = level in (0, min(arguments.levels, default=0))
    found, parts = [], []
    for geometry in arguments.geometries:
        name = "_".join(
            filter(None, ["host", own, f"v{level}" if level else "", re.sub(r"\W", "_", geometry)])
        )
        higher_k = None if has_all else arguments.higher_k
        parts.append(host_variant(these, geometry, arguments.geometries, name, level, higher_k))
        if parts[-1]:
            found.append(name)
    for number, first in enumerate(range(0, len(parts), arguments.each)):
        code = parts[first : first + arguments.each]
        text = "\n".join(['#include "backends/host/dialect.h"', *code] if any(code) else [])
        write(arguments.out / (f"host_v{level}_{number}.cpp" if level else f"host_{number}.cpp"), text)
    return found


def parsed():
    parser = argparse.ArgumentParser()
    parser.add_argument("--root", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--geometries", nargs="+")
    parser.add_argument("--each", type=int, default=1, help="geometries per file")
    parser.add_argument("--kernels", nargs="+")
    parser.add_argument("--levels", nargs="*", type=int, default=[], help="of x86-64, for files with lanes")
    parser.add_argument("--higher-k", nargs="*", default=[], help="at levels above the lowest; left out: all")
    parser.add_argument("--own", default="", help="target that contains the kernels; left out: the library")
    parser.add_argument("--flatten", help="only print this kernel file with its headers")
    return parser.parse_args()


def main():
    arguments = parsed()
    root = arguments.root
    if arguments.flatten:
        print("\n".join(flatten(root, arguments.flatten, set())))
        return
    arguments.out.mkdir(parents=True, exist_ok=True)
    try:
        kernels = [
            Kernel(name, "\n".join(flatten(root, name, set())) + "\n", (root / name).read_text())
            for name in arguments.kernels
        ]
        for kernel in kernels:
            path = arguments.out / f"{kernel.name}.h"
            path.parent.mkdir(parents=True, exist_ok=True)
            write(path, kernel_arguments.header(kernel.name, kernel.text))
    except ValueError as error:
        sys.exit(str(error))
    write(arguments.out / "sources.cpp", sources(kernels, arguments.own))
    names = [name for level in [0, *arguments.levels] for name in write_level(arguments, kernels, level)]
    write(arguments.out / "host_table.cpp", host_table(names, arguments.own))


main()
