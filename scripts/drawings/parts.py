# SPDX-License-Identifier: MIT
"""What several drawings have: bodies, trees, and the lanes of the GPU over time."""

from .bodies import LEAVES
from .canvas import WIDTH, line, polygon, rectangle
from .walks import GROUPS, LANES

LEFT, RIGHT = 12, WIDTH - 12
ROW, GAP = 1.5, 6  # heights of a lane and between groups
SCALE = 1.1  # of a unit of time, the same in all drawings
KEY = (("test", "tests boxes"), ("read", "waits for memory"), ("idle", "no work"))


def moved(points, place):
    """Points, a box's two corners among them. place: what is added to both coordinates, and a scale."""
    x, y, scale = place
    return [(x + scale * p, y + scale * q) for p, q in points]


def moved_box(box, place):
    (left, top), (right, bottom) = moved((box[:2], box[2:]), place)
    return left, top, right, bottom


def middle(box, place):
    return moved([((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)], place)[0]


def draw_bodies(drawing, pair, place, is_strong=lambda which, leaf: False):
    """Both bodies. is_strong: whether a triangle of a body, 'a' or 'b', has a stronger colour."""
    for which, body in zip("ab", pair):
        for strong, opacity in ((False, 0.15), (True, 0.45)):
            triangles = [t for leaf, t in enumerate(body.triangles) if is_strong(which, leaf) == strong]
            if triangles:
                drawing.path(
                    [polygon(moved(t, place)) for t in triangles], which, which, 0.6 * place[2], opacity
                )


def name_bodies(drawing, place):
    """The letters a and b beside the ends of the bodies that stick out."""
    for which, point in (("a", (4, 66)), ("b", (500, 190))):
        ((x, y),) = moved([point], place)
        drawing.text(x, y, which, "name", which)


def draw_tree(drawing, colour, tops, rows, walked=()):
    """Trees below the nodes of one level. rows: heights of these nodes and of the leaves. walked: nodes whose edge is
    strong."""
    depth = LEAVES.bit_length() - tops[0].bit_length()

    def place(node):
        level = node.bit_length() - tops[0].bit_length()
        x = LEFT + (node - (tops[0] << level) + 0.5) * (RIGHT - LEFT) / (len(tops) << level)
        return x, rows[0] + level * (rows[1] - rows[0]) / depth

    for is_walked in (False, True):
        edges = [node for node in range(2 * tops[0], 2 * LEAVES) if (node in walked) == is_walked]
        if edges:
            parts = [line(place(node // 2), place(node)) for node in edges]
            drawing.path(parts, stroke=colour, width=2.2 if is_walked else 0.8)


def checkered(body, roots):
    """Every second of the compact sets of triangles below the nodes of a level, like the fields of a board."""
    two_rows = len(roots) > 4  # a level of 4 nodes is a row, one of 16 is two rows
    return {leaf for node in roots if (node + two_rows * (node // 2)) % 2 for leaf in body.below(node)}


def draw_pairs(drawing, pair, nodes, place):
    """A line for each pair of nodes, and a dot in the middle of each node of their level."""
    a, b = pair
    level = range(1 << (nodes[0][0].bit_length() - 1), 1 << nodes[0][0].bit_length())
    lines = [line(middle(a.nodes[i], place), middle(b.nodes[j], place)) for i, j in nodes]
    drawing.path(lines, stroke="text", width=1.4 * place[2])
    drawing.dots([middle(body.nodes[node], place) for body in pair for node in level], 3.4 * place[2])


def runs(lanes):
    """The first and the last of lanes that follow each other."""
    start = [lane for lane in lanes if lane - 1 not in lanes]
    return zip(start, [lane for lane in lanes if lane + 1 not in lanes])


def group_top(top, group):
    return top + group * (LANES * ROW + GAP)


def draw_strip(drawing, timeline, left, top):
    """The lanes of all groups over time, and an arrow below them. Returns the height below the arrow."""
    right = left + SCALE * timeline.end
    span = lambda start, end, first, last: rectangle((left + SCALE * start, first, left + SCALE * end, last))
    tops = [group_top(top, group) for group in range(GROUPS)]
    drawing.path([span(0, timeline.end, first, first + LANES * ROW) for first in tops], "idle")
    for kind in ("read", "test"):
        parts = []
        for group, lanes, start, end, what in timeline.bars:
            if what == kind:
                rows = [(tops[group] + ROW * i, tops[group] + ROW * (j + 1)) for i, j in runs(lanes)]
                parts += [span(start, end, *row) for row in rows]
        drawing.path(parts, kind)
    bottom = tops[-1] + LANES * ROW
    for kind, colour in (("launch", "ground"), ("balance", "balance"), ("host", "host")):
        parts = [span(start, end, top, bottom) for start, end, what in timeline.pauses if what == kind]
        if parts:
            drawing.path(parts, colour)
    y = bottom + 13
    drawing.path(
        [line((left, y), (right, y)), line((right - 6, y - 4), (right, y), (right - 6, y + 4))],
        stroke="quiet",
        width=1.2,
    )
    drawing.text(right + 5, y + 4, "time", fill="quiet")
    return y + 9


def percent(timeline):
    return f"{100 * timeline.work:.0f}\u00a0%"
