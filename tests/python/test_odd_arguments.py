"""What is no argument of a function, in place of each of its arguments: an error in words, never a crash.

    test_odd_arguments.py COUNT SEED    so many random ones; 0: all of them, 0.5: half of them
"""

import inspect
import itertools
import os
import random
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np

import cli
from cli import nightly
import innermap
import shapes
from test_calls import environment

COUNT, SEED = 60, 1  # of calls that tests/run tries
LONGEST = 1.0  # seconds of a call that takes what is odd


class Raises:
    """Has whatever is looked for, and none of it works."""

    def __getattr__(self, name):
        raise ArithmeticError(name)

    def __len__(self):
        raise ArithmeticError("length")


class NotAnArray:
    def __array__(self, *_, **__):
        raise ArithmeticError("array")


ODD = {
    "None": None, "True": True, "-1": -1, "0": 0, "2 ** 70": 2 ** 70, "1e308": 1e308,
    "nan": float("nan"), "1j": 1j, "empty text": "", "long text": "x" * 5000, "zero": "a\0b",
    "half a surrogate": "\ud800", "bytes": b"\xff", "[]": [], "[[]]": [[]], "ragged": [1, [2, 3]],
    "[None]": [None], "()": (), "pair": (1, 2), "texts": ["a", "b"], "{}": {}, "{1: 2}": {1: 2},
    "{a: ragged}": {"a": [1, [2, 3]]}, "pairs": [([0], [1, [2, 3]])], "object": object(),
    "type": innermap.Map, "callable": lambda *_: [1, [2]], "iterator": iter([1]),
    "no rows": np.zeros((0, 3)), "no axis": np.array(1.0), "five axes": np.ones((1, 1, 1, 1, 3)),
    "nans": np.full((3, 3), np.nan), "text array": np.array(["a"]), "objects": np.array([{}, None]),
    "uint64": np.array([[2 ** 64 - 1] * 3], np.uint64), "backwards": np.ones((4, 3))[::-1, ::-1],
    "record": np.zeros(2, [("a", "f4")]), "raises": Raises(), "no array": NotAnArray(),
    "module": np, "folder": ".", "nothing": "nothing.vdb",
}


def things():
    """What arguments are made of: (name, callable, positional, named)."""
    V, F = shapes.ball(1)
    m = innermap.fit(V, F, shapes.bent(V), **shapes.FEW)
    field = innermap.harmonic(V, F, V[:, 0], tolerance=1e-2)
    cells = innermap.tetrahedralize(V, F, resolution=4)
    grids = innermap.grids({"density": np.ones((4, 4, 4), np.float32)}, np.eye(4))
    deformer = innermap.Deformer((V, F), V, charges=100)
    laid = innermap.correspond((V, F), (V[:, ::-1], F[:, ::-1]), candidates=1)
    m.save("m.ply")
    field.save("f.ply")
    laid.save("c.ply")
    grids.write_vdb("g.vdb")
    cells.write("c.vtu")
    innermap.write_mesh("ball.obj", V, F)
    innermap.write_volume_texture("g.exr", grids)
    given = {
        "check": (V, F), "compare_fem": (V, F), "correspond": (V, F, V, F),
        "deform": ((V, F), V, [V]), "fit": (V, F, V), "grids": ({"a": np.ones((2, 2, 2))}, np.eye(4)),
        "harmonic": (V, F, V[:, 0]), "hexahedralize": (V, F),
        "jobs": ("j.txt", ["innermap", "evaluate", "m.ply", "-o", "m.vdb"]),
        "lattice": ((V.min(axis=0), V.max(axis=0)),), "load": ("m.ply",),
        "load_correspondence": ("c.ply", V, F), "polycube": (V, F), "pull": (m, V, "p.vdb"),
        "push": (m, grids, "p.vdb"), "read_cells": ("c.vtu",), "read_mesh": ("ball.obj",),
        "read_vdb": ("g.vdb",), "read_volume_texture": ("g.exr",), "remesh": (m, cells),
        "sequence": ((V, F), [V]), "solid_texture": ((V, F), "image.png"), "sphere": (V, F),
        "study": (V, F, V), "tetrahedralize": (V, F), "transfer_distance": (m,),
        "voxelize": (V, F), "weights": (V, F, {"a": [1], "b": [2]}),
        "write_mesh": ("w.ply", V, F), "write_section": ("s.png", grids),
        "write_slices": ("s.exr", grids), "write_volume_texture": ("t.exr", grids),
    }
    for name in innermap.__all__:
        function = getattr(innermap, name)
        if not inspect.isclass(function):
            yield name, function, given[name]
    points = {"__call__": (V,), "inverse": (V,), "contains": (V,), "gradient": (V,),
              "measure": (V,), "save": ("s.ply",), "write": ("w.vtu",), "write_vdb": ("w.vdb",),
              "__getitem__": ("density",), "__contains__": ("density",), "metadata": ("density",)}
    for thing in (m, field, cells, grids, laid, deformer, m.source):
        for name, method in inspect.getmembers(thing, callable):
            if not name.startswith("__") or name in points:
                yield f"{type(thing).__name__}.{name}", method, points.get(name, ())


