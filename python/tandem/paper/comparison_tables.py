# SPDX-License-Identifier: MIT
"""Tables 4 and 5: the methods beside each other, resident and as published."""

from . import composed
from .folder import SCENES, STEPS_OF_TABLES, number, paper_table
from .methods import FOUR, found, four_of_scenes, name_of, names
from .quantities import NotMeasured
from .ratios import ratio_of
from .tables import Table, ordered, paper_rows, written

COLUMNS = {
    "frame": "frame",
    "narrow": "narrow",
    "read": "stages:read",
    "write": "stages:write",
    "launches": "launches",
    "launches_as_theirs": "release launches",
}
PARTS = ("transform", "refit", "traverse", "contact", "balance", "preprocess", "postprocess", "read", "write")
SMALL_K = "8"


def _ratio(other, own, quantity):
    try:
        return ratio_of(other, quantity, own, quantity)
    except NotMeasured:
        return None


def factors(scene, other, own, data_path):
    """A row of Table 4: times and launches of `other` over those of `own`, with the interval of the whole
    frame."""
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
        "frame_low": frame and frame.low,
        "frame_high": frame and frame.high,
        "samples": frame and frame.samples,
        "frames": frame and frame.frames,
        "queue_bytes": other.settings.get("queue_bytes") if data_path == "published" else None,
        "records": " ".join((own.locations[0], other.locations[0])),
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
    compared = ([other] if other else []) + folder.cases(f"gpus-{scene}")
    rows = [factors(scene, case, own, "published") for case in compared if _ratio(case, own, "frame")]
    arrays = [
        case
        for step in ("array", "array-again")
        for case in folder.cases(step)
        if case.settings.get("queue_bytes") == _largest(folder)
    ]
    if other and arrays and other.batches:
        rows.append(_with_array(scene, other, own, arrays))
    return rows


def _largest(folder):
    sizes = [case.settings["queue_bytes"] for step in ("array", "array-again") for case in folder.cases(step)]
    return "device" if "device" in sizes else max(sizes, key=int, default=None)


def _with_array(scene, other, own, arrays):
    row = factors(scene, other, own, "published")
    ratios = {
        name: composed.ratio_with_array(other, COLUMNS[name], own, COLUMNS[name], arrays)
        for name in ("frame", "narrow", "write")
    }
    frame = ratios["frame"]
    return (
        row
        | {name: measured.value for name, measured in ratios.items()}
        | {
            "method": f"{name_of(other)}, whole array (composed) / {name_of(own)}",
            "frame_low": frame.low,
            "frame_high": frame.high,
            "samples": frame.samples,
            "queue_bytes": arrays[0].settings["queue_bytes"],
            "records": " ".join(frame.records),
        }
    )


def _composition_note(folder):
    """How near compositions are to frames that were measured whole, with the array of a K40c."""
    arrays, texts = folder.cases("array-k40c"), []
    for scene in SCENES:
        parts = [case for case in folder.cases(f"gpus-{scene}") if case.preset == "published-k40c"]
        whole = folder.cases(f"whole-{scene}") or [case for case in arrays if case.scene == scene]
        if parts and whole and arrays:
            try:
                texts.append(
                    f"{scene} {written(composed.ratio_with_array(parts[0], 'frame', whole[0], 'frame', arrays).value)}"
                )
            except NotMeasured:
                continue
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
            "gProximity takes longer. frame has whole frames with their 95 % interval; narrow is what the paper calls narrow phase. Both methods of a row have the "
            "same frames of one recording.",
            "gProximity published also uploads its queue array for every batch; queue_bytes has its size. Records without setting sizes have a K40c's "
            "launch geometry and batches of 30 body pairs. Composed rows add the measured upload of the array that the release would allocate on this device to each batch.",
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


def _times(scene, case):
    """A row of Table 5. Stages and rest are parts of the replays that time every command."""
    separate = {"broad_s": case.stage("broad"), "seed_s": case.stage("seed")}
    listed = sum(case.stage(name) for name in PARTS) + sum(separate.values())
    return {
        "scene": scene,
        "source": "ours",
        "device": case.device["id"],
        "method": f"{name_of(case)}, k = {case.settings.get('k')}",
        **{f"{name}_s": case.scale * case.stage(name) for name in PARTS},
        **untimed(case),
        "launches_as_theirs": None if case.release_launches is None else case.scale * case.release_launches,
        **{name: case.scale * value for name, value in separate.items()},
        "rest_s": case.scale * max(case.breakdown() - listed, 0),
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
            "The release does not time the making of seeds and the allocation of its queue array. Columns make_seeds and queue_array have these times, "
            "which preprocess contains; they are empty for old records. Only we have the columns right of launches_as_theirs.",
        ),
    )


def untimed(case):
    """Seconds in 102 frames of those parts of stage preprocess that the release does not time; None for
    records without them."""
    found = {
        name: case.host_work(work)
        for name, work in (("make_seeds_s", "make seeds"), ("queue_array_s", "queue array"))
    }
    return {name: None if seconds is None else case.scale * seconds for name, seconds in found.items()}
