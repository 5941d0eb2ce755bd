# SPDX-License-Identifier: MIT
"""A drawing of each method: the bodies with its hierarchy, and below them the lanes of a GPU over time."""

from . import parts, walks
from .bodies import LEAVES, overlap
from .canvas import Drawing, rectangle
from .parts import LEFT, RIGHT, SCALE

CHUNKS = 16
LANES = "Four work-groups of 32 lanes are drawn over time, with the work of each lane."


def overlapping(pair, count):
    """The pairs of nodes that overlap, on the level with so many nodes."""
    a, b = pair
    return [(i, j) for i, j in walks.seeds(count) if overlap(a.nodes[i], b.nodes[j])]


def gproximity(pair):
    about = f"Two bodies of triangles, each with one binary tree. {LANES} Between launches the queues are balanced, and the host reads how many node pairs are left."
    timeline = walks.walk_queues(*pair)
    drawing = Drawing("gproximity", "gProximity", about)
    drawing.subtitle("One tree per body; groups take node pairs from their queues.")
    parts.draw_tree(drawing, "a", [1], (66, 108))
    parts.draw_bodies(drawing, pair, (0, 112, 1))
    parts.name_bodies(drawing, (0, 112, 1))
    parts.draw_tree(drawing, "b", [1], (392, 350))
    top = 434
    drawing.text(LEFT, top - 12, "Lanes of four groups; numbers are the lengths of queues.")
    bottom = parts.draw_strip(drawing, timeline, LEFT, top)
    draw_queues(drawing, timeline, top)
    drawing.key(bottom + 22, *parts.KEY)
    drawing.key(bottom + 44, ("balance", "balances queues"), ("host", "host reads what is left"))
    launches = len(timeline.queues) // 2
    drawing.subtitle(
        f"{launches} launches; lanes have work for {parts.percent(timeline)} of the time.", bottom + 66
    )
    return drawing.svg(bottom + 80)


def draw_queues(drawing, timeline, top):
    """The lengths of queues after each launch, and those at the start of the next one."""
    of = {
        what: [(start + end) / 2 for start, end, kind in timeline.pauses if kind == what]
        for what in ("balance", "host")
    }
    columns = [("ground", *one) for one in zip(of["balance"], timeline.queues[1::2])]
    columns += [("ink", *one) for one in zip(of["host"], timeline.queues[2::2])]
    for colour, time, lengths in columns:
        for group, length in enumerate(lengths):
            x, y = LEFT + SCALE * time, parts.group_top(top, group) + 29
            drawing.text(x, y, str(length), "number", colour, anchor="middle")


def chunked(pair):
    about = f"Two bodies of triangles in chunks, each with a small tree. Lines are seeds whose chunks overlap. {LANES} With the paper's schedule a few lanes walk long while the others have no work. With the grouped schedule the lanes of a group share the work, and end sooner."
    drawing = Drawing("chunked", "Paper's schedule and grouped schedule", about)
    seeds = overlapping(pair, CHUNKS)
    drawing.subtitle(
        f"{CHUNKS} chunks per body make {CHUNKS**2} seeds; lines: the {len(seeds)} that overlap."
    )
    roots, place = range(CHUNKS, 2 * CHUNKS), (0, 90, 1)
    parts.draw_tree(drawing, "a", roots, (66, 88))
    odd = {which: parts.checkered(body, roots) for which, body in zip("ab", pair)}
    parts.draw_bodies(drawing, pair, place, lambda which, leaf: leaf in odd[which])
    parts.draw_pairs(drawing, pair, seeds, place)
    parts.name_bodies(drawing, place)
    parts.draw_tree(drawing, "b", roots, (350, 328))
    top = 408
    paper, grouped = walks.walk_items(*pair, CHUNKS), walks.walk_groups(*pair, CHUNKS)
    right = RIGHT - 36 - SCALE * grouped.end
    drawing.text(LEFT, top - 30, "Paper's schedule")
    drawing.subtitle("a lane walks its own seeds to the end", top - 12)
    drawing.text(right, top - 30, "Grouped")
    drawing.subtitle("shared stack", top - 12, x=right)
    parts.draw_strip(drawing, paper, LEFT, top)
    bottom = parts.draw_strip(drawing, grouped, right, top)
    drawing.key(bottom + 22, *parts.KEY)
    drawing.subtitle(
        f"Lanes have work for {parts.percent(paper)} and {parts.percent(grouped)} of the time.", bottom + 44
    )
    return drawing.svg(bottom + 58)


