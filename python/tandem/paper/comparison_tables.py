# SPDX-License-Identifier: MIT
"""Tables 4 and 5: the methods beside each other, resident and as published."""

import statistics

from . import composed
from .folder import SCENES, STEPS_OF_TABLES, number, paper_table
from .methods import FOUR, columns_of, found, four_of_scenes, name_of, names
from .quantities import NotMeasured, frame_range, seconds_by_round
from .ratios import ratio_of
from .tables import Table, ordered, paper_rows, written

COLUMNS = {
    "frame": "frame",
    **{column: name for name, column in columns_of(4).items() if column in ("narrow", "read", "write")},
    "launches": "launches",
    "launches_as_theirs": "release launches",
}
PARTS = tuple(name for name, column in columns_of(5).items() if column == f"{name}_s")
UNTIMED = {"make_seeds_s": "host work:make seeds", "queue_array_s": "host work:queue array"}  # by the release
ROUNDING = 0.05  # of the paper's factors
SMALL_K = "8"


def _ratio(other, own, quantity):
    try:
        return ratio_of(other, quantity, own, quantity)
    except NotMeasured:
        return None


def factors(scene, other, own, data_path):
    """A row of Table 4: times and launches of `other` over those of `own`, with the intervals of the whole
    frame and of the narrow phase."""
    found_ratios = {name: _ratio(other, own, quantity) for name, quantity in COLUMNS.items()}
    frame = found_ratios["frame"]
    row = {
        "scene": scene,
        "source": "ours",
        "device": own.device["id"],
        "data_path": data_path,
        "method": f"{name_of(other)} / {name_of(own)}",
    }
    row |= {name: measured and measured.value for name, measured in found_ratios.items()}
    return row | {
        **_ends(found_ratios),
        "samples": frame and frame.samples,
        "frames": frame and frame.frames,
        "queue_bytes": other.settings.get("queue_bytes") if data_path == "published" else None,
        "records": " ".join((own.locations[0], other.locations[0])),
    }


def _ends(ratios):
    """Columns of the ends of intervals."""
    return {
        f"{name}_{end}": ratios[name] and getattr(ratios[name], end)
        for name in ("frame", "narrow")
        for end in ("low", "high")
    }


def _resident_rows(scene, cases):
    """gProximity over each of the three other methods, and a row for each that has not been measured."""
    other = cases["gProximity"]
    rows = []
    for name in [name for name in FOUR if name != "gProximity"]:
        own = cases[name]
        if other and own:
            rows.append(factors(scene, other, own, "resident"))
        elif other or own:
            rows.append(
                {
                    "scene": scene,
                    "source": "ours",
                    "device": (other or own).device["id"],
                    "data_path": "resident",
                    "method": f"gProximity / {name}",
                    "frames": "not measured",
                }
            )
    return rows


def _published_rows(folder, scene):
    cells = names()["cells"]
    own, other = (
        found(folder, f"cells-{scene}", scene, {"k": SMALL_K, **cells[name]})
        for name in ("chunked published", "gProximity published")
    )
    if own is None:
        return []
    gpus = folder.cases(f"gpus-{scene}")
    compared = ([other] if other else []) + gpus
    rows = [factors(scene, case, own, "published") for case in compared if _ratio(case, own, "frame")]
    k40c = [case for case in gpus if case.preset == "published-k40c"]
    for case, arrays, gpu in (
        *([(other, _whole_arrays(folder), None)] if other else []),
        *((case, folder.cases("array-k40c"), "K40c") for case in k40c),
    ):
        rows += _with_array(scene, case, own, arrays, gpu)
    return rows


def _whole_arrays(folder):
    """The cases with the largest queue array of this device's launch geometry."""
    cases = [case for step in ("array", "array-again") for case in folder.cases(step)]
    sizes = [case.settings["queue_bytes"] for case in cases]
    largest = "device" if "device" in sizes else max(sizes, key=int, default=None)
    return [case for case in cases if case.settings["queue_bytes"] == largest]


def _composed(other, own, quantity, arrays):
    try:
        return composed.ratio_with_array(other, quantity, own, quantity, arrays)
    except NotMeasured:
        return None


def _with_array(scene, other, own, arrays, gpu):
    """The row of factors with the upload of the whole array, in a list, if it was measured. gpu: the one of
    the paper's whose array it is."""
    ratios = {name: _composed(other, own, COLUMNS[name], arrays) for name in ("frame", "narrow", "write")}
    frame = ratios["frame"]
    if not frame:
        return []
    return [
        factors(scene, other, own, "published")
        | {name: measured and measured.value for name, measured in ratios.items()}
        | _ends(ratios)
        | {
            "method": f"{name_of(other)}, whole array (composed) / {name_of(own)}",
            "samples": frame.samples,
            "queue_bytes": arrays[0].settings["queue_bytes"],
            **_beside_paper(scene, ratios["narrow"], gpu),
            "records": " ".join(frame.records),
        }
    ]


def _beside_paper(scene, narrow, gpu):
    """The paper's factor of the narrow phase on a GPU and ours over it, with intervals. The paper's is that
    of its rounding."""
    of_paper = [number(row["narrow"]) for row in paper_table(4) if (row["scene"], row["gpu"]) == (scene, gpu)]
    if not of_paper or not narrow:
        return {}
    low, value, high = (of_paper[0] + part for part in (-ROUNDING, 0, ROUNDING))
    return {
        "paper_narrow": value,
        "paper_low": low,
        "paper_high": high,
        "narrow_over_paper": narrow.value / value,
        "over_paper_low": narrow.low / high,
        "over_paper_high": narrow.high / low,
    }


