# SPDX-License-Identifier: GPL-3.0-or-later
"""Recipe of nscdd for Spack, of the form of its package repositories since 1.0. See packaging/README.md."""
from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Nscdd(CMakePackage):
    """How fast domain decomposition converges on granular media, and why: certified spectral radii of the iteration
    on packings of rigid grains in contact, and runs of it on packings that move, with friction."""

    license("GPL-3.0-or-later")

    # The source is the checkout itself: spack develop --path CHECKOUT nscdd@0.2.0
    version("0.2.0")

    variant("mpi", default=False, description="Build nscdd-mpi, whose processes share the subdomains")
    variant("python", default=False, description="Build the Python package")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    generator("ninja")
    conflicts("%gcc@:11", msg="C++20 as nscdd uses it is compiled by g++ 12 and later")

    depends_on("eigen@3.4", type=("build", "link"))
    depends_on("arpack-ng@3.8: ~mpi +icb")  # its C++ binding is the option icb
    depends_on("suite-sparse@5.12:")
    depends_on("openblas@0.3.21: threads=pthreads")  # LAPACKE is in it
    depends_on("metis@5.1:")
    depends_on("intel-oneapi-tbb@2021:")
    depends_on("gsl@2.7:")
    depends_on("hdf5@1.10: ~mpi", when="~mpi")
    depends_on("hdf5@1.10:", when="+mpi")
    depends_on("nlohmann-json@3:", type="build")
    depends_on("tomlplusplus@3:", type="build")
    depends_on("fmt@9")

    with when("+mpi"):
        depends_on("mpi")
        depends_on("pkgconfig", type="build")
        depends_on("petsc@3.18: +mpi +double ~complex ~int64")
        depends_on("slepc@3.18:")

    with when("+python"):
        extends("python@3.11:")
        depends_on("py-pybind11@2.10:", type="build")
        depends_on("py-numpy", type=("build", "run"))
        depends_on("py-scipy", type=("build", "run"))

    def cmake_args(self):
        arguments = [
            self.define("NSCDD_TESTS", False),
            self.define_from_variant("NSCDD_MPI", "mpi"),
            self.define_from_variant("NSCDD_PYTHON", "python"),
            # One library has BLAS, LAPACK and LAPACKE here.
            self.define("LAPACKE_LIBRARY", self.spec["openblas"].libs[0]),
        ]
        if self.spec.satisfies("+python"):
            arguments.append(self.define("NSCDD_PYTHON_INTERPRETER", python.path))
        return arguments

    def setup_run_environment(self, env):
        if self.spec.satisfies("+python"):
            env.prepend_path("PYTHONPATH", self.prefix.lib.python3.join("dist-packages"))
