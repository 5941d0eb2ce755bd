# SPDX-License-Identifier: MIT
"""Tables 1 to 7 of the paper beside ours."""
import csv
import dataclasses
import statistics

from .folder import SCENES, STEPS_OF_TABLES, number, paper_table


@dataclasses.dataclass
class Table:
    """Rows are dicts; a row's `source` says whose numbers they are, `records` where ours are from."""
    number: int
    title: str
    rows: list
    notes: tuple = ()

    @property
    def columns(self):
        return list(dict.fromkeys(name for row in self.rows for name in row))

    def write(self, folder):
        with open(folder / f"table{self.number}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, self.columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows([{name: short(row.get(name)) for name in self.columns} for row in self.rows])


def short(value):
    """Five figures of a number, nothing of None."""
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) and abs(value) < 1e5 else f"{value:.0f}" if isinstance(value, float) else str(value)


def ratio(above, below):
    return above / below if above is not None and below else None


def theirs(table, columns, gpu="gpu"):
    """The rows of a table of the paper, numbers as numbers."""
    return [{"scene": row["scene"], "source": "paper", "device": row.get(gpu, ""), **{new: number(row[old]) for new, old in columns.items()}}
            for row in table]


def ordered(rows):
    return sorted(rows, key=lambda row: (SCENES.index(row["scene"]), row["source"] != "ours"))


def table1(folder):
    rows = theirs(paper_table(1), {"bodies": "bodies", "vertices_thousand": "vertices_thousand", "tetrahedra_thousand": "tetrahedra_thousand",
                                   "contacts_thousand": "contacts_thousand", "median_contacts_thousand": "median_contacts_a_step_thousand"})
    for simulation in folder.simulations("sim-"):
        scene, found = simulation.run["scene"], simulation.curve("contacts_found")
        rows.append({"scene": scene["name"], "source": "ours", "device": simulation.run["devices"][0]["id"], "bodies": scene["bodies"],
                     "vertices_thousand": scene["vertices"] / 1e3, "tetrahedra_thousand": scene["tetrahedra"] / 1e3,
                     "contacts_thousand": sum(found) / 1e3, "median_contacts_thousand": statistics.median(found) / 1e3,
                     "steps": len(found), "key": scene["key"], "records": simulation.place})
    for way in [way for way in folder.ways("cells-plates") if way.name.startswith("chunked published")]:
        scene, contacts = way.records[0]["scene"], [n for r in way.records for n in r["work"]["contacts"]]
        rows.append({"scene": scene["name"], "source": "ours", "device": way.device["id"], "bodies": scene["bodies"],
                     "vertices_thousand": scene["vertices"] / 1e3, "tetrahedra_thousand": scene["tetrahedra"] / 1e3,
                     "contacts_thousand": sum(contacts) / 1e3, "median_contacts_thousand": statistics.median(contacts) / 1e3,
                     "steps": len(contacts), "key": scene["key"], "records": way.places[0]})
    return Table(1, "Scenes: bodies, tetrahedra and contacts", ordered(rows),
                 ("The paper's numbers are of 500 steps; ours of as many as column steps says. Plates move by a script here.",))


def table2(folder):
    rows = [{"source": "paper", "device": row["gpu"], "compute_units": number(row["compute_units"]), "cores": number(row["cores"]),
             "clock_mhz": number(row["clock_mhz"]), "memory_gb": number(row["memory_gb"]), "local_memory_kib": number(row["local_memory_kib"]),
             "bandwidth_gb_s": number(row["bandwidth_gb_s"]), "single_gflops": number(row["single_gflops"])} for row in paper_table(2)]
    ceilings = folder.ceilings()
    if ceilings:
        device, reported = ceilings["device"], ceilings.get("told", {})
        rows.append({"source": "ours", "device": device["name"], "compute_units": device["compute_units"], "cores": reported.get("cores"),
                     "clock_mhz": reported.get("clock_mhz"),
                     "memory_gb": device["memory_bytes"] / 1e9, "local_memory_kib": ratio(reported.get("local_bytes"), 1024),
                     "bandwidth_gb_s": ratio(reported.get("peak_bytes_per_s"), 1e9),
                     "single_gflops": ratio(reported.get("peak_flops"), 1e9),
                     "measured_read_gb_s": ceilings["read_bytes_per_s"]["median"] / 1e9, "measured_copy_gb_s": ceilings["copy_bytes_per_s"]["median"] / 1e9,
                     "measured_upload_gb_s": ceilings["upload_pageable_bytes_per_s"]["median"] / 1e9,
                     "measured_launch_us": ceilings["launch_s"]["median"] * 1e6, "records": "records/ceilings.jsonl"})
    return Table(2, "Devices", rows, ("Peak: a fused multiply and add, two operations, a core and clock. Bandwidth: of memory's clock and width, where the driver "
                                      "tells them; measured ones beside it. An empty field is unknown.",))


