# SPDX-License-Identifier: MIT
"""A recipe for Spack 0.23 or newer. Copy it to packages/tandem of a repository of recipes, and
call `spack dev-build tandem@main` in a checkout. To fetch the sources, add a line `git = ADDRESS`.
It builds the program, the library and its CMake package. CUDA needs nothing here, because tandem
loads driver and NVRTC at run time."""

from spack.package import *

try:
    from spack_repo.builtin.build_systems.cmake import CMakePackage, generator
except ImportError:  # before Spack 1.0 the line above imports both
    pass


class Tandem(CMakePackage):
    """A laboratory for walking bounding-volume hierarchies of tetrahedral meshes in tandem on
    GPUs."""

    license("MIT")
    version("main", branch="main")

    variant("mpi", default=False, description="Build the MPI component")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("python@3.11:", type=("build", "run"))
    depends_on("py-pandas", type="run")
    depends_on("py-scipy", type="run")
    depends_on("boost")
    depends_on("cli11")
    depends_on("eigen")
    depends_on("fmt")
    depends_on("gmp+cxx")
    depends_on("lz4")
    depends_on("nlohmann-json")
    depends_on("ocl-icd")
    depends_on("opencl-headers")
    depends_on("tbb")
    depends_on("xz")
    depends_on("zlib-api")
    depends_on("mpi", when="+mpi")

    generator("ninja")
    conflicts("%gcc@:11", msg="tandem is C++20")

    def cmake_args(self):
        return [
            self.define("TANDEM_TESTS", False),
            self.define("TANDEM_PYTHON", False),
            self.define_from_variant("TANDEM_MPI", "mpi"),
        ]