def _composition_note(folder):
    """How near compositions are to frames that were measured whole, with the array of a K40c."""
    arrays, texts = folder.cases("array-k40c"), []
    for scene in SCENES:
        parts = [case for case in folder.cases(f"gpus-{scene}") if case.preset == "published-k40c"]
        whole = folder.cases(f"whole-{scene}")
        measured = _composed(parts[0], whole[0], "frame", arrays) if parts and whole and arrays else None
        if measured:
            texts.append(f"{scene} {written(measured.value)}")
    return (
        (f"A composed frame with a K40c's array over the same frame measured whole: {', '.join(texts)}.",)
        if texts
        else ()
    )


def table4(folder):
    rows = paper_rows(
        paper_table(4),
        {"total": "total", "narrow": "narrow", "read": "read", "write": "write", "launches": "launches"},
    )
    for row in rows:
        row |= {
            "data_path": "published",
            "method": "gProximity / chunked",
            "launches_as_theirs": row["launches"],
            "launches": None,
        }
    for scene, _, cases in four_of_scenes(folder, (SMALL_K,)):
        rows += _resident_rows(scene, cases)
    for scene in SCENES:
        rows += _published_rows(folder, scene)
    return Table(
        4,
        "gProximity over the other methods, k = 8",
        ordered(rows),
        (
            "Resident: everything stays on the device; four methods. Published: both algorithms convert, upload and read back everything in every frame. Above 1, "
            "gProximity takes longer. frame has whole frames, narrow the narrow phase as the release times it, both with 95 % intervals. Both methods of a row have the "
            "same frames of one recording.",
            "Rows with a K40c's launch geometry and whole array have the paper's factor for the K40c beside them, with the interval of its rounding, and ours over it.",
            "gProximity published also uploads its queue array for every batch; queue_bytes has its size. Records without setting sizes have a K40c's "
            "launch geometry and batches of 30 body pairs. Composed rows add the measured upload of the whole array to each batch, from a frame that is not among theirs; "
            "their intervals draw rounds, uploads and frames anew.",
            "The published presets keep of ours: rounding = safe, contact_rule = opposing, a test that rejects pairs early. Records with broad = sphere find body pairs by balls, the release by boxes.",
            "Column total is the paper's for whole simulations; we do not simulate with gProximity. launches counts every kernel, launches_as_theirs as "
            "the release does: a refit and a balance are one each.",
            *_composition_note(folder),
        ),
    )


def _paper_rows_of_5():
    return [
        {
            "scene": row["scene"],
            "source": "paper",
            "device": row["gpu"],
            "method": f"{row['algorithm']} published, k = 8",
            **{f"{name}_s": number(row[f"{name}_s"]) for name in PARTS},
            "launches_as_theirs": number(row["launches"]),
        }
        for row in paper_table(5)
    ]


def _seconds(case, quantity):
    """Seconds of a quantity in all frames, medians of the rounds; None for records without it."""
    try:
        found_times = [seconds_by_round(cell, quantity, frame_range(cell)) for cell in case.cells]
    except NotMeasured:
        return None
    return sum(statistics.median(own.values()) for own in found_times if own)


def _times(scene, case):
    """A row of Table 5. Its parts are of the replays that time every command."""
    parts = {f"{name}_s": _seconds(case, name) for name in PARTS}
    separate = {name: _seconds(case, quantity) for name, quantity in UNTIMED.items()}
    separate |= {f"{name}_s": _seconds(case, f"stages:{name}") for name in ("broad", "seed")}
    listed = sum(seconds or 0 for seconds in (*parts.values(), *separate.values()))
    scaled = lambda columns: {
        name: None if seconds is None else case.scale * seconds for name, seconds in columns.items()
    }
    return {
        "scene": scene,
        "source": "ours",
        "device": case.device["id"],
        "method": f"{name_of(case)}, k = {case.settings.get('k')}",
        **scaled(parts),
        "launches_as_theirs": None if case.release_launches is None else case.scale * case.release_launches,
        **scaled(separate),
        "rest_s": case.scale * max(case.breakdown() - listed, 0),
        **scaled({f"{name}_s": _seconds(case, name) for name in ("initialization", "narrow")}),
        "whole_s": case.scale * case.total(),
        "whole_low_s": case.scale * case.total("low") if case.rounds > 1 else None,
        "whole_high_s": case.scale * case.total("high") if case.rounds > 1 else None,
        "samples": case.rounds,
        "launches": case.scale * case.sum("launches"),
        "waits": case.scale * case.sum("waits"),
        "frames": f"{case.frames} of {case.first}:{case.last}",
        "queue_bytes": case.settings.get("queue_bytes"),
        "records": case.locations[0],
    }


def table5(folder):
    rows = _paper_rows_of_5() + [
        _times(scene, case)
        for scene in SCENES
        for kind in ("cells", "resident")
        for case in folder.cases(f"{kind}-{scene}")
    ]
    return Table(
        5,
        f"Where the time goes, seconds in {STEPS_OF_TABLES} frames",
        ordered(rows),
        (
            "Column frames has the number of our frames; our values are scaled to 102 frames. whole is the median of replays that only time whole frames; "
            "samples has how many rounds each frame has, and one round has no interval. Stages and rest are of replays with timestamps, and stages may overlap.",
            "Columns left of launches_as_theirs have what the release times by these names, so that preprocess has neither seeds nor the queue array; columns make_seeds and "
            "queue_array have these. initialization and narrow are the two phases of the release. Fields are empty for records without such names.",
        ),
    )
