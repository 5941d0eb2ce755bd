# SPDX-License-Identifier: MIT
"""The paper's claims, and a verdict on each from our records."""
import dataclasses
import json
import re
import statistics

import scipy.stats

from .figures import device_seconds, fit
from .folder import SCENES, MeasuredCells
from .pictures import chunks_of
from .tables import data_path, pick, ratio, scene_factors, percentages

AGREES, DIFFERS, UNTESTED = "agrees", "differs", "cannot be tested here"


@dataclasses.dataclass
class Claim:
    where: str  # table, figure or section of the paper
    says: str  # the claim
    verdict: str
    ours: str  # our numbers, or the reason if there are none
    records: str = ""


def span(values, unit=""):
    values = list(values)
    text = f"{min(values):.3g}" if len(values) == 1 else f"{min(values):.3g} to {max(values):.3g}"
    return text + unit


def judged(good):
    return AGREES if good else DIFFERS


def factor_rows(folder):
    """Rows of Table 4 for both data paths: published, resident."""
    rows = [row for scene in SCENES for row in scene_factors(folder, scene)]
    return [row for row in rows if row["data_path"] == "published"], [row for row in rows if row["data_path"] == "resident"]


def narrow_claims(folder):
    published, resident = factor_rows(folder)
    statement = "Chunked takes 6 to 133 times less narrow-phase time than gProximity"
    if not published:
        return [Claim("Table 4", statement, UNTESTED, "no pair of cells has completed")]
    locations = " ".join(row["records"] for row in published)
    whole = [row for row in published if row["against"].endswith("estimated")]
    published = [row for row in published if row not in whole]
    spans = lambda rows: ", ".join(f"{scene} {span(row['narrow'] for row in rows if row['scene'] == scene)}" for scene in dict.fromkeys(row["scene"] for row in rows))
    claims = []
    if whole:
        claims.append(Claim("Table 4", statement + ", with the queue array that its release uploads for every batch", judged(min(row["narrow"] for row in whole) >= 6),
                            spans(whole) + "; estimated: batches times the upload of one array, a quarter of this device's memory, which was measured on plates",
                            " ".join(row["records"] for row in whole)))
    claims.append(Claim("Table 4", statement + ", as published but with a small queue array", judged(min(row["narrow"] for row in published) >= 6), spans(published), locations))
    if resident:
        claims.append(Claim("Table 4", "the same with everything resident, which neither the paper nor its release does",
                            judged(min(row["frame"] for row in resident) >= 6), "whole frames: " + "; ".join(f"{row['scene']} {row['frame']:.3g}" for row in resident),
                            " ".join(row["records"] for row in resident)))
    counted = [row["launches_as_theirs"] for row in published]
    claims.append(Claim("Table 4", "up to three orders of magnitude fewer launches (2.1 to 1748 times)", judged(max(counted) >= 100),
                        f"{span(counted)} times, counted as the release counts; the paper's largest are where its GPUs took 26 to 30 body pairs a batch", locations))
    return claims


def write_claim(folder):
    cases = [case for case in (pick(folder.cases(f"cells-{scene}"), "gproximity", "published") for scene in SCENES) if case]
    statement = "gProximity's bottleneck is writing to the device"
    if not cases:
        return Claim("Figures 7 and 8", statement, UNTESTED, "no cell of gProximity published has completed")
    part = {case.scene: case.stage("write") / case.total() for case in cases}
    array = folder.cases("array")
    whole = f"; with the release's whole array on plates {100 * array[0].stage('write') / array[0].total():.0f} %" if array else ""
    return Claim("Figures 7 and 8", statement, judged(statistics.median(part.values()) > 0.5 or bool(array) and array[0].stage("write") > 0.5 * array[0].total()),
                 "share of write: " + ", ".join(f"{scene} {100 * value:.0f} %" for scene, value in part.items()) + " with a capped queue array" + whole,
                 " ".join(case.locations[0] for case in cases))


