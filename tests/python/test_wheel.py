"""pip install . makes a wheel without network, which works in an environment of its own and goes again."""

import os
import re
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import cli
from cli import nightly

ROOT = Path(os.environ["INNERMAP_ROOT"])
# What tests and their caller put before Python's own paths would hide what is installed.
CLEAN = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}

PICTURES = """
import os
open("picture.png", "wb").write(b"no picture")
open("uv.obj", "w").write("v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 0 0 1\\nvt 0 0\\nvt 1 0\\nvt 0 1\\n"
                          "f 1/1 3/2 2/3\\nf 1/1 2/2 4/3\\nf 1/1 4/2 3/3\\nf 2/1 3/2 4/3\\n")
assert len(Y) == 2
try:
    innermap.solid_texture("uv.obj", "picture.png")
except Exception as error:
    assert "innermap-images" not in str(error), error
loaded = [line.split()[-1] for line in open("/proc/self/maps") if "innermap" in line and line.strip().endswith(".so")]
assert any("innermap-images-" in path for path in loaded), loaded
assert all(path.startswith(os.environ["FOLDER"]) for path in loaded), loaded
"""


def run(*command, good=True, **more):
    done = subprocess.run(command, text=True, capture_output=True, check=False, env={**CLEAN, **more})
    assert (done.returncode == 0) == good, done.stdout + done.stderr
    return done.stdout + done.stderr


def first_example():
    text = (ROOT / "docs/python.md").read_text()
    return re.search(r"```python\n(.*?)```", text, re.S).group(1)


def tree():
    return {path for path in Path("environment").rglob("*") if "__pycache__" not in path.parts}


def offline():
    """What runs a command without network, where this user may cut it off."""
    words = ("unshare", "--net")
    return words if shutil.which(words[0]) and subprocess.run([*words, "true"], check=False).returncode == 0 else ()


def check_install(*settings):
    venv.create("environment", system_site_packages=True, with_pip=True)
    python = str(Path.cwd() / "environment/bin/python3")
    before = tree()
    said = run(*offline(), python, "-m", "pip", "install", "--no-index", "--disable-pip-version-check",
               str(ROOT), *settings)
    assert "Successfully installed innermap-" in said, said
    for name, sample in (("rest.obj", "gecko.obj"), ("pose.obj", "gecko_step.obj")):
        Path(name).symlink_to(ROOT / "samples" / sample)
    # The module and what it loads for pictures are the environment's own.
    run(python, "-c", first_example() + PICTURES, FOLDER=str(Path.cwd() / "environment"))
    run(python, "-m", "pip", "uninstall", "-y", "innermap")
    assert tree() == before, tree() - before


def test_pip_installs_a_checkout():
    check_install(f"--config-settings=build-dir={os.environ['INNERMAP_BUILD']}")


@nightly
def test_pip_builds_a_checkout():
    """From the sources, in build/wheel."""
    check_install()


def test_a_build_without_the_module_is_refused():
    os.mkdir("empty")
    program = "import sys; sys.path.insert(0, sys.argv[1]); import build_backend; build_backend.build_wheel" \
              "('.', {'build-dir': sys.argv[2]})"
    said = run(sys.executable, "-c", program, str(ROOT / "tools/python"), str(Path("empty").resolve()), good=False)
    assert "INNERMAP_BUILD_PYTHON" in said, said
    assert not list(Path(".").glob("*.whl"))


if __name__ == "__main__":
    cli.run(globals())
