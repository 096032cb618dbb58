#!/usr/bin/env python3
"""Axes and units: what is read is brought to those of the output, in meshes, frames, grids, geometry."""

import json
import math

import cli
from caches import cached_frames, read_pc2, write_gltf
from cli import fails, innermap, read_json
from frames import read_energies

SMALL = ["--charges", "400", "--quiet"]
OUT = ["--up", "y", "--unit-scale", "0.01", "--out-up", "z", "--out-unit-scale", "1"]


def moved(p):
    return 0.01 * p[0], -0.01 * p[2], 0.01 * p[1]


def bent(p):
    x, y, z = p
    return x + 0.2 * y * z, 1.1 * y, z - 0.1 * x * y


def near(a, b, within):
    assert len(a) == len(b) > 0
    worst = max(math.dist(p, q) for p, q in zip(a, b))
    assert worst < within, worst


def told(path):
    return json.loads(innermap("info", path, "--json").stdout)["grids"]


def grids_of(path):
    return {g["name"]: g for g in told(path)}


def test_maps_and_what_they_carry():
    vertices, faces = cli.icosphere_arrays(3)
    pose = [bent(v) for v in vertices]
    cli.write_obj("rest.obj", vertices, faces)
    cli.write_obj("pose.obj", pose, faces)
    cli.write_obj("rest_m.obj", [moved(v) for v in vertices], faces)
    cli.write_obj("pose_m.obj", [moved(v) for v in pose], faces)
    innermap("fit", "rest.obj", "pose.obj", "-o", "a.ply", *OUT, *SMALL, "--report", "r.json")
    settings = read_json("r.json")["settings"]
    assert settings["up"] == "y" and settings["out_up"] == "z" and settings["unit_scale"] == 0.01, settings
    innermap("fit", "rest_m.obj", "pose_m.obj", "-o", "b.ply", *SMALL)
    inner, inner_faces = cli.icosphere_arrays(2, 0.6)
    cli.write_obj("in.obj", inner, inner_faces)
    cli.write_obj("in_m.obj", [moved(p) for p in inner], inner_faces)
    innermap("push", "a.ply", "in.obj", "-o", "a.obj", *OUT, "--quiet")
    innermap("push", "b.ply", "in_m.obj", "-o", "b.obj", "--quiet")
    near(cli.read_obj("a.obj")[0], cli.read_obj("b.obj")[0], 1e-7)
    near(cli.read_obj("a.obj")[0], [moved(bent(p)) for p in inner], 2e-4)
    # As they are without options, and back.
    innermap("push", "a.ply", "in_m.obj", "-o", "c.obj", "--quiet")
    near(cli.read_obj("c.obj")[0], cli.read_obj("a.obj")[0], 1e-9)


def test_grids_are_turned_voxel_by_voxel():
    cli.write_obj("box.obj", *box((1, 2, 3), (3, 5, 7)))
    innermap("voxelize", "box.obj", "-o", "a.vdb", "--voxel-size", "0.25", "--fog", "--quiet")
    innermap("voxelize", "box.obj", "-o", "b.vdb", "--voxel-size", "0.0025", "--fog", *OUT, "--quiet")
    there = grids_of("b.vdb")
    assert abs(there["surface"]["voxel_size"][0] - 0.0025) < 1e-9
    metadata = there["surface"]["metadata"]
    assert metadata["innermap_up"] == "z" and float(metadata["innermap_metres_per_unit"]) == 1, metadata
    innermap("push", identity_map("box.obj"), "a.vdb", "-o", "c.vdb", *OUT, "--quiet")
    a, c = grids_of("a.vdb")["surface"], grids_of("c.vdb")["surface"]
    assert abs(c["voxel_size"][0] - 0.0025) < 1e-8, c
    assert abs(a["active_voxels"] / c["active_voxels"] - 1) < 0.1, (a, c)
    innermap("export", "a.vdb", "-o", "a.vti", "--grids", "density", *OUT, "--quiet")
    innermap("export", "a.vdb", "-o", "plain.vti", "--grids", "density", "--quiet")
    sizes = [told(f)[0] for f in ("plain.vti", "a.vti")]
    (nx, ny, nz), turned = sizes[0]["resolution"], sizes[1]["resolution"]
    assert turned == [nx, nz, ny], sizes
    low, high = sizes[0]["world_box"]
    low, high = moved(low), moved(high)
    assert max(abs(a - b) for a, b in zip(sizes[1]["world_box"][0], map(min, low, high))) < 1e-6, sizes
    assert max(abs(a - b) for a, b in zip(sizes[1]["world_box"][1], map(max, low, high))) < 1e-6, sizes
    innermap("export", "a.vdb", "-o", "back.vti", "--grids", "density", "--up", "z", "--out-up", "y", "--quiet")
    back = told("back.vti")[0]
    assert back["resolution"] == [nx, nz, ny], back


