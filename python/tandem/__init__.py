# SPDX-License-Identifier: MIT
"""tandem for Python: collisions of tetrahedral meshes on any device, and records of the laboratory as pandas frames.

    import tandem
    collider = tandem.Collider(["a.msh", "b.msh"], algorithm="tiled", device="host", k=18)
    pairs = collider.pairs([[0, 0, 0, 1, 0, 0, 0], [1, 0, 0, 1, 0, 0, 0]])   # (n, 4): body, tetrahedron, body, tetrahedron

    records = tandem.read("run.jsonl")
    records.cells[["algorithm", "set_k", "ms", "ms_low", "ms_high"]]
    tandem.compare("old.jsonl", "new.jsonl")
    tandem.plot_cells(records)

What collides needs the compiled part and numpy; what reads records needs neither compiler nor device, but pandas. Each is
loaded when it is first asked for.
"""
import importlib
import importlib.util
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._core import DeviceError, Mesh, OutOfMemory, Scene, algorithms, devices, make_scene
    from .collider import Answer, Collider, Contacts, Digest, Trial, make_mesh, read_mesh
    from .comparison import Comparison, compare
    from .lines import RecordError
    from .plots import plot_cells, plot_errors, plot_frames, plot_stages, plot_sweep
    from .records import Records, read

_PLACES = {
    "_core": ("DeviceError", "Mesh", "OutOfMemory", "Scene", "algorithms", "devices", "make_scene"),
    "collider": ("Answer", "Collider", "Contacts", "Digest", "Trial", "make_mesh", "read_mesh"),
    "comparison": ("Comparison", "compare"),
    "lines": ("RecordError",),
    "plots": ("plot_cells", "plot_errors", "plot_frames", "plot_stages", "plot_sweep"),
    "records": ("Records", "read"),
}
_PLACE_OF = {name: place for place, names in _PLACES.items() for name in names}

_COMPILED = importlib.util.find_spec(f"{__name__}._core") is not None

__all__ = sorted(name for name, place in _PLACE_OF.items() if _COMPILED or place not in ("_core", "collider"))
__version__ = "0.1.0"


def __getattr__(name):
    if name not in _PLACE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    place = _PLACE_OF[name]
    if place in ("_core", "collider") and not _COMPILED:
        raise ImportError(f"tandem.{name} needs the compiled part of the package, which this installation was made without; "
                          "run `pip install .` in tandem's checkout on a machine with a compiler (python/README.md)")
    value = getattr(importlib.import_module(f".{place}", __name__), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted({*globals(), *_PLACE_OF})
