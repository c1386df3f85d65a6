"""Spack package. There is no archive to fetch yet: build the source at hand by `spack dev-build splitgrain@main` at its top."""

from spack.package import *

try:  # Spack 1.0 and later; before, spack.package has it
    from spack_repo.builtin.build_systems.cmake import CMakePackage
except ImportError:
    pass


class Splitgrain(CMakePackage):
    """Nonsmooth contact dynamics of rigid grains with domain decomposition."""

    license("Apache-2.0")

    version("main")

    variant("mpi", default=True, description="Run on several ranks")
    variant("hdf5", default=True, description="Write pictures and restart files")
    variant("metis", default=True, description="Split grains by the graph of their contacts")
    variant("fftw", default=True, description="Write spectra")
    variant("suitesparse", default=True, description="Factorise large sparse matrices")
    variant("qhull", default=True, description="Make convex hulls of points and meshes")
    variant("lapack", default=True, description="Find eigenvalues of matrices")
    variant("python", default=True, description="What splitgrain look and study need")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("tomlplusplus", type="build")
    depends_on("mpi", when="+mpi")
    depends_on("hdf5+fortran+mpi", when="+hdf5+mpi")
    depends_on("hdf5+fortran~mpi", when="+hdf5~mpi")
    depends_on("metis@5.1:", when="+metis")
    depends_on("fftw@3:", when="+fftw")
    depends_on("suite-sparse", when="+suitesparse")
    depends_on("qhull", when="+qhull")
    depends_on("lapack", when="+lapack")
    depends_on("python@3.11:", when="+python", type="run")
    depends_on("py-h5py", when="+python", type="run")
    depends_on("py-matplotlib", when="+python", type="run")
    depends_on("py-numpy", when="+python", type="run")

    def cmake_args(self):
        """Options of CMake: libraries by variants; the compiler wrapper chooses the processor."""
        return [
            self.define_from_variant("SPLITGRAIN_MPI", "mpi"),
            self.define_from_variant("SPLITGRAIN_HDF5", "hdf5"),
            self.define_from_variant("SPLITGRAIN_METIS", "metis"),
            self.define_from_variant("SPLITGRAIN_FFTW", "fftw"),
            self.define_from_variant("SPLITGRAIN_SUITESPARSE", "suitesparse"),
            self.define_from_variant("SPLITGRAIN_QHULL", "qhull"),
            self.define_from_variant("SPLITGRAIN_LAPACK", "lapack"),
            self.define("SPLITGRAIN_NATIVE", False),
            self.define("BUILD_TESTING", self.run_tests),
        ]
