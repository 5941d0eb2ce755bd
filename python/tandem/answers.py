# SPDX-License-Identifier: MIT
"""What a collider found in a frame: pairs, contacts and their digests."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy

from . import _core
from .worlds import Numbering


class Digest(NamedTuple):
    """Order-free digest of a set, equal on every device: its count and two wrapping 64-bit sums of a mix of
    its elements."""

    count: int
    a: int
    b: int


class Contacts(NamedTuple):
    """Contacts of a frame, sorted by pair and feature. The columns are views of one array of records."""

    pairs: numpy.ndarray  #: (n, 4) int32: body a, tetrahedron a, body b, tetrahedron b; a before b. With worlds (n, 5), the world first
    features: numpy.ndarray  #: (n,) uint32: number of the contact within its pair (algorithms/narrow_phase)
    points: numpy.ndarray  #: (n, 3) float64: world coordinates, in the meshes' unit
    normals: numpy.ndarray  #: (n, 3) float64: unit vectors that point out of body a
    depths: numpy.ndarray  #: (n,) float64: in the meshes' unit, < 0 inside


class Distances(NamedTuple):
    """Distances of a frame, sorted by pair: of contact_rule="distance", one row for each pair of boundary
    tetrahedra within the margin. A pair that meets has a negative distance, the depth of the least translation that
    parts it; its points are those that touch after it."""

    pairs: numpy.ndarray  #: (n, 4) int32, as of Contacts
    features: numpy.ndarray  #: (n,) uint32: bits 0..3 and 4..7: the corners of a and of b that span the point's corner, edge or face
    points_a: numpy.ndarray  #: (n, 3) float64: of tetrahedron a, closest to b, in world coordinates
    points_b: numpy.ndarray  #: (n, 3) float64: of tetrahedron b; points_a + distances * normals
    normals: numpy.ndarray  #: (n, 3) float64: unit vectors from a to b
    distances: numpy.ndarray  #: (n,) float64: in the meshes' unit, < 0 for pairs that meet


class Surfaces(NamedTuple):
    """Contact surfaces of a frame, sorted by pair: of contact_rule="pressure", one polygon for each pair of
    tetrahedra on which their pressures are equal."""

    pairs: numpy.ndarray  #: (n, 4) int32, as of Contacts
    centroids: numpy.ndarray  #: (n, 3) float64: world coordinates, in the meshes' unit
    normals: (
        numpy.ndarray
    )  #: (n, 3) float64: unit vectors along the gradient of a's pressure minus that of b's, into body a
    areas: numpy.ndarray  #: (n,) float64
    pressures: (
        numpy.ndarray
    )  #: (n,) float64: at the centroids; areas * pressures * normals are forces on body a
    corners: numpy.ndarray | None = (
        None  #: (m, 3) float64: the corners of all polygons, one polygon after the other
    )
    corner_pressures: numpy.ndarray | None = None  #: (m,) float64
    ends: numpy.ndarray | None = (
        None  #: (n,) uint64: corners of polygon i end before ends[i], where those of i + 1 begin
    )


class Wrenches(NamedTuple):
    """Sums of the polygons of each body pair, sorted by bodies: of output="wrenches"."""

    bodies: numpy.ndarray  #: (n, 2) int32: body a, body b. With worlds (n, 3), the world first
    forces: numpy.ndarray  #: (n, 3) float64: on body a, in units of pressure times area; b has the opposite
    torques: (
        numpy.ndarray
    )  #: (n, 3) float64: on body a about its position; of a deformable body about Answer.origin
    areas: numpy.ndarray  #: (n,) float64
    polygons: numpy.ndarray  #: (n,) uint32: their number


class Answer:
    """Result of one run. Later runs of the collider do not change it. It keeps the collider's memory until it
    is deleted."""

    __slots__ = ("_core", "_numbering", "__weakref__")

    def __init__(self, core: _core.Answer, numbering: Numbering | None = None) -> None:
        self._core, self._numbering = core, numbering or Numbering()

    @property
    def count(self) -> int:
        """Number of candidate pairs."""
        return self._core.count

    @property
    def contact_count(self) -> int:
        """Number of contacts."""
        return self._core.contact_count

    @property
    def body_pairs(self) -> int:
        """Number of body pairs whose volumes may overlap."""
        return self._core.body_pairs

    @property
    def degenerate(self) -> int:
        """Number of pairs without contacts because a tetrahedron has no volume, or one whose sign is not certain in
        this precision."""
        return self._core.degenerate

    @property
    def seconds(self) -> float:
        """Time of the frame, from its poses to known counts, as the program measures it. Excludes the
        conversion of arguments."""
        return self._core.seconds

    @property
    def retries(self) -> int:
        """Number of walks that ran again because a buffer was too small."""
        return self._core.retries

    @property
    def batches(self) -> int:
        """Number of parts into which the frame was split for lack of memory; 1: not split."""
        return self._core.batches

    @property
    def origin(self) -> numpy.ndarray:
        """(3,) float64: the point about which the torques of deformable bodies are."""
        return numpy.array(self._core.origin)

    def digest(self) -> Digest:
        """Digest of the pairs, computed on the device without a download of the pairs."""
        return Digest(*self._core.digest())

    def contact_digest(self) -> Digest:
        """Digest of the contacts, sensitive to every bit, computed on the device."""
        return Digest(*self._core.contact_digest())

    def pairs(self, on_device: bool = False) -> Any:
        """Candidate pairs: rows body a, tetrahedron a, body b, tetrahedron b, numbered from 0 in the order of
        the input, body a < body b. In pairs of one body (self_collision), tetrahedron a < tetrahedron b.

        Returns an (n, 4) int32 NumPy array, sorted by its columns. With `worlds` it is (n, 5): the number of
        the world comes first, and bodies are numbered within it; only rows `on_device` have 4 columns there
        too, with body numbers world * bodies + body. With `on_device`, returns an object with __dlpack__ over
        (n, 4) int32 in memory of the device, in the same order, for which the first call sorts them there.
        torch.from_dlpack, cupy.from_dlpack and (device host) numpy.from_dlpack read it without a copy. Every
        call returns the same memory. The rows are complete when the call returns, so that any stream may read
        them. The memory lives as long as an array over it. These libraries do not support OpenCL memory, for
        which `on_device` raises ValueError."""
        return self._core.pairs_on_device() if on_device else self._numbering.rows_of(self._core.pairs())

    def meeting(self) -> numpy.ndarray:
        """Those of pairs() whose tetrahedra meet: rows of the same columns, sorted. Candidate pairs have
        overlapping bounds, these have a common point of the closed tetrahedra. The decision is exact for the
        vertices that the device has: moved and rounded in the collider's precision. It takes no contact rule
        and no boundary faces, so that pairs inside of bodies are found too. It runs on the host, on all
        cores. Raises ValueError with output="count" or "digest", and with placement="exact".

        For arrays that were in memory of the device, what the kernels had is read back: all vertices, 16
        bytes each or 32 in double, by this call alone. It is there until the collider's next run; afterwards
        the answer raises ValueError. The arrays themselves can be overwritten."""
        return self._numbering.rows_of(self._core.meeting())

    def contacts(self) -> Contacts:
        """Contacts of the pairs (see Contacts), in host memory. The contact rule determines which pairs have
        some: with the default, "sat", all that meet; other rules need boundary faces
        (docs/user/python.md)."""
        pairs, *columns, _ = self._core.contacts()
        return Contacts(self._numbering.rows_of(pairs), *columns)

    def distances(self) -> Distances:
        """Distances (see Distances), in host memory: with contact_rule="distance" of all pairs within the margin, with
        output="distances" the least of each body pair."""
        pairs, features, points, normals, distances, _ = self._core.distances()
        return Distances(
            self._numbering.rows_of(pairs),
            features,
            points,
            points + normals * distances[:, None],
            normals,
            distances,
        )

    def surfaces(self, corners: bool = False) -> Surfaces:
        """Contact surfaces (see Surfaces) of contact_rule="pressure", in host memory. With `corners`, the corners
        of each polygon and the pressures there: the host computes them again on all cores, with the device's
        arithmetic. For arrays that were in memory of the device this needs what meeting() needs."""
        pairs, _, centroids, normals, areas, pressures = self._core.polygons()
        rows = (self._numbering.rows_of(pairs), centroids, normals, areas, pressures)
        if not corners:
            return Surfaces(*rows)
        points, at_points, ends = self._core.surfaces()
        return Surfaces(*rows, points, at_points[:, 0], ends[:, 0])

    def wrenches(self) -> Wrenches:
        """Force, torque and area of each body pair with polygons (see Wrenches), with output="wrenches". The sums are
        made on the device, and are equal on every device."""
        pairs, polygons, forces, torques, areas, _ = self._core.wrenches()
        rows = self._numbering.rows_of(pairs)
        bodies = numpy.delete(rows, [rows.shape[1] - 3, rows.shape[1] - 1], axis=1)
        return Wrenches(bodies, forces, torques, areas, polygons)

    def __repr__(self) -> str:
        return f"<tandem.Answer: {self.count} pairs, {self.contact_count} contacts>"


class Queued:
    """A frame of Collider.enqueue(): memory of the device that its commands write, and that the next frame of
    the collider overwrites. Read it in the stream of the frame, or after a wait. It is the same memory for every
    frame until a run() grows the collider's buffers, and it lives as long as this object or an array over it:
    keep it as long as a graph that captured the frame.

    The arrays are objects with __dlpack__ (torch.from_dlpack, cupy.from_dlpack, with device host
    numpy.from_dlpack); OpenCL's memory has none, and raises ValueError."""

    __slots__ = ("_core", "_numbering", "__weakref__")

    NO_ROOM, FLAWED, EXCEEDED = 1, 2, 4  #: bits of counts[0, 0]

    def __init__(self, core: _core.Queued, numbering: Numbering | None = None) -> None:
        self._core, self._numbering = core, numbering or Numbering()

    @property
    def counts(self) -> Any:
        """(1, 6) int64: a flag (0: the answer is complete), candidate pairs, contacts and body pairs, and with
        output="digest" the sums of the digest. With a flag, counts of what depends on missing rows are too small. Bits of the flag: NO_ROOM, a buffer is too small, and rows beyond
        it are missing; FLAWED, poses or vertices on the device are out of range, such as not a number; EXCEEDED,
        an error of tandem, or a body too large for output="wrenches". run() of the same frame then finds the whole answer, or raises what is wrong."""
        return self._core.counts

    @property
    def pairs(self) -> Any:
        """(capacity, 4) int32, of which counts[0, 1] rows are used: body a, tetrahedron a, body b, tetrahedron b,
        in any order, or sorted with order="canonical". No rows with output="count" or "digest"."""
        return self._core.pairs

    @property
    def contact_ids(self) -> Any:
        """(capacity, 2) int32, of which counts[0, 2] rows are used: the row of the contact's pair in `pairs`,
        and its feature; with output="wrenches" the row of one pair of the two bodies, and the number of their polygons.
        No rows without contacts."""
        return self._core.contact_ids

    @property
    def contact_values(self) -> Any:
        """(capacity, 8) float32, float64 with precision="double": point relative to `origin`, normal out of
        body a, depth, and a column that is not used. With contact_rule="distance" the point is that of body a, and
        the distance replaces the depth. With contact_rule="pressure": centroid, normal into body a, area, pressure; with
        output="wrenches": force on body a, torque about its position, area, 0."""
        return self._core.contact_values

    @property
    def origin(self) -> numpy.ndarray:
        """(3,) float64: what to add to the points of contacts for world coordinates."""
        return numpy.array(self._core.origin)

    def collect(self) -> Answer | None:
        """Waits for the frame, and returns its answer over the same memory. None if the flag is set. The next
        enqueue() overwrites the answer: then this and the answer's methods raise ValueError. Its `seconds` are 0."""
        core = self._core.collect()
        return None if core is None else Answer(core, self._numbering)

    def __repr__(self) -> str:
        return "<tandem.Queued>"
