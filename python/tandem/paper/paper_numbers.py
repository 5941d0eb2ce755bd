# SPDX-License-Identifier: MIT
"""The paper's numbers that a claim names, from results/paper. `paper` of a claim is one of {table, column[,
gpu]}; {table, sum = COLUMNS}; {table, above = COLUMNS, below = COLUMNS[, algorithm]}, a quotient of sums;
{table = 7, share = COLUMNS}, a part of all kernels; {table = 5, gproximity_over_chunked,
chunked_over_gproximity or share_of_gproximity}. `factor` scales."""

from .folder import number, paper_table

KERNELS_OF_TABLE_7 = ("transform_min", "refit_min", "traverse_min", "contact_min")


def _sum(row, columns):
    return sum(number(row[column]) or 0 for column in columns)


def _quotient(above, below):
    return above / below if below else None


def _pairs(rows):
    """(row of gproximity, row of chunked) by device."""
    both = {}
    for row in rows:
        both.setdefault(row["gpu"], {})[row["algorithm"]] = row
    return {gpu: (pair["gproximity"], pair["chunked"]) for gpu, pair in both.items()}


def _of_pairs(rows, asked):
    for name in ("gproximity_over_chunked", "chunked_over_gproximity"):
        if name in asked:
            order = 1 if name == "gproximity_over_chunked" else -1
            return {
                gpu: _quotient(*[_sum(row, asked[name]) for row in pair[::order]])
                for gpu, pair in _pairs(rows).items()
            }
    seconds = lambda row: [name for name in row if name.endswith("_s")]
    return {
        gpu: _quotient(_sum(pair[0], [asked["share_of_gproximity"]]), _sum(pair[0], seconds(pair[0])))
        for gpu, pair in _pairs(rows).items()
    }


def of_scene(asked, scene):
    """The paper's numbers of a scene by device; empty if it has none. `asked`: field `paper` of a claim."""
    if not asked:
        return {}
    rows = [
        row
        for row in paper_table(asked["table"])
        if row["scene"] == scene
        and asked.get("algorithm", row.get("algorithm")) == row.get("algorithm")
        and asked.get("gpu", row.get("gpu")) == row.get("gpu")
    ]
    key = lambda row: row.get("gpu", "")
    if "column" in asked:
        found = {key(row): number(row[asked["column"]]) for row in rows}
    elif "sum" in asked:
        found = {key(row): _sum(row, asked["sum"]) for row in rows}
    elif "above" in asked:
        found = {key(row): _quotient(_sum(row, asked["above"]), _sum(row, asked["below"])) for row in rows}
    elif "share" in asked:
        found = {
            key(row): _quotient(_sum(row, asked["share"]), _sum(row, KERNELS_OF_TABLE_7)) for row in rows
        }
    else:
        found = _of_pairs(rows, asked)
    return {device: value * asked.get("factor", 1) for device, value in found.items() if value is not None}