def kernel_claim(folder):
    rows = []
    for scene in SCENES:
        cases = folder.cases(f"cells-{scene}")
        own, other = pick(cases, "chunked", "published"), pick(cases, "gproximity", "published")
        if own and other:
            kernels = lambda case: sum(case.stage(name, "device_ns") for name in ("transform", "refit", "traverse", "balance", "contact"))
            rows.append((scene, kernels(other) / kernels(own), own.locations[0]))
    statement = "pure kernel times are on par with those of approaches that balance (0.5 to 3.8 in Table 5)"
    if not rows:
        return Claim("Section 5", statement, UNTESTED, "no pair of published cells has completed")
    return Claim("Section 5", statement, judged(all(0.5 <= value <= 3.8 for _, value, _ in rows)), "gProximity / chunked: " + ", ".join(f"{s} {v:.2g}" for s, v, _ in rows),
                 " ".join(location for *_, location in rows))


def digest_of(record):
    """The digest of all pairs of a record, as text; None if they were not compared with the reference."""
    digest = (record.get("agreement") or {}).get("digest")
    return json.dumps(digest) if digest else None


def same_pairs_claim(folder):
    groups = {}
    for scene in SCENES:
        for case in folder.cases(f"cells-{scene}"):
            for record in case.records:
                own = record["settings"]
                bounds = (record["scene"]["digest"], record["frames"]["first"], *(own.get(name) for name in ("k", "axes", "precision", "rounding")))
                groups.setdefault(bounds, []).append(digest_of(record))
    statement = "both algorithms find exactly the same pairs of tetrahedra"
    # A comparison needs at least two digests.
    compared = [digests for digests in ([d for d in group if d] for group in groups.values()) if len(digests) > 1]
    if not compared:
        return Claim("Section 4", statement, UNTESTED, "no two records of the same frames and bounds have digests")
    equal = [len(set(digests)) == 1 for digests in compared]
    empty = sum(json.loads(digests[0])["count"] == 0 for digests in compared)
    return Claim("Section 4", statement, judged(all(equal) and not folder.wrong()),
                 f"equal digests in {sum(equal)} of {len(equal)} groups of records with the same frames and bounds ({empty} without pairs), tiled's as well")


def stage_claims(folder):
    runs = {run.scene: run for run in folder.simulations("sim-")}
    claims = []
    for scenes, statement, good in ((("funnel", "glasses"), "collision detection takes 70 to 80 % of complex scenes", lambda own: own >= 60),
                               (("colosseum",), "and less than the solver for the colosseum", lambda own: own < 50)):
        own = {scene: sum(percentages(runs[scene]).values()) - percentages(runs[scene])["solver_percent"] for scene in scenes if scene in runs}
        if not own:
            claims.append(Claim("Table 3", statement, UNTESTED, "no such simulation has completed"))
            continue
        claims.append(Claim("Table 3", statement, judged(all(good(value) for value in own.values())),
                            ", ".join(f"{scene} {value:.0f} %" for scene, value in own.items()) + ", resident on " + next(iter(runs.values())).run["devices"][0]["id"],
                            " ".join(runs[scene].location for scene in own)))
    return claims


