# SPDX-License-Identifier: MIT
"""Finds candidate pairs and contacts of tetrahedral meshes, frame by frame, on any device of tandem."""

from __future__ import annotations

from typing import Any, Iterable, Mapping, NamedTuple, Sequence

import numpy

from . import _core
from .answers import Answer, Contacts, Digest, Distances, Queued
from .arguments import (
    body_pairs_of,
    filters_of,
    flags_of,
    list_of,
    lists_of,
    meshes_of_bodies,
    number_of,
    text_of,
)
from .arrays import stream_address
from .changes import changes_of
from .meshes import mesh_of, tell_missing_fields
from .telling import warn
from .worlds import Numbering


class Trial(NamedTuple):
    """A timed candidate of algorithm="auto"."""

    algorithm: str
    changes: dict[str, str]  #: settings that differ from its preset
    seconds: float  #: median time of a frame


def _check_names(names):
    for what, text in names.items():
        if not isinstance(text, str):
            raise TypeError(f"{what}: type {type(text).__name__}; expected a name")


def _setting_texts(settings, self_collision):
    """The texts of settings, of which self_collision is another name of one."""
    if self_collision is not False:
        if "self" in settings:
            raise ValueError("self_collision and setting self are the same; give one of them")
        settings = settings | {"self": "on" if self_collision is True else self_collision}
    return {name: text_of(value, name) for name, value in settings.items()}


