# SPDX-License-Identifier: MIT
# Written by nanobind's stubgen from python/core. tests/collider/package.py compares its names with those of the module.
"""The library tandem for Python. Use tandem.Collider."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy
from numpy.typing import NDArray


class DeviceError(RuntimeError):
    """
    A device failed or does not support the request. The message is one line: the device and the operation.
    """

class OutOfMemory(DeviceError):
    """
    A device has too little memory: the message gives the requested and the available bytes. The device remains usable.
    """

def devices() -> list[dict[str, object]]:
    """
    All devices, with the fields of `tandem devices --json`: id (the argument `device` of Collider), backend, name, driver, compiler, compute_units, memory_bytes, local_bytes, double (whether it has that type), hardware (PCI address or UUID; None if unknown). A backend without devices has no entry; a Collider on one of its devices raises an error with the reason.
    """

def refuse_beyond_memory(what: str, bytes: float) -> None:
    """
    Raises ValueError if `what` needs more bytes than this process can still allocate.
    """

class MeshReading:
    """How a mesh is read and connected: the arguments of tandem.read_mesh."""

    def __init__(self, duplicates: str, weld: float | None, pressure: float | None, corners: bool = False, only_tetrahedra: bool = False) -> None: ...

class Mesh:
    """
    Checked vertices and tetrahedra: every index is in range, every coordinate is finite.

    vertices: (n, 3) float64, in the unit of the scene. tetrahedra: (m, 4) uint32, indices of vertices; answers number tetrahedra in this order. Both are read-only views of the mesh's own memory. pressures: (n,) float64, the pressure at each vertex, or None without a field. inverted and degenerate count tetrahedra of negative and of zero volume; the mesh keeps them. duplicates and weld are those of make_mesh; pressure is the modulus that made the field, or None. merged lists duplicates of earlier tetrahedra, which are in no answer; welded has for each vertex the first of those that are one with it, or is empty; findings is one line about both and about coincident vertices, or empty.
    """

    @property
    def vertices(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def tetrahedra(self) -> Annotated[NDArray[numpy.uint32], dict(shape=(None, 4), writable=False)]: ...

    @property
    def pressures(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)] | None: ...

    @property
    def name(self) -> str: ...

    @property
    def inverted(self) -> int: ...

    @property
    def degenerate(self) -> int: ...

    @property
    def merged(self) -> list[int]: ...

    @property
    def welded(self) -> Annotated[NDArray[numpy.uint32], dict(shape=(None,), writable=False)]: ...

    @property
    def duplicates(self) -> str: ...

    @property
    def weld(self) -> float | None: ...

    @property
    def pressure(self) -> float | None: ...

    @property
    def findings(self) -> str: ...

def make_mesh(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], tetrahedra: Annotated[NDArray[numpy.uint32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], pressures: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)] | None, name: str, reading: MeshReading) -> Mesh:
    """Implementation of tandem.make_mesh, which checks its input."""

def connected(mesh: Mesh, reading: MeshReading) -> Mesh:
    """A copy of a mesh that is connected by another reading."""

def parse_mesh(data: bytes, name: str, reading: MeshReading) -> Mesh:
    """
    Makes a mesh of the bytes of a file of read_mesh, except of TetGen's pairs. Raises ValueError.
    """

def read_mesh(path: str, reading: MeshReading) -> Mesh:
    """
    Reads a tetrahedral mesh. Content and suffix determine the format: Gmsh .msh 1, 2.2, 4.0 and 4.1, Medit .mesh, TetGen .node/.ele, legacy .vtk and .vtu. Raises ValueError with FILE:LINE.
    """

class Scene:
    """
    Meshes, bodies and their motion, for a Collider to run frame by frame. meshes: a list of Mesh; bodies: the number of each body's mesh; deformable: numbers of the bodies with new vertices in every frame; frame_count: number of frames; key: name and parameters.
    """

    @property
    def key(self) -> str: ...

    @property
    def frame_count(self) -> int: ...

    @property
    def meshes(self) -> list[Mesh]: ...

    @property
    def bodies(self) -> list[int]: ...

    @property
    def deformable(self) -> list[int]: ...

    def poses(self, frame: int) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 7))]:
        """
        Poses of a frame, numbered from 0: (bodies, 7) float64, rows tx ty tz qw qx qy qz.
        """

    def vertices(self, frame: int) -> dict:
        """
        Vertices of a frame's deformable bodies: {body: (n, 3) float64}, in world coordinates.
        """

def make_scene(specification: str, reading: MeshReading) -> Scene:
    """Implementation of tandem.make_scene, which checks its input."""

class Answer:
    """Result of a run of Collider; tandem.Answer wraps it."""

    @property
    def count(self) -> int: ...

    @property
    def contact_count(self) -> int: ...

    @property
    def body_pairs(self) -> int: ...

    @property
    def degenerate(self) -> int: ...

    @property
    def seconds(self) -> float: ...

    @property
    def retries(self) -> int: ...

    @property
    def batches(self) -> int: ...

    @property
    def origin(self) -> list[float]: ...

    def digest(self) -> tuple: ...

    def contact_digest(self) -> tuple: ...

    def pairs(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None, 4))]: ...

    def meeting(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None, 4))]: ...

    def contacts(self) -> tuple: ...

    def distances(self) -> tuple: ...

    def polygons(self) -> tuple: ...

    def surfaces(self) -> tuple: ...

    def wrenches(self) -> tuple: ...

    def pairs_on_device(self) -> Annotated[Any, dict(dtype='int32', shape=(None, 4))]: ...

class Queued:
    """A frame of Collider.enqueue; tandem.Queued wraps it."""

    def collect(self) -> Answer | None:
        """The answer, after a wait; None if it is not complete."""

    @property
    def pairs(self) -> object: ...

    @property
    def contact_ids(self) -> object: ...

    @property
    def contact_values(self) -> object: ...

    @property
    def counts(self) -> object: ...

    @property
    def origin(self) -> list[float]: ...

def algorithms() -> list[str]:
    """Names of the algorithms that Collider accepts besides auto."""

class ColliderOptions:
    """
    bodies, deformable, groups: one entry per body of all worlds, of groups the bits of its groups and of those it meets. stream: an address.
    """

    def __init__(self, bodies: Sequence[int], deformable: Sequence[bool], algorithm: str, preset: str, device: str, settings: Mapping[str, str], groups: Sequence[tuple[int, int]], never_meet: Sequence[tuple[int, int]], worlds: int, stream: int | None) -> None: ...

class Collider:
    """Implementation of tandem.Collider, which checks its input."""

    def __init__(self, meshes: Sequence[Mesh], options: ColliderOptions, owner: object | None) -> None: ...

    def run(self, poses: object | None, vertices: object | None, next_poses: object | None, next_vertices: object | None, body_pairs: list[tuple[int, int]] | None) -> Answer | None:
        """
        Runs a frame. vertices, next_vertices: a list with one array per deformable body, or {number: array}. Returns None for any other container.
        """

    def enqueue(self, poses: object | None, vertices: object | None, next_poses: object | None, next_vertices: object | None, options: tuple[list[tuple[int, int]] | None, int | None]) -> Queued | None:
        """
        As run(), without a wait. options: body pairs, and the address of the stream in whose order it runs.
        """

    def update(self, frame: tuple[Sequence[int], object | None, object | None], next: tuple[Sequence[int], object | None, object | None] | None, body_pairs: Sequence[tuple[int, int]] | None) -> Answer:
        """
        Runs the last frame with changes: numbers of bodies, an array of their poses or None, and {number: vertices} or None. next: changes from that frame to its successor.
        """

    def run_device_input(self, poses: object | None, vertices: list, next_poses: object | None = None, next_vertices: list | None = None) -> Answer:
        """
        Runs a frame whose arrays are all in memory of the device; for device host, in host memory. vertices and next_vertices have one entry per body.
        """

    def tune(self, poses: object | None, vertices: object | None, seconds: float, next_poses: object | None, next_vertices: object | None) -> list | None: ...

    def reset(self) -> None: ...

    @property
    def algorithm(self) -> str: ...

    @property
    def settings(self) -> dict[str, str]: ...

    @property
    def devices(self) -> list[str]: ...

    @property
    def queue(self) -> int: ...

    @property
    def nothing_meets(self) -> str:
        """Why nothing can meet in any frame, or an empty text."""

    @property
    def addresses(self) -> list[int]:
        """
        Addresses from which kernels read the last frame that was in memory of the device: poses (0 for none), then vertices of each deformable body. Those of its successor follow.
        """