def percentages(simulation):
    """Percent of the total, as the paper's Table 3: of sums over all steps, and the mean of the steps' own shares."""
    total = simulation.host("step")
    start = simulation.stage("transform") + simulation.stage("refit")
    of = {"solver": simulation.host("solve") + simulation.host("assemble"), "initialization": start, "broad": simulation.host("broad"),
          "narrow": simulation.host("narrow") - start, "contact_reduction": simulation.host("reduce")}
    return {f"{name}_percent": 100 * seconds / total for name, seconds in of.items()}


def table3(folder):
    columns = ("solver_percent", "initialization_percent", "broad_percent", "narrow_percent", "contact_reduction_percent")
    rows = theirs(paper_table(3), {"total_min": "total_min", **{name: name for name in columns}})
    for simulation in [*folder.simulations("sim-"), *folder.simulations("host-"), *folder.simulations("serial-"), *folder.simulations("parallel-")]:
        own = percentages(simulation)
        rows.append({"scene": simulation.scene, "source": "ours", "device": simulation.run["devices"][0]["id"], "total_min": simulation.host("step") / 60,
                     **own, "collision_percent": sum(own[name] for name in columns[1:]), "steps": len(simulation.steps),
                     "data_path": data_path(simulation), "records": simulation.place})
    for row in rows:
        row.setdefault("collision_percent", sum(row[name] or 0 for name in columns[1:]))
    return Table(3, "What a simulation's time is made of", ordered(rows),
                 ("Shares of sums over all steps, of one run; the paper's are means of ten runs. Our solver, its rows included, runs on one thread, as "
                  "the paper's does.",))


def data_path(simulation):
    settings = simulation.run["settings"]
    published = settings.get("residency") == "published"
    return f"published, conversion {settings.get('convert', 'serial')}" if published else "resident"


def pick(ways, algorithm, preset, k="8"):
    return next((way for way in ways if way.algorithm == algorithm and way.preset == preset and way.settings.get("k") == k), None)


def factors(own, other, path, against):
    """A row of Table 4: how many times `other` takes as `own`."""
    return {"scene": own.scene, "source": "ours", "device": own.device["id"], "data_path": path, "against": against, "frame": ratio(other.total(), own.total()),
            "narrow": ratio(other.narrow, own.narrow), "read": ratio(other.stage("read"), own.stage("read")),
            "write": ratio(other.stage("write"), own.stage("write")), "launches": ratio(other.sum("launches"), own.sum("launches")),
            "launches_as_theirs": ratio(other.theirs, own.theirs), "frames": own.frames, "records": " ".join((own.places[0], other.places[0]))}


def scene_factors(folder, scene):
    ways = folder.ways(f"cells-{scene}")
    rows = []
    published, resident = pick(ways, "chunked", "published"), pick(ways, "chunked", "grouped")
    rest = [way for way in ways if way.algorithm == "gproximity" and way.preset == "published"]
    rest += folder.ways(f"gpus-{scene}")
    for other in rest if published else ():
        if other.frames == published.frames:
            rows.append(factors(published, other, "published", f"gproximity {other.preset}"))
        else:  # geometries of the paper's GPUs are measured on fewer frames: a frame against a frame
            rows.append({**factors(published, other, "published", f"gproximity {other.preset}"), **a_frame(published, other)})
    array, other = folder.ways("array"), pick(ways, "gproximity", "published")
    estimated = with_whole_array(published, other, array[0]) if array and published and other else None
    rows += [estimated] if estimated else []
    fair = pick(ways, "gproximity", "fair")
    if resident and fair:
        rows.append(factors(resident, fair, "resident", "gproximity fair"))
    return rows


def with_whole_array(own, other, array):
    """A row of Table 4, estimated: `other`, each of whose batches uploads the array that the release would allocate on this device,
    as long as one such upload was measured to take. None where that is not known."""
    if not other.batches or not array.batches:
        return None
    write = other.batches * (array.stage("write") - own.stage("write") / own.frames * array.frames) / array.batches
    more = write - other.stage("write")
    return {**factors(own, other, "published", "gproximity with the release's whole queue array, estimated"), "frame": (other.total() + more) / own.total(),
            "narrow": (other.narrow + more) / own.narrow, "write": ratio(write, own.stage("write")),
            "records": " ".join((own.places[0], other.places[0], array.places[0]))}


def a_frame(own, other):
    """Ratios of means over frames that are not the same ones."""
    means = lambda way: {"frame": way.total() / way.frames, "narrow": way.narrow / way.frames, "read": way.stage("read") / way.frames,
                         "write": way.stage("write") / way.frames, "launches": way.sum("launches") / way.frames,
                         "launches_as_theirs": way.theirs / way.frames}
    ours, rest = means(own), means(other)
    return {**{name: ratio(rest[name], ours[name]) for name in ours}, "frames": f"{own.frames} against {other.frames}"}


