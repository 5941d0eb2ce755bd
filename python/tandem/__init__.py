# SPDX-License-Identifier: MIT
"""tandem for Python: collides tetrahedral meshes on any device, and reads records of measurements as pandas
frames.

    collider = tandem.Collider(["a.msh", "b.msh"], device="host")
    answer = collider.run([[0, 0, 0, 1, 0, 0, 0], [1, 0, 0, 1, 0, 0, 0]])  # of each body: tx ty tz qw qx qy qz
    print(answer.meeting(), answer.contacts().depths)

What to call for which task; help(tandem.Collider), for example, has the arguments, shapes and units:

Meshes and scenes
    tandem.read_mesh            reads a mesh file
    tandem.make_mesh            makes a mesh of arrays, which several colliders can share
    tandem.make_scene           makes a scene of tandem by its name, or from a file
    tandem.write_frames         writes frames of a simulation of yours as a scene, for `tandem run`
    tandem.Mesh                 a mesh, and what was found in it, such as duplicates
    tandem.Scene                meshes, and the poses and vertices of every frame

Collisions
    tandem.devices              lists the devices of this machine
    tandem.algorithms           lists the names for algorithm=
    tandem.Collider             bodies on a device, ready for any number of frames
    tandem.Collider.run         collides a frame
    tandem.Collider.update      collides a frame in which some bodies have moved
    tandem.Collider.enqueue     collides a frame without waiting for the device
    tandem.Collider.tune        selects the fastest algorithm on a frame of yours (algorithm="auto")
    tandem.Trial                one candidate of tune(), with its time

Answers of a frame
    tandem.Answer               what run() and update() return
    tandem.Answer.pairs         candidate pairs: tetrahedra whose bounds overlap
    tandem.Answer.meeting       the pairs that do meet, by an exact decision
    tandem.Answer.contacts      points, normals and depths
    tandem.Answer.distances     distances and closest points (contact_rule="distance")
    tandem.Answer.surfaces      contact surfaces of pressure fields (contact_rule="pressure")
    tandem.Answer.wrenches      forces and torques of these surfaces (output="wrenches")
    tandem.Answer.digest        a fingerprint of the pairs, equal on every device
    tandem.Contacts             what contacts() returns
    tandem.Distances            what distances() returns
    tandem.Surfaces             what surfaces() returns
    tandem.Wrenches             what wrenches() returns
    tandem.Digest               what digest() returns
    tandem.Queued               what enqueue() returns

Records
    tandem.read                 reads files of `tandem run`
    tandem.Records              their tables: cells, samples, stages, kernels, frames and errors
    tandem.Records.of           the records of some cells
    tandem.Records.verdict      which cell is the fastest, and how sure that is
    tandem.compare              compares two files: which cells have changed
    tandem.Comparison           what compare() returns
    tandem.plot_cells           draws the times of all cells of a scene
    tandem.plot_stages          draws what a frame is made of
    tandem.plot_frames          draws times, pairs or contacts over the frames
    tandem.plot_sweep           draws times over the values of a setting
    tandem.plot_errors          draws times over errors against the exact truth

Errors
    tandem.DeviceError          a device failed, or cannot do what was asked of it
    tandem.OutOfMemory          the memory of a device is too small
    tandem.RecordError          a file has no valid records

Records need neither a compiler nor a device. All else needs the compiled part of the package.
"""

import importlib
import importlib.util
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._core import DeviceError, Mesh, OutOfMemory, Scene, algorithms, devices
    from .answers import Answer, Contacts, Digest, Distances, Queued, Surfaces, Wrenches
    from .collider import Collider, Trial
    from .comparison import Comparison, compare
    from .lines import RecordError
    from .frames import write_frames
    from .meshes import make_mesh, make_scene, read_mesh
    from .plots import plot_cells, plot_errors, plot_frames, plot_stages, plot_sweep
    from .records import Records, read

# Each module is loaded at the first use of one of its names.
_MODULES = {
    "_core": ("DeviceError", "Mesh", "OutOfMemory", "Scene", "algorithms", "devices"),
    "answers": ("Answer", "Contacts", "Digest", "Distances", "Queued", "Surfaces", "Wrenches"),
    "collider": ("Collider", "Trial"),
    "comparison": ("Comparison", "compare"),
    "frames": ("write_frames",),
    "lines": ("RecordError",),
    "meshes": ("make_mesh", "make_scene", "read_mesh"),
    "plots": ("plot_cells", "plot_errors", "plot_frames", "plot_stages", "plot_sweep"),
    "records": ("Records", "read"),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}

_NEED_COMPILED = ("_core", "answers", "collider", "frames", "meshes")
_COMPILED = importlib.util.find_spec(f"{__name__}._core") is not None

__all__ = sorted(name for name, module in _MODULE_OF.items() if _COMPILED or module not in _NEED_COMPILED)
__version__ = "0.2.0"


def __getattr__(name):
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = _MODULE_OF[name]
    if module in _NEED_COMPILED and not _COMPILED:
        raise ImportError(
            f"tandem.{name} needs the compiled part of the package, which this installation does not have; "
            "run `pip install .` in tandem's checkout on a machine with a compiler (python/README.md)"
        )
    value = getattr(importlib.import_module(f".{module}", __name__), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted({*globals(), *_MODULE_OF})
