"""cmake --install puts the module where its interpreter finds it, and it works from there."""

import os
import subprocess
import sys
from pathlib import Path

import cli

PROGRAM = """
import innermap, numpy, shapes, sys
V, F = shapes.ball(1)
m = innermap.fit(V, F, 2 * V)
assert numpy.allclose(m(V), 2 * V)
print(innermap.__file__)
"""


def test_is_found_where_it_is_installed():
    build = os.environ["INNERMAP_BUILD"]
    # The module's part of the install alone; the rest is tests/install's.
    subprocess.run(["cmake", "--install", build + "/python", "--prefix", Path("prefix").resolve()],
                   check=True, capture_output=True)
    found = sorted(Path("prefix").rglob("innermap/__init__.py"))
    assert len(found) == 1, found
    package = found[0].parent
    names = {path.name.split(".")[0] + path.suffix for path in package.iterdir()}
    assert names == {"__init__.py", "_innermap.so", "_innermap.pyi", "py.typed"}, names
    folder = package.parent.relative_to("prefix").as_posix()
    assert folder.startswith("lib/python3") and folder.endswith("-packages"), folder
    assert str(Path("/usr/local") / folder) in sys.path or str(Path("/usr") / folder) in sys.path \
        or "site-packages" in folder
    here = os.path.dirname(os.path.abspath(__file__))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(
        [str(package.parent.resolve()), here, *sys.path[1:]])}
    os.mkdir("elsewhere")
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd="elsewhere", env=environment,
                          text=True, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert Path(done.stdout.strip()) == package.resolve() / "__init__.py", done.stdout


if __name__ == "__main__":
    cli.run(globals())