def simulation_claims(folder):
    runs = [*folder.simulations("sim-")]
    if not runs:
        return [Claim("Section 4", "the claims about whole simulations", UNTESTED, "no simulation has completed")]
    locations = " ".join(run.location for run in runs)
    moved = {run.scene: 100 * (run.stage("read", "device_ns") + run.stage("write", "device_ns")) / run.host("step") for run in runs}
    claims = [Claim("Table 6", "transfers are never more than 5 to 7 % of the time", judged(max(moved.values()) <= 7),
                    ", ".join(f"{scene} {value:.2g} %" for scene, value in moved.items()) + ", resident", locations)]
    published = [run for run in folder.simulations("serial-")]
    if published:
        own = {run.scene: 100 * (run.stage("read", "device_ns") + run.stage("write", "device_ns")) / run.host("step") for run in published}
        claims.append(Claim("Table 6", "the same with the published data path", judged(max(own.values()) <= 7), ", ".join(f"{s} {v:.2g} %" for s, v in own.items()),
                            " ".join(run.location for run in published)))
        part = {run.scene: (run.stage("preprocess"), max((run.stage(name), name) for name in ("traverse", "contact", "refit", "read", "write", "postprocess"))) for run in published}
        claims.append(Claim("Figures 10 and 11", "pre-processing is the largest cost of finding contacts", judged(all(pre > other for pre, (other, _) in part.values())),
                            ", ".join(f"{scene}: preprocess {pre:.3g} s, {name} {other:.3g} s" for scene, (pre, (other, name)) in part.items()) + ", published data path",
                            " ".join(run.location for run in published)))
    ratios = {run.scene: run.stage("traverse") / run.stage("contact") for run in runs if run.stage("contact")}
    claims.append(Claim("Table 7", "traversal takes about ten times as long as making contacts", judged(all(5 <= value <= 20 for value in ratios.values())),
                        ", ".join(f"{scene} {value:.2g} times" for scene, value in ratios.items()), locations))
    return claims + scaling_claims(runs, locations)


def scaling_claims(runs, locations):
    fitted = {run: fit(run.curve("contacts_found"), device_seconds(run)) for run in runs}
    fitted = {run: values for run, values in fitted.items() if values}
    claims = []
    if fitted:
        rank = {run: scipy.stats.spearmanr(run.curve("contacts_found"), device_seconds(run)).statistic for run in fitted}
        claims.append(Claim("Figures 9 to 11", "device times grow with the number of contacts", judged(all(value > 0.7 for value in rank.values())),
                            "where contacts change fourfold: " + ", ".join(f"{run.scene} rank correlation {rank[run]:.2f}, exponent {values[0]:.2g}" for run, values in fitted.items()), locations))
    steady = {run.scene: statistics.quantiles(run.curve("stage:refit"), n=10) for run in runs}
    claims.append(Claim("Figures 9 to 11", "transform and refit do not depend on contacts", judged(all(deciles[8] <= 2 * deciles[0] for deciles in steady.values())),
                        "ninth over first decile of refit: " + ", ".join(f"{scene} {deciles[8] / deciles[0]:.2g}" for scene, deciles in steady.items()), locations))
    return claims


def order_claim(folder):
    breadth, morton = chunks_of(folder, "breadth"), chunks_of(folder, "morton")
    statement = "chunks of breadth-first order overlap much, those of Z-order are fat and apart"
    if breadth is None or morton is None:
        return Claim("Figure 5", statement, UNTESTED, "chunks have not been exported")
    times = []
    for case in folder.cases("chunk-study"):
        if case.settings.get("builder") == "breadth":
            pair = next((w for w in folder.cases("chunk-study") if {**w.settings, "builder": ""} == {**case.settings, "builder": ""} and w.settings["builder"] == "morton"), None)
            times += [case.total() / pair.total()] if pair else []
    slower = f"; a frame takes {span(times)} times as long with it (median {statistics.median(times):.3g})" if times else ""
    return Claim("Figure 5", statement, judged(breadth.overlap() > 1.2 * morton.overlap()),
                 f"overlap of boxes over the mesh's box: {breadth.overlap():.3g} breadth-first, {morton.overlap():.3g} Z-order; shortest over longest side "
                 f"{breadth.fatness():.2g} and {morton.fatness():.2g}{slower}", "chunks-breadth.csv chunks-morton.csv")


def threshold_claim(folder):
    cases = {int(case.settings["seed_threshold"]): case for case in folder.cases("thresholds") if case.preset == "published"}
    statement = "traversal gets slower where the seed threshold goes from 10^3 to 10^4 (glasses)"
    if not {1000, 10000} <= set(cases):
        return Claim("Figure 13", statement, UNTESTED, "the sweep has not completed")
    step = cases[10000].stage("traverse") / cases[1000].stage("traverse")
    return Claim("Figure 13", statement, judged(step > 1.1), f"traversal {step:.3g} times as long, as published", " ".join(cases[t].locations[0] for t in (1000, 10000)))


