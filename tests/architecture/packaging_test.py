"""The recipe for conda requires what CMake looks for, at the same least versions, and has the version of the project.
usage: packaging_test.py ROOT"""

import pathlib
import re
import sys

# Package of conda-forge for each package of CMake; None: part of the compiler or optional.
CONDA = {"Threads": None, "Eigen3": "eigen", "OpenCV": "libopencv", "Ceres": "ceres-solver", "Boost": "libboost-headers", "HDF5": "hdf5",
         "TIFF": "libtiff", "OpenSSL": "openssl", "CLI11": "cli11", "tomlplusplus": "tomlplusplus", "nlohmann_json": "nlohmann_json", "fmt": "fmt",
         "pugixml": "pugixml", "PkgConfig": "pkg-config", "MATIO": "libmatio", "hwy": "libhwy"}


def wanted(root):
    """{package of CMake: least version or ""} of the program."""
    found = {}
    for name in ("cmake/dependencies.cmake", "imaging/CMakeLists.txt", "sim/CMakeLists.txt"):
        text = (root / name).read_text()
        found.update(re.findall(r"^find_package\((\w+)(?: ([\d.]+))?[^)]*REQUIRED", text, re.M))
        found.update(re.findall(r"^pkg_check_modules\((\w+)[^)]*>=([\d.]+)", text, re.M))
    return found


def main():
    root = pathlib.Path(sys.argv[1])
    recipe = (root / "cmake/packaging/meta.yaml").read_text()
    required = dict(re.findall(r"^    - ([\w-]+)(?: >=([\d.]+))?$", recipe, re.M))
    packages = wanted(root)
    assert len(packages) >= 15, f"the test finds only {sorted(packages)}"
    complaints = []
    for package, version in packages.items():
        if package not in CONDA:
            complaints.append(f"{package} has no name of conda-forge in this test")
        elif CONDA[package] is not None and CONDA[package] not in required:
            complaints.append(f"{package} is required by CMake, {CONDA[package]} not by the recipe")
        elif CONDA[package] is not None and required[CONDA[package]] != version:
            complaints.append(f"{package}: CMake requires '{version}', the recipe '{required[CONDA[package]]}'")
    version = re.search(r"^project\(twincell VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(), re.M)[1]
    if f'  version: "{version}"\n' not in recipe:
        complaints.append(f"the project has version {version}, the recipe another one")
    for complaint in complaints:
        print("cmake/packaging/meta.yaml:", complaint)
    sys.exit(bool(complaints))


main()
