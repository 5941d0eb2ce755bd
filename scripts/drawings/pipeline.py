# SPDX-License-Identifier: MIT
"""A drawing of the pipeline of a frame: what each step makes of two bodies, and who works."""

from . import parts, walks
from .bodies import LEAVES, common, overlap
from .canvas import Drawing, polygon, rectangle
from .methods import CHUNKS, overlapping
from .parts import LEFT, RIGHT

NAMES = ("Poses", "Refit", "Broad phase", "Seeds", "Walk", "Contacts")
ABOUT = "Six steps of a frame, each with the same two bodies: poses, bounds of nodes, a pair of bodies that overlap, seeds, candidate pairs, and pairs that meet. The device performs all steps one after the other, and the host waits once."


def boxes(drawing, pair, places, level):
    """The boxes of a level of nodes."""
    for which, body in zip("ab", pair):
        shown = [rectangle(parts.moved_box(body.nodes[node], places)) for node in range(level, 2 * level)]
        drawing.path(shown, stroke=which, width=0.8 if level > 1 else 1.6)


def triangles(drawing, pair, place, found):
    for which, body, leaves in zip("ab", pair, map(set, zip(*found))):
        drawing.path(
            [polygon(parts.moved(body.triangles[leaf], place)) for leaf in sorted(leaves)],
            which,
            None,
            None,
            0.7,
        )


def pipeline(pair):
    drawing = Drawing("pipeline", "The pipeline of a frame", ABOUT)
    parts.draw_bodies(drawing, pair, (0, 0, 1))
    drawing.keep()
    drawing.subtitle("The host starts all steps together, and waits once.")
    found = sorted(walks.walk_tiles(*pair).found)
    meeting = [one for i, j in found if len(one := common(pair[0].triangles[i], pair[1].triangles[j])) > 2]
    seeds = overlapping(pair, CHUNKS)
    counts = (
        "2 poses",
        f"{2 * (2 * LEAVES - 1)} boxes",
        "1 pair of bodies",
        f"{len(seeds)} seeds overlap",
        f"{len(found)} candidates",
        f"{len(meeting)} pairs meet",
    )
    width = (RIGHT - LEFT) / 3
    for step, (name, count) in enumerate(zip(NAMES, counts)):
        x, y = LEFT + width * (step % 3), 66 + 134 * (step // 3)
        place = (x, y + 26, (width - 14) / 520)
        drawing.text(x, y + 16, f"{step + 1} {name}")
        drawing.subtitle(count, y + 112, x=x)
        drawing.use(place)
        if name == "Refit":
            boxes(drawing, pair, place, 16)
        elif name == "Broad phase":
            boxes(drawing, pair, place, 1)
        elif name == "Seeds":
            parts.draw_pairs(drawing, pair, seeds, place)
        elif name == "Walk":
            triangles(drawing, pair, place, found)
        elif name == "Contacts":
            drawing.path([polygon(parts.moved(points, place)) for points in meeting], "text")
    draw_time(drawing, 342)
    return drawing.svg(436)


def draw_time(drawing, top):
    """Who works in which step. Lengths are those of the words, not of times."""
    first, step = 74, 62
    host, device, end = top + 20, top + 66, first + 7 * step
    block = lambda start, stop, y, colour: drawing.path([rectangle((start, y - 16, stop, y + 12))], colour)
    drawing.text(LEFT, host + 3, "host")
    drawing.text(LEFT, device + 3, "device")
    block(first, end, host, "idle")
    block(first, end, device, "idle")
    block(first, first + step - 3, host, "host")
    drawing.text(first + step / 2 - 2, host + 3, "starts", fill="ink", anchor="middle")
    drawing.text(first + 3.5 * step, host + 3, "waits once", fill="quiet", anchor="middle")
    block(end - step + 3, end, host, "host")
    drawing.text(end - step / 2 + 2, host + 3, "reads", fill="ink", anchor="middle")
    for number in range(len(NAMES)):
        x = first + (number + 0.5) * step
        block(x + 2, x + step - 2, device, "test")
        drawing.text(x + step / 2, device + 3, str(number + 1), fill="ground", anchor="middle")