def cpu_claim(folder):
    rows = []
    for serial in folder.simulations("serial-"):
        parallel, host, device = (folder.simulation(f"{kind}-{serial.scene}") for kind in ("parallel", "host", "sim"))
        if not parallel or not host or not device:
            continue
        steps = len(serial.steps)
        seconds = [sum(run.curve("host:step")[:steps]) for run in (host, serial, parallel, device)]
        rows.append((serial.scene, steps, seconds, serial.location, parallel.location))
    statement = "with serial conversion the GPU's simulator is as fast as the CPU's, with parallel conversion 20 % faster"
    if not rows:
        return Claim("Section 5", statement, UNTESTED, "the simulations have not completed")
    good = all(0.75 <= host / serial <= 1.33 and host / parallel >= 1.1 for _, _, (host, serial, parallel, _), *_ in rows)
    return Claim("Section 5", statement, judged(good),
                 "; ".join(f"{scene}, {steps} steps: host {t[0]:.3g} s, published {t[1]:.3g} s, converted on all cores {t[2]:.3g} s, resident {t[3]:.3g} s"
                           for scene, steps, t, *_ in rows), " ".join(location for row in rows for location in row[3:]))


def precision_claim(folder):
    cases = {case.settings["precision"]: case for case in folder.cases("precision")}
    statement = "double precision would double GPU times or worse"
    if set(cases) != {"float", "double"}:
        return Claim("Section 4", statement, UNTESTED, "both have not completed")
    kernels = lambda case: sum(case.stage(name, "device_ns") for name in ("refit", "seed", "traverse", "contact"))
    value = kernels(cases["double"]) / kernels(cases["float"])
    return Claim("Section 4", statement, judged(value >= 1.8), f"kernels {value:.3g} times as long, whole frames {cases['double'].total() / cases['float'].total():.3g}",
                 " ".join(case.locations[0] for case in cases.values()))


def backlog_claim(folder):
    where, statement = "Table 5", "a GPU whose buffers are too small launches again with what is left (C2075, funnel: 518 launches for 408)"
    whole, short = pick(folder.cases("cells-funnel"), "chunked", "published"), folder.cases("backlog")
    if not whole or not short:
        return Claim(where, statement, UNTESTED, "no cell with a limit of memory has completed")
    frames = [record["frames"] for record in short[0].records]
    comparable = [record for record in whole.records if record["frames"] in frames]
    if not comparable:
        return Claim(where, statement, UNTESTED, "the cells with and without a limit of memory have different frames")
    launches = [case.release_launches for case in (MeasuredCells(comparable, whole.locations), short[0])]
    limit = re.search(r"--memory (\S+)", short[0].records[0]["command"])[1]
    return Claim(where, statement, judged(launches[1] > launches[0]),
                 f"with {limit} of memory {ratio(launches[1], launches[0]):.3g} times the launches, in {sum(r['work']['batches'] for r in short[0].records)} batches for "
                 f"{short[0].frames} frame{'s' * (short[0].frames != 1)}; same pairs", " ".join((short[0].locations[0], whole.locations[0])))


def untestable_claims():
    why = "needs the paper's four GPUs, and one device was measured"
    return [Claim("Table 5, Figure 12", "NVIDIA's and AMD's devices differ in launches and transfers", UNTESTED, why),
            Claim("Figure 10", "the K20c is no faster than the C2075, the K40c and W8100 twice as fast", UNTESTED, why),
            Claim("Section 5", "chunking is simpler to implement and has less risk of bugs", UNTESTED, "an opinion, as the paper says")]


def all_claims(folder):
    return [*narrow_claims(folder), write_claim(folder), kernel_claim(folder), same_pairs_claim(folder), *stage_claims(folder), *simulation_claims(folder),
            order_claim(folder), threshold_claim(folder), cpu_claim(folder), precision_claim(folder), backlog_claim(folder), *untestable_claims()]
