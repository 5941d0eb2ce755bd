# SPDX-License-Identifier: MIT
"""tandem for Python: finds collisions of tetrahedral meshes on any device, and reads records of measurements
as pandas frames.

    import tandem

    collider = tandem.Collider(["a.msh", "b.msh"], algorithm="tiled", device="host", k=18)
    pairs = collider.pairs([[0, 0, 0, 1, 0, 0, 0], [1, 0, 0, 1, 0, 0, 0]])  # (n, 4): body, tetrahedron, body, tetrahedron

    records = tandem.read("run.jsonl")
    records.cells[["algorithm", "set_k", "ms", "ms_low", "ms_high"]]
    tandem.compare("old.jsonl", "new.jsonl")
    tandem.plot_cells(records)

Collisions need the compiled part of the package and numpy. Records need pandas, but no compiler and no
device. Each module is loaded at its first use.
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
