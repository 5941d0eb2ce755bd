# SPDX-License-Identifier: MIT
"""Figures of records. The title of each figure states its result. The fastest cells have a strong colour and
a name; intervals are drawn."""

import textwrap
import warnings

import matplotlib.pyplot as plt

from .labels import labels
from .names import scene
from .report.leads import Named, title

WINNER, PALE, INK = "#0b5394", "#9aa5b1", "#333333"
# Wong 2011, "Points of view: Color blindness", Nature Methods 8: distinct for readers with colour blindness.
COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#000000")
GROUP = ["scene", "first_frame", "last_frame", "device_name"]
STAGE_ORDER = """
    broad refit seed traverse balance contact sort preprocess postprocess read write exchange
""".split()


def _rankable(cells):
    """Cells with correct answers and times. Warns of the rest, which are not drawn."""
    good = cells[(cells["status"] == "ok") & cells["ms"].notna()]
    if len(good) < len(cells):
        warnings.warn(
            f"{len(cells) - len(good)} of {len(cells)} cells failed, are wrong or have no times; they are not drawn",
            stacklevel=3,
        )
    if good.empty:
        raise ValueError("no cell with a correct answer has times; nothing can be drawn")
    return good


def _group_title(cells):
    groups = cells[GROUP].drop_duplicates()
    if len(groups) > 1:
        raise ValueError(
            f"{len(groups)} combinations of scene, frames and device; choose one with records.of(...)"
        )
    first = cells.iloc[0]
    return f"{scene(str(first['scene']))}, frames {first['first_frame']}:{first['last_frame']}, {first['device_name']}"


def _axes(ax, height):
    return ax if ax is not None else plt.subplots(figsize=(6.4, height), layout="constrained")[1]


def _title(ax, text, width=62):
    ax.set_title("\n".join(textwrap.wrap(text, width)), loc="left", fontsize=10, color=INK)


TITLE_WIDTH_WITH_NAMES = 40  # width of a title above axes that are narrower because of names of cells


def _and(words):
    words = list(words)
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _figures(value):
    return f"{value:.3g}"


def _scale_times(ax, name, times):
    """Scales axis "x" or "y": from zero, or logarithmic where short times could not be told apart."""
    if times.max() > 20 * times.min():
        ax.set(**{f"{name}scale": "log"})
    else:
        ax.set(**{f"{name}lim": (0, None)})