def named_of(function):
    try:
        parameters = inspect.signature(function).parameters.values()
    except ValueError:  # of pybind11's own def()
        return []
    return [p.name for p in parameters if p.kind == p.KEYWORD_ONLY]


def cases():
    """(words, call) for each argument of each function, and each odd value."""
    for name, function, given in things():
        places = list(range(len(given))) + named_of(function)
        for place, (what, odd) in itertools.product(places, ODD.items()):
            if isinstance(place, int):
                arguments = given[:place] + (odd,) + given[place + 1:]
                yield f"{name}: argument {place} is {what}", function, arguments, {}
            else:
                yield f"{name}: {place} is {what}", function, given, {place: odd}


class Long(Exception):
    pass


def end_it(*_):
    raise Long


def attempt(function, arguments, named):
    """What is wrong with how the call ended, or None."""
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    try:
        function(*arguments, **named)
    except (SystemError, SystemExit) as error:
        return repr(error)
    except RuntimeError as error:  # pybind11's own, of a cast that failed
        return None if isinstance(error, innermap.Error) and str(error) else repr(error)
    except Exception as error:  # pylint: disable=broad-except
        return None if str(error) or isinstance(error, Long) else repr(error)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    return None


def child(count, seed):
    signal.signal(signal.SIGALRM, end_it)
    every = list(cases())
    if count > 0:
        count = int(count if count >= 1 else count * len(every))
        every = random.Random(seed).sample(every, count)
    for words, function, arguments, named in every:
        print(words, end="", flush=True)
        try:
            wrong = attempt(function, arguments, named)
        except Long:  # when it had ended
            wrong = None
        print(f"\nWRONG: {wrong}" if wrong else "", flush=True)
    print("all")


def end_in_words(count, seed):
    print(f"seed {seed}")
    line = [sys.executable, Path(__file__).resolve(), str(count), str(seed)]
    done = subprocess.run(line, env=environment(), capture_output=True, text=True, check=False)
    said = done.stdout.splitlines()
    wrong = [f"{before}: {line}" for before, line in zip(said, said[1:]) if "WRONG" in line]
    assert done.returncode == 0 and said[-1] == "all", (done.returncode, said[-1:], done.stderr)
    assert not wrong, "\n".join(wrong)


def test_some_end_in_words():
    end_in_words(COUNT, SEED)


@nightly
def test_half_of_all_end_in_words():
    end_in_words(0.5, int(os.environ.get("INNERMAP_TEST_SEED", SEED)))  # another half each night


if __name__ == "__main__":
    if len(sys.argv) == 3:
        child(float(sys.argv[1]), int(sys.argv[2]))
    else:
        cli.run(globals())
