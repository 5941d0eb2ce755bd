# SPDX-License-Identifier: MIT
# test: cost=2
"""cmake/embed_kernels.py: what a kernel file must say of its variants, and the structures of its arguments."""

import pathlib
import subprocess
import tempfile
import unittest

from tests.program import SOURCE

HEAD = "// SPDX-License-Identifier: MIT\n"
VARIANTS = "// Host variants: K PRECISION\n"
KERNEL = "KERNEL void add_words(GLOBAL const uint* from, GLOBAL real* to, uint count, ulong first) { K; PRECISION; }\n"


class KernelFiles(unittest.TestCase):
    def embed(self, text):
        """Standard error of the script for one kernel file, and the folder of what it wrote."""
        work = tempfile.TemporaryDirectory(prefix="tandem-kernels")
        self.addCleanup(work.cleanup)
        root = pathlib.Path(work.name)
        (root / "one.cl").write_text(HEAD + text)
        done = subprocess.run(
            [
                "/usr/bin/python3",
                "-B",
                SOURCE / "cmake/embed_kernels.py",
                "--root",
                root,
                "--out",
                root / "out",
            ]
            + [
                "--geometries",
                "AXES=0,K=8,PRECISION=32",
                "AXES=0,K=8,PRECISION=64",
                "AXES=1,K=8,PRECISION=32",
            ]
            + ["--levels", "2", "4", "--kernels", "one.cl"],
            capture_output=True,
            text=True,
            check=False,
        )
        return done.stderr.strip(), root / "out"

    def variants(self, out, level=""):
        """Number of variants of the kernel at a level, over the files of all geometries."""
        files = [out / f"host_{level}{number}.cpp" for number in range(3)]
        return sum(file.read_text().count('{"one.cl", "add_words"') for file in files)

    def test_arguments_are_a_structure(self):
        errors, out = self.embed(VARIANTS + KERNEL)
        self.assertEqual(errors, "")
        text = (out / "one.cl.h").read_text()
        self.assertIn("namespace tandem::kernels::one {", text)
        members = "const Buffer& from;const Buffer& to;Exact<std::uint32_t> count;Exact<std::uint64_t> first;"
        self.assertIn(members, "".join(line.strip() for line in text.splitlines()))
        self.assertIn("return {from, to, count, first};", text)

    def test_variants_are_compiled_once(self):
        """K and PRECISION have two pairs of values in three geometries."""
        self.assertEqual(self.variants(self.embed(VARIANTS + KERNEL)[1]), 2)

    def test_lanes_are_compiled_by_level(self):
        line = "// Host variants: K PRECISION SLABS=0|1, in lanes; of higher levels: PRECISION=32 SLABS=0\n"
        errors, out = self.embed(line + KERNEL.replace("K;", "K; SLABS; FOR_LANES {}"))
        self.assertEqual(errors, "")
        self.assertEqual([self.variants(out, level) for level in ("", "v2_", "v4_")], [0, 4, 1])

    def test_constants_make_variants_of_higher_levels(self):
        line = "// Host variants: K PRECISION, in lanes; of higher levels: PRECISION=32\n// Host constants: MOTION\n"
        default = "#ifndef MOTION\n#define MOTION 3\n#endif\n"
        errors, out = self.embed(line + default + KERNEL.replace("K;", "K; FOR_LANES {}"))
        self.assertEqual(errors, "")
        self.assertEqual([self.variants(out, level) for level in ("v2_", "v4_")], [2, 2])
        higher = "".join(path.read_text() for path in out.glob("host_v4_*.cpp"))
        self.assertEqual(higher.count("#define MOTION 3\n"), 1 + higher.count(default))
        self.assertIn('"MOTION=3;"}', higher)

    def test_mistakes_are_one_line(self):
        for text, expected in (
            (KERNEL, "one.cl: 0 lines '// Host variants: ...' instead of one"),
            (2 * VARIANTS + KERNEL, "one.cl: 2 lines '// Host variants: ...' instead of one"),
            (VARIANTS + KERNEL.replace("K;", ""), "differ in whether they name K"),
            (VARIANTS + KERNEL.replace("K;", "K; AXES;"), "differ in whether they name AXES"),
            (VARIANTS + KERNEL.replace("K;", "K; FOR_LANES {}"), "differ in whether they have lanes"),
            (VARIANTS + "// Host constants: N\n" + KERNEL, "one.cl: the text has no default of N"),
            (VARIANTS + KERNEL.replace("ulong", "short"), "kernel add_words: parameter 'short first' is"),
            (VARIANTS + KERNEL.replace("GLOBAL real*", "real*"), "kernel add_words: parameter 'real* to' is"),
        ):
            errors = self.embed(text)[0]
            self.assertIn(expected, errors)
            self.assertEqual(len(errors.splitlines()), 1, errors)
