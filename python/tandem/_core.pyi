# SPDX-License-Identifier: MIT
# By nanobind's stubgen from python/core; tests/collider.py compares its names with the module's.
"""The library tandem for Python; tandem.Collider is what to use."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy
from numpy.typing import NDArray


class DeviceError(RuntimeError):
    """
    A device failed or cannot do what was asked: one line that says which, and what was being done.
    """

class OutOfMemory(DeviceError):
    """
    Memory of a device does not suffice: what was asked for and what there is. The device works on.
    """

def devices() -> list[dict[str, object]]:
    """
    Every device there is, under the names of `tandem devices --json`: id (what Collider takes), backend, name, driver, compiler, compute_units, memory_bytes, local_bytes, double (whether it has that type), hardware (PCI address or UUID; None where unknown). A backend without devices has no entry; asking a Collider for one of them says why.
    """

class Mesh:
    """
    Vertices and tetrahedra, checked: every index is in range, every coordinate finite.

    vertices: (n, 3) float64, in the unit of the scene. tetrahedra: (m, 4) uint32, rows of vertices; they keep their order, and answers number them by it. Both are read-only views of the mesh's own memory. inverted and degenerate count tetrahedra of negative and of zero volume, which are kept.
    """

    @property
    def vertices(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, 3), writable=False)]: ...

    @property
    def tetrahedra(self) -> Annotated[NDArray[numpy.uint32], dict(shape=(None, 4), writable=False)]: ...

    @property
    def name(self) -> str: ...

    @property
    def inverted(self) -> int: ...

    @property
    def degenerate(self) -> int: ...

def make_mesh(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], tetrahedra: Annotated[NDArray[numpy.uint32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], name: str) -> Mesh:
    """What tandem.make_mesh, which checks its input, hands it to."""

def read_mesh(path: str) -> Mesh:
    """
    Reads a tetrahedral mesh; content and suffix tell the format: Gmsh .msh 2.2 and 4.1, Medit .mesh, TetGen .node/.ele, legacy .vtk and .vtu. Raises ValueError with FILE:LINE.
    """

class Scene:
    """
    Meshes, bodies and their motion, to be given to a Collider frame by frame. meshes: a list of Mesh; bodies: the mesh of each body; deformable: numbers of the bodies whose vertices come with every frame; frame_count, and key: name and parameters.
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
        Of a frame, numbered from 0: (bodies, 7) float64, rows tx ty tz qw qx qy qz.
        """

    def vertices(self, frame: int) -> dict:
        """Of a frame's deformable bodies: {body: (n, 3) float64}, in the world."""

def make_scene(specification: str) -> Scene:
    """
    A scene as the program takes it: NAME, NAME:par=value,par=value, the path of a scene description (.json) or of a recording (.frames). Raises ValueError.
    """

class Answer:
    """What a run of Collider found; tandem.Answer hands on what it says."""

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

    def digest(self) -> tuple: ...

    def contact_digest(self) -> tuple: ...

    def pairs(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None, 4))]: ...

    def contacts(self) -> tuple: ...

    def pairs_on_device(self) -> Annotated[Any, dict(dtype='int32', shape=(None, 4))]: ...

def algorithms() -> list[str]:
    """Names that Collider takes as its algorithm, beside auto."""

class Collider:
    """What tandem.Collider, which checks its input, hands it to."""

    def __init__(self, meshes: Sequence[Mesh], bodies: Sequence[int], deformable: Sequence[bool], algorithm: str, preset: str, device: str, settings: Mapping[str, str], stream: int | None, owner: object | None) -> None: ...

    def run(self, poses: object | None, vertices: object | None) -> Answer | None:
        """
        Of arrays, vertices in a list of one for each deformable body or in {number: array}. None where they are in anything else.
        """

    def run_there(self, poses: object | None, vertices: list) -> Answer:
        """
        The same as if all were in memory of the device, where arrays of the host are for device host; an entry for each body.
        """

    def tune(self, poses: object | None, vertices: object | None, seconds: float) -> list | None: ...

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
    def addresses(self) -> list[int]:
        """
        Where kernels read the last frame that was in memory of the device: poses, 0 for none, then vertices of each deformable body.
        """
