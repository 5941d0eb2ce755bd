# SPDX-License-Identifier: MIT
"""Candidate pairs and contacts of tetrahedral meshes, frame by frame, on any device of tandem."""
from __future__ import annotations

import os
from typing import Any, Iterable, Mapping, NamedTuple, Sequence

import numpy

from . import _core
from ._core import Mesh
from .arrays import host_array, stream_address


class Digest(NamedTuple):
    """Order-free digest of a set, equal on every device: its count and two wrapping 64-bit sums of a mix of its elements."""
    count: int
    a: int
    b: int


class Contacts(NamedTuple):
    """Contacts of a frame, sorted by pair and feature: columns of one array of records, so that no column is a copy."""
    pairs: numpy.ndarray     #: (n, 4) int32: body a, tetrahedron a, body b, tetrahedron b; body a < body b
    features: numpy.ndarray  #: (n,) uint32: which of the pair's contacts, as algorithms/narrow_phase numbers them
    points: numpy.ndarray    #: (n, 3) float64: in the world, in the meshes' unit
    normals: numpy.ndarray   #: (n, 3) float64: of length 1, out of body a
    depths: numpy.ndarray    #: (n,) float64: in the meshes' unit, < 0 inside


class Trial(NamedTuple):
    """A candidate of algorithm="auto" that was timed."""
    algorithm: str
    changes: dict[str, str]  #: settings that are not as its preset has them
    seconds: float           #: a frame, the median


class Answer:
    """What one run found. It stays what it is when the collider runs again, and keeps the collider's memory until it is gone."""
    __slots__ = ("_core", "__weakref__")

    def __init__(self, core: _core.Answer) -> None:
        self._core = core

    @property
    def count(self) -> int:
        """Candidate pairs."""
        return self._core.count

    @property
    def contact_count(self) -> int:
        """Contacts."""
        return self._core.contact_count

    @property
    def body_pairs(self) -> int:
        """Pairs of bodies whose volumes may overlap."""
        return self._core.body_pairs

    @property
    def degenerate(self) -> int:
        """Pairs without contacts because a tetrahedron has no volume."""
        return self._core.degenerate

    @property
    def seconds(self) -> float:
        """What the frame took, from its poses to known counts, without the call's own part: what the program measures."""
        return self._core.seconds

    @property
    def retries(self) -> int:
        """How often a buffer was too small and a walk ran again."""
        return self._core.retries

    @property
    def batches(self) -> int:
        """Parts that the frame was split into for want of memory; 1: none."""
        return self._core.batches

    def digest(self) -> Digest:
        """Of the pairs, summed on the device: no pair is brought to the host."""
        return Digest(*self._core.digest())

    def contact_digest(self) -> Digest:
        """Of the contacts, to the last bit, summed on the device."""
        return Digest(*self._core.contact_digest())

    def pairs(self, on_device: bool = False) -> Any:
        """Candidate pairs: rows body a, tetrahedron a, body b, tetrahedron b, numbered from 0 in the order of the input, body a < body b.

        An (n, 4) int32 array of NumPy, sorted by its columns. With `on_device` an object with __dlpack__ over (n, 4) int32 in the memory
        of the device that found them, in no order: torch.from_dlpack, cupy.from_dlpack and (device host) numpy.from_dlpack take it without a
        copy, and every call gives the same memory. The rows are complete when the call returns, so that they may be read on any stream. The
        memory lives as long as an array over it does. OpenCL's memory is taken by none of these: ValueError."""
        return self._core.pairs_on_device() if on_device else self._core.pairs()

    def contacts(self) -> Contacts:
        """Contacts of the pairs (see Contacts), brought to the host."""
        return Contacts(*self._core.contacts())

    def __repr__(self) -> str:
        return f"<tandem.Answer: {self.count} pairs, {self.contact_count} contacts>"


