# SPDX-License-Identifier: MIT
# test: cost=5 full=20
"""Schemas reject invalid records: every field of a real record missing, of another type, null, or with one
beside it."""

import json
import sys

from tests.program import SOURCE, Case, ran, tandem


def paths(value, path=()):
    """Every path to a value inside a JSON document, parents first."""
    for name, child in (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    ):
        yield (*path, name)
        yield from paths(child, (*path, name))


def changed(record, path, change):
    """A copy of `record` after change(parent of path, last name of path)."""
    copy = json.loads(json.dumps(record))
    parent = copy
    for name in path[:-1]:
        parent = parent[name]
    change(parent, path[-1])
    return copy


MAPS = {"settings", "asked", "defines", "counters", "kernel_times", "host_work"}
NULLABLE = set(
    "chosen failure agreement commit hardware device_span_ns session command registers local_bytes spill_bytes "
    "stack_bytes missed_upper95 candidate_ratio decisions depth_relative depth_ulps normal_degrees point "
    "hausdorff volume_relative depth_change deep_contact distance_ulps polygon_ulps".split()
)
OF_CONDITION = (
    "cores quota_cores own_cores other_cores governor mhz throttled_periods pressure_percent".split()
)
OF_SAMPLING = ("cells", "seed", "repeat", "noise", "seconds", "spent_seconds", "converged", "drift")
NULLABLE_PATHS = {
    *((name,) for name in ("conditions", "ranks", "partition", "steps")),
    *(("environment", name) for name in ("processor", "sources")),
    *(("error", name) for name in ("truth", "rounding")),
    *(("error", "truth", name) for name in ("contacts", "drift")),
    *(("scene", "reading", name) for name in ("weld", "pressure")),
    *(("conditions", when, "processor", name) for when in ("before", "after") for name in OF_CONDITION),
    *(("conditions", when, "gpus", 0) for when in ("before", "after")),
    *(("sampling", name) for name in OF_SAMPLING),
    *(("work", name) for name in ("undecided_by_filter", "undecided_by_double", "batches")),
}
# Fields that records may lack for another reason than their age.
OPTIONAL_PATHS = {
    *((name,) for name in ("chosen", "partition")),
    *(("sampling", "continued"),),
    *(("error", "truth", "contacts", name) for name in ("no_volume", "distance_ulps", "polygon_ulps")),
}


def declared(schema, path):
    """What the schema says of a field."""
    node = schema
    for name in path:
        while "$ref" in node or "anyOf" in node:
            node = schema["definitions"][node["$ref"].split("/")[-1]] if "$ref" in node else node["anyOf"][1]
        fields = node.get("properties", {})
        node = node["items"] if isinstance(name, int) else fields.get(name) or node["additionalProperties"]
    return node


class Fields(Case):
    def full_record(self):
        """A record with every optional part, but few entries of maps and lists whose entries all have the
        same fields."""
        out = self.work / "schema.jsonl"
        flat, _ = self.flawed("schema.msh")
        tandem(
            f"run --mesh {flat} --mesh {self.good} --device opencl:0 --algorithm gproximity "
            f"--truth contacts --out {out}"
        )
        record = self.records(out)[0]
        for name in ("stages", "kernel_times", "host_work"):
            record[name] = {key: record[name][key] for key in sorted(record[name])[-2:]}
        record["kernels"] = record["kernels"][:1]
        return record

    def check_field(self, record, path):
        """The field removed, of another type, null, or with an additional field beside it."""
        parent, name = path[-2] if len(path) > 1 else None, path[-1]
        nullable_paths = NULLABLE_PATHS | {
            ("work", "counters", counter) for counter in record["work"]["counters"]
        }
        schema = self.validator.schema
        is_new = declared(schema, path).get("since") == schema["properties"]["schema"]["const"]
        optional = parent in MAPS | {"stages"} or isinstance(name, int) or is_new or path in OPTIONAL_PATHS
        gone = changed(record, path, lambda p, n: p.pop(n))
        self.assertTrue(optional or not self.validator.is_valid(gone), "taken away")
        wrong = {"x": []}
        other = changed(
            record, path, lambda p, n: p.update({n: wrong}) if isinstance(p, dict) else p.append(wrong)
        )
        self.assertFalse(self.validator.is_valid(other), "type")
        null = changed(record, path, lambda p, n: p.__setitem__(n, None))
        self.assertEqual(self.validator.is_valid(null), name in NULLABLE or path in nullable_paths, "null")
        if not isinstance(name, int) and parent not in MAPS:
            more = changed(record, path, lambda p, n: p.update(surprise=1))
            self.assertFalse(self.validator.is_valid(more), "one more")

    def test_schema_can_fail(self):
        """Every field of a real record."""
        record = self.full_record()
        seen = set()
        for path in paths(record):
            shape = tuple(0 if isinstance(name, int) else name for name in path)
            if shape in seen:
                continue
            seen.add(shape)
            with self.subTest(path=path):
                self.check_field(record, path)
        self.assertGreater(len(seen), 150)
        for change in (
            {"status": "fine"},
            {"status": "failed"},
            {"failure": "device lost"},
            {"failure": ""},
            {"schema": 2},
            {"stages": {"travers": record["stages"]["traverse"]}},
            {"breakdown_ns": {"samples": []}},
            {"total_ns": {**record["total_ns"], "samples": []}},
            {"devices": []},
            {"settings": {"k": 18}},
            {"scene": {**record["scene"], "digest": "0123456789ABCDEF"}},
            {"agreement": {**record["agreement"], "missing": 1}},
        ):
            self.assertFalse(self.validator.is_valid({**record, **change}), change)

    def test_validate_records(self):
        script = SOURCE / "tests/validate_records.py"

        def validate(*files):
            done = ran([sys.executable, str(script), *map(str, files)])
            return done.returncode, done.stdout + done.stderr

        good, bad, empty = (self.work / name for name in ("good.jsonl", "bad.jsonl", "empty.jsonl"))
        tandem(
            "run", "--mesh", self.good, "--device", "host", "--algorithm", "chunked,gproximity", "--out", good
        )
        line = good.read_text().splitlines()[0]
        bad.write_text(line + "\n" + line.replace('"count":0,', '"count":-1,', 1) + "\n" + line[:100] + "\n")
        empty.write_text("")
        self.assertEqual(validate(good), (0, "2 records valid\n"))
        status, text = validate(good, bad)
        self.assertEqual(status, 1, text)
        self.assertIn(": ".join(("bad.jsonl:2", "/".join(("", "work", "digest", "count")), "")), text)
        self.assertIn("bad.jsonl:3: not JSON", text)
        for files in ([empty], [self.work / "none.jsonl"], [good, self.work / "none.jsonl"]):
            self.assertEqual(validate(*files)[0], 1, files)
