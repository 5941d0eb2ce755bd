# SPDX-License-Identifier: MIT
"""What the lanes of a small GPU do while each method walks two bodies. The schedules are those of the kernels in
algorithms/; only times are simplified. A lane needs one unit of time to test two boxes, and READ units for each box
that it reads from memory. Lanes of a group go in step, so that a group waits for its lane with most tests."""

import dataclasses
import functools

from .bodies import LEAVES, overlap, size, union

GROUPS, LANES = 4, 32
IDLE_LIMIT = 2 * GROUPS // 3  # groups without work that end a launch of gProximity
READ = 4
LAUNCH = 9  # from the end of one kernel to the start of the next
HOST = 18  # until the host has read a number and starts the next kernel


@dataclasses.dataclass
class Timeline:
    """bars: (group, lanes, start, end, kind); kind is read or test. pauses: (start, end, kind) of the whole device;
    kind is launch, balance or host. found: pairs of triangles. queues: lengths of gProximity's queues at each end and
    start of a launch. clocks: times of the groups. tests: their number."""

    bars: list = dataclasses.field(default_factory=list)
    pauses: list = dataclasses.field(default_factory=list)
    found: set = dataclasses.field(default_factory=set)
    queues: list = dataclasses.field(default_factory=list)
    clocks: list = dataclasses.field(default_factory=lambda: [0] * GROUPS)
    tests: int = 0

    def read(self, group, lanes, boxes):
        """Each of the lanes reads a number of boxes."""
        self._add(group, lanes, READ * boxes, "read")

    def test(self, group, counts):
        """Each lane makes its tests. counts: their numbers by lane."""
        done = 0
        for count in sorted(set(counts.values())):
            self._add(group, [lane for lane in counts if counts[lane] >= count], count - done, "test")
            done = count
        self.tests += sum(counts.values())

    def _add(self, group, lanes, length, kind):
        start = self.clocks[group]
        self.clocks[group] += length
        self.bars.append((group, sorted(lanes), start, start + length, kind))

    def pause(self, *parts):
        """All groups end, and wait for what comes between two launches: (length, kind), one after the other."""
        now = self.end
        for length, kind in parts:
            self.pauses.append((now, now + length, kind))
            now += length
        self.clocks = [now] * GROUPS

    @property
    def end(self):
        return max(self.clocks)

    @property
    def work(self):
        """The share of all lanes' time in which they read or test."""
        spent = sum(len(lanes) * (end - start) for _, lanes, start, end, _ in self.bars)
        return spent / (self.end * GROUPS * LANES)


def children(node):
    """A leaf is its own only child."""
    return (2 * node, 2 * node + 1) if node < LEAVES else (node,)


def left_of(timeline, a, b, pairs):
    """Tests node pairs, and returns those still to be walked. Two leaves that overlap are found."""
    hits = [(i, j) for i, j in pairs if overlap(a.nodes[i], b.nodes[j])]
    timeline.found |= {(i - LEAVES, j - LEAVES) for i, j in hits if min(i, j) >= LEAVES}
    return [(i, j) for i, j in hits if min(i, j) < LEAVES]


def below_both(_a, _b, nodes):
    return [(i, j) for i in children(nodes[0]) for j in children(nodes[1])]


def below_larger(a, b, nodes):
    """The children of the larger node with the other one."""
    i, j = nodes
    is_a = j >= LEAVES or (i < LEAVES and size(a.nodes[i]) > size(b.nodes[j]))
    return [(child, j) for child in children(i)] if is_a else [(i, child) for child in children(j)]


def below_unlike(a, b, nodes):
    """As below_larger() if one node is more than four times as wide as the other, otherwise as below_both()."""
    sizes = sorted((size(a.nodes[nodes[0]]), size(b.nodes[nodes[1]])))
    return (below_larger if sizes[1] > 16 * sizes[0] else below_both)(a, b, nodes)


def boxes_of(pairs):
    """The number of different boxes that a lane reads to test node pairs."""
    return sum(len(set(side)) for side in zip(*pairs))


def step(timeline, group, pairs_of):
    """Lanes of a group test node pairs. pairs_of: by lane."""
    timeline.read(group, pairs_of, max(map(boxes_of, pairs_of.values())))
    timeline.test(group, {lane: len(pairs) for lane, pairs in pairs_of.items()})


def seeds(chunks):
    """All pairs of chunk roots, in the order of their numbers."""
    return [(chunks + i, chunks + j) for i in range(chunks) for j in range(chunks)]


