#!/usr/bin/env python3
"""The tasks of docs/recipes.md and docs/tutorial.md, done by their text alone: each command as it is written, in a
folder that has the samples and the program and nothing else."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import cli
from cli import PROGRAM, ROOT, Skip, nightly

BLOCK = re.compile(r"^```sh\n(.*?)^```", re.M | re.S)
# Those that take few seconds; all are done at night.
SHORT = ["Weights for a rig, without painting", "A volume texture for an engine",
         "Move bones and muscles with a pose", "Carry a tetrahedral mesh to another pose",
         "Prove that a map does not fold"]


def tasks(page):
    """The commands under each heading of a page; "" has those before the first."""
    parts = re.split(r"^## (.+)$", (ROOT / "docs" / page).read_text(encoding="utf-8"), flags=re.M)
    found = dict(zip(["", *parts[1::2]], parts[0::2]))
    return {name: "".join(BLOCK.findall(text)) for name, text in found.items() if BLOCK.search(text)}


def checkout(folder):
    """What a task finds: the samples, and the program where a build puts it."""
    tools = Path(folder, "build/release/tools")
    tools.mkdir(parents=True)
    (tools / "innermap").symlink_to(shutil.which(PROGRAM))
    Path(folder, "samples").symlink_to(ROOT / "samples")


def done(name, commands, folder):
    """Runs the commands; every file that they name has to be there afterwards."""
    checkout(folder)
    # Debian's Blender takes the first python3 that it finds for its own; the system's has numpy.
    system = {**os.environ, "PATH": "/usr/bin:" + os.environ["PATH"]}
    ran = subprocess.run(["bash", "-e"], input=commands, cwd=folder, env=system, capture_output=True, text=True,
                         check=False, timeout=1800)
    assert ran.returncode == 0, f"{name}: {ran.stdout[-1500:]}{ran.stderr[-1500:]}"
    named = set(re.findall(r"\bout/[\w./*#]+", commands))
    assert named, f"{name}: makes nothing"
    for path in named:
        made = list(Path(folder).glob(path.replace("####", "*")))
        assert made and all(p.is_dir() or p.stat().st_size for p in made), f"{name}: {path} is not there"


def each(names):
    recipes = tasks("recipes.md")
    start = recipes.pop("")
    assert len(recipes) >= 10, recipes.keys()
    for i, name in enumerate(names or recipes):
        done(name, start + recipes[name], f"task{i}")


def test_short_recipes_run_as_written():
    each(SHORT)


@nightly
def test_all_recipes_run_as_written():
    each([])


@nightly
def test_tutorial_runs_as_written():
    if not shutil.which("blender"):
        raise Skip("Blender is not installed")
    steps = tasks("tutorial.md")
    assert len(steps) == 5, steps.keys()
    done("tutorial", "".join(steps.values()), "tutorial")


cli.run(globals())
