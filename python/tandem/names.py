# SPDX-License-Identifier: MIT
"""The names of methods and scenes that people read: in comparisons, reports, plots and pages. Needs only the
standard library.

names.json has the titles of methods, and the default parameters of scenes, which names leave out; scripts/schema
writes it."""

import functools
import json
import pathlib
import re
import sys

COUNTED = ("bodies", "worlds", "slices", "layers", "segments")
LEFT_OUT = ("frames",)  # how many there are: names of cells have the range that was measured


@functools.cache
def _written():
    return json.loads((pathlib.Path(__file__).parent / "names.json").read_text(encoding="utf-8"))


def method(algorithm, preset):
    """ "grouped schedule" for algorithm chunked with preset grouped; unknown ones have the names of both."""
    titles = _written()["methods"].get(algorithm, {})
    return titles.get(preset) or " ".join(filter(None, (algorithm, preset)))


def in_order(methods):
    """Names of methods in one order for all pages, unknown ones last. Each occurs once."""
    known = [title for titles in _written()["methods"].values() for title in titles.values()]
    return sorted(dict.fromkeys(methods), key=lambda name: known.index(name) if name in known else len(known))


def _parameters(rest):
    """{name: value} of "name=value,name=value"; None for other texts."""
    parts = rest.split(",") if rest else []
    is_known = all(re.match(r"\w+=", part) for part in parts)
    return dict(part.split("=", 1) for part in parts) if is_known else None


def _number(value):
    return f"{int(value):,}" if re.fullmatch("[0-9]{1,18}", value) else value


def _words(name, value):
    """ "20 slices" or "angle 0.5"."""
    if name in COUNTED:
        return f"{_number(value)} {name}"
    return f"{name.replace('_', ' ')} {_number(value)}"


def _bodies(count, mesh):
    """ "2,000 jacks", or "3 bodies of b.msh" for a mesh file."""
    if not mesh.isalpha():
        return f"{_number(count)} bodies of {pathlib.PurePath(mesh).name}"
    return f"{_number(count)} {mesh}{'' if count == '1' else 'es' if mesh.endswith('s') else 's'}"


def _pile(own):
    bodies = _bodies(own.pop("bodies"), own.pop("mesh"))
    worlds = own.pop("worlds")
    return f"{bodies if worlds == '1' else f'{_number(worlds)} worlds of {bodies}'}, density {own.pop('density')}"


def scene(key):
    """ "2,000 jacks, density 0.2" for the key "pile:bodies=2000,mesh=jack,density=0.2,seed=1". A recording has the
    name of its scene. Texts that are no keys stay as they are."""
    recorded, is_recording, of = key.partition(",of=")
    if is_recording and recorded.startswith("recording:"):
        name, _, own = recorded.removeprefix("recording:").partition(",")[0], None, scene(of)
        return own if own.startswith(name) else f"{name}, a recording of {own}"
    name, _, rest = key.rpartition(":") if ":" in key else (key, "", "")
    given = _parameters(rest)
    if given is None:
        return key
    usual = _written()["scenes"].get(name, {})
    own = {**usual, **given}
    title = _pile(own) if name == "pile" else name
    more = [
        _words(*item) for item in own.items() if item[0] not in LEFT_OUT and usual.get(item[0]) != item[1]
    ]
    return ", ".join([title, *more])


def written(algorithms, scenes):
    """What names.json has, from what `tandem algorithms --json` and `tandem scenes --json` print. Parameters of
    simulations are left out."""
    return {
        "methods": {
            one["name"]: {preset["name"]: preset["title"] for preset in one["presets"]} for one in algorithms
        },
        "scenes": {
            one["name"]: {name: parameter["default"] for name, parameter in one["parameters"].items()}
            for one in scenes
        },
    }


if __name__ == "__main__":
    print(
        json.dumps(written(*[json.loads(pathlib.Path(name).read_text()) for name in sys.argv[1:]]), indent=1)
    )
