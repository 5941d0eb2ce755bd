# SPDX-License-Identifier: MIT
# test: cost=20 full=50
"""Groups of 64 work-items, a wave of AMD's GPUs, in the portable form of kernels:
no text but CUDA's exchanges values between 32 work-items in step, and every algorithm is right on PoCL, which
runs work-items one after another."""

import json
import re

from tests.program import LONG, SOURCE, Case, ran, tandem

IN_STEP = re.compile(r"__syncwarp|__shfl\w*|__ballot\w*|__activemask|asm\b|sub_group_\w+|bar\.warp\w*")
SCENE = "pile:bodies=2,mesh=grain1,density=1,frames=1"


class Groups(Case):
    def expanded(self, kernel, *defines):
        """The text of a kernel file with its headers that a compiler with these defines gets."""
        flat = ran(
            ["/usr/bin/python3", SOURCE / "cmake/embed_kernels.py", "--root", SOURCE, "--flatten", kernel],
            check=True,
        )
        done = ran(["g++", "-E", "-P", "-x", "c", "-DGROUP_SIZE=64", *defines, "-"], input=flat.stdout)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_only_text_for_cuda_assumes_steps(self):
        kernels = [
            path.relative_to(SOURCE)
            for path in (SOURCE / "algorithms").rglob("*.cl")
            if "baselines" not in path.parts
        ]
        self.assertGreater(len(kernels), 15)
        with_lanes = 0
        for kernel in kernels:
            portable = self.expanded(kernel, "-D__OPENCL_C_VERSION__=120")
            self.assertIn("kernel", portable, kernel)
            self.assertEqual(IN_STEP.findall(portable), [], kernel)
            with_lanes += bool(
                IN_STEP.search(self.expanded(kernel, "-D__OPENCL_C_VERSION__=120", "-D__NV_CL_C_VERSION=1"))
            )
        self.assertGreater(
            with_lanes, 2
        )  # those of NVIDIA's compiler do, which shows that the expression finds them

    def test_every_algorithm_is_right_in_groups_of_a_wave(self):
        algorithms = [
            one["name"]
            for one in json.loads(tandem("algorithms", "--json")[1])
            if not one["baseline"] and any(setting["name"] == "group_size" for setting in one["parameters"])
        ]
        self.assertLessEqual({"chunked", "gproximity", "tiled", "leaf_query"}, set(algorithms))
        for precision in ("float", "double") if LONG else ("float",):
            out = self.work / f"{precision}.jsonl"
            status, text, errors = tandem(
                f"check {SCENE} --device opencl:0 --algorithm",
                ",".join(algorithms),
                f"--set group_size=64 --set k=8 --set precision={precision} --quiet --truth none --out {out}",
            )
            self.assertEqual(status, 0, (text, errors))
            records = self.records(out)
            self.assertEqual({record["algorithm"] for record in records}, set(algorithms))
            for record in records:
                self.assertEqual(
                    (record["settings"]["group_size"], record["status"]), ("64", "ok"), record["preset"]
                )
                self.assertGreater(record["agreement"]["digest"]["count"], 0)
            self.assertEqual(len({json.dumps(record["agreement"]["digest"]) for record in records}), 1)
