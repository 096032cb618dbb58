#!/usr/bin/env python3
"""Captures of Gaussian splats through the program. What becomes of them: tests/python/test_splats.py."""

import math
import os
import struct

from cli import fails, icosphere_arrays, innermap, read_json, run, write_obj
from scenes import SPLAT_NAMES, fitted_ball, write_splats

# At a quarter; seen from +x red is brighter, from +y green, from +z blue.
SPLAT = dict(zip(SPLAT_NAMES, [0.25, 0, 0, 0.5, 0.5, 0.5, 0, 0, -1, -1, 0, 0, 0, 1, 0, -1, -4, -5, -6,
                               2, 0, 0, 0]))


def read_splats(path):
    with open(path, "rb") as file:
        body = file.read().partition(b"end_header\n")[2]
    return [dict(zip(SPLAT_NAMES, row)) for row in struct.iter_unpack(f"<{len(SPLAT_NAMES)}f", body)]


def turned(p):
    """By a quarter about z, twice as large."""
    return (-2 * p[1] + 1, 2 * p[0], 2 * p[2])


def near(splat, expected, within=1e-5):
    for name, value in expected.items():
        assert abs(splat[name] - value) < within, (name, splat[name], value)


def alpha(splat):
    return 1 / (1 + math.exp(-splat["opacity"]))


def test_there_and_back():
    fitted_ball(turned, subdivisions=3)
    write_splats("cap.ply", [SPLAT, {**SPLAT, "x": 3}])
    innermap("push", "map.ply", "cap.ply", "-o", "posed.ply", "--report", "r.json")
    report = read_json("r.json")["geometry"]
    assert report["splats"] == 2 and report["points_cut"] == 1, report
    posed, = read_splats("posed.ply")
    half, log2 = math.sqrt(0.5), math.log(2)
    near(posed, {"x": 1, "y": 0.5, "z": 0, "scale_0": -4 + log2, "scale_1": -5 + log2,
                 "scale_2": -6 + log2, "rot_0": 2 * half, "rot_1": 0, "rot_2": 0, "rot_3": 2 * half,
                 "opacity": -1, "f_dc_0": 0.5})
    # -y z -x: red is brighter from +y now, green from -x.
    near(posed, {"f_rest_0": -1, "f_rest_2": 0, "f_rest_3": 0, "f_rest_5": 1, "f_rest_7": 1})
    innermap("pull", "map.ply", "posed.ply", "-o", "back.ply")
    near(read_splats("back.ply")[0], SPLAT, 1e-4)


def test_mass_and_what_it_cannot_keep():
    fitted_ball(turned, subdivisions=3)
    write_splats("cap.ply", [SPLAT])
    innermap("push", "map.ply", "cap.ply", "-o", "posed.ply", "--splats", "mass")
    assert abs(alpha(read_splats("posed.ply")[0]) / alpha(SPLAT) - 0.25) < 1e-5
    write_splats("cap.ply", [{**SPLAT, "x": 1}, {**SPLAT, "x": 1, "opacity": -5}])
    innermap("pull", "map.ply", "cap.ply", "-o", "back.ply", "--splats", "mass", "--report", "r.json")
    assert read_json("r.json")["geometry"]["opacities_capped"] == 1
    assert abs(alpha(read_splats("back.ply")[0]) - 0.99) < 1e-5


def test_frames():
    vertices, faces = icosphere_arrays(4)
    write_obj("ball.obj", vertices, faces)
    write_obj("walk.1.obj", [turned(p) for p in vertices], faces)
    write_splats("cap.ply", [SPLAT])
    innermap("deform", "ball.obj", "cap.ply", "walk.1.obj", "-o", "cap.####.ply", "--charges", 500,
             "--splats", "mass")
    posed, = read_splats("cap.0001.ply")
    near(posed, {"x": 1, "y": 0.5, "scale_1": -5 + math.log(2), "f_rest_5": 1}, 2e-3)
    assert abs(alpha(posed) / alpha(SPLAT) - 0.25) < 2e-3


def test_bad_captures_write_nothing():
    fitted_ball(turned, subdivisions=3)
    for change, says in (({"rot_0": 0}, "length 0"), ({"scale_1": math.nan}, "scale"),
                         ({"scale_1": math.inf}, "scale"), ({"f_rest_3": math.nan}, "f_rest")):
        write_splats("bad.ply", [SPLAT, {**SPLAT, **change}])
        fails(1, "push", "map.ply", "bad.ply", "-o", "a.ply", says=["bad.ply", "splat 1", says])
    for names in (SPLAT_NAMES[:8] + SPLAT_NAMES[9:], SPLAT_NAMES[:-1]):
        write_splats("bad.ply", [SPLAT], names)
        fails(1, "push", "map.ply", "bad.ply", "-o", "a.ply", says=["bad.ply"])
    with open("cut.ply", "wb") as file, open("bad.ply", "rb") as whole:
        file.write(whole.read()[:-1])
    fails(1, "push", "map.ply", "cut.ply", "-o", "a.ply", says=["cut.ply"])
    fails(2, "push", "map.ply", "a.vdb", "-o", "b.vdb", "--splats", "mass", says=["--splats"])
    fails(1, "push", "map.ply", "ball.obj", "-o", "a.obj", "--splats", "mass", says=["splats"])
    assert not os.path.exists("a.ply") and not os.path.exists("a.obj")


if __name__ == "__main__":
    run(globals())
