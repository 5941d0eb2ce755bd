# SPDX-License-Identifier: MIT
"""Figures 1 to 6: rendered scenes and our chunks."""

import csv
import math
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

import numpy
from matplotlib.patches import Rectangle

from .drawing import COLOURS, INK, Plot, missing
from .tables import written

TITLES = {
    "funnel": "funnel",
    "glasses": "falling glasses",
    "colosseum": "colosseum",
    "plates": "plates",
    "tower": "tower",
}


def render_script():
    """Path of scripts/render, which is part of the package; None if it is missing."""
    for path in (
        pathlib.Path(__file__).parent / "render.py",
        pathlib.Path(__file__).parents[3] / "scripts" / "render",
    ):
        if path.exists():
            return path
    return None


def rendered(folder, scene, fraction):
    """A list with the image of the scene at a fraction of its animation, stored as
    pictures/SCENE-PERCENT.png; empty if there is none.

    Without the export of the scene, takes the stored image: results are committed without recordings and
    exports, which are large."""
    import matplotlib.image

    glb, script = folder.path / f"{scene}.glb", render_script()
    stored = folder.path / "pictures" / f"{scene}-{fraction:.0%}.png".replace("%", "")
    if glb.exists() and script is not None:
        with tempfile.TemporaryDirectory() as work:
            done = subprocess.run(
                [
                    sys.executable,
                    str(script),
                    str(glb),
                    f"{work}/picture",
                    "--at",
                    str(fraction),
                    "--size",
                    "640x480",
                ],
                capture_output=True,
                text=True,
            )
            if done.returncode == 0:
                stored.parent.mkdir(exist_ok=True)
                shutil.copyfile(f"{work}/picture-0.png", stored)
    return [matplotlib.image.imread(stored)] if stored.exists() else []


def scenes(folder, number, selected, title):
    """A figure with one image for each selected (scene, fraction) that has one. title: what comes before the names
    of those that are shown."""
    pictures = [
        (scene, fraction, image)
        for scene, fraction in selected
        for image in rendered(folder, scene, fraction)
    ]
    if not pictures:
        return missing(folder.path, number, title, "no scene has been exported, or python3-pil is missing")
    plot = Plot(number, len(pictures), 2.5, min(len(pictures), 2))
    for ax, (scene, fraction, image) in zip(plot.axes, pictures):
        ax.imshow(image)
        ax.axis("off")
        ax.set_title(
            f"{TITLES[scene]}, at {100 * fraction:.0f} % of its steps", fontsize=9, loc="left", color=INK
        )
        plot.rows.append(
            {
                "scene": scene,
                "share": fraction,
                "file": f"pictures/{scene}-{fraction:.0%}.png".replace("%", ""),
            }
        )
    names = lambda some: ", ".join(dict.fromkeys(TITLES[scene] for scene, *_ in some))
    shown = {scene for scene, *_ in pictures}
    lacking = names(one for one in selected if one[0] not in shown)
    return plot.save(
        folder.path, f"{title}: {names(pictures)}" + (f" (no picture of {lacking})" if lacking else "")
    )


def figure1(folder):
    """The paper's number is of its jacks; our simulation of the same scene has the paper's solver."""
    jacks, contacts = folder.simulation("solver-jacks"), ""
    if jacks:
        kept = written(float(round(statistics.fmean(jacks.curve("contacts_kept")))))
        contacts = f" ({kept} contacts on average in {len(jacks.steps)} steps of our scene jacks; the paper: 550,000)"
    return scenes(folder, 1, [("funnel", 1.0)], f"Jacks that jam{contacts}")


def figure2(folder):
    selected = [("funnel", 0.5), ("funnel", 1.0), ("colosseum", 0.0), ("colosseum", 1.0)]
    return scenes(folder, 2, selected, "Simulations of rigid bodies")


def figure6(folder):
    selected = [(scene, 1.0) for scene in ("glasses", "funnel", "colosseum", "plates", "tower")]
    return scenes(folder, 6, selected, "Test scenes of the paper")


class Chunks:
    """The chunks of the largest mesh in a file of 'tandem export --chunks'."""

    def __init__(self, text_lines):
        rows = list(csv.DictReader(text_lines))
        counts = {}
        for row in rows:
            counts[row["mesh"]] = counts.get(row["mesh"], 0) + 1
        mesh = max(counts, key=counts.get)  # the mesh with the most rows
        rows = [row for row in rows if row["mesh"] == mesh]
        self.chunk = numpy.array([int(row["chunk"]) for row in rows])
        self.super_chunk = numpy.array([int(row["super_chunk"]) for row in rows])
        self.corners = numpy.array(
            [[[float(row[f"{axis}{i}"]) for axis in "xyz"] for i in range(4)] for row in rows]
        )

    def boxes(self, numbers=None):
        """Lower and upper corners of the box of each chunk's tetrahedra."""
        numbers = self.chunk if numbers is None else numbers
        parts = [self.corners[numbers == i].reshape(-1, 3) for i in range(numbers.max() + 1)]
        return numpy.array([[part.min(0), part.max(0)] for part in parts])

    def overlap(self):
        """Volume of the intersections of boxes of all pairs of chunks, over the volume of the mesh's box."""
        boxes = self.boxes()
        low, high = boxes[:, 0], boxes[:, 1]
        inside = numpy.clip(
            numpy.minimum(high[:, None], high[None]) - numpy.maximum(low[:, None], low[None]), 0, None
        ).prod(-1)
        pairs = numpy.triu(inside, 1).sum()
        return pairs / (high.max(0) - low.min(0)).prod()

    def largest(self):
        """Number of tetrahedra of the largest chunk."""
        return int(numpy.bincount(self.chunk).max())

    def fatness(self):
        """Median over chunks of the ratio of the shortest to the longest side of a box."""
        sides = self.boxes()[:, 1] - self.boxes()[:, 0]
        return float(numpy.median(sides.min(1) / sides.max(1)))


