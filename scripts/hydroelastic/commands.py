# SPDX-License-Identifier: MIT
"""The two comparisons of scripts/drake."""

import collections
import csv
import dataclasses
import itertools
import pathlib
import tempfile

import numpy

from boxes.errors import BadData
from hydroelastic import scenes, shapes
from hydroelastic.comparison import TOLERANCE, Comparison, Single
from hydroelastic.library import Library
from hydroelastic.polygons import Cells
from hydroelastic.program import Cell, Program

MODULUS = 1e7  # Pa
LEAST_AREA = (
    1e-3  # m^2: poses that overlap less are left out, for the relative error of a small overlap is large
)
FRAMES = 5  # of a case that is timed


def written(pair, folder):
    """The files of both meshes."""
    files = [folder / f"{name}.vtk" for name in "AB"]
    for shape, file in zip(pair, files):
        shapes.write(shape, file)
    return files


def overlapping(library, pair, cells, options):
    """(poses, Drake's polygons at each)."""
    random = numpy.random.default_rng(options.seed)
    poses, found = [], []
    for pose in itertools.islice(
        scenes.random_poses(random, sum(shape.radius for shape in pair)), 100 * options.poses
    ):
        polygons = library.polygons(pose, cells)
        if polygons.area.sum() >= LEAST_AREA:
            poses.append(pose)
            found.append(polygons)
        if len(poses) == options.poses:
            break
    return numpy.array(poses), found


def tell_reasons(singles):
    """Prints how many polygons only one side has, by reason, and the largest."""
    groups = collections.defaultdict(list)
    for single in singles:
        groups[single.side, single.reason].append(single)
    for (side, reason), group in sorted(groups.items()):
        most = max(group, key=lambda single: single.share)
        print(
            f"    only {side}: {len(group):,} {reason}; the largest is {most.share:.1e} of the frame's largest, "
            f"pose {most.frame}, tetrahedra {most.pair[0]} and {most.pair[1]}"
        )


def compare_precision(name, precision, comparison, theirs, ours):
    """Prints the result of a pair of meshes. Returns (whether it is as it should be, polygons of one side)."""
    frames = [comparison.frame(i, *both) for i, both in enumerate(zip(theirs, ours))]
    counts = numpy.sum([frame.counts for frame in frames], axis=0)
    area, force, torque, of_lengths = numpy.max([frame.differences for frame in frames], axis=0)
    singles = [single for frame in frames for single in frame.singles]
    print(
        f"{name:15} {precision:7} {len(frames):5} {counts[0]:9,} {counts[1]:9,} {counts[2]:7,} {counts[3]:7,}"
        f"   {area:.1e} {force:.1e} {torque:.1e} {of_lengths:.1e}",
        flush=True,
    )
    tell_reasons(singles)
    judged = numpy.max([frame.judged for frame in frames], axis=0)[[0, 1, 3]]
    return judged.max() <= TOLERANCE[precision] and all(single.is_excused for single in singles), singles


def compare_pair(name, options, folder):
    """Yields (precision, whether it is right, polygons of one side)."""
    pair = scenes.PAIRS[name]()
    fields = [shapes.pressures(shape, MODULUS) for shape in pair]
    cells = [Cells(shape, field) for shape, field in zip(pair, fields)]
    files = written(pair, folder)
    poses, theirs = overlapping(Library(files, MODULUS), pair, cells, options)
    program = Program(options.program, folder, files, MODULUS, poses)
    for precision in TOLERANCE:
        comparison = Comparison(pair, fields, poses, precision)
        yield precision, *compare_precision(name, precision, comparison, theirs, program.polygons(precision))


def write_list(path, rows):
    names = [field.name for field in dataclasses.fields(Single)]
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["meshes", "precision", *names[:2], "tet_a", "tet_b", *names[3:]])
        for name, precision, single in rows:
            row = dataclasses.astuple(single)
            table.writerow([name, precision, *row[:2], *row[2], *row[3:]])


def compare(options):
    """Returns the exit code."""
    names = options.pairs.split(",") if options.pairs else list(scenes.PAIRS)
    if wrong := [name for name in names if name not in scenes.PAIRS]:
        raise BadData(f"unknown pair '{wrong[0]}'; expected some of {','.join(scenes.PAIRS)}")
    print("                                polygons          idle               largest relative difference")
    print(
        "meshes          prec.   poses     Drake    tandem   Drake  tandem   area    force   torque  of lengths"
    )
    is_right, rows = True, []
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            for precision, is_equal, singles in compare_pair(name, options, pathlib.Path(folder)):
                is_right &= is_equal
                rows += [(name, precision, single) for single in singles]
    if options.list:
        write_list(options.list, rows)
    print("equal within the tolerances" if is_right else "DIFFERENT")
    return int(not is_right)


def time_case(pair, translation, options, folder):
    """(polygons of the first frame, {Drake or a cell: seconds of frames})."""
    files = written(pair, folder)
    poses = scenes.moved(translation, FRAMES)
    library = Library(files, MODULUS)
    program = Program(options.program, folder, files, MODULUS, poses)
    count = library.seconds(poses[0])[1]
    seconds = collections.defaultdict(list)
    for _ in range(options.rounds):
        seconds[None] += [library.seconds(pose)[0] for pose in poses]
        for cell in cells_of(options):
            seconds[cell] += program.seconds(cell)
    return count, seconds


def cells_of(options):
    """The first one is compared with Drake."""
    others = [Cell("double", device, threads=0) for device in options.device or []]
    return [*map(Cell, TOLERANCE), *others]


def time(options):
    """Returns the exit code."""
    names = ["1 thread", "in float", *(cell.device for cell in cells_of(options)[2:])]
    print("ms per frame, medians; the last ratio is of the lowest")
    print(f"{'':36} polygons   Drake" + "".join(f" {name:>9}" for name in names) + "  ratios")
    for name, pair, translation in scenes.timed(options.most):
        with tempfile.TemporaryDirectory() as folder:
            count, seconds = time_case(pair, translation, options, pathlib.Path(folder))
        cells = [None, *cells_of(options)]
        medians, lowest = ([1e3 * of(seconds[cell]) for cell in cells] for of in (numpy.median, numpy.min))
        print(
            f"{name:36} {count:8,} {medians[0]:7.3f}" + "".join(f" {ms:9.3f}" for ms in medians[1:]), end=""
        )
        print(f" {medians[0] / medians[1]:6.2f} {lowest[0] / lowest[1]:6.2f}", flush=True)
    return 0
