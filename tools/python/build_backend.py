"""Makes the wheel that `pip install .` asks for (PEP 517), with CMake and Python's own library alone.

    pip install .                                          builds in build/wheel
    pip install . --config-settings=build-dir=build/release    takes the module that is built there

A build folder has to be one with INNERMAP_BUILD_PYTHON, for the same Python. The wheel holds the module
and what it loads for pictures; the libraries that both are linked with are the system's.
"""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MINOR = sys.version_info.minor
METADATA = """Metadata-Version: 2.1
Name: innermap
Version: {version}
Summary: Harmonic maps of solids, into OpenVDB and EXR
License: Apache-2.0
Requires-Python: ==3.{minor}.*
Requires-Dist: numpy
"""
WHEEL = """Wheel-Version: 1.0
Generator: innermap
Root-Is-Purelib: false
Tag: {tag}
"""


def version():
    return re.search(r"project\(innermap VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


def environment():
    """Without what pip puts before the module search path, which hides the system's numpy from CMake."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def run(*command):
    print(" ".join(map(str, command)), flush=True)
    subprocess.run(command, check=True, cwd=ROOT, env=environment())


def built(folder):
    """Builds the module in a folder of its own."""
    probe = [sys.executable, "-c", "import numpy"]
    if subprocess.run(probe, env=environment(), capture_output=True, check=False).returncode:
        sys.exit("innermap: this Python has no numpy, which the module is built with; make the environment with "
                 "python3 -m venv --system-site-packages, or install numpy into it")
    if not shutil.which("cmake"):
        sys.exit("innermap: cmake is missing; docs/install.md lists what the build needs")
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    run("cmake", "-S", ROOT, "-B", folder, *generator, "-DCMAKE_BUILD_TYPE=Release",
        f"-DPython3_EXECUTABLE={sys.executable}", "-DINNERMAP_BUILD_PYTHON=ON", "-DINNERMAP_BUILD_TOOLS=OFF",
        "-DINNERMAP_BUILD_TESTS=OFF", "-DINNERMAP_BUILD_BENCHMARKS=OFF")
    jobs = subprocess.run([ROOT / "scripts/build-jobs"], check=True, capture_output=True, text=True).stdout.strip()
    run("cmake", "--build", folder, "-j", jobs)


def checked(folder):
    """A folder that somebody else has built must hold the module, for this Python."""
    cache = folder / "CMakeCache.txt"
    text = cache.read_text() if cache.is_file() else ""
    if "INNERMAP_BUILD_PYTHON:BOOL=ON" not in text:
        sys.exit(f"innermap: {folder} is no build with the Python module; configure it with "
                 "-DINNERMAP_BUILD_PYTHON=ON, or leave build-dir out")
    if f"INNERMAP_PYTHON_MINOR:INTERNAL={MINOR}\n" not in text:
        sys.exit(f"innermap: {folder} was not built for this Python, which is 3.{MINOR}; leave build-dir out")


def contents(folder):
    """(name in the wheel, file) of the module and of what it loads from its own folder."""
    with tempfile.TemporaryDirectory() as stage:
        for component in ("python", "pictures"):
            run("cmake", "--install", folder, "--prefix", stage, "--strip", "--component", component)
        package = next(Path(stage).rglob("innermap/__init__.py"), None)
        if package is None:
            sys.exit(f"innermap: {folder} has not built the Python module yet; run cmake --build {folder}")
        files = sorted(path for path in package.parent.iterdir() if path.is_file())
        files += [path for path in Path(stage).rglob("innermap-images-*.so") if path not in files]
        for path in files:
            yield f"innermap/{path.name}", path.read_bytes()


def write(wheel, name, data, records, mode=0o644):
    info = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
    info.external_attr = (0o100000 | mode) << 16
    info.compress_type = zipfile.ZIP_DEFLATED
    wheel.writestr(info, data)
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    records.append(f"{name},sha256={digest},{len(data)}")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    del metadata_directory  # nothing was prepared
    given = (config_settings or {}).get("build-dir") or os.environ.get("INNERMAP_BUILD_DIR")
    folder = (ROOT / given) if given else ROOT / "build" / "wheel"
    if given:
        checked(folder)
    else:
        built(folder)
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    tag = f"cp3{MINOR}-cp3{MINOR}-{platform}"
    name = f"innermap-{version()}-{tag}.whl"
    records, info = [], f"innermap-{version()}.dist-info"
    with zipfile.ZipFile(Path(wheel_directory) / name, "w") as wheel:
        for path, data in contents(folder):
            write(wheel, path, data, records, 0o755 if path.endswith(".so") else 0o644)
        write(wheel, f"{info}/METADATA", METADATA.format(version=version(), minor=MINOR).encode(), records)
        write(wheel, f"{info}/WHEEL", WHEEL.format(tag=tag).encode(), records)
        write(wheel, f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes(), records)
        records.append(f"{info}/RECORD,,")
        write(wheel, f"{info}/RECORD", ("\n".join(records) + "\n").encode(), [])
    return name


def build_sdist(sdist_directory, config_settings=None):
    sys.exit("innermap: no source archives are made; install from a checkout, pip install .")
