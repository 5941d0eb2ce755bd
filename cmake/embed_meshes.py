# SPDX-License-Identifier: MIT
"""embed_meshes.py FOLDER OUT.cpp: writes TetGen meshes as C++ strings."""

import pathlib
import sys

folder, out = map(pathlib.Path, sys.argv[1:])
lines = [
    '#include "scenes/embedded.h"',
    "namespace tandem {",
    "std::span<const EmbeddedMesh> embedded_meshes() {",
    "static const EmbeddedMesh all[] = {",
]
for node in sorted(folder.glob("*.node")):
    texts = [f'R"MESH({path.read_text()})MESH"' for path in (node, node.with_suffix(".ele"))]
    lines.append(f'{{"{node.stem}", {texts[0]}, {texts[1]}}},')
lines += ["};", "return all;", "}", "} // namespace tandem", ""]
out.write_text("\n".join(lines))
