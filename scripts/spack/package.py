# SPDX-License-Identifier: MIT
"""A recipe for Spack, not linted. Use: copy it to packages/tandem of a repository of recipes, then `spack dev-build tandem@main` in a
checkout. It builds the program, the library and its CMake package; CUDA needs nothing here, because tandem loads driver and NVRTC at run time."""
from spack.package import *


class Tandem(CMakePackage):
    """A laboratory for walking bounding-volume hierarchies of tetrahedral meshes in tandem on GPUs."""

    license("MIT")
    version("main", branch="main")

    variant("mpi", default=False, description="Build the MPI component")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("python@3.11:", type=("build", "run"))
    depends_on("py-pandas", type="run")
    depends_on("py-scipy", type="run")
    for library in ("boost", "cli11", "eigen", "fmt", "gmp+cxx", "intel-tbb", "lz4", "nlohmann-json", "opencl-headers", "ocl-icd", "xz", "zlib-api"):
        depends_on(library)
    depends_on("mpi", when="+mpi")

    generator("ninja")
    conflicts("%gcc@:11", msg="tandem is C++20")

    def cmake_args(self):
        return [self.define("TANDEM_TESTS", False), self.define("TANDEM_PYTHON", False), self.define_from_variant("TANDEM_MPI", "mpi")]