def tiled(pair):
    about = f"Two bodies of triangles in tiles of 32. Lines are pairs of tiles that overlap. {LANES} The first launch tests tiles, the second one the boxes in pairs of tiles. A matrix of 32 by 32 has the tests of one pair of tiles."
    timeline = walks.walk_tiles(*pair)
    drawing = Drawing("tiled", "Tiled", about)
    count = LEAVES // walks.LANES
    pairs, tops, place = overlapping(pair, count), range(count, 2 * count), (0, 64, 1)
    drawing.subtitle(
        f"{count} tiles of {walks.LANES} boxes per body; lines: the {len(pairs)} pairs of tiles that overlap."
    )
    odd = {which: parts.checkered(body, tops) for which, body in zip("ab", pair)}
    parts.draw_bodies(drawing, pair, place, lambda which, leaf: leaf in odd[which])
    for which, body in zip("ab", pair):
        drawing.path(
            [rectangle(parts.moved_box(body.nodes[node], place)) for node in tops], stroke=which, width=1.5
        )
    parts.draw_pairs(drawing, pair, pairs, place)
    parts.name_bodies(drawing, place)
    top = 352
    drawing.text(LEFT, top - 30, "Two launches")
    drawing.subtitle("no stack, no queue", top - 12)
    bottom = parts.draw_strip(drawing, timeline, LEFT, top)
    tiles = max(pairs, key=lambda one: len(hits(pair, one)))
    draw_matrix(drawing, pair, tiles, (RIGHT - 32 * 6.5, top, 6.5))
    drawing.key(bottom + 22, *parts.KEY)
    drawing.key(bottom + 44, ("text", "boxes overlap"), ("idle", "left out: apart from the other tile"))
    drawing.subtitle(f"Lanes have work for {parts.percent(timeline)} of the time.", bottom + 66)
    return drawing.svg(bottom + 80)


def hits(pair, nodes):
    boxes = [body.boxes_below(node) for body, node in zip(pair, nodes)]
    return [
        (i, j) for i, one in enumerate(boxes[0]) for j, other in enumerate(boxes[1]) if overlap(one, other)
    ]


def draw_matrix(drawing, pair, nodes, place):
    """The tests of the boxes in two tiles. place: left and upper end, and the side of a field."""
    x, y, side = place
    boxes = [body.boxes_below(node) for body, node in zip(pair, nodes)]
    field = lambda i, j: rectangle((x + side * j, y + side * i, x + side * (j + 1), y + side * (i + 1)))
    drawing.text(x, y - 30, "One pair of tiles")
    drawing.subtitle("32 boxes of a by 32 of b", y - 12, x=x)
    drawing.path([rectangle((x, y, x + 32 * side, y + 32 * side))], "idle")
    drawing.path([field(i, j) for i in walks.kept(*boxes) for j in walks.kept(*reversed(boxes))], "test")
    drawing.path([field(i, j) for i, j in hits(pair, nodes)], "text")


def leaf_query(pair):
    about = f"Two bodies of triangles. The box of one triangle of a walks the tree of b, and the nodes that it tests are marked. {LANES} A group waits for its longest query."
    a, b = pair
    timeline = walks.walk_leaves(a, b)
    drawing = Drawing("leaf_query", "Leaf queries", about)
    drawing.subtitle("Each box of a walks the tree of b; one of them is marked.")
    steps = {leaf: [*walks.query(walks.Timeline(), a, b, leaf)] for leaf in range(LEAVES, 2 * LEAVES)}
    leaf = max(steps, key=lambda one: len(steps[one]))
    box, place = a.nodes[leaf], (0, 64, 1)
    is_met = lambda which, i: LEAVES + i == leaf if which == "a" else overlap(box, b.nodes[LEAVES + i])
    parts.draw_bodies(drawing, pair, place, is_met)
    drawing.path([rectangle(parts.moved_box(box, place))], stroke="text", width=2)
    parts.name_bodies(drawing, place)
    parts.draw_tree(drawing, "b", [1], (364, 302), {node for pairs in steps[leaf] for _, node in pairs})
    top = 406
    drawing.text(LEFT, top - 12, "One lane per query: a group waits for its longest one.")
    bottom = parts.draw_strip(drawing, timeline, LEFT, top)
    drawing.key(bottom + 22, *parts.KEY)
    drawing.subtitle(f"Lanes have work for {parts.percent(timeline)} of the time.", bottom + 44)
    return drawing.svg(bottom + 58)
