#!/usr/bin/env python3
"""check, voxelize, slice and info on real input, and on bad input."""

import json
import math
import os
import re
import struct

import cli
from cli import cube, fails, icosphere, innermap, no_leftovers, write_obj


def ball_grid():
    icosphere(subdivisions=3)
    innermap("voxelize", "ball.obj", "-o", "ball.vdb", "--resolution", "48", "--fog", "--quiet")


def test_check_tells_what_is_wrong():
    cube()
    said = innermap("check", "cube.obj").stdout
    assert re.search(r"\b8\b.*\b12\b", said), said
    found = json.loads(innermap("check", "cube.obj", "--json").stdout)
    assert found["findings"] == [] and found["genus"] == 0 and found["closed"]
    assert abs(found["volume"] - 1) < 1e-12 and abs(found["area"] - 6) < 1e-12
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2)]
    write_obj("open.obj", corners + [(9, 9, 9)], faces)
    found = json.loads(innermap("check", "open.obj", "--json").stdout)
    assert len(found["boundary_loops"]) == 1 and found["loose_vertices"] == 1
    assert abs(found["boundary_loops"][0]["length"] - 4) < 1e-12
    assert all(f["what"] and f["meaning"] for f in found["findings"])
    text = innermap("check", "open.obj", "--report", "r.json").stdout
    assert all(f["what"] in text for f in found["findings"])
    assert cli.read_json("r.json")["source"]["boundary_loops"] == 1


def test_check_writes_the_outer_surface():
    cube("a.obj")
    vertices = [tuple(o + (i >> a & 1) for a in range(3)) for o in (0, 0.5) for i in range(8)]
    faces = [tuple(first + v for v in f) for first in (0, 8) for f in cli.CUBE_FACES]
    write_obj("two.obj", vertices, faces)
    innermap("check", "two.obj", "--outer", "outer.ply", "--surface-resolution", 16, "--report",
             "r.json")
    outer = cli.read_json("r.json")["outer_surface"]
    assert outer["taken"] and outer["handles"] == 0 and not outer["cuts"]["x"], outer
    found = json.loads(innermap("check", "outer.ply", "--json").stdout)
    assert found["closed"] and found["components"] == 1 and found["self_intersections"] == 0, found
    assert abs(found["volume"] - 1.875) < 0.02, found["volume"]
    innermap("check", "a.obj", "--outer", "same.ply", "--report", "same.json")
    assert cli.read_json("same.json")["outer_surface"] == {"taken": False}
    assert json.loads(innermap("check", "same.ply", "--json").stdout)["vertices"] == 8


def test_voxelize_holds_the_volume():
    icosphere(subdivisions=4, radius=2)
    innermap("voxelize", "ball.obj", "-o", "ball.vdb", "--resolution", "128", "--report", "r.json")
    report = cli.read_json("r.json")
    assert report["level_set"]["volume_error"] < 0.01
    assert report["level_set"]["lost_surface"] == 0
    assert abs(report["grid"]["voxel_size"] - 4 / 128) < 0.05 * 4 / 128
    inside = report["grid"]["interior_voxels"] * report["grid"]["voxel_size"] ** 3
    assert abs(inside / (32 / 3 * math.pi) - 1) < 0.02


def test_voxelize_options():
    icosphere()
    innermap("voxelize", "ball.obj", "-o", "a.vdb", "--voxel-size", "0.05", "--half-width", "5",
             "--fog", "--report", "r.json")
    assert cli.read_json("r.json")["grid"]["voxel_size"] == 0.05
    text = innermap("info", "a.vdb").stdout
    assert "surface: float, level set" in text and "density: float, fog volume" in text
    innermap("voxelize", "ball.obj", "-o", "b.vdb", "--resolution", "16", "--attributes", "--report",
             "r.json")
    assert cli.read_json("r.json")["warnings"]
    with open("colour.obj", "w", encoding="ascii") as file:
        for line in open("ball.obj", encoding="ascii"):
            file.write(line.rstrip() + " 1 0.5 0\n" if line.startswith("v ") else line)
    innermap("voxelize", "colour.obj", "-o", "c.vdb", "--resolution", "16", "--attributes",
             "--names", "blender", "--quiet")
    assert "color: vec3s" in innermap("info", "c.vdb").stdout


def test_slices_and_section():
    ball_grid()
    innermap("slice", "ball.vdb", "--axis", "y", "--slices", "5", "-o", "s.exr", "--picture",
             "p.png", "--grid", "surface", "--at", "0.5", "--report", "r.json")
    text = innermap("info", "s.exr").stdout
    assert "5 parts" in text and "y_0004" in text and "density.V, surface.V" in text
    report = cli.read_json("r.json")
    assert report["slices"]["count"] == 5 and report["section"]["grid"] == "surface"
    assert abs(report["section"]["position"]) < 0.05
    with open("p.png", "rb") as file:
        head = file.read(24)
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", head[16:24])
    assert width >= 800 and height >= 800
    innermap("slice", "ball.vdb", "-o", "h.exr", "--half", "--grids", "density", "--slices", "2")
    assert os.path.getsize("h.exr") < os.path.getsize("s.exr")
    assert "density.V\n" in innermap("info", "h.exr").stdout
    innermap("slice", "ball.vdb", "-o", "many.exr", "--slices", "5000")
    no_leftovers("ball.obj", "ball.vdb", "s.exr", "h.exr", "many.exr", "p.png", "r.json")


def test_grids_and_places_that_are_not_there():
    ball_grid()
    fails(1, "slice", "ball.vdb", "-o", "s.exr", "--grids", "surface,curl",
          says=["curl", "surface", "density"])
    fails(1, "slice", "ball.vdb", "--picture", "p.png", "--grid", "jacobian",
          says=["jacobian", "density"])
    fails(1, "slice", "ball.vdb", "--picture", "p.png", "--position", "50", says=["position"])
    fails(1, "slice", "ball.vdb", "--picture", "p.png", "--range", "2,1", says=["range"])
    fails(1, "slice", "ball.vdb", "--picture", "p.png", "--at", "1.5", says=["--at"])
    fails(1, "slice", "ball.vdb", "-o", "s.exr", "--slices", "0", says=["--slices"])
    fails(2, "slice", "ball.vdb", "-o", "s.exr", "--axis", "w", says=["--axis"])


def test_bad_files_are_one_line():
    """What else is damaged: the readers' unit tests."""
    for name, data in [("empty.obj", b""), ("text.vdb", b"hello\n" * 30), ("text.exr", b"hello\n" * 30),
                       ("odd.xyz", b"1 2 3\n"), ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")]:
        cli.write_file(name, data)
        fails(1, "info", name, says=[name])
        if not name.endswith((".vdb", ".exr")):
            fails(1, "check", name, says=[name])
            fails(1, "voxelize", name, "-o", "a.vdb", says=[name])
        else:
            fails(1, "slice", name, "-o", "s.exr", says=[name])
    for name in ["missing.obj", "missing.vdb", "missing.exr"]:
        fails(1, "info", name, says=[name])
    write_obj("flat.obj", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    fails(1, "voxelize", "flat.obj", "-o", "a.vdb", says=["flat.obj"])


cli.run(globals())