def box(low, high):
    corners = [tuple((high if i >> a & 1 else low)[a] for a in range(3)) for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def identity_map(path):
    innermap("fit", path, path, "-o", "same.ply", *OUT, *SMALL)
    return "same.ply"


def test_frames_of_all_kinds():
    frames = cached_frames()
    innermap("sequence", "rest.obj", "frames", "-o", "files", *SMALL, "--resolution", "16", "--frames", "2,4")
    innermap("sequence", "rest.obj", "walk.mdd", "-o", "mdd", *OUT, *SMALL, "--resolution", "16", "--frames", "2,4")
    for a, b in zip(read_energies("files"), read_energies("mdd")):
        assert abs(a["jacobian_min"] - b["jacobian_min"]) < 1e-3, (a, b)
        assert abs(b["deformation"] / a["deformation"] / 1e-6 - 1) < 0.01, (a, b)
        assert abs(b["volume"] / a["volume"] / 1e-6 - 1) < 1e-6, (a, b)
    innermap("report", "mdd")
    cli.icosphere("in.obj", 1, 0.5)
    inner = cli.icosphere_arrays(1, 0.5)[0]
    innermap("deform", "rest.obj", "in.obj", "walk.pc2", "-o", "in.pc2", *OUT, *SMALL)
    innermap("deform", "rest.obj", "in.obj", "walk.pc2", "-o", "plain.pc2", *SMALL)
    for turned, plain in zip(read_pc2("in.pc2")[2], read_pc2("plain.pc2")[2]):
        near(turned, [moved(p) for p in plain], 1e-6)
    assert len(inner) == len(read_pc2("in.pc2")[2][0]) and len(frames) == 4


def test_gltf_is_brought_to_the_others():
    """It has y up and metres; what lies beside it is in centimetres with z up."""
    write_gltf("ball.gltf")

    def cm(p):
        return 100 * p[0], -100 * p[2], 100 * p[1]

    inner, faces = cli.icosphere_arrays(1, 0.5)
    cli.write_obj("in.obj", [cm(p) for p in inner], faces)
    innermap("deform", "ball.gltf", "in.obj", "-o", "in.pc2", "--frames", "24", "--up", "z", "--unit-scale", "0.01",
             *SMALL)
    cli.write_obj("plain.obj", inner, faces)
    innermap("deform", "ball.gltf", "plain.obj", "-o", "plain.pc2", "--frames", "24", *SMALL)
    near(read_pc2("in.pc2")[2][0], [cm(p) for p in read_pc2("plain.pc2")[2][0]], 1e-4)
    assert "triangles" in innermap("check", "ball.gltf").stdout


def test_what_makes_no_sense_is_refused():
    cli.cube()
    fails(2, "voxelize", "cube.obj", "-o", "a.vdb", "--up", "x", says=["--up"])
    fails(1, "voxelize", "cube.obj", "-o", "a.vdb", "--out-unit-scale", "0", says=["--out-unit-scale"])


cli.run(globals())