class Collider:
    """Bodies of tetrahedral meshes on a device: uploaded, compiled and ready for frame after frame.

    meshes: a list of what each is a tandem.Mesh, the path of a mesh file, or (vertices, tetrahedra): (n, 3) float64 and (m, 4) integers.
        They are copied, and share one unit, whichever.
    algorithm: one of tandem.algorithms(), or "auto": whichever of them, with whichever settings that change no answer, is fastest on the first
        frame, or on the one given to tune().
    device: "host", "opencl:0", "cuda:0" as tandem.devices() lists them, or several that share a frame, "cuda:0+cuda:1".
    bodies: the mesh of each body, numbered from 0; by default each mesh is one body.
    deformable: True, or numbers of bodies, whose vertices come with every frame.
    stream: a CUDA stream of the device, by which the collider's commands go, in order with the application's: cupy.cuda.get_current_stream(),
        torch.cuda.current_stream(), which are kept as long as the collider, or an address, whose stream must live as long. None: one of its own.
    preset, settings: as --preset and --set of the program, with its defaults (`tandem algorithms NAME` lists them): k=8, precision="double",
        output="count".

    Raises ValueError or TypeError for what cannot be, tandem.DeviceError where a device fails: one line each. Calls release the
    interpreter's lock; those of one collider, and of its answers, wait for each other.
    """

    # `self` is the name of a setting as well, which positions alone leave free.
    def __init__(self, meshes: Sequence[Any], /, algorithm: str = "tiled", device: str = "host", *, bodies: Iterable[int] | None = None,
                 deformable: bool | Iterable[int] = False, preset: str = "", stream: Any = None, **settings: Any) -> None:
        made = [_mesh(mesh, f"meshes[{i}]") for i, mesh in enumerate(_list(meshes, "meshes"))]
        of = list(range(len(made))) if bodies is None else [_number(value, f"bodies[{i}]") for i, value in enumerate(_list(bodies, "bodies"))]
        flags = _flags(deformable, len(of))
        self._soft = [body for body, flag in enumerate(flags) if flag]
        for what, text in (("algorithm", algorithm), ("device", device), ("preset", preset)):
            if not isinstance(text, str):
                raise TypeError(f"{what}: type {type(text).__name__}, and a name is wanted")
        texts = {name: _text(value, name) for name, value in settings.items()}
        address = None if stream is None else stream_address(stream)
        self._core = _core.Collider(made, of, flags, algorithm, preset, device, texts, address, stream)

    def run(self, poses: Any = None, vertices: Any = None) -> Answer:
        """Finds the candidate pairs and contacts of a frame.

        poses: (bodies, 7) numbers, rows tx ty tz qw qx qy qz: x_world = R(q) x_mesh + t, in the meshes' unit; q is made a unit quaternion. None: all
            at the identity. Rows of deformable bodies are not looked at.
        vertices: for deformable bodies, in the world: a list with one (n, 3) array for each of them, in their order, or {body: array}. None: those
            of their meshes.

        Arrays of the host's memory are NumPy's or anything that has __dlpack__; float64 with its rows beside each other is read where it is, and goes
        to the device from there. Arrays on the collider's GPU (CuPy, PyTorch, JAX; __dlpack__ or __cuda_array_interface__), float64 or float32
        with rows beside each other, are read there by the device's kernels, without a copy: after what their library has enqueued for them, and
        before this returns. Both kinds may be mixed, and give the same answer to the bit; with the latter body pairs are found on the device,
        whatever broad says. Raises ValueError or TypeError for wrong shapes, types and numbers that are not finite, tandem.DeviceError
        otherwise."""
        answer = self._core.run(poses, vertices)
        return Answer(self._core.run(poses, self._by_body(vertices)) if answer is None else answer)

    def tune(self, poses: Any = None, vertices: Any = None, seconds: float = 2.0) -> list[Trial]:
        """Of algorithm="auto": times its candidates on that frame, given as to run(), for about `seconds` of frames (compiling them may take six
        times as long), and keeps the fastest, which `algorithm` and `settings` then name. Returns those timed, the fastest first. Without it the
        first run() does so. Raises ValueError where an algorithm was named, or every candidate fails."""
        trials = self._core.tune(poses, vertices, seconds)
        if trials is None:
            trials = self._core.tune(poses, self._by_body(vertices), seconds)
        return [Trial(*trial) for trial in trials]

    def pairs(self, poses: Any = None, vertices: Any = None, on_device: bool = False) -> Any:
        """run(poses, vertices).pairs(on_device): (n, 4) int32, sorted."""
        return self.run(poses, vertices).pairs(on_device)

    def contacts(self, poses: Any = None, vertices: Any = None) -> Contacts:
        """run(poses, vertices).contacts()."""
        return self.run(poses, vertices).contacts()

    def count(self, poses: Any = None, vertices: Any = None) -> int:
        """run(poses, vertices).count: how many candidate pairs; with output="count" none is kept."""
        return self.run(poses, vertices).count

    def digest(self, poses: Any = None, vertices: Any = None) -> Digest:
        """run(poses, vertices).digest()."""
        return self.run(poses, vertices).digest()

    def reset(self) -> None:
        """Forgets what was carried from frame to frame."""
        self._core.reset()

    @property
    def algorithm(self) -> str:
        """Its name; "auto" until one is chosen."""
        return self._core.algorithm

    @property
    def settings(self) -> dict[str, str]:
        """Every setting as the device took it; none until an algorithm is chosen."""
        return self._core.settings

    @property
    def devices(self) -> list[str]:
        """The ids of the devices that share each frame."""
        return self._core.devices

    def _by_body(self, vertices):
        """{number: array}, from whatever may stand for it."""
        if not isinstance(vertices, Mapping):
            rows = _list(vertices, "vertices")
        if not self._soft:
            raise ValueError("vertices: no body is deformable; make the collider with deformable=True or numbers of bodies")
        if not isinstance(vertices, Mapping):
            if len(rows) != len(self._soft):
                raise ValueError(f"vertices: {len(rows)} arrays for {len(self._soft)} deformable bodies; give each its array")
            vertices = dict(zip(self._soft, rows))
        for body in vertices:
            if body not in self._soft:
                raise ValueError(f"vertices: {body!r} is no deformable body (there are: {', '.join(map(str, self._soft))})")
        return {int(body): rows for body, rows in vertices.items()}