def table4(folder):
    rows = theirs(paper_table(4), {"total": "total", "narrow": "narrow", "read": "read", "write": "write", "launches": "launches"})
    for row in rows:
        row |= {"data_path": "published", "against": "gproximity", "launches_as_theirs": row["launches"], "launches": None}
    for scene in SCENES:
        rows += scene_factors(folder, scene)
    array = folder.ways("array")
    plates = pick(folder.ways("cells-plates"), "chunked", "published")
    if array and plates:
        rows.append({**factors(plates, array[0], "published", "gproximity with the release's whole queue array"), **a_frame(plates, array[0])})
    return Table(4, "gProximity / chunked", ordered(rows),
                 ("Published against published: both convert, upload and read back everything in every frame, gProximity its queue array as well, which is "
                  "capped here (setting queue_bytes) but on one frame of plates; where a row is estimated, each batch of 30 body pairs takes as long as that "
                  "upload did. Resident: everything stays on the device. The column total is the paper's "
                  "for whole simulations; ours is not measured with gProximity in the simulator.",
                  "launches counts every kernel; launches_as_theirs as the release does (a refit, a balance are one each)."))


PARTS = ("transform", "refit", "traverse", "contact", "balance", "preprocess", "postprocess", "read", "write")


def table5(folder):
    rows = []
    for row in paper_table(5):
        rows.append({"scene": row["scene"], "source": "paper", "device": row["gpu"], "method": f"{row['algorithm']} published, k = 8",
                     **{f"{name}_s": number(row[f"{name}_s"]) for name in PARTS}, "launches_as_theirs": number(row["launches"])})
    for scene in SCENES:
        for way in folder.ways(f"cells-{scene}"):
            listed = sum(way.stage(name) for name in PARTS)
            apart = {"broad_s": way.stage("broad"), "seed_s": way.stage("seed")}
            rows.append({"scene": scene, "source": "ours", "device": way.device["id"], "method": way.name,
                         **{f"{name}_s": way.scale * way.stage(name) for name in PARTS}, **untimed(way),
                         "launches_as_theirs": None if way.theirs is None else way.scale * way.theirs,
                         **{name: way.scale * value for name, value in apart.items()},
                         "rest_s": way.scale * max(way.total() - listed - sum(apart.values()), 0), "whole_s": way.scale * way.total(),
                         "whole_low_s": way.scale * way.total("low"), "whole_high_s": way.scale * way.total("high"),
                         "launches": way.scale * way.sum("launches"), "waits": way.scale * way.sum("waits"),
                         "frames": f"{way.frames} of {way.first}:{way.last}", "queue_bytes": way.settings.get("queue_bytes"), "records": way.places[0]})
    return Table(5, f"Where the time goes, seconds in {STEPS_OF_TABLES} frames", ordered(rows),
                 ("Ours are of as many frames as the column says, times as many as make 102. whole is the median of replays that only time whole frames; "
                  "stages are of replays with timestamps, and may overlap.",
                  "The release leaves the making of seeds and the allocation of its queue array untimed: columns make_seeds and queue_array, which "
                  "preprocess contains; empty where a record is older than they. rest is what no stage has. Wider columns right of launches are ours alone."))


def untimed(way):
    """What the release does outside its clocks, of what preprocess has here: seconds in 102 frames; None where a record does not tell."""
    found = {name: way.host_work(work) for name, work in (("make_seeds_s", "make seeds"), ("queue_array_s", "queue array"))}
    return {name: None if seconds is None else way.scale * seconds for name, seconds in found.items()}


def table6(folder):
    rows = theirs(paper_table(6), {name: name for name in ("total_min", "read_min", "write_min", "read_percent", "write_percent")})
    for simulation in [*folder.simulations("sim-"), *folder.simulations("host-"), *folder.simulations("serial-"), *folder.simulations("parallel-")]:
        total, read, write = simulation.host("step"), simulation.stage("read", "device_ns"), simulation.stage("write", "device_ns")
        rows.append({"scene": simulation.scene, "source": "ours", "device": simulation.run["devices"][0]["id"], "total_min": total / 60, "read_min": read / 60,
                     "write_min": write / 60, "read_percent": 100 * read / total, "write_percent": 100 * write / total,
                     "data_path": data_path(simulation), "steps": len(simulation.steps), "records": simulation.place})
    return Table(6, "Transfers of a simulation", ordered(rows), ("Device times of uploads and downloads. The paper's are of 500 steps.",))


def table7(folder):
    names = ("transform", "refit", "traverse", "contact")
    rows = theirs(paper_table(7), {f"{name}_min": f"{name}_min" for name in names})
    for simulation in [*folder.simulations("sim-"), *folder.simulations("host-"), *folder.simulations("serial-")]:
        rows.append({"scene": simulation.scene, "source": "ours", "device": simulation.run["devices"][0]["id"],
                     **{f"{name}_min": simulation.stage(name) / 60 for name in names}, "data_path": data_path(simulation),
                     "steps": len(simulation.steps), "records": simulation.place})
    for row in rows:
        row["traverse_over_contact"] = ratio(row["traverse_min"], row["contact_min"])
    return Table(7, "Kernels of a simulation", ordered(rows), ("Device times; a resident frame of rigid bodies is transformed in its refit.",))


def all_tables(folder):
    return [make(folder) for make in (table1, table2, table3, table4, table5, table6, table7)]
