"""The snippets of docs/python.md and README.md run, one after another."""

import contextlib
import io
import os
import re
from pathlib import Path

import numpy as np

import captures
import cli
import innermap
import shapes

BLOCK = re.compile(r"^```python\n(.*?)^```$", re.M | re.S)


def files():
    """What the pages' files are."""
    V, F = shapes.ball(3)
    for name, places in (("rest", V), ("pose", shapes.twisted(V)), ("bones", 0.5 * V),
                         ("stranger", V * [1.2, 1, 0.9]), ("walk.0001", V),
                         ("walk.0002", shapes.twisted(V))):
        cli.write_obj(f"{name}.obj", places.tolist(), F.tolist())
    captures.write("capture.ply", captures.random_capture(0.5 * V))
    n = 16
    matrix = np.diag([1 / n, 1 / n, 1 / n, 1])
    matrix[:3, 3] = -0.5
    innermap.grids({"density": np.ones((n, n, n), np.float32)}, matrix).write_vdb("smoke.vdb")


def run(page):
    blocks = BLOCK.findall((Path(os.environ["INNERMAP_ROOT"]) / page).read_text(encoding="utf-8"))
    assert blocks, page
    names = {}
    for block in blocks:
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(block, f"{page}: {block.splitlines()[0]}", "exec"), names)
    return blocks


def test_python_page():
    files()
    first = run("docs/python.md")[0]
    assert len(first.splitlines()) <= 10


def test_readme():
    files()
    run("README.md")


if __name__ == "__main__":
    cli.run(globals())