def plot_cells(records, ax=None):
    """Draws times of the cells of one scene, frame range and device, fastest first, with 95 % intervals. The
    title names the fastest cell and its lead, or the cells that cannot be told apart. Returns the axes. Raises
    ValueError for cells of several scenes, ranges or devices."""
    rankable = _rankable(records.cells)
    where = _group_title(rankable)
    verdict = records.of(rankable.index).verdict()
    cells = rankable.loc[[one.cell for one in verdict.cells]]
    names = labels(cells, without=GROUP)
    ax = _axes(ax, 1.2 + 0.28 * len(cells))
    ties = cells.index.isin(verdict.leaders())
    for row, (cell, name, tie) in enumerate(zip(cells.itertuples(), names, ties)):
        colour = WINNER if tie else PALE
        ax.plot([cell.ms_low, cell.ms_high], [row, row], color=colour, linewidth=2, solid_capstyle="butt")
        ax.plot(cell.ms, row, "o", color=colour, markersize=5)
        ax.annotate(
            _figures(cell.ms),
            (cell.ms_high, row),
            xytext=(6, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
            color=colour if tie else INK,
        )
    ax.set_yticks(range(len(cells)), names, fontsize=8)
    for tick, tie in zip(ax.get_yticklabels(), ties):
        tick.set_fontweight("bold" if tie else "normal")
    ax.invert_yaxis()
    _scale_times(ax, "x", cells["ms"])
    ax.margins(x=0.12)
    ax.set_xlabel("milliseconds per frame, median and 95 % interval", fontsize=8)
    named = [Named(*one) for one in zip(verdict.cells, names, cells["ms"])]
    message = title(named, verdict.answers_differ)
    _title(ax, f"{where}: {message}", TITLE_WIDTH_WITH_NAMES)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def plot_sweep(records, setting, ax=None):
    """Draws times over the values of a setting ("seed_threshold") with 95 % intervals, and one line for each
    combination of other settings. The title names the fastest value, or the values that are not told apart
    from it. Values that are words keep the order of the records. Returns the axes. Raises ValueError for a
    setting that no cell has."""
    column = "set_" + setting.removeprefix("set_")
    if column not in records.cells or records.cells[column].isna().all():
        known = ", ".join(name.removeprefix("set_") for name in records.cells if name.startswith("set_"))
        raise ValueError(f"{setting}: no such setting in these records; there are {known}")
    cells = _rankable(records.cells[records.cells[column].notna()])
    where = _group_title(cells)
    ax = _axes(ax, 3.6)
    values = cells[column]
    numbers = values.dtype.kind in "if" or str(values.dtype) == "Int64"
    positions = (
        values.astype(float)
        if numbers
        else values.astype(str).map({word: i for i, word in enumerate(values.astype(str).unique())})
    )
    best = cells["ms"].idxmin()
    names = labels(cells, without=(*GROUP, column))
    for colour, (name, line) in zip(COLOURS * 9, cells.groupby(names, sort=False)):
        line = line.assign(position=positions[line.index]).sort_values("position")
        ax.fill_between(
            line["position"], line["ms_low"], line["ms_high"], color=colour, alpha=0.2, linewidth=0
        )
        ax.plot(line["position"], line["ms"], "o-", color=colour, markersize=4, linewidth=1.2, label=name)
    ax.annotate(
        f"{cells.at[best, column]}: {_figures(cells.at[best, 'ms'])}",
        (positions[best], cells.at[best, "ms"]),
        xytext=(0, -14),
        textcoords="offset points",
        ha="center",
        fontsize=8,
        fontweight="bold",
        color=INK,
    )
    if numbers and positions.max() > 100 * max(positions[positions > 0].min(), 1e-300):
        ax.set_xscale("symlog", linthresh=positions[positions > 0].min())
    if not numbers:
        ax.set_xticks(range(positions.max() + 1), values.astype(str).unique())
    ax.set_xlabel(column.removeprefix("set_"), fontsize=8)
    ax.set_ylabel("milliseconds per frame", fontsize=8)
    _scale_times(ax, "y", cells["ms"])
    if len(ax.lines) > 1:
        ax.legend(fontsize=7, frameon=False)
    ties = (
        cells[(names == names[best]) & (cells["ms_low"] <= cells.at[best, "ms_high"])]
        .sort_values("ms")[column]
        .astype(str)
    )
    result = (
        "is the fastest value tried"
        if len(ties) == 1
        else "cannot be told apart, and are the fastest values tried"
    )
    _title(ax, f"{where}: {column.removeprefix('set_')} = {_and(ties)} {result}")
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def plot_stages(records, ax=None):
    """Draws the stages of each cell as one bar, with times on the device, or on the host for stages without
    device time. Cells are of one scene and device, fastest first. Returns the axes."""
    cells = _rankable(records.cells).sort_values("ms")
    where = _group_title(cells)
    columns = [f"stage_{name}_ms" for name in STAGE_ORDER if f"stage_{name}_ms" in cells]
    columns += sorted(name for name in cells if name.startswith("stage_") and name not in columns)
    stages = cells[columns].fillna(0)
    stages = stages.loc[
        :, (stages.div(stages.sum(axis=1), axis=0) > 0.01).any()
    ]  # smaller ones are not visible
    ax = _axes(ax, 1.4 + 0.28 * len(cells))
    left = stages.iloc[:, 0] * 0
    for colour, name in zip((*COLOURS, "#999999", "#66507a"), stages):
        ax.barh(
            range(len(cells)),
            stages[name],
            left=left,
            color=colour,
            label=name.removeprefix("stage_").removesuffix("_ms"),
            height=0.7,
        )
        left = left + stages[name]
    ax.set_yticks(range(len(cells)), labels(cells, without=GROUP), fontsize=8)
    ax.invert_yaxis()
    ax.set_xlabel("milliseconds per frame", fontsize=8)
    ax.legend(
        fontsize=7, frameon=False, ncols=4, loc="upper left", bbox_to_anchor=(0, -0.12 - 1 / (1 + len(cells)))
    )
    largest = stages.iloc[0].idxmax()
    fraction = stages.iloc[0][largest] / stages.iloc[0].sum()
    _title(
        ax,
        f"{where}: {largest.removeprefix('stage_').removesuffix('_ms')} has {100 * fraction:.0f} % of the fastest frame's stages",
        TITLE_WIDTH_WITH_NAMES,
    )
    ax.spines[["top", "right"]].set_visible(False)
    return ax


ERRORS = {
    "depth_relative": "error of depth, relative",
    "depth_ulps": "error of depth, units in the last position",
    "normal_degrees": "error of normals, degrees",
    "point": "distance of points from both bodies",
    "hausdorff": "distance of the contacts' hull",
    "volume_relative": "error of volume, relative",
    "false_share": "share of candidate pairs that do not meet",
    "missed_share": "share of meeting pairs that are missed",
}


def _unbeaten(cells):
    """Which cells are Pareto-optimal: no other cell is better in time or error without being worse in the
    other."""

    def beats(other, cell):
        return (
            other.ms <= cell.ms
            and other.error <= cell.error
            and (other.ms < cell.ms or other.error < cell.error)
        )

    rows = list(cells.itertuples())
    return [not any(beats(other, cell) for other in rows) for cell in rows]


def _draw_errors(ax, cells, names):
    """Draws times over errors. names: of the numbered cells, in their order; the legend has them."""
    numbers = {cell: number for number, cell in enumerate(names.index, 1)}
    some = cells["error"][cells["error"] > 0]
    edge = some.min() / 10 if len(some) else 1.0
    for cell in cells[::-1].itertuples():  # draws the fastest last, on top
        position, number = max(cell.error, edge), numbers.get(cell.Index)
        colour, marker, size, text = (
            WINNER if number else PALE,
            "D" if number else "o",
            6 if number else 4,
            None,
        )
        if number:
            text = f"{number}  {names[cell.Index]}: {_figures(cell.ms)} ms, {_figures(cell.error)}"
        interval = [cell.ms_low, cell.ms_high]
        ax.plot([position, position], interval, color=colour, linewidth=2, solid_capstyle="butt")
        ax.plot(position, cell.ms, marker, color=colour, markersize=size, label=text)
        if number:
            ax.annotate(
                str(number),
                (position, cell.ms),
                xytext=(-7 if number % 2 else 7, 0),
                textcoords="offset points",
                ha="right" if number % 2 else "left",
                va="center",
                fontsize=9,
                fontweight="bold",
                color=WINNER,
            )
    ax.set_xscale("log")
    ax.margins(x=0.1)
    ax.set_ylim(bottom=0)
    handles, texts = ax.get_legend_handles_labels()
    ax.legend(
        handles[::-1],
        texts[::-1],
        fontsize=7,
        frameon=False,
        loc="upper left",
        bbox_to_anchor=(0, -0.14),
        title="beaten by none in both",
        title_fontsize=7,
        alignment="left",
    )


def plot_errors(records, error="depth_relative", which="median", ax=None):
    """Draws milliseconds per frame over an error against the exact truth ("depth_relative", "hausdorff",
    "false_share", ...; its "median", "p99" or "max") for the cells of one scene, frame range and device.
    Pareto-optimal cells are numbered and named below the axes, the rest is pale. Cells without error are at
    the left edge. Returns the axes. Raises ValueError for an error that the records do not have."""
    found = records.errors[(records.errors["error"] == error) & records.errors[which].notna()].set_index(
        "cell"
    )[which]
    if found.empty:
        known = ", ".join(records.errors["error"].unique()) or "none: measure with --truth"
        raise ValueError(f"{error}: no such error in these records; there are {known}")
    cells = _rankable(records.cells.loc[found.index]).sort_values("ms")
    where = _group_title(cells)
    cells = cells.assign(error=found[cells.index])
    unbeaten = _unbeaten(cells)
    best = cells[unbeaten]
    # Values that are words need no name of the setting.
    names = labels(best.drop(columns="error"), without=GROUP).str.replace(
        r"\b[a-z_]+=(?=[a-z])", "", regex=True
    )
    ax = _axes(ax, 3.8 + 0.16 * len(best))
    _draw_errors(ax, cells, names)
    ax.set_xlabel(
        f"{ERRORS.get(error, error)}, {which}" if not error.endswith("_share") else ERRORS[error], fontsize=8
    )
    ax.set_ylabel("milliseconds per frame", fontsize=8)
    fastest, least = best["ms"].idxmin(), best["error"].idxmin()
    if fastest == least:
        message = f"{names[fastest]} is the fastest and has the least error"
    else:
        times = _figures(best.at[least, "ms"] / best.at[fastest, "ms"])
        message = f"{names[least]} has the least error and takes {times} times as long as the fastest, {names[fastest]}"
    _title(ax, f"{where}: {message}")
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def plot_frames(records, what="ms", ax=None):
    """Draws a curve over frames for each cell of one scene and device: "ms", "body_pairs", "candidate_pairs"
    or "contacts". Returns the axes."""
    known = ("ms", "body_pairs", "candidate_pairs", "contacts")
    if what not in known:
        raise ValueError(f"{what}: no such column; there are {', '.join(known)}")
    cells = _rankable(records.cells).sort_values("ms")
    where = _group_title(cells)
    names = labels(cells, without=GROUP)
    ax = _axes(ax, 3.6)
    curves = records.frames[records.frames["cell"].isin(cells.index)]
    for colour, cell in zip(COLOURS * 9, cells.index):
        curve = curves[curves["cell"] == cell]
        ax.plot(curve["frame"], curve[what].astype(float), color=colour, linewidth=1.2, label=names[cell])
    ax.set_xlabel("frame", fontsize=8)
    words = {"ms": "milliseconds"}.get(what, what.replace("_", " "))
    ax.set_ylabel(words, fontsize=8)
    ax.set_ylim(bottom=0)
    if len(cells) > 1:
        ax.legend(fontsize=7, frameon=False)
    top = curves.loc[curves[what].astype(float).idxmax()]
    _title(ax, f"{where}: most {words} in frame {int(top['frame'])}, {_figures(float(top[what]))}")
    ax.spines[["top", "right"]].set_visible(False)
    return ax
