# SPDX-License-Identifier: MIT
"""Frames of a copy of culbvh's data: https://github.com/ZiXuanVickyLu/culbvh at 2e39017, folder asset. Names of files
and columns are those that test/test_simulation_dataset.cu reads and writes there: a folder of boxes for each data
set, and statistic/NAME.csv with the published counts."""

import collections
import csv
import pathlib

from boxes.errors import BadData

COLUMNS = {"sizes": ("collider_count", "mesh_count"), "counts": ("query_contacts", "self_query_contacts")}

# files: of the collider and of the mesh; sizes: how many boxes they should have; counts: published, between both and
# within the mesh.
Frame = collections.namedtuple("Frame", "set number files sizes counts")


def rows_of(path):
    """(number of a frame, its fields) of a table. Raises BadData."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                yield (
                    int(row["frame"]),
                    *(tuple(int(row[name]) for name in names) for names in COLUMNS.values()),
                )
    except OSError as error:
        raise BadData(f"{path}: {error.strerror}") from None
    except (KeyError, TypeError, ValueError):
        wanted = ",".join(["frame", *(name for names in COLUMNS.values() for name in names)])
        raise BadData(f"{path}: is no table with integers in columns {wanted}") from None


def frames(folder):
    """All frames that have a published count, data set by data set. Their files may be missing. Raises BadData."""
    folder = pathlib.Path(folder)
    tables = [path for path in sorted(folder.glob("statistic/*.csv")) if (folder / path.stem).is_dir()]
    if not tables:
        raise BadData(f"{folder}: has no statistic/NAME.csv with a folder NAME; give culbvh's folder asset")
    for table in tables:
        for number, sizes, counts in rows_of(table):
            files = [
                folder / table.stem / f"{what}_triangle_aabb_frame_{number:06}.bin"
                for what in ("moving_collider", "mesh")
            ]
            yield Frame(table.stem, number, files, sizes, counts)