class Collider:
    """Bodies of tetrahedral meshes on a device: uploaded, compiled and ready for any number of frames.

    meshes: a list. Each element is a tandem.Mesh, the path of a mesh file, (vertices, tetrahedra): (n, 3)
    float64 and (m, 4) integers, an object
        with points and cells_dict (meshio.Mesh, pyvista.UnstructuredGrid), or the bytes of a mesh file. They
        are copied. All have the same unit of length.
    algorithm: one of tandem.algorithms(), or "auto": the fastest algorithm and settings on the first frame,
    or on the frame of tune(). Only
        settings that do not change the answer are tried.
    device: "host", "opencl:0", "cuda:0" as tandem.devices() lists them, or several that share a frame:
    "cuda:0+cuda:1". bodies: the number of each body's mesh, from 0; by default each mesh is one body.
    deformable: True, or the numbers of the bodies whose vertices change with every frame. body_groups: a list
    of groups, 0 to 31, for each body; by default [0]. (Setting groups of gproximity counts work-groups.)
    meets: a list of groups that it meets for each body, or None for all. Two bodies meet only if each meets a
    group of the other. never_meet: pairs of bodies that never meet, in either order; (n, n): body n never
    meets itself. self_collision: True: also pairs of tetrahedra of one body that share no vertex;
    "deformable": only in deformable bodies. The same as
        setting self.
    duplicates, weld, pressure: those of tandem.make_mesh, for all meshes. None: a tandem.Mesh keeps its own,
    and others have "merge", no welding and the pressure field of their source, if any. What a
        mesh has of duplicates and coincident vertices is told once, as a UserWarning.
    worlds: N: the bodies exist N times, in N independent states that one call collides; bodies of two worlds
    never meet. All options above are those
        of one world. Poses are then (N, bodies, 7) or (N, bodies, 4, 4), vertices (N, n, 3) for each
        deformable body, body_pairs rows of (world, body, body), and keys of update() pairs (world, body).
        Rows of answers begin with the number of the world. In messages of poses, row world * bodies + body is
        meant.
    stream: a CUDA stream of the device on which the collider enqueues its commands, in order with those of
    the application. Either
        cupy.cuda.get_current_stream() or torch.cuda.current_stream(), which the collider keeps alive, or the
        address of a stream that must outlive the collider. None: the collider makes its own stream.
    preset, settings: the same as --preset and --set of the program (`tandem algorithms NAME` lists them):
    k=8, precision="double",
        output="count". Defaults are the program's, but for contacts: contact_rule="sat" and decision="usual",
        which are to be relied on and cost more. Presets that reproduce other programs ("paper", "published",
        "unc2010") keep their "opposing". motion="linear" finds pairs between a frame and its successor
        (run()); contacts, if any, are those of the frame itself.

    Raises ValueError or TypeError for invalid arguments, tandem.DeviceError if a device fails; messages are
    one line. A UserWarning tells where nothing can meet, such as one body without self_collision. Calls
    release the interpreter's lock. Calls of one collider and of its answers wait for each other. Ctrl-C ends
    run(), update() and tune() before their next launch on the device, by a KeyboardInterrupt, as does any
    exception of another signal's handler; the collider remains usable.
    """

    # The slash makes `self` positional, because a setting has this name as well.
    def __init__(
        self,
        meshes: Sequence[Any],
        /,
        algorithm: str = "tiled",
        device: str = "host",
        *,
        bodies: Iterable[int] | None = None,
        deformable: bool | Iterable[int] = False,
        body_groups: Sequence[Iterable[int]] | None = None,
        meets: Sequence[Iterable[int] | None] | None = None,
        never_meet: Iterable[Sequence[int]] = (),
        self_collision: bool | str = False,
        duplicates: str | None = None,
        weld: float | None = None,
        pressure: float | None = None,
        worlds: int | None = None,
        preset: str = "",
        stream: Any = None,
        **settings: Any,
    ) -> None:
        all_meshes = [
            mesh_of(mesh, f"meshes[{i}]", duplicates, weld, pressure)
            for i, mesh in enumerate(list_of(meshes, "meshes"))
        ]
        mesh_of_body = meshes_of_bodies(bodies, len(all_meshes))
        flags = flags_of(deformable, len(mesh_of_body))
        self._bodies = len(flags)
        self._deformable = [body for body, flag in enumerate(flags) if flag]
        self._numbering = numbering = Numbering(self._bodies, worlds, self._deformable)
        named = {"algorithm": algorithm, "device": device, "preset": preset}
        _check_names(named)
        texts = _setting_texts(settings, self_collision)
        filters = filters_of(body_groups, meets, len(flags))
        apart = body_pairs_of(never_meet, "never_meet", len(flags))
        address = None if stream is None else stream_address(stream)
        count = numbering.count
        of_bodies = (mesh_of_body * count, flags * count, algorithm, preset, device, texts, filters * count)
        options = _core.ColliderOptions(*of_bodies, numbering.in_all_worlds(apart), count, address)
        self._core = _core.Collider(all_meshes, options, stream)
        if self._core.nothing_meets:
            warn(f"nothing can meet: {self._core.nothing_meets}")
        if texts.get("contact_rule") == "pressure":
            tell_missing_fields([all_meshes[number] for number in mesh_of_body])
        self._arguments = named | {
            "bodies": mesh_of_body,
            "deformable": self._deformable,
            "body_groups": lists_of(body_groups),
            "meets": lists_of(meets),
            "never_meet": apart,
            "duplicates": duplicates,
            "weld": weld,
            "pressure": pressure,
            "worlds": numbering.worlds,
            **texts,
        }

    def run(
        self,
        poses: Any = None,
        vertices: Any = None,
        *,
        next_poses: Any = None,
        next_vertices: Any = None,
        body_pairs: Iterable[Sequence[int]] | None = None,
    ) -> Answer:
        """Finds the candidate pairs and contacts of a frame.

        poses: (bodies, 7) numbers, rows tx ty tz qw qx qy qz: x_world = R(q) x_mesh + t, in the meshes' unit;
        q is normalised. The real part is
            first: an order xyzw, as of SciPy's as_quat(), is another rotation and no error, because its
            length is 1 too. Or, in host memory, (bodies, 4, 4) matrices of a rotation and, in the last
            column, a translation. None: the identity for all bodies. Rows of deformable bodies are ignored.
        vertices: world coordinates of deformable bodies: a list with one (n, 3) array for each of them, in
        their order, or {body: array}.
            None: the vertices of their meshes.
        next_poses, next_vertices: the frame's successor, which motion="linear" needs: at least one of them,
        in the forms of poses and vertices.
            Candidate pairs are then those that could meet while the bodies move from the frame to its
            successor: vertices of deformable bodies on straight lines, rigid bodies with straight translation
            and the shorter rotation at constant speed. Contacts are those of the frame. What is left out has
            the same default as in the frame, the identity or the vertices of the mesh, not the frame's own
            poses or vertices.
        body_pairs: pairs of bodies to walk, in either order, instead of those that may overlap: from a broad
        phase of the caller. The collider's
            body_groups, meets and never_meet do not apply to them. (n, n) needs self_collision.

        Arrays in host memory are NumPy arrays or objects with __dlpack__. Contiguous float64 arrays are
        uploaded without another copy. Arrays on the collider's GPU (CuPy, PyTorch, JAX; __dlpack__ or
        __cuda_array_interface__) are contiguous float64 or float32. Kernels read them in place, after the
        work that their library has enqueued and before this call returns. Both kinds may be mixed and give
        the same answer, bit for bit. With arrays on the GPU, body pairs are found on the device, whatever
        setting broad is. Raises ValueError or TypeError for wrong shapes, types and numbers that are not
        finite, tandem.DeviceError otherwise."""
        pairs = self._pairs_to_walk(body_pairs)
        return Answer(
            self._run(self._core.run, poses, vertices, next_poses, next_vertices, pairs), self._numbering
        )

    def enqueue(
        self,
        poses: Any = None,
        vertices: Any = None,
        *,
        next_poses: Any = None,
        next_vertices: Any = None,
        body_pairs: Iterable[Sequence[int]] | None = None,
        stream: Any = None,
    ) -> Queued:
        """Enqueues a frame, and returns before the device has come to it. The arguments are those of run().

        Its commands run in the order of `stream`: a CUDA stream as in Collider(stream=...); None: the stream on
        which the library of the arrays works now, if it tells it. So work that is enqueued there later may read
        the answer, and write the arrays again.

        Buffers keep their sizes: those of settings pair_capacity, contact_capacity and body_pair_capacity, or
        those to which an earlier run() has grown them. A frame that does not fit is flagged, as is one with
        numbers on the device that are not finite (Queued.counts).

        The first call, and the first after a run() that has grown buffers, prepares, which may wait. Later
        calls whose arrays are all on the collider's GPU can be captured in a CUDA graph (torch.cuda.graph,
        CuPy's Stream.begin_capture), which then reads the same arrays in every replay; the captured frame has
        the grids for as much work as the frame before it. Raises ValueError where the host takes part in a
        frame: several devices, decision="exact", gproximity, the paper's data path."""
        pairs = self._pairs_to_walk(body_pairs)
        address = None if stream is None else stream_address(stream)
        core = self._run(self._core.enqueue, poses, vertices, next_poses, next_vertices, (pairs, address))
        return Queued(core, self._numbering)

    def update(
        self,
        poses: Mapping[int, Any] | None = None,
        vertices: Mapping[int, Any] | None = None,
        *,
        next_poses: Mapping[int, Any] | None = None,
        next_vertices: Mapping[int, Any] | None = None,
        body_pairs: Iterable[Sequence[int]] | None = None,
    ) -> Answer:
        """Finds the candidate pairs and contacts of the last frame with some bodies changed: the others keep
        the poses and vertices of the last run(), update() or tune(), of which the first was of all bodies.
        The answer is that of run() for the whole frame, and the device does the same work; the caller
        converts and passes less.

        poses: {body: row of 7 numbers or 4 x 4 matrix}, of bodies that are not deformable. vertices: {body:
        (n, 3)}, of deformable bodies. next_poses, next_vertices: with motion="linear", changes from this
        frame to its successor; at least one of them, of which {} changes nothing. body_pairs: as in run().

        Arrays are in host memory, also those of the last frame. Raises ValueError or TypeError as run() does,
        and before the first frame; a refused call leaves the last frame unchanged, except for a refused
        successor."""
        frame = changes_of(poses, vertices, "", self._numbering)
        following = None
        if next_poses is not None or next_vertices is not None:
            following = changes_of(next_poses, next_vertices, "next_", self._numbering)
        return Answer(self._core.update(frame, following, self._pairs_to_walk(body_pairs)), self._numbering)

    def tune(
        self,
        poses: Any = None,
        vertices: Any = None,
        seconds: float = 2.0,
        *,
        next_poses: Any = None,
        next_vertices: Any = None,
    ) -> list[Trial]:
        """With algorithm="auto": times the candidates on a frame for about `seconds` of frames, and selects
        the fastest for later runs. Compilation may take six times as long. The arrays are those of run().
        Afterwards `algorithm` and `settings` are those selected. Returns the timed candidates, the fastest
        first. If tune() is not called, the first run() selects. Raises ValueError if the collider has another
        algorithm, or all candidates fail."""

        def tune(poses, vertices, next_poses, next_vertices):
            return self._core.tune(poses, vertices, seconds, next_poses, next_vertices)

        trials = self._run(tune, poses, vertices, next_poses, next_vertices)
        return [Trial(*trial) for trial in trials]

    def pairs(
        self,
        poses: Any = None,
        vertices: Any = None,
        on_device: bool = False,
        *,
        next_poses: Any = None,
        next_vertices: Any = None,
    ) -> Any:
        """run(...).pairs(on_device): (n, 4) int32, sorted."""
        return self.run(poses, vertices, next_poses=next_poses, next_vertices=next_vertices).pairs(on_device)

    def contacts(
        self, poses: Any = None, vertices: Any = None, *, next_poses: Any = None, next_vertices: Any = None
    ) -> Contacts:
        """run(...).contacts()."""
        return self.run(poses, vertices, next_poses=next_poses, next_vertices=next_vertices).contacts()

    def distances(self, poses: Any = None, vertices: Any = None) -> Distances:
        """run(...).distances()."""
        return self.run(poses, vertices).distances()

    def meeting(
        self, poses: Any = None, vertices: Any = None, *, next_poses: Any = None, next_vertices: Any = None
    ) -> numpy.ndarray:
        """run(...).meeting(): (n, 4) int32, sorted. With motion="linear" too, these are the pairs that meet
        in the frame itself."""
        return self.run(poses, vertices, next_poses=next_poses, next_vertices=next_vertices).meeting()

    def count(
        self, poses: Any = None, vertices: Any = None, *, next_poses: Any = None, next_vertices: Any = None
    ) -> int:
        """run(...).count: the number of candidate pairs. With output="count" the pairs are not stored."""
        return self.run(poses, vertices, next_poses=next_poses, next_vertices=next_vertices).count

    def digest(
        self, poses: Any = None, vertices: Any = None, *, next_poses: Any = None, next_vertices: Any = None
    ) -> Digest:
        """run(...).digest()."""
        return self.run(poses, vertices, next_poses=next_poses, next_vertices=next_vertices).digest()

    def reset(self) -> None:
        """Discards the state that is carried from frame to frame. The next frame sets the origin of coordinates on
        the device: call it when bodies are far from where they were in the first frame."""
        self._core.reset()

    @property
    def algorithm(self) -> str:
        """Name of the algorithm; "auto" until one is selected."""
        return self._core.algorithm

    @property
    def settings(self) -> dict[str, str]:
        """All settings in use, after the device's adjustments; empty until an algorithm is selected."""
        return self._core.settings

    @property
    def devices(self) -> list[str]:
        """Ids of the devices that share each frame."""
        return self._core.devices

    @property
    def arguments(self) -> dict[str, Any]:
        """Keyword arguments that make an equal collider of the same meshes, without `stream`:
        Collider(meshes, **arguments). They and tandem.Mesh can be pickled, a collider cannot."""
        return dict(self._arguments)

    def __reduce__(self) -> Any:
        raise TypeError(
            "a collider owns memory of devices and cannot be pickled or copied; pickle its meshes and `arguments`"
        )

    def __repr__(self) -> str:
        worlds = "" if self._numbering.worlds is None else f"{self._numbering.worlds} worlds of "
        return (
            f"<tandem.Collider: {worlds}{self._bodies} bodies, {self.algorithm} on {'+'.join(self.devices)}>"
        )

    def _pairs_to_walk(self, body_pairs):
        """Ascending pairs of numbers a <= b; None: none are given."""
        if body_pairs is None:
            return None
        return sorted({(min(pair), max(pair)) for pair in self._numbering.pairs_of(body_pairs, "body_pairs")})

    def _run(self, call, poses, vertices, next_poses, next_vertices, *more):
        """`call` with the arrays of run(). The core takes the common containers itself and returns None for
        others."""
        numbering = self._numbering
        if numbering.worlds is None:
            result = call(poses, vertices, next_poses, next_vertices, *more)
            if result is not None:
                return result
        return call(
            numbering.poses_of(poses, "poses"),
            numbering.vertices_of(self._by_body(vertices, "vertices"), "vertices"),
            numbering.poses_of(next_poses, "next_poses"),
            numbering.vertices_of(self._by_body(next_vertices, "next_vertices"), "next_vertices"),
            *more,
        )

    def _by_body(self, vertices, what):
        """{number: array} from any mapping or sequence of arrays; None: none. `what`: the name of the argument."""
        if vertices is None:
            return None
        if not isinstance(vertices, Mapping):
            rows = list_of(vertices, what)
        if not self._deformable:
            raise ValueError(
                f"{what}: no body is deformable; make the collider with deformable=True or numbers of bodies"
            )
        if not isinstance(vertices, Mapping):
            if len(rows) != len(self._deformable):
                raise ValueError(
                    f"{what}: {len(rows)} arrays for {len(self._deformable)} deformable bodies; give one array for each"
                )
            vertices = dict(zip(self._deformable, rows))
        by_number = {number_of(body, what, "body"): rows for body, rows in vertices.items()}
        for body in by_number:
            if body not in self._deformable:
                raise ValueError(
                    f"{what}: {body} is not a deformable body (those are: {', '.join(map(str, self._deformable))})"
                )
        return by_number