def chunks_of(folder, order):
    text_lines = folder.text_lines(f"chunks-{order}.csv") if folder.named(f"chunks-{order}") else []
    return Chunks(text_lines) if text_lines else None


def show(ax, chunks, numbers, boxes=True):
    """Draws tetrahedra in front view, coloured by chunk, and the boxes of the chunks."""
    depth = chunks.corners[:, :, 2].mean(1).argsort()
    centres = chunks.corners.mean(1)[depth]
    size = min(12.0, 3e4 / len(depth))
    ax.scatter(
        centres[:, 0],
        centres[:, 1],
        s=size,
        c=[COLOURS[i % len(COLOURS)] for i in numbers[depth]],
        linewidths=0,
        rasterized=True,
    )
    if boxes:
        for i, (low, high) in enumerate(chunks.boxes(numbers)):
            ax.add_patch(
                Rectangle(
                    low[:2], *(high - low)[:2], fill=False, edgecolor=COLOURS[i % len(COLOURS)], linewidth=1.2
                )
            )
    ax.set_aspect("equal")
    ax.axis("off")


def figure3(folder):
    chunks = chunks_of(folder, "morton")
    if chunks is None:
        return missing(folder.path, 3, "Chunks in memory", "chunks in Z-order have not been exported")
    plot = Plot(3, 2, 2.4)
    memory, mesh = plot.axes
    count = len(chunks.chunk)
    for i in range(chunks.chunk.max() + 1):
        where = numpy.flatnonzero(chunks.chunk == i)
        memory.broken_barh([(where[0], len(where))], (0, 1), color=COLOURS[i % len(COLOURS)], linewidth=0)
        plot.rows.append(
            {
                "chunk": i,
                "super_chunk": int(chunks.super_chunk[where[0]]),
                "first": int(where[0]),
                "tetrahedra": len(where),
            }
        )
    memory.set_xlim(0, count)
    memory.set_yticks([])
    memory.set_xlabel("position in memory")
    show(mesh, chunks, chunks.chunk, boxes=False)
    return plot.save(
        folder.path,
        f"{count:,} tetrahedra along the Z-curve make {chunks.chunk.max() + 1} chunks, each one stretch of memory and one place of the mesh",
    )


def figure4(folder):
    chunks = chunks_of(folder, "morton")
    if chunks is None:
        return missing(folder.path, 4, "Super chunks", "chunks in Z-order have not been exported")
    plot = Plot(4, 3, 2.6, 3)
    levels = [
        ("tetrahedra", numpy.zeros(len(chunks.chunk), int), len(chunks.chunk)),
        ("chunks", chunks.chunk, chunks.chunk.max() + 1),
        ("super chunks", chunks.super_chunk, chunks.super_chunk.max() + 1),
    ]
    for ax, (name, numbers, count), boxes in zip(plot.axes, levels, (False, True, True)):
        show(ax, chunks, numbers, boxes)
        ax.set_title(f"{count:,} {name}", fontsize=9, color=INK)
        plot.rows.append({"level": name, "count": int(count)})
    chunk_size = -(-len(chunks.chunk) // (chunks.chunk.max() + 1))
    return plot.save(
        folder.path,
        f"{len(chunks.chunk):,} tetrahedra, {chunks.chunk.max() + 1} chunks of up to {2 ** math.ceil(math.log2(chunk_size))}, {chunks.super_chunk.max() + 1} super chunk"
        + ("s" if chunks.super_chunk.max() else "")
        + ": two levels reach the root",
    )


def figure5(folder):
    breadth, morton = chunks_of(folder, "breadth"), chunks_of(folder, "morton")
    if breadth is None or morton is None:
        return missing(folder.path, 5, "Orders of tetrahedra", "chunks in both orders have not been exported")
    plot = Plot(5, 2, 3.2, 2)
    for ax, chunks, name in zip(plot.axes, (breadth, morton), ("breadth-first", "Z-order")):
        show(ax, chunks, chunks.chunk)
        ax.set_title(
            f"{name}: {chunks.overlap():.2f} of the mesh's box\nis in two chunks' boxes",
            fontsize=9,
            color=INK,
        )
        plot.rows.append(
            {
                "order": name,
                "chunks": int(chunks.chunk.max() + 1),
                "overlap_over_box": chunks.overlap(),
                "fatness": chunks.fatness(),
            }
        )
    times = breadth.overlap() / morton.overlap() if morton.overlap() else math.inf
    better = "overlap more" if times > 1 else "overlap less"
    return plot.save(
        folder.path,
        f"Chunks of 256 KiB: breadth-first ones {better}, {times:.2g} times as much as those in Z-order",
    )


def all_pictures(folder):
    return [make(folder) for make in (figure1, figure2, figure3, figure4, figure5, figure6)]
