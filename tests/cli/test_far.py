#!/usr/bin/env python3
"""Far from the origin: what grids hold there, and what every command refuses."""

import os

from cli import fails, icosphere_arrays, innermap, read_json, run, write_obj


def pair(off):
    vertices, faces = icosphere_arrays(subdivisions=3)
    place = lambda p: tuple(20 * x + o for x, o in zip(p, off))
    write_obj("a.obj", [place(p) for p in vertices], faces)
    write_obj("b.obj", [place((1.3 * x, y + 0.1 * x * z, z)) for x, y, z in vertices], faces)


def grids(off):
    pair(off)
    innermap("map", "a.obj", "b.obj", "-o", "out", "--resolution", "32", "--quiet")
    return read_json("out/report.json")


def test_rounding_is_stated_and_little_near_the_origin():
    report = grids((0, 0, 0))
    assert 0 < report["grid"]["map_rounding"] < 1e-7, report["grid"]
    assert "map_local_origin" not in report["grid"], report["grid"]
    assert "warnings" not in report, report["warnings"]


def test_utm_coordinates():
    report = grids((500000.3, 5400000.7, 120))
    # Floats of 5.4e6 are 0.5 apart; the target's diagonal is about 90.
    assert 1e-3 < report["grid"]["map_rounding"] < 6e-3, report["grid"]
    assert len(report["grid"]["map_local_origin"]) == 3, report["grid"]
    assert any("map_local" in w for w in report["warnings"]), report
    assert report["jacobian"]["folded_fraction"] == 0, report["jacobian"]
    assert report["one_to_one"]["cells_folded"] == 0, report["one_to_one"]
    names = innermap("info", "out/map.vdb").stdout
    assert "map_local" in names, names
    near = grids((0, 0, 0))
    assert abs(report["energy"]["deformation"] / near["energy"]["deformation"] - 1) < 1e-4


def test_all_commands_refuse_the_same():
    pair((3e10, -1e10, 2e10))
    os.rename("b.obj", "b.0001.obj")
    said = "of its diagonals from the origin, 1e+08 at most"
    for command in (["check", "a.obj"], ["voxelize", "a.obj", "-o", "a.vdb"],
                    ["fit", "a.obj", "b.0001.obj", "-o", "map.ply"],
                    ["map", "a.obj", "b.0001.obj", "-o", "out"],
                    ["correspond", "a.obj", "b.0001.obj", "-o", "c.ply"],
                    ["texture", "a.obj", "-o", "t.vdb"],
                    ["sequence", "a.obj", "b.0001.obj", "-o", "frames"]):
        fails(1, *command, says=[said])
    assert sorted(os.listdir(".")) == ["a.obj", "b.0001.obj"], os.listdir(".")


run(globals())