def walk_items(a, b, chunks):
    """The paper's schedule: each lane walks seeds that are a stride apart, each to its end."""
    timeline, every = Timeline(), seeds(chunks)
    for group in range(GROUPS):
        waiting = [every[group * LANES + lane :: GROUPS * LANES] for lane in range(LANES)]
        stacks = [[] for _ in range(LANES)]
        while any(waiting) or any(stacks):
            now = {}
            for lane in range(LANES):
                if stacks[lane]:
                    now[lane] = below_both(a, b, stacks[lane].pop())
                elif waiting[lane]:
                    now[lane] = [waiting[lane].pop(0)]
                stacks[lane] += left_of(timeline, a, b, now.get(lane, []))
            step(timeline, group, now)
    return timeline


def walk_groups(a, b, chunks):
    """The grouped schedule: a group tests the roots of its batch of seeds, and then shares one stack."""
    timeline, every = Timeline(), seeds(chunks)
    batch = len(every) // GROUPS
    for group in range(GROUPS):
        own, stack = every[group * batch : (group + 1) * batch], []
        while own or stack:
            if own:
                now, own = [[seed] for seed in own[:LANES]], own[LANES:]
            else:
                now, stack = [below_unlike(a, b, nodes) for nodes in stack[-LANES:]], stack[:-LANES]
            stack += [nodes for pairs in now for nodes in left_of(timeline, a, b, pairs)]
            step(timeline, group, dict(enumerate(now)))
    return timeline


def query(timeline, a, b, leaf):
    """The steps of one leaf of a through the tree of b: lists of node pairs."""
    stack = [[(leaf, 1)]]
    while stack:
        now = stack.pop()
        yield now
        stack += [below_larger(a, b, nodes) for nodes in reversed(left_of(timeline, a, b, now))]


def walk_leaves(a, b):
    """Leaf queries: each lane walks the tree of b with a leaf of a, whose box it keeps."""
    timeline = Timeline()
    for group in range(GROUPS):
        queries = {lane: query(timeline, a, b, LEAVES + group * LANES + lane) for lane in range(LANES)}
        while now := {lane: pairs for lane, one in queries.items() if (pairs := next(one, None))}:
            timeline.read(group, now, max(map(len, now.values())))
            timeline.test(group, {lane: len(pairs) for lane, pairs in now.items()})
    return timeline


def walk_queues(a, b):
    """gProximity: each group has a queue of node pairs. A launch ends when too many groups have none left. Then the
    queues are balanced, and the host reads how many node pairs are left."""
    timeline, queues = Timeline(), [[(1, 1)], *([] for _ in range(GROUPS - 1))]
    while any(queues):
        timeline.queues.append([*map(len, queues)])
        walking = [group for group in range(GROUPS) if queues[group]]
        while walking:
            for group in walking:
                now, queues[group] = queues[group][-LANES:], queues[group][:-LANES]
                step(timeline, group, {lane: [nodes] for lane, nodes in enumerate(now)})
                for nodes in left_of(timeline, a, b, now):
                    queues[group] += below_larger(a, b, nodes)
            walking = [group for group in walking if queues[group]]
            if GROUPS - len(walking) >= IDLE_LIMIT:
                break
        timeline.queues.append([*map(len, queues)])
        timeline.pause((2 * LAUNCH, "balance"), (HOST, "host"))
        left = iter(sum(queues, []))
        share, more = divmod(sum(timeline.queues[-1]), GROUPS)
        queues = [[next(left) for _ in range(share + (group < more))] for group in range(GROUPS)]
    return timeline


def kept(boxes, other):
    """The numbers of the boxes that are not apart from the box of the other tile."""
    whole = functools.reduce(union, other)
    return [i for i, box in enumerate(boxes) if overlap(box, whole)]


def test_tiles(timeline, group, boxes_a, boxes_b):
    """Each lane tests its two boxes with the other tile. Those left of one tile are rows, and each lane whose other box is
    left tests it with all rows. Returns the hits."""
    rows, lanes = sorted((kept(boxes_a, boxes_b), kept(boxes_b, boxes_a)), key=len)
    timeline.read(group, range(len(boxes_a)), 2)
    timeline.test(group, dict.fromkeys(range(len(boxes_a)), 2))
    timeline.test(group, dict.fromkeys(lanes, len(rows)))
    return [(i, j) for i, box in enumerate(boxes_a) for j, other in enumerate(boxes_b) if overlap(box, other)]


def walk_tiles(a, b):
    """Tiled: one launch tests the boxes of tiles, and the next one, for pairs of tiles that overlap, the boxes in them."""
    timeline, count = Timeline(), LEAVES // LANES
    roots = [body.nodes[count : 2 * count] for body in (a, b)]
    pairs = test_tiles(timeline, 0, *roots)
    timeline.pause((LAUNCH, "launch"))
    for turn, (i, j) in enumerate(pairs):
        hits = test_tiles(timeline, turn % GROUPS, a.boxes_below(count + i), b.boxes_below(count + j))
        timeline.found |= {(LANES * i + m, LANES * j + n) for m, n in hits}
    return timeline