def _list(value, what):
    if isinstance(value, (str, bytes, os.PathLike, Mesh)):
        raise TypeError(f"{what}: type {type(value).__name__}, and a list is wanted")
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"{what}: type {type(value).__name__}, and a list is wanted") from None


def _mesh(mesh, what):
    if isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, (str, os.PathLike)):
        return _core.read_mesh(os.fspath(mesh))
    if isinstance(mesh, tuple) and len(mesh) == 2:
        return make_mesh(*mesh, name=what)
    raise TypeError(f"{what}: type {type(mesh).__name__}, and a tandem.Mesh, a path or (vertices, tetrahedra) is wanted")


def make_mesh(vertices: Any, tetrahedra: Any, name: str = "mesh") -> Mesh:
    """A Mesh of vertices, (n, 3) numbers, and tetrahedra, (m, 4) integers from 0; both are copied. Raises ValueError or TypeError, one line that
    begins with `name`."""
    return _core.make_mesh(host_array(vertices, f"{name}: vertices", 3), host_array(tetrahedra, f"{name}: tetrahedra", 4, numpy.uint32), name)


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """Reads a tetrahedral mesh; content and suffix tell the format: Gmsh .msh 2.2 and 4.1, Medit .mesh, TetGen .node/.ele, legacy .vtk and
    .vtu. Raises ValueError with FILE:LINE."""
    return _core.read_mesh(os.fspath(path))


def _number(value, what):
    try:
        number = value.__index__()
    except AttributeError:
        raise TypeError(f"{what}: type {type(value).__name__}, and the number of a mesh is wanted") from None
    if not 0 <= number < 2**32:
        raise ValueError(f"{what}: {number} is no number of a mesh; they go from 0")
    return number


def _flags(deformable, bodies):
    if isinstance(deformable, (bool, numpy.bool_)):
        return [bool(deformable)] * bodies
    flags = [False] * bodies
    for i, value in enumerate(_list(deformable, "deformable")):
        number = _number(value, f"deformable[{i}]")
        if number >= bodies:
            raise ValueError(f"deformable[{i}]: {number} is no body; there are {bodies}, numbered from 0")
        flags[number] = True
    return flags


def _text(value, name):
    if isinstance(value, (bool, numpy.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (str, int, numpy.integer)):
        return str(value)
    raise TypeError(f"setting {name}: type {type(value).__name__}, and a word or an integer is wanted")
