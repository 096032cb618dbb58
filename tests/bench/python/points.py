#!/usr/bin/python3
"""A million points through a map: the Python module beside C++, turn by turn in one run.

    PYTHONPATH=build/release/python tests/bench/python/points.py [--rounds 15] [--threads 2]

Arrays of numpy in and out on the one side, innermap::Points and a Matrix on the other; the least and
the median seconds of each and of its CPU, and their ratios.
"""

import argparse
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import innermap

ROOT = Path(__file__).resolve().parents[3]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default=ROOT / "build/release/tests/bench/innermap_points")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--points", type=int, default=1000000)
    options = parser.parse_args()
    m = innermap.fit(ROOT / "samples/gecko.obj", ROOT / "samples/gecko_step.obj")
    V = m.source.vertices
    X = np.random.default_rng(1).uniform(V.min(0), V.max(0), (14 * options.points, 3))
    X = np.ascontiguousarray(X[m.contains(X)][:options.points])
    with tempfile.TemporaryDirectory() as folder:
        m.save(f"{folder}/map.ply")
        X.tofile(f"{folder}/points")
        program = subprocess.Popen(
            [options.program, f"{folder}/map.ply", f"{folder}/points", str(len(X)),
             str(options.threads)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for what in ("values", "jacobian"):
            seconds = {"C++": [], "Python": []}
            for _ in range(options.rounds):
                program.stdin.write(what + "\n")
                program.stdin.flush()
                seconds["C++"].append([float(t) for t in program.stdout.readline().split()[:2]])
                start = time.monotonic(), time.process_time()
                m(X, jacobian=what == "jacobian", threads=options.threads)
                seconds["Python"].append([time.monotonic() - start[0],
                                          time.process_time() - start[1]])
            print(f"{len(X)} points, {m.charges} charges, {what}:")
            for k, kind in enumerate(("wall", "CPU")):
                cpp, python = (sorted(s[k] for s in seconds[side]) for side in seconds)
                middle = statistics.median(python) / statistics.median(cpp)
                print(f"  {kind}: C++ {cpp[0]:.3f} s at least, {statistics.median(cpp):.3f} s "
                      f"median; Python {python[0]:.3f} s, {statistics.median(python):.3f} s; "
                      f"ratio {python[0] / cpp[0]:.3f} and {middle:.3f}")
        program.stdin.close()
        program.wait()


if __name__ == "__main__":
    main()
